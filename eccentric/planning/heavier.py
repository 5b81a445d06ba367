"""What a change of the rig would decide where no motion does: the same motion with more mass on the link.

A diagnosis takes logs of one rig: the log with another mass is judged alone, without the first one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eccentric.model import vocabulary as v
from eccentric.planning.bounds import Bounds
from eccentric.planning.chance import expected
from eccentric.planning.choice import kept, pairs
from eccentric.planning.limits import HEAVIER, STEPS
from eccentric.planning.motion import Segment
from eccentric.planning.separation import Separation

__all__ = ["Heavier", "with_more_mass"]


@dataclass(frozen=True)
class Heavier:
    """A mass that is added at the place of the one on the link [kg], and the probability that it decides."""

    added_kg: float
    probability: float


def with_more_mass(
    separation: Separation, parts: Sequence[Segment], bounds: Bounds, worth: Mapping[tuple[str, str], float]
) -> Heavier | None:
    """The motion with more mass, slower where the limits require it; None where it cannot be judged.

    That is without a known mass and its distance, or where the limits leave no motion.

    Args:
        separation: the rivals.
        parts: the motion.
        bounds: its limits.
        worth: (true family, other family) -> the factor on what is computed for two rivals.
    """
    known, link = separation.question.data.signals.known, separation.question.data.drive.machine.link
    mass, length = (known.get(q.symbol.name, 0.0) for q in (v.M, v.L))
    if not mass or not length or link not in known:
        return None
    added = HEAVIER * mass
    more = {v.M.symbol.name: mass + added, link: known[link] + added * length**2}
    offer = kept(separation, parts, bounds, known=more)
    if offer is None:
        return None
    found = pairs(separation, [offer[1]], STEPS)
    chances = {rival.family: rival.chance for rival in separation.rivals}
    return Heavier(added, expected({pair: d * worth[pair] for pair, d in found.items()}, chances))
