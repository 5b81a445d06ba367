"""A dialect of Python: how a module spells operations, where one library differs from another."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import mpmath
import sympy as sp

from eccentric.core import InputError
from eccentric.emission.backends.backend import number
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
    """What differs between the back ends."""

    symbol: Callable[[str], str]  # spelling of a symbol
    low: Callable[[str], str]  # spelling of the low part of a pair
    number: Callable[[str], str]  # spelling of a decimal number
    # operation -> its spelling, with {0}, {1} for its arguments; others cannot be printed
    calls: Mapping[str, str]
    pick: str  # a choice by sample, from condition and both values
    choice: str  # a choice by parameters, likewise

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


@dataclass(frozen=True)
class Dialect:
    """What differs between modules in Python.

    Attributes:
        kernel: spelling of operations on samples, with {0}, {1} for what they take.
        prepare: that of operations on parameters.
        where: spelling of a choice by sample, from condition, first and second value.
        choice: that of a choice by parameters.
        decorator: what makes a formula a function.
        missing, divisor: spelling of a parameter that is not given and has no default; that of a positive
            one, which others may be divided by.
        guarded: whether a function is told which of these it must have, as its result is NaN without them.
        pair: spelling of an expression as a pair of doubles, from the expression, the symbols that are pairs,
            how to print a float, which counts as exact, and the spelling of the name of a pair.
        broken: a line of `_prepare` as lines that are not too long.
        single: whether the coefficients for single precision are computed for that only.
    """

    kernel: Mapping[str, str]
    prepare: Mapping[str, str]
    where: str
    choice: str
    decorator: str
    missing: str
    divisor: str
    pair: Callable[[sp.Expr, frozenset[sp.Symbol], Language, Callable[[str], str]], str]
    broken: Callable[[str], list[str]]
    single: bool
    guarded: bool = False

    def language(
        self, calls: Mapping[str, str], symbol: Callable[[str], str], pair: Callable[[str], str] = str
    ) -> Language:
        """The language of expressions: `symbol` is the spelling of names, `pair` of those that are pairs."""
        return Language(symbol, lambda name: f"{pair(name)}.low", number, calls, self.where, self.choice)


def on_samples(library: str) -> dict[str, str]:
    """The operations on samples that NumPy and its like spell alike; `library` is what they call theirs."""
    calls = {
        "fabs": "abs({0})",
        "sgn": "np.sign({0})",
        "forward": "np.heaviside({0}, 0.0)",
        "backward": "np.heaviside(-({0}), 0.0)",
        "exp": "np.exp({0})",
        "at_most": "np.minimum({0}, {1})",
        "within": "np.clip({0}, -{1}, {1})",
        "in_single": "{0} if c.single else {1}",
    }
    return {name: text.replace("np.", f"{library}.") for name, text in calls.items()}


ON_PARAMETERS = {
    "fabs": "abs({0})",
    "rounded": "c.rounded({0})",
    "leading": "c.leading({0})",
    "in_single": "{0} if c.single else {1}",
}
"""The operations on parameters that all spell alike."""


# Lines that are not too long: a formula is broken before an operator that is in no bracket.
WIDTH = 106  # behind the indentation of a function


def broken(before: str, text: str, width: int = WIDTH) -> list[str]:
    """The formula after `before`, on several lines in brackets if it is too long for one.

    A sum is broken between terms, a product between factors; what is neither stays as it is.
    """
    if len(before + text) <= width:
        return [before + text]
    parts = list(_parts(text, "+-"))
    parts = parts if len(parts) > 1 else list(_parts(text, "*/"))
    lines = parts[:1]
    for part in parts[1:]:
        if len(f"{lines[-1]} {part}") <= width - 4:
            lines[-1] += f" {part}"
        else:
            lines.append(part)
    return [f"{before}(", *(f"    {line}" for line in lines), ")"] if len(parts) > 1 else [before + text]


def _parts(text: str, operators: str) -> Iterator[str]:
    """The terms or factors, each but the first with its operator in front."""
    depth = start = 0
    for k, c in enumerate(text):
        depth += (c in "([") - (c in ")]")
        if not depth and c in operators and text[k - 1 : k + 2] == f" {c} ":
            yield text[start : k - 1]
            start = k
    yield text[start:]
