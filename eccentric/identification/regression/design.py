"""What a fit minimises: a linear design, its solution, and the uncertainty of the solution.

    target = columns @ values + residual        on m rows, `train` of them fitted

A nonlinear value is fixed while the design is made; `solver` changes it.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, Self, SupportsFloat

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from eccentric.core import InputError
from eccentric.identification.regression.limits import (
    BLOCK_ROWS,
    LEAST_PART,
    MEMBER_PART,
    NO_INFLUENCE,
    ROUNDING,
)
from eccentric.identification.regression.uncertainty import Spread, rms, spread
from eccentric.signals import Filtered, Rows

# Weighted linear least squares with bounds, and the rank of its design.


Array = NDArray[np.float64]


@dataclass(frozen=True)
class Linear:
    """Coefficients (k,), and for each whether its lower (-1), upper (1) or no (0) bound is active."""

    coefficients: Array
    active: NDArray[np.int64]


def bounded(design: Array, target: Array, lower: Array, upper: Array) -> Linear:
    """Minimise |design @ x - target| over lower <= x <= upper; design (m, k), others (m,) and (k,).

    The bounded-variable algorithm of Stark and Parker (1995) is exact: a bound is active or it is not.
    """
    size = np.linalg.norm(design, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    triangle = _triangle(np.column_stack([design / size, target]))
    free = bool(np.all(np.isinf(lower)) and np.all(np.isinf(upper)))
    if free:
        scaled = np.linalg.lstsq(triangle[:, :-1], triangle[:, -1], rcond=None)[0]
        return Linear(scaled / size, np.zeros(len(scaled), dtype=np.int64))
    found = lsq_linear(
        triangle[:, :-1], triangle[:, -1], (lower * size, upper * size), method="bvls", tol=ROUNDING
    )
    return Linear(found.x / size, np.asarray(found.active_mask, dtype=np.int64))


def _triangle(rows: Array) -> Array:
    """Return R (k, k) of the QR decomposition of rows (m, k): it has the same least squares as all of them.

    By blocks, then once more for the blocks' triangles: a single tall decomposition uses threads that cost
    more than they gain, and a search needs hundreds.
    """
    count = rows.shape[1]
    blocks = -(-len(rows) // BLOCK_ROWS)
    padded = np.zeros((blocks * BLOCK_ROWS, count))
    padded[: len(rows)] = rows
    stack = np.asarray(np.linalg.qr(padded.reshape(blocks, BLOCK_ROWS, count), mode="r"))
    return np.asarray(np.linalg.qr(stack.reshape(-1, count), mode="r"))


def require_rank(design: Array, names: Sequence[str], where: str) -> None:
    """Raise InputError, naming the coefficients that cannot be separated, if columns are dependent.

    `where` opens the message: the log.
    """
    zero = [name for name, column in zip(names, design.T, strict=True) if not np.any(column)]
    if zero:
        raise InputError(
            f"{where}: {', '.join(zero)} cannot be identified: nothing in the log depends on it"
            " (no unbalance, or no rows in one direction)"
        )
    sizes = np.linalg.svd(design / np.linalg.norm(design, axis=0), full_matrices=False)
    weak = sizes.Vh[sizes.S < LEAST_PART * sizes.S[0]]
    if len(weak):
        members = [
            n for n, part in zip(names, np.max(np.abs(weak), axis=0), strict=True) if part > MEMBER_PART
        ]
        raise InputError(
            f"{where}: {', '.join(members)} cannot be separated on this log: more different speeds"
            " (or angles, in both directions) are required"
        )


Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

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


# The design of a fit: coefficients with bounds and roles, its target and its solution.


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
        """Minimise the weighted squares on the fitted rows."""
        root = np.sqrt(self.weights[self.train])
        rows, target = self.columns[self.train] * root[:, None], self.target[self.train] * root
        low, high = self.lower, self.upper
        found = bounded(rows, target, low, high)
        # A value with an active bound is the bound, free of rounding.
        values = np.where(found.active < 0, low, np.where(found.active > 0, high, found.coefficients))
        return Solution(self, values, found.active, target - rows @ found.coefficients)


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

    def spread(
        self, nonlinear: Sequence[Nonlinear] = (), filtered: tuple[Design, Design] | None = None
    ) -> Spread:
        """Return the joint spread of the coefficients and then the nonlinear values.

        `filtered` is the design at one point, and the same after another filter that would do as well: what
        that would change is an error of unknown sign.
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
        if filtered is None:
            return found
        # The point need not be the optimum of the first: only the difference is the filter's.
        before, after = (self._step(one, active == 0) for one in filtered)
        moved = after - before
        return dataclasses.replace(found, matrix=found.matrix + np.outer(moved, moved))

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
        seen = free & (size > NO_INFLUENCE)
        moved[seen] = -np.linalg.lstsq(tangents[:, seen] / size[seen], left, rcond=None)[0] / size[seen]
        return moved


# A balance of a log as a linear design: target = columns @ coefficients + missing part of the model.


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
