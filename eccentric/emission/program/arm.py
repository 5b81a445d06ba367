"""The Program of an arm: its recursion in primitive operations, on vectors with one entry a joint."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import sympy as sp

from eccentric.core import InputError
from eccentric.emission.program.arm_functions import (
    GRADIENT,
    INERTIAL,
    NAMES,
    STEP,
    ArmFunction,
    arm_functions,
    inertial,
)
from eccentric.emission.program.build import WHOLE, Choice, require_distinct
from eccentric.emission.program.lower import HalfTurns, Lowering
from eccentric.emission.program.prepare import Prepare, notes
from eccentric.emission.program.program import Assignment, Helper, Input, Program, Routine, needed
from eccentric.emission.program.shorten import shortened, without_copies
from eccentric.model import HalfCosine, HalfSine, Model, Recursion, meaning, quantity
from eccentric.model import vocabulary as v

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
_OF = {
    "inverse_dynamics": f"within {MOMENT} eps of mu N + P (slides: of mu F + P)",
    "joint_wrenches": f"forces within {FORCE} eps of F, moments within {MOMENT} eps of N",
    "bearing_loads": f"F_N, F_T within {FORCE} eps of F; M_B, T within {MOMENT} eps of N (slides: T of F)",
}
_WITH = (
    "with F = M (g + R (W^2 + A) + 2 V W + B), P = J_m (alpha_m + W omega_m + A), N = F (R + r) + all P:",
    "mass M, reach R, farthest bearing r, and W, A, V, B the sums of the joints' speeds and accelerations,",
    "turning and sliding",
)


def arm_promises(names: Collection[str]) -> tuple[str, ...]:
    """The bounds of the functions that are emitted, one line each; none for none of them."""
    said = [f"{name}: {bound}" for name, bound in _OF.items() if name in names]
    return (*said, *_WITH) if said else ()


def build_arm_program(found: Recursion, model: Model, choice: Choice = WHOLE) -> Program:
    """The Program of an arm.

    Args:
        found: its recursion.
        model: of the arm, with its name and defaults.
        choice: what of it is emitted; without a choice all but the gradient.

    Raises:
        InputError: a quantity has the name of a value that the code computes; there is no function of a
            chosen name; or fixed parameters are asked for, and one that is needed has no default.
    """
    offered = [name for name in NAMES if model.states or name != STEP]
    names = [name for name in choice.of(offered) if choice.functions or name != GRADIENT]
    shared = Prepare(model)
    half_turns = HalfTurns(shared)
    inputs, half_turned = _Inputs(found, model), _half_turned(found)
    of_bodies = inertial(found.chain) if INERTIAL in names else None
    listed = {f.name: f for f in arm_functions(model, found, of_bodies, gradient=GRADIENT in names)}
    routines = tuple(_routine(listed[name], half_turned, inputs, shared, half_turns) for name in names)
    called = {s for r in routines for a in r.assignments for s in a.value.free_symbols}
    helpers = tuple(h for h in half_turns.helpers if sp.Symbol(h.name) in called)
    constants = [(r.name.upper(), r.labels) for r in routines]
    if of_bodies is not None:
        constants.append(("INERTIAL_PARAMETERS", of_bodies.words))
    program = Program(
        name=model.name,
        title=model.title,
        parameters=model.parameters,
        prepare=shortened(shared.assignments),
        coefficients=_used((*helpers, *routines), shared),
        routines=routines,
        constants=tuple(constants),
        notes=notes(model, shared),
        states=tuple((state.quantity, state.initial) for state in model.states),
        defaults=model.defaults or "those of the arm, without friction",
        helpers=helpers,
        promises=arm_promises(names),
        first="motor_torque" if "motor_torque" in names else names[0],
        chosen=bool(choice.functions),
        arrays=choice.arrays,
        fixed=choice.fixed,
    )
    require_distinct(program)
    if choice.fixed and not program.ungiven.isdisjoint(program.coefficients):
        absent = " and ".join(q.name for q in program.parameters if q.default is None)
        raise InputError(
            f"fixed: a value of {absent} is required, which {program.name} has no default for: emit it with"
            " parameters, or choose functions that need none of them"
        )
    return program


class _Inputs:
    """The inputs of an arm's functions: the motion of its motors, and what else a function depends on.

    What each motor has is a vector; time, its step and hidden states are numbers.
    """

    def __init__(self, found: Recursion, model: Model) -> None:
        n = len(found.inputs)
        self.motion = (
            Input(quantity("theta_m", "rad", f"angles of the {n} motors"), n),
            Input(quantity("omega_m", "rad/s", f"velocities of the {n} motors"), n),
            Input(quantity("alpha_m", "rad/s^2", f"accelerations of the {n} motors"), n),
        )
        of_motors = (
            Input(quantity("i", "A", f"armature currents of the {n} motors"), n),
            Input(quantity("u", "V", f"armature voltages of the {n} motors"), n),
            Input(quantity("temperature", v.temperature.unit, f"temperatures of the {n} joints in degC"), n),
        )
        numbers = (v.t, *(state.quantity for state in model.states), v.dt)
        self._others = (*of_motors, *map(Input, numbers))

    def of(self, *, moves: bool, used: Collection[sp.Symbol]) -> tuple[Input, ...]:
        """Those of a function that uses these symbols."""
        others = (x for x in self._others if not set(x.symbols).isdisjoint(used))
        return (*(self.motion if moves else self.motion[:1]), *others)


def _half_turned(found: Recursion) -> dict[sp.Expr, sp.Expr]:
    """Sine and cosine of a joint by those of its half turn, as for one joint."""
    steps: dict[sp.Expr, sp.Expr] = {}
    for joint, inputs in zip(found.chain.joints, found.inputs, strict=True):
        theta = inputs.theta_m.symbol
        mu = _held(joint.mu)
        half_cosine, half_sine = HalfCosine(theta, mu), HalfSine(theta, mu)
        steps[sp.cos(joint.mu * theta)] = 1 - 2 * half_sine**2
        steps[sp.sin(joint.mu * theta)] = -2 * half_cosine * half_sine
    return steps


def _held(mu: sp.Expr) -> sp.Expr:
    """A gear ratio as a double holds it: the period of an angle is split into exact parts of that."""
    return sp.Rational(float(mu)) if mu.is_number else mu


def _turned(value: sp.Expr) -> sp.Expr:
    """The same, where an effect follows the angle of a joint or motor."""
    steps = value.atoms(HalfCosine, HalfSine)
    return value.xreplace({e: e.func(e.args[0], _held(e.args[1])) for e in steps})


def _routine(
    function: ArmFunction,
    half_turned: dict[sp.Expr, sp.Expr],
    inputs: _Inputs,
    shared: Prepare,
    half_turns: HalfTurns,
) -> Routine:
    lowering = Lowering(shared, half_turns)
    told = ""
    given, earlier = [], {}
    for a in function.definitions:
        turned = a.value.xreplace(earlier).xreplace(half_turned) if a.value.has(sp.sin, sp.cos) else a.value
        given.append(replace(a, value=_turned(turned)))
        earlier[a.target] = a.value
    for assignment in needed(given, [expression for _, expression in function.results]):
        value = assignment.value
        if value.free_symbols <= shared.symbols:
            shared.define(assignment.target, meaning(value))
        else:
            value = lowering(shared.hoist(value))
            # Of the components of a vector the first one has the comment.
            note = assignment.note if assignment.note != told else ""
            told = assignment.note
            lowering.assignments.append(Assignment(assignment.target, value, note))
    targets = []
    for label, expression in function.results:
        targets.append(sp.Symbol(f"result_{label}", real=True))
        lowering.assignments.append(Assignment(targets[-1], lowering(shared.hoist(_turned(expression)))))
    used = set().union(*(a.value.free_symbols for a in lowering.assignments))
    return Routine(
        name=function.name,
        inputs=inputs.of(moves=function.moves, used=used),
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
