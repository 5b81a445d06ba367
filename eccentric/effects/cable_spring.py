"""A cable that twists with the link."""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import GRAVITY, Effect, Setting, Words
from eccentric.effects.forms import addition, theta_m
from eccentric.model import quantity
from eccentric.model import vocabulary as v

zero = quantity("cable_0", "N m", "torque of the cable at link angle 0, motor side", letter="T_0")
WORDS = Words(
    headline="a cable that twists with the link",
    meaning="A cable or hose that twists with the link: a torque in proportion to the link angle.",
    hint="several turns of the link in one direction and back; or remove the cable",
    kin=GRAVITY,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family; its rest angle is -cable_0/cable_k."""
    k = quantity(
        "cable_k",
        f"N m/{setting.link_radian}",
        "stiffness of the cable, torque on the motor per link angle",
        "",
        "nonnegative",
        letter="k",
    )
    effect = addition(
        "cable_spring",
        [(k, v.mu.symbol * theta_m), (zero, sp.Integer(1))],
        kind="conservative",
        depends_on=("link_angle",),
        formula="k theta_l + T_0",
        reference="R. Hooke, De potentia restitutiva, 1678",
        inputs=(v.theta_m,),
        words=WORDS,
    )
    return (effect,)
