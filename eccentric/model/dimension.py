"""Dimensions: the SI exponents of a unit and of an expression, so that equations can be held to units."""

from __future__ import annotations

import re
from collections.abc import Mapping

import sympy as sp

from eccentric.model import steps

# kg, m, s, A, K; radians and revolutions are pure numbers.
_BASE = {
    "1": (0, 0, 0, 0, 0), "rad": (0, 0, 0, 0, 0), "radian": (0, 0, 0, 0, 0),
    "kg": (1, 0, 0, 0, 0), "m": (0, 1, 0, 0, 0),
    "s": (0, 0, 1, 0, 0), "A": (0, 0, 0, 1, 0), "K": (0, 0, 0, 0, 1), "N": (1, 1, -2, 0, 0),
    "J": (1, 2, -2, 0, 0), "W": (1, 2, -3, 0, 0), "V": (1, 2, -3, -1, 0), "Ohm": (1, 2, -3, -2, 0),
}  # fmt: skip

Dimension = tuple[sp.Rational, ...]
PURE: Dimension = (sp.Integer(0),) * 5


def of_unit(unit: str) -> Dimension:
    """SI exponents (kg, m, s, A, K) of a unit such as "N m s/rad".

    Raises:
        ValueError: a factor of the unit is unknown.
    """
    total = list(PURE)
    for place, side in enumerate(unit.split("/")):
        sign = -1 if place else 1
        for factor in side.strip(" ()").split():
            match = re.fullmatch(r"([A-Za-z]+|1)(?:\^(-?\d+))?", factor)
            if match is None or match[1] not in _BASE:
                raise ValueError(f"unit {unit!r}: unknown factor {factor!r}; known are {', '.join(_BASE)}")
            power = sign * int(match[2] or 1)
            total = [old + power * new for old, new in zip(total, _BASE[match[1]], strict=True)]
    return tuple(total)


def of_expression(expression: sp.Basic, units: Mapping[sp.Symbol, str]) -> Dimension:
    """SI exponents of an expression; `units` gives the unit of every symbol in it.

    Raises:
        ValueError: addends of different dimension, or a pure number required and something else given.
    """
    expression = sp.sympify(expression)
    if isinstance(expression, sp.Symbol):
        return of_unit(units[expression])
    if expression.is_number:
        return PURE
    if isinstance(expression, sp.Pow):
        base = of_expression(expression.base, units)
        return tuple(exponent * sp.Rational(expression.exp) for exponent in base)
    parts = [of_expression(argument, units) for argument in _values(expression)]
    if isinstance(expression, sp.Mul | steps.Gated):
        return tuple(sum(column, sp.Integer(0)) for column in zip(*parts, strict=True))
    if isinstance(expression, sp.Abs | steps.Bounded | steps.Leading):
        return parts[0]
    if isinstance(expression, steps.SquareDifference):
        _same(expression, parts)
        return tuple(2 * exponent for exponent in parts[0])
    if isinstance(expression, sp.Piecewise):
        # A bare number is used if there is no physical value (the critical velocity of a balanced mass).
        return _same(
            expression,
            [p for p, value in zip(parts, _values(expression), strict=True) if not value.is_number],
        )
    if isinstance(expression, sp.Add | steps.Magnitude):
        return _same(expression, parts)
    if isinstance(expression, steps.Along | steps.Across):
        _same(expression, parts)
        return PURE
    # The rest are functions of a number: trigonometric ones, the sign, the half-turn cosine, exp.
    for part, value in zip(parts, _values(expression), strict=True):
        if part != PURE and not isinstance(
            expression, sp.sign | sp.Heaviside | steps.Sgn | steps.Forward | steps.Backward
        ):
            raise ValueError(f"{value} in {expression}: a pure number is required")
    return PURE


def _values(expression: sp.Basic) -> list[sp.Basic]:
    if isinstance(expression, sp.Piecewise):
        return [branch.expr for branch in expression.args]
    return list(expression.args)


def _same(expression: sp.Basic, parts: list[Dimension]) -> Dimension:
    if len(set(parts)) > 1:
        raise ValueError(f"addends of different dimension in {expression}")
    return parts[0] if parts else PURE
