"""A sampled angle becomes angle, velocity and acceleration without phase lag, and a mask of moving rows.

A second-order Butterworth low pass runs forwards and backwards over the angle, a quintic spline through the
result is differentiated, and the raw angle gives the mask.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline
from scipy.linalg.lapack import dtbtrs

from eccentric.model import TURNING, AxisKind
from eccentric.rigs import COASTING, Rig
from eccentric.signals import limits

if TYPE_CHECKING:
    from collections.abc import Callable


# Stretches between gaps and ends of runs: nothing is filtered, interpolated or integrated across them.


Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def stretches(t: Array, run: Integers) -> Integers:
    """Return the number of the stretch of each row (n,): one starts with a run or after a gap in t [s]."""
    begins = np.ones(len(t), dtype=bool)
    begins[1:] = run[1:] != run[:-1]
    for rows in rows_of_each(run):
        steps = np.diff(t[rows])
        if len(steps):
            begins[rows[1:]] |= steps > limits.GAP_STEPS * np.median(steps)
    return np.cumsum(begins) - 1


def rows_of_each(number: NDArray[Any]) -> list[Integers]:
    """Return the rows of each stretch, in order; `number` (n,) is that of the stretch (or run)."""
    return np.split(np.arange(len(number)), np.flatnonzero(np.diff(number)) + 1)


def joined(number: NDArray[Any], function: Callable[[Integers], NDArray[Any]]) -> NDArray[Any]:
    """Concatenate the results of a function for the rows of each stretch."""
    return np.concatenate([function(rows) for rows in rows_of_each(number)])


Mask = NDArray[np.bool_]

_PADDING = 9
"""Rows by which a signal is extended at either end: three times the length of the filter."""


def low_pass(x: Array, rate_hz: float, cut_hz: float) -> Array | None:
    """Return evenly sampled x (n, ...) after a second-order Butterworth low pass without phase, or None.

    None if the cut-off frequency is above 0.4 of the sampling rate, or the stretch is too short.
    The result is that of SciPy's `sosfiltfilt`; importing `scipy.signal` takes longer than filtering a log.
    """
    if cut_hz > limits.COARSE * rate_hz or len(x) <= _PADDING:
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
        damaged: stretches that lack rows of their even grid: the first row, the places, the rate [Hz].
    """

    together: tuple[tuple[NDArray[np.int64], int, float], ...]
    cut_hz: float
    damaged: tuple[tuple[int, Integers, float], ...] = ()

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
        for first, places, rate_hz in self.damaged:
            rows = slice(first, first + len(places))
            grid = np.arange(places[-1] + 1)
            before = np.minimum(np.searchsorted(places, grid, side="right"), len(places) - 1) - 1
            share = (grid - places[before]) / np.diff(places)[before]
            fill = share.reshape(-1, *[1] * (out.ndim - 1))
            passed = low_pass(
                (1.0 - fill) * out[rows][before] + fill * out[rows][before + 1], rate_hz, self.cut_hz
            )
            if passed is not None:
                out[rows] = passed[places]
        return out


def low_pass_of(t: Array, segment: NDArray[np.int64], cut_hz: float, *, alike: bool = False) -> LowPass:
    """Return the low pass for signals at t [s] (n,) in stretches of these numbers (n,).

    With `alike`, as for the windows of one log, sampling rates that differ by rounding are one.
    """
    together: dict[tuple[int, float], list[int]] = {}
    damaged: list[tuple[int, Integers, float]] = []
    first_rate = 0.0
    for rows in rows_of_each(segment):
        if len(rows) > limits.LEAST_FILTERED:
            rate = 1.0 / float(np.median(np.diff(t[rows])))
            first_rate = first_rate or rate
            if alike and abs(rate - first_rate) < limits.ROUNDED_RATE * rate:
                rate = first_rate
            places = places_of(t[rows])
            if places is not None and places[-1] >= len(rows):
                damaged.append((int(rows[0]), places, rate))
            else:
                together.setdefault((len(rows), rate), []).append(int(rows[0]))
    whole = tuple((np.array(firsts), length, rate) for (length, rate), firsts in together.items())
    return LowPass(whole, cut_hz, tuple(damaged))


def is_even(t: Array) -> bool:
    """Return whether the time stamps t [s] (n,) are on an even grid, up to rounding."""
    grid = np.linspace(t[0], t[-1], len(t))
    return len(t) < 3 or float(np.max(np.abs(t - grid))) <= limits.JITTER * (t[-1] - t[0]) / (len(t) - 1)


def places_of(t: Array) -> Integers | None:
    """Return the places (n,) of time stamps t [s] (n,) on an even grid, of which rows may be missing.

    None if the stamps are on no such grid, up to rounding.
    """
    if is_even(t):
        return np.arange(len(t))
    steps = np.diff(t)
    places = np.concatenate([[0], np.cumsum(np.round(steps / np.median(steps)).astype(np.int64))])
    grid = np.linspace(t[0], t[-1], int(places[-1]) + 1)
    off = float(np.max(np.abs(t - grid[places])))
    on_grid = np.all(np.diff(places) > 0) and off <= limits.JITTER * (t[-1] - t[0]) / places[-1]
    return places if on_grid else None


def motion(t: Array, theta: Array, cut_hz: float) -> tuple[Array, Array, Array, bool]:
    """Return angle [rad], velocity [rad/s], acceleration [rad/s^2] of one stretch (n,), and if low-passed.

    Rows that are missing from an even grid are filled in by a cubic spline through the others. Angles on no
    such grid are interpolated linearly on one of the median step, filtered and differentiated there, and
    interpolated back to the rows. If a log is too coarse for the low-pass filter, a quintic spline through
    the raw angle is differentiated: differences over such coarse steps would lose part of the acceleration,
    and the additional noise of the spline is averaged out by the windows of such a log.
    """
    if len(t) < 3:
        return theta, np.full_like(t, np.nan), np.full_like(t, np.nan), False
    places = places_of(t)
    if places is None:
        count = int(np.ceil((t[-1] - t[0]) / float(np.median(np.diff(t))))) + 1
    else:
        count = int(places[-1]) + 1
    grid = np.linspace(t[0], t[-1], count)
    step = (t[-1] - t[0]) / (count - 1)
    raw = np.interp(grid, t, theta) if places is None else _filled(places, theta)
    angle = low_pass(raw, 1.0 / step, cut_hz)
    if angle is None:
        spline = make_interp_spline(t, theta, k=min(5, (len(t) - 2) // 2 * 2 + 1))
        return theta, spline(t, nu=1), spline(t, nu=2), False
    # Central differences would take 2 % from the acceleration at a twenty-fifth of the sampling rate, and
    # 12 % at a tenth, where the other side of the balance keeps it; a quintic spline takes 0.02 % there.
    spline = make_interp_spline(grid, angle, k=5)
    velocity, acceleration = spline(grid, nu=1), spline(grid, nu=2)
    if places is None:
        angle, velocity, acceleration = (np.interp(t, grid, x) for x in (angle, velocity, acceleration))
    elif len(t) < count:
        angle, velocity, acceleration = angle[places], velocity[places], acceleration[places]
    return angle, velocity, acceleration, True


def _filled(places: Integers, x: Array) -> Array:
    """A signal (n,) at these places on its grid (m,), by a cubic spline where rows are missing."""
    count = int(places[-1]) + 1
    if count == len(x):
        return x
    filled = np.asarray(make_interp_spline(places, x, k=3)(np.arange(count)))
    filled[places] = x
    return filled


def motion_of(
    t: Array, theta: Array, segment: Integers, cut_hz: float, axis: AxisKind = TURNING
) -> tuple[Array, list[str]]:
    """Return angle, velocity, acceleration as rows of (3, n), filtered stretch by stretch, and warnings."""
    plain: list[int] = []

    def one(rows: Integers) -> Array:
        *signals, smoothed = motion(t[rows], theta[rows], cut_hz)
        if not smoothed:
            plain.append(len(rows))
        return np.stack(signals, axis=1)

    signals = joined(segment, one)
    warnings: list[str] = []
    if plain and math.isinf(cut_hz):
        warnings.append(
            "the log is too coarse for the low-pass filter: velocity and acceleration are those of a spline "
            f"through the {axis.term('angle')}, averaged over windows of twelve steps"
        )
    elif plain:
        warnings.append(
            f"{sum(plain)} of {len(t)} rows are too coarse, or in stretches too short, for the "
            f"{cut_hz:g} Hz low-pass filter: their velocity and acceleration are those of a spline"
        )
    return signals.T, warnings


def span_velocity(t: Array, theta: Array) -> Array:
    """Return the velocity [rad/s] (n,) of the raw angle over +-20 ms, at least +-1 step; NaN at the ends."""
    if len(t) < 3:
        return np.full_like(t, np.nan)
    half = max(limits.HALF_SPAN_S, float(np.median(np.diff(t))))
    # The tolerance keeps rows whose span ends at the first or the last time stamp, up to rounding.
    inside = (t - half >= t[0] - 1e-9) & (t + half <= t[-1] + 1e-9)
    rise = np.interp(t + half, t, theta) - np.interp(t - half, t, theta)
    return np.where(inside, rise / (2.0 * half), np.nan)


def moves(t: Array, velocity: Array, threshold: float) -> Mask:
    """Return the rows (n,) faster than the threshold [rad/s] whose velocity keeps its sign within +-60 ms."""
    sign = np.sign(velocity)
    changes = np.concatenate([[0], np.cumsum(sign[1:] != sign[:-1])])
    first = np.searchsorted(t, t - limits.REVERSAL_S - 1e-9)
    last = np.searchsorted(t, t + limits.REVERSAL_S + 1e-9) - 1
    # NaN at the ends differs from itself, so rows near the ends do not count as moving.
    return (np.abs(velocity) > threshold) & (changes[first] == changes[last])


def away_from_ends(t: Array) -> Mask:
    """Return the rows (n,) more than 0.5 s, or a quarter, from either end of the stretch t [s]."""
    end = min(limits.END_S, limits.END_PART * float(t[-1] - t[0]))
    return (t > t[0] + end) & (t < t[-1] - end)


# What a log can resolve, unless the rig says so: cut-off, averages, or one mean per run.
#
# The default low pass of 25 Hz suits a fine encoder on evenly spaced time stamps.  A coarse or jittery angle
# has more noise than signal in its second derivative there, and that noise, times the inertia, looks like
# friction that depends on anything.  Its size is known in advance: white noise of the angle, measured by its
# fourth differences, gives after the zero-phase second-order low pass and two derivatives
#
# noise(alpha)^2 = noise(theta)^2 2 dt (2 pi)^4 f_c^5 I,   I = integral of x^4/(1 + x^4)^2 = pi/(8 sqrt 2)
#
# and from this follows the cut-off at which the noise is a given fraction of the acceleration.  Where a
# stiff drive accelerates its load faster than 25 Hz and the encoder shows it, the cut-off is raised
# instead: what the low pass took from the acceleration, and not from the drive, would look like an effect.
# A bench that logs constant speeds has hardly any acceleration: its runs are points, one mean each.


def suited(
    rig: Rig, t: Array, theta: Array, segment: NDArray[np.int64], moving: Mask, whole: Mask
) -> tuple[Rig, str]:
    """Return the rig with settings that suit its log, and a sentence on them; unchanged if it names a filter.

    t [s], theta [rad] at the motor, number of the stretch and whether it moves, each (n,); `whole`
    (stretches,) are those that the log has begun itself, not a window that was cut out of a longer one.
    """
    if rig.sampling.low_pass_given or rig.sampling.average_over:
        return rig, ""
    stretches = rows_of_each(segment)
    if rig.log.drive == COASTING and (over := _coasting(t, theta, stretches)):
        return _averaged(rig, rig.sampling.low_pass_hz, over), ""
    # Windows of one long run may each have one speed.
    if _is_map(t, theta, [rows for rows, own in zip(stretches, whole, strict=True) if own]):
        steps = [float(np.median(np.diff(t[rows]))) for rows in stretches if len(rows) > 1]
        cut = min(rig.sampling.low_pass_hz, limits.COARSE / max(steps))
        said = f"the log is {len(stretches)} runs of constant speed: one mean of each is compared"
        return _averaged(rig, cut, math.inf), said
    if not np.all(whole):
        places = np.linspace(0, len(stretches) - 1, limits.MOST_STRETCHES).round().astype(int)
        stretches = [stretches[k] for k in np.unique(places)]
    low_pass_hz = rig.sampling.low_pass_hz
    noise, size = _over_all(t, theta, moving, stretches, low_pass_hz)
    if not size:
        return rig, ""
    if noise <= limits.TOO_NOISY * size:
        return _raised(rig, t, theta, moving, stretches)
    signal = math.sqrt(max(size**2 - noise**2, (limits.TOO_NOISY * size) ** 2))
    cut = max(limits.LOWEST_HZ, low_pass_hz * (limits.QUIET * signal / noise) ** (2.0 / 5.0))
    said = (
        f"at {low_pass_hz:g} Hz encoder steps and time-stamp jitter of the {rig.axis.term('angle')} make up"
        f" {100 * noise / size:.0f} % of the"
        f" acceleration: the low-pass filter is set to {cut:.2g} Hz, and both sides are averaged over"
        f" {1.0 / cut:.2g} s (low_pass_hz and average_over in the rig file override this)"
    )
    return _averaged(rig, cut, 1.0 / cut), said


def _raised(
    rig: Rig, t: Array, theta: Array, moving: Mask, stretches: list[NDArray[np.int64]]
) -> tuple[Rig, str]:
    """The rig with the highest cut-off that the noise allows, if the load moves faster than the default."""
    default = chosen = rig.sampling.low_pass_hz
    noise, size = _over_all(t, theta, moving, stretches, default)
    seen = size**2 - noise**2
    most = limits.RAISED / max(
        float(np.median(np.diff(t[rows]))) for rows in stretches if len(rows) > limits.LEAST_STRETCH
    )
    missed, cut = 0.0, 2.0 * default
    # Stamps are rounded: a fifth of the rate is a fifth.
    while cut <= most * (1.0 + 1e-6):
        noise, size = _over_all(t, theta, moving, stretches, cut)
        if not size or noise > limits.TOO_NOISY * size:
            break
        if (beyond := size**2 - noise**2 - seen) > limits.FAST * seen:
            chosen, missed, seen = cut, missed + beyond, seen + beyond
        cut *= 2.0
    if chosen == default:
        return rig, ""
    said = (
        f"the load moves faster than {default:g} Hz, with {100 * missed / seen:.0f} % of the square of its"
        f" acceleration: the low-pass filter is set to {chosen:g} Hz"
        " (low_pass_hz in the rig file overrides this)"
    )
    return dataclasses.replace(rig, sampling=dataclasses.replace(rig.sampling, low_pass_hz=chosen)), said


def _coasting(t: Array, theta: Array, stretches: list[NDArray[np.int64]]) -> float:
    """A hundredth of the longest coast-down [s]; 0 where it turns back, as a pendulum does."""
    longest = max(stretches, key=lambda rows: t[rows[-1]] - t[rows[0]])
    coarse = theta[longest][:: max(1, len(longest) // int(limits.WINDOWS_OF_A_COAST))]
    lasts = float(t[longest[-1]] - t[longest[0]])
    return lasts / limits.WINDOWS_OF_A_COAST if np.ptp(np.sign(np.diff(coarse))) < 2.0 else 0.0


def _averaged(rig: Rig, cut_hz: float, over: float) -> Rig:
    sampling = dataclasses.replace(rig.sampling, low_pass_hz=cut_hz, average_over=over)
    return dataclasses.replace(rig, sampling=sampling)


def _is_map(t: Array, theta: Array, stretches: list[NDArray[np.int64]]) -> bool:
    """Whether each stretch has a constant speed, and not all have the same."""
    if len(stretches) < limits.MAP_RUNS:
        return False
    means, spreads = [], []
    for rows in stretches:
        if len(rows) < limits.MAP_PARTS:
            return False
        reach = len(rows) // limits.MAP_PARTS
        speed = (theta[rows[reach:]] - theta[rows[:-reach]]) / (t[rows[reach:]] - t[rows[:-reach]])
        means.append(float(np.mean(speed)))
        spreads.append(float(np.std(speed)) / max(abs(means[-1]), 1e-12))
    return float(np.median(spreads)) < limits.MAP_STEADY and np.ptp(means) > limits.MAP_RANGE * float(
        np.max(np.abs(means))
    )


def _over_all(
    t: Array, theta: Array, moving: Mask, stretches: list[NDArray[np.int64]], cut_hz: float
) -> tuple[float, float]:
    """RMS of the noise in the acceleration of all stretches, and of the whole [rad/s^2]; 0 if unknown."""
    parts = [
        _noise_and_size(t[r], theta[r], moving[r], cut_hz) for r in stretches if len(r) > limits.LEAST_STRETCH
    ]
    known = np.array([part for part in parts if part is not None]).reshape(-1, 2)
    if not len(known):
        return 0.0, 0.0
    noise, size = np.sqrt(np.mean(known**2, axis=0))
    return float(noise), float(size)


def _noise_and_size(t: Array, theta: Array, moving: Mask, cut_hz: float) -> tuple[float, float] | None:
    """RMS of the noise in the acceleration of a stretch, and of the whole [rad/s^2], over its moving rows."""
    step = float(np.median(np.diff(t)))
    grid = np.arange(t[0], t[-1], step)
    inside = np.interp(grid, t, moving.astype(float)) > 0.5
    difference = np.diff(np.interp(grid, t, theta), 4)[inside[2:-2]] / math.sqrt(70.0)
    _, _, acceleration, smooth = motion(t, theta, cut_hz)
    if not smooth or len(difference) < limits.LEAST_DIFFERENCES or not np.any(moving):
        return None
    gain = math.sqrt(2.0 * step * (2.0 * math.pi) ** 4 * cut_hz**5 * math.pi / (8.0 * math.sqrt(2.0)))
    size = float(np.sqrt(np.mean(acceleration[moving] ** 2)))
    return gain * float(np.sqrt(np.mean(difference**2))), size
