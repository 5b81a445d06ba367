"""The residuals of a model on a log, from its emitted module."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from eccentric.fitting.emitted import Emitted
from eccentric.fitting.fit_data import FitData
from eccentric.fitting.machine import Machine
from eccentric.fitting.states import state_series
from eccentric.model import Model

__all__ = ["Residuals", "Values"]

Array = NDArray[np.float64]
Values = dict[str, float]


class Residuals:
    """The residuals of a model on the samples and rows of a log.

    `values` are those for the drive torque, `scale` is that of the drive, `shapes` are those for the hidden
    states.
    """

    def __init__(
        self, model: Model, data: FitData, shapes: Mapping[str, float], values: Values, scale: float | None
    ) -> None:
        self.data = data
        self._emitted, self._machine = Emitted(model), Machine(model)
        self._drive, signals, channels = data.drive, data.signals, data.drive.channels
        torque = self._drive.torque(values, scale)
        given: dict[str, Array | None] = {
            "theta_m": channels.motion.theta_m,
            "omega_m": channels.motion.omega_m,
            "alpha_m": channels.motion.alpha_m,
            "i": self._drive.machine.current_of_torque(values, torque),
            "u": self._drive.signal() if self._drive.by_voltage else channels.motor.voltage,
            "temperature": channels.temperature,
            "t": signals.values["t"],
        }
        self.inputs = {name: x for name, x in given.items() if x is not None}
        if model.states:
            self.inputs |= state_series(model, signals, dict(shapes))

    def rows(self, balance: str, values: Mapping[str, float], current: Array | None = None) -> Array:
        """The residual of a balance on the rows [N m], optionally with a different current."""
        rows, found = self.data.rows, self.samples(balance, values, current)
        if balance != "mechanical" or rows.smooth is None:
            return rows.mean(found)
        # The acceleration comes from the low-passed angle and must not be filtered twice.
        alpha = self._drive.channels.motion.alpha_m
        inertia = self._machine.inertia({**self.data.signals.known, **values})
        return rows.mean(found) + inertia * (rows.mean(alpha) - rows.plain_mean(alpha))

    def samples(self, balance: str, values: Mapping[str, float], current: Array | None = None) -> Array:
        """The same on the samples.

        With voltage alone, the two balances are one: i is the torque from the voltage, so that the electrical
        residual contains only the effects of the armature.
        """
        inputs = self.inputs if current is None else self.inputs | {"i": current}
        parameters = self._emitted.parameters(values)
        found = self._emitted(f"{balance}_residual", inputs, parameters)
        if balance == "mechanical" and self._drive.by_voltage:
            armature = self._emitted("electrical_residual", inputs, parameters)
            found = found + np.where(self._drive.off, 0.0, armature)
        return found
