"""Symbols, quantities and equations under the names of an axis, for whoever reads them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import sympy as sp

from eccentric.model.axis import AxisKind
from eccentric.model.equation import Equation
from eccentric.model.quantity import Quantity

__all__ = ["in_letters_of", "spoken_equation", "spoken_quantity", "spoken_symbol"]

E = TypeVar("E", bound=sp.Basic)


def spoken_symbol(axis: AxisKind, symbol: sp.Symbol) -> sp.Symbol:
    """The symbol under its name for an axis, with the same assumptions."""
    name = axis.letters.get(symbol.name, symbol.name)
    return symbol if name == symbol.name else sp.Symbol(name, **symbol.assumptions0)


def spoken_quantity(axis: AxisKind, q: Quantity) -> Quantity:
    """A quantity under its name for an axis, with its unit and meaning there."""
    symbol = spoken_symbol(axis, q.symbol)
    letter = axis.formulas.get(symbol.name, "" if symbol != q.symbol else q.letter)
    default = q.default if q.default is None else in_letters_of(axis)(q.default)
    said = {"unit": axis.said(q.unit), "meaning": axis.said(q.meaning)}
    return replace(q, symbol=symbol, letter=letter, default=default, **said)


def spoken_equation(axis: AxisKind, equation: Equation) -> Equation:
    """An equation of a derivation in the words of an axis."""
    put, unit = in_letters_of(axis), equation.unit
    return replace(
        equation,
        left=put(equation.left),
        right=put(equation.right),
        unit=axis.said(unit) if isinstance(unit, str) else tuple(map(axis.said, unit)),
        origin=axis.said(equation.origin),
    )


def in_letters_of(axis: AxisKind) -> Callable[[E], E]:
    """A function that puts the letters of an axis into an expression."""

    def put(expression: E) -> E:
        named = {s: spoken_symbol(axis, s) for s in expression.free_symbols}
        return expression.xreplace({s: now for s, now in named.items() if s != now})

    return put
