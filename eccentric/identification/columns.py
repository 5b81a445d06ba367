"""The columns of a fit: which coefficients a rig leaves open, what they mean, their units and bounds."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.core import InputError, MissingValueError
from eccentric.effects import constant_load
from eccentric.identification.drive import LOAD, Drive, in_drive_unit
from eccentric.identification.regression import Coefficient
from eccentric.identification.uncertainty import Estimate, Spread
from eccentric.model import Column, Model, Role, meaning, regressor
from eccentric.model import vocabulary as v
from eccentric.rigs import KNOWNS, Rig

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from eccentric.identification.drive import Machine


Array = NDArray[np.float64]
R, k_i, k_e, J, u_0 = sp.symbols("R k_i k_e J u_0")
omega_m, _speed = v.omega_m.symbol, sp.Symbol("speed", positive=True)
_OF_RIGS = {known.name for known in KNOWNS}


@dataclass(frozen=True, kw_only=True)
class Combination(Coefficient):
    """A coefficient of a fit in the paper's letters: what the rig leaves open of the scaled balance."""

    expression: sp.Expr  # its name
    meaning: sp.Expr  # its value in parameters
    letter: str  # the coefficient without the scale
    mechanical_unit: str  # its unit
    parameter: str = ""  # of the model, which represents it when the fit is emitted, "" for none


def as_text(expression: sp.Expr) -> str:
    """Return an expression as a person would write it."""
    return str(expression).replace("**", "^")


def scale_of(drive: str, rig: Rig, machine: Machine) -> sp.Expr | None:
    """Return the factor of the mechanical balance, None for one.

    Raises InputError for a current whose k_i has neither a known value nor a range, and for a motor with
    parameters of the model's own that do not give its torque: a rig file has no name for them.
    """
    motor = {
        "torque": frozenset[str](),
        "current": machine.torque_letters,
        "voltage": machine.torque_letters | machine.resistance_letters,
    }[drive]
    emf = machine.back_emf_letters if drive == "voltage" else frozenset[str]()
    own, known, axis = (motor | emf) - _OF_RIGS, set(rig.known), rig.axis
    missing = motor - known
    if lacking := sorted((own - known) | (missing if own & motor else set())):
        raise InputError(
            rig.path,
            f"a value of {' and '.join(map(axis.named, lacking))}",
            "none",
            why=(
                f"to convert the {axis.named(drive)} to {axis.term('torque')}, since"
                f" {' and '.join(map(axis.named, sorted(own)))}"
                f" {'is' if len(own) == 1 else 'are'} the model's own"
            ),
        )
    if drive == "voltage":
        return R / k_i if missing else None
    if missing:
        if "k_i" in rig.unknown:
            return 1 / k_i
        raise MissingValueError(
            rig.path,
            f"[known] {axis.named('k_i')}",
            "neither",
            why=f"to convert the current to {axis.term('torque')} (or its range in [unknown],"
            f" to estimate it jointly)",
            letter="k_i",
        )
    return None


def combinations_of(drive: Drive, rig: Rig, model: Model, scale: sp.Expr | None) -> list[Combination]:
    """Return the coefficients in the order of their columns: friction, inertia, scale, load, offset."""
    machine, unit, by = drive.machine, drive.unit, drive.channels.motor.measured_by
    s = sp.Integer(1) if scale is None else scale
    # The back-EMF has the same column as viscous friction, w: without k_e only the sum is identifiable.
    shared: Mapping[str, sp.Expr] = {}
    if by == "voltage" and not machine.back_emf_letters <= set(rig.known):
        shared = back_emf_columns(model)
        if not shared:
            raise MissingValueError(
                rig.path,
                "[known] k_e",
                "none",
                why=(
                    f"for {model.name}, which has no viscous friction in proportion to the"
                    f" {rig.axis.term('motor velocity')} that would include the back-EMF"
                ),
                letter="k_e",
            )
    damping = s * _plain(machine.back_emf_damping)
    found = [
        _friction(column, model, s, damping * shared.get(column.name, sp.Integer(0)), unit, rig)
        for column in regressor(model)
    ]

    def add(value: sp.Expr, **fields: Any) -> None:
        found.append(Combination(name=as_text(value), expression=value, meaning=value, **fields))

    inertia = machine.inertia(rig.known) if machine.inertia_letters <= set(rig.known) else None
    s_low, s_high = _scale_range(rig, scale)
    if inertia is None:
        low, high = _inertia_range(rig, machine)
        bounds = {"lower": s_low * low, "upper": s_high * high}
        letters = {"letter": "J", "mechanical_unit": "kg m^2", "parameter": machine.rotor}
        add(s * J, role="inertia", unit=_scaled("kg m^2", unit), **bounds, **letters)
    torque = model.balance("mechanical").sum_of("gravity", "conservative")
    beside = torque.subs({x: 0 for x in torque.free_symbols if x.name == LOAD})
    # A scale shows by what the rig knows in newton metres, which a load to be estimated is not.
    if scale is not None and (beside != 0 or inertia is not None or rig.known.get(LOAD) or rig.added):
        bounds = {"lower": s_low, "upper": s_high}
        add(scale, role="scale", unit=f"{unit}/(N m)", **bounds, letter=str(scale), mechanical_unit="1")
    if LOAD in rig.unknown:
        add(s * sp.Symbol(LOAD), role="load", unit=unit, letter=LOAD, mechanical_unit="N m", parameter=LOAD)
    if "voltage_offset_V" in rig.estimate and by == "voltage":
        name = "voltage_offset_V"
        offset = Combination(
            name, "offset", "V", expression=u_0, meaning=u_0, letter=name, mechanical_unit="V"
        )
        found.append(offset)
    return found


def back_emf_columns(model: Model) -> dict[str, sp.Expr]:
    """Return the columns that a voltage without k_e shows together with the back-EMF, with its share in each.

    Those are the column of omega_m, or one for each direction; empty if the model has neither. The share is
    omega_m over the basis: the part of each newton metre second of damping in the coefficient.
    """
    both, forward, backward = {}, {}, {}
    for column in regressor(model):
        if not (column.linear and column.role is Role.VISCOUS):
            continue
        basis = meaning(model.expand(column.basis))
        ahead, back = (sp.simplify(basis.subs(omega_m, sign * _speed) / (sign * _speed)) for sign in (1, -1))
        if not (ahead.free_symbols | back.free_symbols) <= model.parameter_symbols:
            continue
        if ahead == back:
            both[column.name] = 1 / _plain(ahead)
        elif back == 0:
            forward[column.name] = 1 / _plain(ahead)
        elif ahead == 0:
            backward[column.name] = 1 / _plain(back)
    if both or not (forward and backward):
        return both
    return forward | backward


def _friction(column: Column, model: Model, s: sp.Expr, damping: sp.Expr, unit: str, rig: Rig) -> Combination:
    """A column of the regressor, times the scale, with the damping by the back-EMF that it includes."""
    shown = _plain(s * column.coefficient + damping)
    own = Coefficient.within(as_text(shown), "friction", _scaled(column.unit, unit), column.bounds)
    least = sp.Integer(0)
    if "k_e" in rig.unknown:
        given = {sp.Symbol(letter): sp.Float(value) for letter, value in rig.known.items()}
        least = damping.xreplace(given | {k_e: sp.Float(rig.unknown["k_e"][0])})
    return Combination(
        own.name,
        own.role,
        own.unit,
        own.lower + (0.0 if least.free_symbols else float(least)),
        own.upper,
        expression=shown,
        meaning=_plain(s * model.expand(column.coefficient) + damping),
        letter=column.name,
        mechanical_unit=column.unit,
        parameter=column.parameter.name,
    )


def _plain(expression: sp.Expr) -> sp.Expr:
    """Symbols by name only: the model's have assumptions, so that symbols that print the same may differ."""
    named = {symbol: sp.Symbol(symbol.name) for symbol in expression.free_symbols}
    return sp.expand(expression.xreplace(named))


def _scaled(unit: str, drive: str) -> str:
    """The unit of a mechanical coefficient times the scale, for a drive in volts or amperes."""
    scaled = in_drive_unit(unit, drive)
    return f"{unit} {drive}/(N m)" if drive != "N m" and scaled == unit else scaled


def bounded_letters(coefficients: Sequence[Combination], machine: Machine) -> set[str]:
    """The letters of the rig whose ranges bound these coefficients."""
    letters = {symbol.name for c in coefficients for symbol in c.expression.free_symbols}
    inertia = {*machine.inertias} if any(c.role == "inertia" for c in coefficients) else set()
    return letters | inertia


def _range(rig: Rig, letter: str) -> tuple[float, float]:
    if letter in rig.known:
        return rig.known[letter], rig.known[letter]
    return rig.unknown.get(letter, (0.0, math.inf))


def _scale_range(rig: Rig, scale: sp.Expr | None) -> tuple[float, float]:
    if scale is None:
        return 1.0, 1.0
    low, high = _range(rig, "k_i")
    r_low, r_high = _range(rig, "R") if scale.has(R) else (1.0, 1.0)
    return (r_low / high if math.isfinite(high) else 0.0), (r_high / low if low else math.inf)


def _inertia_range(rig: Rig, machine: Machine) -> tuple[float, float]:
    """The inertia with all its parts at the lower, and at the upper ends of their ranges."""
    ranges = {letter: _range(rig, letter) for letter in machine.inertia_letters}
    low, high = ({letter: ends[side] for letter, ends in ranges.items()} for side in (0, 1))
    return machine.inertia(low), machine.inertia(high)


def own_letters(model: Model) -> dict[str, float]:
    """Parameters of a derivation or an effect that no rig knows, with their defaults, which hold."""
    # Every rig with a case has a tilt; a model without one may have another quantity of that name.
    of_rigs = {known.name for known in KNOWNS} - (set() if model.tilted else {v.phi.name})
    return {
        q.name: float(sp.Float(q.default))
        for q in model.parameters
        if q.name not in of_rigs and q.default is not None and q.default.is_number
    }


def with_own(rig: Rig, model: Model) -> Rig:
    """The rig with the model's own parameters besides friction, such as a flywheel's inertia, as known."""
    fitted = {q.name for q in model.friction_parameters}
    own = {name: value for name, value in own_letters(model).items() if name not in fitted}
    return dataclasses.replace(rig, known={**rig.known, **own})


def following_letters(model: Model) -> dict[str, sp.Expr]:
    """Parameters that follow from others by default, such as F_T = M_l g, with these defaults."""
    given = {q.name: q.default for q in model.parameters}
    return {name: x for name, x in given.items() if x is not None and x.free_symbols}


def require_case(rig: Rig, model: Model) -> None:
    """Raise InputError for a model of another axis or case than the rig's; one with a tilt fits each case.

    And for one without an unbalanced mass, where runs carry more of it.
    """
    if rig.added and not {v.M.name, v.L.name} <= {q.symbol.name for q in model.parameters}:
        raise InputError(f"{rig.path}: [added]", "a model with an unbalanced mass", model.name)
    if model.axis is not rig.axis:
        raise InputError(
            rig.path,
            problem=f"model {model.name} requires kind = {model.axis.name!r}, got {rig.axis.name!r};"
            f" {rig.model} fits it",
        )
    if model.tilted:
        return
    case = "C1" if model.balance("mechanical").sum_of("gravity") == 0 else "C2"
    if rig.case != case:
        received = f"case {rig.case}" if rig.case else "a tilted plane (no case)"
        raise InputError(
            rig.path, problem=f"model {model.name} requires case {case}, got {received}; {rig.model} fits it"
        )


def load_letters(model: Model) -> set[str]:
    """Parameters that the regressor and gravity depend on, but for a constant load: it is a column."""
    expressions = [column.basis for column in regressor(model)]
    expressions.append(model.balance("mechanical").sum_of("gravity", "conservative"))
    found = {symbol.name for e in expressions for symbol in model.expand(e).free_symbols}
    loads = {quantity.name for quantity in constant_load.coefficients}
    return found & {quantity.name for quantity in model.parameters} - loads


# Which letters of the paper a log identifies, and which it shows only in combination.
#
# Every column of the problem has a coefficient that is an expression in the letters.  A letter is
# identifiable if its direction is in the row space of the Jacobian of those expressions: then no change of
# the other letters compensates for a change of it.
def identified_letters(
    coefficients: Sequence[Combination], fixed: Collection[str]
) -> tuple[list[str], list[str]]:
    """Return the letters, but for the fixed ones, that are identified, and those that are not."""
    expressions = [c.meaning for c in coefficients if c.role != "offset"]
    plain = [e.xreplace({x: sp.Symbol(x.name, positive=True) for x in e.free_symbols}) for e in expressions]
    letters = sorted({x for e in plain for x in e.free_symbols if x.name not in fixed}, key=str)
    # Distinct primes are a generic point: no accidental cancellation in these few products.
    everything = sorted({x for e in plain for x in e.free_symbols}, key=str)
    point = {x: sp.prime(k + 5) for k, x in enumerate(everything)}
    jacobian = sp.Matrix([[e.diff(x).subs(point) for x in letters] for e in plain])
    rank = jacobian.rank()
    told: list[str] = []
    for k, letter in enumerate(letters):
        own = sp.zeros(1, len(letters))
        own[k] = 1
        if jacobian.col_join(own).rank() == rank:
            told.append(letter.name)
    return told, [x.name for x in letters if x.name not in told]


def combinations(
    coefficients: Sequence[Combination], values: Array, active: NDArray[np.int64], error: Spread
) -> dict[str, Estimate]:
    """Return combinations by name: coefficients of columns that are not a single letter.

    In newton metres if the scale is identified.
    `values` (k,) and `active` (k,) belong to the coefficients, the spread to them and all that follow.
    """
    found: dict[str, Estimate] = {}
    where = next((k for k, c in enumerate(coefficients) if c.role == "scale"), None)
    for k, c in enumerate(coefficients):
        if c.role == "offset":
            continue
        slope = np.zeros(len(error.alone))
        slope[k] = 1.0
        if where is not None and k != where:
            s = values[where]
            slope[k], slope[where] = 1.0 / s, -values[k] / s**2
            name = as_text(sp.expand(c.expression / coefficients[where].expression))
            bounds = (0.0 if c.lower == 0.0 else -np.inf, np.inf)
            found[name] = error.estimate(values[k] / s, slope, c.mechanical_unit, bounds, int(active[k]))
        elif not c.meaning.is_Symbol:
            found[c.name] = error.estimate(values[k], slope, c.unit, (c.lower, c.upper), int(active[k]))
    return found
