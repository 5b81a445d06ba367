"""Effects of the temperature, and slow ones of time and wear."""

# ruff: noqa: ARG001 (all builders have one signature)

from math import exp

import numpy as np

from .record import Builder, Effect, Setting, choose, draw, simply

_KELVIN = 273.15


def viscosity_temperature(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """Oil that thins as it warms: exponentially (Reynolds 1886), or by Arrhenius' law."""
    variant = choose("viscosity_temperature", variant, ("exponential", "arrhenius"), rng)
    cold = setting.plant.Tamb
    if variant == "exponential":
        form, size, bound = "b w (exp(-A (T - Tamb)) - 1)", strength * 4.0 / max(setting.warming, 1.0), 0.15

        def factor(temperature: float, a: float) -> float:
            return exp(-a * (temperature - cold)) - 1.0
    else:
        form, size, bound = (
            "b w (exp(A (1/T - 1/Tamb)) - 1), T in K",
            strength * 4e5 / max(setting.warming, 1.0),
            1.5e4,
        )

        def factor(temperature: float, a: float) -> float:
            return exp(a * (1.0 / (temperature + _KELVIN) - 1.0 / (cold + _KELVIN))) - 1.0

    return Effect(
        "viscosity_temperature",
        form,
        size,
        simply(viscous=lambda s, a: s.viscous * factor(s.temperature, a)),
        ("temperature", "velocity"),
        (cold,),
        bound=bound,
        variant=variant,
        needs_temperature=True,
    )


def coulomb_temperature(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """Dry friction that falls in proportion to the temperature."""
    cold = setting.plant.Tamb
    return Effect(
        "coulomb_temperature",
        "-A (T - Tamb) c sgn w",
        1.5 * strength / max(setting.warming, 1.0),
        simply(dry=lambda s, a: -a * (s.temperature - cold) * s.dry),
        ("temperature",),
        (cold,),
        bound=0.8 / max(setting.warming, 1.0),
        needs_temperature=True,
    )


def hidden_thermal_drift(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """All friction falls as the drive warms, and no column of the log tells the temperature."""
    cold = setting.plant.Tamb
    return Effect(
        "hidden_thermal_drift",
        "-A (T - Tamb) f, T heated by the losses and not logged",
        1.5 * strength / max(setting.warming, 1.0),
        simply(
            dry=lambda s, a: -a * (s.temperature - cold) * s.dry,
            viscous=lambda s, a: -a * (s.temperature - cold) * s.viscous,
        ),
        ("time", "history"),
        (cold,),
        bound=0.8 / max(setting.warming, 1.0),
        hides_temperature=True,
    )


def wear_runin(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Dry friction of a fresh surface, worn off with the distance travelled (Archard 1953)."""
    distance = draw(rng, 0.15, 0.35) * setting.speed * setting.seconds
    return Effect(
        "wear_runin",
        "A exp(-s/s0) sgn w, s the motor's travel",
        2.5 * strength * setting.friction,
        simply(dry=lambda s, a: a * exp(-s.travel / distance)),
        ("time", "history"),
        (distance,),
    )


def time_drift(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Dry friction that grows steadily with time, as a drying grease does."""
    seconds = setting.seconds
    return Effect(
        "time_drift",
        "A (t/t_end) sgn w",
        1.7 * strength * setting.friction,
        simply(dry=lambda s, a: a * s.t / seconds),
        ("time",),
        (seconds,),
    )


FAMILIES: dict[str, Builder] = {
    builder.__name__: builder
    for builder in (viscosity_temperature, coulomb_temperature, hidden_thermal_drift, wear_runin, time_drift)
}
