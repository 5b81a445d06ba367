"""The inputs of a plan: log and rivals, from a diagnosis, or from its document and the log."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.core import InputError, few, given_path, read_document
from eccentric.diagnosis import (
    Candidate,
    Diagnosis,
    NextMeasurement,
    Screen,
    Variant,
    constant_first,
    next_measurement,
    staged_log,
)
from eccentric.effects import Effect, Words
from eccentric.identification import FitData
from eccentric.logs import LogSource
from eccentric.model import Model
from eccentric.planning.limits import LEAST_CHANCE
from eccentric.rigs import Rig


@dataclass(frozen=True)
class Rival:
    """One explanation of a log."""

    family: str  # its distinguishing effect, "" for none
    headline: str  # that of the effect, "" for none
    balance: str  # the balance in which it appears
    variants: tuple[Variant, ...]  # the effects common to all rivals, then its distinguishing one
    coefficients: np.ndarray  # of the base, then of the variants, in the order of the balance's design
    chance: float  # its probability given the log, relative to the other rivals


def rivals_of(diagnosis: Diagnosis) -> tuple[Rival, ...]:
    """The rivals of a tie, most probable first; without a tie, the identified model alone."""
    attribution = diagnosis.attribution
    adopted = attribution.adopted if attribution.verdict in {"not_identifiable", "named"} else ()
    if not adopted:
        return (rival_of(attribution.searches["mechanical"].screen, (), None),)
    first = next((one for one in adopted if one.alike), adopted[0])
    leading, search = first.variant.candidate, attribution.searches[first.balance]
    best = search.best.variants
    place = next(k for k, variant in enumerate(best) if variant.candidate.id == leading.id)
    options = search.alternatives[place]
    likely = {c.family: c.probability for c in attribution.candidates}
    rivals = []
    for family in dict.fromkeys([leading.family, *first.alike]):
        if family == leading.family:
            variants = (*best[:place], *best[place + 1 :], best[place])
        elif family in options:
            variants = options[family][1].variants
        else:
            continue
        rivals.append(rival_of(search.screen, tuple(variants), likely.get(family)))
    return shared(rivals)


def rival_of(screen: Screen, variants: tuple[Variant, ...], likely: float | None) -> Rival:
    """Fit the base model and these variants, the last one distinguishing; `likely` is its probability."""
    coefficients = screen.fit(variants).coefficients
    if not variants:
        return Rival("", "", screen.balance.name, (), coefficients, 1.0)
    effect = variants[-1].candidate
    headline = effect.words.headline or effect.family
    chance = max(likely or 0.0, LEAST_CHANCE)
    return Rival(effect.family, headline, screen.balance.name, variants, coefficients, chance)


def shared(rivals: Sequence[Rival]) -> tuple[Rival, ...]:
    """The rivals with probabilities normalised to sum to one, most probable first."""
    total = sum(rival.chance for rival in rivals)
    return tuple(sorted((replace(r, chance=r.chance / total) for r in rivals), key=lambda r: -r.chance))


FORMAT = "eccentric-diagnosis/1"


@dataclass(frozen=True)
class Question:
    """The open question, and the data to judge a motion by."""

    # explanations of the log, most probable first; a single one where nothing is open
    rivals: tuple[Rival, ...]
    data: FitData  # drive and signals of the log
    model: Model  # the base model
    friction: np.ndarray  # its coefficients, first fit
    screen: Screen  # the balance of the rivals on the log, with their candidates and the declared values
    effects: tuple[Effect, ...]  # effects of the library, including those of the candidates
    # a measurement that needs more than a motion, None where nothing is open
    otherwise: NextMeasurement | None = None
    follows: tuple[str, ...] = ()  # variables of an unexplained structure in the residual
    # ids of the named effects of the other balance, which no motion is judged by
    elsewhere: tuple[str, ...] = ()


def question_of(diagnosis: Diagnosis) -> Question:
    """The open question of a diagnosis.

    Raises:
        InputError: the log does not fit the rig.
    """
    if not diagnosis.models.fits_the_rig:
        raise _unfit(diagnosis.rig.path, f" ({diagnosis.models.misfit})")
    searched, rivals = diagnosis.attribution.searches, rivals_of(diagnosis)
    unexplained = diagnosis.attribution.verdict == "unexplained"
    elsewhere = (
        a.variant.candidate.id for a in diagnosis.attribution.adopted if a.balance != rivals[0].balance
    )
    return Question(
        rivals,
        diagnosis.data,
        diagnosis.models.base,
        searched["mechanical"].base.coefficients,
        searched[rivals[0].balance].screen,
        diagnosis.offered,
        diagnosis.attribution.next_measurement,
        diagnosis.attribution.depends_on if unexplained else (),
        tuple(elsewhere),
    )


def question_from(
    document: str | os.PathLike[str] | Mapping[str, Any],
    logs: Sequence[LogSource],
    rig: Rig,
    model: str | Model | None,
) -> Question:
    """The open question of an earlier diagnosis of these logs, from its diagnosis.json, without a search.

    The candidates come from the document; the information on each rival and the base model, and the noise,
    from the logs.

    Raises:
        InputError: it is no such document, or of other logs or masses, another model or user-defined
            effects; its log does not fit the rig; or the logs do not show the effects it names.
    """
    where = "diagnosis" if isinstance(document, Mapping) else str(given_path(document, "diagnosis"))
    content = document if isinstance(document, Mapping) else read_document(Path(where), "a diagnosis.json")
    _require_known(content, where)
    if not content["fits_the_rig"]:
        raise _unfit(rig.path)
    stage, names = staged_log(logs, rig, model)
    # Only names are compared: folders may have been typed differently.
    if [Path(name).name for name in names] != [Path(str(name)).name for name in content["logs"]]:
        raise InputError(
            f"{where}: logs",
            f"the diagnosis of {few(names)}",
            f"that of {few([str(name) for name in content['logs']])}",
        )
    if content.get("added_kg", {}) != rig.added_kg:
        raise InputError(
            f"{where}: added_kg",
            f"the masses of the rig, {rig.added_kg or 'none'}",
            content.get("added_kg", "none"),
        )
    if content["model"] != stage.plain.name:
        raise InputError(f"{where}: model", f"that of these logs, {stage.plain.name}", content["model"])
    adopted = tuple(content["extended_by"]) if content["verdict"] in {"not_identifiable", "named"} else ()
    tied, family = tuple(content["tied"]), {c["id"]: c["family"] for c in content["candidates"]}
    # With an effect named, any other tie.
    tied = tied or next((tuple(one["alike"]) for one in content.get("undecided", ())), ())
    likely = {c["family"]: c["probability"] for c in content["candidates"]}
    # The largest where nothing is tied, as in `rivals_of`.
    leading = next((name for name in adopted if family.get(name) in tied), adopted[0] if adopted else "")
    beside = [name for name in adopted if name != leading]
    rivals = [
        leading,
        *(name for name in family if family[name] in tied and family[name] != family.get(leading)),
    ]
    requested = {*beside, *rivals} - {""}
    effects = tuple(e for e in stage.offered if e.id in requested or e.corrects is not None)
    if unknown := requested - {e.id for e in effects}:
        raise InputError(where, "effects that these logs can show", min(unknown))
    candidates = stage.candidates(effects)
    # Effects of the other balance do not matter for the rivals.
    shown = {c.id: c.balance for c in candidates} | {"": "mechanical"}
    balance = next(b for b in stage.balances if b.name == shown[leading])
    beside, rivals = ([n for n in some if shown[n] == balance.name] for some in (beside, rivals))
    screen = Screen(balance, [c for c in candidates if c.balance == balance.name], stage.noise[balance.name])
    by_id = {c.id: c for c in candidates}
    fitted = [
        rival_of(
            screen,
            _fitted(screen, [by_id[n] for n in (*beside, name) if n]),
            likely.get(family.get(name, "")),
        )
        for name in rivals
    ]
    words = {e.id: e.words for e in stage.offered}
    best = {c["family"]: words.get(c["id"], Words()) for c in content["candidates"]}
    open_ = tuple(name for name in content["tied"] if name in best)
    otherwise = next_measurement(
        content["verdict"], [(name, best[name]) for name in open_], content["residual_depends_on"]
    )
    otherwise = constant_first(otherwise, open_, stage.offered, stage.data)
    follows = content["residual_depends_on"] if content["verdict"] == "unexplained" else ()
    return Question(
        shared(fitted),
        stage.data,
        stage.base,
        stage.friction,
        screen,
        effects,
        otherwise,
        tuple(follows),
        tuple(name for name in adopted if shown[name] != balance.name),
    )


def _fitted(screen: Screen, candidates: Sequence[Candidate]) -> tuple[Variant, ...]:
    """The candidates, fitted together, at their best shapes."""
    variants: list[Variant] = []
    for candidate in candidates:
        look = [screen.points[number] for _, number in screen.first_look(variants)]
        best = next((v for v in look if v.candidate.id == candidate.id), None)
        if best is None:
            raise InputError("diagnosis", "effects that these logs determine", candidate.id)
        variants.append(best)
    return screen.refine(screen.fit(variants)).variants


def _require_known(content: Mapping[str, Any], where: str) -> None:
    if content.get("format") != FORMAT:
        raise InputError(where, f"a document of format {FORMAT}", f"{content.get('format')!r}")
    needed = "fits_the_rig logs model verdict tied extended_by candidates residual_depends_on"
    if missing := [key for key in needed.split() if key not in content]:
        raise InputError(where, ", ".join(missing), "none: diagnose the logs again")
    request = content.get("asked", {})
    requested = [word for key in ("with", "without", "only") for word in request.get(key, ())]
    if requested:
        raise InputError(
            where,
            "a diagnosis without effects to begin with or to leave out",
            f"one with {', '.join(requested)}",
        )


def _unfit(path: str, how: str = "") -> InputError:
    return InputError(
        path,
        "a log that fits the rig",
        f"one that does not{how}: correct the rig file or the log first",
        why="to plan from",
    )
