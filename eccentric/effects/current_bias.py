"""Offset of the current sensor."""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import Effect, Evidence, Setting, Words
from eccentric.model import Change, Term, quantity
from eccentric.model import vocabulary as v

bias = quantity("bias_i", "A", "measured current minus the true one", letter="i_0")
REFERENCE = "D.-W. Chung and S.-K. Sul, IEEE Trans. Industry Applications 34(2), 1998"
WORDS = Words(
    headline="an offset of the current sensor",
    meaning="The current sensor has an offset, which shows in both balances.",
    hint="read the current with the drive switched off",
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family; without a voltage it is an alias of `coulomb_asymmetry`."""
    if setting.by_voltage:
        return ()
    effect = Effect(
        family="current_bias",
        balance="electrical",
        formula="i - bias for i",
        reference=REFERENCE,
        change=Change(
            {
                "electrical": (_term("bias_u", -v.R.symbol),),
                "mechanical": (_term("bias_torque", v.k_i.symbol),),
            }
        ),
        evidence=Evidence(depends_on=("current",), needs=("current", "voltage")),
        coefficients=(bias,),
        words=WORDS,
    )
    return (effect,)


def _term(name: str, basis: sp.Expr) -> Term:
    return Term(name, "actuator", bias.symbol, basis, REFERENCE, (None, None))
