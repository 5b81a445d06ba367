"""What repeats over a turn of the motor or the link: friction, cogging, torque ripple, a tight spot."""

from __future__ import annotations

import math
from collections.abc import Iterator

import sympy as sp

from eccentric.effects.effect import GRAVITY, Effect, Plausible, PossibleCause, Setting, Shape, Words
from eccentric.effects.forms import (
    addition,
    direction,
    harmonic,
    mu,
    nonnegative,
    of_flux,
    part_of_dry,
    positive,
    theta_m,
)
from eccentric.effects.loads import ROLLING
from eccentric.model import ANGLE, GEARS, IRON, MAGNETS, MOTOR_ANGLE, HalfSine, Quantity, Role, quantity
from eccentric.model import vocabulary as v

LINK_ORDERS, MOTOR_ORDERS = range(1, 13), range(1, 25)
JAHNS = "T. M. Jahns and W. L. Soong, IEEE Trans. Industrial Electronics 43(2), 1996"


def how_often(n: int) -> str:
    """A number of times, in words."""
    return {1: "once", 2: "twice"}.get(n, f"{n} times")


def _parts(name: str, n: int, unit: str, what: str, angle: str) -> tuple[Quantity, Quantity]:
    """The coefficients of cosine and sine of one order."""
    return (
        quantity(f"{name}_c{n}", unit, f"{what} with cos({angle})", letter=f"c_{n}"),
        quantity(f"{name}_s{n}", unit, f"{what} with sin({angle})", letter=f"s_{n}"),
    )


def _size(C: Quantity, S: Quantity) -> sp.Expr:
    return sp.sqrt(C.symbol**2 + S.symbol**2)


VARIES = "the part of the dry friction that varies"
DETENT = "myelectrical2015.com, Stepper Motor Terminology, 2019: 5 to 10 % of the holding torque"


def link_harmonic_friction(setting: Setting) -> Iterator[Effect]:
    """One effect for each order n; every 1/mu turns of the motor are one of the link."""
    words = Words(
        title="Friction that varies over a turn of the link",
        meaning="Friction that varies with the link angle: an eccentric wheel, a bent shaft, a distorted"
        " bearing.",
        hint="slow full turns of the link in both directions: friction changes sign with the direction",
        kin=GRAVITY,
    )
    for n in LINK_ORDERS:
        of_motor = round(n * setting.mu)
        same = of_motor > 0 and abs(n * setting.mu - of_motor) < 1e-3 * n * setting.mu
        alias = same and setting.base.axis.wraps
        cosine, sine = harmonic(n * mu)
        C, S = _parts("link_harmonic", n, "N m", "friction torque", f"{n} theta_l")
        yield addition(
            "link_harmonic_friction",
            [(C, cosine * direction), (S, sine * direction)],
            variant=f"n={n}",
            role=Role.COULOMB,
            depends_on=("link_angle",),
            formula=f"(c cos({n} theta_l) + s sin({n} theta_l)) sgn w",
            reference="M. R. Popovic and A. A. Goldenberg, IEEE Trans. Robotics and Automation 14(1), 1998",
            inputs=(v.theta_m,),
            aliases=(f"motor_harmonic_friction[n={of_motor}]",) if alias else (),
            repeats=True,
            per_turn=n * mu,
            one_of=len(LINK_ORDERS),
            # Dry friction has no other sign where the harmonic takes away more than there is.
            second_order=("bearing_load", "local_defect"),
            plausible=part_of_dry(setting, _size(C, S), VARIES),
            words=words,
            headline=f"friction that varies {how_often(n)} per turn of the link",
        )


def motor_harmonic_friction(setting: Setting) -> Iterator[Effect]:
    """One effect for each order n and line, but those that are an order of the link, n/mu, already."""
    words = Words(
        title="Friction that varies over a turn of the motor",
        meaning="Friction that varies with the motor angle.",
        causes=(
            PossibleCause("a bearing or seal of the motor"),
            PossibleCause("the teeth of its pinion", {"gear": ("planetary", "worm", "spur")}),
            PossibleCause("the two lobes of a wave generator", {"gear": ("strain wave",)}),
        ),
        hint="slow turns of the motor in both directions: friction changes sign with the direction",
        tell_apart={
            "cogging": "Turn the motor slowly in both directions: cogging keeps its sign.",
            "kt_ripple": "Turn the motor slowly at low and at high current: the ripple grows with the"
            " current.",
        },
    )
    for n in (*MOTOR_ORDERS, *setting.lines):
        # A gear ratio is given to four digits or better; a log of a hundred turns resolves a hundredth.
        if any(abs(n / setting.mu - own) < 1e-3 * own for own in LINK_ORDERS):
            continue
        cosine, sine = harmonic(n)
        C, S = _parts("motor_harmonic", n, "N m", "friction torque", f"{n} theta_m")
        yield addition(
            "motor_harmonic_friction",
            [(C, cosine * direction), (S, sine * direction)],
            variant=f"n={n}",
            role=Role.COULOMB,
            depends_on=("motor_angle",),
            formula=f"(c cos({n} theta_m) + s sin({n} theta_m)) sgn w",
            reference="P. S. Gandhi, F. H. Ghorbel and J. Dabney, IEEE CDC 2002 (strain-wave gears); standard"
            " form, as over the link angle",
            inputs=(v.theta_m,),
            repeats=True,
            one_of=max(n, len(MOTOR_ORDERS)),
            only_with={ANGLE: MOTOR_ANGLE},
            plausible=part_of_dry(setting, _size(C, S), VARIES),
            per_turn=n,
            words=words,
            headline=f"friction that varies {how_often(n)} per turn of the motor",
        )


LOWEST, HIGHEST = 0.5, 8.0
"""Orders per turn of the motor: the inner race passes its cage some 0.6 times, and a dozen balls 7 times."""
APART = 0.25
"""Cycles over the log by which it has to slip against every harmonic of motor and link to be none: a fit of
the nearest then leaves 0.44 of it."""


def nonsynchronous_friction(setting: Setting) -> Iterator[Effect]:
    """Balls and cage of a rolling bearing: at the strongest order of the log that is no harmonic.

    The order is a shape within half a cycle over the log of that one: further away, another peak is meant,
    or a harmonic.
    """
    harmonics = [*map(float, MOTOR_ORDERS), *(n * setting.mu for n in LINK_ORDERS)]

    def apart(nu: float) -> bool:
        return LOWEST <= nu <= HIGHEST and all(abs(nu - own) > APART / setting.turns for own in harmonics)

    peak = next(filter(apart, setting.orders), None)
    if peak is None:
        return
    order = positive("nonsync_order", "1", "periods per turn of the motor", "nu")
    C = quantity("nonsync_c", "N m", "friction torque with cos(nu theta_m)", letter="c_nu")
    S = quantity("nonsync_s", "N m", "friction torque with sin(nu theta_m)", letter="s_nu")
    cosine, sine = harmonic(order.symbol)
    half, least = 0.5 / setting.turns, APART / setting.turns
    low = max([peak - half, *(own + least for own in harmonics if own < peak)])
    high = min([peak + half, *(own - least for own in harmonics if own > peak)])
    drift = "Turn the motor over many more turns, slowly: the two orders drift apart."
    yield addition(
        "nonsynchronous_friction",
        [(C, cosine * direction), (S, sine * direction)],
        role=Role.COULOMB,
        depends_on=("motor_angle",),
        formula="(c cos(nu theta_m) + s sin(nu theta_m)) sgn w, nu not an integer",
        reference="N. Tandon and A. Choudhury, Tribology International 32(8), 1999 (orders of a bearing);"
        " standard form, as over the link angle",
        shapes=(Shape(order, low, high, "linear", 5),),
        # It lies between two harmonics: there are as many such places.
        one_of=len(MOTOR_ORDERS),
        plausible=part_of_dry(setting, _size(C, S), VARIES),
        per_turn=order.symbol,
        inputs=(v.theta_m,),
        words=Words(
            headline="friction that repeats at a non-integer order of the motor",
            meaning=(
                "Friction that repeats, but not with the turn of the motor: a damaged ball, race or cage of"
                " its bearing, or of one inside the gear, as long as that rolls without slip."
            ),
            hint="long slow turns of the motor in one direction, and the orders of its bearings from their"
            " geometry",
            tell_apart={"link_harmonic_friction": drift, "motor_harmonic_friction": drift},
        ),
    )


def cogging(setting: Setting) -> Iterator[Effect]:
    """One effect for each order n of the motor angle, and each line; of a carriage, of that of its screw."""
    words = Words(
        title="Cogging",
        meaning="Cogging: magnets attract the teeth; the torque needs no current and dissipates no energy"
        " over a turn.",
        hint="slow turns of the motor in both directions, at low and at high current: cogging stays the same",
        tell_apart={
            "gravity": "Turn the motor slowly with the link removed."
            if setting.has_link
            else "Turn the motor slowly with its axis vertical: cogging stays."
        },
    )
    turns = setting.base.axis.wraps
    for n in (*MOTOR_ORDERS, *setting.lines):
        rate = n if turns else n * mu
        cosine, sine = harmonic(rate)
        angle = f"{n} theta_{'m' if turns else 'l'}"
        C, S = _parts("cogging", n, "N m", "cogging torque", angle)
        # A rig does not declare the rated torque. That of the largest current of a log is seldom above it.
        detent = Plausible(
            100 * _size(C, S) / (v.k_i.symbol * setting.current_max),
            "%",
            0.0,
            math.inf,
            f"none but of steppers: {DETENT}",
            "the cogging as part of the torque at the largest current",
            above="more than a stepper's detent torque, or a log that uses little of the motor's torque",
            by_part={"stepper": (0.0, 10.0, DETENT)},
        )
        yield addition(
            "cogging",
            [(C, cosine), (S, sine)],
            variant=f"n={n}",
            kind="conservative",
            depends_on=("motor_angle" if turns else "link_angle",),
            formula=f"c cos({angle}) + s sin({angle})",
            reference=JAHNS,
            inputs=(v.theta_m,),
            repeats=True,
            one_of=max(n, len(MOTOR_ORDERS)),
            only_with={"motor": IRON, ANGLE: MOTOR_ANGLE},
            plausible=(detent,),
            per_turn=rate,
            words=words,
            headline=f"cogging that repeats {how_often(n)} per turn of the motor",
        )


def kt_ripple(setting: Setting) -> Iterator[Effect]:
    """One effect for each order n of the motor angle, and for the lines that stand out."""
    words = Words(
        title="Ripple of the torque constant",
        meaning="Torque ripple: the torque constant varies over a turn of the motor, so the ripple grows with"
        " the current; the back-EMF varies with it.",
        hint="slow turns of the motor at low and high current: ripple grows with the current, cogging does"
        " not",
    )
    for n in (*MOTOR_ORDERS, *setting.lines):
        cosine, sine = harmonic(n)
        C, S = _parts("kt_ripple", n, "1", "relative ripple of the torque constant", f"{n} theta_m")
        # A sine commutated in six steps falls to cos 30 deg between them: the most of a sound motor.
        size = Plausible(
            100 * _size(C, S),
            "%",
            0.0,
            50.0 * (1.0 - math.cos(math.pi / 6.0)),
            "half of 1 - cos 30 deg, six-step commutation; T. M. Jahns and W. L. Soong, 1996",
            "the ripple of the torque constant",
            above="a commutation error, or cogging that the current compensates",
        )
        yield of_flux(
            "kt_ripple",
            [(C, cosine), (S, sine)],
            setting,
            variant=f"n={n}",
            depends_on=("motor_angle", "current"),
            formula=f"k_i and k_e times 1 + c cos({n} theta_m) + s sin({n} theta_m)",
            reference=JAHNS,
            inputs=(v.theta_m,),
            repeats=True,
            only_with={"motor": MAGNETS, ANGLE: MOTOR_ANGLE},
            plausible=(size,),
            one_of=max(n, len(MOTOR_ORDERS)),
            per_turn=n,
            words=words,
            headline=f"a torque constant that ripples {how_often(n)} per turn of the motor",
        )


def local_defect(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family, a von Mises bump; cos x - 1 is written as -2 sin^2(x/2).

    It has been passed once the link has moved by four widths: a joint need not turn round for that, and no
    wider one is searched.
    """
    widest = min(0.5, 0.49 * math.pi * abs(setting.mu) * setting.turns or 0.5)
    unit = setting.link_radian
    A = nonnegative("defect_A", "N m", "friction torque of the tight spot", "A")
    angle = quantity("defect_angle", unit, "link angle at the tight spot", letter="theta_0")
    width = positive("defect_width", unit, "its width as a standard deviation, link side", "sigma")
    half = HalfSine(theta_m - angle.symbol / mu, mu)
    yield addition(
        "local_defect",
        [(A, sp.exp(-2 * (half / width.symbol) ** 2) * direction)],
        role=Role.COULOMB,
        depends_on=("link_angle",),
        formula="A exp((cos(theta_l - theta_0) - 1)/sigma^2) sgn w",
        reference="N. Tandon and A. Choudhury, Tribology International 32(8), 1999; bump: R. von"
        " Mises, Physikalische Zeitschrift 19, 1918",
        shapes=(Shape(angle, -3.2, 3.2, "linear", 38), Shape(width, 0.06, max(widest, 0.07), "log", 4)),
        inputs=(v.theta_m,),
        per_turn=sp.pi * mu / (2 * width.symbol),
        words=Words(
            headline="a tight spot at one angle of the link",
            meaning="A tight spot at one link angle.",
            causes=(
                PossibleCause("a dent in the race of a bearing", {"bearing": ROLLING}),
                PossibleCause("a rubbing seal"),
                PossibleCause("dirt between teeth", {"gear": GEARS}),
            ),
            hint="slow full turns of the link in both directions, with friction plotted over the link angle",
        ),
    )
