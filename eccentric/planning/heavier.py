"""What a change of the rig would decide where no motion does: the same motion with more mass on the link.

The log with another mass is judged together with the first one: `[added]` in a rig file has both diagnosed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eccentric.errors import InputError
from eccentric.model import TURNING, Model
from eccentric.model import vocabulary as v
from eccentric.planning.bounds import Bounds
from eccentric.planning.chance import expected
from eccentric.planning.choice import judged, kept
from eccentric.planning.limits import HEAVIER
from eccentric.planning.motion import Segment
from eccentric.planning.separation import Separation
from eccentric.rigs import AddedMass, Rig

__all__ = ["Heavier", "require_link", "with_more_mass"]


@dataclass(frozen=True)
class Heavier:
    """A mass that is added at the place of the one on the link [kg], and the probability that it decides."""

    added_kg: float
    probability: float


def require_link(rig: Rig, model: Model) -> None:
    """InputError if there is no link, or none whose mass and its distance are known, to add a mass to."""
    if rig.axis is not TURNING:
        raise InputError(f"{rig.path}: --added: a drive that turns is required, received a carriage")
    letters = [q.symbol.name for q in (v.M, v.L)]
    if missing := [name for name in letters if name not in rig.known]:
        verb = "are" if len(missing) > 1 else "is"
        received = "a range" if set(missing) & set(rig.unknown) else "none"
        raise InputError(
            f"{rig.path}: [known] {' and '.join(missing)} {verb} required to add a mass, received {received}"
        )
    if not set(letters) <= {q.name for q in model.parameters}:
        raise InputError(f"--added: a model with an unbalanced mass is required, received {model.name}")


def with_more_mass(
    separation: Separation, parts: Sequence[Segment], bounds: Bounds, worth: Mapping[tuple[str, str], float]
) -> Heavier | None:
    """The motion with more mass, slower where the limits require it; None where it cannot be judged.

    That is without a known mass and its distance, where the limits leave no motion, and where gravity does
    not load the drive: with two masses the torque constant may be what is off, which the log alone does not
    offer as an explanation there.

    Args:
        separation: the rivals.
        parts: the motion.
        bounds: its limits.
        worth: (true family, other family) -> the factor on what is computed for two rivals.
    """
    known, link = separation.question.data.signals.known, separation.question.data.drive.machine.link
    mass, length = (known.get(q.symbol.name, 0.0) for q in (v.M, v.L))
    gravity = separation.question.model.balance("mechanical").sum_of("gravity")
    if not mass or not length or link not in known or gravity == 0:
        return None
    added = HEAVIER * mass
    heavy = Separation(separation.question, AddedMass(added))
    offer = kept(heavy, parts, bounds)
    if offer is None:
        return None
    found = judged(heavy, offer[1])
    chances = {rival.family: rival.chance for rival in separation.rivals}
    return Heavier(added, expected({pair: d * worth[pair] for pair, d in found.items()}, chances))
