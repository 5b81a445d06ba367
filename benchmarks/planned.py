"""Do planned motions decide? Tied logs of the virtual bench, the planned motion on the same rig, both diagnosed.

Run: python benchmarks/planned.py [LOGS [FIRST_SEED]]
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks.record import Measured, Part, progress
from eccentric.diagnosis import diagnose
from eccentric.errors import InputError
from eccentric.planning import Bounds, Reference, planned
from eccentric.virtual_bench import EFFECTS, Scenario, random_scenario, simulate
from eccentric.virtual_bench.course import Course

FIRST_SEED = 300000
LOGS = 40
STRENGTHS = (0.01, 0.03, 0.08)
RATIOS = (1 / 30, 1 / 5, 1 / 2, 1.0)
SECONDS = 60.0


@dataclass(frozen=True)
class Follows(Course):
    """The course of a planned reference."""

    planned: Reference | None = field(default=None, compare=False)

    def reference(self, time: np.ndarray) -> np.ndarray:
        """The motor speed [rad/s] at `time` [s], shape (n,)."""
        if self.planned is None:
            raise ValueError("a planned reference is required")
        return np.interp(time, self.planned.t, self.planned.omega)


@dataclass(frozen=True)
class Settled:
    """A tied log, its plan, and what both logs together say."""

    seed: int
    truth: str
    tied: tuple[str, ...]
    probability: float
    seconds: float
    within: bool
    verdict: str
    named: tuple[str, ...]

    @property
    def right(self) -> bool:
        """Whether the true family, and no other, is named."""
        return self.verdict == "named" and set(self.named) == {self.truth}


def tied_logs(first: int) -> Iterator[tuple[int, Scenario]]:
    """Scenarios of single effects, one after another; which of them tie is not known yet."""
    families = [family for family in EFFECTS if "temperature" not in family]
    seed = first
    while True:
        rng = np.random.default_rng(seed)
        effect = str(rng.choice(families)), float(rng.choice(STRENGTHS))
        case, kind = str(rng.choice(["C1", "C2"])), str(rng.choice(["runs", "traj"]))
        mu, noise = float(rng.choice(RATIOS)), float(rng.choice([0.004, 0.008, 0.012]))
        # A case need not show every effect.
        with suppress(InputError):
            yield (
                seed,
                random_scenario(rng, case=case, mu=mu, log_type=kind, effects=[effect], noise=noise),
            )
        seed += 1


def settled(seed: int, scenario: Scenario) -> Settled | None:
    """The plan for a log and its outcome; None for a log that is not tied, or tied without the truth."""
    run = simulate(scenario)
    found = diagnose([run.columns], run.rig)
    truth = run.scenario.effects[0].family
    tied = found.attribution.tied
    if found.attribution.verdict != "not_identifiable" or truth not in tied:
        return None
    speed = float(np.max(np.abs(run.columns["omega_m_rad_s"])))
    reference = scenario.course.reference(np.arange(0.0, scenario.course.seconds, 0.004))
    steep = 1.2 * float(np.max(np.abs(np.gradient(reference, 0.004))))
    current = 1.3 * float(np.max(np.abs(run.columns["current_A"])))
    started = time.process_time()
    plan = planned(found, Bounds(speed, steep, current, SECONDS))
    took = time.process_time() - started
    starts = (5.0, 17.0, 29.0, 41.0, 52.0)
    course = Follows(
        "traj",
        round(plan.motion.seconds, 2),
        tuple((a, a + 2.4) for a in starts if a + 2.4 < plan.motion.seconds),
        (0.0,),
        planned=plan.motion,
    )
    following = replace(run.scenario, course=course, seed=run.scenario.seed + 1)
    new = simulate(following, again=True)
    both = diagnose([run.columns, new.columns], run.rig)
    return Settled(
        seed,
        truth,
        tied,
        plan.probability or 0.0,
        took,
        _within(following, speed, current),
        both.attribution.verdict,
        tuple(a.variant.candidate.family for a in both.attribution.adopted),
    )


def _within(scenario: Scenario, speed: float, current: float) -> bool:
    """Whether drives whose friction and inertia are 10 % off keep the limits of speed and current."""
    plant = scenario.plant
    for factor in (0.9, 1.1):
        off = replace(
            plant,
            J_m=factor * plant.J_m,
            J_l=factor * plant.J_l,
            C_m=factor * plant.C_m,
            B_m=factor * plant.B_m,
            C_lN=factor * plant.C_lN,
            B_lN=factor * plant.B_lN,
        )
        columns = simulate(replace(scenario, plant=off), again=True).columns
        if np.max(np.abs(columns["omega_m_rad_s"])) > speed or np.max(np.abs(columns["current_A"])) > current:
            return False
    return True


def measured(quick: bool, first: int = FIRST_SEED, logs: int = LOGS) -> Part:
    """Scan for tied logs, plan, and settle them."""
    found: list[Settled] = []
    for seed, scenario in tied_logs(first):
        one = settled(seed, scenario)
        found += [one] if one else []
        progress(f"plans: {len(found)} tied logs to seed {seed}")
        if len(found) == (2 if quick else logs):
            break
    count = len(found)
    right, stated = sum(one.right for one in found), float(np.mean([one.probability for one in found]))
    slowest = max(one.seconds for one in found)
    broken = sum(not one.within for one in found)
    figures = {
        "plan right": Measured(right / count, f"{right}/{count} = {right / count:.2f}"),
        "plan stated": Measured(
            abs(stated - right / count), f"{stated:.2f} stated, {right / count:.2f} happened"
        ),
        "plan seconds": Measured(slowest),
        "plan broken": Measured(broken, f"{broken} of {count}"),
    }
    return Part(figures, [*_HEAD, "", *_table(found)])


_HEAD = [
    "Logs of single effects, 1 to 8 % of friction, that end in a tie with the truth among the tied; the planned"
    " motion of at most a minute on the same rig, with the limits of the first log's speed, 1.2 times its"
    " acceleration and 1.3 times its current; then `diagnose` with both logs.",
    "Limits are judged on the same drive with friction and inertia 10 % lower and higher.",
]


def _table(found: list[Settled]) -> list[str]:
    return [
        "| seed | truth | tied | stated | after both logs | limits kept |",
        "|---" * 6 + "|",
        *(
            f"| {s.seed} | {s.truth} | {', '.join(s.tied)} | {s.probability:.2f} |"
            f" {s.verdict} {', '.join(s.named)} | {'yes' if s.within else 'no'} |"
            for s in found
        ),
    ]


if __name__ == "__main__":
    logs, first = (int(x) for x in (sys.argv[1:3] + [str(LOGS), str(FIRST_SEED)][len(sys.argv[1:3]) :]))
    part = measured(quick=False, first=first, logs=logs)
    print("\n".join([*(f"{k}: {m.text or m.value}" for k, m in part.figures.items()), *part.details]))
