"""The motion of the motor: its angle without wraps, velocity and acceleration, and the step of its sensor."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from eccentric.signals import filters
from eccentric.signals.filters import joined, rows_of_each, stretches
from eccentric.signals.limits import (
    CLEARLY_LESS,
    HALF_SPAN_S,
    LEAST_OF_MEANS,
    MEANS,
    QUANTA,
    SLOW,
    SWITCHING_S,
    UNEVEN_STEP,
)
from eccentric.signals.plausible import unwrapped

if TYPE_CHECKING:
    from eccentric.rigs import Rig
    from eccentric.signals.table import Table


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


# Which rows move, and which are unaffected by filters at the ends of a stretch or at a switched motor.


Mask = NDArray[np.bool_]


def moving_rows(
    t: Array, theta: Array, segment: Integers, rig: Rig, quantum: float, fitted: Mask
) -> tuple[Mask, float]:
    """Return the moving rows (n,), and the threshold [rad/s]: from the rig or from the rows `fitted`."""
    velocity = joined(segment, lambda rows: filters.span_velocity(t[rows], theta[rows]))
    threshold = rig.sampling.moving_threshold_rad_s
    if threshold is None:
        threshold = _default_threshold(velocity[fitted], quantum)
    moves = joined(segment, lambda rows: filters.moves(t[rows], velocity[rows], threshold))
    return moves.astype(bool), threshold


def _default_threshold(velocity: Array, quantum: float) -> float:
    speeds = np.abs(velocity[np.isfinite(velocity)])
    slow = SLOW * float(np.percentile(speeds, 95.0)) if len(speeds) else 0.0
    return max(QUANTA * quantum / (2.0 * HALF_SPAN_S), slow)


def clear_of_ends(t: Array, segment: Integers) -> Mask:
    """Rows (n,) at least half a second from the ends of every stretch, where filters have transients."""
    return joined(segment, lambda rows: filters.away_from_ends(t[rows]))


def near_switching(t: Array, segment: Integers, off: Mask) -> Mask:
    """Rows (n,) near switching the motor, where filters mix driven and free motion."""
    near = np.zeros(len(t), dtype=bool)
    for row in np.flatnonzero(np.diff(off.astype(int)) & (np.diff(segment) == 0)):
        near |= (np.abs(t - t[row]) < SWITCHING_S) & (segment == segment[row])
    return near


# The white noise of a sensor, from the signal itself, without model or filter.


def white_noise(signal: Array, segment: NDArray[np.int64] | None = None) -> float:
    """Return the RMS of the white noise in a sampled signal (n,), in its unit.

    The fourth difference of a smooth signal vanishes; that of white noise has 70 times the variance. NaN
    marks samples to ignore; differences across the ends of a `segment` (n,) are omitted.
    What a speed loop makes of the steps of its encoder is fast, and cancels in means. Means of 2, 4 and 8
    samples show white noise of the same size: the least size is returned where it is clearly smaller.
    """
    parts = np.zeros(len(signal), np.int64) if segment is None else segment
    found = _of(_differences(signal, parts))
    for length in MEANS:
        left = _differences(*_means(signal, parts, length))
        if len(left) < LEAST_OF_MEANS:
            break
        size = _of(left) * float(np.sqrt(length))
        if size < CLEARLY_LESS * found:
            found = size
    return found


def _differences(signal: Array, segment: NDArray[np.int64]) -> Array:
    """The fourth differences within a segment that have a value."""
    difference = np.diff(signal, 4)
    return difference[np.isfinite(difference) & (segment[4:] == segment[:-4])]


def _of(difference: Array) -> float:
    """The RMS of the white noise that has these fourth differences."""
    return 1.4826 * float(np.median(np.abs(difference - np.median(difference)))) / float(np.sqrt(70.0))


def _means(signal: Array, segment: NDArray[np.int64], length: int) -> tuple[Array, NDArray[np.int64]]:
    """Means of successive groups of `length` samples, NaN across the end of a segment, and their segments."""
    whole = len(signal) // length * length
    parts = segment[:whole].reshape(-1, length)
    means = signal[:whole].reshape(-1, length).mean(axis=1)
    return np.where(parts[:, 0] == parts[:, -1], means, np.nan), parts[:, 0]
