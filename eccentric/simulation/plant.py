"""A fitted drive as what is simulated: a law, its parameters, and the torque of a drive signal."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.identification import Drive, Machine, Refit, state_series
from eccentric.logs import column_names, evaluate
from eccentric.model import Model
from eccentric.rigs import ALIGNMENT, STATES, AddedMass, Controller
from eccentric.signals import Channels
from eccentric.simulation.law import Law, value_of
from eccentric.simulation.recording import Recording, recording_of


@dataclass(frozen=True)
class DrivePlant:
    """A drive at the values of its parameters, each a number or (sets, 1)."""

    law: Law  # of its model
    parameters: Mapping[str, Any]  # by name, as the emitted Parameters have them
    gain: Any  # torque on the motor side per unit of the drive signal [N m per V, A or N m]
    damping: Any  # torque that the back-EMF takes per velocity while the motor is on [N m s/rad]
    zero: Any = 0.0  # motor angle of the recording at which the mass hangs straight down [rad]
    offset: Any = 0.0  # drive signal of the recording where none acts
    load: Any = 0.0  # constant torque against positive motion, whether or not the motor is on [N m]

    @property
    def ampere(self) -> Any:
        """The current of a newton metre [A/(N m)], by its parameters."""
        return Machine(self.law.model).current_of_torque(self.parameters, 1.0)

    def carrying(self, added: AddedMass) -> DrivePlant:
        """The same with a mass on the link."""
        machine = Machine(self.law.model)
        sets = max((np.size(x) for x in self.parameters.values()), default=1)
        each = [
            machine.carrying({name: _of_set(x, k) for name, x in self.parameters.items()}, added)
            for k in range(sets)
        ]
        joined = {name: stacked([one[name] for one in each]) for name in each[0]}
        return dataclasses.replace(self, parameters=joined)


def _of_set(x: Any, k: int) -> float:
    return float(np.ravel(x)[k if np.size(x) > 1 else 0])


def stacked(values: Sequence[float]) -> Any:
    """Values of parameter sets as (sets, 1); a number where they are one."""
    return values[0] if len(set(values)) == 1 else np.array(values, float)[:, None]


_OWN = ("gain", "damping", "zero", "offset", "load")
"""Fields of a plant that are numbers."""


def together(plants: Sequence[DrivePlant]) -> DrivePlant:
    """Plants of one law as one plant of as many parameter sets."""

    def joined(values: Sequence[Any]) -> Any:
        return stacked([float(x) for x in values])

    first = plants[0]
    return DrivePlant(
        first.law,
        {name: joined([p.parameters[name] for p in plants]) for name in first.parameters},
        *(joined([getattr(p, name) for p in plants]) for name in _OWN),
    )


def complete(model: Model, values: Mapping[str, float]) -> dict[str, float]:
    """The values of all parameters of a model: what is not among them has its default, by the others.

    What has none does not matter to the log that they were fitted on, and is 0.
    """
    found = {q.name: float(values[q.name]) for q in model.parameters if values.get(q.name) is not None}
    for q in model.parameters:
        if q.name not in found:
            needed = set() if q.default is None else {s.name for s in q.default.free_symbols}
            found[q.name] = (
                float(value_of(q.default, found)) if q.default is not None and needed <= set(found) else 0.0
            )
    return found


def driven(drive: Drive, values: Mapping[str, float], scale: float | None = None) -> tuple[float, float]:
    """The gain and the damping of a plant for parameters and scale of a fit, as `Drive.torque` has them."""
    by, machine = drive.channels.motor.measured_by, drive.machine
    if by == "torque":
        return 1.0, 0.0
    letters = {**dict.fromkeys(machine.back_emf_letters, 0.0), **values, **drive.scaled(scale)}
    if by == "current":
        return float(machine.torque(letters, 1.0)), 0.0
    one, back = (machine.torque(letters, machine.current(letters, *at)) for at in ((1.0, 0.0), (0.0, 1.0)))
    return float(one), -float(back)


def plants_of(fits: Mapping[str, Refit]) -> dict[str, tuple[DrivePlant, Recording]]:
    """The plant of each fitted model, and the log as it sees it; fits of one model share its law."""
    laws: dict[tuple[int, bool], Law] = {}
    found: dict[str, tuple[DrivePlant, Recording]] = {}
    for name, fit in fits.items():
        armature = fit.data.drive.by_voltage and _changes_armature(fit)
        key = id(fit.model), armature
        laws[key] = laws.get(key) or Law(fit.model, armature)
        found[name] = plant_of(fit, laws[key])
    return found


def plant_of(fitted: Refit, law: Law) -> tuple[DrivePlant, Recording]:
    """The plant of a fitted model with this law, and the log as it sees it."""
    drive = fitted.data.drive
    found = {name: fitted.estimates[name].value for name in ALIGNMENT if name in fitted.estimates}
    aligned = drive.aligned(drive.channels.rig, found) if found else drive
    plant = DrivePlant(
        law, complete(fitted.model, fitted.values), *driven(aligned, fitted.values, fitted.scale)
    )
    recording = recording_of(aligned.channels)
    if fitted.model.states:
        states = state_series(fitted.model, fitted.data.signals, fitted.shapes)
        recording = dataclasses.replace(recording, states=states)
    return plant, recording


def _changes_armature(fitted: Refit) -> bool:
    model = fitted.model
    used = {symbol for t in model.balance("electrical").terms for symbol in t.value.free_symbols}
    added = any("electrical" in extension.change.terms for extension in model.extensions)
    return added or not used.isdisjoint(model.replaced.values())


Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class _Along:
    """A signal along the log (n,), and its change from each row to the next."""

    values: Array
    changes: Array

    @classmethod
    def of(cls, values: Array) -> _Along:
        return cls(values, np.diff(values, append=values[-1]))

    def at(self, rows: Integers, part: float) -> Array:
        """Its value at a part of the way from rows to the next ones."""
        return self.values[rows] + part * self.changes[rows]


Entry = Callable[[Integers, float, Array, Array], Any]
"""The value of an entry for rows, part of the way to the next ones, angle and speed."""


class Servo:
    """The controller of a rig, for `integrate`.

    Args:
        controller: of the rig.
        channels: of the log that it is simulated on.
        zero: the motor angle of the log that is 0 in the simulation [rad].

    Raises:
        InputError: a constant has no value for a run; a set point or gain is a condition or no number.
    """

    def __init__(self, controller: Controller, channels: Channels, zero: float) -> None:
        controlled, time = channels.controlled, channels.time
        if controlled is None:
            raise InputError(channels.rig.path, "[controller]", "none")
        self._per_motor, self._zero = controlled.per_motor, zero
        where = channels.rig.path
        constants = controller.constants(time.run_names, where)
        own = {name: np.array(values)[time.run] for name, values in constants.items()}
        self._columns = {name: _Along.of(x) for name, x in {**controlled.columns, **own}.items()}
        self._entries = {
            key: self._entry(
                source, len(time.t), f"{where}: [controller] {key}", controller.factors.get(key, 1.0)
            )
            for key, source in controller.entries.items()
        }

    def signal(self, rows: Integers, part: float, theta_m: Array, omega_m: Array) -> Array:
        """The drive signal, in its unit, for the state of the motor."""
        theta = (theta_m + self._zero) * self._per_motor
        omega = omega_m * self._per_motor
        have = self._entries

        def value(key: str, otherwise: float = 0.0) -> Any:
            return have[key](rows, part, theta, omega) if key in have else otherwise

        found = value("feed_forward")
        if "position_gain" in have:
            found = found + value("position_gain") * (value("set_point") - theta)
        if "speed_gain" in have:
            found = found + value("speed_gain") * (value("set_speed") - omega)
        if "upper" in have:
            found = np.maximum(np.minimum(found, value("upper")), value("lower"))
        return np.asarray(found + 0.0 * theta)

    def _entry(self, source: str | float, rows: int, where: str, factor: float) -> Entry:
        """An entry that does not depend on the state is evaluated along the log, once."""
        if not isinstance(source, str):
            return lambda *_: source * factor
        columns, text = self._columns, source
        if set(STATES).isdisjoint(column_names(text, where)):
            whole = evaluate(text, lambda name: columns[name].values, where, constant=True)
            along = _Along.of(np.broadcast_to(_number(whole, where), (rows,)) * factor)
            return lambda rows, part, *_: along.at(rows, part)

        def at_a_state(rows: Integers, part: float, theta: Array, omega: Array) -> Any:
            states = {"theta": theta, "omega": omega}

            def column(name: str) -> Array:
                return states[name] if name in states else columns[name].at(rows, part)

            return _number(evaluate(text, column, where), where) * factor

        return at_a_state


def _number(value: NDArray[Any], where: str) -> Array:
    if value.dtype == bool:
        raise InputError(where, "a number", "a condition")
    return value


def servo_of(channels: Channels, zero: float) -> Servo | None:
    """The controller of the rig, None where it has none."""
    controller = channels.rig.controller
    return None if controller is None else Servo(controller, channels, zero)
