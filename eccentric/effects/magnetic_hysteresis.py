"""Magnetic hysteresis."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, relaxation
from eccentric.model import MOTORS, State, quantity
from eccentric.model import vocabulary as v

# Of this sign the torque lags behind the current: of the other, every cycle of the current would give energy.
A = quantity(
    "hysteresis_A",
    "N m",
    "half the difference in torque between falling and rising current",
    "",
    "nonnegative",
    letter="A",
)
width = quantity(
    "hysteresis_i", "A", "change of current within which the branches meet", "", "positive", letter="i_h"
)
# A winding without iron turns in a field that stands still in all the iron there is.
WITH_IRON = {"motor": tuple(m for m in MOTORS if m != "coreless")}
last = quantity("hysteresis_last", "A", "current one time step ago", letter="i_old")
play = quantity("hysteresis_p", "1", "play of the current, in half widths", letter="p")
WORDS = Words(
    title="Magnetic hysteresis",
    meaning="Magnetic hysteresis: the torque lags behind the current, whatever the rate.",
    hint="rising and falling current through the same value, at rest against a stop or at constant speed",
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """Duhem's model, with branches that meet exponentially, and the play operator, with parallel ones."""
    i, largest = v.i.symbol, setting.current_max
    step = i - last.symbol
    branch = relaxation(
        "hysteresis_z", "branch of the hysteresis, -1 to 1", sp.Abs(step), width.symbol, step, letter="z"
    )
    duhem = addition(
        "magnetic_hysteresis",
        [(A, branch.symbol)],
        kind="actuator",
        depends_on=("current", "history"),
        formula="A z, dz = (di - |di| z)/width",
        reference="B. D. Coleman and M. L. Hodgdon, Int. J. Engineering Science 24(6), 1986",
        shapes=(Shape(width, 0.03 * largest, 2.0 * largest, "log", 7),),
        states=(State(last, sp.Integer(0), i), branch),
        needs=("current",),
        only_with=WITH_IRON,
        words=replace(WORDS, headline="magnetic hysteresis between current and torque by Duhem's model"),
    )
    scaled = i / width.symbol
    follow = State(play, sp.Integer(0), sp.Max(scaled - 1, sp.Min(scaled + 1, play.symbol)))
    parallel = addition(
        "magnetic_hysteresis",
        [(A, scaled - play.symbol)],
        variant="play",
        kind="actuator",
        depends_on=("current", "history"),
        formula="A (i/width - p), p the play of i/width",
        reference="M. Brokate and J. Sprekels, Hysteresis and Phase Transitions, Springer, 1996",
        shapes=(Shape(width, 0.02 * largest, 0.8 * largest, "log", 4),),
        states=(follow,),
        needs=("current",),
        only_with=WITH_IRON,
        words=replace(WORDS, headline="magnetic hysteresis between current and torque by the play operator"),
    )
    return duhem, parallel
