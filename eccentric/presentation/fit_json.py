"""A fit as a document: fit.json, format eccentric-fit/1.

Keys of the document; an estimate is {value, std_error, interval_95, unit, bound_active ("lower", "upper" or
null), at_bound, widened_by_bound}. Its std_error takes every other value at a bound as that bound; at_bound
says whether it is at one itself, widened_by_bound whether an active bound, its own or another value's, widens
the interval:

    format, model, rig, logs, kind (of an axis that does not turn: names and units are then its own),
    drive (current, voltage, torque), unit (of target and error: N m, V or A)
    known             letter: value in SI, from the rig
    undetected        C_lN, B_lN whose intervals reach 0: upper_95, unit, reference (the model's own value),
                      z (that in standard errors), power (probability that such a log shows it)
    free_cubic        c_0 to c_3 of a coast-down: friction, or deceleration, as a cubic in the speed
  added_kg          run or pattern: mass that it carries besides M; only where the rig has one
    coefficients      name: estimate, the columns of the fit as they were fitted
    correlation       names, matrix: of the errors of coefficients and unknown; null for one at a bound
    combinations      name: estimate, coefficients of columns that are not a single letter; in newton metres
                      if the scale is identified
    identified, not_identified  letters
    unknown           letter: estimate with range, range_end_hit, profile {values, rmse_training}
    alignment         input_delay_s, theta_zero_rad, voltage_offset_V: value (estimate), estimated
    parameters        letter: value or null, known or fitted
    placeholders      letter: value in the emitted module of what is neither known nor identified, such as
                      R = 1 and k_e = 0 without a voltage
    parameter_notes   letter: known, fitted (with uncertainty) or convention, in words
    levels_cut        only where dry friction would be negative: direction (forward, backward or both), the
                      motor speed_m_rad_s at which it is lowest, that level lowest_Nm, intervals of the link
                      angle [rad]
    back_emf_in_friction  whether the viscous friction contains the back-EMF: a voltage alone, k_e unknown
    torque_unit       of the parameters: N m, or V or A where the log has no scale for a torque
    current_known     whether the parameters give a current in amperes: not where a voltage gives R/k_i alone
    voltage_known     whether they give a voltage: not by a current or a torque where R or k_e is not known
    identified_range  ranges in words;  ranges  {omega_m_rad_s, speed_m_rad_s, temperature_C}
    rmse_holdout_Nm (_V, _A), r_squared_holdout (of the drive signal)  linear, paper, paper_unbounded
    fits_the_rig      false if the log cannot be from this rig: nothing follows from the fit
    error_band        of paper: cut_hz of the low pass, its error below and above, noise of the sensors above;
                      null for averages
    improvement       percent 100 (1 - paper/linear), interval_95
    rows, moving_threshold_rad_s, fitted_on, holdout {rule, intervals_s}, warnings
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from eccentric.emission import LevelCut
from eccentric.identification import (
    NO_BACK_EMF,
    Estimate,
    Fit,
    correlation,
    following_letters,
    inertias,
    k_e,
    own_letters,
    with_own,
)
from eccentric.model import TURNING, AxisKind, regressor
from eccentric.model import vocabulary as v
from eccentric.rigs import ALIGNMENT, COASTING, alignment_of, knowns_of
from eccentric.signals import Channels

FORMAT = "eccentric-fit/1"
DIRECTIONS: Mapping[tuple[int, ...], str] = {(1,): "forward", (-1,): "backward", (1, -1): "both"}
"""Of motion, in which a level is cut."""


def fit_document(fit: Fit, logs: Sequence[str]) -> dict[str, Any]:
    """Return the fit as strict JSON: numbers, strings, lists and tables; null for missing values.

    `logs` are the names of the logs.
    """
    problem = fit.problem
    channels, rig = problem.drive.channels, problem.rig
    values, texts, placeholders = emitted_parameters(fit)
    counted = problem.rows
    axis = rig.axis
    known = {known.name for known in knowns_of(axis)}
    document = {
        "format": FORMAT,
        **({} if axis is TURNING else {"kind": axis.name}),
        "model": problem.model.name,
        "rig": rig.name,
        "logs": list(logs),
        "drive": COASTING if channels.motor.coasting else axis.named(channels.motor.measured_by),
        "unit": axis.unit(problem.unit),
        "known": {name: value for name, value in rig.known.items() if name in known},
        "coefficients": {
            name: estimate_entry(e, axis) for name, e in fit.coefficients.items() if name not in ALIGNMENT
        },
        "correlation": _correlation(fit),
        "combinations": estimate_entries(fit.combinations, axis),
        "identified": [axis.named(name) for name in fit.identified[0]],
        "not_identified": [axis.named(name) for name in fit.identified[1]],
        "unknown": {
            name: {
                **estimate_entry(fit.searched[name], axis),
                "range": list(rig.unknown[name]),
                "range_end_hit": fit.searched[name].bound_active is not None,
                "profile": {"values": list(p.values), "rmse_training": list(p.rmse)},
            }
            for name, p in fit.profiles.items()
        },
        "alignment": _alignment(fit),
        "parameters": {name: x for name, x in values.items() if name not in placeholders},
        "placeholders": {name: values[name] for name in values if name in placeholders},
        "parameter_notes": texts,
        "back_emf_in_friction": any(k_e in c.expression.free_symbols for c in problem.coefficients),
        "current_known": _current_known(fit),
        "voltage_known": problem.drive.voltage_known,
        "torque_unit": axis.unit(_torque_unit(fit)),
        "identified_range": identified_range(fit),
        "ranges": ranges(channels),
        f"rmse_holdout_{axis.unit(problem.unit).replace(' ', '')}": dict(fit.rmse),
        "error_band": None if fit.band is None else vars(fit.band),
        "improvement": gain_entry(fit.percent, fit.percent_interval),
        "r_squared_holdout": dict(fit.r_squared),
        "fits_the_rig": fit.fits_the_rig,
        "rows": channels.counts,
        **({"excerpt": channels.excerpt} if channels.excerpt else {}),
        **({"added_kg": rig.added_kg} if rig.added else {}),
        **({"undetected": _undetected(fit)} if fit.fits_the_rig and fit.undetected else {}),
        **({"free_cubic": estimate_entries(fit.cubic, axis)} if fit.cubic else {}),
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
    return axis.keyed(document)


def _undetected(fit: Fit) -> dict[str, Any]:
    """Upper bounds of friction by F_N that the log does not show."""
    return {
        name: {
            "upper_95": finite(one.upper),
            "unit": one.unit,
            "reference": one.reference,
            "z": one.z,
            "power": one.power,
        }
        for name, one in fit.undetected.items()
    }


def _correlation(fit: Fit) -> dict[str, Any]:
    """Correlation of the errors of coefficients and searched values."""
    matrix = correlation(fit.spread.matrix)
    return {
        "names": [fit.problem.rig.axis.named(name) for name in (*fit.coefficients, *fit.searched)],
        "matrix": [[finite(float(x)) for x in row] for row in matrix],
    }


def estimate_entry(e: Estimate, axis: AxisKind, unit: str | None = None) -> dict[str, Any]:
    """An estimate as every document has it, `unit` in place of its own.

    Its standard error takes a value at a bound as that bound; it is null only where the covariance has none.
    """
    error, *ends = (finite(float(x)) for x in (e.std_error, *e.interval))
    return {
        "value": e.value,
        "std_error": error,
        "interval_95": ends,
        "unit": axis.unit(e.unit) if unit is None else unit,
        "bound_active": e.bound_active,
        "at_bound": e.bound_active is not None,
        "widened_by_bound": e.widened,
    }


def cuts_document(cuts: Sequence[LevelCut], axis: AxisKind) -> dict[str, Any]:
    """Where levels of dry friction are cut at 0, in every document; nothing where they are not."""
    entries = [
        {
            "direction": DIRECTIONS[cut.directions],
            "speed_m_rad_s": cut.speed,
            "lowest_Nm": cut.lowest,
            "intervals": [list(ends) for ends in cut.intervals],
        }
        for cut in cuts
    ]
    return axis.keyed({"levels_cut": entries}) if entries else {}


def gain_entry(percent: float, interval: Sequence[float]) -> dict[str, Any]:
    """A reduction of an error in percent, as every document has it."""
    return {"percent": percent, "interval_95": list(interval)}


def finite(x: float | None) -> float | None:
    """A number, None for one that JSON does not have."""
    return x if x is not None and math.isfinite(x) else None


def estimate_entries(estimates: Mapping[str, Estimate], axis: AxisKind) -> dict[str, Any]:
    """Estimates by name."""
    return {name: estimate_entry(e, axis) for name, e in estimates.items()}


def _alignment(fit: Fit) -> dict[str, Any]:
    rig = fit.problem.rig
    found = {**fit.coefficients, **fit.searched}
    return {
        name: {**estimate_entry(found[name], rig.axis), "estimated": True}
        if name in found
        else {"value": getattr(rig.alignment, name), "estimated": False}
        for name in alignment_of(rig.axis)
    }


def ranges(channels: Channels) -> dict[str, list[float] | None]:
    """Return the ranges of motor velocity and speed [rad/s] and temperature [degC] of the training rows."""
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
    found = ranges(fit.problem.drive.channels)
    low, high = found["omega_m_rad_s"] or [0.0, 0.0]
    slow, fast = found["speed_m_rad_s"] or [0.0, 0.0]
    sides = "both directions" if low < 0.0 < high else "one direction"
    axis = fit.problem.rig.axis
    text = f"{axis.term('motor speed')} {slow:.3g} to {fast:.3g} {axis.unit('rad/s')}, {sides}"
    warm = found["temperature_C"]
    return f"{text}, temperature " + (f"{warm[0]:.3g} to {warm[1]:.3g} degC" if warm else "not logged")


def emitted_parameters(fit: Fit) -> tuple[dict[str, float | None], dict[str, str], set[str]]:
    """Return values for every parameter of the model, the origin of each in words, and the placeholders.

    Placeholders are the letters whose values stand for nothing known or identified. A combination is assigned
    to one letter, and the others have a value that does not change it (B_lT = C_lT = 0; k_e = 0 with the
    back-EMF damping in B_m; k_i = 1 N m/A): the notes say so.
    """
    problem, axis = fit.problem, fit.problem.rig.axis
    fitted = {q.name for q in problem.model.friction_parameters}
    own = {name: value for name, value in own_letters(problem.model).items() if name not in fitted}
    values: dict[str, float | None] = {n: x for n, x in problem.rig.known.items() if n not in own}
    notes = dict.fromkeys(values, "known, from the rig")
    for name, e in fit.searched.items():
        values[name], notes[name] = e.value, _words(e, axis)
    _put_scale(fit, values, notes)
    for c in problem.coefficients:
        if c.role not in ("friction", "inertia", "load"):
            continue
        e = _mechanical(fit, c.name)
        values[c.parameter], notes[c.parameter] = e.value, _words(e, axis)
        if c.parameter != c.letter or k_e in c.expression.free_symbols:
            shown = _mechanical_name(fit, c.name)
            notes[c.parameter] += (
                "" if shown in (c.parameter, "J") else f"; contains all of {axis.named(shown)}"
            )
    if problem.has("inertia") and problem.drive.machine.link:
        _put_inertias(fit, values, notes)
    fields, inertia = problem.emitted.letters, problem.drive.machine.inertia_letters
    follows, placeholders = following_letters(problem.model), set()
    for name in fields:
        if name in values:
            continue
        if name in own:
            values[name], notes[name] = own[name], "the model's own, not fitted"
        elif name in inertia or name in follows:
            values[name], notes[name] = None, "not known, not needed"
        else:
            values[name], notes[name] = (1.0 if name in ("R", "k_i") else 0.0), "convention: not identified"
            placeholders.add(name)
    if not problem.drive.voltage_known:
        for name in problem.drive.machine.back_emf_letters & set(fields):
            values[name], notes[name] = 0.0, axis.text(NO_BACK_EMF)
            placeholders.add(name)
    return {name: values[name] for name in fields}, {name: notes[name] for name in fields}, placeholders


def _put_inertias(fit: Fit, values: dict[str, float | None], notes: dict[str, str]) -> None:
    """Split the inertia, fitted as the rotor's, as `diagnose` does: by what the rig knows, else a link M L^2.

    The rotor has all of it where torques are in another unit, less is found than M L^2, or friction that
    follows J_l has been fitted without it.
    """
    problem, known = fit.problem, fit.problem.rig.known
    model, machine = problem.model, problem.drive.machine
    rotor, link = machine.rotor, machine.link
    values[link] = 0.0
    notes[link] = f"convention: {rotor} contains all of the inertia J_m + mu^2 J_l"
    declared = {rotor, link} & set(known)
    found = {**known, **{name: e.value for name, e in fit.searched.items()}}
    follows = {s.name for column in regressor(model) for s in model.expand(column.basis).free_symbols}
    if (
        _torque_unit(fit) != "N m"
        or link in follows - set(known)
        or not (declared or {v.M.name, v.L.name} <= set(found))
    ):
        return
    rig = with_own(dataclasses.replace(problem.rig, known=found), model)
    parts = {**inertias(rig, machine, values[rotor] or 0.0), **known}
    if not (declared or (parts[rotor] and parts[link])):
        return
    text = f"from {problem.rig.axis.named('J')} {notes[rotor]}"
    words = {rotor: text, link: text if declared else "convention: M L^2, a point mass"}
    for name in (rotor, link):
        values[name], notes[name] = parts[name], "known, from the rig" if name in known else words[name]


def _put_scale(fit: Fit, values: dict[str, float | None], notes: dict[str, str]) -> None:
    """Set k_i and R so that their ratio is the identified scale; without one, 1 N m represents 1 V or 1 A."""
    problem, axis = fit.problem, fit.problem.rig.axis
    if problem.scale is None:
        return
    column = next((c for c in problem.coefficients if c.role == "scale"), None)
    s = fit.coefficients[column.name].value if column else 1.0
    text = (
        _words(fit.coefficients[column.name], axis)
        if column
        else f"no scale identified: {axis.unit('N m')} represents {problem.unit}"
    )
    if problem.unit == "A":
        values["k_i"], notes["k_i"] = 1.0 / s, f"from 1/{axis.named('k_i')} {text}"
        return
    known = problem.rig.known
    if "k_i" not in known and "R" not in known:
        values["k_i"], notes["k_i"] = 1.0, f"convention: only R/{axis.named('k_i')} shows in a voltage"
    if "R" in known:
        values["k_i"], notes["k_i"] = known["R"] / s, f"from R/{axis.named('k_i')} {text}"
    else:
        values["R"], notes["R"] = s * (values["k_i"] or 1.0), f"from R/{axis.named('k_i')} {text}"


def _current_known(fit: Fit) -> bool:
    """Whether the parameters give a current in amperes: by a voltage, k_i or R splits R/k_i."""
    problem = fit.problem
    by_ratio = problem.scale is not None and problem.drive.by_voltage
    return not by_ratio or (_torque_unit(fit) == "N m" and bool({"R", "k_i"} & set(problem.rig.known)))


def _torque_unit(fit: Fit) -> str:
    return "N m" if fit.problem.has("scale") else fit.problem.drive.emitted_unit


def _mechanical_name(fit: Fit, name: str) -> str:
    """The combination in newton metres for a coefficient: they have the same order."""
    if not fit.problem.has("scale"):
        return name
    names = [c.name for c in fit.problem.coefficients if c.role != "offset"]
    return list(fit.combinations)[names.index(name)]


def _mechanical(fit: Fit, name: str) -> Estimate:
    shown = _mechanical_name(fit, name)
    return fit.coefficients[name] if shown == name else fit.combinations[shown]


def _words(e: Estimate, axis: AxisKind) -> str:
    low, high = e.interval
    bound = f", at its {e.bound_active} bound" if e.bound_active else ""
    error = f", std error {e.std_error:.2g}" if math.isfinite(e.std_error) else ""
    unit = "" if e.unit == "1" else f" {axis.unit(e.unit)}"
    return f"fitted: {e.value:.4g}{unit}{error}, 95 % interval {low:.4g} to {high:.4g}{bound}"
