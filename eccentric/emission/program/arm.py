"""The Program of a chain: its recursion in primitive operations, on vectors with one entry a joint.

Three functions: `inverse_dynamics`, `joint_wrenches`, `bearing_loads`. Bounds of rounding are not stated yet.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from eccentric.emission.program.distinct import require_distinct
from eccentric.emission.program.half_turn import HalfTurns
from eccentric.emission.program.lower import Lowering
from eccentric.emission.program.prepare import Prepare, notes
from eccentric.emission.program.program import Assignment, Helper, Input, Program, Routine, needed
from eccentric.emission.program.shorten import shortened, without_copies
from eccentric.model import HalfCosine, HalfSine, Load, Recursion, arm, quantity

_AXES = "xyz"
_LOADS = {Load.NORMAL: "F_N", Load.TRANSVERSAL: "F_T", Load.BENDING: "M_B", Load.TRANSMITTED: "T"}


@dataclass(frozen=True)
class _Function:
    """A function of a chain: its name, unit and meaning, and label -> expression."""

    name: str
    unit: str
    meaning: str
    results: tuple[tuple[str, sp.Expr], ...]


def build_arm_program(found: Recursion, title: str) -> Program:
    """The Program of a chain.

    Args:
        found: its recursion.
        title: one line.

    Raises:
        InputError: a quantity has the name of a value that the code computes.
    """
    model = arm(found.chain, title, found=found)
    shared = Prepare(model)
    half_turns = HalfTurns(shared)
    inputs = _inputs(found)
    assignments = _by_half_turns(found)
    routines = tuple(_routine(f, assignments, inputs, shared, half_turns) for f in _functions(found))
    called = {s for r in routines for a in r.assignments for s in a.value.free_symbols}
    helpers = tuple(h for h in half_turns.helpers if sp.Symbol(h.name) in called)
    program = Program(
        name=found.chain.name,
        title=title,
        parameters=found.chain.parameters,
        prepare=shortened(shared.assignments),
        coefficients=_used((*helpers, *routines), shared),
        routines=routines,
        constants=tuple((r.name.upper(), r.labels) for r in routines),
        notes=notes(model, shared),
        helpers=helpers,
        first=routines[0].name,
        chosen=True,
        # Without a parameter there is nothing to prepare.
        fixed=not found.chain.parameters,
    )
    require_distinct(program)
    return program


def _inputs(found: Recursion) -> tuple[Input, ...]:
    n = len(found.inputs)
    return (
        Input(quantity("theta_m", "rad", f"angles of the {n} motors"), n),
        Input(quantity("omega_m", "rad/s", f"velocities of the {n} motors"), n),
        Input(quantity("alpha_m", "rad/s^2", f"accelerations of the {n} motors"), n),
    )


def _functions(found: Recursion) -> tuple[_Function, ...]:
    joints = found.chain.joints
    torques = [
        (f"tau_m_{j}", rotor + joint.mu * torque)
        for j, (joint, rotor, torque) in enumerate(zip(joints, found.rotors, found.torques, strict=True))
    ]
    wrenches = [
        (f"{part}_{j}_{_AXES[k]}", (link.tilt * vector)[k])
        for j, (link, wrench) in enumerate(zip(found.chain.links, found.wrenches, strict=True))
        for part, vector in (("f", wrench.force), ("n", wrench.moment))
        for k in range(3)
    ]
    loads = [
        (f"{letter}_{j}", bearing.loads[load])
        for j, bearing in enumerate(found.bearings)
        for load, letter in _LOADS.items()
        if load in bearing.loads
    ]
    return (
        _Function(
            "inverse_dynamics",
            "N m",
            "torque of every motor that moves bodies and rotors and holds the weight, without friction",
            tuple(torques),
        ),
        _Function(
            "joint_wrenches",
            "N, N m",
            "force and moment on every body by its joint, in and about the origin of the joint's frame",
            tuple(wrenches),
        ),
        _Function(
            "bearing_loads",
            "N, N m",
            "what every bearing carries, F_N, F_T and M_B, and what its gear passes on, T",
            tuple(loads),
        ),
    )


def _by_half_turns(found: Recursion) -> tuple[Assignment, ...]:
    """The recursion, with sine and cosine of a joint from those of its half turn, as for one joint."""
    steps: dict[sp.Expr, sp.Expr] = {}
    for joint, inputs in zip(found.chain.joints, found.inputs, strict=True):
        theta = inputs.theta_m.symbol
        # The period of an angle is split into exact parts: of what a double holds, not of a decimal.
        mu = sp.Rational(float(joint.mu)) if joint.mu.is_number else joint.mu
        half_cosine, half_sine = HalfCosine(theta, mu), HalfSine(theta, mu)
        steps[sp.cos(joint.mu * theta)] = 1 - 2 * half_sine**2
        steps[sp.sin(joint.mu * theta)] = -2 * half_cosine * half_sine
    angles = {d.symbol: d.value for d in found.definitions if d.quantity.name.startswith("theta_l_")}
    return tuple(
        Assignment(
            d.symbol,
            d.value.xreplace(angles).xreplace(steps) if d.value.has(sp.sin, sp.cos) else d.value,
            f"{d.quantity.meaning.partition(', component ')[0]} [{d.quantity.unit}]",
        )
        for d in found.definitions
    )


def _routine(
    function: _Function,
    assignments: Sequence[Assignment],
    inputs: tuple[Input, ...],
    shared: Prepare,
    half_turns: HalfTurns,
) -> Routine:
    lowering = Lowering(shared, half_turns)
    told = ""
    for assignment in needed(assignments, [expression for _, expression in function.results]):
        if assignment.value.free_symbols <= shared.symbols:
            shared.define(assignment.target, assignment.value)
        else:
            value = lowering(shared.hoist(assignment.value))
            # Of the components of a vector the first one has the comment.
            note = assignment.note if assignment.note != told else ""
            told = assignment.note
            lowering.assignments.append(Assignment(assignment.target, value, note))
    targets = []
    for label, expression in function.results:
        targets.append(sp.Symbol(f"result_{label}", real=True))
        lowering.assignments.append(Assignment(targets[-1], lowering(shared.hoist(expression))))
    return Routine(
        name=function.name,
        inputs=inputs,
        assignments=without_copies(shortened(lowering.assignments), targets),
        results=tuple(targets),
        labels=tuple(label for label, _ in function.results),
        unit=function.unit,
        meaning=function.meaning,
    )


def _used(parts: tuple[Helper | Routine, ...], shared: Prepare) -> tuple[sp.Symbol, ...]:
    used = set().union(*(a.value.free_symbols for part in parts for a in part.assignments))
    order = [a.target for a in shared.assignments]
    plain = sorted((s for s in used & shared.symbols if s not in order), key=str)
    return (*plain, *(symbol for symbol in order if symbol in used))
