"""What is known beside a log: ranges of the figures that a diagnosis found, and what the drive rules out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from eccentric.diagnosis import Diagnosis, RangeCheck
from eccentric.effects import Effect, PossibleCause
from eccentric.model import ANGLE, DRIVE_PARTS, REDUCERS, Parts, missing
from eccentric.rigs import Rig


def effect_name(headline: str, effect_id: str) -> str:
    """The description of an effect, then its id; the id alone if there is no description."""
    return f"{headline} ({effect_id})" if headline else effect_id


def range_document(check: RangeCheck) -> dict[str, Any]:
    """A figure beside its range, as diagnosis.json has it."""
    known = check.known
    return {
        "effect": check.effect,
        "figure": known.name.rstrip(","),
        "value": check.value,
        "interval_95": list(check.interval),
        "unit": known.unit,
        "range": [known.low, known.high],
        "usual": known.usual,
        "source": known.source,
        "outside": check.outside,
    }


def outside_sentences(found: Diagnosis) -> list[str]:
    """One sentence for each figure that lies outside its range."""
    return [_outside(check) for check in found.ranges if check.outside]


def _outside(check: RangeCheck) -> str:
    known, meaning = check.known, {"above": check.known.above, "below": check.known.below}[check.outside]
    if known.usual:
        where = f"{check.value / known.usual:.2g} times {known.whose}"
    else:
        where = f"{check.value:.3g}{_unit(check)}, {check.outside} the known range"
    return f"{known.name[0].upper()}{known.name[1:]} is {where}{f': {meaning}' if meaning else ''}."


def range_line(check: RangeCheck) -> str:
    """A figure with its interval, whether it is in its range, and the source of that."""
    known, (low, high), unit = check.known, check.interval, _unit(check)
    place = f"{check.outside} the known range" if check.outside else "consistent with the known range"
    return (
        f"{known.name.rstrip(',')}: {check.value:.3g}{unit}"
        f" (95 % interval {low:.3g} to {high:.3g}{unit}), {place},"
        f" {known.low:.3g} to {known.high:.3g}{unit} ({known.source})"
    )


def _unit(check: RangeCheck) -> str:
    return "" if check.known.unit == "1" else f" {check.known.unit}"


def ruled_out_sentence(found: Diagnosis) -> str:
    """Which effect explains more, but needs another part or a longer travel; "" for none."""
    effects = {effect.id: effect for effect in found.offered}
    best = next((effects[c.id] for c in found.attribution.ruled_out if c.id in effects), None)
    if best is None:
        return ""
    name = effect_name(best.words.headline, best.id)
    if needs := _needs(best.only_with, found.rig.parts):
        return f"{name[0].upper()}{name[1:]} explains more of it, but it needs {needs}."
    return (
        f"{name[0].upper()}{name[1:]} explains more of it, but the log covers only"
        f" {best.periods_seen(found.setting):.2g} of the angle needed to tell it from other curves."
    )


def possible_causes(found: Diagnosis, effect: Effect) -> tuple[PossibleCause, ...]:
    """What may be behind an effect whose name says what it does: also families that fit this log as well."""
    own, effects = found.attribution.adopted_as(effect.id), {one.id: one for one in found.offered}
    best = {c.family: c for c in reversed(found.attribution.candidates)}
    covered = [best[family] for family in own.covers if family in best] if own else []
    return (
        *(cause for cause in effect.words.causes if not missing(cause.only_with, found.rig.parts)),
        *(PossibleCause(effect_name(c.words.headline, c.id), effects[c.id].only_with) for c in covered),
    )


def excluded_causes(found: Diagnosis, effect: Effect) -> tuple[PossibleCause, ...]:
    """The causes of an effect that this drive cannot have, also families that explain the log as well."""
    effects = {one.id: one for one in found.offered}
    others = [effects[c.id] for c in found.attribution.excluded if c.instead_of == effect.family]
    families = [one for one in others if one.lacks(found.rig.parts)]
    covered = (PossibleCause(effect_name(one.words.headline, one.id), one.only_with) for one in families)
    impossible = (cause for cause in effect.words.causes if missing(cause.only_with, found.rig.parts))
    return (*impossible, *covered)


def excluded_sentence(found: Diagnosis, effects: Iterable[Effect]) -> str:
    """What may not be behind these effects, since the drive cannot have it, and why; "" for nothing."""
    by_part: dict[str, dict[str, None]] = {}
    for effect in effects:
        for cause in excluded_causes(found, effect):
            by_part.setdefault(_needs(cause.only_with, found.rig.parts), {})[cause.name] = None
    causes = [
        f"{' and '.join(texts)}, which need{'s' * (len(texts) == 1)} {needs}"
        for needs, texts in by_part.items()
    ]
    return f"Excluded by the rig file: {'; '.join(causes)}." if causes else ""


def undeclared(given: Parts, needs: Sequence[Parts]) -> tuple[str, ...]:
    """Kinds of parts that a rig does not declare and that would rule out some of these needs, not all."""

    def narrows(kind: str, word: str) -> bool:
        return 0 < sum(bool(missing(one, {kind: (word,)})) for one in needs) < len(needs)

    return tuple(
        kind
        for kind, words in DRIVE_PARTS.items()
        if kind not in given and any(narrows(kind, word) for word in words)
    )


def parts_needed(effect: Effect, rig: Rig) -> Parts:
    """What a drive needs for an effect; at mu = 1 a gear that reduces hides the angle of the motor."""
    direct = ANGLE in effect.only_with and rig.known.get("mu") == 1.0
    return {**effect.only_with, **({"gear": tuple({*DRIVE_PARTS["gear"]} - REDUCERS)} if direct else {})}


def declare_sentence(kinds: Iterable[str]) -> str:
    """Which keys of the rig file would narrow the causes; "" for none."""
    keys = " and ".join(f'{kind} = "..."' for kind in kinds)
    return f"To narrow this down, declare {keys} in the rig file." if keys else ""


def _needs(only_with: Parts, parts: Parts) -> str:
    return " and ".join(
        "the angle of the motor, which is not in a log of the output of this gear (mu = 1)"
        if kind == ANGLE
        else f'{kind} = "{_any_of(words)}" where the rig file has "{" + ".join(parts[kind])}"'
        for kind, words in missing(only_with, parts).items()
    )


def _any_of(words: tuple[str, ...]) -> str:
    return '" or "'.join(words)
