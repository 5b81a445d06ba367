"""Rows reduced to points for drawing: means over a channel with the spread of their rows, and time traces.

Means, since they are additive: before is after plus effect in every bin, even where a bin mixes two branches.
Nothing is smoothed or silently left out: every point records how many rows it represents.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from eccentric.presentation.html.arrays import BalanceResiduals, Bins, Channel, MeanAndSpread, binned

Array = np.ndarray

POINTS = 1200
"""Most points of a time trace."""
CUT_S = 0.5
"""Longer pauses between held-out rows are cut out of the time axis."""


@dataclass(frozen=True)
class Panel:
    """Curves over a channel.

    Attributes:
        channel: what is on the horizontal axis.
        against_motion: whether values are counted positive against the motion, as friction is.
        at: (k,) mean of the channel in each bin, increasing; NaN where a bin is empty, and at zero velocity,
            where friction jumps.
        rows: (k,) rows in each bin.
        left_out: rows in bins with too few of them to draw.
        curves: name -> curve, spread from the 10 % to the 90 % quantile.
    """

    channel: Channel
    against_motion: bool
    at: Array
    rows: Array
    left_out: int
    curves: dict[str, MeanAndSpread]


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
    curves: dict[str, MeanAndSpread]


def residual_panel(balance: BalanceResiduals, channel: Channel) -> Panel | None:
    """Residual before and after, and the fitted effect; None without enough rows.

    Over any channel but the velocity, missing friction would cancel between the two directions of motion.
    There the residual is counted against the motion if that shows more structure.
    """
    curves = {"before": balance.paper}
    if balance.extended is not None:
        curves |= {"after": balance.extended, "effect": balance.paper - balance.extended}
    plain = binned(balance.rows, channel, curves)
    velocity = balance.rows.channel("velocity")
    if plain is None or velocity is None or channel.key == "velocity":
        return plain and _panel(channel, plain, curves)
    sign = np.sign(velocity.values)
    facing = {name: x * sign for name, x in curves.items()}
    turned = binned(balance.rows, channel, facing)
    if turned is not None and turned.structure(facing["before"]) > plain.structure(curves["before"]):
        return _panel(channel, turned, facing, against_motion=True)
    return _panel(channel, plain, curves)


def leading_panel(balance: BalanceResiduals, channels: Iterable[Channel]) -> Panel | None:
    """The panel of the residual over that of the channels which shows most of the effects.

    Without an effect, most of the residual; None if none of the channels has enough rows.
    """
    panels = (residual_panel(balance, channel) for channel in channels)
    return max((panel for panel in panels if panel is not None), key=_structure, default=None)


def _structure(panel: Panel) -> float:
    """Mean square of the means of the effect, or of the residual where there is none."""
    curve = panel.curves["effect" if "effect" in panel.curves else "before"].middle
    known = np.isfinite(curve)
    return float(np.average(curve[known] ** 2, weights=panel.rows[known]))


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
    bins = binned(balance.rows, channel, curves)
    return bins and _panel(channel, bins, curves, against_motion=turn)


def _panel(
    channel: Channel, bins: Bins, curves: Mapping[str, Array], *, against_motion: bool = False
) -> Panel:
    at, rows = bins.mean(bins.x), np.where(bins.drawn, bins.sizes, 0)
    both = channel.key == "velocity" and np.nanmin(at) < 0.0 < np.nanmax(at)
    places = [int(np.argmax(at > 0.0))] if both else []

    def parted(values: Array) -> Array:
        return np.insert(values, places, np.nan)

    drawn = {name: bins.curve(y) for name, y in curves.items()}
    return Panel(
        channel,
        against_motion,
        at=parted(at),
        rows=np.insert(rows, places, 0),
        left_out=int(bins.sizes[~bins.drawn].sum()),
        curves={n: MeanAndSpread(parted(c.low), parted(c.middle), parted(c.high)) for n, c in drawn.items()},
    )


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

    def spread(y: Array) -> MeanAndSpread:
        return MeanAndSpread(
            parted(np.minimum.reduceat(y, begins)), each(y), parted(np.maximum.reduceat(y, begins))
        )

    return Trace(
        at=each(axis),
        t=each(t[index]),
        run=parted(run[index][begins], -1),
        cuts=0.5 * (axis[:-1] + axis[1:])[cut],
        rows_per_point=per,
        rows=len(index),
        curves={name: spread(y[index]) for name, y in curves.items()},
    )
