"""Do plans decide? Tied logs of the virtual bench, each motion on the same rig, both logs diagnosed.

A plan that says that more mass on the link makes a decision likelier is followed: the mass is added.

Run: python benchmarks/planned.py [LOGS [FIRST_SEED]]
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks.record import Measured, Part, progress
from eccentric.core import InputError
from eccentric.diagnosis import Diagnosis, diagnose
from eccentric.planning import Bounds, planned
from eccentric.virtual_bench import EFFECTS, BenchRun, Scenario, on_reference, random_scenario, simulate
from eccentric.virtual_bench.plant import Plant
from eccentric.virtual_bench.scenario import Course

FIRST_SEED = 330000
LOGS = 40
SECONDS = 60.0
"""Of a motion."""
PEERS_KEEP = 0.75
"""Part of the limits that the peers use: nobody simulates the drive for them, so they keep a margin."""


# Logs that end in a tie, found cheaply: a course of a few seconds at one speed, in one direction or over a small range
# leaves open what a full one would decide. The rig is drawn as for any other log of the bench; the limits of its
# motions are those of the drive, not those of the poor course.


STRENGTHS = (0.03, 0.06, 0.12)
RATIOS = (1 / 30, 1 / 5, 1 / 2, 1.0)
NOISES = (0.008, 0.015, 0.025)
COURSES = ("one speed", "one direction", "small range", "swing")


@dataclass(frozen=True)
class Tied:
    """A log whose diagnosis ends in a tie that holds the truth."""

    seed: int
    truth: str
    run: BenchRun
    found: Diagnosis
    bounds: Bounds


def tied_logs(first: int, time_s: float) -> Iterator[tuple[int, Tied | Exception | None]]:
    """From a seed on, each seed with its log if that is tied, or the failure of its diagnosis.

    Plans for them may take `time_s` [s].
    """
    families = [family for family in EFFECTS if "temperature" not in family]
    seed = first
    while True:
        rng = np.random.default_rng(seed)
        effect = str(rng.choice(families)), float(rng.choice(STRENGTHS))
        case, mu, noise = str(rng.choice(["C1", "C2"])), float(rng.choice(RATIOS)), float(rng.choice(NOISES))
        one: Tied | Exception | None = None
        # A case need not show every effect.
        with suppress(InputError):
            drawn = random_scenario(rng, case=case, mu=mu, log_type="runs", effects=[effect], noise=noise)
            poor = replace(drawn, course=poor_course(rng, max(drawn.course.speeds)))
            try:
                one = _tied(seed, poor, drawn, time_s)
            except np.linalg.LinAlgError as error:
                one = error
        yield seed, one
        seed += 1


def _tied(seed: int, scenario: Scenario, drawn: Scenario, time_s: float) -> Tied | None:
    run = simulate(scenario)
    found = diagnose([run.columns], run.rig)
    truth = run.scenario.effects[0].family
    if found.attribution.verdict != "not_identifiable" or truth not in found.attribution.tied:
        return None
    return Tied(
        seed, truth, run, found, limits_of(run.scenario.plant, max(map(abs, drawn.course.speeds)), time_s)
    )


def poor_course(rng: np.random.Generator, top_speed: float) -> Course:
    """Draw a course of 8 to 16 s that shows little: speeds up to `top_speed` [rad/s]."""
    seconds, kind = round(float(rng.uniform(8.0, 16.0)), 1), str(rng.choice(COURSES))
    blocks = [5 * fifth + int(rng.integers(1 if fifth == 0 else 0, 5)) for fifth in range(5)]
    holdout = tuple((round(b * seconds / 25, 3), round((b + 1) * seconds / 25, 3)) for b in blocks)
    speed = top_speed * float(rng.uniform(0.3, 1.0))
    if kind == "swing":
        cycles = float(rng.uniform(3.0, 8.0))
        return Course("traj", seconds, holdout, (speed,), frequencies=(cycles / seconds,), phases=(0.0,))
    parts = {
        "one speed": [1.0, -1.0] * 3,
        "one direction": [1.0, 0.5, 0.8, 0.3],
        "small range": [1.0, -1.0, 0.9, -0.9, 0.8, -0.8],
    }[kind]
    starts = np.linspace(0.0, seconds, len(parts), endpoint=False)
    return Course(
        "runs", seconds, holdout, tuple(speed * x for x in parts), tuple(np.round(starts, 3).tolist())
    )


def limits_of(plant: Plant, speed: float, time_s: float) -> Bounds:
    """Limits that suit a drive: its top speed [rad/s] within 0.3 s, and the current for that with 30 % to spare."""
    acceleration = speed / 0.3
    weight = plant.gravity_torque(0.5 * np.pi)
    friction = plant.friction_torque(0.0, plant.mu * speed)
    current = (plant.inertia * acceleration + friction + abs(weight)) / plant.k_i
    return Bounds(speed, acceleration, 1.3 * current, time_s)


# What plans lead to.


@dataclass(frozen=True)
class Outcome:
    """What a log and the one after it say together."""

    verdict: str
    named: tuple[str, ...]
    tied: tuple[str, ...]

    def right(self, truth: str) -> bool:
        """Whether the true family, and no other, is named."""
        return self.verdict == "named" and set(self.named) == {truth}

    @property
    def words(self) -> str:
        """The verdict and the names."""
        return " ".join([self.verdict, ", ".join(self.tied or self.named)]).strip()


@dataclass(frozen=True)
class Settled:
    """A tied log, its plan, and what it and its peers lead to."""

    tied: Tied
    probability: float
    same: tuple[tuple[str, str], ...]
    seconds: float
    broken: tuple[str, ...]
    after: Outcome
    peers: dict[str, Outcome]
    added_kg: float


def settled(tied: Tied) -> Settled:
    """The plan for a log and its outcome, beside those of the peers."""
    started = time.process_time()
    plan = planned(tied.found, tied.bounds)
    same = plan.same
    if plan.heavier is not None and plan.heavier.probability > (plan.probability or 0.0):
        plan = planned(tied.found, tied.bounds, added=plan.heavier.added_kg)
    took = time.process_time() - started
    following = _following(tied, plan.motion.t, plan.motion.omega, plan.added)
    return Settled(
        tied,
        plan.probability or 0.0,
        same,
        took,
        broken_limits(following, tied.bounds),
        _outcome(tied, following, plan.added),
        {
            name: _outcome(tied, _following(tied, *peer(tied.bounds, tied.seed)))
            for name, peer in PEERS.items()
        },
        plan.added,
    )


def _following(tied: Tied, t: np.ndarray, omega: np.ndarray, added: float = 0.0) -> Scenario:
    """The same rig, with a mass [kg] added, on a motion from where the mass hangs lowest, with other noise."""
    scenario = on_reference(tied.run.scenario, t, omega, 0.0)
    p = scenario.plant
    heavy = replace(p, M=p.M + added, J_l=p.J_l + added * p.L**2)
    # The bench plants these as fractions of the whole; what is wrong is the rig's own, not the added mass.
    own = {"mass_mismatch": p.M / heavy.M, "inertia_mismatch": p.inertia / heavy.inertia}
    effects = tuple(replace(e, amplitude=e.amplitude * own.get(e.family, 1.0)) for e in scenario.effects)
    return replace(scenario, plant=heavy, effects=effects)


def _outcome(tied: Tied, following: Scenario, added: float = 0.0) -> Outcome:
    new = simulate(following, again=True)
    rig = {**tied.run.rig, **({"added": {"table 2": f"{added!r} kg"}} if added else {})}
    both = diagnose([tied.run.columns, new.columns], rig).attribution
    return Outcome(both.verdict, tuple(a.variant.candidate.family for a in both.adopted), both.tied)


def random_fourier(bounds: Bounds, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A sum of five sines with random frequencies to 1.5 Hz, sizes and phases: time [s], speed [rad/s]."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, bounds.time, 0.005)
    frequency, phase = np.exp(rng.uniform(np.log(0.05), np.log(1.5), 5)), rng.uniform(-np.pi, np.pi, 5)
    size = rng.uniform(0.3, 1.0, 5)
    omega = size @ np.sin(2.0 * np.pi * np.outer(frequency, t) + phase[:, None])
    return t, _within(omega * np.clip(np.minimum(t, bounds.time - t), 0.0, 1.0), bounds)


def slow_sweep(bounds: Bounds, _: int) -> tuple[np.ndarray, np.ndarray]:
    """Up to the top speed and down, once in each direction, at a constant rate: time [s], speed [rad/s]."""
    t = np.arange(0.0, bounds.time, 0.005)
    return t, _within(np.interp(t / bounds.time, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0]), bounds)


PEERS: dict[str, Callable[[Bounds, int], tuple[np.ndarray, np.ndarray]]] = {
    "random Fourier": random_fourier,
    "slow sweep": slow_sweep,
}


def _within(omega: np.ndarray, bounds: Bounds) -> np.ndarray:
    steep = np.max(np.abs(np.gradient(omega, 0.005)))
    return omega * PEERS_KEEP * min(bounds.speed / np.max(np.abs(omega)), bounds.acceleration / steep)


def broken_limits(scenario: Scenario, bounds: Bounds) -> tuple[str, ...]:
    """What drives break whose mass, friction and speed loop are 10 % off, in turn both ways."""
    broken = []
    for mass, friction, loop in ((1.1, 1.1, 0.9), (0.9, 0.9, 1.1), (1.1, 0.9, 0.9), (0.9, 1.1, 1.1)):
        p, c = scenario.plant, scenario.controller
        p = replace(p, M=mass * p.M, M_l=mass * p.M_l, J_m=mass * p.J_m, J_l=mass * p.J_l)
        p = replace(
            p, C_m=friction * p.C_m, B_m=friction * p.B_m, C_lN=friction * p.C_lN, B_lN=friction * p.B_lN
        )
        off = replace(scenario, plant=p, controller=replace(c, kp=loop * c.kp, ki=loop * c.ki))
        columns = simulate(off, again=True).columns
        for name, limit in (("omega_m_rad_s", bounds.speed), ("current_A", bounds.current)):
            largest = float(np.max(np.abs(columns[name])))
            if largest > limit:
                broken.append(f"{name} {largest:.3g} of {limit:.3g}")
    return tuple(broken)


def measured(quick: bool, first: int = FIRST_SEED, logs: int = LOGS) -> Part:
    """Scan for tied logs, plan, and settle them."""
    found: list[Settled] = []
    failed: list[int] = []
    scanned, began = 0, time.process_time()
    for seed, tied in tied_logs(first, SECONDS):
        scanned += 1
        failed += [seed] if isinstance(tied, Exception) else []
        found += [settled(tied)] if isinstance(tied, Tied) else []
        progress(f"plans: {len(found)} tied logs to seed {seed}")
        if len(found) == (2 if quick else logs):
            break
    took = time.process_time() - began
    count = len(found)
    heavier = sum(one.added_kg > 0.0 for one in found)
    happened = sum(one.after.right(one.tied.truth) for one in found)
    stated = float(np.mean([one.probability for one in found]))
    broken = sum(bool(one.broken) for one in found)
    peers = ", ".join(
        f"{name} {sum(one.peers[name].right(one.tied.truth) for one in found)}/{count}" for name in PEERS
    )
    left = [one for one in found if not one.after.right(one.tied.truth)]
    same = sum(any(one.tied.truth in pair for pair in one.same) for one in left)
    figures = {
        "plan right": Measured(happened / count, f"{happened}/{count} = {happened / count:.2f}", peers),
        "plan stated": Measured(
            abs(stated - happened / count), f"{stated:.2f} stated, {happened / count:.2f} happened"
        ),
        "plan seconds": Measured(max(one.seconds for one in found)),
        "plan broken": Measured(broken, f"{broken} of {count}"),
    }
    return Part(
        figures,
        [
            *_HEAD,
            f"{scanned} logs were tried, {took / 60:.0f} min of processor time in all."
            f" {heavier} plans added half as much mass again to the link."
            f" Of the {len(left)} that the planned motion left open, the plan said of {same} that the true effect and"
            " another predict the same torque within the limits."
            + (f" `diagnose` failed on seeds {failed}." if failed else ""),
            "",
            *_table(found),
        ],
    )


_HEAD = [
    "Logs of 8 to 16 s at few speeds, with one effect of 3 to 12 % of friction, that end in a tie with the truth among"
    " the tied; the planned motion of at most a minute on the same rig; then `diagnose` with both logs.",
    "Limits: the top speed of the drive, the acceleration that reaches it in 0.3 s, and 1.3 times the current that this requires."
    " They are judged on the same drive with mass, friction and speed loop 10 % lower and higher.",
    "Peers are motions of the same length at three quarters of the limits of speed and acceleration.",
]


def _table(found: list[Settled]) -> list[str]:
    return [
        f"| seed | truth | tied | mass added [kg] | stated | after both logs | {' | '.join(PEERS)} | limits |",
        "|---" * (7 + len(PEERS)) + "|",
        *(
            f"| {s.tied.seed} | {s.tied.truth} | {', '.join(s.tied.found.attribution.tied)} | {s.added_kg:.2g} |"
            f" {s.probability:.2f} |"
            f" {s.after.words} | {' | '.join(one.words for one in s.peers.values())} |"
            f" {', '.join(s.broken) or 'kept'} |"
            for s in found
        ),
    ]


if __name__ == "__main__":
    logs, first = (int(x) for x in (sys.argv[1:3] + [str(LOGS), str(FIRST_SEED)][len(sys.argv[1:3]) :]))
    part = measured(quick=False, first=first, logs=logs)
    print(
        "\n".join([*(f"{k}: {m.text or m.value} ({m.peer})" for k, m in part.figures.items()), *part.details])
    )
