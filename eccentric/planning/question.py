"""What a plan starts from: the log as its rivals see it, from a diagnosis, or its document and the log."""

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

# What a diagnosis left open: the fits that explain its log alike, each with the log's own evidence.


@dataclass(frozen=True)
class Rival:
    """One explanation of a log.

    Attributes:
        family: the effect that it has in place of the others'; headline: that of the effect; "" for none.
        balance: the one that shows it.
        variants: the effects that all rivals have, then its own.
        coefficients: of the base, then of the variants, in the order of the balance's design.
        chance: its probability on the log, relative to the other rivals.
    """

    family: str
    headline: str
    balance: str
    variants: tuple[Variant, ...]
    coefficients: np.ndarray
    chance: float


def rivals_of(found: Diagnosis) -> tuple[Rival, ...]:
    """The rivals of a tie, most probable first; without one, the model that was found, alone."""
    attribution = found.attribution
    kept = attribution.adopted if attribution.verdict in {"not_identifiable", "named"} else ()
    if not kept:
        return (rival_of(attribution.searches["mechanical"].screen, (), None),)
    first = next((one for one in kept if one.alike), kept[0])
    own, search = first.variant.candidate, attribution.searches[first.balance]
    best = search.best.variants
    place = next(k for k, variant in enumerate(best) if variant.candidate.id == own.id)
    options = search.alternatives[place]
    likely = {c.family: c.probability for c in attribution.candidates}
    rivals = []
    for family in dict.fromkeys([own.family, *first.alike]):
        if family == own.family:
            variants = (*best[:place], *best[place + 1 :], best[place])
        elif family in options:
            variants = options[family][1].variants
        else:
            continue
        rivals.append(rival_of(search.screen, tuple(variants), likely.get(family)))
    return shared(rivals)


def rival_of(screen: Screen, variants: tuple[Variant, ...], likely: float | None) -> Rival:
    """The fit of the base model and these variants, the last of them its own; `likely` its probability."""
    coefficients = screen.fit(variants).coefficients
    if not variants:
        return Rival("", "", screen.balance.name, (), coefficients, 1.0)
    own = variants[-1].candidate
    words = own.words.headline or own.family
    chance = max(likely or 0.0, LEAST_CHANCE)
    return Rival(own.family, words, screen.balance.name, variants, coefficients, chance)


def shared(rivals: Sequence[Rival]) -> tuple[Rival, ...]:
    """The rivals with probabilities that add to one, most probable first."""
    whole = sum(rival.chance for rival in rivals)
    return tuple(sorted((replace(r, chance=r.chance / whole) for r in rivals), key=lambda r: -r.chance))


FORMAT = "eccentric-diagnosis/1"


@dataclass(frozen=True)
class Question:
    """What is open, and all that a motion is judged by.

    Attributes:
        rivals: what explains the log, most probable first; one alone where nothing is open.
        data: drive and signals of the log; model: the base model; friction: its coefficients, first fit.
        screen: the log's balance that shows the rivals, with their candidates and the declared values.
        effects: of the library, those that the candidates are made of among them.
        otherwise: a measurement that needs more than a motion, None where nothing is open.
        follows: variables of the structure that no effect explains, for a log with some.
        elsewhere: ids of the named effects that the other balance shows: no motion is judged by them.
    """

    rivals: tuple[Rival, ...]
    data: FitData
    model: Model
    friction: np.ndarray
    screen: Screen
    effects: tuple[Effect, ...]
    otherwise: NextMeasurement | None = None
    follows: tuple[str, ...] = ()
    elsewhere: tuple[str, ...] = ()


def question_of(found: Diagnosis) -> Question:
    """The question that a diagnosis left.

    Raises:
        InputError: the log does not fit the rig.
    """
    if not found.models.fits_the_rig:
        raise _unfit(found.rig.path, f" ({found.models.misfit})")
    searched, rivals = found.attribution.searches, rivals_of(found)
    unexplained = found.attribution.verdict == "unexplained"
    elsewhere = (a.variant.candidate.id for a in found.attribution.adopted if a.balance != rivals[0].balance)
    return Question(
        rivals,
        found.data,
        found.models.base,
        searched["mechanical"].base.coefficients,
        searched[rivals[0].balance].screen,
        found.offered,
        found.attribution.next_measurement,
        found.attribution.depends_on if unexplained else (),
        tuple(elsewhere),
    )


def question_from(
    document: str | os.PathLike[str] | Mapping[str, Any],
    logs: Sequence[LogSource],
    rig: Rig,
    model: str | Model | None,
) -> Question:
    """The question that an earlier diagnosis of these logs left, by its diagnosis.json: no search is run.

    What is open comes from the document; the logs say how well each rival and the base model are known, and
    how large the noise is.

    Raises:
        InputError: it is no such document, or of other logs or masses, another model or effects of one's
            own; its log does not fit the rig; or the logs do not show what it names.
    """
    where = "diagnosis" if isinstance(document, Mapping) else str(given_path(document, "diagnosis"))
    said = document if isinstance(document, Mapping) else read_document(Path(where), "a diagnosis.json")
    _require_known(said, where)
    if not said["fits_the_rig"]:
        raise _unfit(rig.path)
    stage, names = staged_log(logs, rig, model)
    # The folders of logs with one name are as they were typed, here and there.
    if [Path(name).name for name in names] != [Path(str(name)).name for name in said["logs"]]:
        raise InputError(
            f"{where}: logs",
            f"the diagnosis of {few(names)}",
            f"that of {few([str(name) for name in said['logs']])}",
        )
    if said.get("added_kg", {}) != rig.added_kg:
        raise InputError(
            f"{where}: added_kg",
            f"the masses of the rig, {rig.added_kg or 'none'}",
            said.get("added_kg", "none"),
        )
    if said["model"] != stage.plain.name:
        raise InputError(f"{where}: model", f"that of these logs, {stage.plain.name}", said["model"])
    adopted = tuple(said["extended_by"]) if said["verdict"] in {"not_identifiable", "named"} else ()
    tied, family = tuple(said["tied"]), {c["id"]: c["family"] for c in said["candidates"]}
    # Beside a name, what else it left open.
    tied = tied or next((tuple(one["alike"]) for one in said.get("undecided", ())), ())
    likely = {c["family"]: c["probability"] for c in said["candidates"]}
    # The largest where nothing is tied, as in `rivals_of`.
    own = next((name for name in adopted if family.get(name) in tied), adopted[0] if adopted else "")
    beside = [name for name in adopted if name != own]
    rivals = [own, *(name for name in family if family[name] in tied and family[name] != family.get(own))]
    asked = {*beside, *rivals} - {""}
    effects = tuple(e for e in stage.offered if e.id in asked or e.corrects is not None)
    if unknown := asked - {e.id for e in effects}:
        raise InputError(where, "effects that these logs can show", min(unknown))
    candidates = stage.candidates(effects)
    # What the other balance lacks changes nothing in the one that shows what is open.
    shown = {c.id: c.balance for c in candidates} | {"": "mechanical"}
    balance = next(b for b in stage.balances if b.name == shown[own])
    beside, rivals = ([n for n in some if shown[n] == balance.name] for some in (beside, rivals))
    screen = Screen(balance, [c for c in candidates if c.balance == balance.name], stage.noise[balance.name])
    by_id = {c.id: c for c in candidates}
    found = [
        rival_of(
            screen,
            _fitted(screen, [by_id[n] for n in (*beside, name) if n]),
            likely.get(family.get(name, "")),
        )
        for name in rivals
    ]
    words = {e.id: e.words for e in stage.offered}
    best = {c["family"]: words.get(c["id"], Words()) for c in said["candidates"]}
    open_ = tuple(name for name in said["tied"] if name in best)
    otherwise = next_measurement(
        said["verdict"], [(name, best[name]) for name in open_], said["residual_depends_on"]
    )
    otherwise = constant_first(otherwise, open_, stage.offered, stage.data)
    follows = said["residual_depends_on"] if said["verdict"] == "unexplained" else ()
    return Question(
        shared(found),
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
    """The candidates, one beside the others, at their best shapes."""
    variants: list[Variant] = []
    for candidate in candidates:
        look = [screen.points[number] for _, number in screen.first_look(variants)]
        best = next((v for v in look if v.candidate.id == candidate.id), None)
        if best is None:
            raise InputError("diagnosis", "effects that these logs determine", candidate.id)
        variants.append(best)
    return screen.refine(screen.fit(variants)).variants


def _require_known(said: Mapping[str, Any], where: str) -> None:
    if said.get("format") != FORMAT:
        raise InputError(where, f"a document of format {FORMAT}", f"{said.get('format')!r}")
    needed = "fits_the_rig logs model verdict tied extended_by candidates residual_depends_on"
    if missing := [key for key in needed.split() if key not in said]:
        raise InputError(where, ", ".join(missing), "none: diagnose the logs again")
    asked = said.get("asked", {})
    given = [word for key in ("with", "without", "only") for word in asked.get(key, ())]
    if given:
        raise InputError(
            where, "a diagnosis without effects to begin with or to leave out", f"one with {', '.join(given)}"
        )


def _unfit(path: str, how: str = "") -> InputError:
    return InputError(
        path,
        "a log that fits the rig",
        f"one that does not{how}: correct the rig file or the log first",
        why="to plan from",
    )
