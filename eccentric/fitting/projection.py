"""Variable projection: linear coefficients inside, the few values that enter otherwise outside."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from eccentric.fitting.least_squares import Linear, bounded

if TYPE_CHECKING:
    from eccentric.fitting.problem import Problem, Searched

Array = NDArray[np.float64]

PROFILE_POINTS = 9
NEAR_END = 1e-3
"""Part of a range within which a value counts as lying at its end."""


@dataclass(frozen=True)
class Solution:
    """A minimum: coefficients (k,), active bounds (k,), searched values by name.

    On all rows (m,) of the problem: the residual, the columns (m, k), the slopes (m, q) of the prediction by
    the searched values. `cost` is the weighted sum of squares on the training rows.
    """

    coefficients: Array
    active: NDArray[np.int64]
    values: Mapping[str, float]
    residual: Array
    design: Array
    slopes: Array
    cost: float


@dataclass(frozen=True)
class Profile:
    """Training RMSE over the range of one value, all else fitted at each; `best` of its solutions."""

    values: tuple[float, ...]
    rmse: tuple[float, ...]
    best: Solution


def solve(
    problem: Problem,
    *,
    linear: bool = False,
    bounds: bool = True,
    start: Mapping[str, float] | None = None,
    fixed: Mapping[str, float] | None = None,
) -> Solution:
    """Minimise over coefficients and searched values.

    `linear` leaves out all friction but Coulomb and viscous, `bounds=False` the bounds of the coefficients
    (those of the searched values stay); `start` saves the search for one; `fixed` holds some of the values.
    """
    used = np.array([c.linear or not linear for c in problem.coefficients])
    none = np.full(int(used.sum()), np.inf)
    low = np.array([c.lower for c in problem.coefficients])[used] if bounds else -none
    high = np.array([c.upper for c in problem.coefficients])[used] if bounds else none
    train = problem.rows.train
    root = np.sqrt(problem.rows.weights[train])
    held = dict(fixed or {})
    searched = [s for s in problem.searched if s.name not in held]

    def inner(values: Mapping[str, float]) -> tuple[Linear, Array]:
        target, design = problem.design(values)
        target, design = target[train] * root, design[train][:, used] * root[:, None]
        found = bounded(design, target, low, high)
        return found, target - design @ found.coefficients

    def named(x: Array) -> dict[str, float]:
        return {**held, **{s.name: float(v) for s, v in zip(searched, x, strict=True)}}

    best = _start(searched, lambda x: float(np.sum(inner(named(x))[1] ** 2)), start)
    if searched:
        best = least_squares(
            lambda x: inner(named(x))[1],
            best,
            bounds=([s.lower for s in searched], [s.upper for s in searched]),
            x_scale=[s.step for s in searched],
            xtol=1e-6,
            ftol=1e-9,
            gtol=1e-14,  # without it, a value that nothing depends on would be divided by zero
            max_nfev=30,
        ).x
        # The algorithm stays inside the range; what it comes this near to is its end.
        ends = np.array([[s.lower, s.upper] for s in searched])
        near = NEAR_END * (ends[:, 1] - ends[:, 0])
        best = np.where(best <= ends[:, 0] + near, ends[:, 0], best)
        best = np.where(best >= ends[:, 1] - near, ends[:, 1], best)
    values = named(best)
    found, error = inner(values)
    coefficients, active = np.zeros(len(used)), np.zeros(len(used), dtype=np.int64)
    coefficients[used], active[used] = found.coefficients, found.active
    target, design = problem.design(values)
    slopes = _slopes(problem, values, coefficients)
    return Solution(
        coefficients, active, values, target - design @ coefficients, design, slopes, float(np.sum(error**2))
    )


def profile(problem: Problem, solution: Solution, searched: Searched) -> Profile:
    """Fit at evenly spaced values of one searched value over its range."""
    points = np.linspace(searched.lower, searched.upper, PROFILE_POINTS)
    found = [solve(problem, fixed={searched.name: float(v)}, start=solution.values) for v in points]
    weight = float(np.sum(problem.rows.weights[problem.rows.train]))
    rmse = tuple(float(np.sqrt(s.cost / weight)) for s in found)
    return Profile(tuple(map(float, points)), rmse, min(found, key=lambda s: s.cost))


def _start(
    searched: list[Searched], cost: Callable[[Array], float], start: Mapping[str, float] | None
) -> Array:
    """The best of all combinations of starting values; the given one where there is one."""
    if start is not None:
        return np.array([np.clip(start[s.name], s.lower, s.upper) for s in searched])
    choices = [np.array(x) for x in itertools.product(*(s.starts for s in searched))]
    return choices[0] if len(choices) == 1 else min(choices, key=cost)


def _slopes(problem: Problem, values: Mapping[str, float], coefficients: Array) -> Array:
    """Slopes (m, q) of prediction minus target by the searched values, by central differences."""
    slopes: list[Array] = []
    for s in problem.searched:
        # A delay moves between rows; a step well below a row sees one side of its kinks only.
        half = 0.05 * s.step
        ends = [min(max(values[s.name] + d, s.lower), s.upper) for d in (-half, half)]
        one, two = (problem.design({**values, s.name: end}) for end in ends)
        rise = (two[1] @ coefficients - two[0]) - (one[1] @ coefficients - one[0])
        slopes.append(rise / (ends[1] - ends[0]))
    return np.column_stack(slopes) if slopes else np.zeros((len(problem.rows), 0))
