"""Scenarios: an arm, its drives, its course, its friction and effects, the seed of its noise."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, log, pi

import numpy as np

from eccentric.virtual_bench.arms.effects import JointEffect, effect_requests, planted
from eccentric.virtual_bench.arms.plant import BenchArm, BenchLink, JointFriction, Survey, Vector, survey
from eccentric.virtual_bench.arms.trajectory import ArmCourse, ArmServo, harmonic_course, sweep_course
from eccentric.virtual_bench.effects import Requested, check_values
from eccentric.virtual_bench.plant import rms

KINDS = ("2r", "3", "6")
_RIGHT = pi / 2.0
# Rolls of the joint frames: a robot with three parallel axes, and one with a spherical wrist.
_TWISTS = {
    "3": ((0.0, -_RIGHT, 0.0), (0.0, -_RIGHT, _RIGHT)),
    "6": ((0.0, -_RIGHT, 0.0, 0.0, -_RIGHT, _RIGHT), (0.0, -_RIGHT, 0.0, -_RIGHT, _RIGHT, -_RIGHT)),
}
_MASSES = {"3": (5.0, 3.0, 2.2), "6": (7.0, 7.0, 4.0, 2.0, 1.6, 1.2)}


def random_arm(rng: np.random.Generator, kind: str) -> BenchArm:
    """Draw an arm without friction; `kind` is one of `KINDS`. Rotor inertias and motors are drawn last."""
    return _planar(rng) if kind == "2r" else _spatial(rng, kind)


def _planar(rng: np.random.Generator) -> BenchArm:
    """Two tubes swinging about horizontal axes, a drive at the elbow, a weight at the tip; hanging at 0."""
    lengths, tubes = rng.uniform(0.24, 0.36, 2), rng.uniform(0.3, 0.6, 2)
    ends = rng.uniform(0.4, 0.9), rng.uniform(0.3, 0.8)  # elbow drive, weight
    links, place = [], (0.0, 0.0, 0.0)
    for length, tube, end in zip(lengths, tubes, ends, strict=True):
        along = np.array([0.0, -1.0, 0.0])
        bodies = [(tube, 0.5 * length * along, tube * length**2 / 12.0), (end, length * along, 0.0)]
        links.append(_link(place, (0.0, 0.0, 0.0), bodies, _ratio(rng, 6.0, 30.0)))
        place = (0.0, -round(float(length), 4), 0.0)
    return BenchArm("bench_2r", tuple(links), (0.0, -9.81, 0.0))


def _spatial(rng: np.random.Generator, kind: str) -> BenchArm:
    """A column, an upper arm and a forearm along x, and a wrist; each link is a tube with lumped masses."""
    twists = _TWISTS[kind][int(rng.integers(2))]
    n, links = len(twists), []
    place = np.array([0.0, 0.0, rng.uniform(0.1, 0.2)])
    for j in range(n):
        long = j in {1, 2}
        reach = rng.uniform(0.24, 0.42) if long else rng.uniform(0.07, 0.12)
        aside = rng.uniform(-0.06, 0.06)
        end = np.array([reach, 0.0, aside]) if long else np.array([0.0, 0.5 * aside, reach])
        mass = _MASSES[kind][j] * rng.uniform(0.8, 1.25)
        lumps = rng.normal(size=(4, 3)) * 0.03 + rng.uniform(0.0, 1.0, (4, 1)) * end
        bodies = [(0.1 * mass, lump, 1e-4) for lump in lumps]
        bodies += [(0.6 * mass, 0.5 * end, 0.6 * mass * float(end @ end) / 12.0)]
        if j == n - 1:
            bodies += [(rng.uniform(0.5, 2.0), end + np.array([0.0, 0.0, 0.05]), 1e-3)]
        turn = (twists[j], 0.0, round(float(rng.uniform(-0.2, 0.2)), 4) if j else 0.0)
        links.append(_link(place, turn, bodies, _ratio(rng, 30.0, 120.0)))
        place = end
    return BenchArm(f"bench_{n}r", tuple(links))


def _ratio(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a catalogue gear ratio: one over an integer."""
    return 1.0 / round(float(np.exp(rng.uniform(np.log(low), np.log(high)))))


def _link(
    position: object, rpy: Vector, bodies: list[tuple[float, np.ndarray, float]], mu: float
) -> BenchLink:
    """Combine spheres, each with mass, position and inertia, into a link; rounded as in a drawing."""
    mass = sum(m for m, _, _ in bodies)
    centre = np.round(sum(m * p for m, p, _ in bodies) / mass, 5)
    tensor = np.zeros((3, 3))
    for m, place, own in bodies:
        d = place - centre
        tensor += m * (float(d @ d) * np.eye(3) - np.outer(d, d)) + own * np.eye(3)
    six = (tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2])
    x, y, z = (round(float(value), 4) for value in np.asarray(position))
    cx, cy, cz = (float(value) for value in centre)
    xx, yy, zz, xy, xz, yz = (round(float(value), 7) for value in six)
    return BenchLink(
        (x, y, z),
        rpy,
        (0.0, 0.0, 1.0),
        round(float(mass), 4),
        (cx, cy, cz),
        (xx, yy, zz, xy, xz, yz),
        mu,
        0.0,
        1.0,
    )


LOG_TYPES = ("traj", "runs")
MEASURED = ("current", "torque")
RATES = (250, 500)
_STEP_S = 1e-3
"""Longest step of the integration."""


@dataclass(frozen=True)
class ArmScenario:
    """A complete test of an arm, input of `simulate_arm`.

    Attributes:
        effects: effects beyond its friction, each in one joint.
        noise: of each current, over its peak.
        measured: the logged drive signal: "current", or the joints' "torque", current times k_i/mu.
    """

    arm: BenchArm
    servo: ArmServo
    course: ArmCourse
    effects: tuple[JointEffect, ...]
    noise: float
    measured: str
    seed: int
    sample_rate_hz: int = 250
    name: str = "bench"

    @property
    def steps_per_sample(self) -> int:
        """Steps of the integration from one sample to the next."""
        return round(1.0 / (self.sample_rate_hz * _STEP_S))


def random_arm_scenario(
    rng: np.random.Generator,
    *,
    arm: str = "2r",
    effects: Requested = (),
    log_type: str = "traj",
    runs: int = 5,
    seconds: float = 60.0,
    noise: float = 0.01,
    measured: str = "current",
    sample_rate_hz: int = 250,
) -> ArmScenario:
    """Draw an arm with drives and friction, a course, and shapes of effects.

    The same state of `rng` gives the same arm and course, whatever the effects.

    Args:
        rng: random generator.
        arm: "2r" (two links in a vertical plane, a weight at the tip), "3" or "6" joints in space.
        effects: families, each with its joint and strength if wanted: "stribeck", "stribeck@2",
            ("stribeck@2", 0.1). The strength is the effect's rms over that of the joint's friction (0.15);
            without a joint, one is drawn.
        log_type: "traj", sums of harmonics, or "runs", constant velocities.
        runs: of equal length, each from rest; 3 to 20.
        seconds: length of all runs together, 15 to 3600.
        noise: of each current over its largest value, at most 0.5.
        measured: "current", or "torque" of the joints.
        sample_rate_hz: 250 or 500.

    Raises:
        InputError: a value is out of range, an effect or a joint is unknown, or MuJoCo is not installed.
    """
    check_values(
        {"arm": (arm, KINDS), "log type": (log_type, LOG_TYPES), "measured": (measured, MEASURED),
         "sample rate [Hz]": (sample_rate_hz, RATES)},
        {"runs": (runs, 3, 20), "seconds": (seconds, 15.0, 3600.0), "noise": (noise, 0.0, 0.5)},
    )  # fmt: skip
    requests = effect_requests(effects, joints=2 if arm == "2r" else int(arm))
    bare = random_arm(rng, arm)
    course = _course(rng, arm, log_type, int(runs), seconds)
    driven = _with_drives(rng, bare, survey(bare, course))
    rows = survey(driven, course)
    complete = _with_friction(rng, driven, rows)
    servo = _servo(rng, complete, rows)
    seed = int(rng.integers(2**32))
    built = tuple(planted(rng, complete, course, rows, request) for request in requests)
    return ArmScenario(complete, servo, course, built, noise, measured, seed, sample_rate_hz)


def _course(rng: np.random.Generator, arm: str, log_type: str, runs: int, seconds: float) -> ArmCourse:
    if arm == "2r":
        home, reach, top = rng.uniform(-0.8, 0.8, 2), np.array([2.8, 2.8]), rng.uniform(4.0, 6.5, 2)
    else:
        n = int(arm)
        # The upper arm points up by about a radian, the elbow bends back: not straight, not folded.
        home = np.array([0.0, -1.0, 1.2, -0.6, 0.3, 0.0])[:n] + rng.uniform(-0.3, 0.3, n)
        reach = np.array([2.4, 1.1, 1.5, 2.2, 2.2, 2.6])[:n]
        top = np.array([1.8, 1.4, 1.8, 2.4, 2.4, 3.0])[:n] * rng.uniform(0.85, 1.15, n)
    draw = harmonic_course if log_type == "traj" else sweep_course
    return draw(rng, runs, round(seconds / runs, 2), np.round(home, 3), reach, np.round(top, 3))


def _with_drives(rng: np.random.Generator, arm: BenchArm, rows: Survey) -> BenchArm:
    """Draw rotors of 20 to 100 % of the moved inertia, and motors with 4 to 8 A at the peak torque."""
    inertia, peak = rows.inertia.mean(axis=0), np.abs(rows.torque).max(axis=0)
    links = []
    for j, link in enumerate(arm.links):
        share = exp(rng.uniform(log(0.2), log(1.0)))
        J_m = float(f"{share * inertia[j] * link.mu**2:.2g}")
        largest = 1.3 * (1.0 + share) * peak[j] * link.mu
        links.append(replace(link, J_m=J_m, k_i=float(f"{largest / rng.uniform(4.0, 8.0):.2g}")))
    return replace(arm, links=tuple(links))


def _with_friction(rng: np.random.Generator, arm: BenchArm, rows: Survey) -> BenchArm:
    """Draw friction of 15 to 35 % of the torque: half in the motor, half by bearing loads."""
    torque, speed, loads = rms(rows.torque), rms(rows.w), rms(rows.bearing)
    links = []
    for j, link in enumerate(arm.links):
        # A joint about a vertical axis has large bearing loads and little torque.
        size = rng.uniform(0.15, 0.35) * float(np.hypot(torque[j], 0.2 * loads[2, j]))
        parts = size * np.array([0.35, 0.15, 0.38, 0.12]) * rng.uniform(0.75, 1.25, 4)
        # Load-dependent friction is split among the nonzero loads, with one dominant in each joint.
        split = rng.dirichlet([1.0, 0.6, 1.0]) * (loads[:, j] > 1e-6)
        split = split / split.sum()
        by_load = np.divide(split, loads[:, j], out=np.zeros(3), where=split > 0.0)
        C, B = parts[2] * by_load, parts[3] * by_load / speed[j]
        values = {"C_m": parts[0] * link.mu, "B_m": parts[1] * link.mu**2 / speed[j]}
        values |= {"C_lN": C[0], "C_lT": C[1], "C_lM": C[2], "B_lN": B[0], "B_lT": B[1], "B_lM": B[2]}
        links.append(
            replace(link, friction=JointFriction(**{k: float(f"{v:.4g}") for k, v in values.items()}))
        )
    return replace(arm, links=tuple(links))


def _servo(rng: np.random.Generator, arm: BenchArm, rows: Survey) -> ArmServo:
    """Draw loops of 5 to 8 Hz at the mean inertia, on encoders of 2^12 to 2^14 counts, finer at low gears."""
    n, mu = len(arm), arm.column("mu")
    finer = 2.0 ** np.maximum(0, np.floor(np.log2(60.0 * mu)))
    velocity = 2.0 * pi * rng.uniform(5.0, 8.0, n) * np.exp(np.mean(np.log(rows.inertia), axis=0))
    return ArmServo(
        counts=rng.choice([4096.0, 8192.0, 16384.0], n) * finer,
        filter_hz=float(rng.choice([60.0, 80.0, 100.0])),
        position=rng.uniform(5.0, 9.0, n),
        velocity=velocity,
        integral=rng.uniform(4.0, 8.0, n),
    )
