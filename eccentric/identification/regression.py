"""What a fit minimises: a linear design, its solution, and the uncertainty of the solution.

    target = columns @ values + residual        on m rows, `train` of them fitted

A nonlinear value is fixed while the design is made; `search` changes it, or `iterate`.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, Protocol, Self, SupportsFloat, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, lsq_linear

from eccentric.core import InputError
from eccentric.identification import limits
from eccentric.identification.uncertainty import Estimate, Spread, rms, spread
from eccentric.model import TURNING, AxisKind
from eccentric.signals import Filtered, Rows

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


# Sums of a design as triangles: R of the QR decomposition of its rows [X y].
#
# R'R are the normal equations, but R keeps the digits that these lose: its condition is that of X, not its
# square. Triangles of parts stack, and the R of the stack is that of the whole, in any order up to rounding.
def triangle_of(rows: Array) -> Array:
    """The triangle (k, k) of rows (m, k).

    By blocks, then once more for the blocks' triangles: a single tall decomposition uses threads that cost
    more than they gain, and a search needs hundreds.
    """
    block = np.arange(len(rows)) // limits.BLOCK_ROWS
    return merged(triangles(rows, block, -(-len(rows) // limits.BLOCK_ROWS)))


def triangles(rows: Array, block: Integers, count: int) -> Array:
    """Triangles (count, k, k) of rows (m, k), those of one block together; blocks (m,) do not decrease."""
    starts = np.searchsorted(block, np.arange(count + 1))
    longest = int(np.max(np.diff(starts), initial=0))
    width = rows.shape[1]
    padded = np.zeros((count, max(longest, width), width))
    padded[block, np.arange(len(rows)) - starts[block]] = rows
    return _upright(np.asarray(np.linalg.qr(padded, mode="r")))


def merged(stack: Array) -> Array:
    """The triangle (k, k) of several (..., k, k)."""
    return _upright(np.asarray(np.linalg.qr(stack.reshape(-1, stack.shape[-1]), mode="r")))


def _upright(triangle: Array) -> Array:
    """The same with a diagonal that is not negative: then it is unique, whatever the order of its rows."""
    sign = np.where(np.diagonal(triangle, axis1=-2, axis2=-1) < 0.0, -1.0, 1.0)
    return triangle * sign[..., None]


def require_rank(design: Array, names: Sequence[str], where: str, axis: AxisKind = TURNING) -> None:
    """Raise InputError, naming the coefficients that cannot be separated, if columns are dependent.

    `where` opens the message: the log.
    """
    zero, members = ([names[k] for k in places] for places in inseparable(design))
    if zero:
        raise InputError(
            where,
            problem=f"{', '.join(zero)} cannot be identified: nothing in the log depends on it"
            " (no unbalance, or no rows in one direction)",
        )
    if members:
        raise InputError(
            where,
            problem=f"{', '.join(members)} cannot be separated on this log: it takes more speeds"
            f" (or {axis.term('angles')}, in both directions)",
        )


def inseparable(
    design: Array, member: float = limits.MEMBER_PART, nothing: float = 0.0
) -> tuple[list[int], list[int]]:
    """Places of the columns of a design or its triangle that are zero, else of those that the rest makes up.

    `member`: least part of such a column in a dependency; `nothing`: of the largest column, a size that is 0.
    """
    size = np.linalg.norm(design, axis=0)
    if len(zero := np.flatnonzero(size <= nothing * np.max(size, initial=0.0))):
        return zero.tolist(), []
    found = np.linalg.svd(design / size, full_matrices=False)
    weak = np.abs(found.Vh[found.S < limits.LEAST_PART * found.S[0]])
    return [], np.flatnonzero(np.max(weak, axis=0, initial=0.0) > member).tolist()


ColumnRole = Literal[
    "friction",
    "effect",
    "armature",
    "inertia",
    "bodies",
    "load",
    "scale",
    "gravity",
    "back_emf",
    "offset",
    "zero_angle",
]
"""What a column is: friction of the base model, an effect in its own balance, one of the armature in the
mechanical balance, or something of the bench that the rig leaves open: `bodies` are base parameters of a
chain."""
FOLLOWING: frozenset[ColumnRole] = frozenset({"inertia", "back_emf", "bodies"})
"""Roles of columns that follow the angle, and so have passed its low pass."""


@dataclass(frozen=True)
class Coefficient:
    """A linear unknown: the coefficient of a column, its unit and bounds."""

    name: str
    role: ColumnRole
    unit: str
    lower: float = -math.inf
    upper: float = math.inf

    @classmethod
    def within(
        cls, name: str, role: ColumnRole, unit: str, bounds: tuple[SupportsFloat | None, SupportsFloat | None]
    ) -> Coefficient:
        """A coefficient with bounds as a model has them: None for a side that is open."""
        sides = zip(bounds, (-math.inf, math.inf), strict=True)
        return cls(name, role, unit, *(end if bound is None else float(bound) for bound, end in sides))


@dataclass(frozen=True)
class Nonlinear:
    """A nonlinear value: its unit, its range, where to start the search, a typical step."""

    name: str
    unit: str
    lower: float
    upper: float
    starts: tuple[float, ...]
    step: float

    def end_at(self, value: float) -> int:
        """Return -1 at the lower end of the range, 1 at the upper end, 0 in between."""
        return -1 if value <= self.lower else 1 if value >= self.upper else 0


@dataclass(frozen=True)
class Design:
    """Target (m,) and columns (m, k) in one unit; which rows are fitted, and their weights (m,)."""

    coefficients: tuple[Coefficient, ...]
    target: Array
    columns: Array
    train: Mask
    weights: Array

    @property
    def lower(self) -> Array:
        """The lower bounds (k,)."""
        return np.array([c.lower for c in self.coefficients])

    @property
    def upper(self) -> Array:
        """The upper bounds (k,)."""
        return np.array([c.upper for c in self.coefficients])

    def without_bounds(self, but: Collection[ColumnRole] = ()) -> Self:
        """The same with free coefficients, except for those of some roles."""
        freed = tuple(
            c if c.role in but else dataclasses.replace(c, lower=-math.inf, upper=math.inf)
            for c in self.coefficients
        )
        return dataclasses.replace(self, coefficients=freed)

    def solve(self) -> Solution:
        """Minimise the weighted squares on the fitted rows.

        The bounded-variable algorithm of Stark and Parker (1995) is exact: a bound is active or it is not.
        """
        root = np.sqrt(self.weights[self.train])
        rows, target = self.columns[self.train] * root[:, None], self.target[self.train] * root
        low, high, size = self.lower, self.upper, np.linalg.norm(rows, axis=0)
        size = np.where(size > 0.0, size, 1.0)
        triangle = triangle_of(np.column_stack([rows / size, target]))
        inner, right, active = triangle[:, :-1], triangle[:, -1], np.zeros(len(size), np.int64)
        if np.all(np.isinf(low)) and np.all(np.isinf(high)):
            values = np.linalg.lstsq(inner, right, rcond=None)[0] / size
        else:
            found = lsq_linear(inner, right, (low * size, high * size), method="bvls", tol=limits.ROUNDING)
            values, active = found.x / size, np.asarray(found.active_mask, dtype=np.int64)
        left = target - rows @ values
        # A value with an active bound is the bound, free of rounding.
        values = np.where(active < 0, low, np.where(active > 0, high, values))
        return Solution(self, values, active, left)


@dataclass(frozen=True)
class Solution:
    """A solved design: values (k,), and for each whether its lower (-1), upper (1) or no (0) bound is active.

    `weighted` is the residual on the fitted rows, times the root of their weights. `at` are the nonlinear
    values, by name, and `slopes` (m, q) those of the prediction minus the target, by each.
    """

    design: Design
    values: Array
    active: Integers
    weighted: Array
    at: Mapping[str, float] = field(default_factory=dict)
    slopes: Array | None = None

    @property
    def residual(self) -> Array:
        """The residual on all rows (m,)."""
        return self.design.target - self.design.columns @ self.values

    @property
    def cost(self) -> float:
        """The weighted sum of squares on the fitted rows."""
        return float(np.sum(self.weighted**2))

    def by_name(self) -> dict[str, float]:
        """The values by the names of their coefficients."""
        return {c.name: float(x) for c, x in zip(self.design.coefficients, self.values, strict=True)}

    def estimates(self, error: Spread | None = None) -> dict[str, Estimate]:
        """An estimate of each coefficient, by name; `error` is their spread, the first of its values."""
        error, design = error or self.spread(), self.design
        every = zip(design.coefficients, self.values, np.eye(len(error.alone)), self.active, strict=False)
        return {
            c.name: error.estimate(x, unit, c.unit, (c.lower, c.upper), int(active))
            for c, x, unit, active in every
        }

    def spread(self, nonlinear: Sequence[Nonlinear] = (), filtered: tuple[Design, ...] = ()) -> Spread:
        """Return the joint spread of the coefficients and then the nonlinear values.

        `filtered` is the design at one point, and the same after another filter that would do as well, or
        with the drive at another instant: what each would change is an error of unknown sign.
        """
        design = self.design
        ends = [n.end_at(self.at[n.name]) for n in nonlinear]
        active = np.concatenate([self.active, ends]).astype(np.int64)
        found = spread(
            self._tangents(design),
            self.weighted,
            np.concatenate([self.values, [self.at[n.name] for n in nonlinear]]),
            active,
            np.concatenate([design.lower, [n.lower for n in nonlinear]]),
            np.concatenate([design.upper, [n.upper for n in nonlinear]]),
        )
        if len(filtered) < 2:
            return found
        # The point need not be the optimum of the first: only the difference is the filter's.
        before, *after = (self._step(one, active == 0) for one in filtered)
        moved = np.array(after) - before
        return dataclasses.replace(found, matrix=found.matrix + moved.T @ moved)

    def _tangents(self, design: Design) -> Array:
        """The columns of a design, then the slopes by the nonlinear values, on fitted rows, weighted."""
        train = design.train
        slopes = np.zeros((len(train), 0)) if self.slopes is None else self.slopes
        return np.column_stack([design.columns, slopes])[train] * np.sqrt(design.weights[train])[:, None]

    def _step(self, design: Design, free: Mask) -> Array:
        """How a Gauss-Newton step on a design would move coefficients and nonlinear values (k + q,)."""
        train, tangents = design.train, self._tangents(design)
        left = (design.columns @ self.values - design.target)[train] * np.sqrt(design.weights[train])
        size, moved = np.linalg.norm(tangents, axis=0), np.zeros(len(free))
        seen = free & (size > limits.NO_INFLUENCE)
        moved[seen] = -np.linalg.lstsq(tangents[:, seen] / size[seen], left, rcond=None)[0] / size[seen]
        return moved


@dataclass(frozen=True, kw_only=True)
class BalanceDesign(Design):
    """The design of one scalar balance on the rows of the search, in N m on the motor side.

    Its columns are the base, which every model has.
    name: 'mechanical' or 'electrical'; scale: reference of shares (RMS of the friction or of the drive
    torque, N m); samples (n, p): the base before averaging, for effects that change it.
    """

    name: str
    rows: Rows
    scale: float
    samples: Array


def balance_design(
    name: str,
    rows: Rows,
    coefficients: Sequence[Coefficient],
    target: Array,
    base: Array,
    share_of: Array,
    filtered: Sequence[Filtered] = (),
) -> BalanceDesign:
    """Return the design of a target (n,) and base (n, p) of samples; shares are of `share_of`'s RMS.

    The target lacks what is `filtered`, and has passed the low pass already, as have the columns of the roles
    `FOLLOWING`.
    """
    columns, follow = np.array(rows.mean(base)), np.array([c.role in FOLLOWING for c in coefficients], bool)
    columns[:, follow] = rows.plain_mean(base[:, follow])
    return BalanceDesign(
        tuple(coefficients),
        rows.once(target, filtered),
        columns,
        rows.train,
        rows.weights,
        name=name,
        rows=rows,
        scale=rms(rows.mean(share_of)),
        samples=base,
    )


# Around linear least squares: a search over the few nonlinear values, or an iteration.
#
# Variable projection: for given nonlinear values the rest is linear, and the search minimises its best
# solution.  An iteration makes the next design from the solution of the last, until nothing changes.
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
            xtol=limits.VALUE_CHANGE,
            ftol=limits.COST_CHANGE,
            gtol=limits.LEAST_SLOPE,
            max_nfev=limits.MOST_EVALUATIONS,
        ).x
        # The algorithm stays inside the range; this close to an end counts as the end.
        ends = np.array([[s.lower, s.upper] for s in searched])
        near = limits.NEAR_END * (ends[:, 1] - ends[:, 0])
        best = np.where(best <= ends[:, 0] + near, ends[:, 0], best)
        best = np.where(best >= ends[:, 1] - near, ends[:, 1], best)
    at, found = named(best), solved(best)

    def misfit(moved: Mapping[str, float]) -> Array:
        design = problem.design(moved)
        return design.columns @ found.values - design.target

    return replace(found, at=at, slopes=slopes_between(misfit, at, _around(problem.nonlinear, at)))


def profile(problem: Searched, solution: Solution, one: Nonlinear) -> Profile:
    """Fit at evenly spaced values of one searched value over its range."""
    points = np.linspace(one.lower, one.upper, limits.PROFILE_POINTS)
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
        half = limits.SLOPE_STEP * s.step
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
