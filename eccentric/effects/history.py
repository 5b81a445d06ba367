"""Friction by what has happened before: bristles that bend, surfaces that run in, a drift over the log."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from eccentric.effects.effect import TIME, Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import (
    addition,
    direction,
    dt,
    mu,
    nonnegative,
    omega_m,
    positive,
    relaxation,
    rule,
    speed,
    time,
)
from eccentric.model import CONTACT, Definition, Role, State, quantity
from eccentric.model import vocabulary as v


def presliding(setting: Setting) -> Iterator[Effect]:
    """Dahl's and LuGre's models; the state is stepped exactly for the speed of the step.

    LuGre's bristles z, in units of their bend at high speed x = A/sigma_0, give A z + sigma_1 x dz/dt instead
    of A sgn w, with x dz/dt = w - |w| z/g; so they bend over the angle x g(w).
    """
    A = nonnegative("presliding_A", "N m", "Coulomb torque that builds up with the travelled angle", "A")
    r = nonnegative("presliding_r", "1", "its relative increase near rest", "r")
    D = nonnegative(
        "presliding_D", "N m s/rad", "micro-damping: torque per rate of bending of the bristles", "sigma_1"
    )
    level = positive("presliding_g", "1", "level of sliding over that at high speed", "g")
    reach = positive("presliding_x", "rad", "motor angle over which it builds up", "x")
    w_s = positive("presliding_v", "rad/s", "Stribeck velocity, motor side", "v")
    words = Words(
        title="Presliding",
        meaning="Presliding: after a reversal, bristles bend before the surfaces slide (Dahl), more so at low"
        " speed (LuGre).",
        hint="many reversals with strokes from a tenth to ten times the bending angle, finely resolved",
    )
    bends = Plausible(
        1000 * mu * reach.symbol,
        "um",
        0.0,
        100.0,
        "S. Futami, A. Furutani and S. Yoshida, Nanotechnology 1(1), 1990: rolling contacts bend over up to"
        " 100 um, sliding ones over less",
        "the way over which it builds up, at the link and 1 mm from its axis,",
        above="longer than a contact bends: a gear that is elastic or loose",
    )
    state = relaxation(
        "presliding_z", "deflection of the bristles", speed * dt, reach.symbol, omega_m, letter="z"
    )
    z = state.symbol
    low, high = 2e-3 / setting.mu, 2.0 / setting.mu
    yield addition(
        "presliding",
        [(A, z - direction)],
        role=Role.PRESLIDING,
        depends_on=("history",),
        formula="A (z - sgn w), dz/dt = (w - |w| z)/x",
        reference="P. R. Dahl, A solid friction model, The Aerospace Corporation TOR-0158(3107-18)-1, 1968",
        shapes=(Shape(reach, low, high, "log", 8),),
        states=(state,),
        plausible=(bends,) if setting.base.axis.wraps else (),
        words=words,
        headline="presliding after each reversal by Dahl's model",
    )
    end = direction * level.symbol
    bent = end + (z - end) * sp.exp(-speed * dt / (reach.symbol * level.symbol))
    yield addition(
        "presliding",
        [(A, z - direction), (D, omega_m - speed * z / level.symbol)],
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
        definitions=(Definition(level, 1 + r.symbol * sp.exp(-((omega_m / w_s.symbol) ** 2))),),
        states=(State(state.quantity, sp.Integer(0), bent),),
        plausible=(bends,) if setting.base.axis.wraps else (),
        words=words,
        headline="presliding after each reversal by the LuGre model",
    )


def wear_runin(setting: Setting) -> Iterator[Effect]:
    """Running-in over time, and over the angle travelled."""
    C = quantity("wear_C", "N m", "Coulomb torque at the start beyond the final one", letter="C")
    tau = positive("wear_tau", "s", "time over which it settles", "tau")
    way = nonnegative("wear_s", "rad", "motor angle travelled", "s")
    reach = positive("wear_x", "rad", "travelled motor angle over which it settles", "x")
    reference = "standard form; running-in: P. J. Blau, Tribology International 38(11-12), 2005"
    words = Words(
        title="Coulomb friction that settles as surfaces run in",
        meaning="Running-in: dry friction settles as surfaces wear smooth, over time or over distance.",
        hint="repeat the same run at the end: friction stays low after a rest; after heating it does not",
        kin=TIME,
    )
    end = setting.duration_s
    # Half the greatest speed approximates the mean.
    travelled = 0.5 * setting.w_max * end
    yield addition(
        "wear_runin",
        [(C, direction * sp.exp(-time / tau.symbol))],
        role=Role.COULOMB,
        depends_on=("time",),
        formula="C exp(-t/tau) sgn w",
        reference=reference,
        shapes=(Shape(tau, 0.05 * end, 0.5 * end, "log", 6),),
        inputs=(v.t,),
        words=words,
        headline="Coulomb friction that settles over time as surfaces run in",
    )
    yield addition(
        "wear_runin",
        [(C, direction * sp.exp(-way.symbol / reach.symbol))],
        variant="travel",
        role=Role.COULOMB,
        depends_on=("time",),
        formula="C exp(-s/x) sgn w, s the motor angle travelled",
        reference=reference,
        shapes=(Shape(reach, 0.05 * travelled, 0.6 * travelled, "log", 6),),
        states=(State(way, sp.Integer(0), way.symbol + speed * dt),),
        words=words,
        headline="Coulomb friction that settles over the angle travelled as surfaces run in",
    )


def time_drift(setting: Setting) -> Iterator[Effect]:
    """Coulomb friction, and all friction, that drifts linearly."""
    C = quantity("drift_C", "N m/s", "change of the Coulomb torque per second", letter="C")
    rate = quantity("drift_rate", "1/s", "relative change of friction per second", letter="r")
    factor = nonnegative("drift_factor", "1", "friction over that at the start of the log", "kappa")
    shared: dict[str, Any] = {
        "depends_on": ("time",),
        "inputs": (v.t,),
        "reference": "standard form; parameters that drift: R. Isermann, Fault-Diagnosis Systems, Springer,"
        " 2006",
        "words": Words(
            title="Friction that drifts over time",
            meaning="Friction that drifts linearly over the log, whatever the cause.",
            hint="repeat the first run at the end, and again after a rest",
            kin=TIME,
        ),
    }
    yield addition(
        "time_drift",
        [(C, direction * time)],
        role=Role.COULOMB,
        formula="C t sgn w",
        headline="Coulomb friction that drifts over time",
        **shared,
    )
    most = 0.6 / setting.duration_s
    yield rule(
        "time_drift",
        (Definition(factor, sp.Max(0, 1 + rate.symbol * time)),),
        variant="all",
        scales=CONTACT,
        formula="friction times 1 + rate t, never below 0",
        shapes=(Shape(rate, -most, most, "linear", 4),),
        headline="friction that drifts over time",
        **shared,
    )
