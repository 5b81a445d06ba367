"""The picture of an effect: what it adds, over its leading variable, for a few values of its shape."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.figure import Figure

from eccentric.effects import Effect, Shape
from eccentric.model import Model
from generator.curves import added, course

# Told apart by the colour-blind, and readable on white and on black; the text has one colour for each.
COLOURS, INK, PALE_INK = ("#0b84c8", "#d95f02", "#1b9e77"), "#3b3b3b", "#c9c9c9"
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",  # letters stay letters: small, sharp, in the reader's own font
    "svg.hashsalt": "eccentric",
    "font.size": 9,
    "text.color": INK,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.prop_cycle": cycler(color=COLOURS, linestyle=("-", "--", "-.")),
    "legend.frameon": False,
}


def draw(effect: Effect, base: Model, path: Path) -> str:
    """Draw the effect into path.svg and path-dark.svg; return what they show, in words."""
    x_label, x, inputs = course(effect)
    adds = added(effect, base)
    with mpl.rc_context(STYLE):
        figure = Figure((5.0, 2.4), layout="constrained")
        axes = figure.add_subplot()
        for label, values in _choices(effect):
            y = adds(values, inputs)
            if not (np.all(np.isfinite(y)) and np.any(y)):
                raise ValueError(f"effect {effect.id}: nothing to draw for {label or 'its one curve'}")
            scale = np.max(np.abs(y)) if effect.coefficients else 1.0
            (line,) = axes.plot(x, y / scale, label=label)
            if "angle" in x_label or "gravity" in x_label:
                back = adds(values, {**inputs, "omega_m": -inputs["omega_m"]})
                axes.plot(x, back / scale, color=line.get_color(), linestyle=":", linewidth=1.0)
        what = "torque" if effect.balance == "mechanical" else "voltage"
        unit = "N m" if effect.balance == "mechanical" else "V"
        y_label = f"{what}, largest = 1" if effect.coefficients else f"added {what} [{unit}]"
        axes.set_xlabel(x_label)
        axes.set_ylabel(y_label)
        axes.axhline(0.0, color=INK, linewidth=0.5, linestyle="-", zorder=0)
        labels = axes.get_legend_handles_labels()[1]
        title = _title(effect)
        if labels:
            figure.legend(loc="outside right upper", title=title, alignment="left")
    save(figure, path)
    return f"{y_label} over {x_label}" + (f", for {title} {', '.join(labels)}" if labels else "")


def save(figure: Figure, path: Path) -> None:
    """Write path.svg, for white pages, and path-dark.svg, without a date."""
    path.parent.mkdir(parents=True, exist_ok=True)
    light = path.with_name(f"{path.name}.svg")
    with mpl.rc_context(STYLE):
        figure.savefig(light, transparent=True, metadata={"Date": None})
    text = light.read_text(encoding="utf-8")
    path.with_name(f"{path.name}-dark.svg").write_text(text.replace(INK, PALE_INK), encoding="utf-8")


def _title(effect: Effect) -> str:
    """What the curves differ in."""
    if len(effect.coefficients) > 1:
        return "alone:"
    if not effect.shapes:
        return ""
    q = effect.shapes[0].quantity
    return q.name if q.unit == "1" else f"{q.name} [{q.unit}]"


def _choices(effect: Effect) -> Iterator[tuple[str | None, dict[str, float]]]:
    """Label and values of the parameters of each curve."""
    middle = {shape.quantity.name: _between(shape, 0.5) for shape in effect.shapes}
    ones = {q.name: 1.0 for q in effect.coefficients}
    if len(ones) > 1:
        for name in ones:
            yield name, {**middle, **dict.fromkeys(ones, 0.0), name: 1.0}
    elif effect.shapes:
        shape = effect.shapes[0]
        for part in (0.15, 0.4, 0.65):
            value = _between(shape, part)
            yield f"{float(f'{value:.3g}'):g}", {**ones, **middle, shape.quantity.name: value}
    else:
        yield None, ones


def _between(shape: Shape, part: float) -> float:
    """A value of the range, by the scale it is searched on."""
    if shape.scale == "log":
        return shape.low ** (1 - part) * shape.high**part
    return shape.low + part * (shape.high - shape.low)
