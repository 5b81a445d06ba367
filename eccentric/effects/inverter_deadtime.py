"""Dead time of the inverter."""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import Effect, Setting, Shape, Words
from eccentric.effects.forms import addition
from eccentric.model import Sgn, quantity
from eccentric.model import vocabulary as v

V = quantity("deadtime_u", "V", "voltage lost at high current", "", "nonnegative", letter="V")
i_0 = quantity("deadtime_i", "A", "current within which it changes sign", "", "positive", letter="i_0")
WORDS = Words(
    headline="the voltage lost to the dead time of the inverter",
    meaning=(
        "Dead time of the inverter, drop across switches or brushes: a voltage lost with the current's sign."
    ),
    hint="currents that pass slowly through zero in both directions, with a locked rotor",
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family; tanh is written with exp(-2|x|), which never overflows.

    With exp in the numerator as well, expanding would turn exp(-2|x|)/(1 + exp(-2|x|)) into 1/(exp(2|x|) +
    1).
    """
    i, largest = v.i.symbol, setting.current_max
    small = sp.exp(-2 * sp.Abs(i) / i_0.symbol)
    effect = addition(
        "inverter_deadtime",
        [(V, Sgn(i) * (2 / (1 + small) - 1))],
        kind="actuator",
        balance="electrical",
        depends_on=("current", "voltage"),
        formula="V tanh(i/i_0)",
        reference="smoothed; S.-G. Jeong and M.-H. Park, IEEE Trans. Industrial Electronics 38(2), 1991",
        shapes=(Shape(i_0, 0.002 * largest, 0.2 * largest, "log", 6),),
        needs=("current", "voltage"),
        words=WORDS,
    )
    return (effect,)
