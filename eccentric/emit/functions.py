"""From a Model to its emitted functions: which there are, what they depend on, what they return."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from eccentric.emit import stepping
from eccentric.emit.program import Assignment
from eccentric.errors import InputError
from eccentric.model import KINDS, Definition, Model, regressor
from eccentric.model import vocabulary as v
from eccentric.model.steps import Backward, Bounded, Forward, Gated, Magnitude, Sgn, SquareDifference, Step

_DIRECTED = Sgn | Forward | Backward | Gated


@dataclass(frozen=True)
class Function:
    """A function of the model before its parameter-only parts are split off.

    Attributes:
        name, unit, meaning: as in Routine.
        results: label -> expression; the label is "" for a scalar function.
        by: symbols by which the one entry of `results` is differentiated; the function returns those slopes,
            after the entry itself where that has a label.
        definitions: of its own, beyond those of the model.
    """

    name: str
    unit: str
    meaning: str
    results: tuple[tuple[str, sp.Expr], ...]
    by: tuple[sp.Symbol, ...] = ()
    requires: tuple[str, ...] = ()
    definitions: tuple[Definition, ...] = ()


def closure(
    model: Model, results: tuple[tuple[str, sp.Expr], ...], own: tuple[Definition, ...] = ()
) -> tuple[Assignment, ...]:
    """The definitions, the model's and those of a function's own, that the results need, in order."""
    needed = set().union(*(expression.free_symbols for _, expression in results))
    chosen: list[Assignment] = []
    for definition in reversed((*model.definitions, *own)):
        if definition.symbol in needed:
            needed |= definition.value.free_symbols
            chosen.append(Assignment(definition.symbol, definition.value, _note(model, definition)))
    return tuple(reversed(chosen))


def _note(model: Model, definition: Definition) -> str:
    """Meaning and unit of a definition, and the number that the derivation gives it, else the paper."""
    quantity = definition.quantity
    stated = [e.number for e in model.equations if e.left in (quantity.symbol, quantity.symbol**2)]
    number = next(filter(None, reversed(stated)), "") if stated else quantity.equation
    return f"{quantity.meaning} [{quantity.unit}]" + (f", eq {number}" if number else "")


def solve_current(model: Model) -> sp.Expr:
    """The armature current that the mechanical balance asks for, eq (4) without the armature.

    Where an effect depends on the current itself (torque ripple, saturation), the current without that effect
    is put into it: exact to first order in the effect.
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
        InputError: the model lacks something that they are made of.
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
    # (4) with alpha_m = 0 and without gravity: what is left of (k_i/R) u.
    resultant = friction + torque_constant / resistance * electrical.sum_of("back_emf")
    # Held against measured data, both in N m; the electrical one as (k_i/R)(u - k_e omega_m) - k_i i.
    residual = mechanical.residual()
    electrical_residual = sp.expand_mul(torque_constant / resistance * electrical.residual())
    columns = regressor(model)
    coefficients = tuple((column.name, column.coefficient) for column in columns)
    parameters = friction_parameters(model)
    inertia = tuple(q.name for q in model.parameters if q.default is None)
    dependence = tuple(x for x in _inputs(model, resultant) if x.name in {"theta_m", "omega_m", "alpha_m"})
    asymmetric = friction.has(Forward)
    standstill = (
        (("pos", _standstill(model, friction, 1)), ("neg", -_standstill(model, friction, -1)))
        if asymmetric
        else (("", _standstill(model, friction, 1)),)
    )
    normal_force = model.definition("F_N").symbol
    units = {q.symbol: q.unit for q in model.inputs}
    listed = [
        Function("normal_force", "N", "normal force F_N on the axis of rotation", (("", normal_force),)),
        Function(
            "friction_torque",
            "N m",
            "resultant friction torque F, back-EMF damping included, eq (6)",
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
            "columns: regressor times friction_coefficients is mechanical_friction_torque",
            tuple((column.name, column.basis) for column in columns),
        ),
        Function(
            "friction_coefficients",
            ", ".join(column.unit for column in columns),
            "what the columns of the regressor multiply",
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
            "what the mechanical balance leaves: k_i i - J alpha_m - G - f",
            (("", residual),),
            requires=inertia,
        ),
        Function(
            "electrical_residual",
            "N m",
            "what the electrical balance leaves, as a torque: (k_i/R)(u - k_e omega_m) - k_i i",
            (("", electrical_residual),),
        ),
    ]
    if model.states:
        units = ", ".join(state.quantity.unit for state in model.states)
        own = stepping.definitions(model)
        listed.append(
            Function("next_state", units, stepping.meaning(model), stepping.updates(model), definitions=own)
        )
    return (*listed, *_polynomials(model, resultant))


def _require(model: Model) -> None:
    kinds = {balance.name: {term.kind for term in balance.terms} for balance in model.balances}
    there = {
        "an input omega_m": any(q.name == "omega_m" for q in model.inputs),
        "a definition of F_N": any(d.quantity.name == "F_N" for d in model.definitions),
        "a balance `mechanical` with a term of kind `drive`": "drive" in kinds.get("mechanical", ()),
        "a balance `electrical` with a term of kind `resistive`": "resistive" in kinds.get("electrical", ()),
    }
    if missing := [what for what, found in there.items() if not found]:
        raise InputError(f"model {model.name}: required {missing[0]}, received none")


def friction_parameters(model: Model) -> tuple[sp.Symbol, ...]:
    """The friction coefficients among the parameters, in their order there."""
    used = {term.coefficient for term in model.balance("mechanical").terms if term.kind == "friction"}
    return tuple(q.symbol for q in model.parameters if q.symbol in used)


def _inputs(model: Model, expression: sp.Expr) -> tuple[sp.Symbol, ...]:
    symbols = expression.free_symbols.union(
        *(a.value.free_symbols for a in closure(model, (("", expression),)))
    )
    return tuple(q.symbol for q in model.inputs if q.symbol in symbols)


def _standstill(model: Model, friction: sp.Expr, direction: int) -> sp.Expr:
    """The limit of the friction torque for velocity to 0 from above (1) or below (-1)."""
    omega_m = next(q.symbol for q in model.inputs if q.name == "omega_m")
    moving = {
        d.symbol: d.value
        for d in model.definitions
        if d.value.has(omega_m) or d.quantity.name in ("F_N", "speed")
    }
    for symbol in reversed(list(moving)):
        friction = friction.xreplace({symbol: moving[symbol]})
    friction = friction.xreplace(_moving(omega_m, direction)).xreplace({omega_m: sp.Integer(0)})
    # With zero speed the steps fold to plain numbers or to their other argument.
    friction = friction.replace(
        lambda e: isinstance(e, Gated) and e.args[1].is_number, lambda e: sp.Mul(*e.args)
    )
    friction = friction.replace(lambda e: isinstance(e, Bounded) and e.args[0] == 0, lambda e: sp.Integer(0))
    friction = friction.replace(
        lambda e: isinstance(e, SquareDifference) and e.args[0] == 0, lambda e: -(e.args[1] ** 2)
    )
    friction = friction.replace(
        lambda e: isinstance(e, Magnitude) and e.args[1] == 0, lambda e: sp.Abs(e.args[0])
    )
    if any(d.quantity.name == "omega_star" for d in model.definitions):
        omega_star, scale = model.definition("omega_star").symbol, model.definition("scale_N").symbol
        friction = friction.subs(scale * omega_star**2, model.definition("weight").symbol)
    return friction


def _is_curved(model: Model, expression: sp.Expr, omega_m: sp.Symbol) -> bool:
    """Whether a careful step of the velocity is in it, besides those that tell its direction."""
    moving = {omega_m}
    for definition in model.definitions:
        if definition.value.free_symbols & moving:
            moving.add(definition.symbol)
    values = [expression, *(a.value for a in closure(model, (("", expression),)))]
    steps = {step for value in values for step in value.atoms(Step)}
    return any(step.free_symbols & moving for step in steps if not isinstance(step, _DIRECTED))


def _moving(omega_m: sp.Symbol, direction: int) -> dict[sp.Expr, sp.Expr]:
    """What is known of the steps by direction for velocities above (1) or below (-1) zero."""
    return {
        Sgn(omega_m): sp.Integer(direction),
        Forward(omega_m): sp.Integer(direction > 0),
        Backward(omega_m): sp.Integer(direction < 0),
    }


def _polynomials(model: Model, resultant: sp.Expr) -> tuple[Function, ...]:
    """F_3 ... F_0 for each direction where friction is a polynomial in the motor velocity (C1), else none."""
    omega_m = next(q.symbol for q in model.inputs if q.name == "omega_m")
    if _is_curved(model, resultant, omega_m):
        return ()
    plain = model.expand(resultant).replace(Gated, sp.Mul)
    found = []
    for name, direction in (("polynomial", 1), ("polynomial_neg", -1)):
        one_sided = sp.expand(plain.xreplace(_moving(omega_m, direction)))
        if not one_sided.is_polynomial(omega_m):
            return ()
        if direction < 0 and not resultant.has(Backward):
            break  # symmetric friction: the other direction says nothing new
        poly = sp.Poly(one_sided, omega_m)
        results = tuple((f"F_{k}", poly.coeff_monomial(omega_m**k)) for k in (3, 2, 1, 0))
        side = "omega_m > 0" if direction > 0 else "omega_m < 0"
        found.append(
            Function(
                name,
                "N m s^3/rad^3, N m s^2/rad^2, N m s/rad, N m",
                f"coefficients F_3, F_2, F_1, F_0 of F for {side}, eqs (11)-(14)",
                results,
            )
        )
    return tuple(found)
