"""A tight spot at one link angle."""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, direction, theta_m
from eccentric.model import HalfSine, Role, quantity
from eccentric.model import vocabulary as v

A = quantity("defect_A", "N m", "friction torque of the tight spot", "", "nonnegative", letter="A")
WORDS = Words(
    headline="a tight spot at one angle of the link",
    meaning="A tight spot at one link angle: a dent in a race, a rubbing seal, dirt between teeth.",
    hint="slow full turns of the link in both directions, with friction plotted over the link angle",
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family, a von Mises bump; cos x - 1 is written as -2 sin^2(x/2)."""
    unit = setting.link_radian
    angle = quantity("defect_angle", unit, "link angle at the tight spot", letter="theta_0")
    width = quantity(
        "defect_width", unit, "its width as a standard deviation, link side", "", "positive", letter="sigma"
    )
    half = HalfSine(theta_m - angle.symbol / v.mu.symbol, v.mu.symbol)
    effect = addition(
        "local_defect",
        [(A, sp.exp(-2 * (half / width.symbol) ** 2) * direction)],
        role=Role.COULOMB,
        depends_on=("link_angle",),
        formula="A exp((cos(theta_l - theta_0) - 1)/sigma^2) sgn w",
        reference="N. Tandon and A. Choudhury, Tribology International 32(8), 1999; bump: R. von"
        " Mises, Physikalische Zeitschrift 19, 1918",
        shapes=(Shape(angle, -3.2, 3.2, "linear", 38), Shape(width, 0.06, 0.5, "log", 4)),
        inputs=(v.theta_m,),
        words=WORDS,
    )
    return (effect,)
