"""Saturation of the torque constant."""

from __future__ import annotations

from eccentric.effects.effect import LOAD, Effect, Setting, Shape, Words
from eccentric.effects.forms import of_flux
from eccentric.model import MOTORS, quantity
from eccentric.model import vocabulary as v

bend = quantity(
    "ktsat_c",
    "1/A^2",
    "relative fall of the torque constant per square of the current, at small ones",
    "",
    "nonnegative",
    letter="c",
)
i_s = quantity(
    "ktsat_i", "A", "current at which it has fallen by half of c i_s^2", "", "positive", letter="i_s"
)
WORDS = Words(
    headline="a torque constant that falls at high current",
    meaning="Saturation of the iron: torque constant and back-EMF constant fall at high current.",
    hint="high currents at low speed: hold the link horizontal, or accelerate hard",
    kin=LOAD,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family; for c = 1/i_s^2 it is k_t = k_i/(1 + (i/i_s)^2).

    Far below i_s a log determines c alone: by the fraction c i_s^2 its coefficient would grow with i_s.
    """
    square = v.i.symbol**2
    # With i_s at a third of the largest current, that current takes nine tenths of all that there is to lose.
    largest, lowest = setting.current_max, setting.current_max / 3.0
    effect = of_flux(
        "kt_saturation",
        [(bend, -square / (1 + square / i_s.symbol**2))],
        setting,
        # The largest c of those forms whose torque constant is positive at any current, c i_s^2 <= 1; of the
        # others the log has to keep it so.
        bounds=((0.0, lowest**-2),),
        depends_on=("current",),
        formula="k_i and k_e times 1 - c i^2/(1 + (i/i_s)^2)",
        reference="form of our own; armature reaction: A. E. Fitzgerald, C. Kingsley and S. D. Umans,"
        " Electric Machinery",
        shapes=(Shape(i_s, lowest, 20.0 * largest, "log", 10),),
        # A winding without iron has none in the way of its own field.
        only_with={"motor": tuple(m for m in MOTORS if m != "coreless")},
        words=WORDS,
    )
    return (effect,)
