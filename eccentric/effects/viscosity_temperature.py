"""Temperature-dependent viscosity."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import TEMPERATURE, Effect, Evidence, Plausible, Setting, Shape, Words
from eccentric.effects.forms import addition, constant, omega_m
from eccentric.model import Change, Definition, Role, quantity
from eccentric.model import vocabulary as v

b = quantity("viscosity_b", "1/K", "relative fall of the viscosity per kelvin", "", "nonnegative", letter="b")
E = quantity(
    "viscosity_E",
    "K",
    "activation energy of the viscosity over the gas constant",
    "",
    "nonnegative",
    letter="E",
)
B = quantity(
    "viscosity_B", "N m s/rad", "viscous friction of the bearing that warms up", "", "nonnegative", letter="B"
)
factor = quantity(
    "viscosity_factor",
    "1",
    "viscosity over that at the reference temperature",
    "",
    "positive",
    letter="kappa",
)

FILM = {"lubricant": ("grease", "oil")}
OILS = "ASTM D341, 2020: Walther's equation, ISO VG 15 to 680 with a viscosity index of 95, 0 to 100 degC"


def thinning(coefficient: sp.Expr) -> Plausible:
    """The fall of a viscosity per kelvin, beside that of oils."""
    return Plausible(
        100 * coefficient,
        "%/K",
        1.7,
        12.3,
        OILS,
        "the fall of the viscosity with temperature",
        above="not the lubricant alone, or a sensor that warms up less",
        below="friction that is not of the lubricant alone, or a sensor that warms up more",
    )


REYNOLDS = "O. Reynolds, Phil. Trans. Royal Society 177, 1886"
ROBOT = "A. C. Bittencourt, E. Wernholt, S. Sander-Tavallaey and T. Brogårdh, IROS 2010"
WORDS = Words(
    title="Viscous friction that falls with temperature",
    meaning=(
        "The viscosity of a lubricant falls with temperature: exponentially (Reynolds), or by Arrhenius' law."
    ),
    hint=(
        "one speed held while the temperature rises and falls, so that temperature does not simply follow "
        "the order of the runs"
    ),
    kin=TEMPERATURE,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """All viscous friction by either law, or that of one bearing; none if no temperature is logged."""
    if setting.temperature_mid is None:
        return ()
    zero = constant(
        "viscosity_T0", "K", "reference temperature in degC", setting.temperature_mid, letter="T_0"
    )
    kelvin = constant("viscosity_C0", "K", "absolute temperature of 0 degC", 273.15, letter="T_K")
    T, T_0 = v.temperature.symbol, zero.symbol
    absolute = (T + kelvin.symbol) * (T_0 + kelvin.symbol)
    reynolds = sp.exp(-b.symbol * (T - T_0))
    arrhenius = sp.exp(-E.symbol * (T - T_0) / absolute)
    middle = (setting.temperature_mid + 273.15) ** 2
    falls = Shape(b, 0.002, 0.4, "log", 9)
    energy = Shape(E, 0.002 * middle, 0.4 * middle, "log", 9)
    return (
        _scaling(
            "",
            "viscous friction that falls with temperature by Reynolds' law",
            (zero, Definition(factor, reynolds)),
            falls,
            b.symbol,
            "viscous friction times exp(-b (T - T_0))",
            f"{REYNOLDS}; {ROBOT}",
        ),
        _scaling(
            "arrhenius",
            "viscous friction that falls with temperature by Arrhenius' law",
            (zero, kelvin, Definition(factor, arrhenius)),
            energy,
            E.symbol / middle,
            "viscous friction times exp(E/T - E/T_0), T in K",
            f"E. N. da C. Andrade, Nature 125, 1930; {ROBOT}",
        ),
        addition(
            "viscosity_temperature",
            [(B, omega_m * (reynolds - 1))],
            variant="bearing",
            role=Role.VISCOUS,
            depends_on=("temperature",),
            formula="B w (exp(-b (T - T_0)) - 1)",
            reference=f"{REYNOLDS}; {ROBOT}",
            shapes=(falls,),
            definitions=(zero,),
            inputs=(v.temperature,),
            needs=("temperature",),
            only_with=FILM,
            plausible=(thinning(b.symbol),),
            words=replace(WORDS, headline="viscous friction of one bearing that falls with temperature"),
        ),
    )


def _scaling(
    variant: str,
    headline: str,
    definitions: tuple[Definition, ...],
    shape: Shape,
    fall: sp.Expr,
    formula: str,
    reference: str,
) -> Effect:
    return Effect(
        family="viscosity_temperature",
        variant=variant,
        balance="mechanical",
        formula=formula,
        reference=reference,
        change=Change(definitions=definitions, scales={Role.VISCOUS: factor.symbol}, inputs=(v.temperature,)),
        evidence=Evidence(depends_on=("temperature",), needs=("temperature",)),
        shapes=(shape,),
        only_with=FILM,
        plausible=(thinning(fall),),
        words=replace(WORDS, headline=headline),
    )
