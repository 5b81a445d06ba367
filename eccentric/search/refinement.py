"""Shapes between the points of their grid: simplex search of the bounded fit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

from eccentric.effects import Shape
from eccentric.search.candidate import Values, Variant
from eccentric.search.limits import FIRST_STEP, LOSS_TOLERANCE, SHAPE_TOLERANCE

__all__ = ["refined"]

Array = np.ndarray


def refined(variant: Variant, loss: Callable[[Variant], float], evaluations: int) -> Variant:
    """The variant of least loss near this one; `evaluations` at most for each shape."""
    shapes = variant.candidate.shapes

    def at(point: Array) -> Variant:
        values = zip(shapes, np.clip(point, 0.0, 1.0), strict=True)
        return Variant(variant.candidate, {s.quantity.name: _value(s, float(x)) for s, x in values})

    start = np.array([_place(s, variant.values) for s in shapes])
    steps = np.array([FIRST_STEP / max(s.points - 1, 2) for s in shapes])
    simplex = np.vstack([start, start + np.diag(np.where(start + steps <= 1.0, steps, -steps))])
    found = minimize(
        lambda point: loss(at(point)),
        start,
        method="Nelder-Mead",
        options={
            "initial_simplex": simplex,
            "maxfev": evaluations * len(steps),
            "xatol": SHAPE_TOLERANCE,
            "fatol": LOSS_TOLERANCE,
        },
    )
    return at(found.x)


def _value(shape: Shape, x: float) -> float:
    """The value at a position in the range, 0 to 1."""
    if shape.scale == "log":
        return float(shape.low * (shape.high / shape.low) ** x)
    return float(shape.low + (shape.high - shape.low) * x)


def _place(shape: Shape, values: Values) -> float:
    value = values[shape.quantity.name]
    if shape.scale == "log":
        return float(np.log(value / shape.low) / np.log(shape.high / shape.low))
    return (value - shape.low) / (shape.high - shape.low)
