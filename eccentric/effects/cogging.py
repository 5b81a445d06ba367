"""Cogging of the motor."""

from __future__ import annotations

from dataclasses import replace

from eccentric.effects.effect import Effect, Setting, Words, how_often
from eccentric.effects.forms import addition, harmonic
from eccentric.model import ANGLE, IRON, MOTOR_ANGLE, quantity
from eccentric.model import vocabulary as v

ORDERS = range(1, 25)
WORDS = Words(
    title="Cogging",
    meaning=(
        "Cogging: magnets attract the teeth; the torque needs no current and dissipates no energy over"
        " a turn."
    ),
    hint="slow turns of the motor in both directions, at low and at high current: cogging stays the same",
    tell_apart={
        "gravity": "Turn the motor slowly with the link removed.",
    },
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """One effect for each order n of the motor angle, and each line; of a carriage, of that of its screw."""
    return tuple(_order(n, setting.base.axis.wraps) for n in (*ORDERS, *setting.lines))


def _order(n: int, turns: bool) -> Effect:
    cosine, sine = harmonic(n if turns else n * v.mu.symbol)
    angle = f"{n} theta_{'m' if turns else 'l'}"
    C = quantity(f"cogging_c{n}", "N m", f"cogging torque by cos({angle})", letter=f"c_{n}")
    S = quantity(f"cogging_s{n}", "N m", f"cogging torque by sin({angle})", letter=f"s_{n}")
    return addition(
        "cogging",
        [(C, cosine), (S, sine)],
        variant=f"n={n}",
        kind="conservative",
        depends_on=("motor_angle" if turns else "link_angle",),
        formula=f"c cos({angle}) + s sin({angle})",
        reference="T. M. Jahns and W. L. Soong, IEEE Trans. Industrial Electronics 43(2), 1996",
        inputs=(v.theta_m,),
        repeats=True,
        one_of=max(n, len(ORDERS)),
        only_with={"motor": IRON, ANGLE: MOTOR_ANGLE},
        per_turn=n if turns else n * v.mu.symbol,
        words=replace(WORDS, headline=f"cogging that repeats {how_often(n)} per turn of the motor"),
    )
