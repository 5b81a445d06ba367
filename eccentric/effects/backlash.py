"""Backlash."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import Effect, Setting, Shape, Words
from eccentric.effects.forms import (
    addition,
    constant,
    direction,
    dt,
    gravity,
    harmonic,
    link_force,
    omega_m,
    speed,
)
from eccentric.model import GEARS, Definition, Load, Role, Sgn, State, quantity
from eccentric.model import vocabulary as v

gap = quantity("backlash_gap", "rad", "gap, motor side", "", "positive", letter="delta")
arm = quantity(
    "backlash_arm",
    "m",
    "dry friction of the link per force, as part of the load",
    "",
    "nonnegative",
    letter="a",
)
rise = quantity(
    "backlash_rise",
    "1",
    "what that friction gains at the top speed, relative",
    "",
    "nonnegative",
    letter="rho",
)
left = quantity("backlash_left", "1", "remaining share of the gap", "", "nonnegative", letter="r")
side = quantity("backlash_side", "1", "previous side of the load, 1 or -1", letter="z")
GRAVITY = quantity(
    "backlash_G",
    "1",
    "share of the gravity torque decoupled in the gap",
    "",
    "nonnegative",
    letter="gamma",
)
TORQUE = quantity(
    "backlash_T", "N m", "gravity torque due to the link's lag, per half gap", "", "nonnegative", letter="T"
)
# A strain-wave gear is preloaded: some of its teeth are always in mesh on both flanks.
WITH_TEETH = {"gear": tuple(gear for gear in GEARS if gear != "strain wave")}
STILL = 0.01
"""Part of the top speed below which a drive stands: the noise of a speed is less, a drive soon passes it."""
REFERENCE = "form of our own, no impact; backlash: M. Nordin and P.-O. Gutman, Automatica 38(10), 2002"
WORDS = Words(
    title="Backlash",
    meaning=(
        "Backlash: when the load on the gear changes sides, the motor turns freely until the teeth "
        "meet again."
    ),
    hint=("slow swings in which the load changes sides often, with an encoder on the link if possible"),
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The link decoupled in the gap; in case C2 also the link that lags by the gap.

    The gap closes in proportion to the motor's travel: if exponentially, it would be a bristle of
    `presliding`.
    """
    return (_freed(setting),) if setting.case == "C1" else (_freed(setting), _lag(setting))


def _states(setting: Setting) -> tuple[State, State]:
    """The side of the load, and what remains of the gap since it changed.

    Where it changes follows from gravity and friction of the link, which a log hardly separates from that of
    the motor: its part is a shape. A drive that stands has no direction: noise of its speed moves no load,
    and does not decide on which side the link begins.
    """
    dry = v.mu.symbol * link_force(setting) * arm.symbol * direction
    friction = dry * (1 + rise.symbol * speed / _top(setting).symbol)
    load = gravity(setting) + friction if setting.case == "C2" else direction
    now = Sgn(load) * Sgn(sp.Max(0, speed / _still(setting).symbol - 1))
    changed = now * (now * side.symbol**2 - side.symbol) / 2  # 1 if both are known and differ
    # A load that changes back within the gap has to close what the motor has travelled so far.
    rest = sp.Abs(changed - left.symbol) - speed * dt / gap.symbol
    return (
        State(side, sp.Integer(0), now + (1 - now**2) * side.symbol),
        State(left, sp.Integer(0), sp.Max(0, rest)),
    )


def _top(setting: Setting) -> Definition:
    return constant("backlash_top", "rad/s", "top speed of the identification log", setting.w_max, "w_1")


def _still(setting: Setting) -> Definition:
    slow = STILL * setting.w_max
    return constant("backlash_still", "rad/s", "speed below which the drive stands", slow, "w_0")


def _of_the_link(setting: Setting, points: int) -> tuple[Shape, Shape]:
    """The friction of the link: at rest, with so many points, and what it gains at the top speed."""
    longest = 0.4 * setting.known.get("L", 0.25)
    at_rest = Shape(arm, 0.0, longest, "linear", points, jumps=True)
    return at_rest, Shape(rise, 0.0, 1.0, "linear", 2, jumps=True)


def _freed(setting: Setting) -> Effect:
    free = Sgn(left.symbol)
    force = v.F_N.symbol if setting.case == "C2" else sp.Integer(1)
    per_force = setting.case == "C2"
    B = quantity(
        "backlash_B",
        "m s/rad" if per_force else "N m s/rad",
        "viscous friction of the link",
        "",
        "nonnegative",
        letter="B",
    )
    C = quantity(
        "backlash_C",
        "m" if per_force else "N m",
        "Coulomb friction of the link",
        "",
        "nonnegative",
        letter="C",
    )
    columns = [
        (B, -free * v.mu.symbol**2 * force * omega_m),
        (C, -free * v.mu.symbol * force * direction),
    ]
    shapes = [Shape(gap, 3e-3 / setting.mu, 0.5 / setting.mu, "log", 8, jumps=True)]
    roles, inputs = [Role.VISCOUS, Role.COULOMB], ()
    if setting.case == "C2":
        columns.insert(0, (GRAVITY, -free * gravity(setting)))
        shapes += _of_the_link(setting, 5)
        roles.insert(0, Role.NONE)
        inputs = (v.theta_m,)
    return addition(
        "backlash",
        columns,
        role=roles,
        load=Load.NORMAL if per_force else Load.NONE,
        kind="conservative",
        depends_on=("history",),
        formula="-(friction and gravity of the link) while the motor turns through the gap, after the load"
        " has changed its side",
        reference=REFERENCE,
        shapes=tuple(shapes),
        definitions=(_still(setting), _top(setting)) if per_force else (_still(setting),),
        states=_states(setting),
        only_with=WITH_TEETH,
        words=replace(WORDS, headline="backlash in the gear"),
        inputs=inputs,
    )


def _lag(setting: Setting) -> Effect:
    # The link hangs on the flank that its load presses against, whatever the direction of motion.
    place = side.symbol * (1 - 2 * left.symbol)
    return addition(
        "backlash",
        [(TORQUE, -harmonic(v.mu.symbol)[0] * place)],
        variant="lag",
        kind="conservative",
        depends_on=("history",),
        formula="-T z cos(theta_l), z from -1 to 1 the place in the gap, on the side of the load",
        reference=REFERENCE,
        shapes=(
            Shape(gap, 2e-3 / setting.mu, 0.5 / setting.mu, "log", 6, jumps=True),
            *_of_the_link(setting, 3),
        ),
        inputs=(v.theta_m,),
        definitions=(_still(setting), _top(setting)),
        states=_states(setting),
        only_with=WITH_TEETH,
        words=replace(WORDS, headline="a link that lags by the backlash in the gear"),
    )
