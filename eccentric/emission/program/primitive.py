"""Primitive operations: the elements of lowered expressions, printed one to one by every back end.

They keep their arguments unchanged; SymPy neither reorders nor simplifies them. So NumPy and C compute the
same bits.
"""

from __future__ import annotations

import sympy as sp

from eccentric.model import OpaqueStep


class Plus(OpaqueStep):
    """a + b."""


class Minus(OpaqueStep):
    """a - b."""


class Times(OpaqueStep):
    """a b."""


class Over(OpaqueStep):
    """a / b."""


class Root(OpaqueStep):
    """Square root."""


class Size(OpaqueStep):
    """Absolute value."""


class Rounded(OpaqueStep):
    """A parameter-only number in the working precision (prepare only)."""


class Low(OpaqueStep):
    """The digits of a parameter-only number beyond those of its double; 0 in exact arithmetic."""


class TurnLeft(OpaqueStep):
    """2 pi - a b, without losing digits if a b is close to 2 pi (prepare only)."""


class AtMost(OpaqueStep):
    """AtMost(a, b): the smaller of both; NaN stays."""


class Within(OpaqueStep):
    """Within(a, b): a limited to -b and b, for positive b; NaN stays."""


class InSingle(OpaqueStep):
    """InSingle(a, b): a in single precision, b in double; on a sample, b is a symbol."""


class Call(OpaqueStep):
    """A private function of the emitted code, by its name."""


class Pick(OpaqueStep):
    """Pick(a, relation, b, x, y): x where `a relation b` holds, else y; a relation is >, <, <= or ==."""


# 3/2 times the number above which all floats are integers: x + ROUNDER - ROUNDER is x, rounded to an integer.
ROUNDER = sp.Symbol("rounder")
SINE_RATIO, COSINE = sp.Symbol("sine_ratio"), sp.Symbol("cosine")
HALF = sp.Rational(1, 2)
ABOVE, BELOW, AT_MOST, EQUAL = sp.symbols("> < <= ==")  # relations of Pick


def exact(value: sp.Expr) -> sp.Expr:
    """The parameter-only value with SymPy's operations for the primitive ones; rounding is unchanged."""
    plain = {
        Low: lambda _: sp.Integer(0),
        TurnLeft: lambda a, b: 2 * sp.pi - a * b,
        Plus: lambda a, b: a + b,
        Minus: lambda a, b: a - b,
    }
    for operation, meant in plain.items():
        value = value.replace(operation, meant)
    return value
