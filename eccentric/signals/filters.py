"""A sampled angle becomes angle, velocity and acceleration without phase lag, and a mask of moving rows.

A second-order Butterworth low pass runs forwards and backwards over the angle, a quintic spline through the
result is differentiated, and the raw angle gives the mask.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline
from scipy.linalg.lapack import dtbtrs

from eccentric.signals.limits import (
    COARSE,
    END_S,
    HALF_SPAN_S,
    JITTER,
    LEAST_FILTERED,
    REVERSAL_S,
    ROUNDED_RATE,
)
from eccentric.signals.stretches import rows_of_each

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_PADDING = 9
"""Rows by which a signal is extended at either end: three times the length of the filter."""


def low_pass(x: Array, rate_hz: float, cut_hz: float) -> Array | None:
    """Return evenly sampled x (n, ...) after a second-order Butterworth low pass without phase, or None.

    None if the cut-off frequency is above 0.4 of the sampling rate, or the stretch is too short.
    The result is that of SciPy's `sosfiltfilt`; importing `scipy.signal` takes longer than filtering a log.
    """
    if cut_hz > COARSE * rate_hz or len(x) <= _PADDING:
        return None
    if not np.size(x):  # LAPACK's wrapper writes beyond an array without columns
        return np.array(x, float)
    # Without its first value: the rounding of a large offset would be amplified by a low cut-off frequency.
    start = x[:1]
    rows = np.reshape(x - start, (len(x), -1)).T
    forwards = np.empty((len(rows), len(x) + 2 * _PADDING))
    backwards = np.empty_like(forwards)
    # Reflected about its ends, the signal goes on with its slope there.
    forwards[:, _PADDING:-_PADDING] = rows
    np.subtract(2.0 * rows[:, :1], rows[:, _PADDING:0:-1], out=forwards[:, :_PADDING])
    np.subtract(2.0 * rows[:, -1:], rows[:, -2 : -_PADDING - 2 : -1], out=forwards[:, -_PADDING:])
    _one_way(forwards, backwards, cut_hz / rate_hz)
    _one_way(backwards[:, ::-1], forwards, cut_hz / rate_hz)
    return forwards[:, -_PADDING - 1 : _PADDING - 1 : -1].T.reshape(np.shape(x)) + start


def _one_way(rows: Array, out: Array, cut: float) -> None:
    """Put each row (k, n) after a causal Butterworth low pass into `out`; before its start it is constant.

    y[n] + a_1 y[n - 1] + a_2 y[n - 2] = b (x[n] + 2 x[n - 1] + x[n - 2]): the bilinear transform of
    1/(s^2 + sqrt(2) s + 1), its frequency prewarped. `cut` is the cut-off frequency over the sampling rate.
    """
    bands, b = _recursion(rows.shape[1], cut)
    first = rows[:, 0]
    np.multiply(rows[:, 1:-1], 2.0, out=out[:, 2:])
    out[:, 2:] += rows[:, 2:]
    out[:, 2:] += rows[:, :-2]
    out[:, 0], out[:, 1] = 4.0 * first, rows[:, 1] + 3.0 * first
    out *= b
    _, a_1, a_2 = bands[:, 0]
    out[:, 0] -= (a_1 + a_2) * first
    out[:, 1] -= a_2 * first
    solved, _ = dtbtrs(bands, out.T, uplo="L", diag="U", overwrite_b=True)
    if not np.shares_memory(solved, out):
        out[:] = solved.T


@functools.lru_cache(maxsize=2)
def _recursion(length: int, cut: float) -> tuple[Array, float]:
    """The bands 1, a_1 and a_2 of the recursion (3, length), and b; cached: a fit filters one log often."""
    k = math.tan(math.pi * cut)
    scale = 1.0 / (1.0 + math.sqrt(2.0) * k + k * k)
    bands = np.empty((3, length), order="F")
    bands[:] = [[1.0], [2.0 * (k * k - 1.0) * scale], [(1.0 - math.sqrt(2.0) * k + k * k) * scale]]
    return bands, k * k * scale


@dataclass(frozen=True)
class LowPass:
    """The low pass of a log, stretch by stretch: a search applies that of one log thousands of times.

    Attributes:
        together: stretches of one length and sampling rate, filtered at once: the first row of each, the
            length, the rate [Hz]; rows of a stretch that is too coarse or too short stay as they are.
        cut_hz: its cut-off frequency [Hz].
    """

    together: tuple[tuple[NDArray[np.int64], int, float], ...]
    cut_hz: float

    def __call__(self, x: Array) -> Array:
        """Return x (n,) or (n, k) after the low pass."""
        out = np.array(x, float)
        for firsts, length, rate_hz in self.together:
            if len(firsts) == 1:
                rows: Any = slice(firsts[0], firsts[0] + length)
            else:
                rows = np.arange(length)[:, None] + firsts
            passed = low_pass(out[rows], rate_hz, self.cut_hz)
            if passed is not None:
                out[rows] = passed
        return out


def low_pass_of(t: Array, segment: NDArray[np.int64], cut_hz: float, *, alike: bool = False) -> LowPass:
    """Return the low pass for signals at t [s] (n,) in stretches of these numbers (n,).

    With `alike`, as for the windows of one log, sampling rates that differ by rounding are one.
    """
    together: dict[tuple[int, float], list[int]] = {}
    first_rate = 0.0
    for rows in rows_of_each(segment):
        if len(rows) > LEAST_FILTERED:
            rate = 1.0 / float(np.median(np.diff(t[rows])))
            first_rate = first_rate or rate
            if alike and abs(rate - first_rate) < ROUNDED_RATE * rate:
                rate = first_rate
            together.setdefault((len(rows), rate), []).append(int(rows[0]))
    return LowPass(
        tuple((np.array(firsts), length, rate) for (length, rate), firsts in together.items()), cut_hz
    )


def is_even(t: Array) -> bool:
    """Return whether the time stamps t [s] (n,) are on an even grid, up to rounding."""
    grid = np.linspace(t[0], t[-1], len(t))
    return len(t) < 3 or float(np.max(np.abs(t - grid))) <= JITTER * (t[-1] - t[0]) / (len(t) - 1)


def motion(t: Array, theta: Array, cut_hz: float) -> tuple[Array, Array, Array, bool]:
    """Return angle [rad], velocity [rad/s], acceleration [rad/s^2] of one stretch (n,), and if low-passed.

    Unevenly sampled angles are interpolated linearly on a grid of the median step, filtered and
    differentiated there, and interpolated back to the rows. If a log is too coarse for the low pass, a
    quintic spline through the raw angle is differentiated: differences over such coarse steps would lose part
    of the acceleration, and the additional noise of the spline is averaged out by the windows of such a log.
    """
    if len(t) < 3:
        return theta, np.full_like(t, np.nan), np.full_like(t, np.nan), False
    step = float(np.median(np.diff(t)))
    even = is_even(t)
    count = len(t) if even else int(np.ceil((t[-1] - t[0]) / step)) + 1
    grid = np.linspace(t[0], t[-1], count)
    step = (t[-1] - t[0]) / (count - 1)
    raw = theta if even else np.interp(grid, t, theta)
    angle = low_pass(raw, 1.0 / step, cut_hz)
    if angle is None:
        spline = make_interp_spline(t, theta, k=min(5, (len(t) - 2) // 2 * 2 + 1))
        return theta, spline(t, nu=1), spline(t, nu=2), False
    # Central differences would take 2 % from the acceleration at a twenty-fifth of the sampling rate, and
    # 12 % at a tenth, where the other side of the balance keeps it; a quintic spline takes 0.02 % there.
    spline = make_interp_spline(grid, angle, k=5)
    velocity, acceleration = spline(grid, nu=1), spline(grid, nu=2)
    if not even:
        angle, velocity, acceleration = (np.interp(t, grid, x) for x in (angle, velocity, acceleration))
    return angle, velocity, acceleration, True


def span_velocity(t: Array, theta: Array) -> Array:
    """Return the velocity [rad/s] (n,) of the raw angle over +-20 ms, at least +-1 step; NaN at the ends."""
    if len(t) < 3:
        return np.full_like(t, np.nan)
    half = max(HALF_SPAN_S, float(np.median(np.diff(t))))
    # The tolerance keeps rows whose span ends at the first or the last time stamp, up to rounding.
    inside = (t - half >= t[0] - 1e-9) & (t + half <= t[-1] + 1e-9)
    rise = np.interp(t + half, t, theta) - np.interp(t - half, t, theta)
    return np.where(inside, rise / (2.0 * half), np.nan)


def moves(t: Array, velocity: Array, threshold: float) -> Mask:
    """Return the rows (n,) faster than the threshold [rad/s] whose velocity keeps its sign within +-60 ms."""
    sign = np.sign(velocity)
    changes = np.concatenate([[0], np.cumsum(sign[1:] != sign[:-1])])
    first = np.searchsorted(t, t - REVERSAL_S - 1e-9)
    last = np.searchsorted(t, t + REVERSAL_S + 1e-9) - 1
    # NaN at the ends differs from itself, so rows near the ends do not count as moving.
    return (np.abs(velocity) > threshold) & (changes[first] == changes[last])


def away_from_ends(t: Array) -> Mask:
    """Return the rows (n,) more than 0.5 s from either end of the stretch t [s]."""
    return (t > t[0] + END_S) & (t < t[-1] - END_S)
