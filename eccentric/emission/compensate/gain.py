"""How much of the friction may be compensated: as much as the fit is sure is there."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from eccentric.core import InputError
from eccentric.emission.adapt import covariance_of_fit, regressor_rows
from eccentric.emission.hot import load_module
from eccentric.model import LINEAR, TURNING, Model, regressor, spoken

MOST_WITHOUT_REFERENCE = 0.9
"""The most that may follow a measured velocity or a demanded torque."""
_CONFIDENCE = 0.975
_DRAWS, _SPEEDS = 20_000, 24
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
    axis, ranges = model.axis, fit.get("ranges")
    given = ranges.get(axis.named("speed_m_rad_s")) if isinstance(ranges, Mapping) else None
    slowest, fastest = given if isinstance(given, list | tuple) and len(given) == 2 else _RANGE[axis]
    slowest = max(slowest, 0.01 * fastest)
    speed = np.geomspace(slowest, fastest, _SPEEDS)
    rows, omega_m = regressor_rows(model, np.concatenate((-speed, speed)))
    values = np.asarray(load_module(model).friction_coefficients(), float)
    return rows * np.sign(omega_m)[:, None], values
