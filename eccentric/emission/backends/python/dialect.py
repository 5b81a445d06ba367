"""A dialect of Python: how a module spells operations, where one library differs from another."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import sympy as sp

from eccentric.emission.backends.backend import number
from eccentric.emission.backends.expression import Language


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
