"""Coulomb friction by temperature."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import TEMPERATURE, Effect, Evidence, Setting, Shape, Words
from eccentric.effects.forms import addition, constant, direction
from eccentric.model import Change, Definition, Role, quantity
from eccentric.model import vocabulary as v

b = quantity("coulomb_b", "1/K", "relative change of the Coulomb friction per kelvin", letter="b")
C = quantity("coulomb_C", "N m/K", "change of the Coulomb friction of one bearing per kelvin", letter="C")
factor = quantity(
    "coulomb_factor",
    "1",
    "Coulomb friction over that at the reference temperature",
    "",
    "nonnegative",
    letter="kappa",
)
REFERENCE = "A. C. Bittencourt and S. Gunnarsson, J. Dynamic Systems, Measurement and Control 134(5), 2012"
WORDS = Words(
    title="Coulomb friction that changes with temperature",
    meaning=(
        "Dry friction that changes with temperature: fits and preloads grow or shrink, boundary films"
        " become thinner."
    ),
    hint="low speeds, where viscous friction is small, at several temperatures",
    kin=TEMPERATURE,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """All Coulomb friction, or that of one bearing; none if no temperature is logged."""
    if setting.temperature_mid is None:
        return ()
    zero = constant("coulomb_T0", "K", "reference temperature in degC", setting.temperature_mid, letter="T_0")
    warmer = v.temperature.symbol - zero.symbol
    scaling = Effect(
        family="coulomb_temperature",
        balance="mechanical",
        formula="Coulomb friction times 1 + b (T - T_0), never below 0",
        reference=REFERENCE,
        change=Change(
            definitions=(zero, Definition(factor, sp.Max(0, 1 + b.symbol * warmer))),
            scales=dict.fromkeys((Role.COULOMB, Role.PRESLIDING), factor.symbol),
            inputs=(v.temperature,),
        ),
        evidence=Evidence(depends_on=("temperature",), needs=("temperature",)),
        shapes=(Shape(b, -0.03, 0.03, "linear", 4),),
        words=replace(WORDS, headline="Coulomb friction that changes with temperature"),
    )
    bearing = addition(
        "coulomb_temperature",
        [(C, direction * warmer)],
        variant="bearing",
        role=Role.COULOMB,
        depends_on=("temperature",),
        formula="C (T - T_0) sgn w",
        reference=REFERENCE,
        definitions=(zero,),
        inputs=(v.temperature,),
        needs=("temperature",),
        words=replace(WORDS, headline="Coulomb friction of one bearing that changes with temperature"),
    )
    return scaling, bearing
