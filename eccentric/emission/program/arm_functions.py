"""The emitted functions of an arm: which there are, what they return, and which definitions they need."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg
import sympy as sp
from sympy.printing.numpy import NumPyPrinter

from eccentric.emission.program.functions import step_definitions, step_meaning, step_updates
from eccentric.emission.program.program import Assignment, differentiate, needed
from eccentric.model import (
    Chain,
    Definition,
    Load,
    Model,
    Quantity,
    Recursion,
    Term,
    at_rest,
    recursion,
    with_letters,
)

# What the balances of an arm's joints say of the torque of their motors: friction, and what effects add.


def _terms(model: Model, j: int) -> list[Term]:
    return [term for term in model.balance(f"mechanical_{j}").terms if term.kind == "friction"]


def columns(model: Model, j: int) -> list[tuple[str, sp.Expr]]:
    """Coefficient and basis of the friction of a joint, each coefficient once."""
    columns: dict[str, sp.Expr] = {}
    for term in _terms(model, j):
        name = str(term.coefficient)
        columns[name] = columns.get(name, sp.Integer(0)) + term.basis
    return list(columns.items())


def frictions(model: Model, found: Recursion) -> list[tuple[str, sp.Expr]]:
    """Each load is multiplied once, by what follows it; effects may contain a load in other ways."""
    results = []
    for j, bearing in enumerate(found.bearings):
        loads = [load for load in bearing.loads.values() if load.is_Symbol]
        factors: dict[sp.Expr, list[sp.Expr]] = {}
        for term in _terms(model, j):
            rest, own = term.value.as_independent(*loads, as_Add=False)
            load, factor = (own, rest) if own in loads else (sp.Integer(1), term.value)
            factors.setdefault(load, []).append(factor)
        results.append((f"f_{j}", sp.Add(*(load * sp.Add(*parts) for load, parts in factors.items()))))
    return results


def besides(model: Model, j: int, torque: sp.Expr) -> sp.Expr:
    """What the effects of a joint ask of its motor besides friction, at this torque of all else.

    A term of the current is taken at the current without it, as for one joint: exact to first order in it.
    """
    mechanical = model.balance(f"mechanical_{j}")
    drive = next(term for term in mechanical.terms if term.kind == "drive")
    conservative = mechanical.sum_of("conservative")
    current = (torque + conservative) / drive.coefficient
    return conservative + mechanical.sum_of("actuator").subs(drive.basis, current)


def words_of_motor_torque(model: Model) -> str:
    """What `motor_torque` adds up."""
    kinds = {t.kind for b in model.balances if b.unit == "N m" for t in b.terms}
    parts = "inverse_dynamics and mechanical_friction_torque"
    if not kinds.isdisjoint({"conservative", "actuator"}):
        parts += ", and the effects that are no friction"
    return f"torque of every motor that the motion takes: {parts}"


def resultants(model: Model, friction: Sequence[tuple[str, sp.Expr]]) -> list[tuple[str, sp.Expr]]:
    """Eq (4): the back-EMF damps by k_i k_e/R omega_m."""
    results = []
    for j, (_, f) in enumerate(friction):
        electrical = model.balance(f"electrical_{j}")
        resistance = next(t.coefficient for t in electrical.terms if t.kind == "resistive")
        drive = next(t for t in model.balance(f"mechanical_{j}").terms if t.kind == "drive")
        results.append((f"F_{j}", f + drive.coefficient / resistance * electrical.sum_of("back_emf")))
    return results


# The inertial regressor of an arm: torque of every motor per inertial parameter that a motion can show.
#
# The torques are linear in the moments of mass of every body and in the inertia of every rotor. Their
# slopes are taken from the recursion itself, from each torque outwards (reverse mode): what a force or
# moment further out adds to the torque is computed once and serves all parameters of that body.
#
# Some parameters never show, others only in sums. Which, is found on random motions: a column that those
# before it span is left out, and its parameter is counted by them (base parameters; M. Gautier, "Numerical
# calculation of the base inertial parameters of robots", J. Robotic Systems 8(4), 1991).


_MOTIONS = 8
"""Random motions per parameter: enough for full rank with margin."""
_SPANNED = 1e-9
"""Part of a column, by its norm, below which those before it span it: rounding leaves some 1e-14."""
_COUNTED = 1e-9
"""Factor of a parameter in a sum, by the size of its column, below which it is not counted."""


@dataclass(frozen=True)
class Inertial:
    """The inertial regressor of a chain.

    Attributes:
        parameters: those of the columns, in order.
        sums: of each column, parameter -> factor: what the column's coefficient is the sum of.
        slopes: torque of motor j per parameter, [j][k].
        definitions: what the slopes are computed from.
    """

    parameters: tuple[Quantity, ...]
    sums: tuple[Mapping[str, float], ...]
    slopes: tuple[tuple[sp.Expr, ...], ...]
    definitions: tuple[Assignment, ...]

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The sums as a person writes them."""
        return tuple(_in_words(one) for one in self.sums)


def inertial(chain: Chain) -> Inertial:
    """The inertial regressor of a chain: base parameters only."""
    lettered = with_letters(chain, chain.name, rotors=True)
    quantities = lettered.parameters[len(chain.parameters) :]
    found = recursion(lettered)
    definitions, slopes = _slopes(found, [q.symbol for q in quantities])
    values = _evaluated(found, definitions, slopes, chain)
    kept, sums = _base(values, [q.name for q in quantities])
    rows = tuple(tuple(row[k] for k in kept) for row in slopes)
    used = needed(definitions, [e for row in rows for e in row])
    return Inertial(tuple(quantities[k] for k in kept), sums, rows, used)


def _slopes(
    found: Recursion, by: Sequence[sp.Symbol]
) -> tuple[list[Assignment], tuple[tuple[sp.Expr, ...], ...]]:
    """The recursion and, behind it, what each force adds to each torque; the slopes of all torques."""
    moving = [Assignment(d.symbol, d.value) for d in found.definitions]
    # What depends on the parameters: only there slopes are carried on.
    follows = set(by)
    for assignment in moving:
        if assignment.value.free_symbols & follows:
            follows.add(assignment.target)
    added: list[Assignment] = []
    rows = []
    torques = [
        rotor + joint.mu * torque
        for joint, rotor, torque in zip(found.chain.joints, found.rotors, found.torques, strict=True)
    ]
    for j, torque in enumerate(torques):
        carried: dict[sp.Symbol, list[sp.Expr]] = {}
        _carry(carried, torque, sp.Integer(1), follows)
        for assignment in reversed(moving):
            if assignment.target not in carried:
                continue
            factor = sp.Add(*carried.pop(assignment.target))
            if not (factor.is_Atom or (-factor).is_Symbol):
                symbol = sp.Symbol(f"of_{assignment.target.name}_{j}", real=True)
                added.append(Assignment(symbol, factor))
                factor = symbol
            if factor != 0:
                _carry(carried, assignment.value, factor, follows)
        rows.append(tuple(sp.Add(*carried.get(x, [])) for x in by))
    return [*moving, *added], tuple(rows)


def _carry(
    carried: dict[sp.Symbol, list[sp.Expr]], value: sp.Expr, factor: sp.Expr, follows: set[sp.Symbol]
) -> None:
    for symbol in sorted(value.free_symbols & follows, key=str):
        carried.setdefault(symbol, []).append(factor * value.diff(symbol))


def _evaluated(
    found: Recursion,
    definitions: Sequence[Assignment],
    slopes: Sequence[Sequence[sp.Expr]],
    chain: Chain,
) -> np.ndarray:
    """The regressor on random motions and letters of the chain, shape (motions x joints, parameters)."""
    rng, printer = np.random.default_rng(0), NumPyPrinter({"fully_qualified_modules": False})
    motions = _MOTIONS * len(slopes[0])
    known: dict[str, Any] = {q.symbol.name: rng.uniform(0.5, 1.5) for q in chain.parameters}
    for joint, inputs in zip(chain.joints, found.inputs, strict=True):
        gear = float(joint.mu) if joint.mu.is_number else 1.0
        for x in (inputs.theta_m, inputs.omega_m, inputs.alpha_m):
            known[x.symbol.name] = rng.normal(size=motions) * 3.0 / gear
    used = needed(definitions, [e for row in slopes for e in row])
    lines = [f"{a.target} = {printer.doprint(a.value)}" for a in used]
    rows = ", ".join(f"[{', '.join(map(printer.doprint, row))}]" for row in slopes)
    lines.append(f"found = [{rows}]")
    exec("\n".join(lines), dict(vars(np)), known)  # noqa: S102 - printed from expressions, not from text
    columns = [[np.broadcast_to(x, motions) for x in row] for row in known["found"]]
    return np.array(columns, dtype=float).transpose(2, 0, 1).reshape(-1, len(slopes[0]))


def _base(values: np.ndarray, names: Sequence[str]) -> tuple[list[int], tuple[Mapping[str, float], ...]]:
    """The columns that those before them do not span, and which parameters each of them counts."""
    sizes = np.linalg.norm(values, axis=0)
    shown = [k for k in range(len(names)) if sizes[k] > 0.0]
    scaled = values[:, shown] / sizes[shown]
    diagonal = np.abs(np.diag(scipy.linalg.qr(scaled, mode="r")[0]))
    is_kept = diagonal > _SPANNED
    kept, spanned = np.flatnonzero(is_kept), np.flatnonzero(~is_kept)
    factors = np.linalg.lstsq(scaled[:, kept], scaled[:, spanned], rcond=None)[0]
    sums = []
    for row, k in enumerate(kept):
        one = {names[shown[k]]: 1.0}
        for column, other in enumerate(spanned):
            if abs(factors[row, column]) > _COUNTED:
                one[names[shown[other]]] = float(factors[row, column] * sizes[shown[other]] / sizes[shown[k]])
        sums.append(one)
    return [shown[k] for k in kept], tuple(sums)


def _in_words(one: Mapping[str, float]) -> str:
    """mass_1 + 0.4 h_2_x - mass_3"""
    text = ""
    for name, factor in one.items():
        size = f"{abs(factor):.6g}"
        text += (" - " if factor < 0 else " + ") + (name if size == "1" else f"{size} {name}")
    return text.removeprefix(" + ")


_AXES = "xyz"
_LOADS = {Load.NORMAL: "F_N", Load.TRANSVERSAL: "F_T", Load.BENDING: "M_B", Load.TRANSMITTED: "T"}
INERTIAL, GRADIENT = "inertial_regressor", "mechanical_friction_torque_gradient"
STEP = "next_state"
NAMES = (
    "inverse_dynamics", "motor_torque", "joint_wrenches", "bearing_loads", "gravity_torque",
    "mechanical_friction_torque", "friction_torque", "regressor", INERTIAL, GRADIENT, STEP,
)  # fmt: skip
"""Every function of an arm; the gradient only where it is chosen: it is longer than all others together."""


@dataclass(frozen=True)
class ArmFunction:
    """A function of an arm.

    Attributes:
        name, unit, meaning: as in Routine.
        results: label -> expression.
        definitions: what the results are computed from, in order; more than is needed.
        moves: whether it takes velocities and accelerations, not angles alone.
    """

    name: str
    unit: str
    meaning: str
    results: tuple[tuple[str, sp.Expr], ...]
    definitions: tuple[Assignment, ...]
    moves: bool = True


def arm_functions(
    model: Model, found: Recursion, of_bodies: Inertial | None, *, gradient: bool
) -> tuple[ArmFunction, ...]:
    """The functions of an arm in the order of the module.

    Args:
        model: of the arm.
        found: its recursion.
        of_bodies: its inertial regressor, if it is wanted.
        gradient: whether that of the friction is wanted.
    """
    moving = tuple(map(_assigned, model.definitions))
    inverse, friction = _inverse_dynamics(found), frictions(model, found)
    plain = [
        (
            "inverse_dynamics",
            "N m",
            "torque of every motor that moves bodies and rotors and holds the weight, without friction",
            inverse,
        ),
        (
            "motor_torque",
            "N m",
            words_of_motor_torque(model),
            [
                (f"tau_{j}", a + b + besides(model, j, a + b))
                for j, ((_, a), (_, b)) in enumerate(zip(inverse, friction, strict=True))
            ],
        ),
        (
            "joint_wrenches",
            "N, N m",
            "force and moment on every body by its joint, in and about the origin of the joint's frame",
            _wrenches(found),
        ),
        (
            "bearing_loads",
            "N, N m",
            "what every bearing carries, F_N, F_T and M_B, and what its gear passes on, T",
            _loads(found),
        ),
        (
            "mechanical_friction_torque",
            "N m",
            "friction torque of every motor, f = f_m + mu f_l, without back-EMF",
            friction,
        ),
        (
            "friction_torque",
            "N m",
            "resultant friction torque F of every motor, back-EMF damping included, eq (6)",
            resultants(model, friction),
        ),
        (
            "regressor",
            "N m per unit coefficient",
            "friction torque of a joint per coefficient: the last number of a label is the joint",
            [column for j in range(len(found.inputs)) for column in columns(model, j)],
        ),
    ]
    functions = [
        ArmFunction(name, unit, meaning, tuple(results), moving) for name, unit, meaning, results in plain
    ]
    functions.append(
        ArmFunction(
            "gravity_torque",
            "N m",
            "torque of every motor that holds the weight: inverse_dynamics at rest",
            *_at_rest(found),
            moves=False,
        )
    )
    if of_bodies is not None:
        functions.append(_inertial_regressor(of_bodies))
    if gradient:
        functions.append(_gradient(found, moving, friction))
    if model.states:
        units = ", ".join(state.quantity.unit for state in model.states)
        own = (*moving, *map(_assigned, step_definitions(model)))
        functions.append(ArmFunction(STEP, units, step_meaning(model), step_updates(model), own))
    return tuple(functions)


def _inverse_dynamics(found: Recursion) -> list[tuple[str, sp.Expr]]:
    of_joints = zip(found.chain.joints, found.rotors, found.torques, strict=True)
    return [(f"tau_m_{j}", rotor + joint.mu * torque) for j, (joint, rotor, torque) in enumerate(of_joints)]


def _wrenches(found: Recursion) -> list[tuple[str, sp.Expr]]:
    return [
        (f"{part}_{j}_{_AXES[k]}", (link.tilt * vector)[k])
        for j, (link, wrench) in enumerate(zip(found.chain.links, found.wrenches, strict=True))
        for part, vector in (("f", wrench.force), ("n", wrench.moment))
        for k in range(3)
    ]


def _loads(found: Recursion) -> list[tuple[str, sp.Expr]]:
    return [
        (f"{letter}_{j}", bearing.loads[load])
        for j, bearing in enumerate(found.bearings)
        for load, letter in _LOADS.items()
        if load in bearing.loads
    ]


def _at_rest(found: Recursion) -> tuple[tuple[tuple[str, sp.Expr], ...], tuple[Assignment, ...]]:
    definitions, torques = at_rest(found)
    return tuple((f"G_{j}", torque) for j, torque in enumerate(torques)), tuple(map(_assigned, definitions))


def _inertial_regressor(of_bodies: Inertial) -> ArmFunction:
    names = [q.name for q in of_bodies.parameters]
    return ArmFunction(
        INERTIAL,
        "N m per unit parameter",
        "torque of every motor per inertial parameter, a row for each motor; rotors of a given inertia aside",
        tuple(
            (f"tau_m_{j}_by_{name}", slope)
            for j, row in enumerate(of_bodies.slopes)
            for name, slope in zip(names, row, strict=True)
        ),
        of_bodies.definitions,
    )


def _gradient(
    found: Recursion, moving: Sequence[Assignment], friction: Sequence[tuple[str, sp.Expr]]
) -> ArmFunction:
    """Slopes of every joint's friction by every input, definition by definition."""
    by = [x.theta_m.symbol for x in found.inputs] + [x.omega_m.symbol for x in found.inputs]
    by += [x.alpha_m.symbol for x in found.inputs]
    torques = [Assignment(sp.Symbol(f"friction_{label}", real=True), e) for label, e in friction]
    needs = needed((*moving, *torques), [t.target for t in torques])
    steps, slopes = differentiate(needs, by)
    results = [
        (f"{label}_by_{x.name}", slopes.get((torque.target, x), sp.Integer(0)))
        for (label, _), torque in zip(friction, torques, strict=True)
        for x in by
    ]
    return ArmFunction(
        GRADIENT,
        "N m per rad, rad/s, rad/s^2",
        "partial derivatives of mechanical_friction_torque by theta_m, omega_m, alpha_m, joint by joint",
        tuple(results),
        steps,
    )


def _assigned(definition: Definition) -> Assignment:
    meaning = definition.quantity.meaning.partition(", component ")[0]
    return Assignment(definition.symbol, definition.value, f"{meaning} [{definition.quantity.unit}]")
