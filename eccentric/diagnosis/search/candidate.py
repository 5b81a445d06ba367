"""What the search knows of an effect: columns of torque with a few shape parameters.

Method and physics are separated here: a candidate computes columns [N m, motor side], the search compares
columns. `from_effect` turns a record of `eccentric.effects` into a candidate, `smooth` makes those without an
effect behind them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import least_squares, minimize

from eccentric.diagnosis.search.limits import (
    DERIVATIVE_STEP,
    INSIDE,
    LOSS_TOLERANCE,
    NEIGHBOUR,
    SHAPE_TOLERANCE,
    SIMPLEX_STEPS,
)
from eccentric.effects import Evidence, Shape, Words
from eccentric.model import Role

Array = np.ndarray
Values = dict[str, float]


@dataclass(frozen=True)
class Scaling:
    """What an effect multiplies.

    base: factors on the columns of the base (samples, p); by_role: role of friction -> factor (samples,).
    """

    base: Array
    by_role: Mapping[Role, Array]

    def on(self, roles: Sequence[Role]) -> Array:
        """The factors on columns of these roles (samples, k)."""
        one = np.ones(len(self.base))
        return np.column_stack([self.by_role.get(role, one) for role in roles])


@dataclass(frozen=True)
class Candidate:
    """One way in which an effect may enter a balance.

    id: name in the report, as `link_harmonic_friction[n=3]`; several candidates share a `family`.
    balance: "mechanical" or "electrical"; columns are in N m on the motor side in both.
    evidence: how it shows in a log.
    columns: values of the shapes -> (samples, k); hidden states run from the start of the log.
    shapes: nonlinear parameters with their ranges.
    lower: lower bound of each column's coefficient, 0 or -inf; a single one holds for all.
    ranges: of the coefficients that may have either sign, beyond which a fit is refused; empty for no limit.
    changes: values of the shapes -> (what is known to be missing (samples,), base (samples, p)), of an effect
        that changes a quantity inside the base (an angle, a factor on friction). Its parameters are all in
        `shapes`; `columns` are then used in the first screening only.
    scales: values of the shapes -> what an effect multiplies that does so; it has `changes` too.
    roles: of the friction in each column, which such an effect goes by; empty where there is none.
    also: values of the shapes -> what an effect of one balance adds to the target of the other
        (samples, k), for the same coefficients.
    also_instrument: the same on signals whose noise is not the target's, None where there are none.
    joint: whether both balances measure it: the flux of the motor shows in torque and voltage.
    instrument: the same columns on signals whose noise is not the target's, None where there are none.
    tolerance: of a declared value that it corrects, in units of its coefficient; 0 if it corrects none.
    ridge: penalty on the coefficients, relative to their scaled diagonal (smooth terms only).
    words: what a person reads about it.
    """

    id: str
    family: str
    balance: str
    evidence: Evidence
    columns: Callable[[Values], Array]
    shapes: tuple[Shape, ...] = ()
    lower: tuple[float, ...] = (-np.inf,)
    ranges: tuple[tuple[float, float], ...] = ()
    changes: Callable[[Values], tuple[Array, Array]] | None = None
    scales: Callable[[Values], Scaling] | None = None
    roles: tuple[Role, ...] = ()
    also: Callable[[Values], Array] | None = None
    joint: bool = False
    instrument: Callable[[Values], Array] | None = None
    tolerance: float = 0.0
    ridge: float = 0.0
    words: Words = field(default_factory=Words)
    also_instrument: Callable[[Values], Array] | None = None

    @property
    def deviation(self) -> float:
        """The standard deviation of a declared value of which only a tolerance is known (GUM 4.3.7)."""
        return self.tolerance / float(np.sqrt(3.0))

    def in_the(self, balance: str, values: Values | None = None) -> Candidate:
        """The same effect as the other balance shows it, with its shapes free, or held at some values.

        Raises ValueError if it shows nothing there.
        """
        if self.also is None:
            raise ValueError(f"effect {self.id} adds nothing to the {balance} balance")
        shown = replace(
            self,
            balance=balance,
            columns=self.also,
            instrument=self.also_instrument,
            also=None,
            also_instrument=None,
        )
        if values is None:
            return shown
        here, there, held = shown.columns, shown.instrument, dict(values)
        return replace(
            shown,
            shapes=(),
            columns=lambda _: here(held),
            instrument=None if there is None else lambda _: there(held),
        )

    @property
    def variable(self) -> str:
        """The leading variable that it depends on: "velocity", "link_angle", ..."""
        return self.evidence.depends_on[0]


@dataclass(frozen=True)
class Variant:
    """A candidate at one set of values of its shapes."""

    candidate: Candidate
    values: Values

    @property
    def key(self) -> tuple[object, ...]:
        """What distinguishes it from other variants."""
        return (self.candidate.id, *self.values.values())


def instrument_of(variant: Variant) -> Variant | None:
    """The same variant on its instruments, None if it has none."""
    candidate = variant.candidate
    if candidate.instrument is None:
        return None
    twin = replace(
        candidate,
        id=f"{candidate.id} (instrument)",
        columns=candidate.instrument,
        changes=None,
        scales=None,
        instrument=None,
    )
    return Variant(twin, variant.values)


def grid(candidate: Candidate) -> list[Variant]:
    """The variants on all grid points of a candidate's shapes; a single one if it has none."""
    names = [shape.quantity.name for shape in candidate.shapes]
    axes = [
        np.geomspace(s.low, s.high, s.points) if s.scale == "log" else np.linspace(s.low, s.high, s.points)
        for s in candidate.shapes
    ]
    return [
        Variant(candidate, dict(zip(names, map(float, point), strict=True)))
        for point in itertools.product(*axes)
    ]


def bounds_of(candidate: Candidate, width: int) -> Array:
    """Lower bounds of the coefficients of a candidate's columns, (width,)."""
    own = np.asarray(candidate.lower, float)
    return own if len(own) == width else np.full(width, own[0])


# Shapes between the points of their grid: nonlinear least squares on the residual of the bounded fit.
#
# Where the residual jumps with one of them, it has no slope: then a simplex searches all of them.
#
# The coefficients are eliminated, as in the variable projection of G. H. Golub and V. Pereyra (SIAM Journal
# on Numerical Analysis 10(2), 1973), so that only the shapes are searched.


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
