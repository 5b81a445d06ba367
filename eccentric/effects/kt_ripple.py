"""Ripple of the torque constant over a turn of the motor."""

from __future__ import annotations

from dataclasses import replace

from eccentric.effects.effect import Effect
from eccentric.effects.forms import addition, harmonic
from eccentric.effects.setting import Setting
from eccentric.effects.words import Words, how_often
from eccentric.model import quantity
from eccentric.model import vocabulary as v

ORDERS = range(1, 25)
WORDS = Words(
    title="Ripple of the torque constant",
    meaning=(
        "Torque ripple: the torque constant varies over a turn of the motor, so the ripple grows with "
        "the current."
    ),
    hint="slow turns of the motor at low and high current: ripple grows with the current, cogging does not",
)


def effects(_: Setting) -> tuple[Effect, ...]:
    """One effect for each order n of the motor angle."""
    return tuple(_order(n) for n in ORDERS)


def _order(n: int) -> Effect:
    cosine, sine = harmonic(n)
    torque = v.k_i.symbol * v.i.symbol
    C = quantity(
        f"kt_ripple_c{n}", "1", f"relative ripple of the torque constant by cos({n} theta_m)", letter=f"c_{n}"
    )
    S = quantity(
        f"kt_ripple_s{n}", "1", f"relative ripple of the torque constant by sin({n} theta_m)", letter=f"s_{n}"
    )
    return addition(
        "kt_ripple",
        [(C, -torque * cosine), (S, -torque * sine)],
        variant=f"n={n}",
        kind="actuator",
        depends_on=("motor_angle", "current"),
        formula=f"k_t = k_i (1 + c cos({n} theta_m) + s sin({n} theta_m))",
        reference="T. M. Jahns and W. L. Soong, IEEE Trans. Industrial Electronics 43(2), 1996",
        inputs=(v.theta_m,),
        needs=("current",),
        repeats=True,
        words=replace(WORDS, headline=f"a torque constant that ripples {how_often(n)} per turn of the motor"),
    )
