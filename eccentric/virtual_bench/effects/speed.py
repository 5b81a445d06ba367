"""Effects of the speed and its direction."""

from math import exp

from .record import Builder, PlantedEffect, Request, simply


def stribeck(wanted: Request) -> PlantedEffect:
    """Dry friction that falls from break-away to its kinetic level (Stribeck 1902; Bo and Pavelescu 1982)."""
    vs, power = wanted.draw(0.06, 0.14) * wanted.setting.top_speed, float(wanted.rng.choice([1.0, 2.0]))
    return PlantedEffect(
        "stribeck",
        "A exp(-(|w|/vs)^d) sgn w",
        wanted.torque(2.0),
        simply(dry=lambda s, a: a * exp(-((abs(s.w_mid) / vs) ** power))),
        ("velocity",),
        (vs, power),
    )


def quadratic_drag(wanted: Request) -> PlantedEffect:
    """Turbulent air drag."""
    return PlantedEffect(
        "quadratic_drag",
        "A w |w|",
        wanted.torque() / wanted.setting.speed**2,
        simply(viscous=lambda s, a: a * abs(s.w_mid)),
        ("velocity",),
    )


def cubic_drag(wanted: Request) -> PlantedEffect:
    """Drag with the third power of the speed, as fans have about their design point."""
    return PlantedEffect(
        "cubic_drag",
        "A w^3",
        wanted.torque() / wanted.setting.speed**3,
        simply(viscous=lambda s, a: a * s.w_mid**2),
        ("velocity",),
    )


def oneway_windage(wanted: Request) -> PlantedEffect:
    """Quadratic drag in one direction only, as a one-sided scoop makes it."""
    way = float(wanted.rng.choice([-1.0, 1.0]))
    return PlantedEffect(
        "oneway_windage",
        "A w |w| for w of one sign",
        wanted.torque(1.4) / wanted.setting.speed**2,
        simply(viscous=lambda s, a: a * abs(s.w_mid) if s.w_mid * way > 0.0 else 0.0),
        ("velocity", "direction"),
        (way,),
    )


def coulomb_asymmetry(wanted: Request) -> PlantedEffect:
    """Dry friction higher in one direction (helical gears, lip seals)."""
    way = float(wanted.rng.choice([-1.0, 1.0]))
    return PlantedEffect(
        "coulomb_asymmetry",
        "A sgn w for w of one sign",
        wanted.torque(1.4),
        simply(dry=lambda s, a: a if s.w_mid * way > 0.0 else 0.0),
        ("direction",),
        (way,),
    )


def viscous_asymmetry(wanted: Request) -> PlantedEffect:
    """Viscous friction higher in one direction."""
    way = float(wanted.rng.choice([-1.0, 1.0]))
    return PlantedEffect(
        "viscous_asymmetry",
        "A w for w of one sign",
        wanted.torque(1.4) / wanted.setting.speed,
        simply(viscous=lambda s, a: a if s.w_mid * way > 0.0 else 0.0),
        ("velocity", "direction"),
        (way,),
    )


def eddy_current(wanted: Request) -> PlantedEffect:
    """Eddy-current brake: drag that peaks at the speed wc and falls beyond it (Smythe 1942)."""
    wc = wanted.draw(0.15, 0.35) * wanted.setting.top_speed
    return PlantedEffect(
        "eddy_current",
        "A w/(1 + (w/wc)^2)",
        wanted.torque(2.5) / wc,
        simply(viscous=lambda s, a: a / (1.0 + (s.w_mid / wc) ** 2)),
        ("velocity",),
        (wc,),
    )


BUILDERS: tuple[Builder, ...] = (
    stribeck,
    quadratic_drag,
    cubic_drag,
    oneway_windage,
    coulomb_asymmetry,
    viscous_asymmetry,
    eddy_current,
)
