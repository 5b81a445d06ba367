"""The emitted functions of an arm: which there are, what they return, and which definitions they need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from eccentric.emission.program import stepping
from eccentric.emission.program.arm_inertial import Inertial
from eccentric.emission.program.arm_torques import (
    besides,
    columns,
    frictions,
    resultants,
    words_of_motor_torque,
)
from eccentric.emission.program.program import Assignment, differentiate, needed
from eccentric.model import Definition, Load, Model, Recursion, at_rest

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
        own = (*moving, *map(_assigned, stepping.definitions(model)))
        functions.append(ArmFunction(STEP, units, stepping.meaning(model), stepping.updates(model), own))
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
