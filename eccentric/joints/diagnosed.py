"""Diagnose every joint of an arm: the effects missing in its model, besides friction by bearing loads.

A joint's friction enters its own balance only, so each joint is diagnosed as the log of a single drive, with
torques and loads from the others as inputs. An arm has as many chances of a false verdict as it has joints:
an effect has to gain more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import sympy as sp

from eccentric.diagnosis import (
    Asked,
    Diagnosis,
    NextMeasurement,
    SearchRequest,
    diagnosed,
    extended_model,
    required_over,
    staged,
)
from eccentric.effects import Effect
from eccentric.joints.arm_log import ArmLog
from eccentric.joints.base_parameters import names_of
from eccentric.joints.bodies import IdentifiedBodies
from eccentric.joints.fitted import prepared, warnings_of
from eccentric.joints.joint_model import DECLARED, joint_inputs
from eccentric.logs import LogSource
from eccentric.model import (
    Balance,
    Definition,
    JointDrive,
    Load,
    Model,
    Quantity,
    Recursion,
    State,
    Term,
    arm,
    at_rest,
    drives,
    quantity,
    recursion,
    with_bodies,
)
from eccentric.model import vocabulary as v
from eccentric.rigs import ArmRig

_ORDER = ("named", "not_identifiable", "unexplained", "nothing_missing")


@dataclass(frozen=True)
class JointDiagnosis:
    """One joint: its number in the columns, name in the arm file, and diagnosis as a single drive."""

    number: int
    name: str
    found: Diagnosis

    @property
    def verdict(self) -> str:
        """The verdict of the single drive."""
        return self.found.attribution.verdict

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be of this joint, in these units."""
        return self.found.models.fits_the_rig

    @property
    def deviance(self) -> float:
        """Cross-validated gain of the best single effect on the training part."""
        gains = [gain for gain, _ in self.found.attribution.deviance.values()]
        return max(gains, default=0.0)


@dataclass(frozen=True)
class ArmDiagnosis:
    """The diagnosis of an arm.

    Attributes:
        log: the logs, with the bodies used.
        names: of the logs.
        bodies: the identified bodies; None if they are declared, or a torque is unknown.
        joints: from the base outwards.
        required: deviance that an effect had to gain.
    """

    log: ArmLog
    names: tuple[str, ...]
    bodies: IdentifiedBodies | None
    joints: tuple[JointDiagnosis, ...]
    required: float

    @property
    def by_gain(self) -> tuple[JointDiagnosis, ...]:
        """The joints, sorted by the gain of their best effect."""
        return tuple(sorted(self.joints, key=lambda joint: -joint.deviance))

    @property
    def verdict(self) -> str:
        """The first of named, not_identifiable, unexplained, nothing_missing that any joint has."""
        verdicts = {joint.verdict for joint in self.joints}
        return next(verdict for verdict in _ORDER if verdict in verdicts)

    @property
    def named(self) -> tuple[tuple[JointDiagnosis, Effect], ...]:
        """Named effects with their joints, by gain."""
        return tuple((joint, effect) for joint in self.by_gain for effect, _ in joint.found.effects)

    @property
    def first(self) -> dict[str, Any] | None:
        """The joint where an effect gains most, and its leading family; None if nothing is missing."""
        lacking = (
            joint for joint in self.by_gain if joint.fits_the_rig and joint.verdict != "nothing_missing"
        )
        leading = next(lacking, None)
        if leading is None:
            return None
        candidates = leading.found.attribution.candidates
        return {
            "joint": leading.number,
            "verdict": leading.verdict,
            "family": candidates[0].family if candidates else None,
        }

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be of this arm, in these units."""
        return all(joint.fits_the_rig for joint in self.joints)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the logs, and runs of a joint that differ from the others."""
        differing = (
            f"joint {joint.number}: {text}" for joint in self.joints for text in joint.found.differing
        )
        return (*warnings_of(self.log, self.bodies), *differing)


def diagnose_arm(
    logs: Sequence[LogSource],
    rig: ArmRig,
    names: Sequence[str],
    effects: Path | None = None,
    request: SearchRequest | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> ArmDiagnosis:
    """Diagnose every joint.

    Args:
        logs: those of one arm, as `read_log` accepts them.
        rig: of the arm.
        names: of the logs.
        effects: a file with user-defined effects.
        request: restrictions of the search.
        tell: called with one line per stage.

    Raises:
        InputError: bad input; too few rows of a joint; an effect that is unknown.
    """
    log, bodies = prepared(logs, rig, tell)
    required = required_over(len(log))
    joints = []
    for j in range(len(log)):
        number = rig.number(j)
        diagnosis = _diagnosed(log, j, names, effects, request or SearchRequest(), required, tell)
        joints.append(JointDiagnosis(number, rig.chain.joints[j].name, diagnosis))
        tell(f"joint {number}: {joints[-1].verdict}")
    return ArmDiagnosis(log, tuple(names), bodies, tuple(joints), required)


def _diagnosed(
    log: ArmLog,
    j: int,
    names: Sequence[str],
    effects: Path | None,
    request: SearchRequest,
    required: float,
    tell: Callable[[str], None],
) -> Diagnosis:
    number = log.rig.number(j)
    loads = log.present(j, DECLARED)
    model, data = log.joint(j, loads, f"{log.rig.chain.name}_joint_{number}")
    stage = staged(model, model, data, effects, f"{', '.join(names)}: joint {number}")
    inputs = Asked(tuple(names), Path(log.rig.path).name, model, effects, request)
    diagnosis = diagnosed(stage, inputs, lambda line: tell(f"joint {number}: {line}"), required)
    return _in_an_arm(diagnosis)


def _in_an_arm(diagnosis: Diagnosis) -> Diagnosis:
    """The diagnosis without advice that only applies to a single drive."""
    attribution = diagnosis.attribution
    of_inertia = attribution.verdict == "unexplained" and attribution.depends_on[:1] == ("acceleration",)
    if diagnosis.models.misfit or not of_inertia:
        return diagnosis
    return replace(
        diagnosis, attribution=replace(attribution, next_measurement=NextMeasurement("hold_others"))
    )


# The arm model that a diagnosis emits: the recursion of the chain with the joint models' friction.
#
# The inputs of a joint model (`joint_model` with its identified effects) are torques and loads of the joint.
# Here the recursion of the chain replaces them, and all other names of the joint get its number.
_OF_THE_ARM = frozenset({"drive", "inertial", "bodies", "gravity"})
"""Kinds of terms of a joint that the recursion already has."""
_OF_THE_CHAIN = frozenset({v.mu.symbol, v.F_N.symbol})


def why_not_emitted(diagnosis: ArmDiagnosis) -> str:
    """Why an arm with the identified friction would be wrong, in words; "" if it is not."""
    if misfit := [j.number for j in diagnosis.joints if not j.fits_the_rig]:
        return f"the log does not fit the rig in {_those(misfit)}"
    if unscaled := [j.number for j in diagnosis.joints if j.found.unit != "N m"]:
        return f"friction has no scale in N m in {_those(unscaled)}: give k_i under [drives] in the rig file"
    if diagnosis.bodies is not None and not diagnosis.bodies.bodies.explain:
        return "no real bodies have the identified base parameters"
    return ""


def _those(joints: Sequence[int]) -> str:
    return f"joint{'s' * (len(joints) > 1)} {', '.join(map(str, joints))}"


def arm_name(diagnosis: ArmDiagnosis) -> str:
    """The name of the emitted arm: `_extended` where an effect was adopted in a joint, else `_fitted`."""
    adopted = any(joint.found.result.effects for joint in diagnosis.joints)
    return f"{diagnosis.log.rig.chain.name}_{'extended' if adopted else 'fitted'}"


def extended_arm(found: ArmDiagnosis) -> Model | None:
    """The model of a diagnosed arm with the fitted friction of every joint; None if `why_not_emitted`."""
    if why_not_emitted(found):
        return None
    chain = found.log.rig.declared
    if found.bodies is not None:
        values = map(float, found.bodies.bodies.values.ravel())
        chain = with_bodies(chain, dict(zip(names_of(len(found.joints)), values, strict=True)))
    effects = [f"{effect.id} in joint {j.number}" for j in found.joints for effect, _ in j.found.effects]
    done = f"extended by {', '.join(effects)}" if effects else "friction fitted"
    title = f"Arm {chain.name}, {done}"
    joints = [extended_model(joint.found) for joint in found.joints]
    return in_an_arm(recursion(chain), joints, arm_name(found), title)


def in_an_arm(found: Recursion, joints: Sequence[Model], name: str, title: str) -> Model:
    """The model of an arm in which each joint has the friction and drive of a separate model.

    Args:
        found: the recursion of the arm.
        joints: a model for each, from the base outwards: `joint_model`, extended or not.
        name: of the result, in code.
        title: one line.
    """
    base = arm(found.chain, title, found=found)
    gravity, moments = _gravity(found)
    parts = [
        _NumberedJoint(found, j, drive, model, torque)
        for j, (drive, model, torque) in enumerate(zip(drives(found), joints, moments, strict=True))
    ]
    logged = {q.symbol: q for part in parts for q in part.inputs}
    balances = tuple(part.balance(base, name) for part in parts for name in ("mechanical", "electrical"))
    definitions = (*gravity, *(d for part in parts for d in part.definitions))
    states = tuple(state for part in parts for state in part.states)
    used = _used(balances, definitions, states)
    return replace(
        base,
        name=name,
        title=title,
        inputs=(*base.inputs, *(q for symbol, q in logged.items() if symbol in used)),
        parameters=(
            *found.chain.parameters,
            *(q for part in parts for q in part.parameters if q.symbol in used),
        ),
        definitions=(*base.definitions, *(d for d in definitions if d.symbol in used)),
        balances=balances,
        states=tuple(state for state in states if state.symbol in used),
        defaults="fitted values; see the comment on each parameter",
    )


def _used(
    balances: Sequence[Balance], definitions: Sequence[Definition], states: Sequence[State]
) -> set[sp.Symbol]:
    """Symbols that the balances depend on, through definitions and hidden states.

    Effects of the armature circuit are not among them: no function of an arm has a voltage.
    """
    values = {d.symbol: d.value for d in definitions} | {state.symbol: state.update for state in states}
    used: set[sp.Symbol] = set()
    waiting = set().union(*(term.value.free_symbols for b in balances for term in b.terms))
    while waiting:
        used |= waiting
        waiting = set().union(*(values[x].free_symbols for x in waiting if x in values)) - used
    return used


class _NumberedJoint:
    """The model of one joint in the symbols of the arm."""

    def __init__(
        self, recursion: Recursion, j: int, drive: JointDrive, model: Model, gravity: sp.Symbol
    ) -> None:
        self._j, self._model, self._called = j, model, drive.called
        joint, inputs, loads = recursion.chain.joints[j], recursion.inputs[j], recursion.bearings[j].loads
        self._taken = {d.quantity.name for d in recursion.definitions} | {gravity.name}
        zero = sp.Integer(0)
        self._arm_parameters = {q.name: q for q in drive.parameters}
        self._temperature = quantity(
            f"temperature_{j}", v.temperature.unit, f"temperature of joint {j} in degC"
        )
        met = joint_inputs(
            gravity=gravity,
            moving=joint.mu * recursion.torques[j] - gravity,
            rotor=recursion.rotors[j],
            loads={load: loads.get(load, zero) for load in Load},
        )
        self._letters: dict[sp.Expr, sp.Expr] = {
            **met,
            v.mu.symbol: joint.mu,
            v.F_N.symbol: loads.get(Load.NORMAL, zero),
            v.theta_m.symbol: inputs.theta_m.symbol,
            v.omega_m.symbol: inputs.omega_m.symbol,
            v.alpha_m.symbol: inputs.alpha_m.symbol,
            v.i.symbol: drive.current.symbol,
            v.u.symbol: drive.voltage.symbol,
            v.temperature.symbol: self._temperature.symbol,
        }
        self._letters |= {
            q.symbol: self._numbered(q).symbol
            for q in (
                *model.parameters,
                *(d.quantity for d in model.definitions),
                *(state.quantity for state in model.states),
            )
            if q.symbol not in self._letters
        }

    @property
    def inputs(self) -> tuple[Quantity, ...]:
        """Inputs of its model that the arm lacks."""
        names = {q.symbol for q in self._model.inputs}
        logged = {v.temperature.symbol: self._temperature, v.t.symbol: v.t}
        return tuple(q for symbol, q in logged.items() if symbol in names)

    @property
    def parameters(self) -> tuple[Quantity, ...]:
        """Its parameters, without those of the chain."""
        return tuple(self._parameter(q) for q in self._model.parameters if q.symbol not in _OF_THE_CHAIN)

    @property
    def definitions(self) -> tuple[Definition, ...]:
        """Its definitions, without those of the chain."""
        return tuple(
            Definition(self._numbered(d.quantity), self._of_the_arm(d.value))
            for d in self._model.definitions
            if d.symbol not in _OF_THE_CHAIN
        )

    @property
    def states(self) -> tuple[State, ...]:
        return tuple(
            State(self._numbered(s.quantity), self._of_the_arm(s.initial), self._of_the_arm(s.update))
            for s in self._model.states
        )

    def balance(self, base: Model, name: str) -> Balance:
        """A balance of the arm with the terms of its model; `base` is the arm without joint models."""
        balance = base.balance(f"{name}_{self._j}")
        retained = tuple(term for term in balance.terms if term.kind in _OF_THE_ARM)
        added = map(self._term, self._model.balance(name).terms)
        omitted = _OF_THE_ARM | ({"actuator"} if name == "electrical" else set())
        added = (t for t in added if t.kind not in omitted and t.basis != 0)
        return replace(balance, terms=(*retained, *added))

    def _of_the_arm(self, value: sp.Expr) -> sp.Expr:
        return value.xreplace(self._letters)

    def _numbered(self, q: Quantity) -> Quantity:
        meaning, name = f"joint {self._called}: {q.meaning}", f"{q.name}_{self._j}"
        # A user-defined effect may use a name that the recursion has with a number: T, omega_l.
        name = f"effect_{name}" if name in self._taken else name
        return quantity(name, q.unit, meaning, q.equation, q.domain, q.default, q.letter)

    def _parameter(self, q: Quantity) -> Quantity:
        """The parameter of the joint, or the arm's if it has one, with the note of the fit."""
        numbered, note = self._numbered(q), "".join(q.meaning.partition("; ")[1:])
        of_arm = self._arm_parameters.get(numbered.name)
        if of_arm is None:
            return numbered
        return replace(of_arm, meaning=of_arm.meaning + note, default=q.default)

    def _term(self, term: Term) -> Term:
        coefficient, basis = map(self._of_the_arm, (term.coefficient, term.basis))
        name = f"{term.name}_{self._j}"
        return replace(term, name=name, coefficient=coefficient, basis=basis, joint=self._j)


def _gravity(recursion: Recursion) -> tuple[tuple[Definition, ...], tuple[sp.Symbol, ...]]:
    """The gravity torques: definitions in addition to those of the moving chain, and their symbols."""
    at_standstill, torques = at_rest(recursion)
    moving = {d.symbol: d.value for d in recursion.definitions}
    names: dict[sp.Expr, sp.Expr] = {}
    resting = []
    for definition in at_standstill:
        q, value = definition.quantity, definition.value.xreplace(names)
        if value == moving[definition.symbol]:
            continue
        at = quantity(f"{q.name}_rest", q.unit, f"{q.meaning}, at rest", q.equation, q.domain)
        names[q.symbol] = at.symbol
        resting.append(Definition(at, value))
    for j, torque in enumerate(torques):
        at = quantity(f"G_{j}", "N m", f"torque of motor {j} that holds the weight", "(5)")
        resting.append(Definition(at, torque.xreplace(names)))
    return tuple(resting), tuple(d.symbol for d in resting[-len(torques) :])
