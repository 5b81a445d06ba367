"""Printing: a lowered expression in Python or C, operation by operation, in the same order for both."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import mpmath
import sympy as sp

from eccentric.core import InputError
from eccentric.emission.program import (
    AtMost,
    Call,
    InSingle,
    Low,
    Minus,
    Over,
    Pick,
    Plus,
    Root,
    Rounded,
    Size,
    Times,
    Within,
)
from eccentric.model import steps

_CHOICE, _SUM, _PRODUCT, _ATOM = 0, 1, 2, 3


class UnprintableError(InputError):
    """An operation that no back end computes; `operation` is the expression."""

    def __init__(self, operation: sp.Basic) -> None:
        self.operation = operation
        super().__init__(
            f"{operation}: expected +, -, *, /, integer powers, sqrt, Abs, Min, Max, exp or a step of"
            f" eccentric.model.steps, got {type(operation).__name__}"
        )


@dataclass(frozen=True)
class Language:
    """What differs between the back ends.

    Attributes:
        symbol: spelling of a symbol.
        low: spelling of the low part of a pair.
        number: spelling of a decimal number.
        calls: operation -> its spelling, with {0}, {1} for its arguments; others cannot be printed.
        pick: a choice by sample, from condition and both values.
        choice: a choice by parameters, likewise.
    """

    symbol: Callable[[str], str]
    low: Callable[[str], str]
    number: Callable[[str], str]
    calls: Mapping[str, str]
    pick: str
    choice: str

    def call(self, name: str, *arguments: str) -> str:
        """A named operation with printed arguments; KeyError if the language lacks it."""
        return self.calls[name].format(*arguments)

    def branches(self, cases: Sequence[tuple[str, str]]) -> str:
        """A Piecewise, from value and condition of each case; the last one holds otherwise."""
        text = cases[-1][0]
        for value, condition in reversed(cases[:-1]):
            text = self.choice.format(condition, value, text)
        return text


_CALLS: Mapping[type, str] = {
    Root: "sqrt",
    Size: "fabs",
    Rounded: "rounded",
    steps.Leading: "leading",
    steps.Sgn: "sgn",
    steps.Forward: "forward",
    steps.Backward: "backward",
    sp.Abs: "fabs",
    sp.sin: "sin",
    sp.cos: "cos",
    sp.exp: "exp",
}


def printed(expression: sp.Expr, language: Language) -> str:
    """The expression in the language.

    Raises:
        UnprintableError: an operation that the language lacks.
    """
    return _print(expression, language)[0]


def choice_of_pairs(e: sp.Piecewise, pair: Callable[[sp.Expr], str], plain: Language) -> str:
    """A choice between pairs: its conditions are plain; only the values are pairs."""
    values = {f"value_{k}": pair(value) for k, (value, _) in enumerate(e.args)}
    stand_in = sp.Piecewise(*((sp.Symbol(s), c) for s, (_, c) in zip(values, e.args, strict=True)))
    return printed(stand_in, replace(plain, symbol=lambda name: values.get(name) or plain.symbol(name)))


def _print(e: sp.Expr, language: Language) -> tuple[str, int]:
    def at(level: int, part: sp.Expr) -> str:
        text, own = _print(part, language)
        return text if own >= level else f"({text})"

    def plain(part: sp.Expr) -> str:
        return _print(part, language)[0]

    if e.is_Symbol:
        return language.symbol(e.name), _ATOM
    if (e.is_number and not e.args) or e.is_Rational or e is sp.pi:
        with mpmath.workdps(30):
            text = mpmath.nstr(mpmath.mpf(e.evalf(30)), 17)
        return language.number(text), _ATOM if e >= 0 else _SUM
    if isinstance(e, Plus):
        return f"{at(_SUM, e.args[0])} + {at(_PRODUCT, e.args[1])}", _SUM
    if isinstance(e, Minus):
        return f"{at(_SUM, e.args[0])} - {at(_PRODUCT, e.args[1])}", _SUM
    if isinstance(e, Times):
        return f"{at(_PRODUCT, e.args[0])} * {at(_ATOM, e.args[1])}", _PRODUCT
    if isinstance(e, Over):
        return f"{at(_PRODUCT, e.args[0])} / {at(_ATOM, e.args[1])}", _PRODUCT
    if isinstance(e, Low):
        return language.low(e.args[0].name), _ATOM
    if isinstance(e, Call):
        return language.call(e.args[0].name, plain(e.args[1])), _ATOM
    if isinstance(e, Pick):
        a, relation, b, x, y = e.args
        condition = f"{at(_SUM, a)} {relation.name} {at(_SUM, b)}"
        return language.pick.format(condition, plain(x), plain(y)), _ATOM
    if isinstance(e, InSingle):
        return language.call("in_single", *(at(_SUM, part) for part in e.args)), _CHOICE
    if isinstance(e, AtMost | Within):
        name = "at_most" if isinstance(e, AtMost) else "within"
        return language.call(name, *(at(_ATOM, part) for part in e.args)), _ATOM
    if type(e) in _CALLS:
        try:
            return language.call(_CALLS[type(e)], plain(e.args[0])), _ATOM
        except KeyError:
            raise UnprintableError(e) from None
    if isinstance(e, sp.Piecewise) and all(c == sp.true or isinstance(c, sp.Eq) for _, c in e.args):
        pairs = [
            (
                plain(value),
                "" if condition == sp.true else f"{at(_SUM, condition.lhs)} == {at(_SUM, condition.rhs)}",
            )
            for value, condition in e.args
        ]
        return language.branches(pairs), _CHOICE
    if isinstance(e, sp.Max | sp.Min):  # of parameters
        first, *others = e.args
        other = others[0] if len(others) == 1 else e.func(*others)
        relation = ">" if isinstance(e, sp.Max) else "<"
        condition = f"{at(_SUM, first)} {relation} {at(_SUM, other)}"
        return language.branches([(plain(first), condition), (plain(other), "")]), _CHOICE
    if e.is_Add:
        text = ""
        for term in e.as_ordered_terms():
            negative = term.could_extract_minus_sign()
            part = at(_PRODUCT, -term if negative else term)
            text += (" - " if negative else " + ") + part if text else ("-" if negative else "") + part
        return text, _SUM
    if e.is_Mul:
        return _product(e, at)
    if e.is_Pow and e.exp == sp.Rational(1, 2):
        return language.call("sqrt", plain(e.base)), _ATOM
    if e.is_Pow and e.exp.is_negative:
        return f"{plain(sp.Integer(1))} / {at(_ATOM, 1 / e)}", _PRODUCT
    if e.is_Pow and e.exp.is_Integer:
        return " * ".join([at(_ATOM, e.base)] * int(e.exp)), _PRODUCT
    raise UnprintableError(e)


def _product(e: sp.Expr, at: Callable[[int, sp.Expr], str]) -> tuple[str, int]:
    """Factors from left to right, then the divisors as one product."""
    above = [f for f in e.as_ordered_factors() if not (f.is_Pow and f.exp.is_negative)]
    below = [1 / f for f in e.as_ordered_factors() if f.is_Pow and f.exp.is_negative]
    sign = ""
    if above and above[0] == -1:
        sign, above = "-", above[1:]
    top = " * ".join(
        at(_PRODUCT if k == 0 else _ATOM, f) if not f.is_Pow else at(_PRODUCT, f) for k, f in enumerate(above)
    ) or at(_ATOM, sp.Integer(1))
    if not below:
        return sign + top, _SUM if sign else _PRODUCT
    bottom = at(_ATOM, sp.Mul(*below))
    return f"{sign}{top} / {bottom}", _SUM if sign else _PRODUCT
