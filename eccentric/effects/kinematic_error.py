"""A gear whose ratio varies over a turn: its transmission error."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import LOAD, Effect, Evidence, Setting, Shape, Words, how_often
from eccentric.effects.forms import alpha_m, harmonic, of_an_arm, omega_m, slopes, transmitted
from eccentric.model import GEARS, Change, Definition, Gated, Term, quantity
from eccentric.model import vocabulary as v

# A strain-wave gear errs twice per turn of its wave generator, and once where that is off its centre; an
# output wheel off its centre errs once per turn of the link, and an oval one twice.
MOTOR_ORDERS, LINK_ORDERS = (1, 2), (1, 2)
cosine_gear = quantity("kinematic_cos", "1", "cosine of the angle that the error repeats over", letter="c_k")
sine_gear = quantity("kinematic_sin", "1", "sine of the angle that the error repeats over", letter="s_k")
cosine_part = quantity(
    "kinematic_c", "rad", "link angle beyond mu theta_m, by the cosine", letter="epsilon_1"
)
sine_part = quantity("kinematic_s", "rad", "link angle beyond mu theta_m, by the sine", letter="epsilon_2")
share = quantity(
    "kinematic_share", "1", "link's share of the dry friction without F_N", "", "nonnegative", letter="s"
)
# Dry friction of the link reaches the motor times mu, viscous friction times mu^2.
viscous_share = quantity(
    "kinematic_share_B",
    "1",
    "link's share of the viscous friction without F_N",
    "",
    "nonnegative",
    letter="s_B",
)
load = quantity("kinematic_torque", "N m", "torque that the gear transmits, motor side", letter="T")
REFERENCE = (
    "T. D. Tuttle and W. P. Seering, IEEE Trans. Robotics and Automation 12(3), 1996;"
    " F. H. Ghorbel, P. S. Gandhi and F. Alpeter, J. Mechanical Design 123(1), 2001"
)
WORDS = Words(
    title="Kinematic error of the gear",
    meaning=(
        "The gear does not transmit the angle evenly: teeth or wave generator off their centre, or out of"
        " round. Ratio, transmitted torque and acceleration of the link vary over a turn, without loss."
    ),
    hint="an encoder on the link: its angle less mu times that of the motor, over whole turns",
    kin=LOAD,
    tell_apart={
        "cogging": "Turn the motor slowly with the link removed: cogging stays.",
        "encoder_eccentricity": "Log current and voltage: a misread angle shows in both, the gear in one.",
        "kt_ripple": "Log current and voltage: a ripple shows in both, an error of the gear in one.",
        "link_harmonic_friction": "Turn slowly in both directions: only friction changes its sign.",
        "motor_harmonic_friction": "Turn slowly with the link removed: friction of the motor stays.",
    },
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The error over a turn of the motor or of the link, for a declared inertia.

    The link turns by theta_l = mu theta_m + e(theta_m). By virtual work the gear asks of the motor
    (mu + e') times the link's torque, and the link accelerates by (mu + e') alpha + e'' w^2. To first order
    in e the balance gains (e' T + e dT/dtheta + e' w dT/dw)/mu + mu J_l (e' alpha + e'' w^2), where T is the
    transmitted torque. The friction in it is taken from an earlier fit, see `transmitted`.
    """
    if "inertia" in setting.left_open or of_an_arm(setting):
        return ()
    found = [_of("motor", n, sp.Integer(n), setting) for n in MOTOR_ORDERS]
    for n in LINK_ORDERS:
        same = any(abs(n * setting.mu - m) < 1e-3 * m for m in MOTOR_ORDERS)
        found += [] if same else [_of("link", n, n * v.mu.symbol, setting)]
    return tuple(found)


def _of(where: str, n: int, rate: sp.Expr, setting: Setting) -> Effect:
    """The effect for an error that repeats with `rate` times the motor angle."""
    torque, constants = transmitted("kinematic", setting, share.symbol, viscous_share.symbol)
    by_speed, by_angle, sloping = slopes("kinematic", torque, setting)
    gear = [Definition(q, x) for q, x in zip((cosine_gear, sine_gear), harmonic(rate), strict=True)]
    cosine, sine = cosine_gear.symbol, sine_gear.symbol
    # By unit error: e, and its first two derivatives by the motor angle.
    parts = ((cosine_part, cosine, -rate * sine, -(rate**2) * cosine),)
    parts += ((sine_part, sine, rate * cosine, -(rate**2) * sine),)
    mu = v.mu.symbol
    terms = tuple(
        Term(
            q.name,
            "actuator",
            q.symbol,
            first / mu * (load.symbol + by_speed)
            + e / mu * by_angle
            + Gated(v.J_l.symbol, mu * (first * alpha_m + second * omega_m**2)),
            REFERENCE,
            (None, None),
            per_turn=rate,
        )
        for q, e, first, second in parts
    )
    letter = {"motor": "theta_m", "link": "theta_l"}[where]
    times = "" if n == 1 else f"{n} "
    return Effect(
        family="kinematic_error",
        variant=f"{where},n={n}",
        balance="mechanical",
        formula=f"theta_l = mu theta_m + e, e = c cos({times}{letter}) + s sin({times}{letter}),"
        " in torque, speed and acceleration of the link",
        reference=REFERENCE,
        change=Change(
            {"mechanical": terms},
            (*constants, Definition(load, torque), *sloping, *gear),
            inputs=(v.theta_m,),
        ),
        evidence=Evidence(depends_on=(f"{where}_angle", "transmitted_torque", "acceleration")),
        coefficients=(cosine_part, sine_part),
        shapes=tuple(Shape(one, 0.0, 1.0, "linear", 3) for one in (share, viscous_share)),
        only_with={"gear": GEARS},
        words=replace(WORDS, headline=f"a gear whose ratio varies {how_often(n)} per turn of the {where}"),
    )
