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
        return plain
    facing = {name: x * np.sign(velocity.values) for name, x in curves.items()}
    turned = _binned(balance.rows, channel, facing, against_motion=True)
    return turned if turned is not None and _structure(turned) > _structure(plain) else plain


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
    return _binned(balance.rows, channel, curves, against_motion=turn)


def _structure(panel: Panel) -> float:
    """Mean square of the means of the residual before, weighted with their rows."""
    there = np.isfinite(panel.at)
    return float(np.average(panel.curves["before"].middle[there] ** 2, weights=panel.rows[there]))


def _binned(
    rows: ResidualRows, channel: Channel, curves: Mapping[str, Array], against_motion: bool = False
) -> Panel | None:
    x = channel.values if channel.period is None else np.mod(channel.values, channel.period)
    use = shown_rows(rows) & np.all([np.isfinite(y) for y in (x, *curves.values())], axis=0)
    x, count = x[use], int(np.count_nonzero(use))
    if count < 4:
        return None
    if count <= BINS:
        order = np.argsort(x, kind="stable")
        rows_drawn = {name: y[use][order] for name, y in curves.items()}
        made = {name: Curve(y, y, y) for name, y in rows_drawn.items()}
        return Panel(channel, against_motion, x[order], np.ones(count, int), 0, made)
    # Rare extremes of a channel would stretch the axis: they are put into the outermost bins.
    low, high = (0.0, channel.period) if channel.period else np.quantile(x, [0.002, 0.998])
    bins = int(np.clip(count // 10, 12, BINS)) if high > low else 1
    least = 5 if count >= 20 * bins else 2
    place = np.clip(((x - low) / max(high - low, 1e-300) * bins).astype(int), 0, bins - 1)
    order = np.argsort(place, kind="stable")
    members = np.split(order, np.cumsum(np.bincount(place, minlength=bins))[:-1])
    sizes = np.array([len(m) for m in members])
    thick = sizes >= least
    if not thick.any():
        return None

    def curve(y: Array) -> Curve:
        none = np.full(3, np.nan)
        parts = [y[m] if ok else None for m, ok in zip(members, thick, strict=True)]
        ends = [none if y is None else (np.quantile(y, 0.1), y.mean(), np.quantile(y, 0.9)) for y in parts]
        return Curve(*np.transpose(ends))

    made = {name: curve(y[use]) for name, y in curves.items()}
    left_out = int(sizes[~thick].sum())
    return Panel(channel, against_motion, curve(x).middle, np.where(thick, sizes, 0), left_out, made)


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
    begins = np.flatnonzero(np.r_[True, broken])
    groups = [
        group
        for stretch in np.split(np.arange(len(index)), begins[1:])
        for group in (*np.split(stretch, range(per, len(stretch), per)), None)
    ][:-1]

    def each(y: Array) -> Array:
        return np.array([np.nan if g is None else y[g].mean() for g in groups])

    def spread(y: Array) -> Curve:
        low = np.array([np.nan if g is None else y[g].min() for g in groups])
        high = np.array([np.nan if g is None else y[g].max() for g in groups])
        return Curve(low, each(y), high)

    return Trace(
        at=each(axis),
        t=each(t[index]),
        run=np.array([-1 if g is None else run[index][g[0]] for g in groups]),
        cuts=0.5 * (axis[:-1] + axis[1:])[cut],
        rows_per_point=per,
        rows=len(index),
        curves={name: spread(y[index]) for name, y in curves.items()},
    )
