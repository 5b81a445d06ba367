"""A log prepared for fitting: drive, smooth signals, rows; and the residuals of a model on it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.estimation import require_rank
from eccentric.fitting.drive import Drive, inputs_of
from eccentric.fitting.emitted import Emitted
from eccentric.fitting.expressions import (
    Signals,
    base_coefficients,
    base_columns,
    compiled,
    load_torque,
    seen_columns,
)
from eccentric.fitting.limits import MOSTLY_OFF
from eccentric.fitting.machine import Machine
from eccentric.fitting.states import state_series
from eccentric.model import Model, meaning
from eccentric.model import vocabulary as v
from eccentric.rigs import Rig
from eccentric.signals import Rows, rows_of, white_noise

__all__ = ["FitData", "Residuals", "Values", "drive_noise", "fit_data_of", "with_model_current"]

Array = NDArray[np.float64]
Values = dict[str, float]


@dataclass(frozen=True)
class FitData:
    """Drive, smooth signals, rows; gravity torque (samples,) [N m]."""

    drive: Drive
    signals: Signals
    rows: Rows
    gravity: Array

    @property
    def off(self) -> NDArray[np.bool_]:
        """Rows (m,) with the motor off: they have no voltage or current to be compared in."""
        return self.rows.plain_mean(self.drive.off.astype(float)) > MOSTLY_OFF

    @property
    def narrowed(self) -> FitData | None:
        """The same log below a lower cut-off, with the current that effects use; None without a low pass."""
        coarse = self.drive.channels.time.points_per_row > 1
        if self.rows.smooth is None or self.signals.base is None or coarse:
            return None
        channels = self.drive.channels.narrowed(self.drive.channels.rig)
        found = fit_data_of(replace(self.drive, channels=channels), channels.rig, self.signals.base)
        values = {**found.signals.values, "i": self.signals.values["i"]}
        return replace(found, signals=replace(found.signals, values=values))

    def require_rank(self, model: Model, where: str) -> None:
        """Raise InputError, `where` opening it, if the training rows leave coefficients of a model open."""
        columns = self.rows.mean(base_columns(model, self.signals))[self.rows.train]
        require_rank(columns, [c.name for c in base_coefficients(model, self.signals)], where)


def fit_data_of(drive: Drive, rig: Rig, model: Model) -> FitData:
    """Smooth signals that expressions are evaluated on, and the rows that models are compared on.

    The current that effects depend on is (u - k_e omega_m)/R if there is a voltage: measured current on both
    sides of the balance would explain its own noise.
    """
    channels, known = drive.channels, dict(drive.known)
    values = inputs_of(channels)
    if drive.measured_twice and channels.motor.voltage is not None:
        values["u"] = channels.smooth(channels.motor.voltage)
        values["i"] = drive.machine.current(known, values["u"], channels.motion.omega_m)
    else:
        values["i"] = drive.machine.current_of_torque(known, channels.smooth(drive.torque()))
    if drive.scale is not None:
        known |= {"k_e": known.get("k_e", 0.0), "R": drive.scale if drive.by_voltage else 1.0}
        known |= {} if drive.by_voltage else {"k_i": 1.0 / drive.scale}
    if drive.by_voltage:
        values["u"] = channels.smooth(drive.signal())
    starts = tuple(int(k) for k in np.flatnonzero(np.r_[True, np.diff(channels.time.segment) != 0]))
    dt = np.diff(channels.time.t, append=channels.time.t[-1] + np.median(np.diff(channels.time.t)))
    dt[[start - 1 for start in starts if start > 0]] = float(np.median(dt))
    signals = Signals(values, dt, starts, known, friction=seen_columns(model, known), base=model)
    gravity, slope = _gravity(model, signals)
    signals = replace(signals, open=drive.columns(gravity, slope))
    return FitData(drive, signals, rows_of(channels, rig), gravity)


def with_model_current(data: FitData, model: Model, friction: Array) -> FitData:
    """The data with the current that the first fit predicts.

    If only one signal measures the drive, its current is that signal: an effect of it would explain the drive
    by itself, including its noise.
    """
    signals = data.signals
    torque = load_torque(model, signals) + base_columns(model, signals) @ friction
    current = data.drive.machine.current_of_torque(signals.known, torque)
    return replace(data, signals=replace(signals, values={**signals.values, "i": current}))


def _gravity(model: Model, signals: Signals) -> tuple[Array, Array]:
    """Gravity torque of the model on the motor side (samples,) [N m], its slope over the link angle."""
    torque = meaning(model.expand(model.balance("mechanical").sum_of("gravity")))
    slope = sp.diff(torque, v.theta_m.symbol) / v.mu.symbol
    return compiled(model, torque, signals)({}, {}), compiled(model, slope, signals)({}, {})


def drive_noise(data: FitData) -> float:
    """RMS that the white noise of the measured drive leaves in a row, from its fourth differences."""
    drive = data.drive
    sigma = white_noise(drive.torque(), drive.channels.time.segment)
    # An average of rows has less of it; the median one represents all.
    return sigma * float(np.sqrt(np.median(data.rows.noise_gain() ** 2)))


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
        voltage = self._drive.signal() if self._drive.by_voltage else channels.motor.voltage
        self.inputs = inputs_of(channels) | ({} if voltage is None else {"u": voltage})
        self.inputs["i"] = self._drive.machine.current_of_torque(values, torque)
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
