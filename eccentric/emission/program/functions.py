"""The emitted functions of a Model: which there are, what they depend on, what they return."""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy as sp

from eccentric.emission.program import one_sided, stepping
from eccentric.emission.program.program import Assignment
from eccentric.errors import InputError
from eccentric.model import KINDS, Definition, Forward, Model, regressor, symbols
from eccentric.model import vocabulary as v


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
    standstill = tuple((side, sign * one_sided.standstill(model, friction, sign)) for side, sign in sides)
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
            standstill,
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
        own = stepping.definitions(model)
        listed.append(
            Function("next_state", units, stepping.meaning(model), stepping.updates(model), definitions=own)
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
        raise InputError(f"model {model.name}: {missing[0]} is required, received none")


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
        for direction, found in one_sided.polynomials(model, resultant, values).items()
    )
