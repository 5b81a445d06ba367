"""The pictures at the top of the page, lines of an SVG: the residual over a variable, the drive along time.

They need no library: the page of a plain install has them as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from eccentric.model import TURNING, AxisKind
from eccentric.presentation.html.arrays import TURN, BalanceResiduals
from eccentric.presentation.html.panels import Panel
from eccentric.presentation.html.text import curve_name, figure_words, number, run_name

Array = np.ndarray
_LEFT, _RIGHT, _GAP = 66.0, 634.0, 30.0
_HEIGHT, _HEIGHTS = 220.0, (190.0, 90.0)
STRETCH_S = 6.0
"""Longest stretch of the drive along time: more, and lines of a page's width hide each other."""
GAP_STEPS = 3.0
"""A step of time this many usual ones long ends a line: rows at standstill are left out in between."""
_POINTS = 900
"""Most points of a line: more than a screen of its width shows."""
_KINDS = {"before": "paper", "after": "extended"}
"""Curve of a panel -> kind of its line, as along time."""


@dataclass
class Picture:
    """What the template draws.

    Attributes:
        caption, alternative: its words.
        legend: (kind, name); kinds are measured, paper and extended.
        below: what the horizontal axis is, with its unit.
        title: what it is about, beside others; "" alone.
        lines: (kind, points) of polylines; `bars`: (kind, path) of vertical ones.
        grid: (y, label) of horizontal lines; `ticks`: (x, label) below; `names`: (y, text) of the parts.
        height: of the parts.
    """

    caption: str
    alternative: str
    legend: list[tuple[str, str]]
    below: str
    title: str = ""
    lines: list[tuple[str, str]] = field(default_factory=list)
    bars: list[tuple[str, str]] = field(default_factory=list)
    grid: list[tuple[str, str]] = field(default_factory=list)
    ticks: list[tuple[str, str]] = field(default_factory=list)
    names: list[tuple[str, str]] = field(default_factory=list)
    height: int = round(_GAP)

    def part(self, name: str, x: Array, curves: Mapping[str, Array], height: float) -> None:
        """Add lines over places on the axis (n,), broken at NaN; those of (n, 3) have bars around them."""
        values = np.concatenate([y.ravel() for y in curves.values()])
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        pad, top = 0.05 * (high - low) or 1.0, float(self.height)
        low, high = low - pad, high + pad

        def at(y: Any) -> Any:
            return top + height * (high - y) / (high - low)

        self.names.append((f"{top - 8.0:.0f}", name))
        self.grid += [(f"{at(tick):.1f}", number(tick, 3)) for tick in _ticks(low, high)]
        for kind, y in curves.items():
            if y.ndim > 1:
                ends = zip(x, at(y[:, 0]), at(y[:, 2]), strict=True)
                path = (f"M{a:.1f} {b:.1f}V{c:.1f}" for a, b, c in ends if np.isfinite(a + b + c))
                self.bars.append((kind, "".join(path)))
            self.lines += [(kind, points) for points in _polylines(x, at(y if y.ndim == 1 else y[:, 1]))]
        self.height += round(height + _GAP)


def residual_picture(panel: Panel, balance: BalanceResiduals, axis: AxisKind, title: str = "") -> Picture:
    """The residual over a variable, with and without the effects; a panel of the rows below the low pass."""
    curves = {kind: panel.curves[name] for name, kind in _KINDS.items() if name in panel.curves}
    caption, alternative = figure_words(panel, balance.unit, axis)
    low = balance.smooth
    cut = f" All signals are low-pass filtered at {low.cut_hz:g} Hz, like the angle." if low else ""
    channel = panel.channel
    picture = Picture(
        f"{caption} Bars: 10 % to 90 % quantiles of the rows of a point.{cut}",
        alternative,
        [(kind, curve_name(kind, axis)) for kind in curves],
        f"{channel.label} [{channel.unit}]",
        title,
    )
    start, end = float(np.nanmin(panel.at)), float(np.nanmax(panel.at))
    turn = channel.period is not None and abs(channel.period - TURN) < 1e-9
    start, end = (0.0, channel.period) if channel.period else (start, end)
    labels = ("0", "π/2", "π", "3π/2", "2π")
    ticks = [(k * TURN / 4.0, label) for k, label in enumerate(labels)]
    picture.ticks = [
        (f"{_place(at, start, end):.1f}", label)
        for at, label in (ticks if turn else [(at, number(at, 3)) for at in _ticks(start, end)])
    ]
    against = f" × sgn {axis.term('ω')}" if panel.against_motion else ""
    stacked = {kind: np.column_stack([c.low, c.middle, c.high]) for kind, c in curves.items()}
    picture.part(f"residual{against} [{balance.unit}]", _place(panel.at, start, end), stacked, _HEIGHT)
    return picture


def drive_picture(balance: BalanceResiduals, axis: AxisKind = TURNING) -> Picture | None:
    """The drive and, below, what the models miss of it; None without a held-out stretch."""
    balance = balance.below
    if (drive := balance.drive) is None:
        return None
    index = _stretch(balance)
    if len(index) < 3:
        return None
    t = balance.rows.t[index]
    errors = {"paper": drive.gain * balance.paper[index]}
    if balance.extended is not None:
        errors["extended"] = drive.gain * balance.extended[index]
    measured = drive.values[index]
    upper = {"measured": measured} | {name: measured - error for name, error in errors.items()}
    start, end = float(t[0]), float(t[-1])
    errors_text = " and ".join(
        f"{number(float(np.sqrt(np.mean(error**2))), 3)} {drive.unit} ({curve_name(kind, axis)})"
        for kind, error in errors.items()
    )
    run = balance.rows.run_names[int(balance.rows.run[index[0]])]
    where = f"{number(start, 5)} to {number(end, 5)} s of {run_name(run)}"
    most = "it varies most" if balance.extended is None else "the models differ most"
    cut = f" below {balance.smooth.cut_hz:g} Hz" if balance.smooth else ""
    caption = (
        f"Measured {drive.label}{cut}, and the {drive.label} that each model needs for the measured motion,"
        f" in the held-out section where {most} ({where}). Below: the difference, {errors_text} RMS."
        " Rows at standstill are left out."
    )
    legend = [("measured", "measured"), *((kind, curve_name(kind, axis)) for kind in errors)]
    alternative = (
        f"{drive.label}, measured and by the models, {where}; the differences are {errors_text} RMS."
    )
    picture = Picture(caption, alternative, legend, "time [s]")
    picture.ticks = [(f"{_place(tick, start, end):.1f}", number(tick, 5)) for tick in _ticks(start, end)]
    gaps = _gaps(t)
    for curves, height, name in (
        (upper, _HEIGHTS[0], f"{drive.label} [{drive.unit}]"),
        (errors, _HEIGHTS[1], f"measured minus model [{drive.unit}]"),
    ):
        broken = {kind: np.insert(y, gaps, np.nan) for kind, y in curves.items()}
        picture.part(name, np.insert(_place(t, start, end), gaps, np.nan), broken, height)
    return picture


def _place(x: Any, low: float, high: float) -> Any:
    """The place on the horizontal axis of a number or an array."""
    return _LEFT + (_RIGHT - _LEFT) * (x - low) / ((high - low) or 1.0)


def _stretch(balance: BalanceResiduals) -> Array:
    """Rows of the held-out stretch, at most `STRETCH_S` long, in which the models differ most.

    With one model alone, that in which the drive varies most.
    """
    rows, drive = balance.rows, balance.drive
    if drive is None:
        return np.zeros(0, dtype=int)
    known = [drive.values, balance.paper] + ([] if balance.extended is None else [balance.extended])
    held = np.asarray(rows.held_out, bool) & np.all([np.isfinite(y) for y in known], axis=0)
    index = np.flatnonzero(held)
    if not len(index):
        return index
    t, run = rows.t[index], rows.run[index]
    # A pause of a held-out part is rows at standstill; another run or a jump back ends it.
    breaks = (np.diff(run) != 0) | (np.diff(t) <= 0.0) | (np.diff(t) > 1.0)
    shown = drive.values if balance.extended is None else balance.extended - balance.paper
    best, size = index[:0], -1.0
    for part in np.split(index, np.flatnonzero(breaks) + 1):
        slots = np.floor((rows.t[part] - rows.t[part[0]]) / STRETCH_S)
        for slot in np.unique(slots):
            piece = part[slots == slot]
            spread = float(np.std(shown[piece])) * float(np.ptp(rows.t[piece])) ** 0.5
            if spread > size:
                best, size = piece, spread
    return best


def _gaps(t: Array) -> Array:
    """Places before which a line begins anew."""
    steps = np.diff(t)
    return np.flatnonzero(steps > GAP_STEPS * float(np.median(steps))) + 1


def _polylines(x: Array, y: Array) -> list[str]:
    """The points of a line, a text for each part without NaN."""
    per, found = -(-len(x) // _POINTS), []
    for own in np.split(np.arange(len(x)), np.flatnonzero(~np.isfinite(x + y))):
        places = own[np.isfinite((x + y)[own])][::per]
        pairs = zip(x[places].tolist(), y[places].tolist(), strict=True)
        if text := " ".join(f"{a:.1f},{b:.1f}" for a, b in pairs):
            found.append(text)
    return found


def _ticks(low: float, high: float) -> Sequence[float]:
    """Three to six round values of a range."""
    rough = (high - low) / 5.0 or 1.0
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * next(f for f in (1.0, 2.0, 5.0, 10.0) if f * power >= rough)
    first = int(np.ceil(low / step))
    last = int(np.floor(high / step))
    return [float(f"{k * step:.12g}") for k in range(first, last + 1)]
