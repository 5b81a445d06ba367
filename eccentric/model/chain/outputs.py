"""The outputs of an arm: torques, bearing loads, load-dependent friction, regressors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import sympy as sp

from eccentric.model import vocabulary as v
from eccentric.model.balance import Load, Term
from eccentric.model.chain.inertial import inertial
from eccentric.model.chain.motion import AXES
from eccentric.model.chain.recursion import Recursion, at_rest
from eccentric.model.chain.rest import Matrix, Stepped, acceleration, mass_matrix, step, still
from eccentric.model.model import Model
from eccentric.model.output import Assignment, Expressions, Input, Interface, Output, differentiate, needed
from eccentric.model.outputs import STEP, armature_parameters, held_states, step_updates, step_words
from eccentric.model.quantity import Definition, quantity
from eccentric.model.rest import Levels, NamedSteps, budget, levels
from eccentric.model.steps import HalfCosine, HalfSine, meaning

_LOADS = {Load.NORMAL: "F_N", Load.TRANSVERSAL: "F_T", Load.BENDING: "M_B", Load.TRANSMITTED: "T"}
_OF_LOADS = {
    Load.NORMAL: ("N", "forces across the axes of the joints"),
    Load.TRANSVERSAL: ("N", "forces along the axes of the joints"),
    Load.BENDING: ("N m", "moments on the bearings of the joints"),
    Load.TRANSMITTED: ("N m", "sizes of the torques that the drives of the joints transmit"),
}
"""Unit and meaning of each load as an input; of a slide the last is a force."""
_TORQUES = "torques of the motors, all but friction: those of the drives less those of weight and velocities"
_Results = Iterable[tuple[str, sp.Expr]]


@dataclass(frozen=True)
class ArmOutputs:
    """Declares the outputs of a model with this recursion; each is a vector, created only if requested."""

    found: Recursion

    def __call__(self, model: Model) -> Interface:
        """The outputs in the order of a module."""
        outputs = _Outputs(self.found, model).listed()
        constants = {output.name.upper(): output.name for output in outputs}
        return Interface(outputs, "motor_torque", constants)


class _Declared(NamedTuple):
    """An output as declared by its method; `unit`, `meaning` and `on_request` are those of `Output`."""

    unit: str
    meaning: str
    moves: bool = True  # whether it takes velocities and accelerations in addition to angles
    by_torques: bool = False  # whether the motor torques come last, before the time step
    by_loads: bool = False  # whether it takes the bearing loads instead of computing them from the motion
    on_request: bool = False


_DECLARED: dict[str, _Declared] = {}
"""Name of each output and its method -> declaration, in the order of a module."""

_Made = Callable[["_Outputs"], "_Results | Expressions"]


def _output(unit: str, meaning: str, **more: bool) -> Callable[[_Made], _Made]:
    """Declare a method as an output: it returns results for the moving arm, or complete expressions."""

    def declared(method: _Made) -> _Made:
        _DECLARED[method.__name__] = _Declared(unit, meaning, **more)
        return method

    return declared


class _Outputs:
    """The outputs of an arm's model, one method each."""

    def __init__(self, recursion: Recursion, model: Model) -> None:
        self._found, self._model = recursion, model
        self._joints = range(len(recursion.inputs))
        self._moving = tuple(map(_assigned, model.definitions))

    def listed(self) -> tuple[Output, ...]:
        """All of them, in the order of a module."""
        omega_m = [inputs.omega_m.symbol for inputs in self._found.inputs]
        at_once = {x.name: x for x in omega_m} | {f"friction_{j}": sp.Integer(0) for j in self._joints}
        more: dict[str, dict[str, Any]] = {
            "friction_torque": {"needs": armature_parameters(self._model)},
            "friction_step": {"without_time": at_once},
        }
        declared = dict(_DECLARED)
        kinds = {t.kind for b in self._model.balances if b.unit == "N m" for t in b.terms}
        if not kinds.isdisjoint({"conservative", "actuator"}):
            one = declared["motor_torque"]
            meaning = f"{one.meaning}, and the effects that are not friction"
            declared["motor_torque"] = one._replace(meaning=meaning)
        listed = [self._made(name, one, **more.get(name, {})) for name, one in declared.items()]
        if self._model.states:
            stepped = _Declared(*step_words(self._model))
            options = {"without_time": held_states(self._model), "advances": True}
            listed.append(self._made(STEP, stepped, lambda _: step_updates(self._model), **options))
        return tuple(listed)

    def _made(self, name: str, one: _Declared, method: _Made | None = None, **more: Any) -> Output:
        n, results = len(self._joints), method or getattr(_Outputs, name)

        def per_motor(name: str, unit: str, meaning: str, domain: str = "real") -> Input:
            return Input(quantity(name, unit, meaning, domain=domain), n)

        motion = (
            per_motor("theta_m", "rad", f"angles of the {n} motors"),
            per_motor("omega_m", "rad/s", f"velocities of the {n} motors"),
            per_motor("alpha_m", "rad/s^2", f"accelerations of the {n} motors"),
        )[: 3 if one.moves else 1]
        # Motor quantities are vectors; time, its step and hidden states are scalars.
        others = (
            per_motor("i", "A", f"armature currents of the {n} motors"),
            per_motor("u", "V", f"armature voltages of the {n} motors"),
            per_motor("temperature", v.temperature.unit, f"temperatures of the {n} joints in degC"),
            *map(Input, (v.t, *(state.quantity for state in self._model.states))),
        )
        torques = (Input(replace(v.torque, meaning=_TORQUES), n),) if one.by_torques else ()
        loads = tuple(
            per_motor(_LOADS[load], *of, "nonnegative") for load, of in _OF_LOADS.items() if one.by_loads
        )

        def expressions() -> Expressions:
            values = results(self)
            return values if isinstance(values, Expressions) else _expressions(values, self._stable_moving)

        return Output(
            name,
            one.unit,
            one.meaning,
            (*motion, *loads, *others, *torques, Input(v.dt)),
            expressions,
            frozenset(x.quantity.name for x in (*motion[: 2 if loads else 3], *loads)),
            on_request=one.on_request,
            **more,
        )

    # Shared by several outputs.

    @cached_property
    def _stable_moving(self) -> tuple[Assignment, ...]:
        return self._stable(self._moving)

    def _stable(self, definitions: Iterable[Assignment]) -> tuple[Assignment, ...]:
        return _stable(self._found, self._model, definitions)

    def _terms(self, j: int) -> list[Term]:
        return [t for t in self._model.balance(f"mechanical_{j}").terms if t.kind == "friction"]

    def _drive(self, j: int) -> Term:
        return next(t for t in self._model.balance(f"mechanical_{j}").terms if t.kind == "drive")

    @cached_property
    def _friction(self) -> list[sp.Expr]:
        """Friction with each load factored out once; effects may contain a load in other ways."""
        torques = []
        for j, bearing in enumerate(self._found.bearings):
            loads = [load for load in bearing.loads.values() if load.is_Symbol]
            factors: dict[sp.Expr, list[sp.Expr]] = {}
            for term in self._terms(j):
                rest, dependent = term.value.as_independent(*loads, as_Add=False)
                load, factor = (dependent, rest) if dependent in loads else (sp.Integer(1), term.value)
                factors.setdefault(load, []).append(factor)
            torques.append(sp.Add(*(load * sp.Add(*parts) for load, parts in factors.items())))
        return torques

    @cached_property
    def _levels(self) -> list[Levels]:
        """Dry friction of every joint by its direction; the loads are those of the current state."""
        fixed = {d.symbol for d in self._found.definitions}
        return [
            levels(self._model, inputs.omega_m.symbol, tuple(self._terms(j)), fixed)
            for j, inputs in enumerate(self._found.inputs)
        ]

    @cached_property
    def _both_ways(self) -> tuple[Assignment, ...]:
        """The definitions, and the direction-dependent ones for both directions."""
        return (*self._moving, *(a for dry in self._levels for a in dry.definitions))

    def _inertia(self) -> tuple[tuple[Assignment, ...], Matrix]:
        return mass_matrix(self._found, self._moving, self._found.motor_torques)

    def _by_torques(
        self, computed: Callable[[Recursion, NamedSteps, Matrix, list[Levels]], Stepped]
    ) -> Expressions:
        """Forward dynamics: the inertia, the levels, and the steps computed from them."""
        definitions, entries = self._inertia()
        defined = {a.target for a in definitions}
        named = NamedSteps(self._model)
        inertia = [[named(f"M_{j}_{k}", x) for k, x in enumerate(row)] for j, row in enumerate(entries)]
        steps, results = computed(self._found, named, inertia, self._levels)
        before = (*definitions, *(a for a in self._both_ways if a.target not in defined))
        return _expressions(results, (*self._stable(before), *steps))

    # The outputs. Those on request are long.

    @_output(
        "N m", "torque of every motor that moves bodies and rotors and supports the weight, without friction"
    )
    def inverse_dynamics(self) -> _Results:
        return _labelled("tau_m", self._found.motor_torques)

    @_output(
        "N m",
        "torque of every motor that the motion requires: inverse_dynamics plus mechanical_friction_torque",
    )
    def motor_torque(self) -> _Results:
        for j, (bodies, friction) in enumerate(zip(self._found.motor_torques, self._friction, strict=True)):
            mechanical, drive = self._model.balance(f"mechanical_{j}"), self._drive(j)
            conservative = mechanical.sum_of("conservative")
            # Terms that depend on the current are evaluated at the current without them, as for one joint.
            current = (bodies + friction + conservative) / drive.coefficient
            besides = conservative + mechanical.sum_of("actuator").subs(drive.basis, current)
            yield f"tau_{j}", bodies + friction + besides

    @_output(
        "N, N m", "force and moment on every body by its joint, in and about the origin of the joint's frame"
    )
    def joint_wrenches(self) -> _Results:
        for j, (link, wrench) in enumerate(zip(self._found.chain.links, self._found.wrenches, strict=True)):
            for part, vector in (("f", wrench.force), ("n", wrench.moment)):
                yield from zip((f"{part}_{j}_{axis}" for axis in AXES), link.tilt * vector, strict=True)

    @_output("N, N m", "loads of every bearing, F_N, F_T and M_B, and the torque T that its gear transmits")
    def bearing_loads(self) -> _Results:
        for j, bearing in enumerate(self._found.bearings):
            yield from (
                (f"{x}_{j}", bearing.loads[load]) for load, x in _LOADS.items() if load in bearing.loads
            )

    @_output("N m", "torque of every motor that supports the weight: inverse_dynamics at rest", moves=False)
    def gravity_torque(self) -> Expressions:
        definitions, torques = at_rest(self._found)
        return _expressions(_labelled("G", torques), self._stable(map(_assigned, definitions)))

    @_output("N m", "friction torque of every motor, f = f_m + mu f_l, without back-EMF")
    def mechanical_friction_torque(self) -> _Results:
        return _labelled("f", self._friction)

    @_output(
        "N m", "levels of dry friction of every motor at rest: any torque between them holds it", moves=False
    )
    def breakaway_torque(self) -> Expressions:
        results = tuple(
            (f"{label}_{j}", dry.at_rest(direction))
            for j, dry in enumerate(self._levels)
            for label, direction in (("lower", -1), ("upper", 1))
        )
        definitions, at_standstill = still(self._found, self._moving, results, self._model.parameter_symbols)
        return _expressions(at_standstill, self._stable(definitions))

    @_output(
        "N m, N m, N m s/rad",
        "levels of dry friction of every motor at this state, and the viscous coefficient",
    )
    def friction_budget(self) -> Expressions:
        return self._budget({})

    @_output(
        "N m, N m, N m s/rad",
        "levels of dry friction of every motor and its viscous coefficient, at given bearing loads",
        by_loads=True,
        on_request=True,
    )
    def friction_budget_from_loads(self) -> Expressions:
        given = {
            load: sp.Symbol(f"{_LOADS[kind]}_{j}", real=True)
            for j, bearing in enumerate(self._found.bearings)
            for kind, load in bearing.loads.items()
            if load.is_Symbol
        }
        return self._budget(given)

    def _budget(self, given: Mapping[sp.Expr, sp.Expr]) -> Expressions:
        """The levels and the viscous coefficient of every joint; `given` are loads that are not computed."""
        omegas = [inputs.omega_m.symbol for inputs in self._found.inputs]
        results = [
            (f"{label}_{j}", value.xreplace(given))
            for j, (dry, omega_m) in enumerate(zip(self._levels, omegas, strict=True))
            for label, value in budget(dry, omega_m)
        ]
        definitions = (a for a in self._stable(self._both_ways) if a.target not in given)
        return _expressions(results, tuple(replace(a, value=a.value.xreplace(given)) for a in definitions))

    @_output("N m", "resultant friction torque F of every motor, back-EMF damping included, eq (6)")
    def friction_torque(self) -> _Results:
        for j, f in enumerate(self._friction):
            electrical = self._model.balance(f"electrical_{j}")
            resistance = next(t.coefficient for t in electrical.terms if t.kind == "resistive")
            yield f"F_{j}", f + self._drive(j).coefficient / resistance * electrical.sum_of("back_emf")

    @_output(
        "N m per unit coefficient",
        "friction torque of a joint per coefficient: the last number of a label is the joint",
    )
    def regressor(self) -> _Results:
        for j in self._joints:
            columns: dict[str, sp.Expr] = {}
            for term in self._terms(j):
                name = str(term.coefficient)
                columns[name] = columns.get(name, sp.Integer(0)) + term.basis
            yield from columns.items()

    @_output(
        "N m per unit parameter",
        "torque of every motor per inertial parameter, a row for each motor; rotors of a given inertia aside",
    )
    def inertial_regressor(self) -> Expressions:
        of_bodies = inertial(self._found.chain)
        results = [
            (f"tau_m_{j}_by_{q.name}", slope)
            for j, row in enumerate(of_bodies.slopes)
            for q, slope in zip(of_bodies.parameters, row, strict=True)
        ]
        made = _expressions(results, self._stable(of_bodies.definitions))
        return replace(made, constants=(("INERTIAL_PARAMETERS", of_bodies.words),))

    @_output("kg m^2", "inertia on the motor side, rotors included, row by row", moves=False)
    def mass_matrix(self) -> Expressions:
        definitions, entries = self._inertia()
        results = [(f"M_{j}_{k}", x) for j, row in enumerate(entries) for k, x in enumerate(row)]
        return _expressions(results, self._stable(definitions))

    @_output(
        "rad/s, N m",
        "velocities of the motors after a time step, and the friction torques in it",
        by_torques=True,
        on_request=True,
    )
    def friction_step(self) -> Expressions:
        return self._by_torques(step)

    @_output(
        "rad/s^2",
        "accelerations of the motors by their torques, 0 at rest within the levels of dry friction",
        by_torques=True,
        on_request=True,
    )
    def acceleration(self) -> Expressions:
        return self._by_torques(acceleration)

    @_output(
        "N m per rad, rad/s, rad/s^2",
        "partial derivatives of mechanical_friction_torque by theta_m, omega_m, alpha_m, joint by joint",
        on_request=True,
    )
    def mechanical_friction_torque_gradient(self) -> Expressions:
        """Derivatives of every joint's friction by every input, definition by definition."""
        inputs = self._found.inputs
        by = [x.theta_m.symbol for x in inputs] + [x.omega_m.symbol for x in inputs]
        by += [x.alpha_m.symbol for x in inputs]
        torques = [
            Assignment(sp.Symbol(f"friction_f_{j}", real=True), e) for j, e in enumerate(self._friction)
        ]
        needs = needed((*self._moving, *torques), [t.target for t in torques])
        steps, slopes = differentiate(needs, by)
        results = [
            (f"f_{j}_by_{x.name}", slopes.get((torque.target, x), sp.Integer(0)))
            for j, torque in enumerate(torques)
            for x in by
        ]
        return _expressions(results, self._stable(steps))


def _labelled(name: str, values: Iterable[sp.Expr]) -> list[tuple[str, sp.Expr]]:
    return [(f"{name}_{j}", value) for j, value in enumerate(values)]


def _expressions(results: _Results, definitions: tuple[Assignment, ...]) -> Expressions:
    return Expressions(tuple((label, _with_held_ratios(e)) for label, e in results), definitions)


def _stable(recursion: Recursion, model: Model, definitions: Iterable[Assignment]) -> tuple[Assignment, ...]:
    """The definitions in stable steps, with plain formulas where they depend on parameters only."""
    half_turned: dict[sp.Expr, sp.Expr] = {}
    for joint, inputs in zip(recursion.chain.joints, recursion.inputs, strict=True):
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
    """A gear ratio rounded to double: the period of an angle is split into exact parts of it."""
    return sp.Rational(float(mu)) if mu.is_number else mu


def _with_held_ratios(value: sp.Expr) -> sp.Expr:
    """The value with rounded gear ratios in effects that depend on the angle of a joint or motor."""
    steps = value.atoms(HalfCosine, HalfSine)
    return value.xreplace({e: e.func(e.args[0], _held(e.args[1])) for e in steps})


def _assigned(definition: Definition) -> Assignment:
    """A definition with its comment, without the component of a vector."""
    meaning = definition.quantity.meaning.partition(", component ")[0]
    return Assignment(definition.symbol, definition.value, f"{meaning} [{definition.quantity.unit}]")
