"""Presliding: Dahl's and LuGre's bristles."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import Effect, Shape
from eccentric.effects.forms import addition, direction, dt, omega_m, relaxation, speed
from eccentric.effects.setting import Setting
from eccentric.effects.words import Words
from eccentric.model import Role, quantity

A = quantity(
    "presliding_A",
    "N m",
    "Coulomb torque that builds up with the travelled angle",
    "",
    "nonnegative",
    letter="A",
)
S = quantity("presliding_S", "N m", "its increase near rest", "", "nonnegative", letter="S")
reach = quantity("presliding_x", "rad", "motor angle over which it builds up", "", "positive", letter="x")
w_s = quantity("presliding_v", "rad/s", "Stribeck velocity, motor side", "", "positive", letter="v")
WORDS = Words(
    title="Presliding",
    meaning=(
        "Presliding: after a reversal, bristles bend before the surfaces slide (Dahl), more so at low "
        "speed (LuGre)."
    ),
    hint=("many reversals with strokes from a tenth to ten times the bending angle, finely resolved"),
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """Dahl's and LuGre's models; the state is stepped exactly for the direction of motion of the step."""
    state = relaxation(
        "presliding_z", "deflection of the bristles", speed * dt, reach.symbol, omega_m, letter="z"
    )
    late = state.symbol - direction
    low, high = 2e-3 / setting.mu, 2.0 / setting.mu
    dahl = addition(
        "presliding",
        [(A, late)],
        role=Role.PRESLIDING,
        depends_on=("history",),
        formula="A (z - sgn w), dz/dt = (w - |w| z)/x",
        reference="P. R. Dahl, A solid friction model, The Aerospace Corporation TOR-0158(3107-18)-1, 1968",
        shapes=(Shape(reach, low, high, "log", 8),),
        states=(state,),
        words=replace(WORDS, headline="presliding after each reversal by Dahl's model"),
    )
    lugre = addition(
        "presliding",
        [(A, late), (S, state.symbol * sp.exp(-((omega_m / w_s.symbol) ** 2)))],
        variant="lugre",
        role=(Role.PRESLIDING, Role.STRIBECK),
        depends_on=("history",),
        formula="A (z - sgn w) + S z exp(-(w/v)^2), dz/dt = (w - |w| z)/x",
        reference="C. Canudas de Wit, H. Olsson, K. J. Åström and P. Lischinsky, IEEE Trans. Automatic"
        " Control 40(3), 1995",
        shapes=(
            Shape(reach, low, high, "log", 5),
            Shape(w_s, setting.w_min, 0.4 * setting.w_max, "log", 4),
        ),
        states=(state,),
        words=replace(WORDS, headline="presliding after each reversal by the LuGre model"),
    )
    return dahl, lugre
