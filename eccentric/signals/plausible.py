"""Whether angle and speed of a log are consistent: wrapped angles are unwrapped, the rest is reported.

An angle that restarts at every turn, a speed in revolutions per minute and a wrong sign are all valid
numbers, and a fit to them is nonsense that looks like a comparison of models.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from eccentric.signals.filters import rows_of_each
from eccentric.signals.limits import (
    COMPARED_ROWS,
    COMPARED_S,
    LARGEST_SPEED_FACTOR,
    LEAST_CORRELATION,
    LEAST_SPEED_FACTOR,
    NEAR_CAUSE,
    WRAP_FULL,
    WRAP_HOLE,
    WRAP_SPAN,
)

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

TURN = 2.0 * math.pi

_UNITS = {
    60.0 / TURN: "the speed is in rpm",
    360.0 / TURN: "the speed is in deg/s, or the angle is in rad",
    1.0 / TURN: "the speed is in rev/s, or the angle is in rad",
    TURN / 360.0: "the angle is in deg",
    TURN: "the angle is in rev",
    1e3: "the time is in ms",
    1e6: "the time is in us",
}


def unwrapped(
    t: Array, theta: Array, segment: Integers, run: Integers, mu: float | None
) -> tuple[Array, str]:
    """Return the motor angle [rad] (n,) without wraps, and a warning, empty where there are none.

    An angle wraps at one turn of the motor or, with the gear ratio known, of the link. Across a gap in time
    it is continued at the speed before and after; each run starts at its logged angle.
    """
    periods = {"motor": TURN} | ({} if mu in (None, 1.0) else {"link": TURN / mu})
    if _largest_step(theta, segment) <= WRAP_FULL * min(periods.values()):
        return theta, ""
    found = [
        (_largest_step(smooth, segment), turns, smooth, count)
        for turns, period in periods.items()
        for smooth, count in [_unwrap(t, theta, segment, run, period)]
        if count
    ]
    if not found:
        degrees = [math.degrees(period) for period in periods.values()]
        if any(_unwrap(t, theta, segment, run, period)[1] for period in degrees):
            return theta, "the angle jumps by 360 rad (or that over mu): is it in deg?"
        return theta, ""
    largest, turns, smooth, count = min(found, key=lambda one: one[0])
    text = f"the angle is wrapped at one turn of the {turns}, {count} times: it is unwrapped"
    if largest > WRAP_HOLE * periods[turns]:
        text += f", uncertain at up to {largest / periods[turns]:.2g} turns from row to row"
    if turns == "motor" and "link" in periods:
        text += "; the log does not show in which turn a run starts (theta_zero_rad sets it)"
    return smooth, text


def _unwrap(t: Array, theta: Array, segment: Integers, run: Integers, period: float) -> tuple[Array, int]:
    """Return the angle (n,) unwrapped at the period, and the number of wraps."""
    steps = np.diff(theta) / period
    steps[np.diff(segment) != 0] = 0.0
    sizes = np.abs(steps)
    narrow = all(np.ptp(theta[rows]) <= WRAP_SPAN * period for rows in rows_of_each(run))
    whole = (
        not np.any((sizes > WRAP_HOLE) & (sizes < WRAP_FULL)) and np.max(sizes, initial=0.0) < 2.0 - WRAP_FULL
    )
    if not np.any(sizes > WRAP_FULL) or not (narrow or whole):
        return theta, 0
    turns = np.concatenate([[0.0], np.cumsum(-np.round(steps))])
    starts = np.flatnonzero(np.diff(segment, prepend=-1))
    for first, last in zip(starts[1:], starts[1:] - 1, strict=True):
        if run[first] != run[last]:
            turns[first:] -= turns[first]
            continue
        smooth = theta + period * turns
        ahead = _speed(t, smooth, np.flatnonzero(segment == segment[first])[:COMPARED_ROWS])
        behind = _speed(t, smooth, np.flatnonzero(segment == segment[last])[-COMPARED_ROWS:])
        expected = smooth[last] + 0.5 * (ahead + behind) * (t[first] - t[last])
        turns[first:] += np.round((expected - smooth[first]) / period)
    return theta + period * turns, int(np.count_nonzero(np.round(steps)))


def _speed(t: Array, theta: Array, rows: Integers) -> float:
    return 0.0 if len(rows) < 2 else float((theta[rows[-1]] - theta[rows[0]]) / (t[rows[-1]] - t[rows[0]]))


def _largest_step(theta: Array, segment: Integers) -> float:
    return float(np.max(np.abs(np.diff(theta)[np.diff(segment) == 0]), initial=0.0))


def speed_factor(t: Array, theta: Array, omega: Array, segment: Integers) -> tuple[float, float] | None:
    """Return a logged speed [rad/s] (n,) over the slope of the angle, and their correlation; None at rest.

    The turns of both over the same 0.2 s, or five rows, are compared.
    """
    rise: list[Array] = []
    told: list[Array] = []
    for rows in rows_of_each(segment):
        if len(rows) > COMPARED_ROWS:
            span = max(COMPARED_ROWS, round(COMPARED_S / float(np.median(np.diff(t[rows])))))
            integral = cumulative_trapezoid(omega[rows], t[rows], initial=0.0)
            rise.append(theta[rows][span:] - theta[rows][:-span])
            told.append(integral[span:] - integral[:-span])
    x, y = (np.concatenate([np.zeros(0), *parts]) for parts in (rise, told))
    size = float(x @ x)
    if size == 0.0:
        return None
    return float(x @ y) / size, float(x @ y) / math.sqrt(size * float(y @ y)) if np.any(y) else 0.0


def speed_doubt(t: Array, theta: Array, omega: Array, segment: Integers, mu: float | None) -> str:
    """Return what is wrong with a logged speed [rad/s] (n,), by the slope of the angle; empty if nothing."""
    found = speed_factor(t, theta, omega, segment)
    if found is None:
        return ""
    factor, correlation = found
    if abs(correlation) < LEAST_CORRELATION:
        return (
            f"the logged speed does not follow the slope of the angle (correlation {correlation:.2f}): "
            "do both belong to one shaft?"
        )
    if LEAST_SPEED_FACTOR <= factor <= LARGEST_SPEED_FACTOR:
        return ""
    cause = _cause(factor, mu)
    return f"the logged speed is {factor:.4g} times the slope of the angle" + (f": {cause}?" if cause else "")


def _cause(factor: float, mu: float | None) -> str:
    """Return the simplest and closest explanation of the factor; empty if there is none."""
    gears = {}
    if mu is not None and mu != 1.0:
        gears = dict.fromkeys((mu, 1.0 / mu), "they are on two sides of the gear")
        gears |= dict.fromkeys((mu**2, mu**-2), f"mu = {mu:.4g} is the reciprocal of what it should be")
    found = []
    for unit, gear in itertools.product((1.0, *_UNITS), (1.0, *gears)):
        words = [_UNITS.get(unit), gears.get(gear), "their signs differ" if factor < 0.0 else None]
        said = [word for word in words if word]
        off = abs(math.log(abs(factor) / (unit * gear)))
        if off <= NEAR_CAUSE:
            found.append((len(said), off, " and ".join(said)))
    return min(found, default=(0, 0.0, ""))[2]
