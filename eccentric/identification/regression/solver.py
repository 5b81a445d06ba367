"""Around linear least squares: a search over the few nonlinear values, or an iteration.

Variable projection: for given nonlinear values the rest is linear, and the search minimises its best
solution.  An iteration makes the next design from the solution of the last, until nothing changes.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from eccentric.identification.regression.design import Design, Nonlinear, Solution
from eccentric.identification.regression.limits import (
    COST_CHANGE,
    LEAST_SLOPE,
    MOST_EVALUATIONS,
    NEAR_END,
    PROFILE_POINTS,
    SLOPE_STEP,
    VALUE_CHANGE,
)

Array = NDArray[np.float64]


class Searched(Protocol):
    """A design that depends on nonlinear values."""

    @property
    def nonlinear(self) -> tuple[Nonlinear, ...]:
        """The nonlinear values."""
        ...

    def design(self, at: Mapping[str, float]) -> Design:
        """The design for given nonlinear values, by name."""
        ...


@dataclass(frozen=True)
class Profile:
    """Training RMSE over the range of one value, with all others fitted at each; `best` of its solutions."""

    values: tuple[float, ...]
    rmse: tuple[float, ...]
    best: Solution


def search(
    problem: Searched,
    *,
    bounds: bool = True,
    start: Mapping[str, float] | None = None,
    fixed: Mapping[str, float] | None = None,
) -> Solution:
    """Minimise over coefficients and nonlinear values.

    `bounds=False` removes the bounds of the coefficients, not those of the searched values; `start` is where
    their search starts; `fixed` fixes some of them.
    """
    held = dict(fixed or {})
    searched = [s for s in problem.nonlinear if s.name not in held]

    def named(x: Array) -> dict[str, float]:
        return {**held, **{s.name: float(v) for s, v in zip(searched, x, strict=True)}}

    def solved(x: Array) -> Solution:
        design = problem.design(named(x))
        return (design if bounds else design.without_bounds()).solve()

    best = _start(searched, lambda x: solved(x).cost, start)
    if searched:
        best = least_squares(
            lambda x: solved(x).weighted,
            best,
            bounds=([s.lower for s in searched], [s.upper for s in searched]),
            x_scale=[s.step for s in searched],
            xtol=VALUE_CHANGE,
            ftol=COST_CHANGE,
            gtol=LEAST_SLOPE,
            max_nfev=MOST_EVALUATIONS,
        ).x
        # The algorithm stays inside the range; this close to an end counts as the end.
        ends = np.array([[s.lower, s.upper] for s in searched])
        near = NEAR_END * (ends[:, 1] - ends[:, 0])
        best = np.where(best <= ends[:, 0] + near, ends[:, 0], best)
        best = np.where(best >= ends[:, 1] - near, ends[:, 1], best)
    at, found = named(best), solved(best)

    def misfit(moved: Mapping[str, float]) -> Array:
        design = problem.design(moved)
        return design.columns @ found.values - design.target

    return replace(found, at=at, slopes=slopes_between(misfit, at, _around(problem.nonlinear, at)))


def profile(problem: Searched, solution: Solution, one: Nonlinear) -> Profile:
    """Fit at evenly spaced values of one searched value over its range."""
    points = np.linspace(one.lower, one.upper, PROFILE_POINTS)
    design = solution.design
    found = [search(problem, fixed={one.name: float(v)}, start=solution.at) for v in points]
    weight = float(np.sum(design.weights[design.train]))
    rmse = tuple(float(np.sqrt(s.cost / weight)) for s in found)
    return Profile(tuple(map(float, points)), rmse, min(found, key=lambda s: s.cost))


def slopes_between(
    misfit: Callable[[Mapping[str, float]], Array],
    at: Mapping[str, float],
    ends: Mapping[str, tuple[float, float]],
) -> Array:
    """Slopes (m, q) of a function of values by name, each from its difference between two ends of one."""
    slopes = [
        (misfit({**at, name: high}) - misfit({**at, name: low})) / (high - low)
        for name, (low, high) in ends.items()
    ]
    return np.column_stack(slopes) if slopes else np.zeros((len(misfit(at)), 0))


Point = TypeVar("Point")


def iterate(
    advance: Callable[[Point], tuple[Point, float]], start: Point, most: int, converged: float
) -> tuple[Point, float]:
    """Advance until the relative change is below `converged`, `most` times at most; return both."""
    point, change = advance(start)
    for _ in range(most - 1):
        if change < converged:
            break
        point, change = advance(point)
    return point, change


def _around(nonlinear: Sequence[Nonlinear], at: Mapping[str, float]) -> dict[str, tuple[float, float]]:
    """Ends of central differences, inside the ranges.

    A delay moves between rows: a step well below a row would see only one side of its kinks.
    """
    ends: dict[str, tuple[float, float]] = {}
    for s in nonlinear:
        half = SLOPE_STEP * s.step
        low, high = (min(max(at[s.name] + d, s.lower), s.upper) for d in (-half, half))
        ends[s.name] = low, high
    return ends


def _start(
    searched: Sequence[Nonlinear], cost: Callable[[Array], float], start: Mapping[str, float] | None
) -> Array:
    """The best of all combinations of starting values; the given one if there is one."""
    if start is not None:
        return np.array([np.clip(start[s.name], s.lower, s.upper) for s in searched])
    choices = [np.array(x) for x in itertools.product(*(s.starts for s in searched))]
    return choices[0] if len(choices) == 1 else min(choices, key=cost)
