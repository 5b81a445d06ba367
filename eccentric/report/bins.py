"""Bins of a channel: the mean of the rows in each, and the quantiles between which most of them lie."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eccentric.report.arrays import Channel, ResidualRows

__all__ = ["Bins", "Curve", "binned", "shown_rows"]

Array = np.ndarray

BINS = 60
"""Most bins of a panel; up to this many rows are drawn singly."""
SPREAD = (0.1, 0.9)
"""Quantiles of its rows from which to which the bar of a point extends."""


@dataclass(frozen=True)
class Curve:
    """One line (k,): the mean of each point's rows, and the lower and upper end of their spread."""

    low: Array
    middle: Array
    high: Array

    @property
    def swing(self) -> float:
        """The range from the lowest to the highest mean."""
        return float(np.nanmax(self.middle) - np.nanmin(self.middle))


@dataclass(frozen=True)
class Bins:
    """Rows by the bins of a channel; of bins that are not `drawn`, means and quantiles are NaN.

    Attributes:
        x: the channel, on all rows.
        index: rows in the drawn bins, bin by bin; begins: where each of these bins begins in it.
        sizes: rows in each bin.
        drawn: whether a bin has enough rows.
    """

    x: Array
    index: Array
    begins: Array
    sizes: Array
    drawn: Array

    def mean(self, y: Array) -> Array:
        """(bins,) means of the rows."""
        return self._on_all(np.add.reduceat(y[self.index], self.begins) / self.sizes[self.drawn])

    def curve(self, y: Array) -> Curve:
        """Mean and spread of the rows; each bin is sorted once for both quantiles."""
        ordered = y[self.index]
        for part in np.split(ordered, self.begins[1:]):
            part.sort()
        low, high = (self._on_all(self._quantile(ordered, level)) for level in SPREAD)
        return Curve(low, self.mean(y), high)

    def structure(self, y: Array) -> float:
        """Mean square of the means, weighted with their rows."""
        return float(np.average(self.mean(y)[self.drawn] ** 2, weights=self.sizes[self.drawn]))

    def _quantile(self, ordered: Array, level: float) -> Array:
        """Linear between rows, as `numpy.quantile`."""
        place = level * (self.sizes[self.drawn] - 1)
        below = np.floor(place).astype(int)
        first, part = ordered[self.begins + below], place - below
        return first + part * (ordered[self.begins + np.ceil(place).astype(int)] - first)

    def _on_all(self, values: Array) -> Array:
        found = np.full(len(self.sizes), np.nan)
        found[self.drawn] = values
        return found


def shown_rows(rows: ResidualRows) -> Array:
    """(n,) rows that are drawn over channels: fitted or held out."""
    return np.asarray(rows.train, bool) | np.asarray(rows.held_out, bool)


def binned(rows: ResidualRows, channel: Channel, curves: Mapping[str, Array]) -> Bins | None:
    """The drawn rows in which the channel and all curves are known; None without enough of them."""
    x = channel.values if channel.period is None else np.mod(channel.values, channel.period)
    use = np.flatnonzero(shown_rows(rows) & np.all([np.isfinite(y) for y in (x, *curves.values())], axis=0))
    count, own = len(use), x[use]
    if count < 4:
        return None
    if count <= BINS:
        each = np.arange(count)
        return Bins(x, use[np.argsort(own, kind="stable")], each, np.ones(count, int), np.ones(count, bool))
    # Rare extremes of a channel would stretch the axis: they are put into the outermost bins.
    low, high = (0.0, channel.period) if channel.period else np.quantile(own, [0.002, 0.998])
    bins = int(np.clip(count // 10, 12, BINS)) if high > low else 1
    least = 5 if count >= 20 * bins else 2
    place = np.clip(((own - low) / max(high - low, 1e-300) * bins).astype(int), 0, bins - 1)
    sizes = np.bincount(place, minlength=bins)
    drawn = sizes >= least
    if not drawn.any():
        return None
    order = np.argsort(place, kind="stable")
    index = use[order[drawn[place[order]]]]
    return Bins(x, index, np.r_[0, np.cumsum(sizes[drawn])[:-1]], sizes, drawn)
