"""The rows of a log under a rig: for a fit, for the comparison of models, for the search.

    samples        of the log, if it is sampled finely and the rig requires nothing else: a fit passes both
                   sides through the low pass of the angle, a held-out error is that of the drive as logged
    windows        integrated by parts, if the log is too coarse to be differentiated (`windows_by_parts`)
    averages       over the time that the rig names (`average_over`), or twelve steps of a coarse log
    means of runs  for benches that log constant speeds (`average_over = "run"`)
    windows        of the search: short ones, over training rows only (`hann_windows`)

A fit minimises over `fit_rows`; models are compared on `rows_of`; effects are searched on `search_rows`.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from eccentric.core import InputError, few
from eccentric.rigs import Rig
from eccentric.signals import limits
from eccentric.signals.filters import LowPass, rows_of_each
from eccentric.signals.measured import Channels
from eccentric.signals.motion import clear_of_ends, white_noise
from eccentric.signals.rows import Rows, blocks_of, in_order

# Means as windowed integrals, for logs too coarse to differentiate: integrate by parts instead.
#
# A window carries the smooth weight psi(s) ~ (1 - s^2)^4 with s from -1 to 1, of integral one, which vanishes
# with three derivatives at both ends.  So
#
#     mean(x)              = integral of psi x dt
#     mean second rate(x)  = integral of psi d2x/dt2 dt   =  integral of psi'' x dt
#
# and a balance becomes one row per window, in its own unit, with the angle as it was logged.


Array = NDArray[np.float64]
Integers = NDArray[np.int64]

_POWER = 4


def windows_by_parts(t: Array, segment: Integers, run: Integers, window_s: float) -> Rows:
    """Return a row for each window of `window_s`, centres half a window apart, none across a gap.

    t [s] (n,) may be uneven; weights are corrected so that constants, slopes and parabolas are exact. All
    rows belong to the training part.

    Raises InputError if a window holds fewer than 7 rows, or no window fits into the log.
    """
    if not window_s > 0.0:
        raise InputError("windows", "a length above 0 s", f"{window_s:g}")
    half = window_s / 2.0
    centres: list[Array] = []
    bounds: list[Integers] = []
    for rows in rows_of_each(segment):
        stretch = t[rows]
        count = int(np.floor((stretch[-1] - stretch[0] - window_s) / half + 1e-9)) + 1
        centre = stretch[0] + half + half * np.arange(max(count, 0))
        # The tolerance keeps rows that are on the edge up to rounding; their weight is negligible.
        ends = [np.searchsorted(stretch, centre + side * (half + 1e-9)) for side in (-1.0, 1.0)]
        centres.append(centre)
        bounds.append(rows[0] + np.stack(ends))
    middle = np.concatenate(centres)
    first, stop = np.concatenate(bounds, axis=1)
    sizes = stop - first
    if not len(middle):
        raise InputError("windows", f"a stretch of {window_s:g} s without a gap", "none")
    if sizes.min() < limits.LEAST_WINDOW_ROWS:
        raise InputError(
            "windows", f"at least {limits.LEAST_WINDOW_ROWS} rows in {window_s:g} s", sizes.min()
        )
    pointer = np.concatenate([[0], np.cumsum(sizes)])
    columns = np.empty(pointer[-1], dtype=np.int64)
    values = np.empty((2, pointer[-1]))
    for size in np.unique(sizes):
        same = np.flatnonzero(sizes == size)
        entries = pointer[same, None] + np.arange(size)
        columns[entries] = first[same, None] + np.arange(size)
        values[:, entries] = weights_by_parts(t[columns[entries]] - middle[same, None], half)
    shape = (len(middle), len(t))
    mean, second = (csr_array((row, columns, pointer), shape=shape) for row in values)
    block, what = blocks_of(middle, segment[first], t), f"windows of {window_s:.3g} s"
    return dataclasses.replace(_means(what, mean, middle, run[first], block), rate_operator=second)


def _means(description: str, operator: csr_array, t: Array, run: Integers, block: Integers) -> Rows:
    """Rows that are means, all of them for training."""
    every = np.ones(len(t), dtype=bool)
    return Rows(t, run, block, every, ~every, np.ones(len(t)), description, operator)


def weights_by_parts(t: Array, half: float, rates: Sequence[int] = (0, 2), degree: int = 2) -> Array:
    """Return weights (rates, m, n) that make means over windows, and mean rates, of samples at times t.

    t (m, n) counts from the centres and may be uneven, half is half of the length. The mean is by psi, the
    first and the second rate by -psi' and psi''. They are exact for polynomials up to a degree: the sum over
    few samples is not the integral.
    """
    s = t / half
    bump = np.clip(1.0 - s * s, 0.0, None)
    p = _POWER
    every = (
        bump**p,
        2.0 * p * s * bump ** (p - 1) / half,
        2.0 * p * bump ** (p - 2) * ((2.0 * p - 1.0) * s * s - 1.0) / half**2,
    )
    curves = np.stack([every[rate] for rate in rates])
    area = np.gradient(t, axis=-1)
    curves *= area / np.sum(bump**p * area, axis=-1, keepdims=True)
    # Uncorrected, the quadrature error of psi'' would multiply the large constant part of an angle.
    powers = np.stack([s**k / math.factorial(k) for k in range(degree + 1)])
    moments = np.einsum("cmn,pmn->mcp", curves, powers)
    exact = np.zeros_like(moments)
    for place, rate in enumerate(rates):
        # A rate of s^k/k! is s^(k - rate)/(k - rate)!, of which the weight itself makes a mean.
        exact[:, place, rate] = 1.0 / half**rate
        if rate + 2 <= degree:
            exact[:, place, rate + 2] = moments[:, 0, 2] / half**rate
    gram = np.einsum("pmn,qmn,mn->mpq", powers, powers, bump**p)
    change = np.linalg.solve(gram, np.swapaxes(exact - moments, 1, 2))
    return curves + np.einsum("mpc,pmn,mn->cmn", change, powers, bump**p)


# Means with a Hann window, for logs that are sampled finely enough to be filtered and differentiated.
#
# A balance is integrated against a smooth window in the sense of the weak form.  Target and columns pass the
# same window, so its low pass cancels out, except that noise and quantisation above its band are removed.
# Windows are spaced by a quarter of their length.


Mask = NDArray[np.bool_]


def hann_windows(time: Array, valid: Mask, segment: Integers, run: Integers, length_s: float) -> Rows:
    """Return a row for each Hann window whose samples are all valid, all of them for training.

    time (n,) [s], valid (n,), segment (n,) number of the stretch without gap, run (n,); stretches may differ
    in their sampling. Blocks do not extend across gaps.
    """
    label = np.unique(segment, return_inverse=True)[1]
    thinning = int(np.ceil(np.count_nonzero(valid) / limits.MOST_WINDOWS))
    data, index, sizes = [np.empty(0)], [np.empty(0, int)], [np.empty(0, int)]
    for rows in rows_of_each(label):
        step = float(np.median(np.diff(time[rows]))) if len(rows) > 1 else length_s
        half = max(1, round(0.5 * length_s / step))
        kernel = np.hanning(2 * half + 1)[1:-1] if half > 1 else np.ones(1)
        reach = len(kernel) // 2
        centre = np.arange(reach, len(rows) - reach, max(1, half // 2, thinning))
        bad = np.r_[0, np.cumsum(~np.asarray(valid[rows], bool))]
        whole = bad[centre + reach + 1] == bad[centre - reach]
        lasts = time[rows[centre + reach]] - time[rows[centre - reach]]
        whole &= lasts < limits.WINDOW_GAP * 2 * reach * step + step
        centre = centre[whole]
        index.append((rows[centre, None] + np.arange(-reach, reach + 1)).ravel())
        data.append(np.tile(kernel / kernel.sum(), len(centre)))
        sizes.append(np.full(len(centre), len(kernel)))
    width = np.concatenate(sizes)
    pointer = np.r_[0, np.cumsum(width)]
    columns = np.concatenate(index)
    centre = columns[pointer[:-1] + width // 2]
    operator = csr_array((np.concatenate(data), columns, pointer), shape=(len(width), len(time)))
    block = blocks_of(time[centre], label[centre], time)
    return _means(f"windows of {length_s:.3g} s", operator, time[centre], run[centre], block)


LONGER = "no shorter window gives enough: record longer"


def fit_rows(channels: Channels, rig: Rig) -> Rows:
    """The rows that `eccentric fit` minimises over. Raises InputError if an average has none.

    Rows of the log are weighted by the time that they represent. Weights from an estimate of the noise would
    suit sensor noise, but usually what the model omits dominates, and a fit should then be best where the log
    has most of its time.
    """
    if rig.sampling.average_over:
        return rows_of(channels, rig)
    if channels.time.points_per_row > 1:
        found = _by_parts(channels)
        if np.count_nonzero(found.train) >= limits.LEAST_WINDOWS:
            return found
        return dataclasses.replace(found, remedy=_fewer_steps(channels, rig))
    weights = _durations(channels.time.t, channels.time.segment, channels.time.logged_step_s)
    return dataclasses.replace(_samples(channels, rig), weights=weights, description="rows")


def _shorter(channels: Channels, rig: Rig, lengths: Iterable[float]) -> tuple[str, int]:
    """The first of some averages [s] that are enough, as a key of a rig, and their number; "" for none."""
    held = channels.selection.held_out
    for over in lengths:
        tried = dataclasses.replace(rig, sampling=dataclasses.replace(rig.sampling, average_over=over))
        fitted, scored = (len(_averages(channels, tried, part)) for part in (~held, held))
        if fitted >= limits.LEAST_WINDOWS and scored >= limits.LEAST_HELD_OUT:
            return f'average_over = "{over:.2g} s"', fitted
    return "", 0


def _fewer_steps(channels: Channels, rig: Rig) -> str:
    """What helps a coarse log with too few windows of the default's length."""
    step = channels.time.logged_step_s
    steps = range(limits.STEPS - 1, limits.LEAST_STEPS - 1, -1)
    key, count = _shorter(channels, rig, (k * step for k in steps))
    default = f"a window is {limits.STEPS} steps by default"
    return f"{default}, {key} in {rig.path} gives {count}" if key else LONGER


def _half_as_long(channels: Channels, rig: Rig) -> str:
    """What helps a log with too few averages of the rig's length: shorter ones by halves."""
    least, over = limits.LEAST_STEPS * channels.time.logged_step_s, _length(channels, rig)
    halves = itertools.takewhile(lambda x: x >= least, (over * 0.5**k for k in itertools.count(1)))
    key, count = _shorter(channels, rig, halves)
    return f"in {rig.path}, {key} gives {count}" if key else LONGER


def rows_of(channels: Channels, rig: Rig) -> Rows:
    """The rows that models are compared on. Raises InputError if there is none to fit on or to hold out."""
    if not rig.sampling.average_over and channels.time.points_per_row == 1:
        return _samples(channels, rig)
    parts = {"train": ~channels.selection.held_out, "score": channels.selection.held_out}
    found = {name: _averages(channels, rig, part).for_part(name) for name, part in parts.items()}
    whole = math.isinf(rig.sampling.average_over)
    what = "whole runs" if whole else f"averages over {_length(channels, rig):.3g} s"
    shorter = 'a time, such as "0.1 s"' if whole else "a shorter time"
    remedy = f"in {rig.path}, {shorter} as average_over gives more"
    scarce = len(found["train"]) < limits.LEAST_WINDOWS or len(found["score"]) < limits.LEAST_HELD_OUT
    at_least = _length(channels, rig) <= limits.LEAST_STEPS * channels.time.logged_step_s
    if not whole and (scarce or at_least):
        remedy = _half_as_long(channels, rig)
    for name, words in (("train", "to fit"), ("score", "to hold out")):
        if not len(found[name]):
            if remedy == LONGER:
                raise _too_short(channels, rig, parts[name], what, words)
            raise InputError(
                f"{rig.path}: average_over", f"at least one of the {what}", f"none: {remedy}", why=words
            )
    return dataclasses.replace(
        in_order(list(found.values())), description=what, smooth=_smoothing(channels, rig), remedy=remedy
    )


def _too_short(channels: Channels, rig: Rig, part: Mask, what: str, words: str) -> InputError:
    """The error of a log without a whole average in a part of it (n,)."""
    rows, move = (
        round(np.count_nonzero(part & x) / channels.time.points_per_row)
        for x in (True, channels.selection.usable)
    )
    needed = math.ceil(_length(channels, rig) / channels.time.logged_step_s)
    return InputError(
        few(channels.intake.logs) or rig.path,
        f"at least one of the {what}",
        f"none: of {rows} rows {words}, {move} move clear of reversals and ends,"
        f" and an average takes {needed} in a row: record a longer log",
        why=words,
    )


def search_rows(channels: Channels, rig: Rig, moving: bool = True) -> Rows:
    """The rows of the training part that effects are searched on; optionally all rows, moving or not.

    With five runs or more, a block is a whole run: whatever differs from run to run, such as a temperature or
    a gain, has to be predicted for an unseen run.
    """
    if moving and (rig.sampling.average_over or channels.time.points_per_row > 1):
        found = _averages(channels, rig, ~channels.selection.held_out)
    else:
        time, clear = channels.time, channels.selection.fit_rows if moving else _clear(channels)
        length = limits.WINDOW_PERIODS / rig.sampling.low_pass_hz
        found = hann_windows(time.t, clear, time.segment, time.run, length)
        _require_windows(found, length, channels, rig, moving)
    if found.independent:
        return found
    if channels.time.points_per_row == 1:
        found = dataclasses.replace(found, smooth=_low_pass(channels, rig))
    runs = np.unique(found.run, return_inverse=True)[1]
    return dataclasses.replace(found, block=runs) if runs.max() + 1 >= limits.MANY_RUNS else found


def _require_windows(found: Rows, length: float, channels: Channels, rig: Rig, moving: bool) -> None:
    if len(found) >= limits.LEAST_WINDOWS:
        return
    time, clear = channels.time, channels.selection.fit_rows if moving else _clear(channels)
    shortest = hann_windows(time.t, clear, time.segment, time.run, limits.LEAST_STEPS * time.logged_step_s)
    # Averages replace the windows of the mechanical balance, not those of the electrical one.
    both = channels.motor.current is not None and channels.motor.voltage is not None
    key = f"low_pass_hz above {rig.sampling.low_pass_hz:g}" if both else f"average_over below {length:.3g} s"
    remedy = (
        f"the log is short: record a longer one; {key} gives more"
        if len(shortest) >= limits.LEAST_WINDOWS
        else LONGER
    )
    raise InputError(
        rig.path,
        f"at least {limits.LEAST_WINDOWS} windows of {length:.3g} s in the training part",
        f"{len(found)}: {remedy}",
    )


def _clear(channels: Channels) -> Mask:
    return ~channels.selection.held_out & clear_of_ends(channels.time.t, channels.time.segment)


def _smoothing(channels: Channels, rig: Rig) -> LowPass | None:
    return None if rig.sampling.drive_low_pass_hz is None else _low_pass(channels, rig)


def _low_pass(channels: Channels, rig: Rig) -> LowPass:
    """The low pass of the angle, for all that is compared with its acceleration.

    Friction jumps at a reversal, and the drive with it; the acceleration of a filtered angle does not.
    Unfiltered, the difference looks like an effect some 60 ms about each reversal.
    """
    return channels.low_pass(rig)


def _length(channels: Channels, rig: Rig) -> float:
    return rig.sampling.average_over or limits.STEPS * channels.time.logged_step_s


def _samples(channels: Channels, rig: Rig) -> Rows:
    """The rows of the log."""
    t, rows = channels.time.t, channels.selection
    return Rows(
        t,
        channels.time.run,
        blocks_of(t, channels.time.segment, t),
        rows.fit_rows,
        rows.score_rows,
        np.ones_like(t),
        "rows of the log",
        smooth=_low_pass(channels, rig),
        as_logged=~rows.fit_rows,
    )


def _durations(t: Array, segment: Integers, step: float) -> Array:
    """Return the time between the midpoints to the previous and the next row, in median steps."""
    same = np.diff(segment) == 0
    gaps = np.where(same, np.diff(t), step) / step
    # Rounded stamps are not uneven sampling, and a missing row is no more than that.
    whole = np.round(gaps)
    if np.all(np.abs(gaps - whole) < limits.UNEVEN_STEP) and np.all(whole > 0.0):
        gaps = whole
    return (np.concatenate([[1.0], gaps]) + np.concatenate([gaps, [1.0]])) / 2.0


def _by_parts(channels: Channels) -> Rows:
    """Windows with most of their weight on moving rows, integrated by parts; longer ones for a noisy angle.

    An integral may contain a reversal, a row may not; only at standstill is friction undetermined.
    """
    found = _windows(channels, limits.STEPS)
    for steps in limits.LONGER_STEPS:
        if not _enough(found) or _noise_of_rate(channels, found) <= limits.QUIET_RATE:
            break
        try:
            longer = _windows(channels, steps)
        except InputError:  # no stretch is as long
            break
        if not _enough(longer):
            break
        found = longer
    return found


def _windows(channels: Channels, steps: float) -> Rows:
    time, rows = channels.time, channels.selection
    found = windows_by_parts(time.t, time.segment, time.run, steps * time.logged_step_s)
    kept = found.mean(rows.usable.astype(float)) >= limits.MOVING_PART
    kept &= found.inside(rows.usable | ~rows.moving)
    train, score = (kept & found.inside(part) for part in (~rows.held_out, rows.held_out))
    every = dataclasses.replace(found, train=train, score=score)
    turns = found.mean((np.abs(channels.motion.omega_m) > rows.moving_threshold_rad_s).astype(float))
    for part in limits.TURNING_PARTS:
        turning = dataclasses.replace(found, train=train & (turns >= part), score=score & (turns >= part))
        if _enough(turning):
            return turning
    return every


def _enough(found: Rows) -> bool:
    return int(np.count_nonzero(found.train)) >= limits.LEAST_WINDOWS and bool(np.any(found.score))


def _noise_of_rate(channels: Channels, found: Rows) -> float:
    """The noise in the acceleration of the windows over the acceleration: its square is what J loses."""
    every = channels.time.points_per_row
    theta, segment = channels.motion.theta_logged[::every], channels.time.segment[::every]
    noise = white_noise(theta, segment) * math.sqrt(every)
    rate = found.chosen(found.train).rate_operator
    if rate is None:
        return 0.0
    squares = np.asarray(rate.multiply(rate).sum(axis=1)).ravel()
    size = rate @ channels.motion.theta_logged
    return noise * float(np.sqrt(np.mean(squares) / np.mean(size**2)))


def _averages(channels: Channels, rig: Rig, part: Mask) -> Rows:
    """Averages over samples of one part of the log (n,)."""
    time, rows, over = channels.time, channels.selection, rig.sampling.average_over
    usable = rows.usable & part
    if math.isinf(over):
        return _run_means(channels, usable)
    if over:
        return hann_windows(time.t, usable, time.segment, time.run, over)
    # As in `_by_parts`: an average may contain a reversal.
    allowed = part & (rows.usable | ~rows.moving)
    found = hann_windows(time.t, allowed, time.segment, time.run, _length(channels, rig))
    return found.chosen(np.flatnonzero(found.mean(usable.astype(float)) >= limits.MOVING_PART))


def _run_means(channels: Channels, usable: Mask) -> Rows:
    """Means of runs; one that is usable only in pieces says little about its speed and is left out."""
    every = np.bincount(channels.time.run)
    used = np.bincount(channels.time.run[usable], minlength=len(every))
    runs = np.flatnonzero(used > limits.LEAST_RUN_PART * every)
    columns = [np.flatnonzero(usable & (channels.time.run == run)) for run in runs]
    sizes = np.array([len(c) for c in columns], dtype=int)
    index, pointer = np.concatenate([np.empty(0, int), *columns]), np.concatenate([[0], np.cumsum(sizes)])
    weights = np.repeat(1.0 / sizes, sizes)
    operator = csr_array((weights, index, pointer), shape=(len(runs), len(channels.time.t)))
    found = _means("whole runs", operator, operator @ channels.time.t, runs, np.arange(len(runs)))
    return dataclasses.replace(found, independent=True)
