"""The controller of a rig in a simulation: its drive signal from the set point of the log and the state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.logs import column_names, evaluate
from eccentric.rigs import STATES, Controller
from eccentric.signals import Channels

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
