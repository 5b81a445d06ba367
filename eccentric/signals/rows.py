"""The rows on which models are compared: those of the log, or averages where the log asks for them.

Both sides of a balance are averaged with the same weights, so that what the average takes away is noise and
quantisation above its band.  Averages are taken over

- the time that the rig names (`average_over`), or twelve steps where a log is too coarse for the low pass,
  with a Hann window;
- whole runs (`average_over = "run"`), for benches that hold a speed and log it.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, vstack

from eccentric.errors import InputError
from eccentric.rigs import Rig
from eccentric.signals.filters import smoothed
from eccentric.signals.measured import Channels
from eccentric.signals.moving import clear_of_ends
from eccentric.signals.residual import Windows, make_windows
from eccentric.signals.windowed import MOVING_PART, STEPS, Sampling

__all__ = ["LEAST_HELD_OUT", "MANY_RUNS", "Rows", "averaged", "require_rows", "rows_of", "search_windows"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

MANY_RUNS = 5
"""Runs in the training part from which each is left out as a whole in cross-validation."""
LEAST_HELD_OUT = 2
"""Rows that an error on what is held out has an interval from."""
LEAST_PART = 1 / 3
"""Part of a run that has to be usable for a mean of it; the ends of a short run take a third themselves."""
WINDOW_S = 0.064
"""Length of the search's windows for a low pass of 25 Hz, s; in proportion to its period for others."""


@dataclass(frozen=True)
class Rows:
    """m rows: `train` and `score` (m,) tell what is fitted and what is held out; `t` [s] and `run` (m,).

    `weights` (m, n) takes samples to rows, None where rows are samples; `description` says what a row is.
    """

    t: Array
    run: NDArray[np.int64]
    train: Mask
    score: Mask
    weights: csr_matrix | None
    description: str
    smooth: Callable[[Array], Array] | None = None

    def mean(self, x: Array) -> Array:
        """Samples (n,) or (n, k) to rows (m,) or (m, k), in the unit of x."""
        return self.filtered(x if self.smooth is None else self.smooth(x))

    def filtered(self, x: Array) -> Array:
        """The same of what has passed the low pass already: the acceleration, which comes from the angle."""
        return np.asarray(x, float) if self.weights is None else self.weights @ x


def rows_of(channels: Channels, rig: Rig) -> Rows:
    """The rows that errors are reported on. Raises InputError if none is left to fit on or to hold out."""
    if not rig.average_over and channels.points_per_row == 1:
        c = channels
        return Rows(c.t, c.run, c.fit_rows, c.score_rows, None, "rows of the log")
    train, score = (_averages(channels, rig, part) for part in (~channels.held_out, channels.held_out))
    for name, part in (("to fit", train), ("to hold out", score)):
        if not part.weights.shape[0]:
            raise InputError(f"{rig.path}: average_over: at least one average {name} is required, found none")
    weights = vstack([train.weights, score.weights]).tocsr()
    t = np.concatenate([train.time, score.time])
    first = np.array([weights.indices[a] for a in weights.indptr[:-1]])
    order = np.argsort(first, kind="stable")
    held = order >= len(train.time)
    what = "whole runs" if math.isinf(rig.average_over) else f"averages over {_length(channels, rig):.3g} s"
    return Rows(
        t[order], channels.run[first[order]], ~held, held, weights[order], what, _smoothing(channels, rig)
    )


def require_rows(part: Mask, least: int, what: str, where: str) -> None:
    """Raise InputError where a part (m,) of the rows has fewer than `least`; `where` names the log."""
    if (count := int(np.count_nonzero(part))) < least:
        raise InputError(f"{where}: at least {least} moving {what} are required, received {count}")


def averaged(channels: Channels, rig: Rig) -> Sampling:
    """The rows of a fit where the rig wants averages."""
    rows = rows_of(channels, rig)
    # Means of whole runs are independent; averages over a time overlap and share what is slow.
    least = 3 if math.isinf(rig.average_over) else 10
    return Sampling(rows.t, rows.train, rows.score, np.ones(len(rows.t)), rows, rows.description, least)


def search_windows(channels: Channels, rig: Rig, moving: bool = True) -> Windows:
    """The windows of the training part that effects are searched on; all rows, moving or not, if asked.

    With five runs or more, a block is a whole run: what differs from run to run, a temperature or a gain, is
    to be predicted for a run that was not seen.
    """
    found = _windows(channels, rig, moving)
    found = dataclasses.replace(found, smooth=_smoothing(channels, rig))
    if found.independent:
        return found
    first = found.weights.indices[found.weights.indptr[:-1]]
    runs = np.unique(channels.run[first], return_inverse=True)[1]
    return dataclasses.replace(found, block=runs) if runs.max() + 1 >= MANY_RUNS else found


def _smoothing(channels: Channels, rig: Rig) -> Callable[[Array], Array] | None:
    """The low pass of the angle, for all that is compared with its acceleration over a time.

    Friction jumps where the drive and the acceleration of a filtered angle do not.
    """
    cut = rig.drive_low_pass_hz
    return None if cut is None else partial(smoothed, channels.t, channels.segment, cut_hz=cut)


def _windows(channels: Channels, rig: Rig, moving: bool) -> Windows:
    if moving and (rig.average_over or channels.points_per_row > 1):
        return _averages(channels, rig, ~channels.held_out)
    rows = channels.fit_rows if moving else ~channels.held_out & clear_of_ends(channels.t, channels.segment)
    return make_windows(channels.t, rows, channels.segment, WINDOW_S * 25.0 / rig.low_pass_hz)


def _length(channels: Channels, rig: Rig) -> float:
    return rig.average_over or STEPS * channels.logged_step_s


def _averages(channels: Channels, rig: Rig, part: Mask) -> Windows:
    usable = channels.usable & part
    if math.isinf(rig.average_over):
        return _runs(channels, usable)
    if rig.average_over:
        return make_windows(channels.t, usable, channels.segment, rig.average_over, least=1)
    # An average passes a reversal, where a row does not; only standstill leaves friction open.
    allowed = part & (channels.usable | ~channels.moving)
    found = make_windows(channels.t, allowed, channels.segment, _length(channels, rig), least=1)
    kept = np.flatnonzero(found.weights @ usable.astype(float) >= MOVING_PART)
    return Windows(found.weights[kept], found.block[kept], found.time[kept])


def _runs(channels: Channels, usable: Mask) -> Windows:
    """Means of runs; one that is usable only in pieces says little of its speed and is left out."""
    rows, used = (
        np.bincount(channels.run),
        np.bincount(channels.run[usable], minlength=channels.run.max() + 1),
    )
    runs = np.flatnonzero(used > LEAST_PART * rows)
    columns = [np.flatnonzero(usable & (channels.run == run)) for run in runs]
    sizes = np.array([len(c) for c in columns], dtype=int)
    rows, pointer = np.concatenate([np.empty(0, int), *columns]), np.concatenate([[0], np.cumsum(sizes)])
    weights = csr_matrix((np.repeat(1.0 / sizes, sizes), rows, pointer), (len(runs), len(channels.t)))
    return Windows(weights, np.arange(len(runs)), weights @ channels.t, independent=True)
