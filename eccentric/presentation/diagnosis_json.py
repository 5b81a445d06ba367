"""A diagnosis as a document: diagnosis.json, format eccentric-diagnosis/1."""

from __future__ import annotations

import math
from typing import Any

import sympy as sp

from eccentric.diagnosis import Diagnosis
from eccentric.effects import Effect
from eccentric.identification import Estimate, in_drive_unit
from eccentric.model import TURNING, AxisKind
from eccentric.presentation.diagnosis_text import (
    aliases_of,
    diagnosis_sentence,
    tied_families,
    undeclared_parts,
)
from eccentric.presentation.fit_json import estimate_entry, gain_entry, ranges
from eccentric.presentation.plan_text import measurement_sentence
from eccentric.presentation.ranges_text import excluded_causes, possible_causes, range_document
from eccentric.signals import Channels


def diagnosis_document(found: Diagnosis) -> dict[str, Any]:
    """The content of diagnosis.json, format eccentric-diagnosis/1 (keys as in the manual)."""
    a, axis, below = found.attribution, found.rig.axis, found.score.below
    document = {
        "format": "eccentric-diagnosis/1",
        **({} if axis is TURNING else {"kind": axis.name}),
        "logs": list(found.asked.logs),
        "model": found.models.base.name,
        "asked": {
            "with": list(found.asked.request.including),
            "without": list(found.asked.request.without),
            "only": list(found.asked.request.only),
            "empirical": found.asked.request.empirical,
        },
        "verdict": a.verdict,
        "fits_the_rig": found.models.fits_the_rig,
        "sentence": diagnosis_sentence(found),
        "effects": [_effect(found, effect) for effect, _ in found.effects],
        "undecided": [
            {**_effect(found, effect), "alike": list(own.alike)}
            for effect, _ in found.undecided
            if (own := found.attribution.adopted_as(effect.id)) is not None
        ],
        "tied": list(tied_families(found)),
        "clear": [_effect(found, effect) for effect, _ in found.clear],
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
        "range_checks": [range_document(check) for check in found.ranges],
        "parts": {kind: list(words) for kind, words in found.rig.parts.items()},
        "ruled_out": _ruled_out(found),
        "undeclared_parts": list(undeclared_parts(found)),
        "extended_by": [effect.id for effect, _ in found.result.effects],
        "empirical": _empirical(found),
        "residual_depends_on": [axis.named(variable) for variable in a.depends_on],
        "next_measurement": measurement_sentence(a.next_measurement, axis),
        **_errors(found),
        "improvement": {
            "balance": found.score.balance,
            **gain_entry(found.score.percent, found.score.interval),
        },
        "improvement_below_low_pass": below and gain_entry(below.percent, below.interval),
        "closest_effect": _closest(found),
        "better_model": _sibling(found),
        f"noise_floor_{_suffix(found)}": found.noise_floor,
        "error_band": None if found.band is None else vars(found.band),
        "null_test": {
            name: {"gain": gain, "by_chance_99": level} for name, (gain, level) in a.deviance.items()
        },
        "unconfirmed": _unconfirmed(found),
        "data_quality": [
            {
                "kind": f.kind,
                "channel": axis.named(f.channel),
                "text": f.text,
                "rows": f.rows,
                "severity": f.severity,
            }
            for f in found.channels.intake.findings
        ],
        "periodic_per_motor_turn": [
            {"order": o.per_turn, "amplitude": o.amplitude, "share": o.share, "seen": [o.seen, o.stretches]}
            for o in found.orders
        ],
        "rig_identified": _identified(found),
        "ranges": ranges(found.channels),
        "holdout": holdout_entry(found.channels),
        "rows": found.channels.counts,
        **({"excerpt": found.channels.excerpt} if found.channels.excerpt else {}),
        **({"added_kg": found.rig.added_kg} if found.rig.added else {}),
        "settled": not found.models.unsettled,
        "warnings": list(found.warnings),
    }
    return axis.keyed(document)


def holdout_entry(channels: Channels) -> dict[str, Any]:
    """The rule of the held-out part and its intervals of time."""
    holdout = channels.selection.holdout
    return {"rule": holdout.rule, "intervals_s": [list(map(float, pair)) for pair in holdout.intervals_s]}


def _ruled_out(found: Diagnosis) -> list[dict[str, Any]]:
    """Effects that explain more, or as well, with the parts that they need and this drive does not have.

    With the periods that the log travels, for those that repeat with an angle.
    """
    effects = {effect.id: effect for effect in found.offered}
    return [
        {
            "id": c.id,
            "family": c.family,
            "explains": explains,
            "needs": {k: list(words) for k, words in effects[c.id].lacks(found.rig.parts).items()},
            **(
                {"periods_seen": seen}
                if math.isfinite(seen := effects[c.id].periods_seen(found.setting))
                else {}
            ),
        }
        for explains, ranked in (
            ("more", found.attribution.ruled_out),
            ("as well", found.attribution.excluded),
        )
        for c in ranked
    ]


def _unconfirmed(found: Diagnosis) -> dict[str, Any]:
    """Effects that fitted the training part and that the held-out part did not confirm, with its figures."""
    effects, refused = {"effects": list(found.attribution.unconfirmed)}, found.refused
    return effects | ({"improvement": gain_entry(refused.percent, refused.interval)} if refused else {})


def _closest(found: Diagnosis) -> dict[str, Any] | None:
    """The best effect where none is adopted, with what it gains on the held-out part."""
    if (best := found.closest) is None:
        return None
    return {
        "id": best.effect.id,
        "family": best.effect.family,
        "balance": best.balance,
        f"rmse_holdout_{_suffix(found)}": {"paper": best.before, "extended": best.after},
        "improvement": gain_entry(best.percent, best.interval),
        "improvement_below_low_pass": best.below and gain_entry(best.below.percent, best.below.interval),
    }


def _empirical(found: Diagnosis) -> dict[str, Any] | None:
    """The term without a cause of the emitted model; null where it has none."""
    own, axis = found.empirical, found.rig.axis
    if own is None or not own.confirmed:
        return None
    return {
        "id": own.effect.id,
        "variables": [axis.named(name) for name in own.variables],
        "knots": [
            {
                "variable": axis.named(curve.variable),
                "kind": "conservative" if curve.conservative else "friction",
                "by_direction": curve.each_way,
                "at": list(curve.knots),
            }
            for curve in own.curves
        ],
        "coefficients": own.coefficients,
        "gain": gain_entry(own.percent, own.interval),
    }


def _sibling(found: Diagnosis) -> dict[str, Any] | None:
    """The shipped model that predicts the held-out part better than what was found."""
    if (better := found.sibling) is None:
        return None
    return {
        "model": better.name,
        f"rmse_holdout_{_suffix(found)}": better.rmse,
        "improvement": gain_entry(better.percent, better.interval),
    }


def _suffix(found: Diagnosis) -> str:
    return found.rig.axis.unit(found.unit).replace(" ", "")


def _errors(found: Diagnosis) -> dict[str, Any]:
    """Held-out errors; also in the drive's unit if the torque is not measured, and those of free motion."""
    score, drive = found.score, found.data.drive
    errors = {k: dict(v) for k, v in score.rmse.items()}
    if found.empirical is not None and found.empirical.confirmed:
        errors["mechanical"]["empirical"] = found.empirical.rmse[1]
    said: dict[str, Any] = {f"rmse_holdout_{_suffix(found)}": errors}
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
                name: gain_entry(percent, interval) | {"better_runs": better}
                for name, (percent, interval, better) in over.gains.items()
            },
            "below_low_pass": over.below and gain_entry(*over.below),
        }
    return said


def _identified(found: Diagnosis) -> dict[str, Any]:
    """What the rig leaves to be identified: alignment, and quantities with their uncertainty.

    A zero angle or an offset that the refit has moved replaces that of the first fit.
    """
    fitted, aligned = found.models.extended, found.channels.alignment
    of_the_model = {q.name for q in found.models.base.friction_parameters}
    of_the_model |= {q.name for effect, _ in fitted.effects for q in effect.parameters}
    said: dict[str, Any] = {name: getattr(aligned, name) for name in sorted(found.rig.estimate)}
    for name, e in fitted.estimates.items():
        if name not in of_the_model:
            said[name] = estimate_entry(e, found.rig.axis)
    return said


def _estimated(value: float, estimate: Estimate | None, unit: str, axis: AxisKind) -> dict[str, Any]:
    """A value as an estimate of fit.json; null where nothing was estimated."""
    if estimate is None:
        estimate = Estimate(value, math.nan, (math.nan, math.nan), unit)
        return {**estimate_entry(estimate, axis, unit), "interval_95": None}
    return {**estimate_entry(estimate, axis, unit), "value": value}


def _stability(found: Diagnosis, effect: Effect) -> dict[str, Any] | None:
    """In how many variants of the log the search finds the effect, and what it finds instead."""
    own = found.attribution.adopted_as(effect.id)
    if own is None or not own.variants:
        return None
    return {"variants": own.variants, "found": own.found, "instead": dict(own.instead)}


def _effect(found: Diagnosis, effect: Effect) -> dict[str, Any]:
    values = dict(next(own for e, own in found.models.extended.effects if e is effect))
    parameters, axis = {}, found.rig.axis
    for q in effect.parameters:
        estimate = found.models.extended.estimates.get(q.name)
        unit = axis.unit(in_drive_unit(q.unit, found.unit))
        parameters[q.name] = _estimated(values[q.name], estimate, unit, axis)
    equation = effect.equation()
    return {
        "id": effect.id,
        "family": effect.family,
        "headline": effect.words.headline,
        "causes": [cause.name for cause in possible_causes(found, effect)],
        "excluded_causes": [cause.name for cause in excluded_causes(found, effect)],
        "balance": effect.balance,
        "corrects": None if effect.corrects is None else axis.named(effect.corrects.quantity.name),
        "equation": axis.named(f"{equation.left} = {sp.sstr(equation.right)}"),
        "formula": effect.formula,
        "reference": effect.reference,
        "parameters": parameters,
        "share_of_friction_rms": found.models.extended.shares.get(effect.id, 0.0),
        "stability": _stability(found, effect),
        "aliases": list(aliases_of(found, effect)),
    }
