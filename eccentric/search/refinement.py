"""Shapes between the points of their grid: simplex search of the bounded fit."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import minimize

from eccentric.effects import Shape
from eccentric.search.candidate import Values, Variant
from eccentric.search.limits import FIRST_STEP, LOSS_TOLERANCE, SHAPE_TOLERANCE

__all__ = ["refined"]

Array = np.ndarray


def refined(
    variants: Sequence[Variant], loss: Callable[[Sequence[Variant]], float], evaluations: int
) -> list[Variant]:
    """The variants of least loss near these, all shapes at once; `evaluations` at most for each shape.

    One after another they would zigzag: what one shape leaves, another takes.
    """
    shapes = [(k, shape) for k, variant in enumerate(variants) for shape in variant.candidate.shapes]

    def at(point: Array) -> list[Variant]:
        values: list[dict[str, float]] = [{} for _ in variants]
        for (k, shape), x in zip(shapes, np.clip(point, 0.0, 1.0), strict=True):
            values[k][shape.quantity.name] = _value(shape, float(x))
        return [Variant(old.candidate, new) for old, new in zip(variants, values, strict=True)]

    start = np.array([_place(shape, variants[k].values) for k, shape in shapes])
    steps = np.array([FIRST_STEP / max(shape.points - 1, 2) for _, shape in shapes])
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
