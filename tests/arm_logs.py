"""Logs of a planar arm for the tests: motion given in closed form, torques from the textbook's formulas.

Nothing here uses the toolkit: masses on massless links, Newton's law for each mass, friction written out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from eccentric.model import Body, Chain, Joint, Placement

G = 9.81
LENGTHS, MASSES = (0.3, 0.25), (0.8, 0.6)
INERTIA, MU = 0.004, (1 / 9, 1 / 6)
RATE_HZ, NOISE_RAD, NOISE_NM = 200.0, 2e-6, 5e-3


def planar_arm(masses: Sequence[float] = MASSES) -> Chain:
    """Two links in a vertical plane, each with a weight at its end; both hang down at angle 0."""
    bodies = [
        Body(m, (0, -length, 0), np.diag([INERTIA, INERTIA, INERTIA]).tolist())
        for m, length in zip(masses, LENGTHS, strict=True)
    ]
    joints = [
        Joint(mu=MU[0], name="shoulder"),
        Joint(mu=MU[1], placement=Placement((0, -LENGTHS[0], 0)), name="elbow"),
    ]
    return Chain("planar", joints, bodies, (0, -G, 0))


@dataclass(frozen=True)
class Moved:
    """Angles, velocities, accelerations of the joints (n, 2), their torques and normal forces (n, 2)."""

    q: np.ndarray
    w: np.ndarray
    a: np.ndarray
    torque: np.ndarray
    F_N: np.ndarray


def moved(t: np.ndarray, seed: int) -> Moved:
    """A sum of three harmonics in each joint, other ones for each seed."""
    rng = np.random.default_rng(seed)
    size, rate = rng.uniform(0.5, 1.2, (3, 2)), rng.uniform(0.8, 4.5, (3, 2))
    phase = rng.uniform(-3, 3, (3, 2))
    x = rate[None] * t[:, None, None] + phase[None]
    q, w = (size * np.sin(x)).sum(1), (size * rate * np.cos(x)).sum(1)
    a = -(size * rate**2 * np.sin(x)).sum(1)
    both, w_both, a_both = q.sum(1), w.sum(1), a.sum(1)

    # Acceleration of a weight at the end of a link that hangs at an angle, gravity subtracted.
    def end(length: float, angle: np.ndarray, speed: np.ndarray, change: np.ndarray) -> np.ndarray:
        along, up = (np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))
        return length * np.stack([change * e + speed**2 * n for e, n in zip(along, up, strict=True)], 1)

    elbow = end(LENGTHS[0], q[:, 0], w[:, 0], a[:, 0])
    tip = elbow + end(LENGTHS[1], both, w_both, a_both)
    up = np.array([0.0, G])
    forces = MASSES[0] * (elbow + up), MASSES[1] * (tip + up)
    arm_0 = LENGTHS[0] * np.stack([np.sin(q[:, 0]), -np.cos(q[:, 0])], 1)
    arm_1 = LENGTHS[1] * np.stack([np.sin(both), -np.cos(both)], 1)
    outer = _cross(arm_1, forces[1]) + INERTIA * a_both
    inner = _cross(arm_0, forces[0] + forces[1]) + outer + INERTIA * a[:, 0]
    F_N = np.stack([np.linalg.norm(forces[0] + forces[1], axis=1), np.linalg.norm(forces[1], axis=1)], 1)
    return Moved(q, w, a, np.stack([inner, outer], 1), F_N)


def _cross(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    return left[:, 0] * right[:, 1] - left[:, 1] * right[:, 0]


Friction = Callable[[Moved], np.ndarray]


def plain(m: Moved) -> np.ndarray:
    """Coulomb and viscous friction of both joints [N m], joint side."""
    return np.array([0.30, 0.12]) * np.sign(m.w) + np.array([0.05, 0.03]) * m.w


def shoulder_by_load(m: Moved) -> np.ndarray:
    """The same, and in the shoulder Coulomb friction of 20 mm times F_N."""
    return plain(m) + np.stack([0.02 * m.F_N[:, 0] * np.sign(m.w[:, 0]), 0.0 * m.w[:, 1]], 1)


def elbow_stribeck(m: Moved) -> np.ndarray:
    """The same as `plain`, and in the elbow Stribeck friction below 0.4 rad/s."""
    rise = 0.25 * np.exp(-((np.abs(m.w[:, 1]) / 0.4) ** 2)) * np.sign(m.w[:, 1])
    return plain(m) + np.stack([0.0 * rise, rise], 1)


def arm_log_of(friction: Friction, runs: int = 6, seconds: float = 20.0) -> dict[str, Any]:
    """A log as a table: run, time, angles and torques of both joints, with the noise of sensors."""
    t = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    rng, parts = np.random.default_rng(5), []
    for run in range(runs):
        m = moved(t, run)
        q = m.q + rng.normal(size=m.q.shape) * NOISE_RAD
        torque = m.torque + friction(m) + rng.normal(size=m.q.shape) * NOISE_NM
        parts.append((np.full(len(t), f"run_{run}"), t, *q.T, *torque.T))
    names = ("run", "t_s", "q_rad_1", "q_rad_2", "tau_Nm_1", "tau_Nm_2")
    return {name: np.concatenate(x) for name, x in zip(names, zip(*parts, strict=True), strict=True)}


def arm_rig_of(chain: Chain, **more: Any) -> dict[str, Any]:
    """The rig of such a log."""
    columns = {"time": "t_s", "run": "run", "theta_l": "q_rad_{j}", "torque_l": "tau_Nm_{j}"}
    return {"arm": chain, "drive": "torque", "columns": columns, "moving_threshold_rad_s": 0.05, **more}
