"""The reference motion of an arm, run by run from rest, and the servo drives that follow it."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi

import numpy as np

_FADE_S = 1.0
_HARMONICS = 5


@dataclass(frozen=True)
class ArmCourse:
    """Reference of the joints over `runs` runs of `seconds` each.

    `traj`: five harmonics with the run length as period, velocity amplitudes `size` [rad/s] and `phase`
    [rad], both of shape (runs, joints, 5), faded in over the first second.
    `runs`: constant velocities `size` [rad/s], joined by smooth ramps of `ramp_s` [s] at `start` [s], both
    of shape (runs, joints, parts).
    """

    log_type: str
    runs: int
    seconds: float
    home: np.ndarray  # mean angles of the motion [rad], shape (joints,)
    top: np.ndarray  # approximate peak velocity of each joint [rad/s]
    size: np.ndarray
    phase: np.ndarray
    start: np.ndarray
    ramp_s: float = 0.3

    def reference(self, run: int, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return angles [rad] and velocities [rad/s] at `time` [s] of a run, each (len(time), joints)."""
        one = self._harmonics if self.log_type == "traj" else self._parts
        motion = [one(run, joint, time) for joint in range(len(self.home))]
        q, w = (np.stack(part, axis=1) for part in zip(*motion, strict=True))
        return q + self.home, w

    def _harmonics(self, run: int, joint: int, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        q, w = np.zeros_like(time), np.zeros_like(time)
        for k, (size, phase) in enumerate(
            zip(self.size[run, joint], self.phase[run, joint], strict=True), start=1
        ):
            rate = 2.0 * np.pi * k / self.seconds
            q += size / rate * np.sin(rate * time + phase)
            w += size * np.cos(rate * time + phase)
        x = np.clip(time / _FADE_S, 0.0, 1.0)
        fade, slope = x**3 * (10.0 - 15.0 * x + 6.0 * x**2), 30.0 * (x * (1.0 - x)) ** 2 / _FADE_S
        return fade * q, fade * w + slope * q

    def _parts(self, run: int, joint: int, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        q, w, before = np.zeros_like(time), np.zeros_like(time), 0.0
        for start, size in zip(self.start[run, joint], self.size[run, joint], strict=True):
            x = np.clip((time - start) / self.ramp_s, 0.0, 1.0)
            beyond = np.maximum(time - start - self.ramp_s, 0.0)
            w += (size - before) * x * x * (3.0 - 2.0 * x)
            q += (size - before) * (self.ramp_s * (x**3 - 0.5 * x**4) + beyond)
            before = size
        return q, w


def harmonic_course(
    rng: np.random.Generator, runs: int, seconds: float, home: np.ndarray, reach: np.ndarray, top: np.ndarray
) -> ArmCourse:
    """Draw sums of harmonics for each run, within `reach` [rad] of home and at most `top` [rad/s]."""
    n = len(home)
    size = rng.uniform(0.3, 1.0, (runs, n, _HARMONICS))
    phase = rng.uniform(-np.pi, np.pi, (runs, n, _HARMONICS))
    course = ArmCourse("traj", runs, seconds, home, top, size, phase, np.zeros((runs, n, 0)))
    time = np.linspace(0.0, seconds, 400)
    for run in range(runs):
        q, w = course.reference(run, time)
        most = np.maximum(np.abs(q - home).max(axis=0) / reach, np.abs(w).max(axis=0) / top)
        size[run] /= most[:, None] * rng.uniform(1.0, 1.25, (n, 1))
    return ArmCourse("traj", runs, seconds, home, top, np.round(size, 4), np.round(phase, 4), course.start)


def sweep_course(
    rng: np.random.Generator, runs: int, seconds: float, home: np.ndarray, reach: np.ndarray, top: np.ndarray
) -> ArmCourse:
    """Draw constant velocities, 10 to 100 % of `top` [rad/s], 2 s each, within `reach` [rad] of home."""
    n, parts = len(home), max(3, round(seconds / 2.0))
    ramp = round(float(rng.uniform(0.25, 0.4)), 2)
    start, size = np.zeros((runs, n, parts)), np.zeros((runs, n, parts))
    for run in range(runs):
        for joint in range(n):
            lengths = rng.uniform(0.6, 1.4, parts)
            edges = np.round(np.concatenate([[0.0], np.cumsum(lengths) * seconds / lengths.sum()]), 2)
            speeds = rng.permutation(np.linspace(0.1, 1.0, parts)) * rng.uniform(0.85, 1.0, parts)
            place, way = 0.0, float(rng.choice([-1.0, 1.0]))
            for part in range(parts):
                length = edges[part + 1] - edges[part]
                step = speeds[part] * top[joint]
                # Towards the farther end, or as fast as the distance to it allows.
                way = -way if abs(place + way * step * length) > reach[joint] else way
                step = min(step, max(0.1 * top[joint], (reach[joint] - way * place) / length))
                start[run, joint, part], size[run, joint, part] = edges[part], round(way * step, 3)
                place += way * step * length
                way = -way if rng.uniform() < 0.6 else way
    return ArmCourse("runs", runs, seconds, home, top, size, np.zeros_like(size), start, ramp)


@dataclass(frozen=True)
class ArmServo:
    """Measurement and control of the drives, one entry per joint.

    A position loop gives the velocity correction to the reference, a PI velocity loop the joint torque. The
    current is that torque times mu/k_i: the current loop is ideal.
    """

    counts: np.ndarray  # encoder counts per motor turn
    filter_hz: float  # corner of the velocity filter, one pole
    position: np.ndarray  # gain of the position loop [1/s]
    velocity: np.ndarray  # gain of the velocity loop [N m s/rad]
    integral: np.ndarray  # integral gain over `velocity` [1/s]


class ArmLoop:
    """The running loops: one `torque` every `dt`, starting at rest with the holding torque."""

    def __init__(
        self, servo: ArmServo, mu: np.ndarray, dt: float, q: np.ndarray, holding: np.ndarray
    ) -> None:
        self._servo, self._dt = servo, dt
        self._quantum = 2.0 * pi * mu / servo.counts
        self._pole = 1.0 - exp(-2.0 * pi * servo.filter_hz * dt)
        self._gain = servo.integral * servo.velocity * dt
        self.angle = self._read(q)
        self.speed = np.zeros_like(q)
        self._sum = holding.copy()

    def _read(self, q: np.ndarray) -> np.ndarray:
        return np.floor(q / self._quantum + 0.5) * self._quantum

    def torque(self, q: np.ndarray, wanted: np.ndarray, speed: np.ndarray) -> np.ndarray:
        """Return the joint torques [N m] at angles q, for the reference `wanted` [rad] at `speed` [rad/s]."""
        angle = self._read(q)
        self.speed = self.speed + self._pole * ((angle - self.angle) / self._dt - self.speed)
        self.angle = angle
        error = speed + self._servo.position * (wanted - angle) - self.speed
        self._sum = self._sum + self._gain * error
        return self._servo.velocity * error + self._sum
