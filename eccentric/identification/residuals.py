"""The residuals of an emitted model on a log, and its design: the one way from a model to a fit's rows."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.emission import load_module
from eccentric.identification.drive import Drive
from eccentric.identification.machine import Machine
from eccentric.model import Model
from eccentric.signals import Rows

# The emitted module of a model, loaded: what is fitted and scored is what is shipped.


Array = NDArray[np.float64]


class Emitted:
    """The functions of an emitted module, called with the inputs that they require."""

    def __init__(self, model: Model) -> None:
        self._module = load_module(model.with_other_values)
        self.letters = tuple(field.name for field in dataclasses.fields(self._module.Parameters))

    def parameters(self, values: Mapping[str, float]) -> Any:
        """Return the emitted `Parameters` with those values that the model has; others are ignored.

        Raises ValueError if the emitted class refuses a value.
        """
        return self._module.Parameters(**{k: x for k, x in values.items() if k in self.letters})

    def inputs_of(self, function: str) -> tuple[str, ...]:
        """The names of the inputs that a function takes."""
        names = inspect.signature(getattr(self._module, function)).parameters
        return tuple(name for name in names if name not in {"parameters", "out"})

    def __call__(self, function: str, inputs: Mapping[str, Array], parameters: Any) -> Array:
        """Evaluate a function on the inputs (n,) that it takes."""
        return getattr(self._module, function)(*(inputs[n] for n in self.inputs_of(function)), parameters)


class Residuals:
    """The residuals of a model on the samples (n,) and rows (m,) of a log.

    `values` are those for the drive torque, `scale` is that of the drive, None for its own; `states` are the
    hidden states (n,) by name.
    """

    def __init__(
        self,
        model: Model,
        drive: Drive,
        rows: Rows,
        values: Mapping[str, float],
        scale: float | None = None,
        states: Mapping[str, Array] | None = None,
    ) -> None:
        self._model, self._emitted, self._machine = model, Emitted(model), Machine(model)
        self._drive, self._rows = drive, rows
        voltage = drive.signal() if drive.by_voltage else drive.channels.motor.voltage
        self.inputs = drive.inputs | ({} if voltage is None else {"u": voltage})
        self.torque = drive.torque(values, scale)
        self.inputs["i"] = drive.machine.current_of_torque(values, self.torque)
        self.inputs |= {} if states is None else states

    def design(
        self,
        balance: str,
        values: Mapping[str, float],
        unknown: Sequence[tuple[str, ...]],
        current: Array | None = None,
    ) -> tuple[Array, Array]:
        """A balance that is linear in its unknowns: its residual without them (m,), a column for each (m, k).

        A column is what a unit step of the emitted function changes: of a parameter, or of several that are
        the same number. The columns may have a different current from the measured balance.
        """
        start = {**values, **{name: 0.0 for names in unknown for name in names}}
        rest = self.rows(balance, start)
        there = rest if current is None else self.rows(balance, start, current)
        steps = [
            there - self.rows(balance, {**start, **dict.fromkeys(names, 1.0)}, current) for names in unknown
        ]
        return rest, np.column_stack(steps) if steps else np.empty((len(rest), 0))

    def rows(self, balance: str, values: Mapping[str, float], current: Array | None = None) -> Array:
        """The residual of a balance on the rows [N m], optionally with a different current."""
        filtered = self._drive.filtered(balance, self._machine, values)
        return self._rows.once(self.samples(balance, values, current), filtered)

    def samples(self, balance: str, values: Mapping[str, float], current: Array | None = None) -> Array:
        """The same on the samples.

        With voltage alone, the two balances are one: i is the torque from the voltage, so that the electrical
        residual contains only the effects of the armature.
        """
        inputs = self.inputs if current is None else self.inputs | {"i": current}
        found = self._alike(balance, inputs, values)
        for rows, added in self._drive.channels.carried:
            carrying = self._alike(balance, inputs, self._machine.carrying(values, added))
            found = np.where(rows, carrying, found)
        return found

    def _alike(self, balance: str, inputs: Mapping[str, Array], values: Mapping[str, float]) -> Array:
        """A residual on the samples (n,), all of them with the same parameters."""
        parameters = self._emitted.parameters(values)
        found = self._emitted(f"{balance}_residual", inputs, parameters)
        if balance != "mechanical":
            return found
        for names, fast in self._drive.unresolved(self._model, values):
            without = self._emitted.parameters({**values, **dict.fromkeys(names, 0.0)})
            found = np.where(fast, self._emitted("mechanical_residual", inputs, without), found)
        if self._drive.by_voltage:
            armature = self._emitted("electrical_residual", inputs, parameters)
            found = found + np.where(self._drive.off, 0.0, armature)
        return found
