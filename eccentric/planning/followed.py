"""A motion as a drive makes it that is not quite the fitted one: extremes of angle, speed and current.

A reference within its limits is not a motion within them: a speed loop lags behind a ramp and overshoots
its end, gravity and the reversal of friction disturb it, and mass and friction of the drive are not those of
the fit. So the loop is simulated with each of them off by `OFF`, both ways: a speed controller, proportional
and integral, behind the filter of its speed. It is tuned for the fitted inertia, and a mass that is added for
one log leaves it so. Friction holds what is below its level. Load and friction are those along the reference:
where the drive is elsewhere, it is by little.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from eccentric.planning.bounds import Bounds
from eccentric.planning.limits import INTEGRAL_PER_S, LOOP_STEPS, LOOPS_HZ, OFF, RATE_HZ, SPEED_FILTER_HZ
from eccentric.planning.motion import Reference

__all__ = ["Extremes", "Met", "extremes"]

Array = NDArray[np.floating]


@dataclass(frozen=True)
class Met:
    """What a drive meets along a motion, motor side.

    Attributes:
        inertia: [kg m^2]; load: gravity and the like (n,) [N m]; friction: along the motion (n,) [N m].
        torque_constant: torque [N m] of one ampere; noise: what the loop adds to the current [A].
        tuned_for: the inertia that the speed loop was tuned for [kg m^2], None for this one.
    """

    inertia: float
    load: Array
    friction: Array
    torque_constant: float
    noise: float = 0.0
    tuned_for: float | None = None


@dataclass(frozen=True)
class Extremes:
    """Largest speed [rad/s] and current [A], both ends of the angle [rad], largest acceleration asked for."""

    speed: float
    acceleration: float
    current: float
    angle: tuple[float, float]

    def beyond(self, bounds: Bounds) -> float:
        """The largest part of any limit that is used: above 1 one is broken."""
        used = [
            self.speed / bounds.speed,
            self.acceleration / bounds.acceleration,
            self.current / bounds.current,
        ]
        if bounds.angle is not None:
            middle, half = 0.5 * sum(bounds.angle), 0.5 * (bounds.angle[1] - bounds.angle[0])
            used += [abs(end - middle) / half for end in self.angle]
        return max(used)


def extremes(motion: Reference, met: Met, loop_hz: float | None = None) -> Extremes:
    """The extremes over all drives of the uncertainty; `loop_hz`: bandwidth of the speed loop, if known."""
    loops = LOOPS_HZ if loop_hz is None else tuple(loop_hz * (1.0 + sign * OFF) for sign in (-1.0, 1.0))
    factors = (1.0 - OFF, 1.0 + OFF)
    found = [
        _followed(motion, met, mass, friction, loop)
        for mass, friction, loop in product(factors, factors, loops)
    ]
    speed, torque, low, high = (list(x) for x in zip(*found, strict=True))
    # A drive that sticks under a slow loop takes less than the motion asks for.
    steady = max(np.max(np.abs(m * met.load + f * met.friction)) for m, f in product(factors, factors))
    asked = np.max(np.abs(met.load + met.inertia * motion.alpha + met.friction))
    return Extremes(
        max(speed),
        float(np.max(np.abs(motion.alpha))),
        float(max(*torque, steady, asked)) / abs(met.torque_constant) + met.noise,
        (float(np.min(motion.theta)) + min(low), float(np.max(motion.theta)) + max(high)),
    )


def _followed(
    motion: Reference, met: Met, mass: float, friction: float, loop_hz: float
) -> tuple[float, float, float, float]:
    """Largest speed and torque, and the deviation of the angle to both sides, of one drive under its loop.

    The integral begins with what holds the load: the drive stands before it moves.
    """
    dt = 1.0 / (RATE_HZ * LOOP_STEPS)
    inertia, load = mass * met.inertia, (mass * met.load).tolist()
    dry = (friction * _size(motion, met.friction)).tolist()
    gain = 2.0 * math.pi * loop_hz * (met.inertia if met.tuned_for is None else met.tuned_for)
    per_step, pole = gain * INTEGRAL_PER_S * dt, 1.0 - math.exp(-2.0 * math.pi * SPEED_FILTER_HZ * dt)
    step, speed, seen, integral, away = dt / inertia, 0.0, 0.0, load[0], 0.0
    fastest = strongest = low = high = 0.0
    for asked, pull, hold in zip(motion.omega.tolist(), load, dry, strict=True):
        level = step * hold
        for _ in range(LOOP_STEPS):
            error = asked - seen
            torque = gain * error + integral
            integral += per_step * error
            push = speed + step * (torque - pull)
            speed = push - level if push > level else push + level if push < -level else 0.0
            seen += pole * (speed - seen)
            away += dt * (speed - asked)
            strongest = max(strongest, abs(torque))
        fastest, low, high = max(fastest, abs(speed)), min(low, away), max(high, away)
    return fastest, strongest, low, high


def _size(motion: Reference, friction: Array) -> Array:
    """The size of friction [N m] (n,): at rest, where the models have none, that of the motion beside it."""
    moving = motion.omega != 0.0
    if not np.any(moving):
        return np.zeros(len(friction))
    size = np.maximum(friction * np.sign(motion.omega), 0.0)
    return np.interp(motion.t, motion.t[moving], size[moving])
