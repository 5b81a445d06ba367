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

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.effects import constant_load, with_constant_load
from eccentric.identification.limits import LEAST_RESOLVED
from eccentric.identification.machine import Machine, evaluated
from eccentric.identification.regression import Coefficient, ColumnRole
from eccentric.model import Model, Term
from eccentric.rigs import Rig
from eccentric.signals import Channels, Filtered

# What a joint meets along a log from outside its own motor: the loads of its bearing, and the other joints.
#
# A single link has none of it: its loads follow from its own angle and velocity.


Array = NDArray[np.float64]


@dataclass(frozen=True)
class MetAlong:
    """Signals of a log (n,) that a model takes as inputs besides the motion of its motor.

    Attributes:
        signals: by the name of the input, in SI units.
        torque: the sum of those that the drive has to supply, motor side [N m]: they come from filtered
            angles and must not pass the low pass twice.
        force: name of the signal that is the normal force on the bearing [N]; "" for none.
        open: what the rig leaves open of the bodies, coefficient -> column of torque, from the same angles.
        below: the same with all angles below another cut-off [Hz].
    """

    signals: Mapping[str, Array]
    torque: Array
    force: str = ""
    open: Mapping[Coefficient, Array] = field(default_factory=dict)
    below: Callable[[float], MetAlong] | None = None

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
        unit = {
            "N m s/rad": "1/s",
            "N m s^2/rad^2": "1/rad",
            "N m s^3/rad^3": "s/rad^2",
            "kg m^2": "1",
        }.get(unit, unit)
    loaded = {
        "m": f"{drive}/N",
        "m s/rad": f"{drive} s/(N rad)",
        "kg m^2": f"{drive} s^2/rad",
        "1/(N m)": f"1/{drive}",
    }
    return loaded.get(unit, re.sub(r"^N m(?![A-Za-z])", drive, unit))


@dataclass(frozen=True)
class Drive:
    """The drive of the rig.

    Attributes:
        machine: motor, armature and inertia of the base model.
        channels: with delay, zero angle and offset as identified.
        known: value of every parameter that is no friction coefficient, known or identified, SI units; k_i is
            1 N m/A where a voltage determines R/k_i alone.
        scale: s, None if the torque is measured.
        unit: of torques: "N m", or "V" or "A" if nothing in the log determines the scale.
        open: the free columns, by their roles: those of a parameter of the model (inertia, load) and those
            outside it (gravity, back_emf, offset, zero_angle).
        adjusts: the letter that a free gravity column changes: the scale, or L, M or phi known by a range; of
            phi the column is bounded, in cos(phi).
        identified: letters that were estimated from the log, for the report.
        warnings: of the first fit.
        rotor: inertia of the motor if the rig knows it, and that of the link has to be estimated [kg m^2].
        along: what a joint of a chain meets besides the motion of its motor; None for a single link.
    """

    machine: Machine
    channels: Channels
    known: Mapping[str, float]
    scale: float | None
    unit: str
    open: tuple[Coefficient, ...] = ()
    adjusts: str = ""
    identified: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    rotor: float | None = None
    along: MetAlong | None = None

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

        In the mechanical balance it is what accelerates the drive, its inertia by a model and the other
        bodies of a chain; in the electrical one the back-EMF.
        """
        motion = self.channels.motion
        if balance == "electrical":
            return [Filtered(self.machine.damping(values), motion.omega_m)]
        inertia = machine.inertia_along(values, self.channels.carried)
        bodies = [] if self.along is None else [Filtered(1.0, self.along.torque)]
        return [*bodies, Filtered(inertia, motion.alpha_m, motion.theta_logged)]

    def back_emf(self, values: Mapping[str, float]) -> list[Filtered]:
        """The same of a torque: that from the voltage alone has the back-EMF in it."""
        return [Filtered(self.machine.damping(values), self.channels.turning)] if self.by_voltage else []

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
