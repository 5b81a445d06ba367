"""What a user asks of the bench for arms, checked: families with their joints and strengths, and ranges."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eccentric.errors import InputError, meant
from eccentric.virtual_bench.arms.families import ARM_EFFECTS, ARM_VARIANTS

Requested = Sequence[str | tuple[str, float]] | Mapping[str, float]
STRENGTH = 0.15


@dataclass(frozen=True)
class EffectRequest:
    """One effect that is asked for; without a variant or a joint (from 0), one is drawn."""

    family: str
    variant: str | None
    joint: int | None
    strength: float


def checked(
    effects: Requested,
    choices: Mapping[str, tuple[object, Collection[object]]],
    ranges: Mapping[str, tuple[object, float, float]],
    joints: int,
) -> list[EffectRequest]:
    """Return the effects that are asked for; raises InputError for any value that is not allowed."""
    for quantity, (value, allowed) in choices.items():
        if value not in allowed:
            raise InputError(f"{quantity}: {' or '.join(map(str, allowed))} is required, received {value}")
    for quantity, (value, low, high) in ranges.items():
        if not _within(value, low, high):
            raise InputError(f"{quantity}: {low:g} to {high:g} is required, received {value!r}")
    if isinstance(effects, str) or not isinstance(effects, Sequence | Mapping):
        raise InputError(f"effects: a list of names or of (name, strength) is required, received {effects!r}")
    listed = list(effects.items()) if isinstance(effects, Mapping) else effects
    return [_effect(one, joints) for one in listed]


def _effect(one: str | tuple[str, float], joints: int) -> EffectRequest:
    pair = (one, STRENGTH) if isinstance(one, str) else one
    if not isinstance(pair, tuple | list) or len(pair) != 2:
        raise InputError(f"effects: names or (name, strength) are required, received {one!r}")
    name, strength = pair
    family, variant, joint = known_joint_effect(str(name))
    if joint is not None and not 1 <= joint <= joints:
        raise InputError(f"effect {name}: a joint from 1 to {joints} is required, received {joint}")
    if not _within(strength, 0.0, 1.0) or strength == 0.0:
        raise InputError(
            f"effect {name}: a strength above 0 and at most 1 is required, received {strength!r}"
        )
    return EffectRequest(family, variant, None if joint is None else joint - 1, float(strength))


def known_joint_effect(name: str) -> tuple[str, str | None, int | None]:
    """Split `family[variant]@joint`; InputError, listing what there is, if there is no such effect."""
    match = re.fullmatch(r"(\w+)(?:\[(.+?)\])?(?:@(\d+))?", name)
    if match is None or match[1] not in ARM_EFFECTS:
        raise InputError(
            f"effect {name}: one of {', '.join(ARM_EFFECTS)} is required"
            + meant(name.partition("@")[0], ARM_EFFECTS)
        )
    family, variant, joint = match[1], match[2], match[3]
    variants = ARM_VARIANTS.get(family, ())
    if variant is not None and variant not in variants:
        allowed = f"a variant of {', '.join(variants)}" if variants else "no variant"
        raise InputError(f"effect {family}: {allowed} is required, received {variant}")
    return family, variant, None if joint is None else int(joint)


def _within(value: object, low: float, high: float) -> bool:
    """Whether it is a number of the range, which NaN and true are not."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return False
    return bool(low <= value <= high)
