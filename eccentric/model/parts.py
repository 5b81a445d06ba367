"""The parts of a drive: the words by which a rig says what it is made of, and whether they allow a cause.

What a rig does not say rules out nothing. Of a drive with several parts of one kind, such as a planetary gear
before a belt, a cause needs one of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

Parts = Mapping[str, tuple[str, ...]]
"""Kind of part -> words for it."""

NO_PART = "none"
GEARS = ("strain wave", "planetary", "worm", "spur", "belt", "screw")
DRIVE_PARTS: Parts = MappingProxyType(
    {
        "gear": (*GEARS, NO_PART),
        "motor": (
            *("brushed", "coreless", "brushless", "slotless", "stepper", "induction"),
            *("eddy-current brake", NO_PART),
        ),
        "bearing": ("ball", "roller", "plain", "air", NO_PART),
        "lubricant": ("grease", "oil", NO_PART),
    }
)
"""Every word that a rig may use; `docs/rig.md` says what each means."""

IRON = ("brushed", "brushless", "stepper")
"""Motors with magnets and iron teeth, which attract each other."""
MAGNETS = (*IRON, "coreless", "slotless")
MOTORS = (*MAGNETS, "induction")


REDUCERS = frozenset({"strain wave", "planetary", "worm"})
"""Gears whose ratio is never 1."""
ANGLE, MOTOR_ANGLE, OUTPUT_ANGLE = "angle", ("motor",), ("output",)
"""Kind and words of what follows from a rig: whether the angle of the motor is known at all."""


def missing(needs: Parts, given: Parts) -> dict[str, tuple[str, ...]]:
    """Kind -> the words of which a drive of the `given` parts has none; empty where nothing is missing."""
    return {
        kind: words for kind, words in needs.items() if given.get(kind) and not set(words) & set(given[kind])
    }
