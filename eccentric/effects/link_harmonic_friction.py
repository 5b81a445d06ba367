"""Friction that varies with the link angle."""

from __future__ import annotations

from dataclasses import replace

from eccentric.effects.effect import GRAVITY, Effect, Setting, Words, how_often
from eccentric.effects.forms import addition, direction, harmonic
from eccentric.model import Role, quantity
from eccentric.model import vocabulary as v

ORDERS = range(1, 13)
WORDS = Words(
    title="Friction that varies over a turn of the link",
    meaning=(
        "Friction that varies with the link angle: an eccentric wheel, a bent shaft, a distorted bearing."
    ),
    hint="slow full turns of the link in both directions: friction changes its sign with the direction",
    kin=GRAVITY,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """One effect for each order n; every 1/mu turns of the motor are one of the link."""
    return tuple(_order(n, setting.mu, setting.base.axis.wraps) for n in ORDERS)


def _order(n: int, mu: float, turns: bool) -> Effect:
    of_motor = round(n * mu)
    same = turns and of_motor > 0 and abs(n * mu - of_motor) < 1e-3 * n * mu
    cosine, sine = harmonic(n * v.mu.symbol)
    C = quantity(f"link_harmonic_c{n}", "N m", f"friction torque by cos({n} theta_l)", letter=f"c_{n}")
    S = quantity(f"link_harmonic_s{n}", "N m", f"friction torque by sin({n} theta_l)", letter=f"s_{n}")
    return addition(
        "link_harmonic_friction",
        [(C, cosine * direction), (S, sine * direction)],
        variant=f"n={n}",
        role=Role.COULOMB,
        depends_on=("link_angle",),
        formula=f"(c cos({n} theta_l) + s sin({n} theta_l)) sgn w",
        reference="M. R. Popovic and A. A. Goldenberg, IEEE Trans. Robotics and Automation 14(1), 1998",
        inputs=(v.theta_m,),
        aliases=(f"motor_harmonic_friction[n={of_motor}]",) if same else (),
        repeats=True,
        per_turn=n * v.mu.symbol,
        one_of=len(ORDERS),
        # Dry friction has no other sign where the harmonic takes away more than there is.
        second_order=("bearing_load", "local_defect"),
        words=replace(WORDS, headline=f"friction that varies {how_often(n)} per turn of the link"),
    )
