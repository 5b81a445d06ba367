"""The drive torque of a log, and what the rig leaves open about the bench.

    current, k_i known                 torque = k_i i
    torque signal                      torque = tau
    voltage, or current without k_i    torque = (x - x_0 - k_e w)/s,  s = R/k_i [V/(N m)] or 1/k_i [A/(N m)]
    motor switched off                 torque = 0

Inertia, scale (through gravity), back-EMF (if free motion separates it from viscous friction), offset and a
constant load stay free in every model that is tried: each of them has these columns, so that no effect is
adopted for compensating a slightly wrong description of the bench.  Without a scale in the log s is 1, and
the result is in the unit of the drive.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.effects import constant_load, with_constant_load
from eccentric.identification.limits import LEAST_RESOLVED
from eccentric.identification.regression import Coefficient, ColumnRole
from eccentric.model import Model, Term, function_of, meaning
from eccentric.model import vocabulary as v
from eccentric.rigs import AddedMass, Rig
from eccentric.signals import Channels, Filtered

Array = NDArray[np.float64]

# Motor, armature and inertia as numbers: the balances of the model, solved and evaluated.

Values = Mapping[str, float]
Carried = Sequence[tuple[NDArray[np.bool_], AddedMass]]
"""Masses that some runs carry, each with its rows (n,)."""


def evaluated(expression: sp.Expr, given: Mapping[str, Any]) -> Any:
    """An expression at values or arrays (n,) of its inputs and parameters, by name.

    Raises KeyError if one is missing.
    """
    function, arguments = function_of(meaning(expression))
    return function(*(given[name] for name in arguments))


class Machine:
    """What the balances of a model say about its motor, armature and inertia.

    `values` are parameters by the paper's letters, in SI units; signals are arrays (n,) or numbers. A letter
    that an expression needs and that is not among them is a KeyError.
    """

    def __init__(self, model: Model) -> None:
        self._model = model

    def torque(self, values: Values, current: Any) -> Any:
        """Motor torque [N m] of a current [A]: the drive term of the mechanical balance, k_i i."""
        return evaluated(self._drive, {**values, "i": current})

    def current_of_torque(self, values: Values, torque: Any) -> Any:
        """The current [A] for a motor torque [N m]."""
        return torque / evaluated(self._torque_constant, values)

    def current(self, values: Values, voltage: Any, omega_m: Any) -> Any:
        """The current [A] from the electrical balance, (u - k_e omega_m)/R."""
        return evaluated(self._armature, {**values, "u": voltage, "omega_m": omega_m})

    def voltage(self, values: Values, current: Any, omega_m: Any) -> Any:
        """The voltage [V] of a current, from the electrical balance, R i + k_e omega_m."""
        return evaluated(self._voltage, {**values, "i": current, "omega_m": omega_m})

    @cached_property
    def back_emf_damping(self) -> sp.Expr:
        """Damping by the back-EMF, in parameters [N m s/rad]: k_i k_e/R."""
        return -sp.diff(self._drive.xreplace({v.i.symbol: self._armature}), v.omega_m.symbol)

    def damping(self, values: Values) -> float:
        """Torque that the back-EMF takes per speed [N m s/rad]: k_i k_e/R."""
        return float(evaluated(self.back_emf_damping, values))

    @cached_property
    def torque_letters(self) -> frozenset[str]:
        """The parameters that the torque of a current is proportional to: k_i."""
        return self._factors("mechanical", "drive")

    @cached_property
    def resistance_letters(self) -> frozenset[str]:
        """The parameters that the resistive voltage is proportional to: R."""
        return self._factors("electrical", "resistive")

    @cached_property
    def back_emf_letters(self) -> frozenset[str]:
        """The parameters that the back-EMF is proportional to: k_e."""
        return self._factors("electrical", "back_emf")

    def _factors(self, balance: str, kind: str) -> frozenset[str]:
        """The parameters that the terms of a derivation are proportional to, and that are not of a body."""
        model = self._model
        added = {t.name for e in model.extensions for terms in e.change.terms.values() for t in terms}
        terms = (t for t in model.balance(balance).terms if t.kind == kind and t.name not in added)
        own = model.expand(sp.Add(*(term.value for term in terms)))
        body = model.expand(model.balance("mechanical").sum_of("inertial", "gravity"))
        letters = {q.symbol for q in model.parameters} & (own.free_symbols - body.free_symbols)
        return frozenset(x.name for x in letters if sp.expand(sp.diff(own, x) * x - own) == 0)

    @property
    def absent(self) -> dict[str, float]:
        """Values for parameters without effect on a log: the emitted functions require numbers."""
        one = dict.fromkeys(self.torque_letters | self.resistance_letters, 1.0)
        return one | dict.fromkeys((*self.back_emf_letters, *self.inertias), 0.0)

    @property
    def inertia_letters(self) -> frozenset[str]:
        """The parameters of the inertia: J_m, J_l, mu."""
        return frozenset(symbol.name for symbol in self._model.inertia.free_symbols)

    @cached_property
    def inertias(self) -> tuple[str, ...]:
        """The inertias that the total is linear in, J_m, J_l; those without a default first."""
        slopes = self._inertia_slopes.items()
        return tuple(name for name, slope in slopes if name not in {s.name for s in slope.free_symbols})

    @cached_property
    def rotor(self) -> str:
        """The parameter of the inertia on the motor's side, J_m: one of it is one of the total."""
        return next(name for name in self.inertias if self._inertia_slopes[name] == 1)

    @cached_property
    def link(self) -> str:
        """The parameter of the inertia behind the gear, J_l, in which the total is linear; "" if none.

        Also "" where a correction scales the whole inertia: then no parameter is the rotor alone.
        """
        rotors = [name for name in self.inertias if self._inertia_slopes[name] == 1]
        return next((name for name in self.inertias if rotors and name not in rotors), "")

    def inertia(self, values: Values) -> float:
        """The total inertia at the motor [kg m^2]: J_m + mu^2 J_l."""
        return float(evaluated(self._model.inertia, values))

    def inertia_along(self, values: Values, carried: Carried) -> Any:
        """The same along a log with masses that some runs carry: a number without any, else (n,)."""
        found: Any = self.inertia(values)
        for rows, added in carried:
            found = np.where(rows, self.inertia(self.carrying(values, added)), found)
        return found

    def carrying(self, values: Values, added: AddedMass) -> dict[str, float]:
        """The values with a mass on the link; what is relative to a declared value remains a part of that."""
        whole = {**values, **added.on(values)}
        parts = {
            q.name: values[q.name] * self.part(q.part_of, values, whole)
            for q in self._model.parameters
            if q.part_of is not None and values.get(q.name)
        }
        return whole | parts

    def part(self, declared: sp.Symbol, values: Values, whole: Values) -> float:
        """A declared quantity over the same with more mass; 1 where both are 0."""
        own, all_of_it = (float(evaluated(self._model.expand(declared), given)) for given in (values, whole))
        return own / all_of_it if all_of_it else 1.0

    def along(self, values: Values, carried: Carried) -> dict[str, Array]:
        """What differs along a log where some runs carry more mass: parameter -> (n,); nothing without."""
        found: dict[str, Array] = {}
        for rows, added in carried:
            for name, value in self.carrying(values, added).items():
                before = values.get(name, 0.0)
                if value != before:
                    found[name] = np.where(rows, value, found.get(name, before))
        return found

    def inertia_per(self, letter: str, values: Values) -> float:
        """Its derivative by one of them: 1, mu^2."""
        return float(evaluated(self._inertia_slopes[letter], values))

    def shared(self, values: Values, rotor: float) -> dict[str, float]:
        """The inertias of the same total with a known rotor: what is left of it is the link's, 0 at least."""
        beyond = self.inertia(values) - self.inertia({**values, self.rotor: rotor, self.link: 0.0})
        return {self.rotor: rotor, self.link: max(beyond / self.inertia_per(self.link, values), 0.0)}

    @cached_property
    def _drive(self) -> sp.Expr:
        return self._model.expand(self._model.balance("mechanical").sum_of("drive"))

    @cached_property
    def _torque_constant(self) -> sp.Expr:
        return sp.diff(self._drive, v.i.symbol)

    @cached_property
    def _armature(self) -> sp.Expr:
        return self._model.expand(self._model.balance("electrical").solved_for(v.i.symbol))

    @cached_property
    def _voltage(self) -> sp.Expr:
        return self._model.expand(self._model.balance("electrical").solved_for(v.u.symbol))

    @cached_property
    def _inertia_slopes(self) -> dict[str, sp.Expr]:
        inertia = self._model.inertia
        own = [q for q in self._model.parameters if q.symbol in inertia.free_symbols]
        own.sort(key=lambda q: q.default is not None)
        return {q.name: sp.diff(inertia, q.symbol) for q in own}


# What a joint meets along a log from outside its own motor: the loads of its bearing, and the other joints.
#
# A single link has none of it: its loads follow from its own angle and velocity.
@dataclass(frozen=True)
class MetAlong:
    """Signals of a log (n,) that a model takes as inputs besides the motion of its motor."""

    signals: Mapping[str, Array]  # by the name of the input, in SI units
    # the sum of those that the drive has to supply, motor side [N m]: they come from filtered
    # angles and must not pass the low pass twice
    torque: Array
    force: str = ""  # name of the signal that is the normal force on the bearing [N]; "" for none
    # what the rig leaves open of the bodies, coefficient -> column of torque, from the same angles
    open: Mapping[Coefficient, Array] = field(default_factory=dict)
    below: Callable[[float], MetAlong] | None = None  # the same with all angles below another cut-off [Hz]

    def narrowed(self, cut_hz: float) -> MetAlong:
        """The same with all angles below a cut-off."""
        return self if self.below is None else self.below(cut_hz)


# Rows where a torque repeats faster than a log can show.
#
# The balance of a drive holds at every instant, but a log has its acceleration from sampled angles, which
# have nothing above half of the log's rate. A torque that repeats faster, and the current that goes with
# it, alias to slow ones that the acceleration never had: such rows neither show the torque nor contradict
# it.
def unresolved(
    terms: Sequence[Term], values: Mapping[str, float], omega_m: NDArray[np.float64], step_s: float
) -> list[tuple[tuple[str, ...], NDArray[np.bool_]]]:
    """The coefficients of terms that repeat faster than half of the log's rate, with the samples where.

    The fastest come first. Where a slower one is too fast, they are as well: each entry has the coefficients
    of those before it, and its samples (n,) are among theirs. A term without such a sample has none.

    values: of the parameters in `Term.per_turn`; omega_m: (n,) [rad/s]; step_s: of the log [s].
    """
    own: dict[float, list[str]] = {}
    for term in terms:
        if term.per_turn != 0:
            often = float(evaluated(sp.sympify(term.per_turn), values))
            own.setdefault(often, []).append(str(term.coefficient))
    found, names = [], []
    for often in sorted(own, reverse=True):
        names = [*names, *own[often]]
        mask = np.abs(omega_m) * often * step_s > np.pi
        if np.any(mask):
            found.append((tuple(names), mask))
    return found


NO_BACK_EMF = "0 by convention: R, k_e or k_i is not known"
"""The remark of k_e where the parameters give no voltage."""
PER_INERTIA = "rad/s^2"
"""The unit of a torque over the inertia, where a coast-down has none declared."""
DRIVE_UNITS = {"torque": "N m", "current": "A", "voltage": "V"}
"""The unit of each signal that measures the drive."""
LOAD = constant_load.coefficients[0].name
"""The parameter of a constant load on the link: not an effect to be found, but part of the base model."""


def in_drive_unit(unit: str, drive: str) -> str:
    """The unit of a fitted parameter where torques are in volts or amperes; without a torque, its own.

    Args:
        unit: as if torques were in newton metres: of a torque, of friction per load ("m"), or of an inertia.
        drive: the unit of torques, "N m", "V" or "A"; the scale of the latter is one.
    """
    if drive == "N m":
        return unit
    if drive == PER_INERTIA:
        unit = {"N m s/rad": "1/s", "N m s^2/rad^2": "1/rad", "N m s^3/rad^3": "s/rad^2", "kg m^2": "1"}.get(
            unit, unit
        )
    loaded = {
        "m": f"{drive}/N",
        "m s/rad": f"{drive} s/(N rad)",
        "kg m^2": f"{drive} s^2/rad",
        "1/(N m)": f"1/{drive}",
    }
    return loaded.get(unit, re.sub(r"^N m(?![A-Za-z])", drive, unit))


@dataclass(frozen=True)
class Drive:
    """The drive of the rig."""

    machine: Machine  # motor, armature and inertia of the base model
    channels: Channels  # with delay, zero angle and offset as identified
    # value of every parameter that is no friction coefficient, known or identified, SI units; k_i
    # is 1 N m/A where a voltage determines R/k_i alone
    known: Mapping[str, float]
    scale: float | None  # s, None if the torque is measured
    unit: str  # of torques: "N m", or "V" or "A" if nothing in the log determines the scale
    # the free columns, by their roles: those of a parameter of the model (inertia, load) and those
    # outside it (gravity, back_emf, offset, zero_angle)
    open: tuple[Coefficient, ...] = ()
    # what a free gravity column changes: the scale, or L, M or phi known by a range. The column is
    # bounded by the range that the rig gives it, of phi in cos(phi).
    adjusts: str = ""
    identified: tuple[str, ...] = ()  # letters that were estimated from the log, for the report
    warnings: tuple[str, ...] = ()  # of the first fit
    # inertia of the motor if the rig knows it, and that of the link has to be estimated [kg m^2]
    rotor: float | None = None
    # what a joint of a chain meets besides the motion of its motor; None for a single link
    along: MetAlong | None = None

    @property
    def placeholders(self) -> set[str]:
        """Letters of the motor that are neither declared nor identified: their values stand for nothing."""
        machine = self.machine
        motor = machine.torque_letters | machine.resistance_letters | machine.back_emf_letters
        return set(motor - set(self.channels.rig.known) - set(self.identified))

    def opens(self, role: ColumnRole) -> bool:
        """Whether a column of this role is free."""
        return any(c.role == role for c in self.open)

    def with_gravity(self, values: Mapping[str, float], factor: float) -> dict[str, float]:
        """The letter that gravity adjusts, for a gravity torque that is larger by a factor."""
        value = values[self.adjusts]
        if self.adjusts != "phi":
            return {self.adjusts: value * factor}
        return {"phi": math.acos(min(max(math.cos(value) * factor, 0.0), 1.0))}

    @property
    def inputs(self) -> dict[str, Array]:
        """Motion, time, temperature and what a joint of a chain meets, (n,) by the inputs of a model."""
        return inputs_of(self.channels) | ({} if self.along is None else dict(self.along.signals))

    def narrowed(self) -> Drive:
        """The same with the angle after a lower low pass, and those of the other joints as well."""
        channels = self.channels.narrowed(self.channels.rig)
        along = None if self.along is None else self.along.narrowed(channels.rig.sampling.low_pass_hz)
        return replace(self, channels=channels, along=along)

    @property
    def later(self) -> Drive | None:
        """The same with the current sampled one standard error later in its row; None if that is known."""
        channels = self.channels.later
        return None if channels is None else replace(self, channels=channels)

    def aligned(self, rig: Rig, values: Mapping[str, float]) -> Drive:
        """The same with another delay, zero angle or offset, by the names of the rig."""
        alignment = replace(self.channels.alignment, **values)
        return replace(self, channels=self.channels.realigned(rig, alignment))

    def unresolved(
        self, model: Model, values: Mapping[str, float]
    ) -> list[tuple[tuple[str, ...], NDArray[np.bool_]]]:
        """Coefficients of a model's torques that repeat too fast for the log, with the samples where.

        None with a voltage alone: the torque comes from it, and has all that it has at the sampled angles. An
        order that hardly a row of the fit resolves is left as it is: nothing else would determine it.
        """
        if self.by_voltage:
            return []
        channels, given = self.channels, {**self.known, **values}
        found = unresolved(
            model.balance("mechanical").terms, given, channels.motion.omega_m, channels.time.logged_step_s
        )
        shown = [float(np.mean(~fast[channels.selection.fit_rows])) > LEAST_RESOLVED for _, fast in found]
        left = {name for (names, _), kept in zip(found, shown, strict=True) if not kept for name in names}
        return [
            (tuple(name for name in names if name not in left), fast)
            for (names, fast), kept in zip(found, shown, strict=True)
            if kept
        ]

    @property
    def emitted_unit(self) -> str:
        """The unit of torques in what is emitted: of a coast-down without an inertia, N m at 1 kg m^2."""
        return "N m" if self.unit == PER_INERTIA else self.unit

    @property
    def by_voltage(self) -> bool:
        """Whether the torque comes from the voltage alone."""
        return self.scale is not None and self.channels.motor.measured_by == "voltage"

    @property
    def back_emf_in_friction(self) -> bool:
        """Whether the log does not separate the back-EMF from viscous friction."""
        known = self.machine.back_emf_letters <= set(self.known)
        return self.by_voltage and not known and not self.opens("back_emf")

    @property
    def current_known(self) -> bool:
        """Whether a current of the model is in amperes: a voltage alone needs k_i or R, and a scale."""
        known = set(self.channels.rig.known)
        declared = self.machine.torque_letters <= known or self.machine.resistance_letters <= known
        return not self.by_voltage or (declared and self.unit == "N m")

    @property
    def voltage_known(self) -> bool:
        """Whether a voltage of the model is in volts: a current requires R and k_e, a torque k_i too."""
        letters = self.machine.resistance_letters | self.machine.back_emf_letters
        if self.channels.motor.measured_by == "torque":
            letters |= self.machine.torque_letters
        return self.by_voltage or letters <= set(self.channels.rig.known)

    @property
    def off(self) -> NDArray[np.bool_]:
        """Rows (n,) with the motor switched off."""
        return self.channels.motor.off

    @property
    def measured_twice(self) -> bool:
        """Whether voltage and current are both logged: then one gives the current for the other's balance."""
        motor = self.channels.motor
        return self.scale is None and motor.measured_by == "current" and motor.voltage is not None

    def signal(self) -> Array:
        """The measured drive (n,): volts, amperes or newton metres."""
        return np.where(self.off, 0.0, self.channels.motor.measured)

    def slow_current(self) -> Array:
        """The measured current (n,) [A] below the low pass, for a search; a fit has it as logged.

        Times a ripple of the torque constant near the Nyquist frequency, its own ripple of that order would
        make a slow torque that is not there. The slow torque that the two do have is given up as well: half
        their product, the part in phase, which inertia keeps small where the ripple is faster than the loop.
        """
        return self.channels.smooth(self.signal())

    def scaled(self, scale: float | None = None) -> dict[str, float]:
        """The motor that the scale represents, or another scale.

        By a voltage R = scale k_i, with k_i as known; where only R is known, k_i follows.
        """
        scale = self.scale if scale is None else scale
        if scale is None:
            return {}
        if not self.by_voltage:
            return dict.fromkeys(self.machine.torque_letters, 1.0 / scale)
        constants = {name: self.known.get(name, 1.0) for name in self.machine.torque_letters}
        resistance = scale * float(self.machine.torque(constants, 1.0))
        declared, (first, *others) = self.channels.rig.known, self.machine.resistance_letters
        if first in declared and not others and not set(constants) & set(declared):
            constants = {name: x * declared[first] / resistance for name, x in constants.items()}
            resistance = declared[first]
        return constants | dict.fromkeys(self.machine.resistance_letters, resistance)

    def filtered(self, balance: str, machine: Machine, values: Mapping[str, float]) -> list[Filtered]:
        """What of a balance follows the angle, and so has passed its low pass.

        In the electrical balance it is the back-EMF. In the mechanical one it is what accelerates the drive,
        its inertia by a model and the other bodies of a chain; and the back-EMF, where the torque comes from
        the voltage alone.
        """
        motion = self.channels.motion
        if balance == "electrical":
            return [Filtered(self.machine.damping(values), motion.omega_m)]
        found = [] if self.along is None else [Filtered(1.0, self.along.torque)]
        inertia = machine.inertia_along(values, self.channels.carried)
        found.append(Filtered(inertia, motion.alpha_m, motion.theta_logged))
        if self.by_voltage and not self.back_emf_in_friction:
            found.append(Filtered(self.machine.damping(values), self.channels.turning))
        return found

    def torque(self, known: Mapping[str, float] | None = None, scale: float | None = None) -> Array:
        """The drive torque (n,) [N m], optionally for different values of k_e and scale."""
        signal = self.signal()
        if self.channels.motor.measured_by == "torque":
            return signal
        # Without k_e, what is viscous includes the back-EMF.
        none = dict.fromkeys(self.machine.back_emf_letters, 0.0)
        letters = {**none, **(self.known if known is None else known), **self.scaled(scale)}
        if self.by_voltage:
            signal = self.machine.current(letters, signal, self.channels.motion.omega_m)
        return np.where(self.off, 0.0, self.machine.torque(letters, signal))

    def driven_by(self, known: Mapping[str, float] | None = None, scale: float | None = None) -> Array:
        """What a model explains (n,) [N m]: the drive torque, or what the inertia of a coast-down gives."""
        if not self.channels.motor.coasting:
            return self.torque(known, scale)
        inertia = self.machine.inertia({**self.machine.absent, **self.known, **(known or {})})
        return -inertia * self.channels.motion.alpha_m

    def columns(self, gravity: Array, slope: Array) -> dict[Coefficient, Array]:
        """The free columns (n,) of the balance J alpha + G + f = torque.

        gravity (n,) [N m] and its slope over the link angle (n,) [N m/rad].
        """
        driven, motion = np.where(self.off, 0.0, 1.0), self.channels.motion
        made: dict[ColumnRole, Array] = {
            "inertia": motion.alpha_m,
            "load": np.full_like(driven, load_gain(self.channels.rig)),
            "gravity": gravity,
            "back_emf": motion.omega_m * driven,
            "offset": driven,
            "zero_angle": -slope,
        }
        return {c: made[c.role] for c in self.open} | ({} if self.along is None else dict(self.along.open))


def inputs_of(channels: Channels) -> dict[str, Array]:
    """Motion, time and temperature (n,) by the names of a model's inputs."""
    motion = channels.motion
    found = {
        "theta_m": motion.theta_m,
        "omega_m": motion.omega_m,
        "alpha_m": motion.alpha_m,
        "t": channels.time.elapsed,
    }
    return found if channels.temperature is None else found | {"temperature": channels.temperature}


def loaded_model(base: Model, rig: Rig) -> Model:
    """The model, extended by a constant load if the rig has one."""
    declared = LOAD in rig.known or LOAD in rig.unknown
    return with_constant_load(base, rig.known.get(LOAD, 0.0)) if declared else base


def load_gain(rig: Rig) -> float:
    """The torque at the motor per newton metre of load: mu, if it is known; 1 for a load on a carriage."""
    if rig.axis.model:
        return 1.0
    (term,) = constant_load.change.terms["mechanical"]
    return float(evaluated(term.basis, {"mu": 1.0, **rig.known}))
