"""Stribeck friction."""

from __future__ import annotations

import math
from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import SPEED, Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import addition, direction, omega_m, root, speed
from eccentric.model import Quantity, Role, quantity
from eccentric.model import vocabulary as v

A = quantity(
    "stribeck_A",
    "N m",
    "Stribeck torque: increase of the friction near rest",
    "",
    "nonnegative",
    letter="A",
)
w_s = quantity("stribeck_v", "rad/s", "Stribeck velocity, motor side", "", "positive", letter="v")
ratio = speed / w_s.symbol
half, definitions = root("stribeck", omega_m / w_s.symbol, "speed over the Stribeck velocity")
# A general exponent would require `pow`; these are the four in use.
POWERS = {"0.5": half, "1": ratio, "1.5": ratio * half, "2": ratio**2}
SERVOS = (
    "M. Duclusaud et al., github.com/Rhoban/bam, fitted to geared servos from XL-320 to MX-106, 2024:"
    " 0.12 to 2.0 rad/s at the output"
)


def speed_at_the_output(velocity: Quantity) -> Plausible:
    """The Stribeck velocity of a drive, which is known of small geared servos only."""
    return Plausible(
        v.mu.symbol * velocity.symbol,
        "rad/s",
        0.0,
        math.inf,
        f"none but of servos: {SERVOS}",
        "the Stribeck velocity at the output",
        above="a slow fall of friction that has another cause",
        by_part={"spur": (0.12, 2.0, SERVOS)},
    )


WORDS = Words(
    title="Stribeck friction",
    meaning="Dry friction that is higher at low speed, until a film of lubricant carries the load.",
    hint="steady runs at several speeds below and around the Stribeck velocity, in both directions",
    kin=SPEED,
    tell_apart={
        "presliding": "Move slowly below the Stribeck velocity, far from reversals.",
    },
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """One effect for each exponent d."""
    return tuple(
        addition(
            "stribeck",
            [(A, sp.exp(-power) * direction)],
            variant=f"d={d}",
            role=Role.STRIBECK,
            depends_on=("velocity",),
            formula=f"A exp(-(|w|/v)^{d}) sgn w",
            reference="R. Stribeck, Zeitschrift des VDI 46, 1902; with an exponent L. C. Bo and D. Pavelescu,"
            " Wear 82(3), 1982",
            definitions=definitions if power.has(half) else (),
            # Bristles that bend over no angle at all leave LuGre's g(w) alone; under a constant load, or at
            # one temperature, Stribeck friction that follows it is this one.
            special_of=("presliding", "stribeck_load", "stribeck_temperature"),
            plausible=(speed_at_the_output(w_s),),
            shapes=(Shape(w_s, setting.w_min, 0.6 * setting.w_max, "log", 12),),
            words=replace(WORDS, headline=f"Stribeck friction with exponent {d}"),
        )
        for d, power in POWERS.items()
    )
