"""Friction that changes with temperature, logged or not: viscosity, fits and films, a drive that warms up."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any

import sympy as sp

from eccentric.effects.effect import TEMPERATURE, Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import (
    addition,
    constant,
    copper,
    direction,
    heating,
    loss,
    nonnegative,
    omega_m,
    part_of_dry,
    part_of_viscous,
    positive,
    reference_temperature,
    rule,
    temperature,
    thermal_times,
)
from eccentric.model import CONTACT, Definition, Role, State, quantity
from eccentric.model import vocabulary as v

FILM = {"lubricant": ("grease", "oil")}
OILS = "ASTM D341, 2020: Walther's equation, ISO VG 15 to 680 with a viscosity index of 95, 0 to 100 degC"
REYNOLDS = "O. Reynolds, Phil. Trans. Royal Society 177, 1886"
ROBOT = "A. C. Bittencourt, E. Wernholt, S. Sander-Tavallaey and T. Brogårdh, IROS 2010"


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


def viscosity_temperature(setting: Setting) -> Iterator[Effect]:
    """All viscous friction by either law, or that of one bearing; none if no temperature is logged."""
    if setting.temperature_mid is None:
        return
    b = nonnegative("viscosity_b", "1/K", "relative fall of the viscosity per kelvin", "b")
    E = nonnegative("viscosity_E", "K", "activation energy of the viscosity over the gas constant", "E")
    B = nonnegative("viscosity_B", "N m s/rad", "viscous friction of the bearing that warms up", "B")
    factor = positive("viscosity_factor", "1", "viscosity over that at the reference temperature", "kappa")
    words = Words(
        title="Viscous friction that falls with temperature",
        meaning="The viscosity of a lubricant falls with temperature: exponentially (Reynolds), or by"
        " Arrhenius' law.",
        hint="one speed held while the temperature rises and falls, so that temperature does not simply"
        " follow the order of the runs",
        kin=TEMPERATURE,
    )
    zero = reference_temperature("viscosity", setting.temperature_mid)
    kelvin = constant("viscosity_C0", "K", "absolute temperature of 0 degC", 273.15, letter="T_K")
    warmer = temperature - zero.symbol
    absolute = (temperature + kelvin.symbol) * (zero.symbol + kelvin.symbol)
    reynolds = sp.exp(-b.symbol * warmer)
    middle = (setting.temperature_mid + 273.15) ** 2
    falls = Shape(b, 0.002, 0.4, "log", 9)
    shared: dict[str, Any] = {
        "depends_on": ("temperature",),
        "needs": ("temperature",),
        "inputs": (v.temperature,),
        "only_with": FILM,
        "words": words,
    }
    yield rule(
        "viscosity_temperature",
        (zero, Definition(factor, reynolds)),
        scales=(Role.VISCOUS,),
        formula="viscous friction times exp(-b (T - T_0))",
        reference=f"{REYNOLDS}; {ROBOT}",
        shapes=(falls,),
        plausible=(thinning(b.symbol),),
        headline="viscous friction that falls with temperature by Reynolds' law",
        **shared,
    )
    yield rule(
        "viscosity_temperature",
        (zero, kelvin, Definition(factor, sp.exp(-E.symbol * warmer / absolute))),
        variant="arrhenius",
        scales=(Role.VISCOUS,),
        formula="viscous friction times exp(E/T - E/T_0), T in K",
        reference=f"E. N. da C. Andrade, Nature 125, 1930; {ROBOT}",
        shapes=(Shape(E, 0.002 * middle, 0.4 * middle, "log", 9),),
        plausible=(thinning(E.symbol / middle),),
        headline="viscous friction that falls with temperature by Arrhenius' law",
        **shared,
    )
    yield addition(
        "viscosity_temperature",
        [(B, omega_m * (reynolds - 1))],
        variant="bearing",
        role=Role.VISCOUS,
        formula="B w (exp(-b (T - T_0)) - 1)",
        reference=f"{REYNOLDS}; {ROBOT}",
        shapes=(falls,),
        definitions=(zero,),
        plausible=(
            thinning(b.symbol),
            *part_of_viscous(setting, B.symbol, "the part of the viscous friction that warms up"),
        ),
        headline="viscous friction of one bearing that falls with temperature",
        **shared,
    )


def coulomb_temperature(setting: Setting) -> Iterator[Effect]:
    """All Coulomb friction, or that of one bearing; none if no temperature is logged."""
    if setting.temperature_mid is None:
        return
    b = quantity("coulomb_b", "1/K", "relative change of the Coulomb friction per kelvin", letter="b")
    C = quantity("coulomb_C", "N m/K", "change of the Coulomb friction of one bearing per kelvin", letter="C")
    factor = nonnegative(
        "coulomb_factor", "1", "Coulomb friction over that at the reference temperature", "kappa"
    )
    zero = reference_temperature("coulomb", setting.temperature_mid)
    warmer = temperature - zero.symbol
    shared: dict[str, Any] = {
        "depends_on": ("temperature",),
        "needs": ("temperature",),
        "inputs": (v.temperature,),
        "reference": "A. C. Bittencourt and S. Gunnarsson, J. Dynamic Systems, Measurement and Control"
        " 134(5), 2012",
        "words": Words(
            title="Coulomb friction that changes with temperature",
            meaning="Dry friction that changes with temperature: fits and preloads grow or shrink, boundary"
            " films become thinner.",
            hint="low speeds, where viscous friction is small, at several temperatures",
            kin=TEMPERATURE,
        ),
    }
    yield rule(
        "coulomb_temperature",
        (zero, Definition(factor, sp.Max(0, 1 + b.symbol * warmer))),
        scales=(Role.COULOMB, Role.PRESLIDING),
        formula="Coulomb friction times 1 + b (T - T_0), never below 0",
        shapes=(Shape(b, -0.03, 0.03, "linear", 4),),
        headline="Coulomb friction that changes with temperature",
        **shared,
    )
    yield addition(
        "coulomb_temperature",
        [(C, direction * warmer)],
        variant="bearing",
        role=Role.COULOMB,
        formula="C (T - T_0) sgn w",
        definitions=(zero,),
        headline="Coulomb friction of one bearing that changes with temperature",
        **shared,
    )


def hidden_thermal_drift(setting: Setting) -> Iterator[Effect]:
    """All friction, all viscous friction, or viscous or Coulomb friction of one bearing.

    None if a temperature is logged: `viscosity_temperature` and `coulomb_temperature` then use it. Where the
    losses lack those of the windings, all friction is offered once more, heated by these alone.
    """
    if setting.temperature_mid is not None:
        return
    tau = positive("heat_tau", "s", "thermal time constant", "tau")
    fall = nonnegative("heat_b", "1", "fall of the logarithm of friction over the log", "b")
    B = nonnegative("heat_B", "N m s/rad", "viscous friction of the bearing that warms up", "B")
    C = nonnegative("heat_C", "N m", "fall of the Coulomb friction over the log", "C")
    factor = positive("heat_factor", "1", "friction over that of the cold drive", "kappa")
    time_constant = Shape(tau, *thermal_times(setting), "log", 8)
    shared: dict[str, Any] = {
        "depends_on": ("time", "history"),
        "reference": "L. Simoni, M. Beschi, G. Legnani and A. Visioli, Robotica 37(5), 2019"
        " (temperature not measured)",
        "words": Words(
            title="Friction that falls as the drive warms up",
            meaning="Friction falls as the drive warms up, and no temperature is logged: first-order heating"
            " by the losses.",
            hint="start cold, hold one speed until friction is steady, rest, repeat; or log a temperature",
            kin=TEMPERATURE,
        ),
    }

    def scaling(
        variant: str,
        which: str,
        roles: Collection[Role],
        heat: str,
        heated: tuple[sp.Expr, tuple[Definition, ...], State],
    ) -> Effect:
        """Friction of these roles, `which`, times a factor that falls as this heat makes the drive warm."""
        rise, definitions, state = heated
        return rule(
            "hidden_thermal_drift",
            (*definitions, Definition(factor, sp.exp(-fall.symbol * rise))),
            variant=variant,
            scales=roles,
            formula=f"{which} times exp(-b rise), tau d(rise)/dt = {heat}/mean - rise",
            states=(state,),
            shapes=(time_constant, Shape(fall, 0.03, 1.5, "log", 3)),
            headline=f"{which} that falls as the drive warms up",
            **shared,
        )

    warm = rise, definitions, state = heating("heat", setting, loss(setting), tau.symbol)
    yield scaling("", "friction", CONTACT, "losses", warm)
    yield scaling("viscous", "viscous friction", {Role.VISCOUS}, "losses", warm)
    if (windings := copper(setting)) is not None:
        power, resistance = windings
        rise_i, by_current, state_i = heating("heat", setting, power, tau.symbol)
        warm = rise_i, (resistance, *by_current), state_i
        yield scaling("windings", "friction", CONTACT, "R i^2", warm)
    yield addition(
        "hidden_thermal_drift",
        [(B, omega_m * (sp.exp(-fall.symbol * rise) - 1))],
        variant="bearing",
        role=Role.VISCOUS,
        formula="B w (exp(-b rise) - 1), tau d(rise)/dt = losses/mean - rise",
        shapes=(time_constant, Shape(fall, 0.1, 2.5, "log", 3)),
        definitions=definitions,
        states=(state,),
        plausible=part_of_viscous(setting, B.symbol, "the part of the viscous friction that warms up"),
        headline="viscous friction of one bearing that falls as the drive warms up",
        **shared,
    )
    yield addition(
        "hidden_thermal_drift",
        [(C, -direction * rise)],
        variant="coulomb",
        role=Role.COULOMB,
        formula="-C rise sgn w, tau d(rise)/dt = losses/mean - rise",
        shapes=(time_constant,),
        definitions=definitions,
        states=(state,),
        plausible=part_of_dry(setting, C.symbol, "the fall of the dry friction over the log"),
        headline="Coulomb friction that falls as the drive warms up",
        **shared,
    )
