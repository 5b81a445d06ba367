"""Presliding: Dahl's and LuGre's bristles."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, direction, dt, omega_m, relaxation, speed
from eccentric.model import Definition, Role, State, quantity

A = quantity(
    "presliding_A",
    "N m",
    "Coulomb torque that builds up with the travelled angle",
    "",
    "nonnegative",
    letter="A",
)
r = quantity("presliding_r", "1", "its relative increase near rest", "", "nonnegative", letter="r")
D = quantity(
    "presliding_D",
    "N m s/rad",
    "micro-damping: torque per rate of bending of the bristles",
    "",
    "nonnegative",
    letter="sigma_1",
)
level = quantity("presliding_g", "1", "level of sliding over that at high speed", "", "positive", letter="g")
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
    """Dahl's and LuGre's models; the state is stepped exactly for the speed of the step.

    LuGre's bristles z, in units of their bend at high speed x = A/sigma_0, give A z + sigma_1 x dz/dt instead
    of A sgn w, with x dz/dt = w - |w| z/g; so they bend over the angle x g(w).
    """
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
    bristle = quantity("presliding_z", "1", "deflection of the bristles", letter="z")
    end = direction * level.symbol
    bent = State(
        bristle,
        sp.Integer(0),
        end + (bristle.symbol - end) * sp.exp(-speed * dt / (reach.symbol * level.symbol)),
    )
    falling = Definition(level, 1 + r.symbol * sp.exp(-((omega_m / w_s.symbol) ** 2)))
    lugre = addition(
        "presliding",
        [(A, late), (D, omega_m - speed * bristle.symbol / level.symbol)],
        variant="lugre",
        role=Role.PRESLIDING,
        depends_on=("history",),
        formula="A (z - sgn w) + D x dz/dt, x dz/dt = w - |w| z/g, g = 1 + r exp(-(w/v)^2)",
        reference="C. Canudas de Wit, H. Olsson, K. J. Åström and P. Lischinsky, IEEE Trans. Automatic"
        " Control 40(3), 1995",
        shapes=(
            Shape(reach, low, high, "log", 5),
            Shape(w_s, setting.w_min, 0.4 * setting.w_max, "log", 4),
            Shape(r, 0.1, 2.0, "log", 2),
        ),
        definitions=(falling,),
        states=(bent,),
        words=replace(WORDS, headline="presliding after each reversal by the LuGre model"),
    )
    return dahl, lugre
