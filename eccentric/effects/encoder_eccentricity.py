"""An encoder that reads the angle with an error that repeats once per turn."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import Effect, Evidence, Plausible, Setting, Words
from eccentric.effects.forms import alpha_m, constant, gravity, harmonic, omega_m, slopes
from eccentric.model import Change, Definition, Gated, Quantity, Term, quantity, regressor
from eccentric.model import vocabulary as v

cosine_read = quantity("eccentric_cos", "1", "cosine of the angle that the encoder reads", letter="c_e")
sine_read = quantity("eccentric_sin", "1", "sine of the angle that the encoder reads", letter="s_e")
cosine_part = quantity("eccentric_c", "rad", "true angle minus the one read, by its cosine", letter="e_1")
sine_part = quantity("eccentric_s", "rad", "true angle minus the one read, by its sine", letter="e_2")
REFERENCE = "X.-D. Lu, R. Graetz, D. Amin-Shahidi and K. Smeds, CIRP Annals 59(1), 2010"
KNOWN = Plausible(
    180 / sp.pi * sp.sqrt(cosine_part.symbol**2 + sine_part.symbol**2),
    "deg",
    0.0,
    1.41,
    "ams, AS5050 data sheet 1.12, undated: magnet off by 0.5 mm, over temperature",
    "the error of the encoder",
    above="not an eccentric scale alone",
)
SECOND_ORDER = (
    "kinematic_error",
    "cogging",
    "kt_ripple",
    "motor_harmonic_friction",
    "link_harmonic_friction",
)
"""An error by the true angle has, by the one that is read, half of its square twice per turn."""
WORDS = Words(
    title="Encoder eccentricity",
    meaning=(
        "The scale of the encoder is not centred on its shaft: the angle has an error that repeats once per"
        " turn, the velocity one that grows with the speed, the acceleration one that grows with its square."
        " The friction torque has no term of it: correct what is read, or centre the scale."
    ),
    hint="constant speeds over a wide range: the error grows with the square of the speed",
    tell_apart={
        "cogging": "Turn at constant speeds over a wide range: cogging stays the same.",
        "kt_ripple": "Drive the motor externally with its terminals open: voltage over speed shows both, and"
        " beside a second encoder only the ripple.",
        "link_harmonic_friction": "Turn slowly in both directions: only friction changes its sign.",
        "motor_harmonic_friction": "Turn slowly in both directions: only friction changes its sign.",
    },
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The encoder on the motor or on the link, which is the same at mu = 1; for a declared inertia.

    To first order in the error d(theta) of the motor angle, inertia, gravity, friction and back-EMF act on
    d and on its rates d' = d_theta w and d'' = d_theta alpha + d_thetatheta w^2: the mechanical balance has
    J d'' + df/dw d' + d(G + f)/dtheta d, the electrical one k_e d'. The friction f is taken from an earlier
    fit: with the model's own coefficients the balance would no longer be linear.
    """
    if "inertia" in setting.left_open:
        return ()
    motor = _of("motor", sp.Integer(1), "motor_angle", setting)
    if abs(setting.mu - 1.0) < 1e-3:
        return (motor,)
    return motor, _of("link", v.mu.symbol, "link_angle", setting)


def _of(where: str, rate: sp.Expr, variable: str, setting: Setting) -> Effect:
    """The effect for an encoder whose angle is `rate` times the motor angle."""
    known, friction = _friction(setting)
    by_speed, by_angle, sloping = slopes("eccentric", gravity(setting) + friction, setting)
    read = [Definition(q, x) for q, x in zip((cosine_read, sine_read), harmonic(rate), strict=True)]
    cosine, sine = cosine_read.symbol, sine_read.symbol
    # By unit error of the encoder: the motor angle, and its first two derivatives by itself.
    parts = (
        (cosine_part, cosine / rate, -sine, -rate * cosine),
        (sine_part, sine / rate, cosine, -rate * sine),
    )
    inertial = [
        _term(
            q,
            Gated(v.J.symbol, slope * alpha_m + bend * omega_m**2) + by_speed * slope + by_angle * error,
        )
        for q, error, slope, bend in parts
    ]
    circuit = [_term(q, v.k_e.symbol * slope * omega_m, "_emf") for q, _, slope, _ in parts]
    letter = {"motor": "theta_m", "link": "theta_l"}[where]
    return Effect(
        family="encoder_eccentricity",
        variant=where,
        balance="mechanical",
        formula=f"{letter} + c cos({letter}) + s sin({letter}) for {letter}, and its derivatives likewise",
        reference=REFERENCE,
        change=Change(
            {"mechanical": tuple(inertial), "electrical": tuple(circuit)},
            (*known, *sloping, *read),
            inputs=(v.theta_m,),
        ),
        evidence=Evidence(depends_on=(variable, "velocity", "acceleration"), second_order=SECOND_ORDER),
        coefficients=(cosine_part, sine_part),
        plausible=(KNOWN,),
        words=replace(WORDS, headline=f"an encoder whose error repeats once per turn of the {where}"),
    )


def _friction(setting: Setting) -> tuple[list[Definition], sp.Expr]:
    """The coefficients of an earlier fit, and the friction torque with them."""
    known: list[Definition] = []
    terms: list[sp.Expr] = []
    for column in regressor(setting.base):
        if column.name in setting.friction:
            meaning = f"{column.name} from an earlier fit"
            value, letter = setting.friction[column.name], f"{column.name}^0"
            known.append(constant(f"eccentric_{column.name}", column.unit, meaning, value, letter))
            terms.append(known[-1].symbol * column.basis)
    return known, sp.Add(*terms)


def _term(q: Quantity, basis: sp.Expr, ending: str = "") -> Term:
    return Term(q.name + ending, "actuator", q.symbol, basis, REFERENCE, (None, None))
