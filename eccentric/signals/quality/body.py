"""What the drive signal of a log says about its rig: a rigid body with Coulomb and viscous friction.

On block means, this is not a model of the friction: it gives signs, and sizes to some per cent, whatever
the delay and the noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eccentric.signals.quality.limits import DEPENDENT, LEAST_MEANS, MEAN_ROWS, MEAN_S, ROUNDING, SIGMAS

if TYPE_CHECKING:
    from eccentric.rigs import Rig
    from eccentric.signals.measured import Channels

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Means:
    """Means of blocks, each (m,): motion at the motor, link angle [rad] if mu is known, drives as logged."""

    alpha: Array
    omega: Array
    link: Array | None
    drives: dict[str, Array]
    rows: int


@dataclass(frozen=True)
class RigidBody:
    """What a drive says about the rig, in its own unit: value and standard error.

    `explained` is the explained part of the drive's variance.
    `alpha` and `drive` are their rms about the mean.
    `inertia` multiplies alpha; `gravity` is the amplitude of gravity, `turned` the angle [rad] of its
    direction from down; `loss` is the mean power of friction [unit rad/s].
    """

    inertia: tuple[float, float]
    gravity: tuple[float, float]
    turned: float
    loss: tuple[float, float]
    explained: float
    alpha: float
    drive: float


def means_of(c: Channels, rig: Rig) -> Means | None:
    """Return the means of blocks of consecutive rows; None if there are too few."""
    motion, motor = c.motion, c.motor
    known = np.isfinite(motion.alpha_m) & np.isfinite(motion.omega_m)
    for carrying, _ in c.carried:  # J and M g L of the rig are those without it
        known = known & ~carrying
    rows = np.flatnonzero(c.selection.fit_rows & ~motor.off & known)
    steps = np.diff(c.time.t)[np.diff(c.time.segment) == 0]
    if not len(rows) or not len(steps):
        return None
    size = max(MEAN_ROWS, math.ceil(MEAN_S / float(np.median(steps))))
    pieces = np.split(rows, np.flatnonzero((np.diff(rows) != 1) | (np.diff(c.time.segment[rows]) != 0)) + 1)
    blocks = [piece[k : k + size] for piece in pieces for k in range(0, len(piece) - size + 1, size)]
    if len(blocks) < LEAST_MEANS:
        return None
    index = np.array(blocks)
    found = {"current": motor.current, "torque": motor.torque, "voltage": motor.voltage}
    mu = rig.known.get("mu")
    return Means(
        np.mean(motion.alpha_m[index], axis=1),
        np.mean(motion.omega_m[index], axis=1),
        None if mu is None else mu * np.mean(motion.theta_m[index], axis=1),
        {name: np.mean(x[index], axis=1) for name, x in found.items() if x is not None},
        index.size,
    )


def regressed(columns: list[Array], x: Array) -> tuple[Array, Array, float]:
    """Return coefficients, their covariance, and the explained part of the variance of x."""
    design = np.stack(columns, axis=1)
    scale = np.linalg.norm(design, axis=0)
    scale[scale == 0.0] = 1.0
    inverse = np.linalg.pinv(design / scale, rcond=ROUNDING)
    solution = inverse @ x
    rest = x - design / scale @ solution
    variance = float(rest @ rest) / max(len(x) - design.shape[1], 1)
    # A column in the span of the others has no coefficient, whatever the pseudoinverse returns.
    lost = np.linalg.matrix_rank(design / scale, tol=DEPENDENT) < design.shape[1]
    covariance = variance * (inverse @ inverse.T) + (np.inf if lost else 0.0)
    total = float(np.sum((x - np.mean(x)) ** 2))
    return (
        solution / scale,
        covariance / np.outer(scale, scale),
        1.0 - float(rest @ rest) / max(total, 1e-300),
    )


def friction_of(m: Means) -> list[Array]:
    """Return w, sgn(w), and a constant if both directions separate it from sgn(w); each (m,)."""
    sign = np.sign(m.omega)
    both = bool(np.any(sign > 0.0) and np.any(sign < 0.0))
    return [m.omega, sign, *([np.ones_like(sign)] if both else [])]


def body_of(m: Means, x: Array, link: Array | None) -> RigidBody:
    """Return what a drive x (m,) says about the rig, with the link angle (m,) [rad] if it is known."""
    gravity = [] if link is None else [np.sin(link), np.cos(link)]
    columns = [m.alpha, *friction_of(m), *gravity]
    a, covariance, explained = regressed(columns, x)
    power = np.array([np.mean(m.omega**2), np.mean(np.abs(m.omega))])
    loss = float(power @ a[1:3]), math.sqrt(float(power @ covariance[1:3, 1:3] @ power))
    amplitude, turned, error = 0.0, 0.0, math.inf
    if link is not None:
        amplitude, turned = math.hypot(a[-2], a[-1]), math.atan2(a[-1], a[-2])
        error = math.sqrt(max(covariance[-2, -2], covariance[-1, -1]))
    inertia = float(a[0]), math.sqrt(covariance[0, 0])
    sizes = float(np.std(m.alpha)), float(np.std(x))
    return RigidBody(inertia, (amplitude, error), turned, loss, explained, *sizes)


def is_clear(value: float, error: float) -> bool:
    """Return whether a coefficient is significantly different from zero."""
    return abs(value) > SIGMAS * error
