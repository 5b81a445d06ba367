"""Friction that varies with the motor angle."""

from __future__ import annotations

from dataclasses import replace

from eccentric.effects.effect import Effect, Setting, Words, how_often
from eccentric.effects.forms import addition, direction, harmonic
from eccentric.effects.link_harmonic_friction import ORDERS as LINK_ORDERS
from eccentric.model import ANGLE, MOTOR_ANGLE, Role, quantity
from eccentric.model import vocabulary as v

ORDERS = range(1, 25)
WORDS = Words(
    title="Friction that varies over a turn of the motor",
    meaning=(
        "Friction that varies with the motor angle: a bearing or seal of the motor, the teeth of its pinion,"
        " the two lobes of the wave generator of a strain-wave gear."
    ),
    hint="slow turns of the motor in both directions: friction changes its sign with the direction",
    tell_apart={
        "cogging": "Turn the motor slowly in both directions: cogging keeps its sign.",
        "kt_ripple": "Turn the motor slowly at low and at high current: the ripple grows with the current.",
    },
)
REFERENCE = (
    "P. S. Gandhi, F. H. Ghorbel and J. Dabney, IEEE CDC 2002 (strain-wave gears); standard form, as over the"
    " link angle"
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """One effect for each order n and line, but those that are an order of the link, n/mu, already."""
    return tuple(_order(n) for n in (*ORDERS, *setting.lines) if not _of_the_link(n / setting.mu))


def _of_the_link(order: float) -> bool:
    # A gear ratio is given to four digits or better; a log of a hundred turns resolves a hundredth.
    return any(abs(order - own) < 1e-3 * own for own in LINK_ORDERS)


def _order(n: int) -> Effect:
    cosine, sine = harmonic(n)
    C = quantity(f"motor_harmonic_c{n}", "N m", f"friction torque by cos({n} theta_m)", letter=f"c_{n}")
    S = quantity(f"motor_harmonic_s{n}", "N m", f"friction torque by sin({n} theta_m)", letter=f"s_{n}")
    return addition(
        "motor_harmonic_friction",
        [(C, cosine * direction), (S, sine * direction)],
        variant=f"n={n}",
        role=Role.COULOMB,
        depends_on=("motor_angle",),
        formula=f"(c cos({n} theta_m) + s sin({n} theta_m)) sgn w",
        reference=REFERENCE,
        inputs=(v.theta_m,),
        repeats=True,
        one_of=max(n, len(ORDERS)),
        only_with={ANGLE: MOTOR_ANGLE},
        per_turn=n,
        words=replace(WORDS, headline=f"friction that varies {how_often(n)} per turn of the motor"),
    )
