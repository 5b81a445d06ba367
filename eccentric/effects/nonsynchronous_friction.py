"""Friction that repeats at a non-integer order of the motor: balls and cage of a rolling bearing."""

from __future__ import annotations

from eccentric.effects.effect import Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, direction, harmonic
from eccentric.effects.link_harmonic_friction import ORDERS as LINK_ORDERS
from eccentric.effects.motor_harmonic_friction import ORDERS as MOTOR_ORDERS
from eccentric.model import Role, quantity
from eccentric.model import vocabulary as v

order = quantity("nonsync_order", "1", "periods per turn of the motor", "", "positive", letter="nu")
C = quantity("nonsync_c", "N m", "friction torque by cos(nu theta_m)", letter="c_nu")
S = quantity("nonsync_s", "N m", "friction torque by sin(nu theta_m)", letter="s_nu")
LOWEST, HIGHEST = 0.5, 8.0
"""Orders per turn of the motor: the inner race passes its cage some 0.6 times, and a dozen balls 7 times."""
APART = 0.25
"""Cycles over the log by which it has to slip against every harmonic of motor and link to be none: a fit of
the nearest then leaves 0.44 of it."""
WORDS = Words(
    headline="friction that repeats at a non-integer order of the motor",
    meaning=(
        "Friction that repeats, but not with the turn of the motor: a damaged ball, race or cage of its"
        " bearing, or of one inside the gear, as long as that rolls without slip."
    ),
    hint="long slow turns of the motor in one direction, and the orders of its bearings from their geometry",
    tell_apart={
        "link_harmonic_friction": "Turn the motor over many more turns, slowly: the two orders drift apart.",
        "motor_harmonic_friction": "Turn the motor over many more turns, slowly: the two orders drift apart.",
    },
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family, at the strongest order of the log that is no harmonic.

    The order is a shape within half a cycle over the log of that one: further away, another peak is meant,
    or a harmonic.
    """
    found = next((nu for nu in setting.orders if _own(nu, setting)), None)
    if found is None:
        return ()
    cosine, sine = harmonic(order.symbol)
    half, least = 0.5 / setting.turns, APART / setting.turns
    below = [own for own in _harmonics(setting) if own < found]
    above = [own for own in _harmonics(setting) if own > found]
    span = (
        max([found - half, *(own + least for own in below)]),
        min([found + half, *(own - least for own in above)]),
    )
    effect = addition(
        "nonsynchronous_friction",
        [(C, cosine * direction), (S, sine * direction)],
        role=Role.COULOMB,
        depends_on=("motor_angle",),
        formula="(c cos(nu theta_m) + s sin(nu theta_m)) sgn w, nu not an integer",
        reference="N. Tandon and A. Choudhury, Tribology International 32(8), 1999 (orders of a bearing);"
        " standard form, as over the link angle",
        shapes=(Shape(order, *span, "linear", 5),),
        # It lies between two harmonics: there are as many such places.
        one_of=len(MOTOR_ORDERS),
        per_turn=order.symbol,
        inputs=(v.theta_m,),
        words=WORDS,
    )
    return (effect,)


def _own(nu: float, setting: Setting) -> bool:
    """Whether an order is within the range, and no harmonic of motor or link."""
    least = APART / setting.turns
    return LOWEST <= nu <= HIGHEST and all(abs(nu - own) > least for own in _harmonics(setting))


def _harmonics(setting: Setting) -> list[float]:
    """The orders of motor and link, per turn of the motor."""
    return [*map(float, MOTOR_ORDERS), *(n * setting.mu for n in LINK_ORDERS)]
