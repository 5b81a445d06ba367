"""The nearest friction with constant coefficients, for simulators whose joints take no other.

Of a joint moving at v: level + a v + b v|v| + c v^3 against the motion, a level for each direction. It is
fitted to the friction of a drive over a turn of the link and its range of speeds, by least squares with
coefficients that are not negative (C. L. Lawson and R. J. Hanson, Solving Least Squares Problems, 1974).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from eccentric.exports.drive import ExportedDrive, Floats

_ANGLES, _SPEEDS = 720, 64
"""Points of a turn of the link and of the speeds of each direction."""
_ROUNDING = 1e-12
"""Share of the largest friction below which a part of it, or an error, is rounding."""


@dataclass(frozen=True)
class ConstantLaw:
    """Friction of a joint with constant coefficients, and its error over the range that it was fitted on.

    Attributes:
        upper, lower: sizes of the levels forwards and backwards [N m].
        damping: coefficients of v, v|v| and v^3 [N m s/rad, N m s^2/rad^2, N m s^3/rad^3].
        error_rms, error_max: of the friction torque [N m].
        friction_rms: of the friction torque itself [N m].
        breakaway: smallest and largest level of the drive at rest, over the angle and both directions [N m].
    """

    upper: float
    lower: float
    damping: tuple[float, float, float]
    error_rms: float
    error_max: float
    friction_rms: float
    breakaway: tuple[float, float]

    @property
    def level(self) -> float:
        """Half the sum of both levels [N m]: what a simulator has one number for."""
        return (self.upper + self.lower) / 2.0

    @property
    def offset(self) -> float:
        """Half their difference [N m]: with it as a constant torque against the joint, `level` is exact."""
        return (self.upper - self.lower) / 2.0

    @property
    def exact(self) -> bool:
        """Whether the drive has this friction."""
        return self.error_max == 0.0

    def torque(self, velocity: Floats) -> Floats:
        """The friction torque in motion [N m]."""
        a, b, c = self.damping
        dry = np.where(velocity > 0.0, self.upper, -self.lower)
        return dry + a * velocity + b * velocity * np.abs(velocity) + c * velocity**3


def nearest(
    drive: ExportedDrive, powers: tuple[int, ...] = (1, 2, 3), *, symmetric: bool = False
) -> ConstantLaw:
    """The nearest law of a drive.

    Args:
        drive: its friction depends on angle and velocity alone.
        powers: of the speed in the damping.
        symmetric: whether both levels are one.

    Raises:
        InputError: its friction depends on a temperature, a current or the like.
    """
    drive.require_motion_alone()
    speed = np.linspace(*drive.link_speeds, _SPEEDS)
    angle = np.linspace(0.0, 2.0 * np.pi, _ANGLES, endpoint=False)
    velocity = np.concatenate([speed, -speed])
    torque = drive.friction(angle[:, None], velocity[None, :])
    sign = np.where(velocity >= 0.0, 1.0, -1.0)
    forward, backward = (sign > 0.0).astype(float), -(sign < 0.0).astype(float)
    levels = [sign] if symmetric else [forward, backward]
    columns = np.column_stack([*levels, *(sign * np.abs(velocity) ** k for k in powers)])
    # The columns are the same at each angle: the mean over it has the same solution.
    scale = np.linalg.norm(columns, axis=0)
    found = nnls(columns / scale, torque.mean(axis=0))[0] / scale
    largest = float(np.abs(torque).max())
    found[found * np.abs(columns).max(axis=0) <= _ROUNDING * largest] = 0.0
    error = torque - columns @ found
    error = np.zeros(1) if np.abs(error).max() <= _ROUNDING * largest else error
    upper, lower = found[0], found[0 if symmetric else 1]
    if abs(upper - lower) <= _ROUNDING * largest:
        upper = lower
    damping = dict(zip(powers, map(float, found[len(levels) :]), strict=True))
    low, high, _ = drive.budget(angle, np.zeros_like(angle))
    at_rest = np.concatenate([-low, high])
    return ConstantLaw(
        float(upper),
        float(lower),
        (damping.get(1, 0.0), damping.get(2, 0.0), damping.get(3, 0.0)),
        float(np.sqrt(np.mean(error**2))),
        float(np.abs(error).max()),
        float(np.sqrt(np.mean(torque**2))),
        (float(at_rest.min()), float(at_rest.max())),
    )
