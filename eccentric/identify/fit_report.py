"""A fit as a document (`eccentric-fit/1`), as parameters to emit, and as a few lines for a terminal.

Keys of the document; an estimate is {value, std_error, interval_95, unit, bound_active (or null)}, its
std_error null where an active bound, its own or another value's, makes the interval:

    format, model, rig, logs, drive (current, voltage, torque), unit (of target and error: N m, V or A)
    known             letter: value in SI, from the rig
    coefficients      name: estimate, the columns of the fit as they were fitted
    combinations      name: estimate, what the columns hold that is no single letter; in newton metres where
                      the scale is identified
    identified, not_identified  letters
    unknown           letter: estimate with range, range_end_hit, profile {values, rmse_training}
    alignment         input_delay_s, theta_zero_rad, voltage_offset_V: value (estimate), estimated
    parameters        letter: value or null, complete for `Parameters` of the emitted module
    parameter_notes   letter: known, fitted (with uncertainty) or convention, in words
    identified_range  ranges in words;  ranges  {omega_m_rad_s, speed_m_rad_s, temperature_C}
    rmse_holdout_Nm (_V, _A), r_squared_holdout (of the drive signal)  linear, paper, paper_unbounded
    improvement       percent 100 (1 - paper/linear), interval_95
    rows, moving_threshold_rad_s, fitted_on, holdout {rule, intervals_s}, warnings
"""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from eccentric.errors import few

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eccentric.identify.fit import Fit
    from eccentric.identify.uncertainty import Estimate

FORMAT = "eccentric-fit/1"
_ALIGNMENT = ("input_delay_s", "theta_zero_rad", "voltage_offset_V")
_KEYS = {"N m": "rmse_holdout_Nm", "V": "rmse_holdout_V", "A": "rmse_holdout_A"}
_DRIVES = {"N m": "torque", "V": "voltage", "A": "current"}
_CLEAR = 1.0
"""A gain below this, in per cent, is not worth the words."""
LEAST_R_SQUARED = 0.5
"""Below, half of what the drive does is unexplained, and comparing friction models says nothing.

On the bundled log a wrong sign or unit, another mu and a zero angle 1 rad off leave -4000 to 0.48, a k_i
wrong by 30 % leaves 0.95; logs with friction that the models lack have 0.98.
"""


def document(fit: Fit, logs: Sequence[str]) -> dict[str, Any]:
    """Return the fit as strict JSON: numbers, texts, lists and tables; null for what is not there.

    `logs` are the names of the logs.
    """
    problem = fit.problem
    channels, rig = problem.channels, problem.rig
    parameters, texts = emitted_parameters(fit)
    counted = problem.sampling
    return {
        "format": FORMAT,
        "model": problem.model.name,
        "rig": rig.name,
        "logs": list(logs),
        "drive": channels.drive,
        "unit": problem.unit,
        "known": dict(rig.known),
        "coefficients": {name: _entry(e) for name, e in fit.coefficients.items() if name not in _ALIGNMENT},
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
        _KEYS[problem.unit]: dict(fit.rmse),
        "improvement": {"percent": fit.percent, "interval_95": list(fit.percent_interval)},
        "r_squared_holdout": dict(fit.r_squared),
        "rows": channels.counts,
        "moving_threshold_rad_s": channels.moving_threshold_rad_s,
        "fitted_on": {
            "what": counted.description,
            "training": int(np.count_nonzero(counted.train)),
            "held_out": int(np.count_nonzero(counted.score)),
        },
        "holdout": {
            "rule": channels.holdout.rule,
            "intervals_s": [list(x) for x in channels.holdout.intervals_s],
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
        else {"value": getattr(rig, name), "estimated": False}
        for name in _ALIGNMENT
    }


def ranges(fit: Fit) -> dict[str, list[float] | None]:
    """Return the ranges of motor velocity and speed [rad/s] and temperature [degC] of the training rows."""
    channels = fit.problem.channels
    rows = channels.fit_rows if np.any(channels.fit_rows) else channels.usable
    omega = channels.omega_m[rows]
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


def emitted_parameters(fit: Fit) -> tuple[dict[str, float | None], dict[str, str]]:
    """Return values for every parameter of the model, known and fitted, and in words where each is from.

    What the log shows only in combination goes into one letter and the others take a value that leaves the
    combination alone (B_lT = C_lT = 0; k_e = 0 with the back-EMF damping in B_m; k_i = 1 N m/A): the notes
    say so.
    """
    problem = fit.problem
    values: dict[str, float | None] = dict(problem.rig.known)
    notes = dict.fromkeys(values, "known, from the rig")
    for name, e in fit.searched.items():
        values[name], notes[name] = e.value, _words(e)
    _put_scale(fit, values, notes)
    for c in problem.coefficients:
        if c.role not in ("friction", "inertia"):
            continue
        e = _mechanical(fit, c.name)
        letter = {"B": "B_m", "C": "C_m", "J": "J_m"}.get(c.letter, c.letter)
        values[letter], notes[letter] = e.value, _words(e)
        if letter != c.letter or "k_e" in c.name:
            shown = _mechanical_name(fit, c.name)
            notes[letter] += "" if shown in (letter, "J") else f"; holds all of {shown}"
    if any(c.role == "inertia" for c in problem.coefficients):
        values["J_l"], notes["J_l"] = 0.0, "convention: J_m holds all of the inertia J_m + mu^2 J_l"
    fields = [field.name for field in dataclasses.fields(problem.module.Parameters)]
    for name in fields:
        if name in values:
            continue
        if name in ("F_T", "J_m", "J_l"):
            values[name], notes[name] = None, "not known, not needed"
        else:
            values[name], notes[name] = (1.0 if name in ("R", "k_i") else 0.0), "convention: not identified"
    return {name: values[name] for name in fields}, {name: notes[name] for name in fields}


def _put_scale(fit: Fit, values: dict[str, float | None], notes: dict[str, str]) -> None:
    """Put k_i and R so that their ratio is the identified scale; without one, 1 N m stands for 1 V or 1 A."""
    problem = fit.problem
    if problem.scale is None:
        return
    column = next((c for c in problem.coefficients if c.role == "scale"), None)
    s = fit.coefficients[column.name].value if column else 1.0
    text = (
        _words(fit.coefficients[column.name])
        if column
        else f"no scale identified: N m stands for {problem.unit}"
    )
    if problem.unit == "A":
        values["k_i"], notes["k_i"] = 1.0 / s, f"from 1/k_i {text}"
        return
    known = problem.rig.known
    if "k_i" not in known and "R" not in known:
        values["k_i"], notes["k_i"] = 1.0, "convention: only R/k_i shows in a voltage"
    if "R" in known:
        values["k_i"], notes["k_i"] = known["R"] / s, f"from R/k_i {text}"
    else:
        values["R"], notes["R"] = s * (values["k_i"] or 1.0), f"from R/k_i {text}"


def _mechanical_name(fit: Fit, name: str) -> str:
    """The combination in newton metres that belongs to a coefficient: they come in the same order."""
    if not any(c.role == "scale" for c in fit.problem.coefficients):
        return name
    names = [c.name for c in fit.problem.coefficients if c.role != "offset"]
    return list(fit.combinations)[names.index(name)]


def _mechanical(fit: Fit, name: str) -> Estimate:
    shown = _mechanical_name(fit, name)
    return fit.coefficients[name] if shown == name else fit.combinations[shown]


def _words(e: Estimate) -> str:
    low, high = e.interval
    bound = f", at its {e.bound_active} bound" if e.bound_active else ""
    error = "" if e.widened else f" +- {e.std_error:.2g}"
    unit = "" if e.unit == "1" else f" {e.unit}"
    return f"fitted: {e.value:.4g}{error}{unit}, 95 % interval {low:.4g} to {high:.4g}{bound}"


def sentence(fit: Fit) -> str:
    """Return in one sentence what the paper's model gains on the held-out part over Coulomb + viscous.

    Where the log does not fit the rig at all, the sentence says that instead.
    """
    if not _fits(fit):
        return (
            f"This log does not fit the rig (R^2 {fit.r_squared['paper']:.2f}): check units and signs of the "
            'columns, mu, and the zero angle (theta_zero_rad = "estimate" estimates it).'
        )
    low, high = fit.percent_interval
    gain, interval = _percent(fit.percent), f"95 % interval {_percent(low)} to {_percent(high)} %"
    if low > 0.0 and fit.percent >= _CLEAR:
        return (
            f"The paper's model predicts the held-out part {gain} % better than "
            f"Coulomb + viscous friction ({interval})."
        )
    if high < 0.0 and fit.percent <= -_CLEAR:
        return (
            f"The paper's model predicts the held-out part {_percent(-fit.percent)} % worse than "
            f"Coulomb + viscous friction ({interval} of gain)."
        )
    if abs(fit.percent) >= _CLEAR:
        return (
            f"The paper's model has no certain gain over Coulomb + viscous friction on the held-out part "
            f"({gain} %, {interval})."
        )
    return (
        f"The paper's model gains nothing over Coulomb + viscous friction here "
        f"({gain} % of the held-out error, {interval})."
    )


def _fits(fit: Fit) -> bool:
    return fit.r_squared["paper"] >= LEAST_R_SQUARED


def _percent(x: float) -> str:
    return f"{round(x, 1) + 0.0:.1f}"  # + 0.0 takes the sign from a zero


def lines(fit: Fit, logs: Sequence[str]) -> list[str]:
    """Return the fit for a terminal."""
    problem = fit.problem
    sampling = problem.sampling
    what = f"{np.count_nonzero(sampling.train)} {sampling.description} fitted"
    head = f"{few(logs)}: {problem.model.name}, driven by {problem.channels.drive}; {what}, "
    head += f"{np.count_nonzero(sampling.score)} held out ({problem.channels.holdout.brief})"
    shown = {**fit.coefficients, **fit.searched}
    table = [("", "value", "std error", "95 % interval", "unit")]
    table += [
        (name, f"{e.value:.4g}", "-" if e.widened else f"{e.std_error:.2g}", _interval(e), e.unit + _bound(e))
        for name, e in shown.items()
    ]
    widths = [max(len(row[k]) for row in table) for k in range(4)]
    out = [head]
    for name, *middle, unit in table:
        cells = [name.ljust(widths[0]), *(x.rjust(w) for x, w in zip(middle, widths[1:], strict=True))]
        out.append("  ".join(["", *cells, unit]).rstrip())
    if any(c.role == "scale" for c in problem.coefficients):
        names = [name for name in fit.combinations if name not in fit.coefficients]
        combined = (f"{name} = {fit.combinations[name].value:.4g}" for name in names)
        out.append(f"in newton metres: {', '.join(combined)}")
    elif problem.scale is not None:
        out.append(
            f"no scale to newton metres (neither J nor gravity is known): all is times {problem.scale}"
        )
    errors = ", ".join(f"{which} {fit.rmse[which]:.4g}" for which in ("linear", "paper"))
    parts = ", ".join(f"{which} {fit.r_squared[which]:.4f}" for which in ("linear", "paper"))
    out.append(f"held-out RMSE [{problem.unit}]: {errors}; R^2 of the drive {_DRIVES[problem.unit]}: {parts}")
    if problem.rig.moving_threshold_rad_s is None:
        threshold = problem.channels.moving_threshold_rad_s
        out.append(f"rows count as moving above {threshold:.4g} rad/s (moving_threshold_rad_s sets it)")
    if _fits(fit):
        out += _bounds_line(fit)
    return [*out, sentence(fit)]


def _interval(e: Estimate) -> str:
    return f"{e.interval[0]:.4g} to {e.interval[1]:.4g}"


def _bound(e: Estimate) -> str:
    return f"  ({e.bound_active} bound active)" if e.bound_active else ""


def _bounds_line(fit: Fit) -> list[str]:
    free, held = fit.rmse["paper_unbounded"], fit.rmse["paper"]
    if not fit.bounds_active:
        return []
    gain = 100.0 * (1.0 - free / held)
    text = f"bound active on {', '.join(fit.bounds_active)}; without bounds the held-out RMSE is {free:.4g}"
    if gain >= _CLEAR:
        text += f", {gain:.2g} % less: a sign of an effect that the model lacks"
    return [text]
