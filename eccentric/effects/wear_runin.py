"""Running-in."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import TIME, Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, direction, dt, speed
from eccentric.model import Role, State, quantity
from eccentric.model import vocabulary as v

C = quantity("wear_C", "N m", "Coulomb torque at the start beyond the final one", letter="C")
tau = quantity("wear_tau", "s", "time over which it settles", "", "positive", letter="tau")
way = quantity("wear_s", "rad", "motor angle travelled", "", "nonnegative", letter="s")
reach = quantity("wear_x", "rad", "travelled motor angle over which it settles", "", "positive", letter="x")
REFERENCE = "standard form; running-in: P. J. Blau, Tribology International 38(11-12), 2005"
WORDS = Words(
    title="Coulomb friction that settles as surfaces run in",
    meaning="Running-in: dry friction settles as surfaces wear smooth, over time or over distance.",
    hint="repeat the same run at the end: friction stays low after a rest; after heating it does not",
    kin=TIME,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """Over time, and over the angle travelled."""
    end = setting.duration_s
    # Half the greatest speed approximates the mean.
    travelled = 0.5 * setting.w_max * end
    in_time = addition(
        "wear_runin",
        [(C, direction * sp.exp(-v.t.symbol / tau.symbol))],
        role=Role.COULOMB,
        depends_on=("time",),
        formula="C exp(-t/tau) sgn w",
        reference=REFERENCE,
        shapes=(Shape(tau, 0.05 * end, 0.5 * end, "log", 6),),
        inputs=(v.t,),
        words=replace(WORDS, headline="Coulomb friction that settles over time as surfaces run in"),
    )
    in_way = addition(
        "wear_runin",
        [(C, direction * sp.exp(-way.symbol / reach.symbol))],
        variant="travel",
        role=Role.COULOMB,
        depends_on=("time",),
        formula="C exp(-s/x) sgn w, s the motor angle travelled",
        reference=REFERENCE,
        shapes=(Shape(reach, 0.05 * travelled, 0.6 * travelled, "log", 6),),
        states=(State(way, sp.Integer(0), way.symbol + speed * dt),),
        words=replace(
            WORDS, headline="Coulomb friction that settles over the angle travelled as surfaces run in"
        ),
    )
    return in_time, in_way
