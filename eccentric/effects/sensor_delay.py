"""The current is measured late: it shows in both balances, in proportion to how fast the current changes."""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import Effect
from eccentric.effects.forms import addition, current_slope
from eccentric.effects.setting import Setting
from eccentric.model import Term, quantity
from eccentric.model import vocabulary as v

delay = quantity("delay_d", "s", "delay of the measured current behind angle and voltage")
BOUNDS = (-0.02, 0.07)
REFERENCE = (
    "first order of the Taylor series i(t + d) = i + d di/dt, as in H. Pade's approximant [1/0] of a delay"
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family, di/dt being a state; in both balances where a voltage is logged."""
    slope, states = current_slope("delay")
    torque, drop = -v.k_i.symbol * slope, v.R.symbol * slope
    terms = {"mechanical": (_term("delay_torque", torque),)}
    if setting.has("voltage"):
        terms["electrical"] = (_term("delay_u", drop),)
    effect = addition(
        "sensor_delay",
        [(delay, drop if setting.has("voltage") else torque)],
        balance="electrical" if setting.has("voltage") else "mechanical",
        bounds=(BOUNDS,),
        terms=terms,
        depends_on=("history", "current"),
        formula="i(t + d), to first order i + d di/dt, for i",
        reference=REFERENCE,
        states=states,
        needs=("current",),
        hint="a step of voltage with the rotor held: voltage and current must move together",
    )
    return (effect,)


def _term(name: str, basis: sp.Expr) -> Term:
    return Term(name, "actuator", delay.symbol, basis, REFERENCE, BOUNDS)
