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
import math

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from eccentric.core import InputError
from eccentric.rigs import Rig
from eccentric.signals.filters import LowPass
from eccentric.signals.limits import (
    LEAST_RUN_PART,
    LEAST_STEPS,
    LEAST_WINDOWS,
    MANY_RUNS,
    MOVING_PART,
    STEPS,
    UNEVEN_STEP,
    WINDOW_PERIODS,
)
from eccentric.signals.measured import Channels
from eccentric.signals.motion import clear_of_ends
from eccentric.signals.rows import Rows, blocks_of, in_order
from eccentric.signals.windows import hann_windows, windows_by_parts

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

LONGER = "no shorter window gives enough; a longer log is required"


def fit_rows(channels: Channels, rig: Rig) -> Rows:
    """The rows that `eccentric fit` minimises over. Raises InputError if an average has none.

    Rows of the log are weighted by the time that they represent. Weights from an estimate of the noise would
    suit sensor noise, but usually what the model omits dominates, and a fit should then be best where the log
    has most of its time.
    """
    if rig.sampling.average_over:
        return rows_of(channels, rig)
    if channels.time.points_per_row > 1:
        return _by_parts(channels)
    weights = _durations(channels.time.t, channels.time.segment, channels.time.logged_step_s)
    return dataclasses.replace(_samples(channels, rig), weights=weights, description="rows")


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
    if not whole and _length(channels, rig) <= LEAST_STEPS * channels.time.logged_step_s:
        remedy = LONGER
    for name, words in (("train", "to fit"), ("score", "to hold out")):
        if not len(found[name]):
            raise InputError(
                f"{rig.path}: average_over", f"at least one of the {what}", f"none: {remedy}", why=words
            )
    return dataclasses.replace(
        in_order(list(found.values())), description=what, smooth=_smoothing(channels, rig), remedy=remedy
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
        length = WINDOW_PERIODS / rig.sampling.low_pass_hz
        found = hann_windows(time.t, clear, time.segment, time.run, length)
        _require_windows(found, length, channels, rig, moving)
    if found.independent:
        return found
    if channels.time.points_per_row == 1:
        found = dataclasses.replace(found, smooth=_low_pass(channels, rig))
    runs = np.unique(found.run, return_inverse=True)[1]
    return dataclasses.replace(found, block=runs) if runs.max() + 1 >= MANY_RUNS else found


def _require_windows(found: Rows, length: float, channels: Channels, rig: Rig, moving: bool) -> None:
    if len(found) >= LEAST_WINDOWS:
        return
    time, clear = channels.time, channels.selection.fit_rows if moving else _clear(channels)
    shortest = hann_windows(time.t, clear, time.segment, time.run, LEAST_STEPS * time.logged_step_s)
    # Averages replace the windows of the mechanical balance, not those of the electrical one.
    both = channels.motor.current is not None and channels.motor.voltage is not None
    key = f"low_pass_hz above {rig.sampling.low_pass_hz:g}" if both else f"average_over below {length:.3g} s"
    remedy = (
        f"the log is short: a longer one is the remedy; {key} gives more"
        if len(shortest) >= LEAST_WINDOWS
        else LONGER
    )
    raise InputError(
        rig.path,
        f"at least {LEAST_WINDOWS} windows of {length:.3g} s in the training part",
        f"{len(found)}: {remedy}",
        plural=True,
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
    return rig.sampling.average_over or STEPS * channels.time.logged_step_s


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
    gaps = np.where(same, np.diff(t), step)
    durations = (np.concatenate([[step], gaps]) + np.concatenate([gaps, [step]])) / (2.0 * step)
    # Rounded stamps are not uneven sampling.
    even = bool(np.all(np.abs(gaps / step - 1.0) < UNEVEN_STEP))
    return np.ones_like(t) if even else durations


def _by_parts(channels: Channels) -> Rows:
    """Windows of twelve steps with most of their weight on moving rows, integrated by parts.

    An integral may contain a reversal, a row may not; only at standstill is friction undetermined.
    """
    time, rows = channels.time, channels.selection
    found = windows_by_parts(time.t, time.segment, time.run, STEPS * time.logged_step_s)
    kept = found.mean(rows.usable.astype(float)) >= MOVING_PART
    kept &= found.inside(rows.usable | ~rows.moving)
    train, score = (kept & found.inside(part) for part in (~rows.held_out, rows.held_out))
    return dataclasses.replace(found, train=train, score=score)


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
    return found.chosen(np.flatnonzero(found.mean(usable.astype(float)) >= MOVING_PART))


def _run_means(channels: Channels, usable: Mask) -> Rows:
    """Means of runs; one that is usable only in pieces says little about its speed and is left out."""
    every = np.bincount(channels.time.run)
    used = np.bincount(channels.time.run[usable], minlength=len(every))
    runs = np.flatnonzero(used > LEAST_RUN_PART * every)
    columns = [np.flatnonzero(usable & (channels.time.run == run)) for run in runs]
    sizes = np.array([len(c) for c in columns], dtype=int)
    index, pointer = np.concatenate([np.empty(0, int), *columns]), np.concatenate([[0], np.cumsum(sizes)])
    weights = np.repeat(1.0 / sizes, sizes)
    operator = csr_array((weights, index, pointer), shape=(len(runs), len(channels.time.t)))
    all_of_them = np.ones(len(runs), dtype=bool)
    return Rows(
        t=operator @ channels.time.t,
        run=runs,
        block=np.arange(len(runs)),
        train=all_of_them,
        score=~all_of_them,
        weights=np.ones(len(runs)),
        description="whole runs",
        operator=operator,
        independent=True,
    )
