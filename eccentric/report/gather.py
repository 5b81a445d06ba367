"""A Diagnosis as the records of the report.

Apart from `balance` and `facts`, which this file calls, no other file of the report knows about fits.
"""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from eccentric.diagnosis import Diagnosis, closest_sentence, diagnosis_sentence, sibling_sentence
from eccentric.effects import Effect
from eccentric.report.balance import balance_of
from eccentric.report.data import AddedEffect, CandidateRow, Errors, Gain, Parameter, ReportData
from eccentric.report.equation import friction_equations, typesetter_of
from eccentric.report.facts import facts_of
from eccentric.report.text import number, range_of
from eccentric.rigs import KNOWNS
from eccentric.version import __version__

__all__ = ["report_data"]

_WORSE = {"paper": "Coulomb and viscous friction", "extended": "the paper's"}
_ORIGINS = ("effect", "friction", "bench", "rig", "model", "unseen")


def report_data(found: Diagnosis, files: Sequence[tuple[str, str]] = ()) -> ReportData:
    """The records of a diagnosis; `files` are (name, description) of everything written beside the report."""
    attribution, score, findings = found.attribution, found.score, found.channels.intake.findings
    effects = [effect for effect, _ in found.models.extended.effects]
    named = {effect.family for effect in effects}
    about = {effect.id: effect for effect in found.offered}
    names = sorted(score.rmse, key=lambda name: name != score.balance)
    return ReportData(
        logs=found.asked.logs,
        rig=found.asked.rig,
        model=found.models.base.name,
        model_title=found.models.base.title,
        verdict=attribution.verdict,
        sentence=diagnosis_sentence(found),
        balances=tuple(balance_of(found, name) for name in names),
        gain=Gain(score.balance, score.percent, score.interval) if found.models.adopted else None,
        further=tuple(_further(found)),
        holdout=found.channels.selection.holdout.rule,
        depends_on=attribution.depends_on,
        candidates=tuple(
            CandidateRow(
                c.id, c.family, c.balance, c.rmse, c.probability, c.family in named, *_words(about, c.id)
            )
            for c in attribution.candidates
        ),
        tied=attribution.tied,
        chance=attribution.deviance,
        effects=tuple(
            AddedEffect(
                id=e.id,
                balance=e.balance,
                meaning=e.words.meaning,
                formula=e.formula,
                reference=e.reference,
                share=found.models.extended.shares.get(e.id, 0.0),
                headline=e.words.headline,
            )
            for e in effects
        ),
        parameters=tuple(_parameters(found)),
        equations=tuple(friction_equations(found.models.extended.model, effects)),
        facts=tuple(facts_of(found)),
        warnings=tuple(text for text in found.warnings if text not in {f.text for f in findings}),
        findings=findings,
        next_measurement=attribution.next_measurement,
        closest=" ".join(filter(None, [closest_sentence(found), sibling_sentence(found)])),
        command=_command(found),
        files=tuple(files),
        version=__version__,
    )


def _words(about: dict[str, Effect], name: str) -> tuple[str, tuple[str, ...], str, str]:
    effect = about.get(name)
    if effect is None:
        return "", (), "", ""
    return effect.formula, effect.evidence.aliases, effect.words.hint, effect.words.headline


def _further(found: Diagnosis) -> list[Errors]:
    """Errors that only some logs have: in the drive's unit, of free motion, over whole runs."""
    score = found.score
    models = {"linear", "paper"} | ({"extended"} if found.models.adopted else set())

    def of(rmse: Mapping[str, float]) -> dict[str, float]:
        return {model: value for model, value in rmse.items() if model in models}

    further = []
    if score.per_drive:
        unit = {"voltage": "V", "current": "A", "torque": "N m"}[found.channels.motor.measured_by]
        further.append(Errors("mechanical balance, as measured", unit, of(score.per_drive)))
    if score.free:
        note = "These rows contain no electrical effect: only mechanical terms predict them."
        further.append(Errors("with the motor switched off", found.unit, of(score.free), note=note))
    if over := score.over_runs:
        gains = [
            f"Gain of the {name} model on {_WORSE[name]}: {number(percent, 3)} % (95 % interval"
            f" {range_of((low, high), 3)} %), in {better} of {over.runs} runs."
            for name, (percent, (low, high), better) in over.gains.items()
            if name in models
        ]
        note = " ".join(
            [
                "Coefficients refitted on the other runs; the effect itself was chosen on the training runs.",
                *gains,
            ]
        )
        interval = over.gains["extended"][1] if "extended" in over.gains and "extended" in models else None
        further.append(Errors("every run left out once", found.unit, of(over.rmse), interval, note))
    return further


def _parameters(found: Diagnosis) -> list[Parameter]:
    """Parameters of the effects, fitted friction, those of the bench that were estimated, and known ones."""
    own = {q.name for effect, _ in found.models.shipped.effects for q in effect.parameters}
    terms = found.models.shipped.model.balance("mechanical").terms
    friction = {str(term.coefficient) for term in terms if term.kind == "friction"}
    estimates = found.models.shipped.estimates
    given = {*found.data.drive.identified, *estimates}
    typeset, rows = typesetter_of(found.models.shipped.model), []
    for q in found.models.shipped.model.parameters:
        value = found.models.shipped.values.get(q.name)
        kinds = (
            ("effect", own),
            ("friction", friction),
            ("bench", given),
            ("rig", found.rig.known),
            ("model", found.data.drive.known.keys() - {known.name for known in KNOWNS}),
        )
        origin = next((name for name, letters in kinds if q.name in letters), "unseen")
        # A coefficient that is inseparable from another is not fitted: the other represents their sum.
        if value is None or (origin == "friction" and estimates and q.name not in estimates):
            continue
        row = Parameter(q.name, q.meaning, q.unit, value, origin, letter=typeset(q.symbol))
        if e := estimates.get(q.name):
            row = replace(
                row, std_error=e.std_error, interval=e.interval, bound=e.bound_active or "", widened=e.widened
            )
        rows.append(row)
    return sorted(rows, key=lambda row: _ORIGINS.index(row.origin))


def _command(found: Diagnosis) -> str:
    words = ["eccentric", "diagnose", *found.asked.logs, "--rig", found.asked.rig]
    if found.asked.model != found.rig.model and not found.asked.request.including:
        words += ["--model", Path(found.asked.model).name]
    if found.asked.effects is not None:
        words += ["--effects", found.asked.effects.name]
    request = found.asked.request
    for flag, names in (("with", request.including), ("without", request.without), ("only", request.only)):
        words += [word for name in names for word in (f"--{flag}", name)]
    return shlex.join([*words, "--out", "DIR"])
