"""The motion of the motor: its angle without wraps, velocity and acceleration, and the step of its sensor."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from eccentric.signals import filters
from eccentric.signals.limits import UNEVEN_STEP
from eccentric.signals.plausible import unwrapped
from eccentric.signals.stretches import joined, rows_of_each, stretches

if TYPE_CHECKING:
    from eccentric.rigs import Rig
    from eccentric.signals.table import Table

__all__ = ["motion_of", "motor_side", "of_the_motor", "quantum_of", "uneven"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def motor_side(table: Table, rig: Rig, motor: str, link: str) -> Array | None:
    """Convert a channel to the motor side: angles and speeds are divided by mu, torques multiplied."""
    if motor in table.channels:
        return table.channels[motor]
    if link not in table.channels:
        return None
    mu = rig.value("mu")
    return table.channels[link] * (mu if link == "torque_l" else 1.0 / mu)


def of_the_motor(table: Table, rig: Rig) -> tuple[Table, list[str]]:
    """Return the table with angle and speed of the motor, and warnings.

    The angle is the logged one, unwrapped, or the integral of the logged speed.
    """
    logged = motor_side(table, rig, "theta_m", "theta_l")
    omega = motor_side(table, rig, "omega_m", "omega_l")
    theta, warnings = _integral(table, omega) if logged is None else (_smooth(table, rig, logged), [])
    own = {"theta_m": theta} | ({} if omega is None else {"omega_m": omega})
    rest = {c: x for c, x in table.channels.items() if not c.startswith(("theta_", "omega_"))}
    return dataclasses.replace(table, channels=rest | own), warnings


def _smooth(table: Table, rig: Rig, theta: Array) -> Array:
    if not rig.axis.wraps:
        return theta
    t = table.channels["time"]
    return unwrapped(t, theta, stretches(t, table.run), table.run, rig.known.get("mu"))[0]


def _integral(table: Table, omega: Array | None) -> tuple[Array, list[str]]:
    if omega is None:
        raise AssertionError("read_table requires an angle or a speed")
    t = table.channels["time"]
    theta = joined(table.run, lambda rows: cumulative_trapezoid(omega[rows], t[rows], initial=0.0))
    warnings = ["no angle is logged: it is the integral of the speed, from 0 at the start of each run"]
    if stretches(t, table.run)[-1] > table.run[-1]:
        warnings.append("the integrated angle is uncertain after a gap in time")
    return theta, warnings


def motion_of(t: Array, theta: Array, segment: Integers, cut_hz: float) -> tuple[Array, list[str]]:
    """Return angle, velocity, acceleration as rows of (3, n), filtered stretch by stretch, and warnings."""
    plain: list[int] = []

    def one(rows: Integers) -> Array:
        *signals, smoothed = filters.motion(t[rows], theta[rows], cut_hz)
        if not smoothed:
            plain.append(len(rows))
        return np.stack(signals, axis=1)

    signals = joined(segment, one)
    warnings: list[str] = []
    if plain and math.isinf(cut_hz):
        warnings.append(
            "the log is too coarse for the low pass: velocity and acceleration are those of a spline "
            "through the angle, averaged over windows of twelve steps"
        )
    elif plain:
        warnings.append(
            f"{sum(plain)} of {len(t)} rows are too coarse, or in stretches too short, for the "
            f"{cut_hz:g} Hz low pass: their velocity and acceleration are those of a spline"
        )
    return signals.T, warnings


def uneven(table: Table) -> list[str]:
    """Return warnings about uneven time steps; one across dropped rows does not count."""
    t = table.channels["time"]
    piece = stretches(t, table.run) + np.cumsum(table.after_dropped)
    if all(filters.is_even(t[rows]) for rows in rows_of_each(piece)):
        return []
    steps = np.diff(t)[np.diff(piece) == 0]
    usual = float(np.median(steps))
    odd = int(np.count_nonzero(np.abs(steps / usual - 1.0) > UNEVEN_STEP))
    if not odd:  # a clock that drifts against the grid
        return []
    text = (
        f"time steps are uneven ({odd} of {len(steps)} differ by more than {UNEVEN_STEP:.0%} from the usual "
        f"{usual:.4g} s): for filtering, the angle is interpolated linearly"
    )
    return [text]


def quantum_of(logged: Table, rig: Rig, theta: Array) -> float:
    """Return the step of the motor angle [rad], from the counts or the smallest one seen; 0 if integrated."""
    if "theta_m" not in logged.channels and "theta_l" not in logged.channels:
        return 0.0
    if rig.log.counts_per_rev is not None:
        gear = 1.0 if "theta_m" in logged.channels else rig.value("mu")
        return 2.0 * np.pi / rig.log.counts_per_rev / gear
    segment = stretches(logged.channels["time"], logged.run)
    changes = np.abs(np.diff(theta))[np.diff(segment) == 0]
    changes = changes[changes > 1e-9 * max(1.0, float(np.max(np.abs(theta))))]
    return float(np.min(changes)) if len(changes) else 0.0
