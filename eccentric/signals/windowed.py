"""The rows that a fit minimises over: those of the log, or windows where it is sampled too coarsely."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eccentric.signals.weak import Windows, windows

if TYPE_CHECKING:
    from eccentric.signals.measured import Channels
    from eccentric.signals.rows import Rows

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

STEPS = 12
"""Steps in a window: 0.3 s at 40 rows per second, where a second difference is mostly rounding."""

MOVING_PART = 0.5
"""Least part of a window's weight on moving rows."""


@dataclass(frozen=True)
class Sampling:
    """Rows that enter the balance, and how many of them a coefficient asks for (`per_coefficient`).

    Masks and weights (m,), times t [s] (m,); `windows` is None for the rows of the log. Weights are the time
    that a row stands for over its mean: one for evenly sampled logs. Weighting by what the noise is estimated
    to be would serve the noise of the sensors, but what dominates is usually what the model leaves out, and a
    fit should then be best where the log has been.
    """

    t: Array
    train: Mask
    score: Mask
    weights: Array
    windows: Windows | Rows | None
    description: str
    per_coefficient: int = 10

    def mean(self, x: Array) -> Array:
        """Bring signals (n,) or (n, k) of the log to the rows of the fit: (m,) or (m, k)."""
        return x if self.windows is None else self.windows.mean(x)

    def acceleration(self, channels: Channels) -> Array:
        """Motor acceleration [rad/s^2] (m,): integrated by parts from the logged angle where windowed."""
        if isinstance(self.windows, Windows):
            return self.windows.second_rate(channels.theta_logged)
        return channels.alpha_m if self.windows is None else self.windows.filtered(channels.alpha_m)


def sample(channels: Channels) -> Sampling:
    """Return the rows of the log, or windows of twelve steps if it is too coarse for the low pass."""
    step = channels.logged_step_s
    if channels.points_per_row == 1:
        weights = _durations(channels.t, channels.segment, step)
        return Sampling(channels.t, channels.fit_rows, channels.score_rows, weights, None, "rows")
    length = STEPS * step
    cut = windows(channels.t, channels.segment, length)
    # An integral passes a reversal, where a row does not; only standstill leaves friction open.
    kept = cut.mean(channels.usable.astype(float)) >= MOVING_PART
    kept &= cut.inside(channels.usable | ~channels.moving)
    return Sampling(
        cut.t,
        kept & cut.inside(~channels.held_out),
        kept & cut.inside(channels.held_out),
        np.ones(len(cut.t)),
        cut,
        f"windows of {length:.3g} s",
    )


def _durations(t: Array, segment: NDArray[np.int64], step: float) -> Array:
    """Return the time from half-way to the last to half-way to the next row, in median steps."""
    same = np.diff(segment) == 0
    gaps = np.where(same, np.diff(t), step)
    durations = (np.concatenate([[step], gaps]) + np.concatenate([gaps, [step]])) / (2.0 * step)
    even = bool(np.all(np.abs(gaps / step - 1.0) < 0.2))  # rounded stamps are not uneven sampling
    return np.ones_like(t) if even else durations
