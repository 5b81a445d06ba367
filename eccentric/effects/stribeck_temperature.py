"""Stribeck friction of a film whose viscosity falls with temperature."""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import TEMPERATURE, Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, constant, direction, speed
from eccentric.effects.viscosity_temperature import FILM, thinning
from eccentric.model import Role, quantity
from eccentric.model import vocabulary as v

A = quantity(
    "filmrise_A", "N m", "Stribeck torque: increase of the friction near rest", "", "nonnegative", letter="A"
)
w_s = quantity("filmrise_v", "rad/s", "Stribeck velocity at T_0, motor side", "", "positive", letter="v")
b = quantity("filmrise_b", "1/K", "relative fall of the viscosity per kelvin", "", "nonnegative", letter="b")
WORDS = Words(
    headline="Stribeck friction whose velocity rises with temperature",
    meaning=(
        "A warm film of lubricant is thin and needs more speed to carry: the Stribeck velocity rises as the"
        " viscosity falls, at a constant product of both (Hersey number)."
    ),
    hint="slow runs at several speeds below and around the Stribeck velocity, cold and warm",
    kin=TEMPERATURE,
    tell_apart={"stribeck": "Repeat slow runs at several speeds over a ramp of 20 K or more."},
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family; none if no temperature is logged."""
    if setting.temperature_mid is None:
        return ()
    zero = constant(
        "filmrise_T0", "K", "reference temperature in degC", setting.temperature_mid, letter="T_0"
    )
    thinner = sp.exp(-b.symbol * (v.temperature.symbol - zero.symbol))
    effect = addition(
        "stribeck_temperature",
        [(A, sp.exp(-speed * thinner / w_s.symbol) * direction)],
        role=Role.STRIBECK,
        depends_on=("temperature", "velocity"),
        formula="A exp(-|w| exp(-b (T - T_0))/v) sgn w",
        reference="M. D. Hersey, J. Washington Academy of Sciences 4, 1914; A. C. Bittencourt and"
        " S. Gunnarsson, J. Dynamic Systems, Measurement and Control 134(5), 2012",
        shapes=(
            # At the median temperature: cold it is a fraction of that, and below 0.4 w_max as in `stribeck`.
            Shape(w_s, setting.w_min, setting.w_max, "log", 9),
            # Below 0.5 % per kelvin it is `stribeck`; oils lose 2 to 6 %.
            Shape(b, 0.005, 0.1, "log", 4),
        ),
        definitions=(zero,),
        inputs=(v.temperature,),
        needs=("temperature",),
        only_with=FILM,
        plausible=(thinning(b.symbol),),
        words=WORDS,
    )
    return (effect,)
