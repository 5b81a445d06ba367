"""Temperature-dependent resistance of the winding."""

from __future__ import annotations

from dataclasses import replace

from eccentric.effects.effect import TEMPERATURE, Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import addition, constant, heating, thermal_times
from eccentric.model import quantity
from eccentric.model import vocabulary as v

alpha = quantity(
    "resistance_alpha", "1/K", "relative rise of the winding's resistance per kelvin", letter="alpha"
)
# The temperature of the declared R is not in the rig file, so this is free.
cold = quantity("resistance_r0", "1", "relative error of the declared resistance at T_0", letter="r_0")
rise = quantity(
    "resistance_rise",
    "1",
    "relative rise of the resistance over the log",
    "",
    "nonnegative",
    letter="r",
)
tau = quantity("resistance_tau", "s", "thermal time constant of the winding", "", "positive", letter="tau")
REFERENCE = (
    "standard form; thermal models: A. Boglietti et al., IEEE Trans. Industrial Electronics 56(3), 2009"
)
# R_20 (1 + 0.00393 (T - 20 degC)) rises by 0.43 % of itself per kelvin at 0 degC, by 0.25 % at 180 degC.
COPPER = Plausible(
    100 * alpha.symbol,
    "%/K",
    0.25,
    0.43,
    "IEC 60028, International standard of resistance for copper, 1925: 0.393 %/K at 20 degC",
    "the temperature coefficient of the resistance",
    0.393,
    "copper's",
    above="not the winding alone",
    below="a part of the resistance that is not copper, or a sensor that warms up more than the winding",
)
WARMING = Plausible(
    100 * rise.symbol,
    "%",
    0.0,
    63.0,
    "copper, IEC 60028, 1925, from 20 degC to 180 degC, class H of IEC 60085, 2007",
    "the rise of the resistance over the log",
    above="more than a winding survives",
)
WORDS = Words(
    title="A winding resistance that rises with temperature",
    meaning="The winding's resistance rises with its temperature, logged or computed from R i^2.",
    hint="the locked rotor at a constant current: the voltage then shows only the resistance",
    kin=TEMPERATURE,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """By the logged temperature, if there is one, or by the winding's own heat R i^2."""
    drop = v.R.symbol * v.i.symbol
    found = []
    if setting.temperature_mid is not None:
        zero = constant(
            "resistance_T0", "K", "reference temperature in degC", setting.temperature_mid, letter="T_0"
        )
        columns = [(alpha, drop * (v.temperature.symbol - zero.symbol)), (cold, drop)]
        found.append(
            addition(
                "resistance_temperature",
                columns if not setting.by_voltage else columns[:1],
                kind="actuator",
                balance="electrical",
                depends_on=("temperature", "current"),
                formula="R (1 + r_0 + alpha (T - T_0)) for R",
                reference=REFERENCE,
                definitions=(zero,),
                inputs=(v.temperature,),
                needs=("current", "voltage", "temperature"),
                plausible=(COPPER,),
                words=replace(WORDS, headline="a winding resistance that rises with temperature"),
            )
        )
    warm, definitions, state = heating("resistance", setting, drop * v.i.symbol, tau.symbol)
    found.append(
        addition(
            "resistance_temperature",
            [(rise, drop * warm)],
            variant="hidden",
            kind="actuator",
            balance="electrical",
            depends_on=("current", "time"),
            formula="R (1 + r rise) for R, tau d(rise)/dt = R i^2/mean - rise",
            reference=REFERENCE,
            shapes=(Shape(tau, *thermal_times(setting), "log", 8),),
            definitions=definitions,
            states=(state,),
            plausible=(WARMING,),
            needs=("current", "voltage"),
            words=replace(WORDS, headline="a winding resistance that rises as the winding heats up"),
        )
    )
    return tuple(found)
