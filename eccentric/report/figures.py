"""The report's figures: Bokeh models of panels and traces, and the JSON that draws them offline.

Colours are those of Okabe and Ito, distinct for the colour-blind; marks and dashes differ as well. Text
follows the page: `report.js.jinja` sets its colour for the light and the dark scheme.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.document import Document
from bokeh.models import (
    BasicTickFormatter,
    ColumnDataSource,
    FixedTicker,
    HoverTool,
    PlainText,
    Range1d,
    Span,
)
from bokeh.plotting import figure
from bokeh.resources import Resources

from eccentric.report.panels import Panel, Trace
from eccentric.report.text import curve_name

__all__ = ["document_json", "library", "panel_figure", "trace_figures"]

_GREY, _VERMILION, _BLUE, _GREEN, _PURPLE = "#8a8a8a", "#d55e00", "#0072b2", "#009e73", "#cc79a7"
# Name of the curve: colour, dash, mark, line width.
STYLES: dict[str, tuple[str, str, str, float]] = {
    "measured": (_GREY, "solid", "circle", 5.0),
    "linear": (_PURPLE, "dotted", "triangle", 1.5),
    "paper": (_VERMILION, "dashed", "diamond", 2.0),
    "extended": (_BLUE, "solid", "square", 1.5),
    "before": (_VERMILION, "dashed", "diamond", 1.5),
    "after": (_BLUE, "solid", "square", 1.5),
    "effect": (_GREEN, "dotdash", "", 3.0),
}
_WITH_BARS = {"measured", "before", "after"}
_FEW = 100
"""Points of a trace are marked up to this number."""
_TURN = 2.0 * np.pi


def library() -> str:
    """BokehJS as one script: the part that draws, without widgets and without loaders of fonts or TeX."""
    return "\n".join(Resources(mode="inline", components=["bokeh"], log_level="warn").js_raw)


def document_json(roots: Sequence[tuple[str, Any]]) -> str:
    """All figures as JSON for `Bokeh.embed.embed_items`; roots are (id of the page's element, figure).

    "<" is escaped, so that no text can end the enclosing script element.
    """
    document = Document()
    # Frozen, since Bokeh would otherwise traverse all models again for every root.
    with document.models.freeze():
        for _, root in roots:
            document.add_root(root)
    places = {root.id: at for at, root in roots}
    items = [{"docid": "report", "roots": places, "root_ids": list(places)}]
    text = json.dumps(
        {"documents": {"report": document.to_json(deferred=False)}, "items": items}, allow_nan=False
    )
    return text.replace("<", "\\u003c")


def panel_figure(panel: Panel, quantity: str, unit: str) -> Any:
    """Means over a channel with bars from the 10 % to the 90 % quantile of their rows."""
    label = f"{panel.channel.label} [{panel.channel.unit}]"
    against = " × sgn ω" if panel.against_motion else ""
    made = _figure(label, f"{quantity}{against} [{unit}]", 290)
    columns: dict[str, Any] = {"at": panel.at, "rows": panel.rows}
    for name, curve in panel.curves.items():
        columns |= {name: curve.middle, f"{name}_low": curve.low, f"{name}_high": curve.high}
    source = ColumnDataSource(data={name: _compact(x) for name, x in columns.items()})
    marks = [_curve(made, source, name, curve_name(name)) for name in panel.curves]
    names = [(curve_name(name), f"@{name}{{0.0000}} {unit}") for name in panel.curves]
    hover = HoverTool(
        renderers=marks[:1], mode="vline", tooltips=[("at", "@at{0.000}"), *names, ("rows", "@rows")]
    )
    made.add_tools(hover)
    if panel.channel.period is not None and abs(panel.channel.period - _TURN) < 1e-9:
        ticks = [k * _TURN / 4 for k in range(5)]
        made.xaxis.ticker = FixedTicker(ticks=ticks)
        made.xaxis.major_label_overrides = dict(zip(ticks, ("0", "π/2", "π", "3π/2", "2π"), strict=True))
        made.x_range = Range1d(start=-0.1, end=_TURN + 0.1)
    _finish(made)
    return made


def trace_figures(trace: Trace, run_names: Sequence[str], quantity: str, unit: str) -> list[Any]:
    """Friction along time, and below it the residuals; both share the time axis."""
    upper = [name for name in ("measured", "paper", "extended") if name in trace.curves]
    lower = [name for name in ("before", "after") if name in trace.curves]
    columns: dict[str, Any] = {"at": trace.at, "t": trace.t}
    for name, curve in trace.curves.items():
        columns |= {name: curve.middle, f"{name}_low": curve.low, f"{name}_high": curve.high}
    columns = {name: _compact(x) for name, x in columns.items()}
    few = len(trace.at) <= _FEW
    columns["run"] = [run_names[k] if k >= 0 else "" for k in trace.run]
    source = ColumnDataSource(data=columns)
    end = float(np.nanmax(trace.at))
    time = Range1d(start=-0.01 * end, end=1.01 * end, bounds=(-0.05 * end, 1.05 * end))
    made = []
    for names, what, height in ((upper, quantity, 330), (lower, "residual", 230)):
        if not names:
            continue
        one = _figure("held-out time, pauses cut out [s]", f"{what} [{unit}]", height)
        one.x_range = time
        for at in trace.cuts:
            one.add_layout(Span(location=float(at), dimension="height", line_color=_GREY, line_dash="dotted"))
        spread = names[:1] if names is upper else names
        bands = spread if trace.rows_per_point > 1 else []
        lines = [_trace_line(one, source, name, curve_name(name), name in bands, few) for name in names]
        tips = [(curve_name(name), f"@{name}{{0.0000}} {unit}") for name in names]
        hover = HoverTool(
            renderers=lines[:1], mode="vline", tooltips=[("t", "@t{0.000} s"), ("run", "@run"), *tips]
        )
        one.add_tools(hover)
        _finish(one)
        made.append(one)
    return made


def _figure(x_label: str, y_label: str, height: int) -> Any:
    made = figure(
        height=height,
        sizing_mode="stretch_width",
        tools="pan,box_zoom,wheel_zoom,reset,save",
        active_drag="box_zoom",
        toolbar_location="right",
        background_fill_color=None,
        border_fill_color=None,
        outline_line_color=None,
        min_border_left=76,
        output_backend="canvas",
    )
    made.toolbar.logo = None
    made.toolbar.autohide = True
    # Plain text: Bokeh would take a string between $$ for TeX and fetch a renderer.
    made.xaxis.axis_label = PlainText(text=x_label)
    made.yaxis.axis_label = PlainText(text=y_label)
    made.yaxis.formatter = BasicTickFormatter(power_limit_low=-6)
    for axis in (*made.xaxis, *made.yaxis):
        axis.axis_label_text_font_style = "normal"
        axis.minor_tick_line_color = None
        for part in ("axis_label_text", "major_label_text"):
            setattr(axis, f"{part}_font", "system-ui, sans-serif")
            setattr(axis, f"{part}_font_size", "12px")
    return made


def _curve(made: Any, source: ColumnDataSource, name: str, said: str) -> Any:
    colour, dash, mark, width = STYLES[name]
    shown = {"legend_label": said, "visible": name != "linear"}
    if name in _WITH_BARS:
        made.segment("at", f"{name}_low", "at", f"{name}_high", source=source, color=colour, alpha=0.35,
                     line_width=2, **shown)  # fmt: skip
    line = made.line("at", name, source=source, color=colour, line_dash=dash, line_width=width, **shown)
    if not mark:
        return line
    return made.scatter(
        "at", name, source=source, marker=mark, size=10 if name == "measured" else 5, color=colour, **shown
    )


def _trace_line(made: Any, source: ColumnDataSource, name: str, said: str, band: bool, few: bool) -> Any:
    colour, dash, mark, width = STYLES[name]
    if few:
        # A single row makes no line.
        made.scatter("at", name, source=source, marker=mark, size=7, color=colour, legend_label=said)
    if band:
        made.segment("at", f"{name}_low", "at", f"{name}_high", source=source, color=colour, alpha=0.3,
                     line_width=1.5, legend_label=said)  # fmt: skip
    return made.line(
        "at", name, source=source, color=colour, line_dash=dash, line_width=width, legend_label=said
    )


def _finish(made: Any) -> None:
    """The legend, above the plot; a click on an entry hides its curve."""
    legend = made.legend[0]
    made.add_layout(legend, "above")
    legend.click_policy = "hide"
    legend.orientation = "horizontal"
    legend.nrows = 1 + (len(legend.items) > 3)  # four in a row are wider than the plot on a narrow page
    legend.label_text_font = "system-ui, sans-serif"
    legend.label_text_font_size = "12px"
    legend.background_fill_color = None
    legend.border_line_color = None
    legend.spacing, legend.padding, legend.margin, legend.glyph_width = 10, 2, 2, 22


def _compact(x: Any) -> np.ndarray:
    """Single precision: seven digits are more than a screen resolves, at half the size."""
    array = np.asarray(x)
    return array.astype(np.float32) if array.dtype.kind == "f" else array.astype(np.int32)
