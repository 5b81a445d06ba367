"""A plane of motion whose tilt is not the declared one."""

from __future__ import annotations

import math
from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import GRAVITY, Correction, Effect, Evidence, Setting, Shape, Words
from eccentric.effects.forms import addition, harmonic, omega_m, theta_m
from eccentric.model import Change, Definition, Magnitude, Term, quantity
from eccentric.model import vocabulary as v

M, M_l, L, g, mu = (q.symbol for q in (v.M, v.M_l, v.L, v.g, v.mu))
tilt = quantity(
    "tilt_angle",
    "rad",
    "tilt of the plane from horizontal (C1) or vertical (C2)",
    "",
    "nonnegative",
    letter="delta",
)
phase = quantity("tilt_phase", "rad", "link angle from the lowest point of the tilted plane", letter="beta")
cosine = quantity("tilt_c", "N m", "gravity torque due to the tilt with cos(theta_l)", letter="c")
sine = quantity("tilt_s", "N m", "gravity torque due to the tilt with sin(theta_l)", letter="s")
g_tilted = quantity("tilt_g", "m/s^2", "gravity in the tilted plane", "", "nonnegative", letter="g^*")
F_N_tilted = quantity(
    "tilt_F_N", "N", "normal force with the gravity of the tilted plane", "", "nonnegative", letter="F_N^*"
)
more = quantity("tilt_more", "rad", "true tilt of the plane minus the declared one", letter="delta")
phi_true = quantity("tilt_phi", "rad", "true tilt of the plane of motion", "", "tilt", letter="phi^*")
REFERENCE = "derivations/rotating_link.py: the general link, phi near pi/2 or near 0"
WORDS = Words(
    title="A tilted plane of motion",
    meaning="The plane of motion is not quite horizontal (C1) or not quite vertical (C2).",
    hint="a spirit level; or slow full turns with and without the mass",
    kin=GRAVITY,
)

MOST = 0.35
"""Largest error of a declared tilt, in rad: more is no error of a spirit level."""


def effects(setting: Setting) -> tuple[Effect, ...]:
    """C1: the torque alone, linear in its two parameters, or with its normal force. C2: reduced gravity.

    None for a motor that the rig declares without an unbalanced mass: gravity has nothing to act on. A logged
    torque may have had gravity subtracted, so there it is offered. In a plane that is declared
    as tilted, another tilt; none if the log has to determine gravity.
    """
    bare = 0.0 in (setting.known.get("M"), setting.known.get("L"))
    if bare and setting.channels & {"current", "voltage"}:
        return ()
    if setting.base.tilted:
        return () if "gravity" in setting.left_open else (_tilted(setting.known.get("phi", 0.0)),)
    return _level() if setting.case == "C1" else (_upright(),)


def _level() -> tuple[Effect, Effect]:
    torque = addition(
        "gravity_tilt",
        list(zip((cosine, sine), harmonic(mu), strict=True)),
        kind="conservative",
        depends_on=("link_angle",),
        formula="c cos(theta_l) + s sin(theta_l)",
        reference=REFERENCE,
        inputs=(v.theta_m,),
        words=replace(WORDS, headline="a plane of motion that is not horizontal"),
    )
    turned = theta_m + phase.symbol / mu
    along, across = harmonic(mu, turned)
    weight = (M + M_l) * g * sp.sin(tilt.symbol)
    # The weight along the axis falls by 1 - cos(tilt) only: B_lT and C_lT absorb that.
    force = Magnitude(M * L * mu**2 * omega_m**2 + weight * along, weight * across)
    gravity = mu * M * g * sp.sin(tilt.symbol) * L * across
    load = Effect(
        family="gravity_tilt",
        variant="load",
        balance="mechanical",
        formula="mu M g sin(tilt) L sin(theta_l + phase), and its weight in the normal force",
        reference=REFERENCE,
        change=Change(
            terms={"mechanical": (Term("tilt", "conservative", sp.Integer(1), gravity, REFERENCE),)},
            definitions=(Definition(F_N_tilted, force),),
            replaces={v.F_N.symbol: F_N_tilted.symbol},
            inputs=(v.theta_m,),
        ),
        evidence=Evidence(depends_on=("link_angle",)),
        shapes=(Shape(tilt, 0.01, 0.7, "log", 3), Shape(phase, -3.6, 3.6, "linear", 13)),
        words=replace(WORDS, headline="a plane of motion that is not horizontal, normal force included"),
    )
    return torque, load


def _tilted(declared: float) -> Effect:
    # Beyond these ends only the mirror image of a plane follows.
    span = max(-MOST, -declared), min(MOST, math.pi / 2 - declared)
    true = Definition(phi_true, v.phi.symbol + more.symbol)
    return Effect(
        family="gravity_tilt",
        variant="declared",
        balance="mechanical",
        formula="phi + delta for phi",
        reference=REFERENCE,
        change=Change(definitions=(true,), replaces={v.phi.symbol: phi_true.symbol}),
        evidence=Evidence(depends_on=("gravity_load",)),
        shapes=(Shape(more, *span, "linear", 6),),
        corrects=Correction(v.phi, true.value, looks_wrong=("M g L",)),
        words=replace(WORDS, headline="a correction of the declared tilt"),
    )


def _upright() -> Effect:
    return Effect(
        family="gravity_tilt",
        balance="mechanical",
        formula="g cos(tilt) for g",
        reference=REFERENCE,
        change=Change(
            definitions=(Definition(g_tilted, g * sp.cos(tilt.symbol)),), replaces={g: g_tilted.symbol}
        ),
        evidence=Evidence(depends_on=("gravity_load",)),
        shapes=(Shape(tilt, 0.05, 1.0, "log", 4),),
        words=replace(WORDS, headline="a plane of motion that is not vertical"),
    )
