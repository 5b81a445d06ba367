"""A log as the search sees it: signals and rows, both balances, and the setting of the library."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import median_filter

from eccentric.diagnosis.search import limits
from eccentric.diagnosis.search.candidate import Variables
from eccentric.diagnosis.search.crossval import unexplained
from eccentric.effects import CURRENT_DELAYS_S, HIGHEST_ORDER, Setting
from eccentric.identification import (
    BalanceDesign,
    ColumnRole,
    FitData,
    Signals,
    balance_design,
    base_coefficients,
    base_columns,
    deceleration_noise,
    load_torque,
)
from eccentric.model import Model
from eccentric.rigs import Rig
from eccentric.signals import Channels, Rows, motion_of, search_rows, white_noise

Array = np.ndarray


def standing_orders(
    theta_m: Array, omega_m: Array, residual: Array, harmonics: Sequence[float], gravity: Sequence[float]
) -> tuple[float, tuple[float, ...]]:
    """The range of the motor angle in turns, and the orders of friction that stand out, the strongest first.

    Harmonics of motor and link are taken out, since on a short log they spread over the spectrum. That leaves
    nothing within a cycle of each, which over a few turns is everywhere. So the strongest order of all comes
    first, a harmonic or not: only the first orders of the link, which gravity leaves, are taken out for it.
    Over a few turns peaks are so wide that what is taken out shifts them, and each order is fitted beside it.

    Args:
        theta_m, omega_m: motor angle [rad], from one zero, and velocity [rad/s] (samples,).
        residual: what the model does not explain (samples,) [N m].
        harmonics: orders of motor and link.
        gravity: those of them that gravity leaves where its load is not quite the model's; friction at them
            is taken out as well.
    """
    if not len(theta_m):
        return 0.0, ()
    turns = _turns(theta_m)
    if not 1.0 < turns < limits.MOST_TURNS:
        return turns, ()
    if turns < limits.FEW_TURNS:
        strongest = _best_fit(theta_m, omega_m, residual, gravity)
    else:
        orders, power = _spectrum(theta_m, omega_m, residual, gravity)
        strongest = _peaks(orders, power, turns, np.ones(len(orders), bool))[:1]
    orders, power = _spectrum(theta_m, omega_m, residual, harmonics)
    # Within a cycle of a harmonic there is nothing left, not even noise, and it would lower the floor.
    beside = np.min(np.abs(orders[:, None] - np.asarray(harmonics)), axis=1) > 1.0 / turns
    others = _peaks(orders, power, turns, beside)
    return turns, (*strongest, *others)


def _turns(theta_m: Array) -> float:
    return float(np.ptp(theta_m)) / (2.0 * np.pi)


def _spectrum(
    theta_m: Array, omega_m: Array, residual: Array, without: Sequence[float]
) -> tuple[Array, Array]:
    """Orders, and the power of friction at each over that of white noise.

    Friction at an order nu is c cos(nu theta_m) + s sin(nu theta_m) against the motion, whatever the time:
    the residual times the direction is put into bins of the angle, and their sums have one spectrum. A peak
    is as narrow as the range of the angle is long, so that neighbouring orders stay apart.
    """
    angle = (theta_m - np.min(theta_m)) / (2.0 * np.pi)
    against = np.sign(omega_m) * unexplained(_known(theta_m, omega_m, without), residual)
    bins = np.bincount((angle * limits.BINS_PER_TURN).astype(int), against)
    power = np.abs(np.fft.rfft(bins, limits.PADDED * len(bins))) ** 2
    return np.arange(len(power)) * limits.BINS_PER_TURN / (limits.PADDED * len(bins)), power / np.sum(
        against**2
    )


def _best_fit(theta_m: Array, omega_m: Array, residual: Array, without: Sequence[float]) -> list[float]:
    """The order whose friction takes out most beside what is taken out, if it stands out of what is left.

    It has a cycle or more over the log. The residual is averaged in bins of the angle, either way by itself:
    at a sampled time the motion may always be at the same few angles.
    """
    turns, way = _turns(theta_m), np.sign(omega_m)
    place = ((theta_m - np.min(theta_m)) / (2.0 * np.pi) * limits.BINS_PER_TURN).astype(int) * 2 + (way > 0.0)
    number = np.bincount(place)
    there = number > 0
    angle, speed, mean = (np.bincount(place, x)[there] / number[there] for x in (theta_m, omega_m, residual))
    weight, way = np.sqrt(number[there])[:, None], np.where(np.flatnonzero(there) % 2, 1.0, -1.0)[:, None]
    orders = np.arange(limits.PADDED, HIGHEST_ORDER * limits.PADDED * turns) / (limits.PADDED * turns)
    waves = [weight * way * np.column_stack([np.cos(nu * angle), np.sin(nu * angle)]) for nu in orders]
    known, target = weight * _known(angle, speed, without), weight[:, 0] * mean
    gains, _ = _gains(waves, known, target)
    best = int(np.argmax(gains))
    # A wide peak has no floor beside it: that of the spectrum without it is taken.
    rest, noise = _gains(waves, np.hstack([known, waves[best]]), target)
    around = rest[np.abs(orders - orders[best]) <= 0.5 * limits.AROUND_A_PEAK]
    return (
        [float(orders[best])] if gains[best] > limits.STANDS_OUT * max(np.median(around), 2.0 * noise) else []
    )


def _gains(waves: Sequence[Array], known: Array, target: Array) -> tuple[Array, float]:
    """The square sum that each pair of waves takes out of a target (n,) beside what is known (n, k).

    And the mean square of what that leaves, which is white noise if nothing else is there.
    """
    basis = np.linalg.qr(known)[0]
    left = target - basis @ (basis.T @ target)
    found = np.zeros(len(waves))
    for k, pair in enumerate(waves):
        own = pair - basis @ (basis.T @ pair)
        found[k] = left @ own @ np.linalg.lstsq(own, left, rcond=None)[0]
    return found, float(left @ left) / max(len(left) - known.shape[1], 1)


def _known(theta_m: Array, omega_m: Array, without: Sequence[float]) -> Array:
    """Offset, Coulomb and viscous friction, and friction and torque at some orders (samples, k)."""
    way = np.sign(omega_m)
    waves = [wave(order * theta_m) for order in without for wave in (np.cos, np.sin)]
    return np.column_stack([way, omega_m, np.ones_like(way), *waves, *(wave * way for wave in waves)])


def _peaks(orders: Array, power: Array, turns: float, where: Array) -> list[float]:
    """The orders that stand out of those around them, and of white noise; the strongest first."""
    one = round(1.0 / orders[1])
    orders, power = orders[where], power[where]
    around = median_filter(power, 2 * round(0.5 * limits.AROUND_A_PEAK * one) + 1, mode="nearest")
    found: list[float] = []
    rest = np.where(power > limits.STANDS_OUT * np.maximum(around, 1.0), power, 0.0)
    while len(found) < limits.MOST_PEAKS and np.any(rest):
        k = int(np.argmax(rest))
        found.append(float(orders[k]))
        rest[np.abs(orders - orders[k]) < 2.0 / turns] = 0.0
    return found


def balances_of(data: FitData, rig: Rig, model: Model) -> tuple[list[BalanceDesign], dict[str, float]]:
    """The balances of the training part, and the white noise that remains in a row of each [N m]."""
    drive, signals, channels = data.drive, data.signals, data.drive.channels
    known, torque = signals.known, drive.torque()
    target = torque - load_torque(model, signals)
    coefficients, columns = base_coefficients(model, signals), base_columns(model, signals)
    rows, filtered = search_rows(channels, rig), drive.filtered("mechanical", drive.machine, known)
    mechanical = balance_design("mechanical", rows, coefficients, target, columns, target, filtered)
    # What the rig leaves open is as good as known, whatever its sign.
    balances = [mechanical.without_bounds(but=("friction",))]
    unseen = np.where(channels.selection.held_out, np.nan, 1.0)
    noise = {"mechanical": _row_noise(unseen * torque, rows)}
    if channels.motor.coasting:
        noise["mechanical"] = deceleration_noise(drive, rows)
    if drive.measured_twice and channels.motor.voltage is not None:
        every = search_rows(channels, rig, moving=False)
        by_voltage = drive.machine.current(known, channels.motor.voltage, channels.motion.omega_m)
        residual = drive.machine.torque(known, by_voltage) - torque
        empty = np.empty((len(torque), 0))
        filtered = drive.filtered("electrical", drive.machine, known)
        balances.append(balance_design("electrical", every, (), residual, empty, target, filtered))
        # Real torque as fast as noise is in the target, but cancels in the residual, at the current's lag.
        known_torque, target_seen = residual + torque, unseen * torque
        shifted = (unseen * known_torque - _ahead(target_seen, channels, lag) for lag in _lags(channels))
        matched = min(shifted, key=lambda left: float(np.nanmean(left**2)))
        left = target_seen, unseen * residual, matched
        noise["electrical"] = min(_row_noise(x, every) for x in left)
    return balances, noise


def _lags(channels: Channels) -> list[int]:
    """Lags of the measured current to try, in rows: those that `sensor_delay` knows."""
    first, last = (lag / channels.time.logged_step_s for lag in CURRENT_DELAYS_S)
    return sorted({round(lag) for lag in np.linspace(first, last, limits.LAGS)})


def _ahead(signal: Array, channels: Channels, lag: int) -> Array:
    """A signal (samples,) as it would be without its lag in rows; NaN where the segment ends before."""
    place = np.arange(len(signal)) + lag
    inside = np.clip(place, 0, len(signal) - 1)
    same = (inside == place) & (channels.time.segment[inside] == channels.time.segment)
    return np.where(same, signal[inside], np.nan)


def _row_noise(signal: Array, rows: Rows) -> float:
    """RMS of the white noise of a signal (samples,) that remains in a row; the first row represents all."""
    return white_noise(signal) * float(rows.noise_gain()[0])


def setting_of(data: FitData, model: Model, friction: Array) -> Setting:
    """What the ranges of the library depend on, from the moving training rows."""
    signals, channels = data.signals, data.drive.channels
    rows = channels.selection.fit_rows
    speed = np.abs(channels.motion.omega_m[rows])
    current = signals.values["i"]
    if not np.any(current[rows]):  # the model has no torque at all: the drive as measured is the scale
        current = data.drive.machine.current_of_torque(signals.known, data.drive.torque())
    columns = signals.columns(model)
    own = friction[: len(columns)]
    torque = base_columns(model, signals)[:, : len(columns)] @ own
    loss = np.mean((torque * channels.motion.omega_m)[rows])
    if "R" in signals.known and channels.motor.measured_by != "torque":
        loss += np.mean(signals.known["R"] * current[rows] ** 2)
    warm = channels.temperature
    present = {"current"} if channels.motor.measured_by != "voltage" else set()
    present -= {"current"} if channels.motor.coasting else set()
    present |= {"voltage"} if data.drive.measured_twice else set()
    # With a voltage alone, effects of the armature show in the torque computed from it.
    present |= {"current", "voltage"} if data.drive.by_voltage else set()
    present |= {"temperature"} if warm is not None else set()
    # A joint of an arm has a load on its bearing, and open bodies leave these of each joint open.
    along, bodies, force = data.drive.along, set[str](), 0.0
    if along is not None:
        bodies = {"inertia", "gravity", "theta_zero_rad"} if along.open else bodies
        force = float(np.mean(along.signals[along.force][rows])) if along.force else force
    highest = float(np.quantile(speed, limits.TOP_SPEED))
    turns, orders = float(np.ptp(channels.motion.theta_m[rows])) / (2.0 * np.pi), ()
    # Orders are per turn of the motor: the position of a carriage has none.
    if channels.phased and model.axis.wraps:
        left = data.drive.torque() - load_torque(model, signals) - base_columns(model, signals) @ friction
        angle, turning = channels.motion.theta_m, channels.motion.omega_m
        mu = signals.known["mu"]
        harmonics = sorted(
            {
                *(n * mu for n in range(1, limits.LINK_ORDERS + 1)),
                *map(float, range(1, limits.MOTOR_ORDERS + 1)),
            }
        )
        gravity = [n * mu for n in range(1, limits.GRAVITY_ORDERS + 1)]
        _, orders = standing_orders(angle[rows], turning[rows], left[rows], harmonics, gravity)
    return Setting(
        base=model,
        mu=signals.known["mu"],
        known=dict(signals.known),
        w_min=max(
            limits.SLOWEST_PART * float(np.quantile(speed, limits.SLOWEST)), highest / limits.SPEED_RANGE
        ),
        w_max=highest,
        current_max=float(np.quantile(np.abs(current[rows]), limits.TOP_CURRENT)),
        duration_s=float(np.max(channels.time.elapsed)),
        mean_loss_W=max(float(loss), limits.LEAST_LOSS_W),
        mean_square_A2=float(np.mean(current[rows] ** 2)),
        temperature_mid=None if warm is None else float(np.median(warm[rows])),
        channels=frozenset(present),
        friction={c.name: float(x) for c, x in zip(columns, own, strict=True)},
        by_voltage=data.drive.by_voltage,
        scaled=data.drive.scale is None and channels.motor.measured_by in {"current", "voltage"},
        masses=bool(channels.carried),
        left_open=tuple(sorted({*(c.role for c in data.drive.open), *channels.rig.estimate, *bodies})),
        mean_force=force,
        turns=turns,
        orders=orders,
        lines=channels.lines,
    )


def variables_of(data: FitData, instruments: Signals | None = None) -> Variables:
    """What a residual of the log may depend on; with the instruments of the same, where there are any."""
    channels = data.drive.channels
    own = Variables(
        t=channels.time.t,
        # Angles integrated from the speed have no zero common to several runs.
        theta_m=channels.motion.theta_m if channels.phased and _shows_the_angle(data) else None,
        omega_m=channels.motion.omega_m,
        alpha_m=channels.motion.alpha_m,
        gravity=data.gravity,
        mu=data.signals.known["mu"],
        current=_drive_current(data),
        voltage=data.signals.values.get("u"),
        temperature=channels.temperature,
        averaged=math.isinf(channels.rig.sampling.average_over),
    )
    if instruments is None:
        return own
    slow = instruments.values
    clean = replace(
        own,
        omega_m=slow["omega_m"],
        alpha_m=slow["alpha_m"],
        current=None if own.current is None else slow["i"],
        voltage=slow.get("u"),
    )
    return replace(own, instruments=clean)


def _shows_the_angle(data: FitData) -> bool:
    """Whether something turns with the motion by a known gear, and within a row by less than a turn.

    Not where the pitch of a screw is unknown, nor in the long rows of a coast-down.
    """
    channels = data.drive.channels
    if channels.motor.coasting:
        turned = np.median(np.abs(channels.motion.omega_m)) * channels.rig.sampling.average_over
        return bool(turned < 2.0 * np.pi)
    return channels.rig.axis.wraps or "pitch" in channels.rig.known


def _drive_current(data: FitData) -> Array | None:
    """The current (samples,) [A] that smooth terms may depend on: measured if there is a voltage as well.

    None of a coast-down, which has none.
    """
    drive = data.drive
    if drive.channels.motor.coasting:
        return None
    if drive.measured_twice:
        return drive.slow_current()
    return data.signals.values["i"]


# Signals whose noise is not that of the target: slow motion, and what the model makes of it.
#
# The measured current stands on one side of a balance and inside candidates on the other; noise of the angle
# passes through the speed loop into voltage and current. What such a candidate gains in a search may be the
# noise of its own signals. Its instrument is the same candidate without that noise: on the speed below the
# frequency where the motion ends, and the current and voltage that the fitted model needs for it. An effect
# that is there shows in both; noise that comes back through the loop in one.
#
# The angle is that of the fit. Its noise is a small part of a turn, and changes a column over the angle with
# a sign that alternates within its period, so that it averages out against the target's; a slower angle
# would lose the phase of ripples.
#
# Reference: A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial
# robot identification", IEEE Trans. Control Systems Technology 22(1), 2014.
def instruments_of(data: FitData, model: Model, friction: Array) -> Signals | None:
    """The signals of a log from its motion alone; None where its rows average all noise away.

    friction: (columns,) coefficients of a first fit of the base model, in SI units.
    """
    channels, signals = data.drive.channels, data.signals
    motion = None if data.rows.independent else _slow_motion(data)
    if motion is None:
        return None
    cut, motion = motion
    along = None if data.drive.along is None else data.drive.along.narrowed(cut)
    values = {**signals.values, **motion, **({} if along is None else along.signals)}
    # What the rig leaves open follows the same motion: an open inertia would bring the noise back.
    slowly: dict[ColumnRole, Array] = {
        "inertia": motion["alpha_m"],
        "back_emf": np.where(data.drive.off, 0.0, motion["omega_m"]),
    }
    free = {c: slowly.get(c.role, column) for c, column in signals.open.items()}
    free |= {} if along is None else dict(along.open)
    slow = replace(signals, values=values, open=free)
    torque = channels.smooth(load_torque(model, slow) + base_columns(model, slow) @ friction)
    values["i"] = data.drive.machine.current_of_torque(signals.known, torque)
    if "u" in values:
        values["u"] = data.drive.machine.voltage(signals.known, values["i"], values["omega_m"])
    return replace(signals, values=values, open=free)


def _slow_motion(data: FitData) -> tuple[float, dict[str, Array]] | None:
    """The least frequency [Hz] that holds the motion; speed and acceleration (samples,) below it."""
    channels = data.drive.channels
    rows, speed = channels.selection.fit_rows, channels.motion.omega_m
    cut = limits.LOWEST_BAND_HZ
    while cut < channels.rig.sampling.low_pass_hz:
        found, _ = motion_of(channels.time.t, channels.motion.theta_m, channels.time.segment, cut)
        missed = np.sum((found[1] - speed)[rows] ** 2) / np.sum(speed[rows] ** 2)
        if missed < 1.0 - limits.LEAST_MOTION:
            return cut, {"omega_m": found[1], "alpha_m": found[2]}
        cut *= 2.0
    return None
