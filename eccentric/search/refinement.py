"""Shapes between the points of their grid: nonlinear least squares on the residual of the bounded fit.

Where the residual jumps with one of them, it has no slope: then a simplex searches all of them.

The coefficients are eliminated, as in the variable projection of G. H. Golub and V. Pereyra (SIAM Journal on
Numerical Analysis 10(2), 1973), so that only the shapes are searched.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import least_squares, minimize

from eccentric.effects import Shape
from eccentric.search.candidate import Values, Variant
from eccentric.search.limits import (
    DERIVATIVE_STEP,
    INSIDE,
    LOSS_TOLERANCE,
    NEIGHBOUR,
    SHAPE_TOLERANCE,
    SIMPLEX_STEPS,
)

__all__ = ["refined"]

Array = np.ndarray


def refined(
    variants: Sequence[Variant], residual: Callable[[Sequence[Variant]], Array], steps: int
) -> list[Variant]:
    """The variants of least sum of squares near these, all shapes at once.

    One after another they would zigzag: what one shape leaves, another takes.

    Args:
        variants: where the search begins; some of them may have no shapes.
        residual: variants -> what the fit of all coefficients leaves (rows,).
        steps: of the search, at most; each costs one fit, and one more for each shape. A simplex takes
            `SIMPLEX_STEPS` fits for each.
    """
    shapes = [(k, shape) for k, variant in enumerate(variants) for shape in variant.candidate.shapes]

    def at(place: Array) -> list[Variant]:
        values: list[dict[str, float]] = [{} for _ in variants]
        for (k, shape), x in zip(shapes, place, strict=True):
            values[k][shape.quantity.name] = _value(shape, float(x))
        return [Variant(old.candidate, new) for old, new in zip(variants, values, strict=True)]

    def left(place: Array) -> Array:
        return residual(at(place))

    start = np.array([_place(shape, variants[k].values) for k, shape in shapes])
    beside = np.diag([NEIGHBOUR / max(shape.points - 1, 2) for _, shape in shapes])
    # The slope at the first point may lead out of a cell that is better further inside.
    places = np.clip([start, *(start + beside), *(start - beside)], 1.0 + INSIDE, 2.0 - INSIDE)

    def loss(place: Array) -> float:
        return float(np.sum(left(place) ** 2))

    best = min(places, key=loss)
    if any(shape.jumps for _, shape in shapes):
        return at(_without_slopes(loss, best, beside, steps))
    found = least_squares(
        left,
        best,
        bounds=(1.0, 2.0),
        diff_step=DERIVATIVE_STEP,
        x_scale=np.diag(beside),
        xtol=SHAPE_TOLERANCE,
        ftol=LOSS_TOLERANCE,
        max_nfev=steps,
    )
    return at(found.x)


def _without_slopes(loss: Callable[[Array], float], start: Array, beside: Array, steps: int) -> Array:
    """The place (shapes,) of least loss near the start, by the simplex of Nelder and Mead of that size."""
    inward = np.where(start + np.diag(beside) < 2.0, 1.0, -1.0)
    found = minimize(
        loss,
        start,
        method="Nelder-Mead",
        bounds=[(1.0, 2.0)] * len(start),
        options={
            "initial_simplex": [start, *(start + inward[:, None] * beside)],
            "maxfev": SIMPLEX_STEPS * steps,
            "xatol": SHAPE_TOLERANCE,
            "fatol": LOSS_TOLERANCE * loss(start),
        },
    )
    return np.asarray(found.x)


def _value(shape: Shape, x: float) -> float:
    """The value at a place in the range, which is counted from 1 to 2: SciPy's steps are relative to it."""
    return shape.at(min(max(x - 1.0, 0.0), 1.0))


def _place(shape: Shape, values: Values) -> float:
    return 1.0 + shape.place_of(values[shape.quantity.name])
