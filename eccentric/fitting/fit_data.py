"""A log prepared for fitting: the drive, smooth signals that expressions are evaluated on, and rows."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.fitting.drive import Drive
from eccentric.fitting.expressions import Signals, base_columns, compiled, seen_columns
from eccentric.model import Model, meaning
from eccentric.model import vocabulary as v
from eccentric.rigs import Rig
from eccentric.signals import Rows, rows_of, white_noise

__all__ = ["FitData", "drive_noise", "fit_data_of", "with_model_current"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FitData:
    """Drive, smooth signals, rows; gravity torque (samples,) [N m]."""

    drive: Drive
    signals: Signals
    rows: Rows
    gravity: Array


def fit_data_of(drive: Drive, rig: Rig, model: Model) -> FitData:
    """Smooth signals that expressions are evaluated on, and the rows that models are compared on.

    The current that effects depend on is (u - k_e omega_m)/R if there is a voltage: measured current on both
    sides of the balance would explain its own noise.
    """
    channels, known = drive.channels, dict(drive.known)
    values = {
        "theta_m": channels.motion.theta_m,
        "omega_m": channels.motion.omega_m,
        "alpha_m": channels.motion.alpha_m,
        "t": channels.time.elapsed,
    }
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
    if channels.temperature is not None:
        values["temperature"] = channels.temperature
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
    load = compiled(model, model.balance("mechanical").sum_of("inertial", "gravity", "conservative"), signals)
    torque = load({}, {}) + base_columns(model, signals) @ friction
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
