"""What is promised of the emitted arithmetic: bounds that `tests/test_accuracy*.py` measure.

They are relative to 50 digits, with inputs and parameters taken as exact, over the whole plane, including the
zero of F_N, for motor angles up to 1e4 rad. Bounds proved by Gappa are marked. The others were found by a
search over states and parameters, and are stated one to two units above the worst case found.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from decimal import ROUND_UP, Context, Decimal, localcontext
from functools import cache
from typing import NamedTuple

import mpmath
import sympy as sp

from eccentric.emission.program.lower import split
from eccentric.model import (
    Gated,
    HalfCosine,
    HalfSine,
    Magnitude,
    Model,
    Quantity,
    SquareDifference,
    moving,
    normal_force,
)
from eccentric.model import vocabulary as v

# How many digits a number has, and the parts that a parameter is split into.
#
# Integers and half-integers times a part of few digits are exact, in every precision. Double precision uses
# three parts, single precision five; the last one has all digits.

BITS = {"single": 24, "double": 53}
# Bits that `Leading` keeps, and those that remain for a number of half turns. In single precision these are
# 14 bits: within 1e4 rad of the motor, a link that turns five times as far does not need more.
LEADING_BITS = {"single": 10, "double": 33}
TURN_BITS = {precision: bits - LEADING_BITS[precision] for precision, bits in BITS.items()}


class Bound(NamedTuple):
    """The largest error in units, with any parameters and with those of Table 1."""

    anywhere: int
    table_1: int

    def within(self, unit: str, table_1: bool) -> str:
        """The bound in words, with a tighter one if the defaults of the model are Table 1."""
        tighter = f" (Table 1: {self.table_1})" if table_1 and self.table_1 < self.anywhere else ""
        return f"within {self.anywhere}{tighter} {unit}"


# In units in the last place of the exact value; without an angle the slopes are as accurate as the friction.
PROVED_FORCE = Bound(5, 5)
NORMAL_FORCE = Bound(8, 7)
FRICTION_TORQUE = Bound(9, 8)
WITHOUT_ANGLE = Bound(6, 6)
# In eps of the working precision, of the sizes that `promises` words.
GRADIENT = Bound(15, 7)
ACCELERATED_FORCE = Bound(12, 12)
ACCELERATED_FRICTION = Bound(12, 12)
ACCELERATED_GRADIENT = Bound(12, 7)
# Of the link angle, in rad; the parts of a shift by half a turn are not exact where theta_m is nearly 0.
LARGEST_SHIFT = 3
LARGEST_ANGLE = 10_000  # of the motor, in rad
# A link that turns further would pass more half turns within that angle than are subtracted exactly.
LARGEST_RATIO = int(2 ** min(TURN_BITS.values()) * math.pi / LARGEST_ANGLE)

# What is promised of an arm's arithmetic: bounds that `tests/test_arm_accuracy.py` measures at 50 digits.
#
# They are relative to the size that forces and moments can have at that motion, not to the results: these are
# small where the forces of several bodies cancel. With all masses M, the reach R (the distances of the joints
# from one another, the travel of slides, the farthest centre of mass and the largest radius of gyration,
# added), the farthest centre of a bearing from its joint r, and the sums W, A, V, B of the joints' speeds and
# accelerations, turning and sliding,
#
# F = M (g + R (W^2 + A) + 2 V W + B)
# P = J_m (alpha_m + W omega_m + A)                 of each rotor
# N = F (R + r) + the sum of P
#
# found by a search over random arms of 1 to 7 joints, and stated one unit above the worst case.

FORCE, MOMENT = 4, 3
"""Largest error of a force, in eps of F; of a moment or torque, in eps of N; on the motor side that times mu,
and P of its own rotor."""
_OF_ARM = {
    "inverse_dynamics": f"within {MOMENT} eps of mu N + P (slides: of mu F + P)",
    "joint_wrenches": f"forces within {FORCE} eps of F, moments within {MOMENT} eps of N",
    "bearing_loads": f"F_N, F_T within {FORCE} eps of F; M_B, T within {MOMENT} eps of N (slides: T of F)",
}
_WITH = (
    "with F = M (g + R (W^2 + A) + 2 V W + B), P = J_m (alpha_m + W omega_m + A), N = F (R + r) + all P:",
    "mass M, reach R, farthest bearing r, and W, A, V, B the sums of the joints' speeds and accelerations,",
    "turning and sliding",
)

# F_N of case C1, eq (8), as emitted: the input of Gappa.
_CENTRIFUGAL = v.M.symbol * v.L.symbol * (v.mu.symbol * v.omega_m.symbol) ** 2


def promises(model: Model, names: Collection[str]) -> tuple[str, ...]:
    """One line for each bound that these functions of a model have."""
    of_arm = [f"{name}: {bound}" for name, bound in _OF_ARM.items() if name in names]
    return (*_of_functions(_of_drive(model), names), *of_arm, *(_WITH if of_arm else ()))


def _of_drive(model: Model) -> tuple[str, ...]:
    """Those of one drive; none without F_N, or if an effect changes the angle or adds to F_N."""
    inputs = {q.symbol for q in model.inputs}
    force = normal_force(model)
    if force is None:
        return ()
    F_N = model.expand(force)
    angles = {
        step.args[0]: split(step.args[0], model.parameter_symbols) for step in F_N.atoms(HalfCosine, HalfSine)
    }
    if any(moving not in inputs for moving, _ in angles.values()):
        return ()
    steady = "alpha_m" not in {s.name for s in F_N.free_symbols}
    if not _as_derived(F_N, steady):
        return ()
    shifted = any(shift for _, shift in angles.values())
    tabled = _of_table_1(model)
    lines = _steady(model, bool(angles), tabled) if steady else _accelerated(model, tabled)
    # The paper's own tilt is an ordinary parameter; that of an effect enters the critical velocity.
    rounded = sorted(map(str, F_N.atoms(sp.sin, sp.cos))) if steady else []
    given = [f"{', '.join(rounded)} in double precision as exact, too"] if rounded else []
    given += [f"the link angle shifted by {LARGEST_SHIFT} rad at most"] if shifted else []
    given += (
        ["Table 1: with its parameters, mu 1/5 or 1/30"] if any("Table 1" in line for line in lines) else []
    )
    return (*lines, *(["  " + "; ".join(given)] if given else []))


def _of_functions(lines: Sequence[str], names: Collection[str]) -> tuple[str, ...]:
    found = []
    for line in lines:
        functions, within, bound = line.partition(" within")
        kept = [name for name in functions.split(", ") if name in names]
        if kept:
            found.append(", ".join(kept) + within + bound)
        elif not within and found:  # what holds for all of them
            found.append(line)
    return tuple(found)


def _steady(model: Model, angle: bool, tabled: bool) -> list[str]:
    """The bounds of a model without acceleration; its slopes are relative as well if there is no angle."""
    last = "units in the last place"
    if angle:
        force, friction = NORMAL_FORCE.within(last, tabled), FRICTION_TORQUE.within(last, tabled)
        slope = GRADIENT.within("eps of its largest value at that speed, any angle", tabled)
    else:
        proved = model.expand(model.definition("F_N").symbol) == _CENTRIFUGAL
        force = (PROVED_FORCE if proved else WITHOUT_ANGLE).within(last, table_1=False)
        force += " (proved for parameters and speeds of 1e-6 to 1e6)" if proved else ""
        friction = slope = WITHOUT_ANGLE.within(last, table_1=False)
    return _lines(model, force, friction, slope)


def _accelerated(model: Model, tabled: bool) -> list[str]:
    """With an acceleration F_N vanishes along a curve, and near it the digits of its direction are lost."""
    greatest = "its largest value, any direction of F_N, times that load over F_N"
    return _lines(
        model,
        ACCELERATED_FORCE.within("eps (M L (omega_l^2 + |alpha_l|) + weight)", tabled),
        ACCELERATED_FRICTION.within("eps of what they are at that load", tabled),
        ACCELERATED_GRADIENT.within(f"eps of {greatest}", tabled),
    )


def _lines(model: Model, force: str, friction: str, slope: str) -> list[str]:
    lines = [f"normal_force {force}"]
    if not _of_one_sign(model):
        return lines
    mechanical = "" if model.back_emf_in_friction else "mechanical_friction_torque, "
    torques = f"friction_torque, {mechanical}friction_torque_jacobian"
    return [*lines, f"{torques} {friction}", f"friction_torque_gradient {slope}"]


def _of_table_1(model: Model) -> bool:
    """Whether its parameters are the paper's, of either direction or both, with the values of Table 1."""
    paper = [q for q in vars(v).values() if isinstance(q, Quantity)]
    split = [v.directed(q, direction) for q in paper for direction in ("pos", "neg")]
    return not model.defaults and set(model.parameters) <= {*paper, *split}


def _as_derived(F_N: sp.Expr, steady: bool) -> bool:
    """Whether it is one product of parameters, speed and stable steps, without an effect added to it."""
    magnitude = next((f for f in sp.Mul.make_args(F_N) if isinstance(f, Magnitude)), None)
    if magnitude is None:
        return not F_N.has(sp.Add)
    along = magnitude.args[0]
    return isinstance(along, SquareDifference) if steady else along.has(SquareDifference)


def _of_one_sign(model: Model) -> bool:
    """Whether friction sums powers of load and speed that all oppose the motion, as its slopes then do."""
    F_N, omega_m = normal_force(model), next(q.symbol for q in model.inputs if q.name == "omega_m")
    size = sp.Symbol("size", positive=True)
    tilts = [q.symbol for q in model.parameters if q.domain == "tilt"]  # from 0 to pi/2
    upright = {of(tilt): sp.Dummy(nonnegative=True) for tilt in tilts for of in (sp.sin, sp.cos)}

    def opposes(value: sp.Expr, direction: int) -> bool:
        known = moving(omega_m, direction) | {omega_m: direction * size}
        against = direction * value.replace(Gated, sp.Mul).xreplace(known)
        if against.free_symbols - model.parameter_symbols - {F_N, size} or not against.is_polynomial(
            F_N, size
        ):
            return False
        return all(c.xreplace(upright).is_nonnegative for c in sp.Poly(against, F_N, size).coeffs())

    return all(
        opposes(term.value, direction)
        for balance in model.balances
        for term in balance.terms
        if term.kind in ("friction", "back_emf")
        for direction in (1, -1)
    )


# Minimax polynomials for the half angle: no back end needs a sine from its library.
#
# sin(h)/h = 1 + x S(x) and cos(h) = 1 + x C(x), x = h^2, for |h| up to a quarter turn. S and C come from
# the Remez exchange at 40 digits, with the least maximum error: relative for the sine, which determines the
# last digits of the normal force, absolute for the cosine. The degree is the lowest with an error below a
# fifth of a unit of the working precision. The stated error is that of the coefficients rounded to the
# working precision.
_DIGITS = 40  # ten of which are lost in solving the equations
# The half angle is within a quarter turn, plus its own rounding, which in single precision is at most 2^-10
# of half a turn (tests/test_polynomials.py): the error is that up to the latter edge.
_FITTED, _EDGE = "1.001", "1.002"
_GRID = 160  # points for the search of the extrema of the error
_EXCHANGES = 4
# Between such points a polynomial of degree n is at most 1/cos(n pi/2 _GRID) times its maximum at them
# (Ehlich and Zeller, Mathematische Zeitschrift 86, 1964): 1 % more for degree 14, at which all relevant
# digits are reached.
_BETWEEN = Decimal("1.01")
# Rounding errors of the polynomials relative to exact evaluation with the same coefficients, in single and in
# double precision: proved by Gappa in tests/test_polynomials.py.
_ROUNDING = {"sine_ratio": ("6.2e-8", "1.2e-16"), "cosine": ("2.3e-7", "4.2e-16")}


@dataclass(frozen=True)
class Polynomial:
    """Coefficients of S or C from the highest power down, as decimals, and bounds of their errors."""

    coefficients: tuple[str, ...]  # as they are printed
    error: str  # bound of the method's error, of 1 + x S(x) relative to sin(h)/h, of 1 + x C(x) absolute
    rounding: str  # bound of the rounding error of x S(x) or 1 + x C(x), absolute


@cache
def _samples(name: str, edge: str) -> tuple[list[Decimal], list[tuple[Decimal, Decimal]]]:
    """Points x = h^2 up to the edge, and there sin(h)/h or cos(h) with the weight of its error."""
    with mpmath.workdps(_DIGITS):
        last = (mpmath.pi / 2 * mpmath.mpf(edge)) ** 2
        grid = [last * (1 - mpmath.cos(mpmath.pi * k / _GRID)) / 2 for k in range(1, _GRID + 1)]
        angles = [mpmath.sqrt(x) for x in grid]
        if name == "cosine":
            exact = [(mpmath.cos(h), 1) for h in angles]
        else:
            exact = [(mpmath.sin(h) / h, h / mpmath.sin(h)) for h in angles]
        return [_decimal(x) for x in grid], [(_decimal(value), _decimal(weight)) for value, weight in exact]


def _decimal(x: mpmath.mpf | int) -> Decimal:
    # Python's decimals take a tenth of the time: the exchange consists of sums and products only.
    return Decimal(mpmath.nstr(mpmath.mpf(x), _DIGITS))


@cache
def polynomial(name: str, single: bool) -> Polynomial:
    """The polynomial `sine_ratio` or `cosine` for single or double precision."""
    digits, allowed = (9, Decimal("1.2e-8")) if single else (17, Decimal("2.2e-17"))
    grid, exact = _samples(name, _FITTED)
    with localcontext(prec=_DIGITS), mpmath.workdps(_DIGITS):
        for count in range(3, 16):
            coefficients, error = _remez(grid, exact, count, allowed)
            if error < allowed:
                decimals = tuple(
                    mpmath.nstr(mpmath.mpf(str(c)), digits, min_fixed=0, max_fixed=0) for c in coefficients
                )
                rounded = _rounded(decimals, BITS["single" if single else "double"])
                worst = max(map(abs, _errors(*_samples(name, _EDGE), rounded))) * _BETWEEN
                stated = Context(prec=2, rounding=ROUND_UP).create_decimal(worst)
                return Polynomial(decimals, f"{stated:.1e}", _ROUNDING[name][not single])
    raise AssertionError(f"{name}: no degree below 16 reaches {allowed}")


def _rounded(decimals: Iterable[str], bits: int) -> list[Decimal]:
    with mpmath.workprec(bits):
        return [Decimal(float(mpmath.mpf(c))) for c in decimals]


def _remez(
    grid: list[Decimal], exact: list[tuple[Decimal, Decimal]], count: int, allowed: Decimal
) -> tuple[list[Decimal], Decimal]:
    """The coefficients, highest first, with the least maximum weighted error, and that error.

    If so few coefficients cannot reach the allowed error, a lower bound of their error.
    """
    at = [(2 * k + 1) * _GRID // (2 * count + 2) for k in range(count + 1)]
    coefficients, error = [], Decimal(0)
    for _ in range(_EXCHANGES):
        # The weighted error is the same at all these points, with alternating sign.
        rows = [
            [*(grid[k] ** (j + 1) for j in range(count)), (-1) ** n / exact[k][1], exact[k][0] - 1]
            for n, k in enumerate(at)
        ]
        *solved, level = _solved(rows)
        if abs(level) > allowed:  # de la Vallée Poussin: no polynomial of this degree leaves less
            return [], abs(level)
        coefficients = solved[::-1]
        errors = _errors(grid, exact, coefficients)
        error = max(map(abs, errors))
        before, at = at, _extrema(errors)
        if len(at) != count + 1 or at == before:
            break
    return coefficients, error


def _solved(rows: list[list[Decimal]]) -> list[Decimal]:
    """The solution of linear equations, each given by coefficients and right side: Gauss-Jordan."""
    for k in range(len(rows)):
        pivot = max(range(k, len(rows)), key=lambda n: abs(rows[n][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        rows = [
            row if n == k else [x - row[k] * y for x, y in zip(row, rows[k], strict=True)]
            for n, row in enumerate(rows)
        ]
    return [row[-1] for row in rows]


def _errors(
    grid: list[Decimal], exact: list[tuple[Decimal, Decimal]], coefficients: Iterable[Decimal]
) -> list[Decimal]:
    coefficients, errors = list(coefficients), []
    for x, (value, weight) in zip(grid, exact, strict=True):
        series = Decimal(0)
        for c in coefficients:
            series = series * x + c
        errors.append((1 + x * series - value) * weight)
    return errors


def _extrema(errors: list[Decimal]) -> list[int]:
    """The points of largest error within each stretch of one sign."""
    found: list[int] = []
    for k, error in enumerate(errors):
        if found and error * errors[found[-1]] > 0:
            if abs(error) > abs(errors[found[-1]]):
                found[-1] = k
        else:
            found.append(k)
    return found
