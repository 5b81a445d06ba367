"""A zero of the link angle other than the declared one."""

from __future__ import annotations

from dataclasses import replace

from eccentric.effects.effect import GRAVITY, Effect, Evidence, Setting, Shape, Words
from eccentric.effects.forms import addition, harmonic, theta_m
from eccentric.model import Change, Definition, quantity
from eccentric.model import vocabulary as v

offset = quantity("offset_angle", "rad", "true link angle minus the logged one", letter="theta_0")
torque = quantity("offset_torque", "N m", "gravity torque where the logged link angle is 0", letter="T_0")
theta_true = quantity("theta_true", "rad", "true motor angle", letter="theta_m^*")
REFERENCE = "B. W. Mooring, Z. S. Roth and M. R. Driels, Fundamentals of Manipulator Calibration, Wiley, 1991"
WORDS = Words(
    title="An offset of the link angle",
    meaning="The link angle is not 0 where the mass hangs lowest.",
    hint="let the link swing out freely and read the angle at which it comes to rest",
    kin=GRAVITY,
)

# What the base model of case C1 already contains, and the column of it.
IN_C1 = {"angle_offset": "nothing at all: no term depends on the link angle"}


def effects(setting: Setting) -> tuple[Effect, ...]:
    """A shifted angle, or its torque alone, which a link with lateral imbalance has as well; case C2 only.

    None if the rig leaves the zero angle to be identified: the fit then includes it already.
    """
    if setting.case == "C1" or "theta_zero_rad" in setting.left_open:
        return ()
    shifted = Effect(
        family="angle_offset",
        balance="mechanical",
        formula="theta_l + offset for theta_l",
        reference=REFERENCE,
        change=Change(
            definitions=(Definition(theta_true, theta_m + offset.symbol / v.mu.symbol),),
            replaces={theta_m: theta_true.symbol},
        ),
        evidence=Evidence(depends_on=("link_angle",)),
        shapes=(Shape(offset, -0.7, 0.7, "linear", 6),),
        words=replace(WORDS, headline="an offset of the link angle"),
    )
    alone = addition(
        "angle_offset",
        [(torque, harmonic(v.mu.symbol)[0])],
        variant="torque",
        kind="conservative",
        depends_on=("link_angle",),
        formula="T cos(theta_l)",
        reference=REFERENCE,
        inputs=(v.theta_m,),
        words=replace(WORDS, headline="a gravity torque where the link angle is zero"),
    )
    return shifted, alone
