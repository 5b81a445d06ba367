"""A parameter in parts of few digits: whole and half numbers times each part are exact, in every precision.

Double precision takes three parts, single precision five, of which the last one has all digits.
"""

from __future__ import annotations

import sympy as sp

from eccentric.emission.program.prepare import Prepare
from eccentric.emission.program.primitive import InSingle, Minus, Rounded
from eccentric.model.steps import Leading

BITS = {"single": 24, "double": 53}
# What `Leading` keeps of them, and what that leaves to a number of half turns. In single precision these are
# 14 bits: within 1e4 rad of the motor, a link that turns five times as far does not pass more.
LEADING_BITS = {"single": 10, "double": 33}
TURN_BITS = {precision: bits - LEADING_BITS[precision] for precision, bits in BITS.items()}


def last_parts(name: str, left: sp.Symbol, prepare: Prepare) -> list[sp.Symbol]:
    """The third part and those after it, of what the first two leave."""
    third = prepare(f"{name}_3", InSingle(Leading(left), Rounded(left)))
    fourth = prepare(f"{name}_4", Leading(Minus(left, third)))
    last = prepare(f"{name}_last", Minus(Minus(left, third), fourth))
    return [third, fourth, prepare(f"{name}_5", Rounded(last))]
