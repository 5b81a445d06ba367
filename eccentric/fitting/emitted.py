"""The emitted module of a model on the samples and rows of a log."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eccentric.emission import load_module
from eccentric.fitting.drive import Drive
from eccentric.fitting.expressions import Signals
from eccentric.fitting.states import state_series
from eccentric.model import Model
from eccentric.signals import Rows

__all__ = ["Emitted", "FitData", "Values"]

Array = np.ndarray
Values = dict[str, float]


@dataclass(frozen=True)
class FitData:
    """A log as models are fitted on it: drive, smooth signals, rows; gravity torque (samples,) [N m]."""

    drive: Drive
    signals: Signals
    rows: Rows
    gravity: Array


class Emitted:
    """The emitted module of a model on the samples of a log, for given values of what is searched."""

    def __init__(
        self, model: Model, data: FitData, shapes: Mapping[str, float], known: Values, scale: float | None
    ) -> None:
        self.module, self.data = load_module(model), data
        self.drive, signals, channels = data.drive, data.signals, data.drive.channels
        torque = self.drive.torque(known, scale)
        given: dict[str, Array | None] = {
            "theta_m": channels.theta_m,
            "omega_m": channels.omega_m,
            "alpha_m": channels.alpha_m,
            "i": torque / known["k_i"],
            "u": self.drive.signal() if self.drive.by_voltage else channels.voltage,
            "temperature": channels.temperature,
            "t": signals.values["t"],
        }
        self.inputs = {name: x for name, x in given.items() if x is not None}
        if model.states:
            self.inputs |= state_series(model, signals, dict(shapes))

    def residual(self, balance: str, values: Mapping[str, float], current: Array | None = None) -> Array:
        """The emitted residual of a balance on the rows [N m], with another current if given."""
        rows, found = self.data.rows, self.samples(balance, values, current)
        if balance != "mechanical" or rows.smooth is None:
            return rows.mean(found)
        # The acceleration comes from the low-passed angle: it is not to pass the filter twice.
        alpha = self.drive.channels.alpha_m
        inertia = values["J_m"] + self.data.signals.known["mu"] ** 2 * values["J_l"]
        return rows.mean(found) + inertia * (rows.mean(alpha) - rows.plain_mean(alpha))

    def samples(self, balance: str, values: Mapping[str, float], current: Array | None = None) -> Array:
        """The same on the samples.

        Where voltage alone drives, the two balances are one: i is the torque that the voltage leaves, so that
        the electrical residual holds nothing but the effects of the armature.
        """
        inputs = self.inputs if current is None else self.inputs | {"i": current}
        found = self._call(f"{balance}_residual", values, inputs)
        if balance == "mechanical" and self.drive.by_voltage:
            found = found + np.where(self.drive.off, 0.0, self._call("electrical_residual", values, inputs))
        return found

    def _call(self, name: str, values: Mapping[str, float], inputs: Mapping[str, Array]) -> Array:
        function = getattr(self.module, name)
        names = [n for n in inspect.signature(function).parameters if n not in {"parameters", "out"}]
        return function(*(inputs[n] for n in names), self.module.Parameters(**values))
