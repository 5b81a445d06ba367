"""What a diagnosis left open: the fits that explain its log alike, each with the log's own evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from eccentric.diagnosis import Diagnosis
from eccentric.planning.limits import LEAST_CHANCE
from eccentric.search import Screen, Variant

__all__ = ["Rival", "rival_of", "rivals_of", "shared"]


@dataclass(frozen=True)
class Rival:
    """One explanation of a log.

    Attributes:
        family: the effect that it has in place of the others', "" for none; headline: the same in words.
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
        return Rival("", "the friction of the paper's model", screen.balance.name, (), coefficients, 1.0)
    own = variants[-1].candidate
    words = own.words.headline or own.family
    chance = max(likely or 0.0, LEAST_CHANCE)
    return Rival(own.family, words, screen.balance.name, variants, coefficients, chance)


def shared(rivals: Sequence[Rival]) -> tuple[Rival, ...]:
    """The rivals with probabilities that add to one, most probable first."""
    whole = sum(rival.chance for rival in rivals)
    return tuple(sorted((replace(r, chance=r.chance / whole) for r in rivals), key=lambda r: -r.chance))
