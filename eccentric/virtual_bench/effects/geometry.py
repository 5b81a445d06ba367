"""Effects of the angle of the link or the motor, and of a rig that is not quite as declared."""

# ruff: noqa: ARG001 (all builders have one signature, and so have all laws)

from __future__ import annotations

from math import cos, exp, pi, sin
from typing import TYPE_CHECKING

from .record import Builder, Effect, Law, Setting, choose, draw, phase, simply

if TYPE_CHECKING:
    import numpy as np

    from eccentric.virtual_bench.motion import Motion


def link_harmonic_friction(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """Dry friction that varies n times per turn of the link (misalignment, bent shaft, lobed bearing)."""
    drawn = choose("link_harmonic_friction", variant, ("n=1", "n=2", "n=3", "n=4"), rng)
    order, shift = int(drawn[2:]), phase(rng)
    return Effect(
        "link_harmonic_friction",
        f"A cos({order} thl + phi) sgn w",
        1.4 * strength * setting.friction,
        simply(dry=lambda s, a: a * cos(order * s.link + shift)),
        ("link_angle",),
        (float(order), shift),
        variant=drawn,
    )


def cogging(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Torque of the slots against the magnets, n times per turn of the motor (Hanselman 2003)."""
    drawn = choose("cogging", variant, ("n=2", "n=4", "n=6"), rng)
    order, shift = int(drawn[2:]), phase(rng)
    return Effect(
        "cogging",
        f"A cos({order} thm + phi)",
        1.4 * strength * setting.friction,
        simply(torque=lambda s, a: a * cos(order * s.theta + shift)),
        ("motor_angle",),
        (float(order), shift),
        variant=drawn,
    )


def kt_ripple(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Torque constant that varies n times per turn of the motor (commutation)."""
    drawn = choose("kt_ripple", variant, ("n=2", "n=4", "n=6"), rng)
    order, shift, k_i = int(drawn[2:]), phase(rng), setting.plant.k_i
    return Effect(
        "kt_ripple",
        f"-A cos({order} thm + phi) k_i i",
        1.4 * strength * setting.friction / (k_i * setting.current),
        simply(torque=lambda s, a: -a * cos(order * s.theta + shift) * k_i * s.i),
        ("motor_angle", "current"),
        (float(order), shift),
        variant=drawn,
        bound=0.6,
    )


def local_defect(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Tight spot at one angle of the link: a bump of dry friction."""
    centre, width = phase(rng), draw(rng, 0.15, 0.4)

    def dry(s: Motion, a: float) -> float:
        away = (s.link - centre + pi) % (2.0 * pi) - pi
        return a * exp(-0.5 * (away / width) ** 2)

    return Effect(
        "local_defect",
        "A exp(-((thl - th0)/d)^2/2) sgn w",
        3.0 * strength * setting.friction,
        simply(dry=dry),
        ("link_angle",),
        (centre, width),
    )


def cable_spring(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Cable or hose that winds up with the link."""
    rest = phase(rng)
    return Effect(
        "cable_spring",
        "A (thl - th0)",
        0.1 * strength * setting.friction,
        simply(torque=lambda s, a: a * (s.link - rest)),
        ("link_angle",),
        (rest,),
    )


def _other_gravity(setting: Setting, gravity: Law, turn: Law) -> dict[str, Law]:
    """Return what changes with `gravity` [m/s^2] in the plane and down turned by `turn` [rad]."""
    plant = setting.plant

    def friction(s: Motion, a: float) -> tuple[float, float]:
        return plant.link_friction(plant.normal_force(s.link + turn(s, a), s.w_link, gravity(s, a)))

    return {
        "torque": lambda s, a: plant.gravity_torque(s.link + turn(s, a), gravity(s, a)) - s.gravity,
        "dry": lambda s, a: friction(s, a)[0] - s.link_dry,
        "viscous": lambda s, a: friction(s, a)[1] - s.link_viscous,
    }


def gravity_tilt(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Plane of motion tilted by A against the declared one, in gravity torque and normal force."""
    g, load = setting.plant.g, _gravity_size(setting)
    if setting.plant.case == "C1":
        shift = phase(rng)
        start = simply(**_other_gravity(setting, lambda s, a: g * sin(a), lambda s, a: shift))
        form, size, shape = (
            "tilt A: g' = g sin A, down at thl = -phi",
            1.4 * strength * setting.friction / load,
            (shift,),
        )
    else:
        start = simply(**_other_gravity(setting, lambda s, a: g * cos(a), lambda s, a: 0.0))
        form, size, shape = "tilt A: g' = g cos A", (2.8 * strength * setting.friction / load) ** 0.5, ()
    return Effect("gravity_tilt", form, size, start, ("link_angle", "gravity_load"), shape, bound=0.7)


def angle_offset(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Zero angle of the link off by A, so that gravity pulls elsewhere than the log says."""
    setting.need("C2", "angle_offset", "without gravity in the plane no angle is special")
    g = setting.plant.g
    return Effect(
        "angle_offset",
        "G(thl + A) - G(thl), and F_N likewise",
        1.4 * strength * setting.friction / _gravity_size(setting),
        simply(**_other_gravity(setting, lambda s, a: g, lambda s, a: a)),
        ("link_angle", "gravity_load"),
        bound=0.7,
    )


def mass_mismatch(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Unbalanced mass A times more than declared, in gravity and normal force; J_l is as declared."""
    setting.need("C2", "mass_mismatch", "without gravity in the plane it is an alias of B_lN and C_lN")
    plant = setting.plant

    def friction(s: Motion, a: float) -> tuple[float, float]:
        ratio = (plant.M * (1.0 + a) + plant.M_l) / (plant.M + plant.M_l)
        force = plant.normal_force(s.link, s.w_link * ((1.0 + a) / ratio) ** 0.5) * ratio
        return plant.link_friction(force)

    start = simply(
        torque=lambda s, a: a * s.gravity,
        dry=lambda s, a: friction(s, a)[0] - s.link_dry,
        viscous=lambda s, a: friction(s, a)[1] - s.link_viscous,
    )
    size = 1.4 * strength * setting.friction / _gravity_size(setting)
    return Effect(
        "mass_mismatch", "M -> M (1 + A) in G and F_N", size, start, ("gravity_load", "link_angle"), bound=0.9
    )


def inertia_mismatch(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """Inertia on the motor side A times more than declared."""
    inertia = setting.plant.inertia
    return Effect(
        "inertia_mismatch",
        "A J dw/dt",
        strength,
        simply(inertia=lambda s, a: a * inertia),
        ("acceleration",),
        bound=3.0,
    )


def _gravity_size(setting: Setting) -> float:
    plant = setting.plant
    return plant.gravity_torque(pi / 2, plant.g)


FAMILIES: dict[str, Builder] = {
    builder.__name__: builder
    for builder in (
        link_harmonic_friction,
        cogging,
        kt_ripple,
        local_defect,
        cable_spring,
        gravity_tilt,
        angle_offset,
        mass_mismatch,
        inertia_mismatch,
    )
}
