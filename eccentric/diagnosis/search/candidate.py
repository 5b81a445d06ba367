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
from scipy.interpolate import BSpline
from scipy.optimize import least_squares, minimize

from eccentric.diagnosis.search import limits
from eccentric.effects import Evidence, Shape, Words
from eccentric.model import Role

Array = np.ndarray
Values = dict[str, float]


@dataclass(frozen=True)
class Scaling:
    """What an effect multiplies."""

    base: Array  # factors on the columns of the base (samples, p)
    by_role: Mapping[Role, Array]  # role of friction -> factor (samples,)

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
    possible: whether the drive has the parts that it needs, and the log shows a period of it; one that is not
        possible is never adopted.
    periods: how many of its periods the log travels; infinite if it repeats with no angle.
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
    possible: bool = True
    periods: float = np.inf

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

    @property
    def covers(self) -> tuple[str, ...]:
        """Families that its name stands for as well."""
        return self.candidate.evidence.covers


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
    beside = np.diag([limits.NEIGHBOUR / max(shape.points - 1, 2) for _, shape in shapes])
    # The slope at the first point may lead out of a cell that is better further inside.
    places = np.clip([start, *(start + beside), *(start - beside)], 1.0 + limits.INSIDE, 2.0 - limits.INSIDE)

    def loss(place: Array) -> float:
        return float(np.sum(left(place) ** 2))

    best = min(places, key=loss)
    if any(shape.jumps for _, shape in shapes):
        return at(_without_slopes(loss, best, beside, steps))
    found = least_squares(
        left,
        best,
        bounds=(1.0, 2.0),
        diff_step=limits.DERIVATIVE_STEP,
        x_scale=np.diag(beside),
        xtol=limits.SHAPE_TOLERANCE,
        ftol=limits.LOSS_TOLERANCE,
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
            "maxfev": limits.SIMPLEX_STEPS * steps,
            "xatol": limits.SHAPE_TOLERANCE,
            "fatol": limits.LOSS_TOLERANCE * loss(start),
        },
    )
    return np.asarray(found.x)


def _value(shape: Shape, x: float) -> float:
    """The value at a place in the range, which is counted from 1 to 2: SciPy's steps are relative to it."""
    return shape.at(min(max(x - 1.0, 0.0), 1.0))


def _place(shape: Shape, values: Values) -> float:
    return 1.0 + shape.place_of(values[shape.quantity.name])


# Smooth terms: splines and Fourier sums in each variable of the diagnosis.
#
# They compete with the physical candidates in the same cross-validation: no physical effect explains what
# they still remove from a residual.
@dataclass(frozen=True)
class Variables:
    """What a residual may depend on: smooth signals (samples,), None where a log has none."""

    t: Array  # time in the run [s]
    theta_m: Array | None  # of the motor; None where the angles of several runs have no common zero
    omega_m: Array
    alpha_m: Array
    gravity: Array  # its torque on the motor side [N m]
    mu: float  # gear ratio
    current: Array | None = None  # [A]
    voltage: Array | None = None  # [V]
    temperature: Array | None = None  # [degC]
    # whether a row is the mean of a run: no time, and the acceleration between its ends only
    averaged: bool = False
    instruments: Variables | None = None  # the same without the noise of the target


def smooth_terms(variables: Variables, balance: str, valid: Array) -> list[Candidate]:
    """Empirical terms of a balance, one family "smooth:<variable>" each.

    valid (samples,): those that any window uses.
    """
    clean = variables.instruments
    instruments = {} if clean is None else _terms(clean, balance, valid)
    return [
        Candidate(
            id=f"smooth:{name}",
            family=f"smooth:{name}",
            balance=balance,
            evidence=Evidence((name,)),
            columns=lambda _, columns=columns: columns,
            instrument=None if clean is None else lambda _, columns=instruments[name]: columns,
            ridge=limits.RIDGE,
        )
        for name, columns in _terms(variables, balance, valid).items()
        if columns.shape[1]
    ]


def _terms(variables: Variables, balance: str, valid: Array) -> dict[str, Array]:
    """Columns (samples, k) by variable. Even and odd parts are both there: times sgn w, one is friction."""
    omega = variables.omega_m
    sign = np.sign(omega)[:, None]

    def both(columns: Array) -> Array:
        return np.hstack([columns, columns * sign])

    terms: dict[str, Array] = {
        "velocity": _spline(np.abs(omega), limits.PIECES["velocity"], valid) * sign,
        "direction": np.hstack(
            [np.ones_like(sign), _spline(np.abs(omega), limits.PIECES["direction"], valid)]
        ),
    }
    if not variables.averaged:
        elapsed = variables.t - variables.t[0]
        slope = _spline(elapsed, limits.PIECES["slope"], valid) * omega[:, None]
        terms["acceleration"] = _spline(variables.alpha_m, limits.PIECES["acceleration"], valid)
        terms["time"] = np.hstack([both(_spline(elapsed, limits.PIECES["time"], valid)), slope])
    if variables.theta_m is not None:
        terms["motor_angle"] = _fourier(variables.theta_m, range(1, limits.MOTOR_ORDERS + 1))
    if balance == "mechanical":
        if variables.theta_m is not None:
            terms["link_angle"] = both(
                _fourier(variables.mu * variables.theta_m, range(1, limits.LINK_ORDERS + 1))
            )
        if np.any(variables.gravity):
            terms["gravity_load"] = both(_spline(variables.gravity, limits.PIECES["gravity_load"], valid))
    if variables.current is not None:
        terms["current"] = _spline(variables.current, limits.PIECES["current"], valid)
    if variables.voltage is not None and balance == "electrical":
        terms["voltage"] = _spline(variables.voltage, limits.PIECES["voltage"], valid)
    if variables.temperature is not None:
        warm = _spline(variables.temperature, limits.PIECES["temperature"], valid)
        terms["temperature"] = np.hstack([warm, warm * sign, warm * omega[:, None]])
    return terms


def _spline(x: Array, pieces: int, valid: Array) -> Array:
    """Cubic B-splines of x, (samples, pieces + 2): the constant is left out.

    Half of the knots are at quantiles, half are evenly spaced within the 0.2 to 99.8 % range of the valid
    samples: a log dwells at few speeds, and what happens between them counts as well.
    """
    low, high = np.quantile(x[valid], limits.KNOTS)
    share = np.linspace(0.0, 1.0, pieces + 1)
    knots = 0.5 * (np.clip(np.quantile(x[valid], share), low, high) + low + (high - low) * share)
    if high - low <= limits.NO_RANGE * max(1.0, abs(low), abs(high)):
        return np.empty((len(x), 0))
    full = np.r_[[knots[0]] * 3, knots, [knots[-1]] * 3]
    return BSpline.design_matrix(np.clip(x, knots[0], knots[-1]), full, 3).toarray()[:, 1:]


def _fourier(angle: Array, orders: Sequence[int]) -> Array:
    return np.column_stack([f(n * angle) for n in orders for f in (np.cos, np.sin)])
