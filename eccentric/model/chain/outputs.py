"""The outputs of an arm: torques, loads of the bearings, friction that follows them, regressors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eccentric.model import vocabulary as v
from eccentric.model.balance import Load, Term
from eccentric.model.chain.inertial import inertial
from eccentric.model.chain.recursion import Recursion, at_rest
from eccentric.model.chain.rest import Matrix, Stepped, acceleration, mass_matrix, step, still
from eccentric.model.model import Model
from eccentric.model.output import Assignment, Expressions, Input, Interface, Output, differentiate, needed
from eccentric.model.outputs import STEP, armature_parameters, held_states, step_updates, step_words
from eccentric.model.quantity import Definition, quantity
from eccentric.model.rest import Levels, NamedSteps, budget, levels
from eccentric.model.steps import HalfCosine, HalfSine, meaning

_AXES = "xyz"
_LOADS = {Load.NORMAL: "F_N", Load.TRANSVERSAL: "F_T", Load.BENDING: "M_B", Load.TRANSMITTED: "T"}
_TORQUES = "torques of the motors, all but friction: those of the drives less those of weight and velocities"
_Results = Iterable[tuple[str, sp.Expr]]


@dataclass(frozen=True)
class ArmOutputs:
    """Declares the outputs of a model that has this recursion; each is a vector, written only if wanted."""

    found: Recursion

    def __call__(self, model: Model) -> Interface:
        """The outputs in the order of a module."""
        outputs = _Outputs(self.found, model).listed()
        constants = {output.name.upper(): output.name for output in outputs}
        return Interface(outputs, "motor_torque", constants)


class _Outputs:
    """The outputs of an arm's model."""

    def __init__(self, found: Recursion, model: Model) -> None:
        self._found, self._model = found, model
        self._motion, self._others = _inputs(found, model)
        self._moving = tuple(map(_assigned, model.definitions))

    @cached_property
    def _stable_moving(self) -> tuple[Assignment, ...]:
        return _stable(self._found, self._model, self._moving)

    @cached_property
    def _friction(self) -> list[tuple[str, sp.Expr]]:
        return _frictions(self._model, self._found)

    @cached_property
    def _levels(self) -> list[Levels]:
        """Dry friction of every joint by its own direction; the loads are those of the state."""
        given = {d.symbol for d in self._found.definitions}
        return [
            levels(self._model, inputs.omega_m.symbol, tuple(_terms(self._model, j)), given)
            for j, inputs in enumerate(self._found.inputs)
        ]

    def listed(self) -> tuple[Output, ...]:
        """All of them, in the order of a module."""
        found, model = self._found, self._model
        per_joint = range(len(found.inputs))
        listed = [
            self._output(
                "inverse_dynamics",
                "N m",
                "torque of every motor that moves bodies and rotors and holds the weight, without friction",
                self._of_moving(lambda: _labelled("tau_m", found.motor_torques)),
            ),
            self._output(
                "motor_torque", "N m", _words_of_motor_torque(model), self._of_moving(self._motor_torque)
            ),
            self._output(
                "joint_wrenches",
                "N, N m",
                "force and moment on every body by its joint, in and about the origin of the joint's frame",
                self._of_moving(lambda: _wrenches(found)),
            ),
            self._output(
                "bearing_loads",
                "N, N m",
                "what every bearing carries, F_N, F_T and M_B, and what its gear passes on, T",
                self._of_moving(lambda: _loads(found)),
            ),
            self._output(
                "gravity_torque",
                "N m",
                "torque of every motor that holds the weight: inverse_dynamics at rest",
                self._at_rest,
                moves=False,
            ),
            self._output(
                "mechanical_friction_torque",
                "N m",
                "friction torque of every motor, f = f_m + mu f_l, without back-EMF",
                self._of_moving(lambda: self._friction),
            ),
            self._output(
                "breakaway_torque",
                "N m",
                "levels of dry friction of every motor at rest: any torque between them holds it",
                self._breakaway,
                moves=False,
            ),
            self._output(
                "friction_budget",
                "N m, N m, N m s/rad",
                "levels of dry friction of every motor at this state, and the viscous coefficient",
                self._budget,
            ),
            self._output(
                "friction_torque",
                "N m",
                "resultant friction torque F of every motor, back-EMF damping included, eq (6)",
                self._of_moving(lambda: _resultants(model, self._friction)),
                needs=armature_parameters(model),
            ),
            self._output(
                "regressor",
                "N m per unit coefficient",
                "friction torque of a joint per coefficient: the last number of a label is the joint",
                self._of_moving(lambda: [column for j in per_joint for column in _columns(model, j)]),
            ),
            self._output(
                "inertial_regressor",
                "N m per unit parameter",
                "torque of every motor per inertial parameter, a row for each motor;"
                " rotors of a given inertia aside",
                self._inertial_regressor,
            ),
            # These are long: the matrix aside, only on request.
            self._output(
                "mass_matrix",
                "kg m^2",
                "inertia on the motor side, rotors included, row by row",
                self._mass_matrix,
                moves=False,
            ),
            self._output(
                "friction_step",
                "rad/s, N m",
                "velocities of the motors after a time step, and the friction torques in it",
                lambda: self._by_torques(step),
                by_torques=True,
                without_time=_without_time(found),
                on_request=True,
            ),
            self._output(
                "acceleration",
                "rad/s^2",
                "accelerations of the motors by their torques, 0 at rest within the levels of dry friction",
                lambda: self._by_torques(acceleration),
                by_torques=True,
                on_request=True,
            ),
            self._output(
                "mechanical_friction_torque_gradient",
                "N m per rad, rad/s, rad/s^2",
                "partial derivatives of mechanical_friction_torque by theta_m, omega_m, alpha_m,"
                " joint by joint",
                self._gradient,
                on_request=True,
            ),
        ]
        if model.states:
            updates = self._of_moving(lambda: step_updates(model))
            listed.append(
                self._output(
                    STEP, *step_words(model), updates, without_time=held_states(model), advances=True
                )
            )
        return tuple(listed)

    def _output(
        self,
        name: str,
        unit: str,
        meaning: str,
        expressions: Callable[[], Expressions],
        *,
        moves: bool = True,
        by_torques: bool = False,
        **more: Any,
    ) -> Output:
        """One of them.

        `moves` is whether it takes velocities and accelerations, not angles alone; `by_torques` whether the
        torques of the motors come last, before the time step.
        """
        motion, last = (self._motion if moves else self._motion[:1]), self._others[-1:]
        if by_torques:
            last = (Input(replace(v.torque, meaning=_TORQUES), len(self._found.inputs)), *last)
        taken = frozenset(x.quantity.name for x in motion)
        inputs = (*motion, *self._others[:-1], *last)
        return Output(name, unit, meaning, inputs, expressions, taken, **more)

    def _of_moving(self, results: Callable[[], _Results]) -> Callable[[], Expressions]:
        return lambda: _expressions(results(), self._stable_moving)

    def _motor_torque(self) -> _Results:
        both = zip(self._found.motor_torques, self._friction, strict=True)
        for j, (bodies, (_, friction)) in enumerate(both):
            yield f"tau_{j}", bodies + friction + _besides(self._model, j, bodies + friction)

    def _at_rest(self) -> Expressions:
        definitions, torques = at_rest(self._found)
        stable = _stable(self._found, self._model, tuple(map(_assigned, definitions)))
        return _expressions(_labelled("G", torques), stable)

    @cached_property
    def _both_ways(self) -> tuple[Assignment, ...]:
        """The definitions, and those that a direction of motion changes, for both."""
        return (*self._moving, *(a for found in self._levels for a in found.definitions))

    def _budget(self) -> Expressions:
        omegas = [inputs.omega_m.symbol for inputs in self._found.inputs]
        results = [
            (f"{label}_{j}", value)
            for j, (dry, omega_m) in enumerate(zip(self._levels, omegas, strict=True))
            for label, value in budget(dry, omega_m)
        ]
        return _expressions(results, _stable(self._found, self._model, self._both_ways))

    def _breakaway(self) -> Expressions:
        results = tuple(
            (f"{label}_{j}", dry.at_rest(direction))
            for j, dry in enumerate(self._levels)
            for label, direction in (("lower", -1), ("upper", 1))
        )
        definitions, held = still(self._found, self._moving, results, self._model.parameter_symbols)
        return _expressions(held, _stable(self._found, self._model, definitions))

    def _inertia(self) -> tuple[tuple[Assignment, ...], Matrix]:
        return mass_matrix(self._found, self._moving, self._found.motor_torques)

    def _mass_matrix(self) -> Expressions:
        definitions, entries = self._inertia()
        results = [(f"M_{j}_{k}", x) for j, row in enumerate(entries) for k, x in enumerate(row)]
        return _expressions(results, _stable(self._found, self._model, definitions))

    def _by_torques(
        self, computed: Callable[[Recursion, NamedSteps, Matrix, list[Levels]], Stepped]
    ) -> Expressions:
        """What the torques make of the motion: the inertia, the levels, and the steps from them."""
        definitions, entries = self._inertia()
        there = {a.target for a in definitions}
        named = NamedSteps(self._model)
        inertia = [[named(f"M_{j}_{k}", x) for k, x in enumerate(row)] for j, row in enumerate(entries)]
        steps, results = computed(self._found, named, inertia, self._levels)
        before = (*definitions, *(a for a in self._both_ways if a.target not in there))
        return _expressions(results, (*_stable(self._found, self._model, before), *steps))

    def _inertial_regressor(self) -> Expressions:
        of_bodies = inertial(self._found.chain)
        names = [q.name for q in of_bodies.parameters]
        results = [
            (f"tau_m_{j}_by_{name}", slope)
            for j, row in enumerate(of_bodies.slopes)
            for name, slope in zip(names, row, strict=True)
        ]
        stable = _stable(self._found, self._model, of_bodies.definitions)
        return replace(_expressions(results, stable), constants=(("INERTIAL_PARAMETERS", of_bodies.words),))

    def _gradient(self) -> Expressions:
        """Slopes of every joint's friction by every input, definition by definition."""
        inputs = self._found.inputs
        by = [x.theta_m.symbol for x in inputs] + [x.omega_m.symbol for x in inputs]
        by += [x.alpha_m.symbol for x in inputs]
        torques = [Assignment(sp.Symbol(f"friction_{label}", real=True), e) for label, e in self._friction]
        needs = needed((*self._moving, *torques), [t.target for t in torques])
        steps, slopes = differentiate(needs, by)
        results = [
            (f"{label}_by_{x.name}", slopes.get((torque.target, x), sp.Integer(0)))
            for (label, _), torque in zip(self._friction, torques, strict=True)
            for x in by
        ]
        return _expressions(results, _stable(self._found, self._model, steps))


def _labelled(name: str, values: Iterable[sp.Expr]) -> list[tuple[str, sp.Expr]]:
    return [(f"{name}_{j}", value) for j, value in enumerate(values)]


def _without_time(found: Recursion) -> dict[str, sp.Expr]:
    """What a time step gives where no time passes: the velocities as they are, and no friction."""
    velocities = [inputs.omega_m.symbol for inputs in found.inputs]
    frictions = {f"friction_{j}": sp.Integer(0) for j in range(len(velocities))}
    return {omega_m.name: omega_m for omega_m in velocities} | frictions


def _expressions(results: _Results, definitions: tuple[Assignment, ...]) -> Expressions:
    return Expressions(tuple((label, _with_held_ratios(e)) for label, e in results), definitions)


def _inputs(found: Recursion, model: Model) -> tuple[tuple[Input, ...], tuple[Input, ...]]:
    """The motion of the motors, and what else an output may depend on.

    What each motor has is a vector; time, its step and hidden states are numbers.
    """
    n = len(found.inputs)
    motion = (
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
    return motion, (*of_motors, *map(Input, numbers))


# In stable steps: the sine and cosine of a joint by those of its half turn, as for one joint.


def _stable(found: Recursion, model: Model, definitions: Iterable[Assignment]) -> tuple[Assignment, ...]:
    """The definitions with these steps; what depends on parameters only is a plain formula."""
    half_turned: dict[sp.Expr, sp.Expr] = {}
    for joint, inputs in zip(found.chain.joints, found.inputs, strict=True):
        theta, mu = inputs.theta_m.symbol, _held(joint.mu)
        half_cosine, half_sine = HalfCosine(theta, mu), HalfSine(theta, mu)
        half_turned[sp.cos(joint.mu * theta)] = 1 - 2 * half_sine**2
        half_turned[sp.sin(joint.mu * theta)] = -2 * half_cosine * half_sine
    fixed, earlier, stable = {q.symbol for q in model.parameters}, {}, []
    for a in definitions:
        value = a.value.xreplace(earlier).xreplace(half_turned) if a.value.has(sp.sin, sp.cos) else a.value
        value = _with_held_ratios(value)
        if value.free_symbols <= fixed:
            fixed.add(a.target)
            value = meaning(value)
        stable.append(replace(a, value=value))
        earlier[a.target] = a.value
    return tuple(stable)


def _held(mu: sp.Expr) -> sp.Expr:
    """A gear ratio as a double holds it: the period of an angle is split into exact parts of that."""
    return sp.Rational(float(mu)) if mu.is_number else mu


def _with_held_ratios(value: sp.Expr) -> sp.Expr:
    """The same, where an effect follows the angle of a joint or motor."""
    steps = value.atoms(HalfCosine, HalfSine)
    return value.xreplace({e: e.func(e.args[0], _held(e.args[1])) for e in steps})


def _assigned(definition: Definition) -> Assignment:
    """A definition with its comment; of the components of a vector the first one has it."""
    meaning = definition.quantity.meaning.partition(", component ")[0]
    return Assignment(definition.symbol, definition.value, f"{meaning} [{definition.quantity.unit}]")


# What the balances of an arm's joints say of the torque of their motors: friction, and what effects add.


def _terms(model: Model, j: int) -> list[Term]:
    return [term for term in model.balance(f"mechanical_{j}").terms if term.kind == "friction"]


def _columns(model: Model, j: int) -> list[tuple[str, sp.Expr]]:
    """Coefficient and basis of the friction of a joint, each coefficient once."""
    columns: dict[str, sp.Expr] = {}
    for term in _terms(model, j):
        name = str(term.coefficient)
        columns[name] = columns.get(name, sp.Integer(0)) + term.basis
    return list(columns.items())


def _frictions(model: Model, found: Recursion) -> list[tuple[str, sp.Expr]]:
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


def _besides(model: Model, j: int, torque: sp.Expr) -> sp.Expr:
    """What the effects of a joint ask of its motor besides friction, at this torque of all else.

    A term of the current is taken at the current without it, as for one joint: exact to first order in it.
    """
    mechanical = model.balance(f"mechanical_{j}")
    drive = next(term for term in mechanical.terms if term.kind == "drive")
    conservative = mechanical.sum_of("conservative")
    current = (torque + conservative) / drive.coefficient
    return conservative + mechanical.sum_of("actuator").subs(drive.basis, current)


def _words_of_motor_torque(model: Model) -> str:
    """What `motor_torque` adds up."""
    kinds = {t.kind for b in model.balances if b.unit == "N m" for t in b.terms}
    parts = "inverse_dynamics and mechanical_friction_torque"
    if not kinds.isdisjoint({"conservative", "actuator"}):
        parts += ", and the effects that are no friction"
    return f"torque of every motor that the motion takes: {parts}"


def _resultants(model: Model, friction: Sequence[tuple[str, sp.Expr]]) -> list[tuple[str, sp.Expr]]:
    """Eq (4): the back-EMF damps by k_i k_e/R omega_m."""
    results = []
    for j, (_, f) in enumerate(friction):
        electrical = model.balance(f"electrical_{j}")
        resistance = next(t.coefficient for t in electrical.terms if t.kind == "resistive")
        drive = next(t for t in model.balance(f"mechanical_{j}").terms if t.kind == "drive")
        results.append((f"F_{j}", f + drive.coefficient / resistance * electrical.sum_of("back_emf")))
    return results


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
