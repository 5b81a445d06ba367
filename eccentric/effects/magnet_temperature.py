"""A torque constant and back-EMF constant that fall as the magnets warm up."""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import TEMPERATURE, Effect, Plausible, Setting, Words
from eccentric.effects.forms import constant, of_flux
from eccentric.model import MAGNETS, quantity
from eccentric.model import vocabulary as v

fall = quantity(
    "magnet_a", "1/K", "relative fall of the motor's flux per kelvin", "", "nonnegative", letter="a"
)
# The temperature of the declared constants is not in the rig file, so this is free.
cold = quantity("magnet_0", "1", "relative error of the declared constants at T_0", letter="k_0")
MAGNETS_KNOWN = Plausible(
    100 * fall.symbol,
    "%/K",
    0.02,
    0.20,
    "neomagnetsupplier.com, Types of Magnets, 2008: ferrite 0.20, NdFeB 0.12, SmCo 0.04, Alnico 0.02 %/K",
    "the temperature coefficient of the flux",
    above="not the magnets alone",
    below="less than any magnet, or a sensor that warms up more than the magnets",
)
WORDS = Words(
    headline="torque and back-EMF constants that fall as the magnets warm up",
    meaning=(
        "The flux of permanent magnets falls with temperature, reversibly: by 0.1 % per kelvin for neodymium,"
        " 0.2 % for ferrite, 0.04 % for samarium-cobalt; torque constant and back-EMF constant fall with it."
    ),
    hint="drive the motor externally with its terminals open, cold and warm, and read the voltage",
    kin=TEMPERATURE,
    tell_apart={
        "resistance_temperature": "Hold the rotor locked at a constant current while it warms: only R shows.",
    },
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family; none if no temperature is logged.

    The voltage alone identifies R/k_i, and does not tell which of both changes: `resistance_temperature`.
    """
    if setting.temperature_mid is None or setting.by_voltage:
        return ()
    zero = constant("magnet_T0", "K", "reference temperature in degC", setting.temperature_mid, letter="T_0")
    effect = of_flux(
        "magnet_temperature",
        [(fall, zero.symbol - v.temperature.symbol), (cold, sp.Integer(1))],
        setting,
        # No magnet loses 1 % per kelvin, and no data sheet is off by half.
        bounds=((0.0, 0.01), (-0.5, 0.5)),
        depends_on=("temperature", "current"),
        needs=("temperature",),
        formula="k_i and k_e times 1 + k_0 - a (T - T_0)",
        reference="T. J. E. Miller, Brushless Permanent-Magnet and Reluctance Motor Drives, Oxford"
        " University Press, 1989",
        definitions=(zero,),
        inputs=(v.temperature,),
        only_with={"motor": MAGNETS},
        plausible=(MAGNETS_KNOWN,),
        words=WORDS,
    )
    return (effect,)
