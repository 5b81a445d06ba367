"""A log prepared for fitting: drive, smooth signals, rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.identification.drive import Drive
from eccentric.identification.expressions import (
    Signals,
    base_coefficients,
    base_columns,
    compiled,
    load_torque,
    seen_columns,
)
from eccentric.identification.limits import MOSTLY_OFF
from eccentric.identification.machine import Machine
from eccentric.identification.regression import require_rank
from eccentric.identification.residuals import Residuals
from eccentric.identification.states import state_series
from eccentric.model import Model, meaning
from eccentric.model import vocabulary as v
from eccentric.rigs import Rig
from eccentric.signals import Channels, Rows, rows_of, white_noise, with_doubts

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
        drive = self.drive.narrowed()
        found = fit_data_of(drive, drive.channels.rig, self.signals.base)
        values = {**found.signals.values, "i": self.signals.values["i"]}
        return replace(found, signals=replace(found.signals, values=values))

    def residuals(
        self, model: Model, shapes: Mapping[str, float], values: Values, scale: float | None
    ) -> Residuals:
        """The residuals of a model; `shapes` are those for its hidden states, others as in `Residuals`."""
        states = state_series(model, self.signals, shapes) if model.states else None
        return Residuals(model, self.drive, self.rows, values, scale, states)

    def require_rank(self, model: Model, where: str) -> None:
        """Raise InputError, `where` opening it, if the training rows leave coefficients of a model open."""
        columns = self.rows.mean(base_columns(model, self.signals))[self.rows.train]
        names = [c.name for c in base_coefficients(model, self.signals)]
        with with_doubts(self.drive.channels.intake.findings):
            require_rank(columns, names, where)


def fit_data_of(drive: Drive, rig: Rig, model: Model) -> FitData:
    """Smooth signals that expressions are evaluated on, and the rows that models are compared on.

    The current that effects depend on is (u - k_e omega_m)/R if there is a voltage: measured current on both
    sides of the balance would explain its own noise.
    """
    channels, known = drive.channels, dict(drive.known)
    values = drive.inputs
    if drive.measured_twice and channels.motor.voltage is not None:
        values["u"] = channels.smooth(channels.motor.voltage)
        values["i"] = drive.machine.current(known, values["u"], channels.motion.omega_m)
    else:
        values["i"] = drive.machine.current_of_torque(known, channels.smooth(drive.torque()))
    if drive.scale is not None:
        machine = drive.machine
        absent = dict.fromkeys(machine.back_emf_letters, 0.0) | dict.fromkeys(machine.resistance_letters, 1.0)
        known = absent | known | drive.scaled()
    if drive.by_voltage:
        values["u"] = channels.smooth(drive.signal())
    starts = tuple(int(k) for k in np.flatnonzero(np.r_[True, np.diff(channels.time.segment) != 0]))
    dt = np.diff(channels.time.t, append=channels.time.t[-1] + np.median(np.diff(channels.time.t)))
    if channels.time.one_clock:
        starts = (0,)
    dt[[start - 1 for start in starts if start > 0]] = float(np.median(dt))
    # A mass that only some runs carry loads the bearing there.
    seen = seen_columns(model, {} if drive.channels.carried else known)
    signals = Signals(
        values,
        dt,
        starts,
        known,
        friction=seen,
        base=model,
        bridged=_bridged(channels),
        by_row=Machine(model).along(known, channels.carried),
    )
    gravity, slope = _gravity(model, signals)
    signals = replace(signals, open=drive.columns(gravity, slope))
    return FitData(drive, signals, rows_of(channels, rig), gravity)


def _bridged(channels: Channels) -> dict[int, int]:
    """Steps from the sample before to each one that a window of a long log begins with, inside a run."""
    time = channels.time
    begins = np.flatnonzero(time.skipped[1:] & (np.diff(time.run) == 0)) + 1
    steps = (time.t[begins] - time.t[begins - 1]) / np.median(np.diff(time.t))
    return dict(zip(begins.tolist(), steps.round().astype(int).tolist(), strict=True))


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
