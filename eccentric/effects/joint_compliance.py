"""A joint that gives way under its load."""

from __future__ import annotations

from eccentric.effects.effect import LOAD, Effect, Evidence, Setting, Shape, Words
from eccentric.effects.forms import alpha_m, gravity, of_an_arm, omega_m, over_angle, transmitted
from eccentric.model import Change, Definition, Gated, Term, quantity
from eccentric.model import vocabulary as v

compliance = quantity(
    "compliance", "rad/(N m)", "twist of the joint per torque on the link", "", "nonnegative", letter="kappa"
)
share = quantity(
    "compliance_share", "1", "link's share of the friction without F_N", "", "nonnegative", letter="s"
)
load = quantity("compliance_torque", "N m", "torque that the joint transmits, motor side", letter="T")
slope = quantity("compliance_slope", "N m/rad", "slope of the gravity torque over theta_m", letter="K")
bend = quantity("compliance_bend", "N m/rad^2", "slope of that slope", letter="K^'")
REFERENCE = (
    "M. W. Spong, J. Dynamic Systems, Measurement, and Control 109(4), 1987,"
    " its spring, to first order in the compliance and below the resonance"
)
WORDS = Words(
    headline="a joint that twists under its load",
    title="Compliance of the joint",
    meaning=(
        "The joint is elastic (strain-wave gear, belt, shaft): the link lags the motor by the twist, so"
        " that gravity acts at another angle, without loss."
    ),
    hint="an encoder on the link: its angle less mu times that of the motor, with and without the load",
    kin=LOAD,
    tell_apart={
        "kinematic_error": "Repeat slow turns with another mass: the twist grows with its square.",
        "cogging": "Turn the motor slowly with the link removed: cogging stays.",
        "encoder_eccentricity": "Log current and voltage: a misread angle shows in both, the twist in one.",
        "gravity": "Repeat slow turns with another mass: the twist grows with its square.",
        "link_harmonic_friction": "Turn slowly in both directions: only friction changes its sign.",
    },
)
IN_C1 = {"joint_compliance": "nothing at all: without gravity it shows in jerk and snap of the motor alone"}


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family, for a declared inertia; case C2 only.

    A spring turns the link by theta_l = mu theta_m - kappa T/mu, where T is the transmitted torque on the
    motor side. To first order in kappa the link's torque on the motor changes by

        -kappa (T G'/mu^2 + J_l d^2 T/dt^2), with d^2 T/dt^2 = G' alpha_m + G'' omega_m^2 + ...

    G' is the slope of the gravity torque over theta_m. Left out is what needs jerk and snap of the motor: it
    is to the inertial torque as the square of the frequency to that of the resonance, and all that there is
    without gravity. Left out as well are the slopes of friction.
    """
    pull = gravity(setting)
    if pull == 0 or "inertia" in setting.left_open or of_an_arm(setting):
        return ()
    torque, constants = transmitted("compliance", setting, share.symbol)
    first = over_angle(pull)
    term = Term(
        "compliance",
        "actuator",
        compliance.symbol,
        -load.symbol * slope.symbol / v.mu.symbol**2
        - Gated(v.J_l.symbol, slope.symbol * alpha_m + bend.symbol * omega_m**2),
        REFERENCE,
        (0.0, None),
    )
    effect = Effect(
        family="joint_compliance",
        balance="mechanical",
        formula="theta_l = mu theta_m - kappa T/mu, in gravity and inertia of the link",
        reference=REFERENCE,
        change=Change(
            {"mechanical": (term,)},
            (
                *constants,
                Definition(load, torque),
                Definition(slope, first),
                Definition(bend, over_angle(first)),
            ),
            inputs=(v.theta_m,),
        ),
        evidence=Evidence(depends_on=("link_angle", "gravity_load", "transmitted_torque")),
        coefficients=(compliance,),
        shapes=(Shape(share, 0.0, 1.0, "linear", 3),),
        words=WORDS,
    )
    return (effect,)
