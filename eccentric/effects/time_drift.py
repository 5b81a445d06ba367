"""Friction that drifts over the log."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import TIME, Effect, Evidence, Setting, Shape, Words
from eccentric.effects.forms import addition, direction
from eccentric.model import CONTACT, Change, Definition, Role, quantity
from eccentric.model import vocabulary as v

C = quantity("drift_C", "N m/s", "change of the Coulomb torque per second", letter="C")
rate = quantity("drift_rate", "1/s", "relative change of friction per second", letter="r")
factor = quantity(
    "drift_factor", "1", "friction over that at the start of the log", "", "nonnegative", letter="kappa"
)
REFERENCE = "standard form; parameters that drift: R. Isermann, Fault-Diagnosis Systems, Springer, 2006"
WORDS = Words(
    title="Friction that drifts over time",
    meaning="Friction that drifts linearly over the log, whatever the cause.",
    hint="repeat the first run at the end, and again after a rest",
    kin=TIME,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """Coulomb friction, and all friction."""
    dry = addition(
        "time_drift",
        [(C, direction * v.t.symbol)],
        role=Role.COULOMB,
        depends_on=("time",),
        formula="C t sgn w",
        reference=REFERENCE,
        inputs=(v.t,),
        words=replace(WORDS, headline="Coulomb friction that drifts over time"),
    )
    most = 0.6 / setting.duration_s
    every = Effect(
        family="time_drift",
        variant="all",
        balance="mechanical",
        formula="friction times 1 + rate t, never below 0",
        reference=REFERENCE,
        change=Change(
            definitions=(Definition(factor, sp.Max(0, 1 + rate.symbol * v.t.symbol)),),
            scales=dict.fromkeys(CONTACT, factor.symbol),
            inputs=(v.t,),
        ),
        evidence=Evidence(depends_on=("time",)),
        shapes=(Shape(rate, -most, most, "linear", 4),),
        words=replace(WORDS, headline="friction that drifts over time"),
    )
    return dry, every
