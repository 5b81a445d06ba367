"""A log as it enters the search: signals and rows, both balances, and what the library is made for."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import sympy as sp

from eccentric.effects import Setting
from eccentric.fitting import Drive, FitData, Signals, base_columns, compiled, seen_columns
from eccentric.model import Model
from eccentric.model import vocabulary as v
from eccentric.model.steps import meaning
from eccentric.rigs import Rig
from eccentric.search.smooth import Variables
from eccentric.signals import (
    BalanceDesign,
    Channels,
    Rows,
    balance_design,
    rows_of,
    search_rows,
    smoothed,
    white_noise,
)

__all__ = [
    "balances_of",
    "drive_current",
    "drive_noise",
    "elapsed",
    "fit_data_of",
    "setting_of",
    "variables_of",
    "with_model_current",
]

Array = np.ndarray


def fit_data_of(drive: Drive, rig: Rig, model: Model) -> FitData:
    """Smooth signals that expressions are evaluated on, and the rows that models are compared on.

    The current that effects depend on is (u - k_e omega_m)/R where there is a voltage: measured current on
    both sides of the balance would explain its own noise.
    """
    channels, known = drive.channels, dict(drive.known)
    values = {
        "theta_m": channels.theta_m,
        "omega_m": channels.omega_m,
        "alpha_m": channels.alpha_m,
        "t": elapsed(channels),
    }
    if drive.measured_twice and channels.voltage is not None:
        values["u"] = _smooth(channels, channels.voltage)
        values["i"] = (values["u"] - known["k_e"] * channels.omega_m) / known["R"]
    else:
        values["i"] = _smooth(channels, drive.torque()) / known["k_i"]
    if drive.scale is not None:
        known |= {"k_e": known.get("k_e", 0.0), "R": drive.scale if drive.by_voltage else 1.0}
        known |= {} if drive.by_voltage else {"k_i": 1.0 / drive.scale}
    if drive.by_voltage:
        values["u"] = _smooth(channels, drive.signal())
    if channels.temperature is not None:
        values["temperature"] = channels.temperature
    starts = tuple(int(k) for k in np.flatnonzero(np.r_[True, np.diff(channels.segment) != 0]))
    dt = np.diff(channels.t, append=channels.t[-1] + np.median(np.diff(channels.t)))
    dt[[start - 1 for start in starts if start > 0]] = float(np.median(dt))
    signals = Signals(values, dt, starts, known, friction=seen_columns(model, known), base=model)
    gravity, slope = gravity_of(model, signals)
    signals = replace(signals, open=drive.columns(gravity, slope))
    return FitData(drive, signals, rows_of(channels, rig), gravity)


def with_model_current(data: FitData, model: Model, friction: Array) -> FitData:
    """The data with the current that the first fit asks for.

    Where one signal alone measures the drive, the current from it is that signal: an effect on it would
    explain the drive by the drive, noise and all.
    """
    signals = data.signals
    load = compiled(model, model.balance("mechanical").sum_of("inertial", "gravity", "conservative"), signals)
    torque = load({}, {}) + base_columns(model, signals) @ friction
    return replace(
        data, signals=replace(signals, values={**signals.values, "i": torque / signals.known["k_i"]})
    )


def balances_of(data: FitData, rig: Rig, model: Model) -> tuple[list[BalanceDesign], dict[str, float]]:
    """The balances of the training part, and what white noise leaves in a row of each [N m]."""
    drive, signals, channels = data.drive, data.signals, data.drive.channels
    known, torque = signals.known, drive.torque()
    load = compiled(model, model.balance("mechanical").sum_of("inertial", "gravity", "conservative"), signals)
    target = torque - load({}, {})
    columns = signals.columns(model)
    lower = np.array([-np.inf if c.bounds[0] is None else c.bounds[0] for c in columns])
    lower = np.r_[lower, np.full(len(signals.open), -np.inf)]
    names = (*(c.name for c in columns), *signals.open)
    rows = search_rows(channels, rig)
    mechanical = balance_design(
        "mechanical", rows, target, base_columns(model, signals), names, lower, target
    )
    balances = [_once_filtered(mechanical, channels.alpha_m, known)]
    unseen = np.where(channels.held_out, np.nan, 1.0)
    noise = {"mechanical": _row_noise(unseen * torque, rows)}
    if drive.measured_twice and channels.voltage is not None:
        every = search_rows(channels, rig, moving=False)
        residual = known["k_i"] / known["R"] * (channels.voltage - known["k_e"] * channels.omega_m) - torque
        empty = np.empty((len(torque), 0))
        balances.append(balance_design("electrical", every, residual, empty, (), np.empty(0), target))
        # What the drive really does as quickly as noise is in the torque, and cancels in the residual.
        noise["electrical"] = min(_row_noise(unseen * x, every) for x in (torque, residual))
    return balances, noise


def _row_noise(signal: Array, rows: Rows) -> float:
    """RMS that the white noise of a signal (samples,) leaves in a row; the first stands for all."""
    return white_noise(signal) * float(rows.noise_gain()[0])


def _once_filtered(balance: BalanceDesign, alpha: Array, known: Mapping[str, float]) -> BalanceDesign:
    """The balance with the acceleration as it is: it comes from the low-passed angle."""
    rows = balance.rows
    if rows.smooth is None:
        return balance
    own = rows.plain_mean(alpha)
    inertia = known["J_m"] + known["mu"] ** 2 * known["J_l"]
    base = balance.base.copy()
    if "J_m" in balance.base_names:
        base[:, balance.base_names.index("J_m")] = own
    return replace(balance, target=balance.target + inertia * (rows.mean(alpha) - own), base=base)


def gravity_of(model: Model, signals: Signals) -> tuple[Array, Array]:
    """Gravity torque of the model on the motor side (samples,) [N m], its slope over the link angle."""
    torque = meaning(model.expand(model.balance("mechanical").sum_of("gravity")))
    slope = sp.diff(torque, v.theta_m.symbol) / v.mu.symbol
    return compiled(model, torque, signals)({}, {}), compiled(model, slope, signals)({}, {})


def setting_of(data: FitData, model: Model, friction: Array) -> Setting:
    """What the ranges of the library depend on, from the moving training rows."""
    signals, channels = data.signals, data.drive.channels
    rows = channels.fit_rows
    speed = np.abs(channels.omega_m[rows])
    current = signals.values["i"]
    columns = signals.columns(model)
    own = friction[: len(columns)]
    torque = base_columns(model, signals)[:, : len(columns)] @ own
    loss = np.mean((torque * channels.omega_m)[rows])
    if "R" in signals.known and channels.drive != "torque":
        loss += np.mean(signals.known["R"] * current[rows] ** 2)
    warm = channels.temperature
    present = {"current"} if channels.drive != "voltage" else set()
    present |= {"voltage"} if data.drive.measured_twice else set()
    # What the armature does, a voltage shows in the torque that it makes.
    present |= {"current", "voltage"} if data.drive.by_voltage else set()
    present |= {"temperature"} if warm is not None else set()
    highest = float(np.quantile(speed, 0.99))
    return Setting(
        base=model,
        mu=signals.known["mu"],
        known=dict(signals.known),
        w_min=max(0.5 * float(np.quantile(speed, 0.002)), highest / 400),
        w_max=highest,
        current_max=float(np.quantile(np.abs(current[rows]), 0.995)),
        duration_s=float(np.max(elapsed(channels))),
        mean_loss_W=max(float(loss), 1e-12),
        temperature_mid=None if warm is None else float(np.median(warm[rows])),
        channels=frozenset(present),
        friction={c.name: float(x) for c, x in zip(columns, own, strict=True)},
        by_voltage=data.drive.by_voltage,
        scaled=data.drive.scale is None and channels.drive in {"current", "voltage"},
        left_open=tuple(sorted({*data.drive.open, *channels.rig.estimate})),
    )


def variables_of(data: FitData) -> Variables:
    """What a residual of the log may depend on."""
    channels = data.drive.channels
    return Variables(
        t=channels.t,
        # Angles of several runs that were integrated from the speed have no common zero.
        theta_m=channels.theta_m if channels.phased else None,
        omega_m=channels.omega_m,
        alpha_m=channels.alpha_m,
        gravity=data.gravity,
        mu=data.signals.known["mu"],
        current=drive_current(data),
        voltage=data.signals.values.get("u"),
        temperature=channels.temperature,
        averaged=math.isinf(channels.rig.average_over),
    )


def drive_current(data: FitData) -> Array:
    """The current (samples,) [A] that what is smooth may depend on: measured where a voltage tells it too."""
    drive = data.drive
    if drive.measured_twice:
        return _smooth(drive.channels, drive.signal())
    return data.signals.values["i"]


def _smooth(channels: Channels, x: Array) -> Array:
    """A channel (samples,) after the low pass that the angle has passed."""
    return smoothed(channels.t, channels.segment, x, channels.rig.low_pass_hz)


def elapsed(channels: Channels) -> Array:
    """Time since the start of each row's run [s]."""
    start = np.array([channels.t[channels.run == run][0] for run in range(int(channels.run.max()) + 1)])
    return channels.t - start[channels.run]


def drive_noise(data: FitData) -> float:
    """RMS that the white noise of the measured drive leaves in a row, from its fourth differences."""
    drive = data.drive
    sigma = white_noise(drive.torque(), drive.channels.segment)
    # An average of rows has less of it; the one in the middle stands for all.
    return sigma * float(np.sqrt(np.median(data.rows.noise_gain() ** 2)))
