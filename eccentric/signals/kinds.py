"""What a row's value stands for: a sample, the mean over the row, or a value that is held until the next.

A row lasts from its time to that of the next one.  The balance is compared at the times of the rows, so that
a value that stands for the whole row is read half a row too early if it is taken for a sample: at 50 rows
per second and a time constant of 0.3 s, the inertia comes out 3 % wrong.

    held   x(t) = c_k for t_k <= t < t_{k+1}             a command, kept until the next one
    mean   c_k  = mean of x over t_k <= t < t_{k+1}      what a drive has averaged over its cycle

At t_k both are the mean of the rows before and after it, less a part of their second difference:

    x_k = (c_{k-1} + c_k)/2 - beta (c_{k-2} - c_{k-1} - c_k + c_{k+1})

Of a signal of wave number w per row this leaves cos(w/2) - 2 beta (cos(3w/2) - cos(w/2)), which is
1 - w^2 (1/8 - 2 beta) + O(w^4).  A held signal has sin(w/2)/(w/2) = 1 - w^2/24 of its commands: beta = 1/24.
From means it has the reciprocal, 1 + w^2/24: beta = 1/12.
"""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from eccentric.signals import limits
from eccentric.signals.filters import is_even, rows_of_each, stretches

if TYPE_CHECKING:
    from collections.abc import Mapping

    from eccentric.signals.rows import Rows
    from eccentric.signals.table import Table

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

_CURVATURE = {"held": 1.0 / 24.0, "mean": 1.0 / 12.0}


def at_the_times(x: Array, kind: str, t: Array, segment: Integers) -> Array:
    """Return a signal at the times t [s] (n,) of its rows, from what these stand for (n,).

    Args:
        x: the values of the rows, in any unit.
        kind: "sample", "mean" or "held".
        t: the times of the rows [s] (n,).
        segment: the number of the stretch without gap of each row (n,); none is joined to another.
    """
    if kind == "sample":
        return x
    out = np.array(x, float)
    for rows in rows_of_each(segment):
        if len(rows) > 1:
            before, c, after = np.r_[x[rows[0]], x[rows[:-1]]], x[rows], np.r_[x[rows[1:]], x[rows[-1]]]
            steps = np.diff(t[rows])
            if is_even(t[rows]):
                steps = np.ones_like(steps)
            own, last = np.r_[steps, steps[-1]], np.r_[steps[0], steps]
            if kind == "mean":
                # A mean lies half of its own row away from the time: the shorter row says more of it.
                own, last = last, own
            earlier = np.r_[before[0], before[:-1]]
            out[rows] = (last * before + own * c) / (last + own)
            out[rows] -= _CURVATURE[kind] * (earlier - before - c + after)
    return out


def at_times(table: Table, kinds: Mapping[str, str]) -> Table:
    """The table with each channel at the times of the rows, by what their values stand for."""
    t = table.channels["time"]
    segment = stretches(t, table.run)
    read = {
        name: at_the_times(table.channels[name], kind, t, segment)
        for name, kind in kinds.items()
        if name in table.channels
    }
    return dataclasses.replace(table, channels={**table.channels, **read})


# A coarse log between its rows: the integrands of a window of twelve steps, on a finer grid.
#
# At 40 rows per second a reversal falls between two rows, and the sign of the velocity, summed over rows, is
# off by a fraction of a step; so is a load that follows the angle.  The angle between the rows is that of a
# quintic spline, as in `filters.motion`; a signal that is held from row to row is held there too; other
# signals are interpolated linearly.  Nothing is added to the log: windows cover the same time as before, and
# rows are counted as logged.


def refined(table: Table, kinds: Mapping[str, str]) -> Table:
    """The table, angle unwrapped on the motor side, with more points a row; a stretch ends as it did.

    `kinds` is what a row's value stands for, by channel; one that is not in it is a sample.
    """
    t, held = table.channels["time"], {name for name, kind in kinds.items() if kind == "held"}
    table = at_times(table, {name: kind for name, kind in kinds.items() if name not in held})
    parts: list[dict[str, Array]] = []
    source: list[NDArray[np.int64]] = []
    for rows in rows_of_each(stretches(t, table.run)):
        where = np.arange((len(rows) - 1) * limits.POINTS_PER_ROW + 1) / limits.POINTS_PER_ROW
        fine = np.interp(where, np.arange(len(rows)), t[rows])
        before = rows[np.minimum(where.astype(int), len(rows) - 1)]
        source.append(before)
        part = {"time": fine}
        for name, x in table.channels.items():
            if name == "theta_m" and len(rows) > 5:
                part[name] = np.asarray(make_interp_spline(t[rows], x[rows], k=5)(fine))
            elif name in held:
                one = np.zeros(len(fine), np.int64)
                part[name] = at_the_times(x[before], "held", fine, one)
            elif name != "time":
                part[name] = np.interp(fine, t[rows], x[rows])
        parts.append(part)
    joined = {name: np.concatenate([part[name] for part in parts]) for name in table.channels}
    return table.at(np.concatenate(source), joined)


# Whether a log shows that its drive is held.


def evidence(rows: Rows, target: Array, one: Array, other: Array) -> float:
    """Return by how many standard errors the columns `one` explain a target better than the `other` ones.

    Vuong's statistic for models that do not contain each other (Econometrica 57, 1989), least squares with
    Gaussian residuals, summed over the blocks of the rows, which are not independent within one.

    Args:
        rows: m rows.
        target: what is explained (m,); its noise does not favour either, that of the columns might.
        one: columns (m, k).
        other: others (m, k).
    """
    likelihoods = []
    for columns in (one, other):
        size = np.linalg.norm(columns, axis=0)
        scaled = columns / np.where(size > 0.0, size, 1.0)
        left = target - scaled @ np.linalg.lstsq(scaled, target, rcond=None)[0]
        variance = float(np.mean(left**2))
        if variance == 0.0:
            return math.inf if columns is one else -math.inf
        likelihoods.append(-0.5 * (math.log(variance) + left**2 / variance))
    _, block = np.unique(rows.block, return_inverse=True)
    more = np.bincount(block, likelihoods[0] - likelihoods[1])
    spread = float(np.sqrt(np.sum((more - more.mean()) ** 2)))
    return float(more.sum()) / spread if spread else 0.0
