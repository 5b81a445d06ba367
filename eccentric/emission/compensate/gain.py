"""How much of the friction may be compensated: as much as the fit is sure is there."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from eccentric.core import InputError
from eccentric.emission.adapt import covariance_of_fit, inputs_of
from eccentric.emission.hot import load_module
from eccentric.model import LINEAR, TURNING, Model, regressor, spoken, spoken_quantity
from eccentric.model import vocabulary as v

MOST_WITHOUT_REFERENCE = 0.9
"""The most that may follow a measured velocity or a demanded torque."""
_CONFIDENCE = 0.975
_DRAWS, _ANGLES, _SPEEDS = 20_000, 48, 24
_RANGE = {TURNING: (1.0, 40.0), LINEAR: (0.005, 0.2)}
"""Speeds where a fit states none [rad/s, m/s]."""
_LITTLE = 0.02
"""A friction below this share of its mean is left out: a ratio of two noughts says nothing."""


@dataclass(frozen=True)
class CompensationGain:
    """The gain g, and where it comes from, in words."""

    value: float
    origin: str


def gain_of(model: Model, fit: Mapping[str, Any] | None = None) -> CompensationGain:
    """The ratio of the friction that is there with 97.5 % to the model's, over the whole identified range.

    Of coefficients drawn by the fit's covariance, each draw has its least ratio of friction to the model's,
    over a turn and the speeds of the fit; g is the ratio that 97.5 % of the draws stay above. It is one bound
    of the torque at all states together: coefficients that are uncertain against each other cost nothing.

    Raises:
        InputError: the model has no friction to compensate.
    """
    fit = fit or {}
    columns = regressor(spoken(model))
    rows, values = _states(model, fit)
    friction = rows @ values
    there = friction > _LITTLE * np.mean(np.abs(friction))
    if not there.any():
        raise InputError(f"model {model.name}", "friction to compensate", "none")
    covariance = covariance_of_fit(columns, fit)
    if not covariance.any():
        stated = f"{MOST_WITHOUT_REFERENCE}, since without a fit the uncertainty of the friction is unknown"
        return CompensationGain(MOST_WITHOUT_REFERENCE, stated)
    value = sure_share(rows[there], values, covariance)
    return CompensationGain(
        value, f"{value}: with 97.5 % confidence, friction is nowhere below this share of the model's"
    )


def gravity_apart(model: Model) -> tuple[float, float]:
    """The largest gravity torque over a turn of the link, and the largest that is not the pendulum's [N m].

    A compensation of the friction has neither; the second is that of cogging, a spring or a constant load.
    """
    function = getattr(load_module(model), model.axis.named("gravity_torque"), None)
    if function is None:
        return 0.0, 0.0
    angle = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
    motor_angle = spoken_quantity(model.axis, v.theta_m).name
    given = {motor_angle: angle / _ratio(model), "temperature": np.full_like(angle, 25.0)}
    values = (given.get(name, np.zeros_like(angle)) for name in inputs_of(function))
    torque = np.broadcast_to(function(*values), angle.shape)
    carried = {q.name: q.default for q in model.parameters}
    pendulum = sum(2.0 * np.mean(torque * wave) * wave for wave in (np.sin(angle), np.cos(angle)))
    loaded = carried.get("M") and carried.get("L")
    return float(np.abs(torque).max()), float(np.abs(torque - (pendulum if loaded else 0.0)).max())


def _ratio(model: Model) -> float:
    """mu, 1 where the model has none."""
    return next((float(q.default) for q in model.parameters if q.name == "mu" and q.default is not None), 1.0)


def sure_share(rows: np.ndarray, values: np.ndarray, covariance: np.ndarray) -> float:
    """The share of a friction that is there at every state with 97.5 %, to three decimals, downwards.

    Args:
        rows: of the regressor (m, n), one for each state, with a friction above 0.
        values: of the coefficients (n,).
        covariance: of their errors (n, n).
    """
    squares, axes = np.linalg.eigh(covariance)
    drawn = np.random.default_rng(0).standard_normal((len(values), _DRAWS))
    errors = rows @ (axes * np.sqrt(np.maximum(squares, 0.0)) @ drawn)
    least = 1.0 + np.min(errors / (rows @ values)[:, None], axis=0)
    found = float(np.quantile(least, 1.0 - _CONFIDENCE))
    # Further decimals are of the draws.
    return math.floor(1000.0 * min(max(found, 0.0), 1.0)) / 1000.0


def _states(model: Model, fit: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the regressor by the direction of motion, over a turn and the speeds of the fit; values."""
    axis, module = model.axis, load_module(model)
    ranges = fit.get("ranges")
    given = ranges.get(axis.named("speed_m_rad_s")) if isinstance(ranges, Mapping) else None
    slowest, fastest = given if isinstance(given, list | tuple) and len(given) == 2 else _RANGE[axis]
    slowest = max(slowest, 0.01 * fastest)
    angle = np.linspace(0.0, 2 * math.pi / _ratio(model), _ANGLES, endpoint=False)
    speed = np.geomspace(slowest, fastest, _SPEEDS)
    theta_m, omega_m = (x.ravel() for x in np.meshgrid(angle, np.concatenate((-speed, speed))))
    known = {spoken_quantity(axis, q).name: x for q, x in ((v.theta_m, theta_m), (v.omega_m, omega_m))}
    known["temperature"] = np.full_like(theta_m, 25.0)
    inputs = [known.get(name, np.zeros_like(theta_m)) for name in inputs_of(module.regressor)]
    rows = np.asarray(module.regressor(*inputs)) * np.sign(omega_m)[:, None]
    return rows, np.asarray(module.friction_coefficients(), float)
