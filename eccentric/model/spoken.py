"""A model in the words of its axis: letters, units and meanings, for whoever reads it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

import sympy as sp

from eccentric.model.axis import TURNING, AxisKind
from eccentric.model.definition import Definition
from eccentric.model.equation import Equation
from eccentric.model.quantity import Quantity

if TYPE_CHECKING:
    from eccentric.model.model import Model

__all__ = ["spoken", "spoken_equation", "spoken_quantity", "spoken_symbol"]

E = TypeVar("E", bound=sp.Basic)


def spoken_symbol(axis: AxisKind, symbol: sp.Symbol) -> sp.Symbol:
    """The symbol under its name for an axis, with the same assumptions."""
    name = axis.letters.get(symbol.name, symbol.name)
    return symbol if name == symbol.name else sp.Symbol(name, **symbol.assumptions0)


def spoken_quantity(axis: AxisKind, q: Quantity) -> Quantity:
    """A quantity under its name for an axis, with its unit and meaning there."""
    symbol = spoken_symbol(axis, q.symbol)
    letter = axis.formulas.get(symbol.name, "" if symbol != q.symbol else q.letter)
    default = q.default if q.default is None else _in(axis)(q.default)
    said = {"unit": axis.said(q.unit), "meaning": axis.said(q.meaning)}
    return replace(q, symbol=symbol, letter=letter, default=default, **said)


def spoken(model: Model) -> Model:
    """The same model in the words of its axis; nothing computes with it."""
    axis = model.axis
    if axis is TURNING:
        return model
    put = _in(axis)

    def quantity(q: Quantity) -> Quantity:
        return spoken_quantity(axis, q)

    return replace(
        model,
        title=axis.said(model.title),
        inputs=tuple(map(quantity, model.inputs)),
        parameters=tuple(map(quantity, model.parameters)),
        definitions=tuple(
            Definition(quantity(definition.quantity), put(definition.value))
            for definition in model.definitions
        ),
        balances=tuple(
            replace(
                balance,
                unit=axis.said(balance.unit),
                terms=tuple(
                    replace(term, coefficient=put(term.coefficient), basis=put(term.basis))
                    for term in balance.terms
                ),
            )
            for balance in model.balances
        ),
        equations=tuple(spoken_equation(axis, equation) for equation in model.equations),
        states=tuple(
            replace(
                state,
                quantity=quantity(state.quantity),
                initial=put(state.initial),
                update=put(state.update),
            )
            for state in model.states
        ),
        extensions=(),
        axis=TURNING,
    )


def spoken_equation(axis: AxisKind, equation: Equation) -> Equation:
    """An equation of a derivation in the words of an axis."""
    put, unit = _in(axis), equation.unit
    return replace(
        equation,
        left=put(equation.left),
        right=put(equation.right),
        unit=axis.said(unit) if isinstance(unit, str) else tuple(map(axis.said, unit)),
        origin=axis.said(equation.origin),
    )


def _in(axis: AxisKind) -> Callable[[E], E]:
    """A function that puts the letters of an axis into an expression."""

    def put(expression: E) -> E:
        named = {s: spoken_symbol(axis, s) for s in expression.free_symbols}
        return expression.xreplace({s: now for s, now in named.items() if s != now})

    return put
