"""A fit as a document: fit.json, format eccentric-fit/1.

Keys of the document; an estimate is {value, std_error, interval_95, unit, bound_active (or null)}, its
std_error null if an active bound, its own or another value's, determines the interval:

    format, model, rig, logs, drive (current, voltage, torque), unit (of target and error: N m, V or A)
    known             letter: value in SI, from the rig
    coefficients      name: estimate, the columns of the fit as they were fitted
    combinations      name: estimate, coefficients of columns that are not a single letter; in newton metres
    if
                      the scale is identified
    identified, not_identified  letters
    unknown           letter: estimate with range, range_end_hit, profile {values, rmse_training}
    alignment         input_delay_s, theta_zero_rad, voltage_offset_V: value (estimate), estimated
    parameters        letter: value or null, complete for `Parameters` of the emitted module
    parameter_notes   letter: known, fitted (with uncertainty) or convention, in words
    identified_range  ranges in words;  ranges  {omega_m_rad_s, speed_m_rad_s, temperature_C}
    rmse_holdout_Nm (_V, _A), r_squared_holdout (of the drive signal)  linear, paper, paper_unbounded
    fits_the_rig      false if the log cannot be from this rig: nothing follows from the fit
    improvement       percent 100 (1 - paper/linear), interval_95
    rows, moving_threshold_rad_s, fitted_on, holdout {rule, intervals_s}, warnings
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from eccentric.fitting.parameters import emitted_parameters
from eccentric.rigs import ALIGNMENT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eccentric.estimation import Estimate
    from eccentric.fitting.identify import Fit

__all__ = ["fit_document"]

FORMAT = "eccentric-fit/1"


def fit_document(fit: Fit, logs: Sequence[str]) -> dict[str, Any]:
    """Return the fit as strict JSON: numbers, strings, lists and tables; null for missing values.

    `logs` are the names of the logs.
    """
    problem = fit.problem
    channels, rig = problem.channels, problem.rig
    parameters, texts = emitted_parameters(fit)
    counted = problem.rows
    return {
        "format": FORMAT,
        "model": problem.model.name,
        "rig": rig.name,
        "logs": list(logs),
        "drive": channels.motor.measured_by,
        "unit": problem.unit,
        "known": dict(rig.known),
        "coefficients": {name: _entry(e) for name, e in fit.coefficients.items() if name not in ALIGNMENT},
        "combinations": {name: _entry(e) for name, e in fit.combinations.items()},
        "identified": fit.identified[0],
        "not_identified": fit.identified[1],
        "unknown": {
            name: {
                **_entry(fit.searched[name]),
                "range": list(rig.unknown[name]),
                "range_end_hit": fit.searched[name].bound_active is not None,
                "profile": {"values": list(p.values), "rmse_training": list(p.rmse)},
            }
            for name, p in fit.profiles.items()
        },
        "alignment": _alignment(fit),
        "parameters": parameters,
        "parameter_notes": texts,
        "identified_range": identified_range(fit),
        "ranges": ranges(fit),
        f"rmse_holdout_{problem.unit.replace(' ', '')}": dict(fit.rmse),
        "improvement": {"percent": fit.percent, "interval_95": list(fit.percent_interval)},
        "r_squared_holdout": dict(fit.r_squared),
        "fits_the_rig": fit.fits_the_rig,
        "rows": channels.counts,
        "moving_threshold_rad_s": channels.selection.moving_threshold_rad_s,
        "fitted_on": {
            "what": counted.description,
            "training": int(np.count_nonzero(counted.train)),
            "held_out": int(np.count_nonzero(counted.score)),
        },
        "holdout": {
            "rule": channels.selection.holdout.rule,
            "intervals_s": [list(x) for x in channels.selection.holdout.intervals_s],
        },
        "warnings": list(fit.warnings),
    }


def _entry(e: Estimate) -> dict[str, Any]:
    return {
        "value": e.value,
        "std_error": None if e.widened else e.std_error,
        "interval_95": [x if math.isfinite(x) else None for x in e.interval],
        "unit": e.unit,
        "bound_active": e.bound_active,
    }


def _alignment(fit: Fit) -> dict[str, Any]:
    rig = fit.problem.rig
    found = {**fit.coefficients, **fit.searched}
    return {
        name: {**_entry(found[name]), "estimated": True}
        if name in found
        else {"value": getattr(rig.alignment, name), "estimated": False}
        for name in ALIGNMENT
    }


def ranges(fit: Fit) -> dict[str, list[float] | None]:
    """Return the ranges of motor velocity and speed [rad/s] and temperature [degC] of the training rows."""
    channels = fit.problem.channels
    rows = channels.selection.fit_rows if np.any(channels.selection.fit_rows) else channels.selection.usable
    omega = channels.motion.omega_m[rows]
    temperature = None if channels.temperature is None else channels.temperature[rows]
    return {
        "omega_m_rad_s": _ends(omega),
        "speed_m_rad_s": _ends(np.abs(omega)),
        "temperature_C": None if temperature is None else _ends(temperature),
    }


def _ends(x: np.ndarray) -> list[float]:
    return [float(np.min(x)), float(np.max(x))]


def identified_range(fit: Fit) -> str:
    """Return the range of speed and temperature that the parameters were identified on, in words."""
    found = ranges(fit)
    low, high = found["omega_m_rad_s"] or [0.0, 0.0]
    slow, fast = found["speed_m_rad_s"] or [0.0, 0.0]
    sides = "both directions" if low < 0.0 < high else "one direction"
    text = f"motor speed {slow:.3g} to {fast:.3g} rad/s, {sides}"
    warm = found["temperature_C"]
    return f"{text}, temperature " + (f"{warm[0]:.3g} to {warm[1]:.3g} degC" if warm else "not logged")
