"""Families of effects in a joint of an arm: those of a single drive, and its own laws of the load."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import exp, hypot
from typing import cast

import numpy as np

from eccentric.core import InputError, meant
from eccentric.virtual_bench.effects import EFFECTS, VARIANTS, Builder, PlantedEffect, Request, simply
from eccentric.virtual_bench.plant import Motion, Plant

# The motion of one joint of an arm, as seen by the laws of its effects.


class JointMotion(Motion):
    """`Motion` of the joint's motor, and what only an arm has.

    `normal` is F_N, `gravity` the torque that holds the joint at rest, `transmitted` what its gear passes on
    without friction, with its sign; both on the motor side [N m].
    """

    __slots__ = ("transmitted",)

    def __init__(self, plant: Plant, effects: int = 0) -> None:
        super().__init__(plant, effects=effects)
        self.transmitted = 0.0


_OF_ONE_DRIVE = (
    "stribeck", "quadratic_drag", "cubic_drag", "oneway_windage", "coulomb_asymmetry", "viscous_asymmetry",
    "eddy_current", "sublinear_viscous", "hidden_thermal_drift", "wear_runin", "time_drift",
    "viscosity_temperature", "coulomb_temperature", "stribeck_temperature", "link_harmonic_friction",
    "motor_harmonic_friction", "nonsynchronous_friction",
    "cogging", "kt_ripple", "local_defect", "cable_spring", "presliding", "magnetic_hysteresis",
    "kt_saturation", "current_bias",
)  # fmt: skip
"""Their laws read nothing but the motion, current and temperature of one motor."""


def _transmitted(s: Motion) -> float:
    return cast("JointMotion", s).transmitted


def _gravity(s: Motion) -> float:
    return s.gravity


def load_dependent(request: Request) -> PlantedEffect:
    """Dry friction of the gear in proportion to the torque that it passes on, or to that of gravity alone."""
    by_gravity = request.variant == "gravity"
    load = _gravity if by_gravity else _transmitted
    return PlantedEffect(
        "load_dependent",
        f"A |{'G' if by_gravity else 'mu T'}| sgn w",
        request.strength,
        simply(dry=lambda s, a: a * abs(load(s))),
        ("gravity_load", "link_angle") if by_gravity else ("transmitted_torque",),
        bound=0.6,
        variant=request.variant,
    )


def gear_efficiency(request: Request) -> PlantedEffect:
    """Loss in proportion to the torque passed on, smaller or larger when the load drives the motor."""
    back = request.draw(0.25, 0.5) if request.variant == "easy" else request.draw(1.8, 3.0)

    def dry(s: Motion, a: float) -> float:
        torque = _transmitted(s)
        return a * abs(torque) * (1.0 if torque * s.w_mid > 0.0 else back)

    return PlantedEffect(
        "gear_efficiency",
        f"A |mu T| sgn w when driving, {back} A |mu T| sgn w when back-driven",
        request.strength,
        simply(dry=dry),
        ("transmitted_torque", "direction"),
        (back,),
        bound=0.6,
        variant=request.variant,
    )


def stribeck_load(request: Request) -> PlantedEffect:
    """Rise of dry friction near rest that grows with the torque passed on, or with F_N."""
    vs = request.draw(0.06, 0.14) * request.setting.top_speed
    by_force = request.variant == "F_N"

    def rise(s: Motion, a: float) -> float:
        return a * (s.normal if by_force else abs(_transmitted(s))) * exp(-((s.w_mid / vs) ** 2))

    return PlantedEffect(
        "stribeck_load",
        f"A {'F_N' if by_force else '|mu T|'} exp(-(w/vs)^2) sgn w",
        2.0 * request.strength,
        simply(rise=rise),
        ("velocity", "link_angle") if by_force else ("transmitted_torque", "velocity"),
        (vs,),
        variant=request.variant,
    )


def bearing_load(request: Request) -> PlantedEffect:
    """Dry friction of the bearing by a power of F_N, or under a preload across it, beside that by F_N itself.

    Beside it, and not instead of it: what would be subtracted is more than there is where F_N hardly varies.
    The powers are those of a Hertzian point contact, 2/3, and of a deep-groove ball bearing, 1.55 (Palmgren).
    """
    weight = request.plant.M * request.plant.g
    if request.variant == "preload":
        force = request.draw(0.5, 1.5) * weight
        form, shape = "A sqrt(F_N^2 + F_p^2) sgn w", force

        def carried(normal: float) -> float:
            return hypot(normal, force)
    else:
        power = 2.0 / 3.0 if request.variant == "Hertz" else 1.55
        form, shape = f"A F_0 (F_N/F_0)^{power:.3g} sgn w, F_0 the mean load", power

        def carried(normal: float) -> float:
            return weight * (normal / weight) ** power

    return PlantedEffect(
        "bearing_load",
        form,
        request.torque() / weight,
        simply(dry=lambda s, a: a * carried(s.normal)),
        ("velocity", "link_angle"),
        (shape,),
        variant=request.variant,
    )


ARM_EFFECTS: dict[str, Builder] = {
    **{name: EFFECTS[name] for name in _OF_ONE_DRIVE},
    **{one.__name__: one for one in (load_dependent, gear_efficiency, stribeck_load, bearing_load)},
}
"""Family -> its builder."""

ARM_VARIANTS: dict[str, tuple[str, ...]] = {
    **{name: VARIANTS[name] for name in _OF_ONE_DRIVE if name in VARIANTS},
    "load_dependent": ("transmitted", "gravity"),
    "gear_efficiency": ("easy", "hard"),
    "stribeck_load": ("transmitted", "F_N"),
    "bearing_load": ("Hertz", "Palmgren", "preload"),
}
"""Variants of a family; one without an entry has none."""


# What a user asks of the bench for arms, checked: families with their joints and strengths, and ranges.


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
            raise InputError(quantity, " or ".join(map(str, allowed)), value)
    for quantity, (value, low, high) in ranges.items():
        if not _within(value, low, high):
            raise InputError(quantity, f"{low:g} to {high:g}", f"{value!r}")
    if isinstance(effects, str) or not isinstance(effects, Sequence | Mapping):
        raise InputError("effects", "a list of names or of (name, strength)", f"{effects!r}")
    listed = list(effects.items()) if isinstance(effects, Mapping) else effects
    return [_effect(one, joints) for one in listed]


def _effect(one: str | tuple[str, float], joints: int) -> EffectRequest:
    pair = (one, STRENGTH) if isinstance(one, str) else one
    if not isinstance(pair, tuple | list) or len(pair) != 2:
        raise InputError("effects", "names or (name, strength)", f"{one!r}")
    name, strength = pair
    family, variant, joint = known_joint_effect(str(name))
    if joint is not None and not 1 <= joint <= joints:
        raise InputError(f"effect {name}", f"a joint from 1 to {joints}", joint)
    if not _within(strength, 0.0, 1.0) or strength == 0.0:
        raise InputError(f"effect {name}", "a strength above 0 and at most 1", f"{strength!r}")
    return EffectRequest(family, variant, None if joint is None else joint - 1, float(strength))


def known_joint_effect(name: str) -> tuple[str, str | None, int | None]:
    """Split `family[variant]@joint`; InputError, listing what there is, if there is no such effect."""
    match = re.fullmatch(r"(\w+)(?:\[(.+?)\])?(?:@(\d+))?", name)
    if match is None or match[1] not in ARM_EFFECTS:
        raise InputError(
            f"effect {name}",
            problem=f"expected one of {', '.join(ARM_EFFECTS)}" + meant(name.partition("@")[0], ARM_EFFECTS),
        )
    family, variant, joint = match[1], match[2], match[3]
    variants = ARM_VARIANTS.get(family, ())
    if variant is not None and variant not in variants:
        allowed = f"a variant of {', '.join(variants)}" if variants else "no variant"
        raise InputError(f"effect {family}", allowed, variant)
    return family, variant, None if joint is None else int(joint)


def _within(value: object, low: float, high: float) -> bool:
    """Whether it is a number of the range, which NaN and true are not."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return False
    return bool(low <= value <= high)
