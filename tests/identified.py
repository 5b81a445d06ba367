"""Whether a fit has found what a rig is."""

from __future__ import annotations

from eccentric.identification import Refit

FILTERED = 1e-3
"""Relative: what a low pass of 25 Hz and a spline at 125 Hz take from an acceleration of 2 Hz and less."""


def is_found(fitted: Refit, name: str, truth: float, bias: float = 0.0) -> bool:
    """Whether an estimate lies within three standard errors of the truth, and what the filter takes."""
    estimate = fitted.estimates[name]
    return abs(estimate.value - truth) <= 3.0 * estimate.std_error + bias * abs(truth)


def inertia(fitted: Refit, mu: float) -> float:
    """J_m + mu^2 J_l of the fit."""
    return fitted.values["J_m"] + mu**2 * fitted.values["J_l"]
