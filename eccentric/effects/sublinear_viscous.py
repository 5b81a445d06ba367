"""Viscous friction that grows less than in proportion to speed: shear thinning, and what does the same."""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import SPEED, Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, omega_m
from eccentric.model import Definition, Magnitude, Role, quantity

B = quantity(
    "thinning_B",
    "N m s/rad",
    "viscous friction at low speed that is lost at high",
    "",
    "nonnegative",
    letter="B",
)
w_c = quantity(
    "thinning_w",
    "rad/s",
    "speed above which it grows less than in proportion, motor side",
    "",
    "positive",
    letter="omega_c",
)
size = quantity("thinning_x", "1", "root of 1 + (w/w_c)^2", "", "positive", letter="x")
root = quantity("thinning_root", "1", "its square root", "", "positive", letter="r")

WORDS = Words(
    headline="viscous friction that grows less than in proportion to speed",
    meaning=(
        "Viscous friction that shear or heat of a lubricant holds back as speed rises, by Carreau's law;"
        " Cross's, Eyring's and power laws are so close to it that a log seldom distinguishes them."
    ),
    hint="steady runs over a speed range of 1 to 10 or more, warm and cold, in both directions",
    causes=(
        "grease or oil that thins by shear",
        "a lubricant that warms in its contacts as speed rises",
        "a seal",
        "the excess part of the motor's iron losses",
    ),
    kin=SPEED,
)
REFERENCE = (
    "P. J. Carreau, Trans. Society of Rheology 16(1), 1972; M. M. Cross, J. Colloid Science 20(5), 1965;"
    " H. Eyring, J. Chemical Physics 4(4), 1936; greases: A. W. Sisko, Industrial & Engineering Chemistry"
    " 50(12), 1958; contacts: H. Spikes and J. Zhang, Tribology Letters 56(1), 2014; gears of robots:"
    " R. Waiboer, R. Aarts and B. Jonker, ECCOMAS Multibody Dynamics, 2005"
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """Carreau's law with exponents 1/2 and 0: beside viscous and dry friction they make up the other laws.

    The model's own viscous friction is that at high speed, and a power law the limit of a low w_c. The
    exponent -1 is that of an eddy-current brake: its torque falls beyond a peak, as that of no lubricant
    does. As viscous friction it follows what scales the viscosity, such as temperature.
    """
    definition = Definition(size, Magnitude(omega_m / w_c.symbol, sp.Integer(1)))
    laws = {
        "n=0.5": (root.symbol, (definition, Definition(root, sp.sqrt(size.symbol)))),
        "n=0": (size.symbol, (definition,)),
    }
    return tuple(
        addition(
            "sublinear_viscous",
            [(B, omega_m / thinned)],
            variant=variant,
            role=Role.VISCOUS,
            depends_on=("velocity",),
            formula=f"B w (1 + (w/w_c)^2)^({power})",
            reference=REFERENCE,
            definitions=definitions,
            covers=("eddy_current",),
            shapes=(Shape(w_c, setting.w_min, setting.w_max, "log", 12),),
            words=WORDS,
        )
        for (variant, (thinned, definitions)), power in zip(laws.items(), ("-1/4", "-1/2"), strict=True)
    )
