"""Ripple of the torque constant over a turn of the motor."""

from __future__ import annotations

import math
from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import Effect, Plausible, Setting, Words, how_often
from eccentric.effects.forms import harmonic, of_flux
from eccentric.model import ANGLE, MAGNETS, MOTOR_ANGLE, quantity
from eccentric.model import vocabulary as v

ORDERS = range(1, 25)
WORDS = Words(
    title="Ripple of the torque constant",
    meaning=(
        "Torque ripple: the torque constant varies over a turn of the motor, so the ripple grows with "
        "the current; the back-EMF varies with it."
    ),
    hint="slow turns of the motor at low and high current: ripple grows with the current, cogging does not",
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """One effect for each order n of the motor angle, and for the lines that stand out."""
    return tuple(_order(n, setting) for n in (*ORDERS, *setting.lines))


def _order(n: int, setting: Setting) -> Effect:
    cosine, sine = harmonic(n)
    C = quantity(
        f"kt_ripple_c{n}", "1", f"relative ripple of the torque constant by cos({n} theta_m)", letter=f"c_{n}"
    )
    S = quantity(
        f"kt_ripple_s{n}", "1", f"relative ripple of the torque constant by sin({n} theta_m)", letter=f"s_{n}"
    )
    # A sine commutated in six steps falls to cos 30 deg between them: the largest ripple of a sound motor.
    size = Plausible(
        100 * sp.sqrt(C.symbol**2 + S.symbol**2),
        "%",
        0.0,
        50.0 * (1.0 - math.cos(math.pi / 6.0)),
        "half of 1 - cos 30 deg, six-step commutation; T. M. Jahns and W. L. Soong, 1996",
        "the ripple of the torque constant",
        above="commutation that is off, or cogging that the current compensates",
    )
    return of_flux(
        "kt_ripple",
        [(C, cosine), (S, sine)],
        setting,
        variant=f"n={n}",
        depends_on=("motor_angle", "current"),
        formula=f"k_i and k_e times 1 + c cos({n} theta_m) + s sin({n} theta_m)",
        reference="T. M. Jahns and W. L. Soong, IEEE Trans. Industrial Electronics 43(2), 1996",
        inputs=(v.theta_m,),
        repeats=True,
        only_with={"motor": MAGNETS, ANGLE: MOTOR_ANGLE},
        plausible=(size,),
        one_of=max(n, len(ORDERS)),
        per_turn=n,
        words=replace(WORDS, headline=f"a torque constant that ripples {how_often(n)} per turn of the motor"),
    )
