"""The outputs of the model of one drive: friction, its derivatives, gravity, voltage, current, residuals.

They follow from the balances by the kinds of their terms: friction is the sum of all friction terms, also
those added by effects, and the regressor consists of their bases.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import sympy as sp

from eccentric.core import InputError
from eccentric.model import vocabulary as v
from eccentric.model.balance import KINDS
from eccentric.model.functions import cached
from eccentric.model.model import Model
from eccentric.model.output import Assignment, Expressions, Input, Interface, Output, needed
from eccentric.model.quantity import Definition, symbols
from eccentric.model.regressor import regressor
from eccentric.model.rest import acceleration, at_direction, budget, levels, moving, step
from eccentric.model.steps import (
    Backward,
    Bounded,
    Forward,
    Gated,
    Magnitude,
    OpaqueStep,
    Sgn,
    SquareDifference,
)

# By identity: a model is immutable, and has no hash. It is kept, so its ids stay unique.
_KEPT = 32
_interfaces: dict[tuple[object, ...], tuple[Model, Interface]] = {}


def interface_of(model: Model) -> Interface:
    """The outputs of a model: those that it declares, else those of one drive. The last 32 are cached.

    Models of one drive that differ in name, title and values alone have the same one.

    Raises:
        InputError: the model lacks something that they require.
    """
    structure = parts, *rest = structure_of(model)
    key = (*map(id, parts), *rest)
    kept = _interfaces.get(key)
    if kept is None:
        if model.declares is None:
            kept = model, cached("interface", structure, lambda: drive_interface(model))
        else:
            kept = model, model.declares(model)
        if len(_interfaces) >= _KEPT:
            _interfaces.pop(next(iter(_interfaces)), None)
        _interfaces[key] = kept
    return kept[1]


def structure_of(model: Model) -> tuple[tuple[object, ...], ...]:
    """All that the outputs of a model follow from: of one drive, not its name, its title and its values."""
    if model.declares is not None:
        return ((model,),)
    # `replace` keeps the parts that it does not change.
    parts = model.inputs, model.definitions, model.balances, model.equations, model.states, model.extensions
    known = model.back_emf_in_friction, model.current_known, model.voltage_known, model.torque_unit
    parameters = ((q.symbol, q.name, q.unit, q.default is None) for q in model.parameters)
    return (*parts, model.axis), known, tuple(parameters)


# Friction in one direction: its limit at standstill, and its polynomial in the velocity.


_DIRECTED = Sgn | Forward | Backward | Gated


def standstill(model: Model, friction: sp.Expr, direction: int) -> sp.Expr:
    """The limit of friction without acceleration as the velocity tends to 0 from above (1) or below (-1)."""
    omega_m, still = v.omega_m.symbol, {v.omega_m.symbol: sp.Integer(0), v.alpha_m.symbol: sp.Integer(0)}
    dependent = _following(model, set(still))
    defined = {d.symbol: d.value for d in model.definitions if d.symbol in dependent}
    for symbol in reversed(list(defined)):
        friction = friction.xreplace({symbol: defined[symbol]})
    friction = at_direction(friction, omega_m, direction).xreplace(still)
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
    # Expressions of parameters only are precomputed in double precision, where the plain root is accurate.
    varying = _following(model, {q.symbol for q in model.inputs})
    return friction.replace(
        lambda e: isinstance(e, Magnitude) and not e.free_symbols & varying,
        lambda e: sp.sqrt(e.args[0] ** 2 + e.args[1] ** 2),
    )


def polynomials(model: Model, resultant: sp.Expr) -> dict[int, tuple[sp.Expr, ...]]:
    """F_3, F_2, F_1, F_0 by direction, 1 or -1, if friction is a polynomial in the velocity, else empty.

    -1 is omitted if friction is symmetric.
    """
    omega_m = v.omega_m.symbol
    if _is_curved(model, _needed(model, resultant)):
        return {}
    expanded = model.expand(resultant).replace(Gated, sp.Mul)
    sides = {direction: sp.expand(expanded.xreplace(moving(omega_m, direction))) for direction in (1, -1)}
    if not all(side.is_polynomial(omega_m) for side in sides.values()):
        return {}
    # Poly would take a common exp(-t/tau) out of a sum and leave exp(t/tau) in it, which overflows.
    return {
        direction: tuple(side.coeff(omega_m, k) for k in (3, 2, 1, 0))
        for direction, side in sides.items()
        if direction > 0 or resultant.has(Backward)
    }


def _following(model: Model, symbols: set[sp.Symbol]) -> set[sp.Symbol]:
    """The symbols, and all definitions that depend on them directly or indirectly."""
    dependent = set(symbols)
    for definition in model.definitions:
        if definition.value.free_symbols & dependent:
            dependent.add(definition.symbol)
    return dependent


def _is_curved(model: Model, values: Iterable[sp.Expr]) -> bool:
    """Whether they contain a stable step of the velocity, other than of its direction."""
    dependent = _following(model, {v.omega_m.symbol})
    steps = {step for value in values for step in value.atoms(OpaqueStep)}
    return any(step.free_symbols & dependent for step in steps if not isinstance(step, _DIRECTED))


STEP = "next_state"
"""The output that advances hidden states; emitted with every model that has them."""
_ARMATURE = frozenset({"drive", "resistive", "back_emf"})
"""Kinds of terms whose coefficients are motor and armature parameters."""
_LABELLED = {
    "REGRESSOR": "regressor",
    "GRADIENT": "friction_torque_gradient",
    "JACOBIAN": "friction_torque_jacobian",
}
"""Constant of a module -> the output whose labels it lists."""
_OF_CURRENT = frozenset({"current", "mechanical_residual", "electrical_residual"})
"""Functions that need k_i itself, not only R/k_i."""
_OF_VOLTAGE = frozenset({"voltage", "electrical_residual"})
"""Functions that need R and k_e, not only k_i."""
_WITHOUT_BACK_EMF = _OF_CURRENT | {"mechanical_friction_torque"}
"""Functions that need the friction without the back-EMF, or its constant."""


def _note(model: Model, definition: Definition) -> str:
    """Meaning, unit and equation number of a definition, from the derivation, else from the paper."""
    quantity = definition.quantity
    stated = [e.number for e in model.equations if e.left in (quantity.symbol, quantity.symbol**2)]
    number = next(filter(None, reversed(stated)), "") if stated else quantity.equation
    return f"{quantity.meaning} [{quantity.unit}]" + (f", eq {number}" if number else "")


def solve_current(model: Model) -> sp.Expr:
    """The armature current required by the mechanical balance, eq (4) without the armature.

    In effects that depend on the current itself (torque ripple, saturation), the current without the effect
    is substituted: exact to first order in the effect.
    """
    mechanical = model.balance("mechanical")
    drive = next(term for term in mechanical.terms if term.kind == "drive")
    driven = [kind for kind in KINDS if kind not in {"drive", "actuator"}]
    current = sp.expand_mul(mechanical.sum_of(*driven) / drive.coefficient)
    actuator = sp.expand_mul(mechanical.sum_of("actuator") / drive.coefficient)
    return current + actuator.subs(drive.basis, current)


def drive_interface(model: Model) -> Interface:
    """The outputs of the model of one drive, in the order of a module.

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
    # Both in N m for comparison with data; the electrical one is (k_i/R)(u - k_e omega_m) - k_i i.
    residual = mechanical.residual()
    electrical_residual = sp.expand_mul(torque_constant / resistance * electrical.residual())
    columns = regressor(model)
    parameters = symbols(*model.friction_parameters)
    inertial = model.inertia.free_symbols
    inertia = tuple(q.name for q in model.parameters if q.default is None and q.symbol in inertial)
    dependence = tuple(x for x in _inputs(model, resultant) if x.name in {"theta_m", "omega_m", "alpha_m"})
    dry = levels(model, v.omega_m.symbol, tuple(t for t in mechanical.terms if t.kind == "friction"))
    at_rest = (
        ("lower", standstill(model, dry.at_rest(-1), -1)),
        ("upper", standstill(model, dry.at_rest(1), 1)),
    )
    moved_inertia = _moved_inertia(model)
    on_the_way, stepped = step(model, dry, moved_inertia)
    on_its_way, accelerated = acceleration(model, dry, moved_inertia)
    units = {q.symbol: q.unit for q in model.inputs}
    spanned = "friction_torque" if model.back_emf_in_friction else "mechanical_friction_torque"
    force = normal_force(model)
    damping = (
        "back-EMF damping included" if model.voltage_known else "here without back-EMF: R or k_e is not known"
    )
    definitions, scaled = _scaled(model)
    last = [v.alpha_m, v.torque, v.dt]
    order = [q for q in (*model.inputs, *(state.quantity for state in model.states)) if q not in last]
    order += [q for q in last if q in model.inputs or q is not v.alpha_m]
    inputs, axis = tuple(map(Input, order)), model.axis

    def output(
        name: str,
        unit: str,
        meaning: str,
        results: Iterable[tuple[str, sp.Expr]],
        by: tuple[sp.Symbol, ...] = (),
        before: Iterable[Assignment] = (),
        **more: Any,
    ) -> Output:
        own = (replace(a, value=a.value.xreplace(scaled)) for a in before)
        found = tuple((label, value.xreplace(scaled)) for label, value in results)
        expressions = Expressions(found, (*definitions, *own), by, (v.omega_m.symbol,))
        return Output(axis.named(name), axis.unit(unit), axis.text(meaning), inputs, expressions, **more)

    def one(value: sp.Expr) -> tuple[tuple[str, sp.Expr]]:
        return (("", value),)

    with_inertia = {"taken": frozenset({v.alpha_m.name}) if inertia else frozenset(), "requires": inertia}
    listed = [
        output("normal_force", "N", "normal force F_N on the axis of rotation", one(force or sp.S.Zero)),
        output(
            "friction_torque",
            "N m",
            f"resultant friction torque F, {damping}, eq (6)",
            one(resultant),
            needs=armature_parameters(model),
        ),
        output(
            "mechanical_friction_torque",
            "N m",
            "mechanical friction torque f = f_m + mu f_l, without back-EMF",
            one(friction),
        ),
        output(
            "friction_torque_gradient",
            f"N m per {', '.join(units[x] for x in dependence)}",
            "partial derivatives of friction_torque with respect to its inputs",
            one(resultant),
            dependence,
        ),
        output(
            "friction_torque_with_gradient",
            f"N m, N m per {', '.join(units[x] for x in dependence)}",
            "friction torque and its partial derivatives, for linearisation",
            (("friction_torque", resultant),),
            dependence,
        ),
        output(
            "friction_torque_jacobian",
            "N m per unit coefficient",
            "partial derivatives of friction_torque with respect to all friction coefficients",
            one(resultant),
            parameters,
        ),
        output(
            "regressor",
            "N m per unit coefficient",
            f"columns: regressor times friction_coefficients is {spanned}",
            ((column.name, column.basis) for column in columns),
        ),
        output(
            "friction_coefficients",
            ", ".join(column.unit for column in columns),
            "coefficients of the columns of the regressor",
            ((column.name, column.coefficient) for column in columns),
        ),
        output(
            "breakaway_torque",
            "N m",
            "levels of dry friction at rest: any torque between them holds the drive",
            at_rest,
            formerly=axis.named("coulomb_torque"),
        ),
        output(
            "friction_budget",
            "N m, N m, N m s/rad",
            "levels of dry friction at this state, and the viscous coefficient",
            budget(dry),
            before=dry.definitions,
        ),
        output("gravity_torque", "N m", "gravity torque G, eq (5)", one(gravity)),
        output(
            "voltage",
            "V",
            "armature voltage u = (R/k_i) (J alpha_m + G + F), eq (4)",
            one(voltage),
            **with_inertia,
        ),
        output("current", "A", "armature current i = (J alpha_m + G + f)/k_i", one(current), **with_inertia),
        output(
            "mechanical_residual",
            "N m",
            "residual of the mechanical balance: k_i i - J alpha_m - G - f",
            one(residual),
            **with_inertia,
        ),
        output(
            "electrical_residual",
            "N m",
            "residual of the electrical balance, as a torque: (k_i/R)(u - k_e omega_m) - k_i i",
            one(electrical_residual),
        ),
    ]
    if moved_inertia != 0:  # else the model has no acceleration
        listed += [
            output(
                "friction_step",
                "rad/s, N m",
                "velocity after a time step and the friction torque in it",
                stepped,
                before=(*dry.definitions, *on_the_way),
                requires=inertia,
                without_time={v.omega_m.name: v.omega_m.symbol, "friction": sp.Integer(0)},
            ),
            output(
                "acceleration",
                "rad/s^2",
                "acceleration by a torque, 0 at rest within the levels of dry friction",
                accelerated,
                before=(*dry.definitions, *on_its_way),
                requires=inertia,
            ),
        ]
    if model.states:
        listed.append(
            output(
                STEP, *step_words(model), step_updates(model), without_time=held_states(model), advances=True
            )
        )
    for direction, found in polynomials(model, resultant).items():
        name, side = {1: ("polynomial", "omega_m > 0"), -1: ("polynomial_neg", "omega_m < 0")}[direction]
        listed.append(
            output(
                name,
                "N m s^3/rad^3, N m s^2/rad^2, N m s/rad, N m",
                f"coefficients F_3, F_2, F_1, F_0 of F for {side}, eqs (11)-(14)",
                zip(("F_3", "F_2", "F_1", "F_0"), found, strict=True),
            )
        )
    withheld = frozenset[str]() if model.current_known else _OF_CURRENT
    if not model.voltage_known:
        withheld |= _OF_VOLTAGE
    if model.back_emf_in_friction:
        withheld = _WITHOUT_BACK_EMF
    if force is None:
        withheld |= {"normal_force"}
    left_out = set(map(axis.named, withheld))
    return Interface(
        tuple(one for one in listed if one.name not in left_out),
        axis.named(model.first_function),
        {constant: axis.named(name) for constant, name in _LABELLED.items()},
    )


def armature_parameters(model: Model) -> tuple[str, ...]:
    """Names of the motor and armature parameters, R, k_i and k_e, even if an effect replaces them."""
    before = {now: old for old, now in model.replaced.items()}
    coefficients = [t.coefficient for b in model.balances for t in b.terms if t.kind in _ARMATURE]
    return tuple(q.name for q in model.parameters if q.symbol in {before.get(x, x) for x in coefficients})


def step_words(model: Model) -> tuple[str, str]:
    """Unit and meaning of the hidden states one time step later."""
    units = ", ".join(state.quantity.unit for state in model.states)
    return units, "the hidden states one time step later"


def held_states(model: Model) -> dict[str, sp.Expr]:
    """Name and value of each hidden state for a time step of zero."""
    return {state.quantity.name: state.symbol for state in model.states}


def step_updates(model: Model) -> tuple[tuple[str, sp.Expr], ...]:
    """Name and value one time step later of each hidden state."""
    return tuple((state.quantity.name, state.update) for state in model.states)


def _moved_inertia(model: Model) -> sp.Expr:
    """Torque per acceleration: J and additions by effects on the motion [kg m^2].

    An angle error adds a part that varies with the angle; the total is kept above 1 % of the constant part.
    """
    others = [term for term in model.balance("mechanical").terms if term.kind != "friction"]
    summed = sp.Add(*(KINDS[t.kind] * t.value for t in others))
    for d in reversed(model.definitions):  # such as the transmitted torque
        if v.alpha_m.symbol in model.expand(d.symbol).free_symbols:
            summed = summed.xreplace({d.symbol: d.value})
    total = -sp.diff(summed, v.alpha_m.symbol)
    parts = sp.Add.make_args(sp.expand_mul(total))
    constant = sp.Add(*(part for part in parts if part.free_symbols <= model.parameter_symbols))
    if constant in (0, total):
        return total
    return constant / 100 + sp.Max(0, total - constant / 100)


def _require(model: Model) -> None:
    kinds = {balance.name: {term.kind for term in balance.terms} for balance in model.balances}
    present = {
        "an input omega_m": any(q.name == "omega_m" for q in model.inputs),
        "a balance `mechanical` with a term of kind `drive`": "drive" in kinds.get("mechanical", ()),
        "a balance `electrical` with a term of kind `resistive`": "resistive" in kinds.get("electrical", ()),
    }
    if missing := [what for what, is_present in present.items() if not is_present]:
        raise InputError(f"model {model.name}", missing[0], "none")


def normal_force(model: Model) -> sp.Symbol | None:
    """The symbol of F_N, or of its replacement by an effect; None for a model without one."""
    F_N = next((d.symbol for d in model.definitions if d.quantity.name == "F_N"), None)
    return None if F_N is None else model.replaced.get(F_N, F_N)


def _scaled(model: Model) -> tuple[tuple[Assignment, ...], dict[sp.Symbol, sp.Expr]]:
    """The definitions, with F_N = scale_N load expanded so that the scale becomes part of its factors.

    Also returns the replacement of F_N.
    """
    load = sp.Symbol("load", real=True)
    scaled: dict[sp.Symbol, sp.Expr] = {}
    written: list[Assignment] = []
    for d in model.definitions:
        magnitude = [factor for factor in sp.Mul.make_args(d.value) if isinstance(factor, Magnitude)]
        if d.symbol == v.F_N.symbol and magnitude:
            scaled[d.symbol] = d.value.xreplace({magnitude[0]: load})
            written.append(Assignment(load, magnitude[0], "normal force over scale_N [rad^2/s^2]"))
        else:
            written.append(Assignment(d.symbol, d.value.xreplace(scaled), _note(model, d)))
    return tuple(written), scaled


def _needed(model: Model, expression: sp.Expr) -> list[sp.Expr]:
    """The expression, and the values of the definitions that it depends on."""
    assignments = [Assignment(d.symbol, d.value) for d in model.definitions]
    return [expression, *(a.value for a in needed(assignments, [expression]))]


def _inputs(model: Model, expression: sp.Expr) -> tuple[sp.Symbol, ...]:
    symbols = set().union(*(value.free_symbols for value in _needed(model, expression)))
    return tuple(q.symbol for q in model.inputs if q.symbol in symbols)
