"""The sequence of pieces that separates the closest rivals, one piece after another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import permutations

import numpy as np

from eccentric.errors import InputError
from eccentric.planning.bounds import Bounds
from eccentric.planning.limits import EVALUATIONS, LEAST_PIECE_S, MARGIN, PIECES, RATE_HZ
from eccentric.planning.motion import Reference, Segment, joined, pieces
from eccentric.planning.separation import Ground, Separation

__all__ = ["chosen"]

Offer = tuple[Segment, Ground]


def chosen(
    separation: Separation, bounds: Bounds, seed: int, tell: Callable[[str], None]
) -> tuple[Reference, tuple[str, ...], dict[tuple[str, str], float]]:
    """The motion, its pieces in words, and how far it leaves the rivals apart, log included.

    Greedy: each piece is the one that adds most to those before it. Then the sequence as a whole is compared
    with its best pieces repeated, which shows what drifts with time.

    Raises InputError if no piece stays within the bounds.
    """
    count = int(np.clip(bounds.time / LEAST_PIECE_S, 2, PIECES))
    seconds = bounds.time / count
    offers: list[Offer] = []
    for piece in pieces(bounds, seconds, np.random.default_rng(seed)):
        ground = separation.ground(joined([piece], bounds))
        if np.max(np.abs(ground.current)) <= (1.0 - MARGIN) * bounds.current:
            offers.append((piece, ground))
    if not offers:
        raise InputError(
            f"limits: current_A: enough for the slowest motion is required, received {bounds.current:g} A"
        )
    tell(f"{len(offers)} pieces of motion within the limits")
    taken: list[Offer] = []
    left = bounds.time
    while fitting := [offer for offer in offers if _length(offer[0]) <= left + 1e-9]:
        grounds = [separation.log, *(ground for _, ground in taken)]
        best = max(fitting, key=lambda offer: _worth(separation, [*grounds, offer[1]]))
        taken.append(best)
        left -= _length(best[0])
    sequences = [[piece for piece, _ in taken]]
    for piece in dict.fromkeys(piece.words for piece, _ in taken):
        own = next(p for p, _ in taken if p.words == piece)
        sequences.append([own] * max(int(bounds.time / _length(own)), 1))
    found = []
    for parts in sequences:
        motion = joined(parts, bounds)
        ground = separation.ground(motion)
        if np.max(np.abs(ground.current)) <= bounds.current:
            found.append((_worth(separation, [separation.log, ground]), motion, parts, ground))
    if not found:
        raise InputError(
            "limits: current_A: enough for the pieces one after another is required,"
            f" received {bounds.current:g} A"
        )
    _, motion, parts, ground = max(found, key=lambda one: one[0])
    tell("judging the motion")
    return motion, tuple(p.words for p in parts), _pairs(separation, [separation.log, ground], EVALUATIONS)


def _length(piece: Segment) -> float:
    return len(piece.omega) / RATE_HZ


def _pairs(
    separation: Separation, grounds: Sequence[Ground], evaluations: int = 0
) -> dict[tuple[str, str], float]:
    return {
        (truth.family, other.family): separation.apart(truth, other, grounds, evaluations)
        for truth, other in permutations(separation.rivals, 2)
    }


def _worth(separation: Separation, grounds: Sequence[Ground]) -> float:
    """What grounds are worth: how far the true rival is from the closest other; alone, how well it is known.

    Alone: the log determinant of the information on its coefficients, D-optimality.
    """
    if len(separation.rivals) == 1:
        return float(np.linalg.slogdet(separation.information(separation.rivals[0], grounds))[1])
    pairs = _pairs(separation, grounds)
    return sum(
        rival.chance * float(np.log1p(min(d for (truth, _), d in pairs.items() if truth == rival.family)))
        for rival in separation.rivals
    )
