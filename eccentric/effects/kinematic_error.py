"""Angles that are not what they seem: a gear that errs over a turn, an eccentric encoder, a soft joint."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import sympy as sp

from eccentric.effects.effect import LOAD, Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import (
    F_N,
    addition,
    alpha_m,
    earlier_fit,
    gravity,
    harmonic,
    mu,
    nonnegative,
    of_an_arm,
    omega_m,
    theta_m,
    transmitted,
)
from eccentric.effects.harmonics import how_often
from eccentric.model import GEARS, Across, Along, Definition, Gated, HalfCosine, HalfSine, quantity
from eccentric.model import vocabulary as v

# A strain-wave gear errs twice per turn of its wave generator, and once where that is off its centre; an
# output wheel off its centre errs once per turn of the link, and an oval one twice.
MOTOR_ORDERS, LINK_ORDERS = (1, 2), (1, 2)
ACCURACY = "Harmonic Drive LLC, CSF-CSG catalogue, undated: positioning accuracy of 0.5 to 2 arcmin, span"
ONLY_FRICTION = "Turn slowly in both directions: only friction changes sign."

IN_C1 = {"joint_compliance": "nothing at all: without gravity it shows in jerk and snap of the motor alone"}


def kinematic_error(setting: Setting) -> Iterator[Effect]:
    """The error of a gear over a turn of the motor or of the link, for a declared inertia.

    The link turns by theta_l = mu theta_m + e(theta_m). By virtual work the gear asks of the motor
    (mu + e') times the link's torque, and the link accelerates by (mu + e') alpha + e'' w^2. To first order
    in e the balance gains (e' T + e dT/dtheta + e' w dT/dw)/mu + mu J_l (e' alpha + e'' w^2), where T is the
    transmitted torque. The friction in it is taken from an earlier fit, see `transmitted`.
    """
    if "inertia" in setting.left_open or of_an_arm(setting):
        return
    cosine_gear = quantity(
        "kinematic_cos", "1", "cosine of the angle that the error repeats over", letter="c_k"
    )
    sine_gear = quantity("kinematic_sin", "1", "sine of the angle that the error repeats over", letter="s_k")
    cosine_part = quantity(
        "kinematic_c", "rad", "link angle beyond mu theta_m, by the cosine", letter="epsilon_1"
    )
    sine_part = quantity(
        "kinematic_s", "rad", "link angle beyond mu theta_m, by the sine", letter="epsilon_2"
    )
    share = nonnegative("kinematic_share", "1", "link's share of the dry friction without F_N", "s")
    # Dry friction of the link reaches the motor times mu, viscous friction times mu^2.
    viscous_share = nonnegative(
        "kinematic_share_B", "1", "link's share of the viscous friction without F_N", "s_B"
    )
    load = quantity("kinematic_torque", "N m", "torque that the gear transmits, motor side", letter="T")
    load_off = "the link removed" if setting.has_link else "the gear uncoupled"
    words = Words(
        title="Kinematic error of the gear",
        meaning=(
            "The gear does not transmit the angle evenly: teeth or wave generator off their centre, or out of"
            " round. Ratio, transmitted torque and acceleration of the link vary over a turn, without loss."
        ),
        hint="an encoder on the link: its angle less mu times that of the motor, over whole turns",
        kin=LOAD,
        tell_apart={
            "cogging": f"Turn the motor slowly with {load_off}: cogging stays.",
            "encoder_eccentricity": "Log current and voltage: a misread angle shows in both, the gear in"
            " one.",
            "kt_ripple": "Log current and voltage: a ripple shows in both, an error of the gear in one.",
            "link_harmonic_friction": ONLY_FRICTION,
            "motor_harmonic_friction": f"Turn slowly with {load_off}: friction of the motor stays.",
        },
    )
    orders: list[tuple[str, str, int, sp.Expr]] = [
        ("motor", "theta_m", n, sp.Integer(n)) for n in MOTOR_ORDERS
    ]
    for n in LINK_ORDERS:
        same = any(abs(n * setting.mu - m) < 1e-3 * m for m in MOTOR_ORDERS)
        orders += [] if same else [("link", "theta_l", n, n * mu)]
    # One order of an error has at most 4/pi of half of its span.
    accurate = Plausible(
        10800 / sp.pi * sp.sqrt(cosine_part.symbol**2 + sine_part.symbol**2),
        "arcmin",
        0.0,
        math.inf,
        f"none but of strain-wave gears: {ACCURACY}",
        "the error of the gear at the link",
        above="more than such a gear's: an eccentric or oblique mounting",
        by_part={"strain wave": (0.0, 4.0 / math.pi, ACCURACY)},
    )
    torque, constants = transmitted("kinematic", setting, share.symbol, viscous_share.symbol)
    by_speed, by_angle, sloping = _slopes("kinematic", torque, setting)
    for where, letter, n, rate in orders:
        gear = [Definition(q, x) for q, x in zip((cosine_gear, sine_gear), harmonic(rate), strict=True)]
        cosine, sine = cosine_gear.symbol, sine_gear.symbol
        # By unit error: e, and its first two derivatives by the motor angle.
        columns = [
            (
                q,
                first / mu * (load.symbol + by_speed)
                + e / mu * by_angle
                + Gated(v.J_l.symbol, mu * (first * alpha_m + second * omega_m**2)),
            )
            for q, e, first, second in (
                (cosine_part, cosine, -rate * sine, -(rate**2) * cosine),
                (sine_part, sine, rate * cosine, -(rate**2) * sine),
            )
        ]
        times = "" if n == 1 else f"{n} "
        yield addition(
            "kinematic_error",
            columns,
            variant=f"{where},n={n}",
            kind="actuator",
            depends_on=(f"{where}_angle", "transmitted_torque", "acceleration"),
            formula=f"theta_l = mu theta_m + e, e = c cos({times}{letter}) + s sin({times}{letter}),"
            " in torque, speed and acceleration of the link",
            reference="T. D. Tuttle and W. P. Seering, IEEE Trans. Robotics and Automation 12(3), 1996;"
            " F. H. Ghorbel, P. S. Gandhi and F. Alpeter, J. Mechanical Design 123(1), 2001",
            definitions=(*constants, Definition(load, torque), *sloping, *gear),
            inputs=(v.theta_m,),
            shapes=tuple(Shape(one, 0.0, 1.0, "linear", 3) for one in (share, viscous_share)),
            only_with={"gear": GEARS},
            plausible=(accurate,) if setting.base.axis.wraps else (),
            per_turn=rate,
            words=words,
            headline=f"a gear whose ratio varies {how_often(n)} per turn of the {where}",
        )


def encoder_eccentricity(setting: Setting) -> Iterator[Effect]:
    """The encoder on the motor or on the link, which is the same at mu = 1; for a declared inertia.

    To first order in the error d(theta) of the motor angle, inertia, gravity, friction and back-EMF act on
    d and on its rates d' = d_theta w and d'' = d_theta alpha + d_thetatheta w^2: the mechanical balance has
    J d'' + df/dw d' + d(G + f)/dtheta d, the electrical one k_e d'. The friction f is taken from an earlier
    fit: with the model's own coefficients the balance would no longer be linear.
    """
    if "inertia" in setting.left_open:
        return
    cosine_read = quantity("eccentric_cos", "1", "cosine of the angle that the encoder reads", letter="c_e")
    sine_read = quantity("eccentric_sin", "1", "sine of the angle that the encoder reads", letter="s_e")
    cosine_part = quantity("eccentric_c", "rad", "true angle minus the one read, by its cosine", letter="e_1")
    sine_part = quantity("eccentric_s", "rad", "true angle minus the one read, by its sine", letter="e_2")
    known = Plausible(
        180 / sp.pi * sp.sqrt(cosine_part.symbol**2 + sine_part.symbol**2),
        "deg",
        0.0,
        1.41,
        "ams, AS5050 data sheet 1.12, undated: magnet off by 0.5 mm, over temperature",
        "the error of the encoder",
        above="not an eccentric scale alone",
    )
    words = Words(
        title="Encoder eccentricity",
        meaning=(
            "The scale of the encoder is not centred on its shaft: the angle has an error that repeats once"
            " per turn, the velocity one that grows with the speed, the acceleration one that grows with its"
            " square. It adds no term to the friction torque: correct what is read, or centre the scale."
        ),
        hint="constant speeds over a wide range: the error grows with the square of the speed",
        tell_apart={
            "cogging": "Turn at constant speeds over a wide range: cogging stays the same.",
            "kt_ripple": "Drive the motor externally with its terminals open: voltage over speed shows both,"
            " and next to a second encoder only the ripple.",
            "link_harmonic_friction": ONLY_FRICTION,
            "motor_harmonic_friction": ONLY_FRICTION,
        },
    )
    fitted = earlier_fit("eccentric", setting)
    friction = sp.Add(*(constant.symbol * column.basis for column, constant in fitted))
    by_speed, by_angle, sloping = _slopes("eccentric", gravity(setting) + friction, setting)
    cosine, sine = cosine_read.symbol, sine_read.symbol
    for where, letter, rate in (("motor", "theta_m", sp.Integer(1)), ("link", "theta_l", mu)):
        if where == "link" and abs(setting.mu - 1.0) < 1e-3:
            return
        read = [Definition(q, x) for q, x in zip((cosine_read, sine_read), harmonic(rate), strict=True)]
        # By unit error of the encoder: the motor angle, and its first two derivatives by itself.
        parts = (
            (cosine_part, cosine / rate, -sine, -rate * cosine),
            (sine_part, sine / rate, cosine, -rate * sine),
        )
        yield addition(
            "encoder_eccentricity",
            [
                (
                    q,
                    Gated(v.J.symbol, slope * alpha_m + bend * omega_m**2)
                    + by_speed * slope
                    + by_angle * error,
                )
                for q, error, slope, bend in parts
            ],
            circuit=[v.k_e.symbol * slope * omega_m for _, _, slope, _ in parts],
            variant=where,
            kind="actuator",
            depends_on=(f"{where}_angle", "velocity", "acceleration"),
            formula=f"{letter} + c cos({letter}) + s sin({letter}) for {letter},"
            " and its derivatives likewise",
            reference="X.-D. Lu, R. Graetz, D. Amin-Shahidi and K. Smeds, CIRP Annals 59(1), 2010",
            definitions=(*(constant for _, constant in fitted), *sloping, *read),
            inputs=(v.theta_m,),
            # An error by the true angle has, by the one that is read, half of its square twice per turn.
            second_order=(
                "kinematic_error",
                "cogging",
                "kt_ripple",
                "motor_harmonic_friction",
                "link_harmonic_friction",
            ),
            plausible=(known,),
            per_turn=rate,
            words=words,
            headline=f"an encoder whose error repeats once per turn of the {where}",
        )


def joint_compliance(setting: Setting) -> Iterator[Effect]:
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
        return
    compliance = nonnegative("compliance", "rad/(N m)", "twist of the joint per torque on the link", "kappa")
    share = nonnegative("compliance_share", "1", "link's share of the friction without F_N", "s")
    load = quantity("compliance_torque", "N m", "torque that the joint transmits, motor side", letter="T")
    slope = quantity("compliance_slope", "N m/rad", "slope of the gravity torque over theta_m", letter="K")
    bend = quantity("compliance_bend", "N m/rad^2", "slope of that slope", letter="K^'")
    torque, constants = transmitted("compliance", setting, share.symbol)
    first = _over_angle(pull)
    lag = -load.symbol * slope.symbol / mu**2
    yield addition(
        "joint_compliance",
        [(compliance, lag - Gated(v.J_l.symbol, slope.symbol * alpha_m + bend.symbol * omega_m**2))],
        kind="actuator",
        depends_on=("link_angle", "gravity_load", "transmitted_torque"),
        formula="theta_l = mu theta_m - kappa T/mu, in gravity and inertia of the link",
        reference="M. W. Spong, J. Dynamic Systems, Measurement, and Control 109(4), 1987,"
        " its spring, to first order in the compliance and below the resonance",
        definitions=(
            *constants,
            Definition(load, torque),
            Definition(slope, first),
            Definition(bend, _over_angle(first)),
        ),
        inputs=(v.theta_m,),
        shapes=(Shape(share, 0.0, 1.0, "linear", 3),),
        words=Words(
            headline="a joint that twists under its load",
            title="Compliance of the joint",
            meaning=(
                "The joint is elastic (strain-wave gear, belt, shaft): the link lags the motor by the twist,"
                " so that gravity acts at another angle, without loss."
            ),
            hint="an encoder on the link: its angle less mu times that of the motor, with and without the"
            " load",
            kin=LOAD,
            tell_apart={
                "kinematic_error": "Repeat slow turns with another mass: the twist grows with its square.",
                "cogging": "Turn the motor slowly with the link removed: cogging stays.",
                "encoder_eccentricity": "Log current and voltage: a misread angle shows in both, the twist in"
                " one.",
                "gravity": "Repeat slow turns with another mass: the twist grows with its square.",
                "link_harmonic_friction": ONLY_FRICTION,
            },
        ),
    )


class _Slopes(NamedTuple):
    """Velocity times the slope over it [N m], the slope over the motor angle [N m/rad], and what both use."""

    by_speed: sp.Symbol
    by_angle: sp.Symbol
    definitions: tuple[Definition, ...]


def _slopes(name: str, torque: sp.Expr, setting: Setting) -> _Slopes:
    """The slopes of a torque in F_N and the motion of the motor; names begin with `name`.

    The normal force is the length of a vector: the pull of the mass and the weight along the link, and the
    weight across it. Its slopes are components along that vector, and 0 where it has no length.
    """
    pull = nonnegative(f"{name}_pull", "N", "centrifugal force of the mass", "F_c")
    speed = quantity(f"{name}_by_speed", "N m", "velocity times a torque's slope over it", letter="D")
    angle = quantity(f"{name}_by_angle", "N m/rad", "its slope over the motor angle", letter="K")
    # Without definitions that follow from the normal force, such as another load of a bearing.
    for definition in reversed(setting.base.definitions):
        if definition.symbol == F_N:
            break
        torque = torque.xreplace({definition.symbol: definition.value})
    by_force = sp.diff(torque, F_N) * pull.symbol
    by_angle = _over_angle(torque)
    by_speed = omega_m * sp.diff(torque, omega_m)
    pulled: tuple[Definition, ...] = ()
    if by_force != 0:
        pulled = (Definition(pull, v.M.symbol * v.L.symbol * (mu * omega_m) ** 2),)
        along, across = _direction(pull.symbol, setting)
        by_speed += 2 * along * by_force
        by_angle -= mu * across * by_force
    return _Slopes(
        speed.symbol, angle.symbol, (*pulled, Definition(speed, by_speed), Definition(angle, by_angle))
    )


def _over_angle(torque: sp.Expr) -> sp.Expr:
    """The slope of a torque over the motor angle; by half angles, cos^2 - sin^2 is 2 cos^2 - 1."""
    return sp.diff(torque, theta_m).replace(
        lambda e: e.is_Pow and isinstance(e.base, HalfSine) and e.exp == 2,
        lambda e: 1 - HalfCosine(*e.base.args) ** 2,
    )


def _direction(pull: sp.Symbol, setting: Setting) -> tuple[sp.Expr, sp.Expr]:
    """Components of the normal force along the link and across it, over its length."""
    if setting.case == "C1":
        return sp.Integer(1), sp.Integer(0)
    cosine, sine = harmonic(mu)
    inside = sp.cos(v.phi.symbol) if setting.base.tilted else 1
    weight = (v.M.symbol + v.M_l.symbol) * v.g.symbol * inside
    ends = pull + weight * cosine, weight * sine
    return Along(*ends), Across(*ends)
