"""Signals whose noise is not that of the target: slow motion, and what the model makes of it.

The measured current stands on one side of a balance and inside candidates on the other; noise of the angle
passes through the speed loop into voltage and current. What such a candidate gains in a search may be the
noise of its own signals. Its instrument is the same candidate without that noise: on the speed below the
frequency where the motion ends, and the current and voltage that the fitted model needs for it. An effect
that is there shows in both; noise that comes back through the loop in one.

The angle is that of the fit. Its noise is a small part of a turn, and changes a column over the angle with a
sign that alternates within its period, so that it averages out against the target's; a slower angle would
lose the phase of ripples.

Reference: A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial
robot identification", IEEE Trans. Control Systems Technology 22(1), 2014.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eccentric.diagnosis.search.limits import (
    CLEARLY,
    KEPT_BY_INSTRUMENTS,
    LEAST_MOTION,
    LOWEST_BAND_HZ,
    MOST_LAGS,
    ROWS_FOR_ONE,
)
from eccentric.identification import ColumnRole, FitData, Signals, base_columns, load_torque
from eccentric.model import Model
from eccentric.signals import motion_of

Array = np.ndarray


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
    cut = LOWEST_BAND_HZ
    while cut < channels.rig.sampling.low_pass_hz:
        found, _ = motion_of(channels.time.t, channels.motion.theta_m, channels.time.segment, cut)
        missed = np.sum((found[1] - speed)[rows] ** 2) / np.sum(speed[rows] ** 2)
        if missed < 1.0 - LEAST_MOTION:
            return cut, {"omega_m": found[1], "alpha_m": found[2]}
        cut *= 2.0
    return None


# Are the columns of a candidate free of the target's noise? Least squares against instrumental variables.
#
# The measured current stands on one side of a balance and inside candidates on the other. Least squares
# then takes the noise of the target for the effect; instruments do not. Where the columns are free of that
# noise, as a ripple over the angle is, both estimate the same (the idea of the Durbin-Wu-Hausman test).
# Such a fit may lie below the sensors' noise floor: a ripple faster than the sampling looked like noise to
# the floor.
#
# Reference: J. A. Hausman, "Specification tests in econometrics", Econometrica 46(6), 1978.


def exogenous(target: Array, base: Array, own: Array, instruments: Array) -> bool:
    """Whether instruments find what least squares finds.

    Args:
        target: (rows,) [N m].
        base: (rows, p), what is fitted beside the candidate.
        own: (rows, k), the candidate's columns, with the noise of their signals.
        instruments: (rows, k), the same without it.

    Of the torque that least squares gives the candidate, the instruments must find most, and more than three
    standard errors of it. False where the instruments do not determine the coefficients.
    """
    y, x, z = (_without(base, a) for a in (target[:, None], own, instruments))
    try:
        squares, found = np.linalg.lstsq(x, y, rcond=None)[0], np.linalg.solve(z.T @ x, z.T @ y)
        inverse = np.linalg.inv(z.T @ x)
    except np.linalg.LinAlgError:
        return False
    rest = y - x @ found
    variance = ROWS_FOR_ONE * float(rest[:, 0] @ rest[:, 0]) / len(rest)
    along = x.T @ (x @ squares)  # the estimate that is to be found again, weighted by the torque it makes
    whole = float((squares.T @ along).item())
    if whole <= 0.0:
        return False
    error = float(np.sqrt(variance * (along.T @ inverse @ (z.T @ z) @ inverse.T @ along).item()))
    again = float((found.T @ along).item())
    return again > KEPT_BY_INSTRUMENTS * whole and again > CLEARLY * error


def _without(base: Array, columns: Array) -> Array:
    """The columns without what the base explains of them."""
    return columns - base @ np.linalg.lstsq(base, columns, rcond=None)[0] if base.shape[1] else columns


# How many rows a residual counts as: rows that follow each other repeat a part of what they say.


def inflation(residual: Array, block: Array) -> float:
    """Variance inflation 1 + 2 sum of autocorrelation (Bartlett weights), at least 1.

    Pairs of rows more than one block apart are not counted.
    """
    r = residual - residual.mean()
    variance = float(np.mean(r**2))
    if variance <= 0.0:
        return 1.0
    total = 1.0
    for lag in range(1, min(MOST_LAGS, len(r) - 1) + 1):
        near = block[lag:] - block[:-lag] <= 1
        rho = float(np.sum(r[lag:] * r[:-lag] * near)) / (len(r) * variance)
        total += 2.0 * (1.0 - lag / (MOST_LAGS + 1)) * rho
    return max(1.0, total)


def correlated(residual: Array, block: Array, independent: bool) -> float:
    """How many rows count as one: at least two, since windows overlap by half; one if each row is a run."""
    return 1.0 if independent else max(ROWS_FOR_ONE, inflation(residual, block))
