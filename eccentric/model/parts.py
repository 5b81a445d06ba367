"""The components of a drive as declared in a rig, and whether they allow a cause.

An undeclared component rules out nothing. If a drive has several components of a kind, such as a planetary
gear and a belt, one of them suffices for a cause.
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
"""All values that a rig may declare, as defined in `docs/rig-reference.md`."""

IRON = ("brushed", "brushless", "stepper")
"""Motors with magnets and iron teeth, which have cogging."""
MAGNETS = (*IRON, "coreless", "slotless")
MOTORS = (*MAGNETS, "induction")


REDUCERS = frozenset({"strain wave", "planetary", "worm"})
"""Gears whose ratio is never 1."""
ANGLE, MOTOR_ANGLE, OUTPUT_ANGLE = "angle", ("motor",), ("output",)
"""Kind and values derived from a rig: whether the motor angle is known."""


def missing(needs: Parts, given: Parts) -> dict[str, tuple[str, ...]]:
    """Kind -> the required components of which the `given` ones include none; empty if none is missing."""
    return {
        kind: words for kind, words in needs.items() if given.get(kind) and not set(words) & set(given[kind])
    }
