"""The emitted compensation in a loop, beside what people write by hand: 200 virtual drives with real stiction.

The drives are case C2 with random parameters, an encoder with noise, a filter of the speed and a delay. Their
friction is set-valued: a step of 50 us solves for the velocity with the levels at its start (Moreau), so that
a drive at rest is at rest. In half of them static friction is above kinetic, in a quarter friction builds up
over a distance. All of this is written here once more and shares no code with the model; the compensation is
the emitted C. What the controller knows of the friction is off by the uncertainty of an identification.
"""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import eccentric
from benchmarks.record import Measured, Part, progress
from eccentric.emission import sure_share

MANUAL = Path(__file__).resolve().parent.parent / "docs" / "in-the-loop.md"
TICK, STEPS = 1e-3, 20
TASKS = ("hold", "sine", "creep", "point to point")
HOLD, SINE, CREEP, POINT = range(4)
LAST = 2000
"""Samples at the end of a hold over which a limit cycle is looked for."""
NAMES = ("B_lN", "C_lN", "B_m", "C_m")


class Drives:
    """Random drives (n,), what is known of them, and their loops.

    Attributes:
        known, true: the coefficients NAMES (4, n).
        gain: the share of the known friction that is there with 97.5 %.
        premise: whether the true friction is above this share at every identified state.
    """

    def __init__(self, n: int, seed: int = 48) -> None:
        random = np.random.default_rng(seed)

        def uniform(low: float, high: float) -> np.ndarray:
            return random.uniform(low, high, n)

        self.n = n
        self.M, self.M_l, self.L = uniform(0.3, 0.7), uniform(0.1, 0.3), uniform(0.15, 0.35)
        self.mu, self.g = random.choice([0.1, 0.2, 1 / 3], n), 9.81
        self.J = uniform(1e-4, 4e-4) + self.mu**2 * self.L**2 * (self.M + self.M_l / 3)
        table = np.array([0.004, 0.08, 4e-4, 0.008])[:, None]
        self.known = table * np.exp(random.normal(0, 0.35, (4, n)))
        self.true, self.gain, self.premise = np.empty((4, n)), np.empty(n), np.empty(n, bool)
        worst = uniform(0.01, 0.06)  # standard deviation of the friction where it is known worst
        for k in range(n):
            self._identify(k, worst[k], random)
        self.static = np.where(np.arange(n) % 2 == 0, 1.0, uniform(1.05, 1.5))
        self.fall = uniform(0.2, 2.0)  # speed over which static friction falls to kinetic [rad/s]
        self.presliding, self.bend = np.arange(n) % 4 == 1, uniform(0.3, 2.0) * np.pi * 1e-3
        self.step = 2 * np.pi / 2.0 ** random.integers(10, 17, n)  # of the encoder [rad]
        self.noise = uniform(0.0, 0.5)  # of the encoder, in steps
        self.delay = random.integers(1, 4, n)  # of the torque, in ticks
        self.cutoff = random.choice([50.0, 100.0, 200.0], n)  # of the speed's filter [Hz]
        # A loop as fast as its delays allow: speed, and position a quarter of it.
        lag = self.delay * TICK + 1.5e-3 + 1 / (2 * np.pi * self.cutoff)
        self.bandwidth = 2 * np.pi * np.minimum(12.0, 1 / (8 * np.pi * lag))
        self.stiffness = self.bandwidth / 4
        zero = np.zeros(n)
        self.level = self.budget(zero, zero, self.known)[0]
        self.spring = self.budget(zero, zero, self.true)[0] / self.bend
        self.spring_damping = 1.4 * np.sqrt(self.spring * self.J)

    def _rows(self, k: int, theta: np.ndarray, w: np.ndarray) -> np.ndarray:
        force, mu = self.load(theta, w, k), self.mu[k]
        return np.stack([force * mu**2 * w, force * mu, w, np.ones_like(w)], axis=1)

    def _identify(self, k: int, worst: float, random: np.random.Generator) -> None:
        """What a log of random motion tells of the friction, and the truth that is as far from it as it may."""
        turn = 2 * np.pi / self.mu[k]
        seen = self._rows(k, random.uniform(0, turn, 400), random.uniform(0.5, 40, 400))
        grid = np.meshgrid(np.linspace(0, turn, 24, endpoint=False), np.geomspace(0.5, 40, 10))
        rows = self._rows(k, *(x.ravel() for x in grid))
        covariance, known = np.linalg.inv(seen.T @ seen), self.known[:, k]
        share = np.sqrt(np.einsum("ij,jk,ik->i", rows, covariance, rows)) / (rows @ known)
        covariance *= (worst / share.max()) ** 2
        self.gain[k] = sure_share(rows, known, covariance)
        self.true[:, k] = np.maximum(random.multivariate_normal(known, covariance), 0.0)
        self.premise[k] = np.min(rows @ self.true[:, k] / (rows @ known)) >= self.gain[k]

    def load(self, theta: np.ndarray, w: np.ndarray, k: Any = slice(None)) -> np.ndarray:
        """The normal force at the bearing [N], the paper's (16)."""
        pull, weight = self.M[k] * self.L[k] * (self.mu[k] * w) ** 2, (self.M[k] + self.M_l[k]) * self.g
        along, across = pull + weight * np.cos(self.mu[k] * theta), weight * np.sin(self.mu[k] * theta)
        return np.hypot(along, across)

    def budget(self, theta: np.ndarray, w: np.ndarray, of: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Level of Coulomb friction [N m] and viscous coefficient [N m s/rad]."""
        force = self.load(theta, w)
        return self.mu * of[1] * force + of[3], self.mu**2 * of[0] * force + of[2]

    def gravity(self, theta: np.ndarray) -> np.ndarray:
        """The gravity torque [N m]."""
        return self.mu * self.M * self.g * self.L * np.sin(self.mu * theta)

    def moved(self, theta: Any, w: Any, z: Any, applied: Any, of: Any = None) -> tuple[Any, Any, Any]:
        """Angle, velocity and bending of the contact after a tick under a torque; its friction is `of`."""
        h, of = TICK / STEPS, self.true if of is None else of
        for _ in range(STEPS):
            level, viscous = self.budget(theta, w, of)
            level = level * (1 + (self.static - 1) * np.exp(-((w / self.fall) ** 2)))
            momentum = self.J * w + h * (applied - self.gravity(theta))
            sliding = np.sign(momentum) * np.maximum(np.abs(momentum) - h * level, 0.0)
            rigid = sliding / (self.J + h * viscous)
            stiff = self.J + h * viscous + h * h * self.spring + h * self.spring_damping
            bent = (momentum - h * self.spring * z) / stiff
            force = self.spring * (z + h * bent) + self.spring_damping * bent
            slips = np.abs(force) > level
            slid = (momentum - h * np.sign(force) * level) / (self.J + h * viscous)
            elastic = np.where(slips, slid, bent)
            z = np.where(slips, np.sign(force) * level / self.spring, z + h * elastic)
            w = np.where(self.presliding, elastic, rigid)
            theta = theta + h * w
        return theta, w, z


# The references.


def references(seconds: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle, velocity and acceleration of every task (samples, tasks)."""
    t = np.arange(round(seconds / TICK)) * TICK
    rate = np.pi  # of the sine [rad/s]
    ramp = np.minimum(t / 0.5, 1.0)
    move, dwell, size = 0.8, 0.7, 3.0
    phase = t % (2 * (move + dwell))
    back = phase >= move + dwell
    x = np.clip((phase - back * (move + dwell)) / move, 0.0, 1.0)
    way = 10 * x**3 - 15 * x**4 + 6 * x**5
    sign = np.where(back, -size, size)
    zero = np.zeros_like(t)
    return (
        np.stack([zero + 1.0, 3 / rate * (1 - np.cos(rate * t)), 0.3 * np.cumsum(ramp) * TICK,
                  size * back + sign * way], 1),
        np.stack([zero, 3 * np.sin(rate * t), 0.3 * ramp, sign * (30 * x**2 - 60 * x**3 + 30 * x**4) / move], 1),
        np.stack([zero, 3 * rate * np.cos(rate * t), np.where(t < 0.5, 0.6, 0.0),
                  sign * (60 * x - 180 * x**2 + 120 * x**3) / move**2], 1),
    )  # fmt: skip


# The laws: each adds a torque, from what a loop has in a sample.


@dataclass
class Sample:
    """What a law sees; arrays (tasks, drives)."""

    theta_ref: Any
    omega_ref: Any
    theta: Any
    omega: Any
    slow: Any
    error: Any
    demand: Any
    observed: Any


Law = Callable[[Sample], Any]


def by_hand(d: Drives) -> dict[str, Law]:
    """What people write: the sign of a velocity, softened or not, times the friction that is known."""

    def friction(theta: Any, w: Any, direction: Any) -> Any:
        level, viscous = d.budget(theta, w, d.known)
        return direction * level + viscous * w

    return {
        "no compensation": lambda s: 0.0 * s.theta,
        "sign of the measured velocity": lambda s: friction(s.theta, s.omega, np.sign(s.omega)),
        "sign of the filtered velocity": lambda s: friction(s.theta, s.slow, np.sign(s.slow)),
        "sign of the reference velocity": lambda s: friction(s.theta_ref, s.omega_ref, np.sign(s.omega_ref)),
        "tanh(w/3) of the measured velocity": lambda s: friction(s.theta, s.omega, np.tanh(s.omega / 3)),
        "dead band of 2 rad/s": lambda s: np.where(
            np.abs(s.omega) > 2, friction(s.theta, s.omega, np.sign(s.omega)), 0.0
        ),
        "disturbance observer": lambda s: s.observed,
    }


_HARNESS = """#include "c2_parallel_compensation.h"
static c2_parallel_compensation_settings settings[@N@];
static c2_parallel_coefficients coefficients[@N@];

int set(int k, const double *x, unsigned velocity, unsigned push)
{
    c2_parallel_parameters p = c2_parallel_default_parameters;
    c2_parallel_compensation_settings *s = &settings[k];
    p.M = x[0]; p.M_l = x[1]; p.L = x[2]; p.mu = x[3];
    p.B_lN = x[4]; p.C_lN = x[5]; p.B_m = x[6]; p.C_m = x[7];
    *s = c2_parallel_compensation_default;
    s->velocity = velocity; s->push = push;
    s->gain = x[8]; s->encoder_step = x[9]; s->band = x[10]; s->push_width = x[11];
    return c2_parallel_prepare(&p, &coefficients[k]) + 100 * c2_parallel_compensation_prepare(&p, s);
}

void compensate(int n, const double *theta, const double *omega_ref, const double *omega_m, const double *error,
                const double *torque, double *out)
{
    for (int k = 0; k < n; ++k) {
        out[k] = c2_parallel_compensation(theta[k], omega_ref[k], omega_m[k], error[k], torque[k],
                                          &settings[k % @N@], &coefficients[k % @N@]);
    }
}
"""
REFERENCE, MEASURED = 1, 2
NO_PUSH, BY_ERROR, BY_DEMAND = 0, 1, 2


def emitted(d: Drives, folder: Path, velocity: int, push: int) -> Law:
    """The emitted C, a set of coefficients and settings for each drive."""
    out, name = folder / "emitted", f"loop_{velocity}_{push}"
    if not out.exists():
        eccentric.emit("c2_parallel", out, compensation=True)
    source = folder / f"{name}.c"
    source.write_text(_HARNESS.replace("@N@", str(d.n)), encoding="utf-8")
    sources = [source, out / "c2_parallel.c", out / "c2_parallel_compensation.c"]
    library = folder / f"{name}.so"
    subprocess.run(["gcc", "-O2", "-shared", "-fPIC", f"-I{out}", "-o", library, *sources, "-lm"], check=True)
    c = ctypes.CDLL(str(library))
    gain = d.gain if velocity == REFERENCE else np.minimum(d.gain, 0.9)
    # As stiff as the loop itself twice over, and twenty steps of the encoder wide at least.
    width = np.maximum(gain * d.level / (2 * d.J * d.bandwidth * d.stiffness), 20 * d.step)
    if push == BY_DEMAND:
        width = 0.1 * d.level
    columns = np.stack([d.M, d.M_l, d.L, d.mu, *d.known, gain, d.step, d.step / TICK, width], axis=1)
    for k, row in enumerate(np.ascontiguousarray(columns)):
        assert c.set(k, row.ctypes.data_as(ctypes.c_void_p), velocity, push) == 0

    def law(s: Sample) -> Any:
        given = [s.theta_ref, s.omega_ref, s.omega, s.error, s.demand]
        arrays = [np.ascontiguousarray(np.broadcast_to(x, s.theta.shape), float) for x in given]
        found = np.empty(s.theta.shape)
        c.compensate(found.size, *(x.ctypes.data_as(ctypes.c_void_p) for x in (*arrays, found)))
        return found

    return law


# The loop.


def run(d: Drives, laws: Mapping[str, Law], seconds: float, integral: bool) -> tuple[np.ndarray, np.ndarray]:
    """Angle and torque (samples, laws, tasks, drives) of a speed loop within a position loop.

    What inertia and gravity need is fed forward. With `integral` the speed loop has a part that adds up, as
    in most servo drives; without, it is a spring and a damper.
    """
    theta_ref, omega_ref, alpha_ref = references(seconds)
    shape = (len(laws), len(TASKS), d.n)
    random = np.random.default_rng(1)
    theta, w, z, added, omega, slow, observed = (np.zeros(shape) for _ in range(7))
    theta[:, HOLD] = theta_ref[0, HOLD] - 0.05  # it is let go there
    sent = np.zeros((4, *shape))
    last = before = None
    quick, slowly = (1 - np.exp(-2 * np.pi * f * TICK) for f in (d.cutoff, 10.0))
    proportional = d.J * d.bandwidth
    adding = proportional * d.bandwidth / 5 * TICK if integral else 0.0
    angles, torques = (np.empty((len(theta_ref), *shape), np.float32) for _ in range(2))
    for i in range(len(theta_ref)):
        read = (np.floor(theta / d.step + random.normal(0, 1, d.n) * d.noise) + 0.5) * d.step
        raw = (read - (read if last is None else last)) / TICK
        last, before = read, omega
        omega = omega + quick * (raw - omega)
        slow = slow + slowly * (raw - slow)
        ref, speed, alpha = (
            np.broadcast_to(x[i][:, None], shape[1:]) for x in (theta_ref, omega_ref, alpha_ref)
        )
        behind = speed + d.stiffness * (ref - read) - omega
        added = added + adding * behind
        demand = proportional * behind + added + d.J * alpha + d.gravity(ref)
        # What was applied, less inertia and gravity, is friction: low-passed.
        unexplained = sent[0] - d.J * (omega - before) / TICK - d.gravity(read)
        observed = observed + 0.05 * (unexplained - observed)
        torque = demand.copy()
        for k, law in enumerate(laws.values()):
            torque[k] += law(
                Sample(ref, speed, read[k], omega[k], slow[k], ref - read[k], demand[k], observed[k])
            )
        applied = np.where(d.delay == 1, sent[3], np.where(d.delay == 2, sent[2], sent[1]))
        sent = np.concatenate((sent[1:], torque[None]))
        theta, w, z = d.moved(theta, w, z, applied)
        angles[i], torques[i] = theta, torque
    return angles, torques


def torque_mode(d: Drives, laws: Mapping[str, Law], seconds: float) -> np.ndarray:
    """The largest speed of the second half over the speed at the start (laws, drives), of a drive let go.

    Its friction is that of the model over 1.1; nothing is demanded but what gravity needs.
    """
    shape = (len(laws), 1, d.n)
    random = np.random.default_rng(2)
    theta, z, omega, slow = (np.zeros(shape) for _ in range(4))
    w, start = np.full(shape, 5.0), 5.0
    sent = np.zeros((4, *shape))
    last, fastest = theta, np.zeros(shape)
    quick, slowly = (1 - np.exp(-2 * np.pi * f * TICK) for f in (d.cutoff, 10.0))
    count = round(seconds / TICK)
    for i in range(count):
        read = (np.floor(theta / d.step + random.normal(0, 1, d.n) * d.noise) + 0.5) * d.step
        raw, last = (read - last) / TICK, read
        omega, slow = omega + quick * (raw - omega), slow + slowly * (raw - slow)
        torque = d.gravity(read)
        zero = np.zeros(shape[1:])
        for k, law in enumerate(laws.values()):
            torque[k] = torque[k] + law(Sample(read[k], zero, read[k], omega[k], slow[k], zero, zero, zero))
        applied = np.where(d.delay == 1, sent[3], np.where(d.delay == 2, sent[2], sent[1]))
        sent = np.concatenate((sent[1:], torque[None]))
        with np.errstate(all="ignore"):  # what runs away ends as no number
            theta, w, z = d.moved(theta, np.clip(w, -1e3, 1e3), z, applied, d.known / 1.1)
        if i > count / 2:
            fastest = np.maximum(fastest, np.abs(w))
    return fastest[:, 0] / start


# What comes out.


@dataclass(frozen=True)
class Row:
    """Of one law: limit cycles, and motion that only goes one way (drives,); chatter, errors (tasks, drives)."""

    name: str
    cycles: np.ndarray
    one_way: np.ndarray
    chatter: np.ndarray
    errors: np.ndarray


def judged(d: Drives, laws: Sequence[str], angles: np.ndarray, torques: np.ndarray) -> list[Row]:
    """Limit cycles (drives,), chatter over the Coulomb level and tracking error (tasks, drives), by law."""
    held = angles[-LAST:, :, HOLD]
    swing, gone = np.ptp(held, axis=0), np.abs(held[-1] - held[0])
    wanted = references(len(angles) * TICK)[0]
    rows = []
    for k, name in enumerate(laws):
        errors = np.stack([
            np.sqrt(np.mean((angles[1000:, k, j] - wanted[1000:, j, None]) ** 2, axis=0)) for j in range(4)
        ])  # fmt: skip
        changes = [np.diff(torques[-LAST:, k, j], axis=0) for j in range(4)]
        chatter = np.stack([np.sqrt(np.mean(x**2, axis=0)) for x in changes]) / d.level
        rows.append(Row(name, swing[k] > swing[0] + 2 * d.step, gone[k] > 0.8 * swing[k], chatter, errors))
    return rows


OURS = "emitted, from the reference"
PUSHED = "the same, pushed at rest by the error"


def measured(quick: bool) -> Part:
    """Limit cycles, chatter and tracking error of every law, and the drive that is let go."""
    d = Drives(40 if quick else 200)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        laws = by_hand(d)
        ours = emitted(d, folder, REFERENCE, NO_PUSH)
        progress("loops: with integral action")
        seconds = 4.0 if quick else 8.0
        pushed = emitted(d, folder, REFERENCE, BY_ERROR)
        servo = {**laws, OURS: ours, PUSHED: pushed}
        rows = judged(d, list(servo), *run(d, servo, seconds, integral=True))
        progress("loops: without integral action")
        soft = {**laws, OURS: ours, PUSHED: pushed}
        others = judged(d, list(soft), *run(d, soft, seconds, integral=False))
        progress("loops: torque mode")
        free = {
            "sign of the measured velocity": laws["sign of the measured velocity"],
            "tanh(w/3) of the measured velocity": laws["tanh(w/3) of the measured velocity"],
            "emitted, from the measured velocity": emitted(d, folder, MEASURED, BY_DEMAND),
        }
        let_go = torque_mode(d, free, 4.0 if quick else 10.0)
    details = _details(d, rows, others, free, let_go)
    if not quick:
        write_manual(details)
    return Part(_figures(d, rows, others, let_go), details)


def write_manual(details: Sequence[str]) -> None:
    """Put the tables into the manual."""
    text = MANUAL.read_text(encoding="utf-8")
    begin, end = (f"<!-- loops: {x} -->" for x in ("begin", "end"))
    before, after = text.split(begin)[0], text.split(end)[1]
    MANUAL.write_text("\n".join([before + begin, *details, end + after]), encoding="utf-8")


def _best(d: Drives, rows: Sequence[Row], task: int) -> tuple[str, float]:
    """The peer without a limit cycle that tracks best: its name and its median error."""
    peers = [r for r in rows if r.name not in (OURS, PUSHED) and not (r.cycles & d.premise).any()]
    best = min(peers, key=lambda r: np.median(r.errors[task]))
    return best.name, float(np.median(best.errors[task]))


def _figures(d: Drives, rows: list[Row], others: list[Row], let_go: np.ndarray) -> dict[str, Measured]:
    by = {r.name: r for r in rows}
    ours, none = by[OURS], rows[0]
    # As the manual advises: no push where the loop has integral action.
    advised = (ours, *(r for r in others if r.name in (OURS, PUSHED)))
    cycles, beyond = (sum(int((r.cycles & x).sum()) for r in advised) for x in (d.premise, ~d.premise))
    hand = (r for r in rows[1:] if r.name not in (OURS, PUSHED))
    peers = ", ".join(f"{int((r.cycles & d.premise).sum())}" for r in hand)
    chatter = 100 * max(float(np.max(np.median(ours.chatter - none.chatter, axis=1))), 0.0)
    worst = 100 * float(np.max((ours.chatter - none.chatter)[HOLD]))
    ratios = {}
    for task, name in enumerate(TASKS):
        peer, error = _best(d, rows, task)
        ratios[name] = (float(np.median(ours.errors[task])) / error, peer)
    slowest = max(ratios, key=lambda x: ratios[x][0])
    to_none = {
        task: float(np.median(ours.errors[task]) / np.median(none.errors[task])) for task in (SINE, POINT)
    }
    return {
        "loop cycles": Measured(cycles, f"{cycles}; {beyond} beyond the premise", f"by hand: {peers}"),
        "loop chatter": Measured(worst, f"{worst:.2f} %"),
        "loop steps": Measured(chatter, f"{chatter:.2f} %"),
        "loop tracking": Measured(
            ratios[slowest][0], f"{ratios[slowest][0]:.2f}, {slowest}", ratios[slowest][1]
        ),
        "loop sine": Measured(to_none[SINE]),
        "loop point": Measured(to_none[POINT]),
        "loop torque mode": Measured(
            int((~(let_go[-1] <= 1.0)).sum()),
            "",
            f"sign of the measured velocity: {int((~(let_go[0] <= 1.0)).sum())}",
        ),
    }


def _details(
    d: Drives, rows: list[Row], others: list[Row], free: Mapping[str, Law], let_go: np.ndarray
) -> list[str]:
    head = "| law | limit cycles | chatter at rest | " + " | ".join(TASKS) + " |"
    lines = [
        f"{d.n} drives; the true friction is above gain times the model's at every identified state in"
        f" {int(d.premise.sum())} of them; gain {np.median(d.gain):.3f} (median).",
        "Limit cycles: the number of drives that, in the last 2 s of a hold, swing by over two counts more than"
        " without compensation (in brackets, those whose true friction does not exceed the compensation). Chatter: the"
        " rms change of the torque from one sample to the next during that time, relative to the Coulomb level. The"
        " other columns are rms tracking errors in mrad. Chatter and errors are medians.",
        "",
    ]
    for title, table in (
        ("Position loop around a speed loop with integral action:", rows),
        ("The same without integral action:", others),
    ):
        lines += [title, "", head, "|---|" + "--:|" * (2 + len(TASKS))]
        for r in table:
            errors = " | ".join(f"{1e3 * x:.2f}" for x in np.median(r.errors, axis=1))
            inside, outside = int((r.cycles & d.premise).sum()), int((r.cycles & ~d.premise).sum())
            lines.append(
                f"| {r.name} | {inside} ({outside}) | {100 * np.median(r.chatter[HOLD]):.2f} % | {errors} |"
            )
        lines.append("")
    creeping = [
        f"{int((r.cycles & r.one_way).sum())} of {int(r.cycles.sum())} {where} ({r.name})"
        for table, where in ((rows, "with integral action"), (others, "without"))
        for r in table
        if r.name in (OURS, PUSHED) and r.cycles.any()
    ]
    if creeping:
        lines += [
            "Some limit cycles are only a creep towards the reference, in one direction: "
            + ", ".join(creeping)
            + ".",
            "",
        ]
    lines += [
        "Torque mode: a drive is released at 5 rad/s, with the friction of the model divided by 1.1. Number of"
        " drives that speed up:",
        "",
        *(f"- {name}: {int((~(x <= 1.0)).sum())}" for name, x in zip(free, let_go, strict=True)),
    ]
    return lines
