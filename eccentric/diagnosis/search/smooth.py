"""Smooth terms: splines and Fourier sums in each variable of the diagnosis.

They compete with the physical candidates in the same cross-validation: no physical effect explains what they
still remove from a residual.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from eccentric.diagnosis.search.candidate import Candidate
from eccentric.diagnosis.search.limits import KNOTS, LINK_ORDERS, MOTOR_ORDERS, NO_RANGE, PIECES, RIDGE
from eccentric.effects import Evidence

Array = np.ndarray


@dataclass(frozen=True)
class Variables:
    """What a residual may depend on: smooth signals (samples,), None where a log has none.

    t: time in the run [s]; theta_m, omega_m, alpha_m: of the motor, theta_m None where the angles of several
    runs have no common zero; current [A]; voltage [V]; temperature [degC]; gravity: its torque on the motor
    side [N m]; mu: gear ratio; averaged: whether a row is the mean of a whole run, which has no time, and
    only the acceleration between its ends; instruments: the same without the noise of the target.
    """

    t: Array
    theta_m: Array | None
    omega_m: Array
    alpha_m: Array
    gravity: Array
    mu: float
    current: Array | None = None
    voltage: Array | None = None
    temperature: Array | None = None
    averaged: bool = False
    instruments: Variables | None = None


def smooth_terms(variables: Variables, balance: str, valid: Array) -> list[Candidate]:
    """Empirical terms of a balance, one family "smooth:<variable>" each.

    valid (samples,): those that any window uses.
    """
    clean = variables.instruments
    instruments = {} if clean is None else _terms(clean, balance, valid)
    return [
        Candidate(
            id=f"smooth:{name}",
            family=f"smooth:{name}",
            balance=balance,
            evidence=Evidence((name,)),
            columns=lambda _, columns=columns: columns,
            instrument=None if clean is None else lambda _, columns=instruments[name]: columns,
            ridge=RIDGE,
        )
        for name, columns in _terms(variables, balance, valid).items()
        if columns.shape[1]
    ]


def _terms(variables: Variables, balance: str, valid: Array) -> dict[str, Array]:
    """Columns (samples, k) by variable. Even and odd parts are both there: times sgn w, one is friction."""
    omega = variables.omega_m
    sign = np.sign(omega)[:, None]

    def both(columns: Array) -> Array:
        return np.hstack([columns, columns * sign])

    terms: dict[str, Array] = {
        "velocity": _spline(np.abs(omega), PIECES["velocity"], valid) * sign,
        "direction": np.hstack([np.ones_like(sign), _spline(np.abs(omega), PIECES["direction"], valid)]),
    }
    if not variables.averaged:
        elapsed = variables.t - variables.t[0]
        slope = _spline(elapsed, PIECES["slope"], valid) * omega[:, None]
        terms["acceleration"] = _spline(variables.alpha_m, PIECES["acceleration"], valid)
        terms["time"] = np.hstack([both(_spline(elapsed, PIECES["time"], valid)), slope])
    if variables.theta_m is not None:
        terms["motor_angle"] = _fourier(variables.theta_m, range(1, MOTOR_ORDERS + 1))
    if balance == "mechanical":
        if variables.theta_m is not None:
            terms["link_angle"] = both(_fourier(variables.mu * variables.theta_m, range(1, LINK_ORDERS + 1)))
        if np.any(variables.gravity):
            terms["gravity_load"] = both(_spline(variables.gravity, PIECES["gravity_load"], valid))
    if variables.current is not None:
        terms["current"] = _spline(variables.current, PIECES["current"], valid)
    if variables.voltage is not None and balance == "electrical":
        terms["voltage"] = _spline(variables.voltage, PIECES["voltage"], valid)
    if variables.temperature is not None:
        warm = _spline(variables.temperature, PIECES["temperature"], valid)
        terms["temperature"] = np.hstack([warm, warm * sign, warm * omega[:, None]])
    return terms


def _spline(x: Array, pieces: int, valid: Array) -> Array:
    """Cubic B-splines of x, (samples, pieces + 2): the constant is left out.

    Half of the knots are at quantiles, half are evenly spaced within the 0.2 to 99.8 % range of the valid
    samples: a log dwells at few speeds, and what happens between them counts as well.
    """
    low, high = np.quantile(x[valid], KNOTS)
    share = np.linspace(0.0, 1.0, pieces + 1)
    knots = 0.5 * (np.clip(np.quantile(x[valid], share), low, high) + low + (high - low) * share)
    if high - low <= NO_RANGE * max(1.0, abs(low), abs(high)):
        return np.empty((len(x), 0))
    full = np.r_[[knots[0]] * 3, knots, [knots[-1]] * 3]
    return BSpline.design_matrix(np.clip(x, knots[0], knots[-1]), full, 3).toarray()[:, 1:]


def _fourier(angle: Array, orders: Sequence[int]) -> Array:
    return np.column_stack([f(n * angle) for n in orders for f in (np.cos, np.sin)])
