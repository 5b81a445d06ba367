"""Effects of the speed and its direction."""

# ruff: noqa: ARG001 (all builders have one signature)

from math import exp

import numpy as np

from .record import Builder, Effect, Setting, draw, simply


def stribeck(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Dry friction that falls from break-away to its kinetic level (Stribeck 1902; Bo and Pavelescu 1982)."""
    vs, power = draw(rng, 0.06, 0.14) * setting.top_speed, float(rng.choice([1.0, 2.0]))
    return Effect(
        "stribeck",
        "A exp(-(|w|/vs)^d) sgn w",
        2.0 * strength * setting.friction,
        simply(dry=lambda s, a: a * exp(-((abs(s.w_mid) / vs) ** power))),
        ("velocity",),
        (vs, power),
    )


def quadratic_drag(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """Turbulent air drag."""
    return Effect(
        "quadratic_drag",
        "A w |w|",
        strength * setting.friction / setting.speed**2,
        simply(viscous=lambda s, a: a * abs(s.w_mid)),
        ("velocity",),
    )


def cubic_drag(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Drag with the third power of the speed, as fans have about their design point."""
    return Effect(
        "cubic_drag",
        "A w^3",
        strength * setting.friction / setting.speed**3,
        simply(viscous=lambda s, a: a * s.w_mid**2),
        ("velocity",),
    )


def oneway_windage(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """Quadratic drag in one direction only, as a one-sided scoop makes it."""
    way = float(rng.choice([-1.0, 1.0]))
    return Effect(
        "oneway_windage",
        "A w |w| for w of one sign",
        1.4 * strength * setting.friction / setting.speed**2,
        simply(viscous=lambda s, a: a * abs(s.w_mid) if s.w_mid * way > 0.0 else 0.0),
        ("velocity", "direction"),
        (way,),
    )


def coulomb_asymmetry(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """Dry friction higher in one direction (helical gears, lip seals)."""
    way = float(rng.choice([-1.0, 1.0]))
    return Effect(
        "coulomb_asymmetry",
        "A sgn w for w of one sign",
        1.4 * strength * setting.friction,
        simply(dry=lambda s, a: a if s.w_mid * way > 0.0 else 0.0),
        ("direction",),
        (way,),
    )


def viscous_asymmetry(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """Viscous friction higher in one direction."""
    way = float(rng.choice([-1.0, 1.0]))
    return Effect(
        "viscous_asymmetry",
        "A w for w of one sign",
        1.4 * strength * setting.friction / setting.speed,
        simply(viscous=lambda s, a: a if s.w_mid * way > 0.0 else 0.0),
        ("velocity", "direction"),
        (way,),
    )


def eddy_current(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Eddy-current brake: drag that peaks at the speed wc and falls beyond it (Smythe 1942)."""
    wc = draw(rng, 0.15, 0.35) * setting.top_speed
    return Effect(
        "eddy_current",
        "A w/(1 + (w/wc)^2)",
        2.5 * strength * setting.friction / wc,
        simply(viscous=lambda s, a: a / (1.0 + (s.w_mid / wc) ** 2)),
        ("velocity",),
        (wc,),
    )


FAMILIES: dict[str, Builder] = {
    builder.__name__: builder
    for builder in (
        stribeck,
        quadratic_drag,
        cubic_drag,
        oneway_windage,
        coulomb_asymmetry,
        viscous_asymmetry,
        eddy_current,
    )
}
