"""Backlash: the link decoupled while the motor turns through the gap, and the link that lags by it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import sympy as sp

from eccentric.effects.effect import Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import (
    F_N,
    Column,
    addition,
    constant,
    direction,
    dt,
    gravity,
    harmonic,
    mu,
    nonnegative,
    omega_m,
    positive,
    speed,
)
from eccentric.model import GEARS, Load, Role, Sgn, State, quantity
from eccentric.model import vocabulary as v

LOOSE = "maxon motor, Program 2012/13: average backlash of planetary gearheads without load"
STILL = 0.01
"""Part of the top speed below which a drive stands: the noise of a speed is less, a drive soon passes it."""


def backlash(setting: Setting) -> Iterator[Effect]:
    """The link decoupled in the gap; in case C2 also the link that lags by the gap.

    The gap closes in proportion to the motor's travel: if exponentially, it would be a bristle of
    `presliding`.

    Where the load changes its side follows from gravity and friction of the link, which a log hardly
    separates from that of the motor: its part is a shape. A drive that stands has no direction: noise of its
    speed moves no load, and does not decide on which side the link begins.
    """
    by_force = setting.case == "C2"
    per, force = ("", F_N) if by_force else ("N ", sp.Integer(1))
    gap = positive("backlash_gap", "rad", "gap, motor side", "delta")
    arm = nonnegative("backlash_arm", "m", "dry friction of the link per force, as part of the load", "a")
    rise = nonnegative("backlash_rise", "1", "what that friction gains at the top speed, relative", "rho")
    left = nonnegative("backlash_left", "1", "remaining share of the gap", "r")
    side = quantity("backlash_side", "1", "previous side of the load, 1 or -1", letter="z")
    G = nonnegative("backlash_G", "1", "share of the gravity torque decoupled in the gap", "gamma")
    B = nonnegative("backlash_B", f"{per}m s/rad", "viscous friction of the link", "B")
    C = nonnegative("backlash_C", f"{per}m", "Coulomb friction of the link", "C")
    T = nonnegative("backlash_T", "N m", "gravity torque due to the link's lag, per half gap", "T")
    top = constant("backlash_top", "rad/s", "top speed of the identification log", setting.w_max, "w_1")
    slow = STILL * setting.w_max
    still = constant("backlash_still", "rad/s", "speed below which the drive stands", slow, "w_0")

    dry = mu * _link_force(setting) * arm.symbol * direction
    load = gravity(setting) + dry * (1 + rise.symbol * speed / top.symbol) if by_force else direction
    now = Sgn(load) * Sgn(sp.Max(0, speed / still.symbol - 1))
    changed = now * (now * side.symbol**2 - side.symbol) / 2  # 1 if both are known and differ
    # A load that changes back within the gap has to close what the motor has travelled so far.
    rest = sp.Abs(changed - left.symbol) - speed * dt / gap.symbol
    shared: dict[str, Any] = {
        "kind": "conservative",
        "depends_on": ("history",),
        "reference": "form of our own, no impact; backlash: M. Nordin and P.-O. Gutman, Automatica 38(10),"
        " 2002",
        "inputs": (v.theta_m,) if by_force else (),
        "definitions": (still, top) if by_force else (still,),
        "states": (
            State(side, sp.Integer(0), now + (1 - now**2) * side.symbol),
            State(left, sp.Integer(0), sp.Max(0, rest)),
        ),
        # A strain-wave gear is preloaded: some of its teeth are always in mesh on both flanks.
        "only_with": {"gear": tuple(gear for gear in GEARS if gear != "strain wave")},
        "plausible": (
            Plausible(
                180 / sp.pi * mu * gap.symbol,
                "deg",
                0.0,
                math.inf,
                f"none but of planetary gears: {LOOSE}",
                "the backlash at the output",
                above="more than such a gear has: wear, or another loose part",
                by_part={"planetary": (0.0, 3.0, LOOSE)},
            ),
        )
        if setting.base.axis.wraps
        else (),
        "words": Words(
            title="Backlash",
            meaning="Backlash: when the load on the gear changes sides, the motor turns freely until the"
            " teeth meet again.",
            hint="slow swings in which the load changes sides often, with an encoder on the link if possible",
        ),
    }

    def shapes(lowest: float, points: int, of_friction: int) -> tuple[Shape, ...]:
        """The gap, the friction of the link at rest, with so many points each, and its gain at the top."""
        found = (Shape(gap, lowest / setting.mu, 0.5 / setting.mu, "log", points, jumps=True),)
        if not by_force:
            return found
        longest = 0.4 * setting.known.get("L", 0.25)
        return (
            *found,
            Shape(arm, 0.0, longest, "linear", of_friction, jumps=True),
            Shape(rise, 0.0, 1.0, "linear", 2, jumps=True),
        )

    free = Sgn(left.symbol)
    # The first names the effect: gravity's share where there is one, else Coulomb friction, since after a
    # reversal the speed is low and a log seldom shows the viscous part.
    columns: list[Column] = [(C, -free * mu * force * direction), (B, -free * mu**2 * force * omega_m)]
    roles = [Role.COULOMB, Role.VISCOUS]
    if by_force:
        columns.insert(0, (G, -free * gravity(setting)))
        roles.insert(0, Role.NONE)
    yield addition(
        "backlash",
        columns,
        role=roles,
        load=Load.NORMAL if by_force else Load.NONE,
        formula="-(friction and gravity of the link) while the motor turns through the gap, after the load"
        " has changed sides",
        shapes=shapes(3e-3, 8, 5),
        headline="backlash in the gear",
        **shared,
    )
    if by_force:
        # The link hangs on the flank that its load presses against, whatever the direction of motion.
        place = side.symbol * (1 - 2 * left.symbol)
        yield addition(
            "backlash",
            [(T, -harmonic(mu)[0] * place)],
            variant="lag",
            formula="-T z cos(theta_l), z from -1 to 1 the place in the gap, on the side of the load",
            shapes=shapes(2e-3, 6, 3),
            headline="a link that lags by the backlash in the gear",
            **shared,
        )


def _link_force(setting: Setting) -> sp.Expr:
    """Magnitude of the forces that the link's bearing carries [N]: F_N, and the weight along its axis."""
    along = sp.sin(v.phi.symbol) if setting.base.tilted else int(setting.case == "C1")
    return F_N + (v.M.symbol + v.M_l.symbol) * v.g.symbol * along
