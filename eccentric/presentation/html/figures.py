"""The report's figures as plain data: what `report.js.jinja` draws in the browser with BokehJS.

BokehJS zooms, pans, shows the values under the pointer and hides curves, so none of that is code of ours. Its
scripts are read as files and its figures are built in the page: the Python half of Bokeh, which would take
longer than the rest of the report, is never imported.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.model import TURNING, AxisKind
from eccentric.presentation.html.arrays import TURN, BalanceResiduals, MeanAndSpread
from eccentric.presentation.html.data import ReportData
from eccentric.presentation.html.panels import Panel, Trace, friction_panel, leading_panel, residual_panel
from eccentric.presentation.html.text import curve_name

_SCRIPTS = ("bokeh.min.js", "bokeh-api.min.js")
"""BokehJS and its interface for building figures, without widgets and without loaders of fonts or TeX."""
_WITH_BARS = {"measured", "before", "after"}
_FEW = 100
"""Points of a trace are marked up to this number."""


def library() -> str:
    """BokehJS as one script; "" if Bokeh is not installed."""
    spec = find_spec("bokeh")
    if spec is None or not spec.submodule_search_locations:
        return ""
    folder = Path(spec.submodule_search_locations[0]) / "server" / "static" / "js"
    return "\n".join((folder / name).read_text(encoding="utf-8") for name in _SCRIPTS)


class Figures:
    """Collects the figures of a page; each plot receives the id of its element.

    A figure is a dict: `columns` (name -> numbers, None where there is none), and `plots` that share them and
    their horizontal axis, each with the names, labels and marks of its `curves`.
    """

    def __init__(self, axis: AxisKind = TURNING) -> None:
        self._axis = axis
        self._figures: list[dict[str, Any]] = []
        self._plots = 0

    def json(self) -> str:
        """All figures, "" without any; "<" is escaped: no text can end the enclosing script element."""
        if not self._figures:
            return ""
        return json.dumps(self._figures, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")

    def panel(self, panel: Panel, quantity: str, unit: str) -> list[str]:
        """Means over a channel with bars from the 10 % to the 90 % quantile of their rows; the plot's id."""
        against = f" × sgn {self._axis.term('ω')}" if panel.against_motion else ""
        curves = [
            self._curve(name, bars=name in _WITH_BARS, mark=10 if name == "measured" else 5)
            | {"hidden": name == "linear"}
            for name in panel.curves
        ]
        columns = {"at": panel.at, "rows": panel.rows, **_columns(panel.curves, _WITH_BARS)}
        period = panel.channel.period
        return self._add(
            columns,
            [(f"{quantity}{against} [{unit}]", 290, curves)],
            x=f"{panel.channel.label} [{panel.channel.unit}]",
            turn=period is not None and abs(period - TURN) < 1e-9,
            unit=unit,
        )

    def trace(self, trace: Trace, run_names: Sequence[str], quantity: str, unit: str) -> list[str]:
        """Friction along time and, below it, the residuals; the ids of both plots."""
        few, means = len(trace.at) <= _FEW, trace.rows_per_point > 1
        plots, bands = [], set()
        for names, banded, what, height in (
            (("measured", "paper", "extended"), ("measured",), quantity, 330),
            (("before", "after"), ("before", "after"), "residual", 230),
        ):
            own = [name for name in names if name in trace.curves]
            bands |= set(banded) if means else set()
            curves = [self._curve(name, bars=name in bands, mark=7 if few else 0) for name in own]
            plots += [(f"{what} [{unit}]", height, curves)] if own else []
        end = float(np.nanmax(trace.at))
        return self._add(
            {"at": trace.at, "t": trace.t, "run": trace.run, **_columns(trace.curves, bands)},
            plots,
            x="held-out time, pauses cut out [s]",
            end=end,
            cuts=_numbers(trace.cuts),
            runs=list(run_names),
            unit=unit,
        )

    def _curve(self, name: str, *, bars: bool, mark: int) -> dict[str, Any]:
        return {"name": name, "label": curve_name(name, self._axis), "bars": bars, "mark": mark}

    def _add(
        self, columns: Mapping[str, Any], plots: Sequence[tuple[str, int, list[Any]]], **others: Any
    ) -> list[str]:
        ids = [f"plot-{self._plots + k + 1}" for k in range(len(plots))]
        self._plots += len(plots)
        self._figures.append(
            {
                "columns": {name: _numbers(x) for name, x in columns.items()},
                "plots": [
                    {"id": at, "y": y, "height": height, "curves": curves}
                    for at, (y, height, curves) in zip(ids, plots, strict=True)
                ],
                **others,
            }
        )
        return ids


def _columns(curves: Mapping[str, MeanAndSpread], with_bars: set[str]) -> dict[str, Any]:
    """A column for each curve, and those of the ends of its bars."""
    columns = {name: curve.middle for name, curve in curves.items()}
    for name in (name for name in curves if name in with_bars):
        columns |= {f"{name}_low": curves[name].low, f"{name}_high": curves[name].high}
    return columns


def _numbers(x: np.ndarray) -> list[float | int | None]:
    """To seven digits of the largest, more than a screen resolves."""
    if x.dtype.kind != "f":
        return x.tolist()
    largest = float(np.max(np.abs(x[np.isfinite(x)]), initial=0.0))
    shown = np.round(x, 6 - int(np.floor(np.log10(largest)))) if largest > 1e-300 else x
    return [value if math.isfinite(value) else None for value in shown.tolist()]


# Two figures of the report in matplotlib: the residual of the balance, and friction over the velocity.


# Okabe and Ito's colours, as in the figures of the page: colour, dash, mark.
_STYLES = {
    "measured": ("#8a8a8a", "-", "o"),
    "linear": ("#cc79a7", ":", ""),
    "paper": ("#d55e00", "--", ""),
    "extended": ("#0072b2", "-", ""),
    "before": ("#d55e00", "--", "o"),
    "after": ("#0072b2", "-", "o"),
    "effect": ("#009e73", "-.", ""),
}


def plot_report(data: ReportData, left: Any, right: Any = None) -> None:
    """Draw the first figures of the report on two matplotlib axes, or the first of them on one.

    On the left the residual before and after, over the variable of the effect or the signal that it depends
    on most; on the right measured and predicted friction over the motor velocity, or the residual if the
    balance contains no friction.
    Points are means over bins; bars extend from the 10 % to the 90 % quantile of their rows.
    """
    balance, axis = data.errors.balances[0], data.source.axis
    order = {key: k for k, key in enumerate(data.conclusion.depends_on)}
    channels = sorted(balance.rows.channels, key=lambda c: order.get(c.key, len(order)))
    panels = (residual_panel(balance, channel) for channel in channels)
    leading = next((e for e in data.extended.effects if e.balance == balance.name), None)
    own = leading_panel(balance.below, leading.follows) if leading else None
    first = own or next((panel for panel in panels if panel is not None), None)
    _draw(left, first, balance, "residual", axis)
    if right is None:
        return
    velocity = balance.rows.channel("velocity")
    friction = velocity and friction_panel(balance, velocity)
    if friction is not None:
        _draw(right, friction, balance, balance.quantity, axis)
    else:
        _draw(right, velocity and residual_panel(balance, velocity), balance, "residual", axis)
    added = ", ".join(effect.id for effect in data.extended.effects) or data.conclusion.verdict.replace(
        "_", " "
    )
    left.set_title(f"{', '.join(data.source.logs)}: {added}", loc="left", fontsize=9.0)


def _draw(axes: Any, panel: Panel | None, balance: BalanceResiduals, quantity: str, axis: AxisKind) -> None:
    if panel is None:
        axes.set_axis_off()
        return
    for name, curve in panel.curves.items():
        color, line, mark = _STYLES[name]
        if name in _WITH_BARS:
            axes.vlines(panel.at, curve.low, curve.high, color=color, alpha=0.35, linewidth=2.0)
        style = {"color": color, "linestyle": line, "marker": mark, "markersize": 3.0}
        axes.plot(panel.at, curve.middle, label=curve_name(name, axis), **style)
    against = f" × sgn {axis.term('ω')}" if panel.against_motion else ""
    axes.set_xlabel(f"{panel.channel.label} [{panel.channel.unit}]")
    axes.set_ylabel(f"{quantity}{against} [{balance.unit}]")
    axes.grid(linewidth=0.3)
    axes.legend(frameon=False, fontsize=8.0)
