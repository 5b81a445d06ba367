"""A diagnosis as `diagnosis.json` and as lines for a terminal."""

from __future__ import annotations

import inspect
from typing import Any

import sympy as sp

from eccentric.effects.effect import Effect
from eccentric.errors import few
from eccentric.identify.diagnose import LEAST_R2, Diagnosis

__all__ = ["document", "lines", "sentence"]

_GRAVE = {"wrong_sign", "wrong_unit", "contradiction", "another_rig", "mismatch", "zero_angle"}
PROVABLE = 3.0
"""A residual this many times the noise of the sensors has a cause, found or not."""


def document(found: Diagnosis) -> dict[str, Any]:
    """The content of diagnosis.json, format eccentric-diagnosis/1 (keys as in the manual)."""
    a = found.attribution
    return {
        "format": "eccentric-diagnosis/1",
        "logs": list(found.logs),
        "model": found.base.name,
        "verdict": a.verdict,
        "sentence": sentence(found),
        "effects": [_effect(found, effect) for effect, _ in found.effects],
        "candidates": [
            {
                "id": c.id,
                "family": c.family,
                "balance": c.balance,
                "rmse_cross_validated": c.rmse,
                "probability": c.probability,
            }
            for c in a.candidates
        ],
        "extended_by": [effect.id for effect, _ in found.extended.effects],
        "residual_depends_on": list(a.depends_on),
        "next_measurement": a.next_measurement,
        **_errors(found),
        "improvement": {
            "balance": found.balance,
            "percent": found.percent,
            "interval_95": list(found.interval),
        },
        f"noise_floor_{_suffix(found)}": found.noise_floor,
        "null_test": {
            name: {"gain": gain, "by_chance_99": level} for name, (gain, level) in a.deviance.items()
        },
        "unconfirmed": _unconfirmed(found),
        "data_quality": [
            {"kind": f.kind, "channel": f.channel, "text": f.text, "rows": f.rows, "severity": f.severity}
            for f in found.channels.findings
        ],
        "periodic_per_motor_turn": [
            {"order": o.per_turn, "amplitude": o.amplitude, "share": o.share, "seen": [o.seen, o.stretches]}
            for o in found.orders
        ],
        "rig_identified": _identified(found),
        "holdout": {
            "rule": found.channels.holdout.rule,
            "intervals_s": [list(map(float, pair)) for pair in found.channels.holdout.intervals_s],
        },
        "rows": found.channels.counts,
        "settled": not found.unsettled,
        "warnings": list(found.warnings),
    }


def _unconfirmed(found: Diagnosis) -> dict[str, Any]:
    """Effects that the training part asked for and the held-out part did not confirm, with what it said."""
    if found.refused is None:
        return {"effects": list(found.attribution.unconfirmed)}
    percent, interval = found.refused.percent, list(found.refused.interval)
    return {
        "effects": list(found.attribution.unconfirmed),
        "improvement": {"percent": percent, "interval_95": interval},
    }


def _suffix(found: Diagnosis) -> str:
    return found.unit.replace(" ", "")


def _errors(found: Diagnosis) -> dict[str, Any]:
    """Held-out errors; where the torque is not measured also in the unit of the drive, and of free motion."""
    score, drive = found.score, found.bench.drive
    said: dict[str, Any] = {f"rmse_holdout_{_suffix(found)}": {k: dict(v) for k, v in score.rmse.items()}}
    if score.per_drive and found.unit == "N m":
        said[f"rmse_holdout_{'V' if drive.by_voltage else 'A'}"] = {"mechanical": dict(score.per_drive)}
    if score.free:
        said[f"rmse_holdout_motor_off_{_suffix(found)}"] = dict(score.free)
    over = score.over_runs
    if over is not None:
        said["leave_one_run_out"] = {
            "runs": over.runs,
            f"rmse_{_suffix(found)}": dict(over.rmse),
            "gains": {
                name: {"percent": percent, "interval_95": list(interval), "better_runs": better}
                for name, (percent, interval, better) in over.gains.items()
            },
        }
    return said


def _identified(found: Diagnosis) -> dict[str, Any]:
    """What the rig left to the log: alignment, and quantities with their uncertainty.

    A zero angle or an offset that the refit has moved replaces that of the first fit.
    """
    letters = {"J_m", "J_l", "T_load", "R/k_i", "1/k_i", "k_e", "L", "M"} | found.rig.estimate
    said: dict[str, Any] = {name: getattr(found.channels, name) for name in sorted(found.rig.estimate)}
    for name, e in found.shipped.estimates.items():
        if name in letters:
            interval = list(e.interval)
            said[name] = {"value": e.value, "std_error": e.std_error, "interval_95": interval, "unit": e.unit}
    return said


def _effect(found: Diagnosis, effect: Effect) -> dict[str, Any]:
    values = dict(next(own for e, own in found.extended.effects if e is effect))
    parameters = {}
    for q in effect.parameters:
        estimate = found.extended.estimates.get(q.name)
        parameters[q.name] = {
            "value": values[q.name],
            "std_error": None if estimate is None else estimate.std_error,
            "interval_95": None if estimate is None else list(estimate.interval),
            "unit": q.unit,
        }
    equation = effect.equation()
    return {
        "id": effect.id,
        "family": effect.family,
        "balance": effect.balance,
        "equation": f"{equation.left} = {sp.sstr(equation.right)}",
        "formula": effect.formula,
        "reference": effect.reference,
        "parameters": parameters,
        "share_of_friction_rms": found.extended.shares.get(effect.id, 0.0),
        "aliases": list(effect.aliases),
    }


def sentence(found: Diagnosis) -> str:
    """One sentence that can be sent to a colleague."""
    a = found.attribution
    before, after = found.rmse[found.balance]["paper"], found.rmse[found.balance]["extended"]
    falls = "falls" if found.interval[0] > 0.0 else "does not clearly fall:"
    gain = (
        f"the held-out error {falls} from {before:.4g} to {after:.4g} {found.unit}"
        f" ({found.percent:.1f} %, 95 % interval {found.interval[0]:.1f} to {found.interval[1]:.1f} %)"
    )
    if a.verdict == "named":
        names = " and ".join(_name(found, effect) for effect, _ in found.effects)
        sure = min(_probability(found, effect) for effect, _ in found.effects)
        these = "it" if len(found.effects) == 1 else "them"
        return f"The model lacks {names} (probability {sure:.2f}); with {these} {gain}.{_first(found)}"
    if a.verdict == "not_identifiable":
        families = " or ".join(a.tied or tuple(dict.fromkeys(c.family for c in a.candidates[:2])))
        return f"An effect is missing, but this log cannot tell {families} apart; with the first {gain}."
    if found.r_squared < LEAST_R2:
        return (
            f"This log does not fit the rig (R^2 of the drive torque {found.r_squared:.2f}): check units and"
            f" signs before anything else.{_first(found)}"
        )
    if a.unconfirmed:
        return (
            f"{' and '.join(a.unconfirmed)} fits the training part but does not predict what was held out; no"
            f" name is given. The structure depends on {', '.join(a.depends_on)}."
        )
    if a.verdict == "unexplained":
        return (
            f"Structure remains that depends on {', '.join(a.depends_on) or 'something unknown'},"
            " and no effect of the library explains it; no name is given."
        )
    if before > PROVABLE * found.noise_floor:
        return (
            f"Nothing further can be proved from this log: {before:.4g} {found.unit} are left, well above the"
            f" {found.noise_floor:.2g} {found.unit} of the sensors' noise, but no effect takes out more of"
            " them than chance would."
        )
    return (
        f"Nothing is missing: no effect takes out more of the residual ({before:.4g} {found.unit} held out;"
        f" noise of the sensors alone {found.noise_floor:.4g} {found.unit}) than chance would."
    )


def _name(found: Diagnosis, effect: Effect) -> str:
    """Its id; where it is a wrong declaration, which quantity of the rig should have which value."""
    if effect.corrects is None:
        return effect.id
    quantity, value = effect.corrects
    fitted = {q.symbol: found.extended.values[q.name] for q in effect.parameters}
    letters = {s.name: s for s in value.free_symbols - set(fitted)}
    if not set(letters) <= set(found.rig.known):
        return effect.id
    declared = {s: found.rig.known[name] for name, s in letters.items()}
    true, said = (float(value.subs(declared | x)) for x in (fitted, dict.fromkeys(fitted, 0)))
    return (
        f"the right value of {quantity.name} ({effect.id}: {true:.4g} {quantity.unit},"
        f" {said:.4g} in the rig file)"
    )


def _first(found: Diagnosis) -> str:
    """What the record itself says is wrong, if anything that the named effects do not say."""
    told = {effect.corrects[0].name for effect, _ in found.effects if effect.corrects}
    grave = [
        f for f in found.quality if f.severity == "warning" and f.kind in _GRAVE and f.channel not in told
    ]
    return f" {grave[0].text[0].upper()}{grave[0].text[1:]}." if grave else ""


def _probability(found: Diagnosis, effect: Effect) -> float:
    return max(
        (c.probability for c in found.attribution.candidates if c.family == effect.family), default=0.0
    )


def lines(found: Diagnosis) -> list[str]:
    """At most fourteen lines for a terminal."""
    a = found.attribution
    out = [f"{few(found.logs)}: {found.base.name}, verdict {a.verdict}", sentence(found)]
    for effect, own in found.effects[:3]:
        shown = []
        for q in effect.parameters:
            estimate = found.extended.estimates.get(q.name)
            error = "" if estimate is None else f" +- {estimate.std_error:.2g}"
            shown.append(f"{q.name} = {own[q.name]:.4g}{error}{'' if q.unit == '1' else ' ' + q.unit}")
        share = 100 * found.extended.shares.get(effect.id, 0.0)
        out.append(f"  {effect.id} ({share:.1f} % of friction): {', '.join(shown)}")
    for balance, models in found.rmse.items():
        errors = ", ".join(f"{name} {value:.4g}" for name, value in models.items())
        out.append(f"held-out RMSE, {balance} [{found.unit}]: {errors}")
    over = found.score.over_runs
    if over is not None:
        errors = ", ".join(f"{name} {value:.4g}" for name, value in over.rmse.items())
        out.append(f"each of {over.runs} runs predicted from the others [{found.unit}]: {errors}")
        for name, (percent, (low, high), better) in over.gains.items():
            if low == high:  # without a mass, the paper's model is the linear one
                continue
            than = {"paper": "linear", "extended": "paper"}[name]
            out.append(
                f"  {name} against {than}: {abs(percent):.1f} % {'less' if percent > 0 else 'more'} error"
                f" (95 % interval of the gain {low:.1f} to {high:.1f} %, {better} of {over.runs} runs better)"
            )
    if a.verdict == "unexplained":
        nearest = ", ".join(c.id for c in a.candidates[:4])
        out.append(f"nearest, and not enough: {nearest}")
    elif a.verdict != "nothing_missing":
        ranked = ", ".join(f"{c.id} {c.probability:.2f}" for c in a.candidates[:4])
        out.append(f"candidates: {ranked}")
    if found.orders:
        parts = ", ".join(f"{o.per_turn:.2f} ({100 * o.share:.0f} % of its variance)" for o in found.orders)
        out.append(f"what is left inside runs is periodic in the motor angle, per turn: {parts}")
    arguments = list(inspect.signature(found.shipped_module.mechanical_friction_torque).parameters)[:-2]
    name = f"{found.base.name}_extended"
    out.append(f"to call: {name}_mechanical_friction_torque({', '.join([*arguments, f'&{name}_default'])})")
    if a.next_measurement:
        out.append(f"next: {a.next_measurement}")
    return out
