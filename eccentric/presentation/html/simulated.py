"""The drive as it was measured and as the models give it, along a stretch of held-out time: lines of an SVG.

It needs no library: the page of a plain install has it as well.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eccentric.model import TURNING, AxisKind
from eccentric.presentation.html.arrays import BalanceResiduals
from eccentric.presentation.html.text import curve_name, number, run_name

Array = np.ndarray
_LEFT, _RIGHT, _GAP = 66.0, 954.0, 30.0
_HEIGHTS = (190.0, 90.0)
STRETCH_S = 6.0
"""Longest stretch of the measured and simulated drive: more, and lines of a page's width hide each other."""
GAP_STEPS = 3.0
"""A step of time this many usual ones long ends a line: rows at standstill are left out in between."""
_POINTS = 900
"""Most points of a line: one for each unit of its width."""


@dataclass(frozen=True)
class Simulated:
    """What the template draws.

    Attributes:
        lines: (kind, points) of polylines; kinds are measured, paper and extended.
        grid: (y, label) of horizontal lines; `times`: (x, label) below; `names`: (y, text) of the panels.
        legend: (kind, name).
        height: of the picture.
        caption, alternative: its words.
    """

    lines: list[tuple[str, str]]
    grid: list[tuple[str, str]]
    times: list[tuple[str, str]]
    names: list[tuple[str, str]]
    legend: list[tuple[str, str]]
    height: int
    caption: str
    alternative: str


def simulated(balance: BalanceResiduals, axis: AxisKind = TURNING) -> Simulated | None:
    """The drive and, below, what the models miss of it; None without a held-out stretch."""
    drive = balance.drive
    if drive is None:
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
    ends = _ends(t)
    start, span = float(t[0]), float(t[-1] - t[0])
    x = _LEFT + (_RIGHT - _LEFT) * (t - start) / span
    top = _GAP
    lines: list[tuple[str, str]] = []
    grid: list[tuple[str, str]] = []
    names: list[tuple[str, str]] = []
    for curves, height, name in (
        (upper, _HEIGHTS[0], f"{drive.label} [{drive.unit}]"),
        (errors, _HEIGHTS[1], f"measured minus model [{drive.unit}]"),
    ):
        values = np.concatenate(list(curves.values()))
        low, high = float(values.min()), float(values.max())
        pad = 0.05 * (high - low) or 1.0
        low, high = low - pad, high + pad
        names.append((f"{top - 8.0:.0f}", name))
        grid += [
            (f"{top + height * (high - tick) / (high - low):.1f}", number(tick, 3))
            for tick in _ticks(low, high)
        ]
        for kind, y in curves.items():
            places = top + height * (high - y) / (high - low)
            lines += [(kind, points) for points in _polylines(x, places, ends)]
        top += height + _GAP
    times = [
        (f"{_LEFT + (_RIGHT - _LEFT) * (tick - start) / span:.1f}", number(tick, 5))
        for tick in _ticks(start, start + span)
    ]
    errors_text = " and ".join(
        f"{number(float(np.sqrt(np.mean(error**2))), 3)} {drive.unit} ({curve_name(kind, axis)})"
        for kind, error in errors.items()
    )
    run = balance.rows.run_names[int(balance.rows.run[index[0]])]
    where = f"{number(start, 5)} to {number(start + span, 5)} s of {run_name(run)}"
    most = "it varies most" if balance.extended is None else "the models differ most"
    caption = (
        f"Measured {drive.label}, and the {drive.label} that each model needs for the measured motion, in the"
        f" held-out section where {most} ({where}). Below: the difference, {errors_text} RMS."
        " Rows at standstill are left out."
    )
    legend = [("measured", "measured"), *((kind, curve_name(kind, axis)) for kind in errors)]
    alternative = (
        f"{drive.label}, measured and by the models, {where}; the differences are {errors_text} RMS."
    )
    return Simulated(lines, grid, times, names, legend, round(top - 8.0), caption, alternative)


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


def _ends(t: Array) -> Array:
    """Places after which a line begins anew."""
    steps = np.diff(t)
    return np.flatnonzero(steps > GAP_STEPS * float(np.median(steps))) + 1


def _polylines(x: Array, y: Array, ends: Array) -> list[str]:
    per = -(-len(x) // _POINTS)
    found = []
    for xs, ys in zip(np.split(x, ends), np.split(y, ends), strict=True):
        pairs = zip(xs[::per].tolist(), ys[::per].tolist(), strict=True)
        found.append(" ".join(f"{a:.1f},{b:.1f}" for a, b in pairs))
    return found


def _ticks(low: float, high: float) -> list[float]:
    """Three to six round values of a range."""
    rough = (high - low) / 5.0
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * next(f for f in (1.0, 2.0, 5.0, 10.0) if f * power >= rough)
    first = int(np.ceil(low / step))
    last = int(np.floor(high / step))
    return [float(f"{k * step:.12g}") for k in range(first, last + 1)]
