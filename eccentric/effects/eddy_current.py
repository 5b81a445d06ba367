"""Eddy-current brake."""

from __future__ import annotations

from eccentric.effects.effect import SPEED, Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, omega_m
from eccentric.model import Role, quantity

D = quantity("eddy_D", "N m s/rad", "eddy-current damping at low speed", "", "nonnegative", letter="D")
w_c = quantity(
    "eddy_w",
    "rad/s",
    "speed of the greatest eddy-current torque, motor side",
    "",
    "positive",
    letter="omega_c",
)
WORDS = Words(
    headline="an eddy-current brake",
    meaning=(
        "Eddy currents, in a brake or as iron losses of the motor: viscous at low speed, weaker above a"
        " critical speed."
    ),
    hint="steady runs below, at and far above the critical speed; removing the magnet removes the effect",
    kin=SPEED,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family."""
    effect = addition(
        "eddy_current",
        [(D, omega_m / (1 + (omega_m / w_c.symbol) ** 2))],
        role=Role.EDDY_CURRENT,
        depends_on=("velocity",),
        formula="D w/(1 + (w/w_c)^2)",
        reference="J. H. Wouterse, IEE Proceedings B 138(4), 1991",
        shapes=(Shape(w_c, 2.0 * setting.w_min, 0.8 * setting.w_max, "log", 12),),
        # The iron of other motors is laminated: its eddy currents are weaker above a speed that no motor has.
        only_with={"motor": ("eddy-current brake", "induction")},
        words=WORDS,
    )
    return (effect,)
