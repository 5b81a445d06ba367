"""The emitted functions of a Model: which there are, what they depend on, what they return."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import sympy as sp

from eccentric.core import InputError
from eccentric.emission.program.program import BELOW, Assignment, Pick
from eccentric.model import (
    KINDS,
    Backward,
    Bounded,
    Definition,
    Forward,
    Gated,
    Magnitude,
    Model,
    OpaqueStep,
    Sgn,
    SquareDifference,
    quantity,
    regressor,
    symbols,
)
from eccentric.model import vocabulary as v

# Friction on one side of zero velocity: its limit at standstill, and its polynomial in the velocity.


_DIRECTED = Sgn | Forward | Backward | Gated


def standstill(model: Model, friction: sp.Expr, direction: int) -> sp.Expr:
    """The limit of the friction torque as the velocity tends to 0 from above (1) or below (-1)."""
    omega_m = v.omega_m.symbol
    moved = _following(model, {v.omega_m.symbol})
    defined = {d.symbol: d.value for d in model.definitions if d.symbol in moved}
    for symbol in reversed(list(defined)):
        friction = friction.xreplace({symbol: defined[symbol]})
    friction = friction.xreplace(moving(omega_m, direction)).xreplace({omega_m: sp.Integer(0)})
    # At zero speed the steps reduce to plain numbers or to their other argument.
    friction = friction.replace(
        lambda e: isinstance(e, Gated) and e.args[1].is_number, lambda e: sp.Mul(*e.args)
    )
    friction = friction.replace(lambda e: isinstance(e, Bounded) and e.args[0] == 0, lambda e: sp.Integer(0))
    friction = friction.replace(
        lambda e: isinstance(e, SquareDifference) and e.args[0] == 0, lambda e: -(e.args[1] ** 2)
    )
    friction = friction.replace(
        lambda e: isinstance(e, Magnitude) and sp.S.Zero in e.args, lambda e: sp.Abs(sp.Add(*e.args))
    )
    # By their definitions, which are those of the stable form of F_N.
    scale_N, omega_star, weight = symbols(v.scale_N, v.omega_star, v.weight)
    friction = friction.subs(scale_N * omega_star**2, weight)
    # What depends on parameters only is prepared, in double precision: there the plain root serves.
    varying = _following(model, {q.symbol for q in model.inputs})
    return friction.replace(
        lambda e: isinstance(e, Magnitude) and not e.free_symbols & varying,
        lambda e: sp.sqrt(e.args[0] ** 2 + e.args[1] ** 2),
    )


def polynomials(
    model: Model, resultant: sp.Expr, values: Iterable[sp.Expr]
) -> dict[int, tuple[sp.Expr, ...]]:
    """F_3, F_2, F_1, F_0 by direction, 1 or -1, if friction is a polynomial in the velocity, else none.

    `values` are the resultant and the definitions that it needs. If friction is symmetric, -1 gives nothing
    new and is omitted.
    """
    omega_m = v.omega_m.symbol
    if _is_curved(model, values):
        return {}
    plain = model.expand(resultant).replace(Gated, sp.Mul)
    sides = {direction: sp.expand(plain.xreplace(moving(omega_m, direction))) for direction in (1, -1)}
    if not all(side.is_polynomial(omega_m) for side in sides.values()):
        return {}
    # Poly would take a common exp(-t/tau) out of a sum and leave exp(t/tau) in it, which overflows.
    return {
        direction: tuple(side.coeff(omega_m, k) for k in (3, 2, 1, 0))
        for direction, side in sides.items()
        if direction > 0 or resultant.has(Backward)
    }


def _following(model: Model, given: set[sp.Symbol]) -> set[sp.Symbol]:
    """Symbols, and what is defined by them, also by way of other definitions."""
    found = set(given)
    for definition in model.definitions:
        if definition.value.free_symbols & found:
            found.add(definition.symbol)
    return found


def _is_curved(model: Model, values: Iterable[sp.Expr]) -> bool:
    """Whether they contain a stable step of the velocity, other than those of its direction."""
    moved = _following(model, {v.omega_m.symbol})
    steps = {step for value in values for step in value.atoms(OpaqueStep)}
    return any(step.free_symbols & moved for step in steps if not isinstance(step, _DIRECTED))


def moving(omega_m: sp.Symbol, direction: int) -> dict[sp.Expr, sp.Expr]:
    """The values of the steps by direction for velocities above (1) or below (-1) zero."""
    return {
        Sgn(omega_m): sp.Integer(direction),
        Forward(omega_m): sp.Integer(direction > 0),
        Backward(omega_m): sp.Integer(direction < 0),
    }


# The hidden states one time step later, for any time step: without elapsed time, nothing changes.
#
# A model defines the update of a state over a positive time step. Firmware also passes 0 (the first sample, a
# repeated time stamp) and negative ones (a counter overflow). Then the states stay unchanged, and nothing in
# the computation divides by less than the shortest time step.


# In seconds: shorter than any loop, and second differences of a current over it do not overflow in float.
SHORTEST = "1e-9"
_DT, _LEAST = v.dt.symbol, sp.Rational(SHORTEST)
_ELAPSED = Definition(quantity("elapsed", "s", "time step, at least the shortest"), sp.Max(_DT, _LEAST))


def step_meaning(model: Model) -> str:
    """The result of `next_state`, in words."""
    kept = f", unchanged if dt is less than {SHORTEST} s" if _is_timed(model) else ""
    return f"the hidden states one time step later{kept}"


def step_updates(model: Model) -> tuple[tuple[str, sp.Expr], ...]:
    """Name and value one time step later of each hidden state; without dt, every call is one time step."""
    if not _is_timed(model):
        return tuple((state.quantity.name, state.update) for state in model.states)
    return tuple(
        (
            state.quantity.name,
            Pick(_DT, BELOW, _LEAST, state.symbol, state.update.xreplace({_DT: _ELAPSED.symbol})),
        )
        for state in model.states
    )


def step_definitions(model: Model) -> tuple[Definition, ...]:
    """Definitions that the updates need in addition to the model's."""
    return (_ELAPSED,) if _is_timed(model) else ()


def _is_timed(model: Model) -> bool:
    return any(state.update.has(_DT) for state in model.states)


@dataclass(frozen=True)
class Function:
    """A function of the model before its parameter-only parts are split off.

    Attributes:
        name, unit, meaning: as in Routine.
        results: label -> expression; the label is "" for a scalar function.
        by: symbols by which the one entry of `results` is differentiated; the function returns those slopes,
            after the entry itself if that has a label.
        definitions: its own, in addition to those of the model.
    """

    name: str
    unit: str
    meaning: str
    results: tuple[tuple[str, sp.Expr], ...]
    by: tuple[sp.Symbol, ...] = ()
    requires: tuple[str, ...] = ()
    definitions: tuple[Definition, ...] = ()


_OF_CURRENT = frozenset({"current", "mechanical_residual", "electrical_residual"})
"""Functions that need k_i itself, R/k_i being known."""
_OF_VOLTAGE = frozenset({"voltage", "electrical_residual"})
"""Functions that need R and k_e, k_i being known."""
_WITHOUT_BACK_EMF = _OF_CURRENT | {"mechanical_friction_torque"}
"""Functions that need the friction without the back-EMF, or its constant."""


def closure(
    model: Model, results: tuple[tuple[str, sp.Expr], ...], own: tuple[Definition, ...] = ()
) -> tuple[Assignment, ...]:
    """The definitions, of the model and of the function itself, that the results need, in order."""
    needed = set().union(*(expression.free_symbols for _, expression in results))
    chosen: list[Assignment] = []
    for definition in reversed((*model.definitions, *own)):
        if definition.symbol in needed:
            needed |= definition.value.free_symbols
            chosen.append(Assignment(definition.symbol, definition.value, _note(model, definition)))
    return tuple(reversed(chosen))


def _note(model: Model, definition: Definition) -> str:
    """Meaning, unit and equation number of a definition, from the derivation, else from the paper."""
    quantity = definition.quantity
    stated = [e.number for e in model.equations if e.left in (quantity.symbol, quantity.symbol**2)]
    number = next(filter(None, reversed(stated)), "") if stated else quantity.equation
    return f"{quantity.meaning} [{quantity.unit}]" + (f", eq {number}" if number else "")


def solve_current(model: Model) -> sp.Expr:
    """The armature current that the mechanical balance requires, eq (4) without the armature.

    If an effect depends on the current itself (torque ripple, saturation), the current without that effect is
    substituted: exact to first order in the effect.
    """
    mechanical = model.balance("mechanical")
    drive = next(term for term in mechanical.terms if term.kind == "drive")
    driven = [kind for kind in KINDS if kind not in {"drive", "actuator"}]
    plain = sp.expand_mul(mechanical.sum_of(*driven) / drive.coefficient)
    actuator = sp.expand_mul(mechanical.sum_of("actuator") / drive.coefficient)
    return plain + actuator.subs(drive.basis, plain)


def functions(model: Model) -> tuple[Function, ...]:
    """Every function that is emitted for the model, in the order of the module.

    Raises:
        InputError: the model lacks something that they require.
    """
    _require(model)
    mechanical, electrical = model.balance("mechanical"), model.balance("electrical")
    friction = mechanical.sum_of("friction")
    gravity = mechanical.sum_of("gravity", "conservative")
    resistance = next(t.coefficient for t in electrical.terms if t.kind == "resistive")
    torque_constant = next(t.coefficient for t in mechanical.terms if t.kind == "drive")
    current = solve_current(model)
    armature = electrical.sum_of("back_emf", "actuator").subs(v.i.symbol, current)
    voltage = resistance * current + armature
    # (4) with alpha_m = 0 and without gravity: the rest of (k_i/R) u.
    resultant = friction + torque_constant / resistance * electrical.sum_of("back_emf")
    # For comparison with measured data, both in N m; the electrical one as (k_i/R)(u - k_e omega_m) - k_i i.
    residual = mechanical.residual()
    electrical_residual = sp.expand_mul(torque_constant / resistance * electrical.residual())
    columns = regressor(model)
    coefficients = tuple((column.name, column.coefficient) for column in columns)
    parameters = symbols(*model.friction_parameters)
    inertial = model.inertia.free_symbols
    inertia = tuple(q.name for q in model.parameters if q.default is None and q.symbol in inertial)
    dependence = tuple(x for x in _inputs(model, resultant) if x.name in {"theta_m", "omega_m", "alpha_m"})
    sides = (("pos", 1), ("neg", -1)) if friction.has(Forward) else (("", 1),)
    at_rest = tuple((side, sign * standstill(model, friction, sign)) for side, sign in sides)
    units = {q.symbol: q.unit for q in model.inputs}
    spanned = "friction_torque" if model.back_emf_in_friction else "mechanical_friction_torque"
    force = normal_force(model)
    damping = (
        "back-EMF damping included" if model.voltage_known else "here without back-EMF: R or k_e is not known"
    )
    listed = [
        Function("normal_force", "N", "normal force F_N on the axis of rotation", (("", force),)),
        Function(
            "friction_torque",
            "N m",
            f"resultant friction torque F, {damping}, eq (6)",
            (("", resultant),),
        ),
        Function(
            "mechanical_friction_torque",
            "N m",
            "mechanical friction torque f = f_m + mu f_l, without back-EMF",
            (("", friction),),
        ),
        Function(
            "friction_torque_gradient",
            f"N m per {', '.join(units[x] for x in dependence)}",
            "partial derivatives of friction_torque with respect to its inputs",
            (("", resultant),),
            dependence,
        ),
        Function(
            "friction_torque_with_gradient",
            f"N m, N m per {', '.join(units[x] for x in dependence)}",
            "friction_torque and its partial derivatives, as a linearisation needs them",
            (("friction_torque", resultant),),
            dependence,
        ),
        Function(
            "friction_torque_jacobian",
            "N m per unit coefficient",
            "partial derivatives of friction_torque with respect to all friction coefficients",
            (("", resultant),),
            parameters,
        ),
        Function(
            "regressor",
            "N m per unit coefficient",
            f"columns: regressor times friction_coefficients is {spanned}",
            tuple((column.name, column.basis) for column in columns),
        ),
        Function(
            "friction_coefficients",
            ", ".join(column.unit for column in columns),
            "coefficients of the columns of the regressor",
            coefficients,
        ),
        Function(
            "coulomb_torque",
            "N m",
            "magnitude of the friction torque at standstill, where it is set-valued",
            at_rest,
        ),
        Function("gravity_torque", "N m", "gravity torque G, eq (5)", (("", gravity),)),
        Function(
            "voltage",
            "V",
            "armature voltage u = (R/k_i) (J alpha_m + G + F), eq (4)",
            (("", voltage),),
            requires=inertia,
        ),
        Function(
            "current", "A", "armature current i = (J alpha_m + G + f)/k_i", (("", current),), requires=inertia
        ),
    ]
    listed += [
        Function(
            "mechanical_residual",
            "N m",
            "residual of the mechanical balance: k_i i - J alpha_m - G - f",
            (("", residual),),
            requires=inertia,
        ),
        Function(
            "electrical_residual",
            "N m",
            "residual of the electrical balance, as a torque: (k_i/R)(u - k_e omega_m) - k_i i",
            (("", electrical_residual),),
        ),
    ]
    if model.states:
        units = ", ".join(state.quantity.unit for state in model.states)
        own = step_definitions(model)
        listed.append(
            Function("next_state", units, step_meaning(model), step_updates(model), definitions=own)
        )
    given = (*listed, *_polynomials(model, resultant))
    withheld = frozenset[str]() if model.current_known else _OF_CURRENT
    if not model.voltage_known:
        withheld |= _OF_VOLTAGE
    if model.back_emf_in_friction:
        withheld = _WITHOUT_BACK_EMF
    if force is None:
        withheld |= {"normal_force"}
    said = model.axis.said
    return tuple(
        replace(f, name=said(f.name), unit=said(f.unit), meaning=said(f.meaning))
        for f in given
        if f.name not in withheld
    )


def _require(model: Model) -> None:
    kinds = {balance.name: {term.kind for term in balance.terms} for balance in model.balances}
    there = {
        "an input omega_m": any(q.name == "omega_m" for q in model.inputs),
        "a balance `mechanical` with a term of kind `drive`": "drive" in kinds.get("mechanical", ()),
        "a balance `electrical` with a term of kind `resistive`": "resistive" in kinds.get("electrical", ()),
    }
    if missing := [what for what, found in there.items() if not found]:
        raise InputError(f"model {model.name}", missing[0], "none")


def normal_force(model: Model) -> sp.Symbol | None:
    """The symbol of F_N, or of its replacement by an effect; None for a model without one."""
    F_N = next((d.symbol for d in model.definitions if d.quantity.name == "F_N"), None)
    return None if F_N is None else model.replaced.get(F_N, F_N)


def _inputs(model: Model, expression: sp.Expr) -> tuple[sp.Symbol, ...]:
    symbols = expression.free_symbols.union(
        *(a.value.free_symbols for a in closure(model, (("", expression),)))
    )
    return tuple(q.symbol for q in model.inputs if q.symbol in symbols)


def _polynomials(model: Model, resultant: sp.Expr) -> tuple[Function, ...]:
    """F_3 ... F_0 for each direction if friction is a polynomial in the motor velocity (C1), else none."""
    values = [resultant, *(a.value for a in closure(model, (("", resultant),)))]
    names = {1: ("polynomial", "omega_m > 0"), -1: ("polynomial_neg", "omega_m < 0")}
    return tuple(
        Function(
            names[direction][0],
            "N m s^3/rad^3, N m s^2/rad^2, N m s/rad, N m",
            f"coefficients F_3, F_2, F_1, F_0 of F for {names[direction][1]}, eqs (11)-(14)",
            tuple((f"F_{k}", coefficient) for k, coefficient in zip((3, 2, 1, 0), found, strict=True)),
        )
        for direction, found in polynomials(model, resultant, values).items()
    )
