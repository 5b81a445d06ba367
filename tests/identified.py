"""A log prepared for a fit, and whether a fit has found what a rig is."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.identification import FitData, Refit, drive_of, fit_data_of
from eccentric.logs import read_log
from eccentric.model import Model, load_model
from eccentric.rigs import read_rig
from eccentric.signals import read_channels

FILTERED = 1e-3
"""Relative: what a low pass of 25 Hz and a spline at 125 Hz take from an acceleration of 2 Hz and less."""


def prepared(log: Path | Mapping[str, Any], rig: Path | Mapping[str, Any]) -> tuple[FitData, Model]:
    """What a fit of the rig's own model sees of a log."""
    channels = read_channels([log if isinstance(log, Path) else read_log(log)], read_rig(rig))
    model = load_model(channels.rig.model)
    return fit_data_of(drive_of(channels, channels.rig, model), channels.rig, model), model


def is_found(fitted: Refit, name: str, truth: float, bias: float = 0.0) -> bool:
    """Whether an estimate lies within three standard errors of the truth, and what the filter takes."""
    estimate = fitted.estimates[name]
    return abs(estimate.value - truth) <= 3.0 * estimate.std_error + bias * abs(truth)


def inertia(fitted: Refit, mu: float) -> float:
    """J_m + mu^2 J_l of the fit."""
    return fitted.values["J_m"] + mu**2 * fitted.values["J_l"]


def left_of(y: np.ndarray, *others: np.ndarray) -> float:
    """The part of y, by its norm, that a fit of the others leaves."""
    x = np.column_stack(others)
    return float(np.linalg.norm(y - x @ np.linalg.lstsq(x, y, rcond=None)[0]) / np.linalg.norm(y))
