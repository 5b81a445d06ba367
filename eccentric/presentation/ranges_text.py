"""What is known beside a log: ranges of the figures that a diagnosis found, and what the drive rules out."""

from __future__ import annotations

from typing import Any

from eccentric.diagnosis import Diagnosis, RangeCheck
from eccentric.effects import Effect
from eccentric.model import ANGLE, Parts


def effect_name(headline: str, effect_id: str) -> str:
    """The description of an effect, then its id; the id alone if there is no description."""
    return f"{headline} ({effect_id})" if headline else effect_id


def range_document(check: RangeCheck) -> dict[str, Any]:
    """A figure beside its range, as diagnosis.json has it."""
    known = check.known
    return {
        "effect": check.effect,
        "figure": known.name,
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
    place = f"{check.outside} the known range" if check.outside else "not outside the known range"
    return (
        f"{known.name}: {check.value:.3g}{unit} (95 % interval {low:.3g} to {high:.3g}{unit}), {place},"
        f" {known.low:.3g} to {known.high:.3g}{unit} ({known.source})"
    )


def _unit(check: RangeCheck) -> str:
    return "" if check.known.unit == "1" else f" {check.known.unit}"


def ruled_out_sentence(found: Diagnosis) -> str:
    """Which effect explains more, but needs a part that the drive does not have; "" for none."""
    effects = {effect.id: effect for effect in found.offered}
    best = next((effects[c.id] for c in found.attribution.ruled_out if c.id in effects), None)
    if best is None:
        return ""
    name = effect_name(best.words.headline, best.id)
    return f"{name[0].upper()}{name[1:]} explains more of it, but {_needs(best, found.rig.parts)}."


def _needs(effect: Effect, parts: Parts) -> str:
    return " and ".join(
        "it needs the angle of the motor, which is not in a log of the output of this gear (mu = 1)"
        if kind == ANGLE
        else f'it needs {kind} = "{_any_of(words)}" where the rig file has "{" + ".join(parts[kind])}"'
        for kind, words in effect.lacks(parts).items()
    )


def _any_of(words: tuple[str, ...]) -> str:
    return '" or "'.join(words)
