"""What a person reads about an effect; written once, in the file of its family."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

__all__ = [
    "GRAVITY",
    "LOAD",
    "SPEED",
    "TEMPERATURE",
    "TIME",
    "Kin",
    "Words",
    "how_often",
    "measurement_between",
]


@dataclass(frozen=True)
class Kin:
    """Families that follow the same variable, so that one log may not distinguish them.

    Attributes:
        name: of the variable.
        tell_apart: what separates a family of this kin from one of the named kin, or its own: one sentence.
    """

    name: str
    tell_apart: Mapping[str, str]


TIME = Kin("time", {"time": "Log three times as long, with rests, to separate time from distance travelled."})
TEMPERATURE = Kin(
    "temperature",
    {
        "temperature": "Alternate slow and fast speeds over a ramp of 20 K or more.",
        "time": "Repeat the same speeds warm and cooled down, with the temperature logged.",
    },
)
SPEED = Kin(
    "speed",
    {"speed": "Add constant speeds at twice the present range and at its lower end, in both directions."},
)
LOAD = Kin(
    "load",
    {"load": "Accelerate hard at several speeds, then repeat with another mass on the link."},
)
GRAVITY = Kin(
    "gravity",
    {"gravity": "Hold slow speeds over whole turns in both directions, with two masses."},
)


@dataclass(frozen=True)
class Words:
    """What a person reads about an effect.

    Attributes:
        headline: a noun phrase that continues "the model lacks ...": "friction that varies
            twice per turn of the link"; "" for an effect that is known by its id only.
        title: a heading for the family, where its effects have headlines of their own.
        meaning: what the family is and where it comes from, one sentence.
        hint: what to measure to separate it from others, as a noun phrase or an instruction.
        kin: families that follow the same variable; None for one that has no kin.
        tell_apart: family, or name of a kin -> the measurement that separates the effect from it, one
            sentence; it takes precedence over the kin's.
    """

    headline: str = ""
    title: str = ""
    meaning: str = ""
    hint: str = ""
    kin: Kin | None = None
    tell_apart: Mapping[str, str] = field(default_factory=dict)


def measurement_between(first: tuple[str, Words], second: tuple[str, Words]) -> str:
    """The measurement that separates two families, each with its words; "" if neither knows one.

    What a family says of the other family takes precedence over what it says of the other's kin, and that
    over what the kins say of each other.
    """
    pairs = ((first, second), (second, first))
    own = [own.tell_apart.get(other) for (_, own), (other, _) in pairs]
    of_kin = [own.tell_apart.get(other.kin.name) for (_, own), (_, other) in pairs if other.kin]
    kins = [own.kin.tell_apart.get(other.kin.name) for (_, own), (_, other) in pairs if own.kin and other.kin]
    return next(filter(None, [*own, *of_kin, *kins]), "")


def how_often(n: int) -> str:
    """A number of times, in words."""
    return {1: "once", 2: "twice"}.get(n, f"{n} times")
