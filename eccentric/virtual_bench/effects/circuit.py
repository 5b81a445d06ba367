"""Effects in the armature circuit, the torque constant and the current sensor."""

# ruff: noqa: ARG001 (all builders have one signature, and so have all laws)

from __future__ import annotations

from typing import TYPE_CHECKING

from .record import Builder, Effect, Setting, draw, simply

if TYPE_CHECKING:
    import numpy as np

    from eccentric.virtual_bench.motion import Motion


def kt_saturation(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Iron that saturates: the torque constant falls with the current."""
    k_i, size = setting.plant.k_i, setting.current

    def torque(s: Motion, a: float) -> float:
        share = a * (s.i / size) ** 2
        return k_i * s.i * share / (1.0 + share)

    return Effect(
        "kt_saturation",
        "k_i -> k_i/(1 + A (i/i0)^2)",
        0.5 * strength * setting.friction / (k_i * size),
        simply(torque=torque),
        ("current",),
        (size,),
        bound=1.0,
    )


def current_bias(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Sensor of the current whose zero is off by A."""
    return Effect(
        "current_bias",
        "i_logged = i + A",
        strength * setting.friction / setting.plant.k_i,
        simply(current=lambda s, a: a),
        ("current",),
        channel="electrical",
    )


def inverter_deadtime(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """Voltage lost to the dead time of the bridge, against the current (Munoz and Lipo 1999).

    It is linear within i0 about zero current, where the drop and the current are solved for together.
    """
    plant = setting.plant
    i0 = draw(rng, 0.02, 0.06) * setting.current

    def drop(s: Motion, a: float) -> float:
        share = s.v / (a + plant.R * i0)
        return a * min(1.0, max(-1.0, share))

    return Effect(
        "inverter_deadtime",
        "A sat(i/i0)",
        strength * setting.friction * plant.R / plant.k_i,
        simply(drop=drop),
        ("current", "voltage"),
        (i0,),
        channel="electrical",
    )


def resistance_temperature(
    strength: float, rng: np.random.Generator, setting: Setting, variant: str | None
) -> Effect:
    """Winding whose resistance rises with its temperature."""
    cold = setting.plant.Tamb

    def drop(s: Motion, a: float) -> float:
        share = a * (s.temperature - cold)
        return s.v * share / (1.0 + share)

    size = strength * setting.friction / (setting.plant.k_i * setting.current * max(setting.warming, 1.0))
    return Effect(
        "resistance_temperature",
        "R -> R (1 + A (T - Tamb))",
        size,
        simply(drop=drop),
        ("temperature", "current"),
        (cold,),
        bound=0.02,
        channel="electrical",
        needs_temperature=True,
    )


def ke_mismatch(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Back-EMF constant A times more than declared."""
    plant = setting.plant
    size = strength * setting.friction * plant.R / (plant.k_i * plant.k_e * setting.speed)
    return Effect(
        "ke_mismatch",
        "k_e -> k_e (1 + A)",
        size,
        simply(drop=lambda s, a: a * plant.k_e * s.w_mid),
        ("velocity",),
        bound=0.8,
        channel="electrical",
    )


def sensor_delay(strength: float, rng: np.random.Generator, setting: Setting, variant: str | None) -> Effect:
    """Sensor of the current that is late by A against angle and voltage."""
    return Effect(
        "sensor_delay",
        "i_logged(t) = i(t - A)",
        0.01,
        simply(delay=lambda s, a: a),
        ("history", "current"),
        bound=0.06,
        channel="electrical",
    )


FAMILIES: dict[str, Builder] = {
    builder.__name__: builder
    for builder in (
        kt_saturation,
        current_bias,
        inverter_deadtime,
        resistance_temperature,
        ke_mismatch,
        sensor_delay,
    )
}
