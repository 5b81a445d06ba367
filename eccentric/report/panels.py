"""Rows reduced to points for drawing: means over a channel with the spread of their rows, and time traces.

Means, since they are additive: before is after plus effect in every bin, even where a bin mixes two branches.
Nothing is smoothed or silently left out: every point records how many rows it represents.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eccentric.report.arrays import BalanceResiduals, Channel, ResidualRows

__all__ = ["Curve", "Panel", "Trace", "friction_panel", "residual_panel", "shown_rows", "trace"]

Array = np.ndarray

BINS = 60
"""Most bins of a panel; up to this many rows are drawn singly."""
POINTS = 1200
"""Most points of a time trace."""
SPREAD = (0.1, 0.9)
"""Quantiles of its rows from which to which the bar of a point extends."""
CUT_S = 0.5
"""Longer pauses between held-out rows are cut out of the time axis."""


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
class Panel:
    """Curves over a channel.

    Attributes:
        channel: what is on the horizontal axis.
        against_motion: whether values are counted positive against the motion, as friction is.
        at: (k,) mean of the channel in each bin, increasing; NaN where a bin is empty.
        rows: (k,) rows in each bin.
        left_out: rows in bins with too few of them to draw.
        curves: name -> curve, spread from the 10 % to the 90 % quantile.
    """

    channel: Channel
    against_motion: bool
    at: Array
    rows: Array
    left_out: int
    curves: dict[str, Curve]


@dataclass(frozen=True)
class Trace:
    """The held-out part along time, long pauses cut out.

    Attributes:
        at: (k,) time on the axis [s]; a NaN separates stretches.
        t: (k,) logged time [s]; run: (k,) number of the run.
        cuts: (c,) axis times where something was cut out.
        rows_per_point: most rows that a point represents; 1 if nothing was decimated.
        rows: all rows drawn.
        curves: name -> curve, spread from the smallest to the largest row.
    """

    at: Array
    t: Array
    run: Array
    cuts: Array
    rows_per_point: int
    rows: int
    curves: dict[str, Curve]


def shown_rows(rows: ResidualRows) -> Array:
    """(n,) rows that are drawn over channels: fitted or held out."""
    return np.asarray(rows.train, bool) | np.asarray(rows.held_out, bool)


def residual_panel(balance: BalanceResiduals, channel: Channel) -> Panel | None:
    """Residual before and after, and the fitted effect; None without enough rows.

    Over any channel but the velocity, missing friction would cancel between the two directions of motion.
    There the residual is counted against the motion if that shows more structure.
    """
    curves = {"before": balance.paper}
    if balance.extended is not None:
        curves |= {"after": balance.extended, "effect": balance.paper - balance.extended}
    plain = _binned(balance.rows, channel, curves)
    velocity = balance.rows.channel("velocity")
    if plain is None or velocity is None or channel.key == "velocity":
        return plain and _panel(channel, plain, curves)
    sign = np.sign(velocity.values)
    facing = {name: x * sign for name, x in curves.items()}
    turned = _binned(balance.rows, channel, facing)
    if turned is not None and turned.structure(facing["before"]) > plain.structure(curves["before"]):
        return _panel(channel, turned, facing, against_motion=True)
    return _panel(channel, plain, curves)


def friction_panel(balance: BalanceResiduals, channel: Channel) -> Panel | None:
    """Measured and predicted friction; over any channel but the velocity, counted against the motion."""
    if balance.measured is None:
        return None
    residuals = {"linear": balance.linear, "paper": balance.paper, "extended": balance.extended}
    curves = {"measured": balance.measured}
    curves |= {name: balance.measured - r for name, r in residuals.items() if r is not None}
    velocity = balance.rows.channel("velocity")
    turn = channel.key != "velocity" and velocity is not None
    if turn and velocity is not None:
        curves = {name: x * np.sign(velocity.values) for name, x in curves.items()}
    bins = _binned(balance.rows, channel, curves)
    return bins and _panel(channel, bins, curves, against_motion=turn)


@dataclass(frozen=True)
class _Bins:
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


def _panel(
    channel: Channel, bins: _Bins, curves: Mapping[str, Array], *, against_motion: bool = False
) -> Panel:
    return Panel(
        channel,
        against_motion,
        at=bins.mean(bins.x),
        rows=np.where(bins.drawn, bins.sizes, 0),
        left_out=int(bins.sizes[~bins.drawn].sum()),
        curves={name: bins.curve(y) for name, y in curves.items()},
    )


def _binned(rows: ResidualRows, channel: Channel, curves: Mapping[str, Array]) -> _Bins | None:
    x = channel.values if channel.period is None else np.mod(channel.values, channel.period)
    use = np.flatnonzero(shown_rows(rows) & np.all([np.isfinite(y) for y in (x, *curves.values())], axis=0))
    count, own = len(use), x[use]
    if count < 4:
        return None
    if count <= BINS:
        each = np.arange(count)
        return _Bins(x, use[np.argsort(own, kind="stable")], each, np.ones(count, int), np.ones(count, bool))
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
    return _Bins(x, index, np.r_[0, np.cumsum(sizes[drawn])[:-1]], sizes, drawn)


def trace(balance: BalanceResiduals) -> Trace | None:
    """Measured and predicted friction, and residuals, on the held-out rows; None if there are none.

    Consecutive rows of a stretch are averaged so that at most some 1200 points remain.
    """
    given = {
        "measured": balance.measured,
        "paper": None if balance.measured is None else balance.measured - balance.paper,
        "before": balance.paper,
        "after": balance.extended,
    }
    if balance.measured is not None and balance.extended is not None:
        given["extended"] = balance.measured - balance.extended
    curves = {name: np.asarray(y) for name, y in given.items() if y is not None}
    t, run = balance.rows.t, balance.rows.run
    held = np.asarray(balance.rows.held_out, bool)
    index = np.flatnonzero(held & np.all([np.isfinite(y) for y in curves.values()], axis=0))
    if len(index) < 2:
        return None
    steps = np.diff(t[index])
    broken = (np.diff(index) != 1) | (np.diff(run[index]) != 0)
    usual = float(np.median(steps[~broken])) if not broken.all() else float(np.median(np.abs(steps)))
    cut = (np.diff(run[index]) != 0) | (steps > CUT_S) | (steps <= 0)
    axis = np.r_[0.0, np.cumsum(np.where(cut, 10.0 * usual, steps))]
    per = -(-len(index) // POINTS)
    # The first row of every point: of each stretch, and within it of every `per` rows.
    row, stretch = np.arange(len(index)), np.r_[True, broken]
    begins = np.flatnonzero(stretch | ((row - np.maximum.accumulate(np.where(stretch, row, 0))) % per == 0))
    sizes = np.diff(begins, append=len(index))
    gaps = np.flatnonzero(stretch[begins])[1:]

    def parted(values: Array, gap: float = np.nan) -> Array:
        return np.insert(values, gaps, gap)

    def each(y: Array) -> Array:
        return parted(np.add.reduceat(y, begins) / sizes)

    def spread(y: Array) -> Curve:
        return Curve(parted(np.minimum.reduceat(y, begins)), each(y), parted(np.maximum.reduceat(y, begins)))

    return Trace(
        at=each(axis),
        t=each(t[index]),
        run=parted(run[index][begins], -1),
        cuts=0.5 * (axis[:-1] + axis[1:])[cut],
        rows_per_point=per,
        rows=len(index),
        curves={name: spread(y[index]) for name, y in curves.items()},
    )
