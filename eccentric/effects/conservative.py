"""Torques on the link that are no friction: gravity in another plane or angle, a cable, a constant load."""

from __future__ import annotations

import math
from collections.abc import Iterator

import sympy as sp

from eccentric.effects.effect import GRAVITY, Correction, Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, harmonic, mu, nonnegative, omega_m, rule, theta_m
from eccentric.model import Definition, Magnitude, Model, Term, quantity
from eccentric.model import vocabulary as v

M, M_l, L, g = (q.symbol for q in (v.M, v.M_l, v.L, v.g))
MOST = 0.35
"""Largest error of a declared tilt, in rad: more is not an error of a spirit level."""

# What the base model of case C1 already contains, and the column of it.
IN_C1 = {"angle_offset": "nothing at all: no term depends on the link angle"}


def gravity_tilt(setting: Setting) -> Iterator[Effect]:
    """C1: the torque alone, linear in its two parameters, or with its normal force. C2: reduced gravity.

    None for a motor that the rig declares without an unbalanced mass: gravity has nothing to act on. A logged
    torque may have had gravity subtracted, so there it is offered. In a plane that is declared as tilted,
    another tilt; none if the log has to determine gravity.
    """
    if 0.0 in (setting.known.get("M"), setting.known.get("L")) and setting.channels & {"current", "voltage"}:
        return
    reference = "derivations/rotating_link.py: the general link, phi near pi/2 or near 0"
    words = Words(
        title="A tilted plane of motion",
        meaning="The plane of motion is not quite horizontal (C1) or not quite vertical (C2).",
        hint="a spirit level; or slow full turns with and without the mass",
        kin=GRAVITY,
    )
    if setting.base.tilted:
        if "gravity" in setting.left_open:
            return
        more = quantity("tilt_more", "rad", "true tilt of the plane minus the declared one", letter="delta")
        phi_true = quantity("tilt_phi", "rad", "true tilt of the plane of motion", "", "tilt", letter="phi^*")
        true, declared = Definition(phi_true, v.phi.symbol + more.symbol), setting.known.get("phi", 0.0)
        # Beyond these ends only the mirror image of a plane follows.
        span = max(-MOST, -declared), min(MOST, math.pi / 2 - declared)
        yield rule(
            "gravity_tilt",
            (true,),
            variant="declared",
            replaces={v.phi.symbol: true.symbol},
            depends_on=("gravity_load",),
            formula="phi + delta for phi",
            reference=reference,
            shapes=(Shape(more, *span, "linear", 6),),
            corrects=Correction(v.phi, true.value, looks_wrong=("M g L",)),
            words=words,
            headline="a correction of the declared tilt",
        )
        return
    tilt = nonnegative(
        "tilt_angle", "rad", "tilt of the plane from horizontal (C1) or vertical (C2)", "delta"
    )
    if setting.case == "C2":
        g_tilted = nonnegative("tilt_g", "m/s^2", "gravity in the tilted plane", "g^*")
        yield rule(
            "gravity_tilt",
            (Definition(g_tilted, g * sp.cos(tilt.symbol)),),
            replaces={g: g_tilted.symbol},
            depends_on=("gravity_load",),
            formula="g cos(tilt) for g",
            reference=reference,
            shapes=(Shape(tilt, 0.05, 1.0, "log", 4),),
            words=words,
            headline="a plane of motion that is not vertical",
        )
        return
    cosine = quantity("tilt_c", "N m", "gravity torque due to the tilt with cos(theta_l)", letter="c")
    sine = quantity("tilt_s", "N m", "gravity torque due to the tilt with sin(theta_l)", letter="s")
    yield addition(
        "gravity_tilt",
        list(zip((cosine, sine), harmonic(mu), strict=True)),
        kind="conservative",
        depends_on=("link_angle",),
        formula="c cos(theta_l) + s sin(theta_l)",
        reference=reference,
        inputs=(v.theta_m,),
        words=words,
        headline="a plane of motion that is not horizontal",
    )
    phase = quantity(
        "tilt_phase", "rad", "link angle from the lowest point of the tilted plane", letter="beta"
    )
    F_N_tilted = nonnegative("tilt_F_N", "N", "normal force with the gravity of the tilted plane", "F_N^*")
    along, across = harmonic(mu, theta_m + phase.symbol / mu)
    weight = (M + M_l) * g * sp.sin(tilt.symbol)
    # The weight along the axis falls by 1 - cos(tilt) only: B_lT and C_lT absorb that.
    force = Magnitude(M * L * mu**2 * omega_m**2 + weight * along, weight * across)
    torque = mu * M * g * sp.sin(tilt.symbol) * L * across
    yield rule(
        "gravity_tilt",
        (Definition(F_N_tilted, force),),
        variant="load",
        replaces={v.F_N.symbol: F_N_tilted.symbol},
        terms=(Term("tilt", "conservative", sp.Integer(1), torque, reference),),
        depends_on=("link_angle",),
        formula="mu M g sin(tilt) L sin(theta_l + phase), and its weight in the normal force",
        reference=reference,
        inputs=(v.theta_m,),
        shapes=(Shape(tilt, 0.01, 0.7, "log", 3), Shape(phase, -3.6, 3.6, "linear", 13)),
        words=words,
        headline="a plane of motion that is not horizontal, normal force included",
    )


def angle_offset(setting: Setting) -> Iterator[Effect]:
    """A shifted angle, or its torque alone, which a link with lateral imbalance has as well; case C2 only.

    None if the rig leaves the zero angle to be identified: the fit then includes it already.
    """
    if setting.case == "C1" or "theta_zero_rad" in setting.left_open:
        return
    offset = quantity("offset_angle", "rad", "true link angle minus the logged one", letter="theta_0")
    torque = quantity("offset_torque", "N m", "gravity torque where the logged link angle is 0", letter="T_0")
    theta_true = quantity("theta_true", "rad", "true motor angle", letter="theta_m^*")
    reference = (
        "B. W. Mooring, Z. S. Roth and M. R. Driels, Fundamentals of Manipulator Calibration, Wiley, 1991"
    )
    words = Words(
        title="An offset of the link angle",
        meaning="The link angle is not 0 where the mass hangs lowest.",
        hint="let the link swing out freely and read the angle at which it comes to rest",
        kin=GRAVITY,
    )
    yield rule(
        "angle_offset",
        (Definition(theta_true, theta_m + offset.symbol / mu),),
        replaces={theta_m: theta_true.symbol},
        depends_on=("link_angle",),
        formula="theta_l + offset for theta_l",
        reference=reference,
        shapes=(Shape(offset, -0.7, 0.7, "linear", 6),),
        words=words,
        headline="an offset of the link angle",
    )
    yield addition(
        "angle_offset",
        [(torque, harmonic(mu)[0])],
        variant="torque",
        kind="conservative",
        depends_on=("link_angle",),
        formula="T cos(theta_l)",
        reference=reference,
        inputs=(v.theta_m,),
        words=words,
        headline="a gravity torque where the link angle is zero",
    )


def cable_spring(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family: a cable that twists with the link; its rest angle is -cable_0/cable_k."""
    k = nonnegative(
        "cable_k",
        f"N m/{setting.link_radian}",
        "stiffness of the cable, torque on the motor per link angle",
        "k",
    )
    zero = quantity("cable_0", "N m", "torque of the cable at link angle 0, motor side", letter="T_0")
    yield addition(
        "cable_spring",
        [(k, mu * theta_m), (zero, sp.Integer(1))],
        kind="conservative",
        depends_on=("link_angle",),
        formula="k theta_l + T_0",
        reference="R. Hooke, De potentia restitutiva, 1678",
        inputs=(v.theta_m,),
        words=Words(
            headline="a cable that twists with the link",
            meaning="A cable or hose that twists with the link: a torque in proportion to the link angle.",
            hint="several turns of the link in one direction and back; or remove the cable",
            kin=GRAVITY,
        ),
    )


# The weight on a screw drive, a spring at its working point. Not a family of the library: a declared load
# belongs to the base model, and an undeclared one is indistinguishable from friction that differs between the
# directions.
T_load = quantity("T_load", "N m", "constant torque of the load on the link, against positive motion")

constant_load: Effect = addition(
    "constant_load",
    [(T_load, mu)],
    kind="conservative",
    depends_on=("direction",),
    formula="mu T_load",
    reference="torque balance of the link, as gravity in the paper's eq (5), but constant",
    words=Words(headline="a constant load on the link", hint="another weight"),
)
"""The record that extends a model by a constant load on the link."""


def with_constant_load(model: Model, value: float = 0.0) -> Model:
    """The model, extended by the load with this default [N m]; as it is where it has one already."""
    if T_load.name in {q.name for q in model.parameters}:
        return model
    return constant_load.extend(model, {T_load.name: value})
