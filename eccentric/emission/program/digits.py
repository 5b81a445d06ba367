"""How many digits a number has, and the parts that a parameter is split into.

Integers and half-integers times a part of few digits are exact, in every precision. Double precision uses
three parts, single precision five; the last one has all digits.
"""

from __future__ import annotations

BITS = {"single": 24, "double": 53}
# Bits that `Leading` keeps, and those that remain for a number of half turns. In single precision these are
# 14 bits: within 1e4 rad of the motor, a link that turns five times as far does not need more.
LEADING_BITS = {"single": 10, "double": 33}
TURN_BITS = {precision: bits - LEADING_BITS[precision] for precision, bits in BITS.items()}
