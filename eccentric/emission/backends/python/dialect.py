"""A dialect of Python: how a module spells operations, where one library differs from another."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import sympy as sp

from eccentric.emission.backends.expression import Language
from eccentric.emission.backends.text import number


@dataclass(frozen=True)
class Dialect:
    """What differs between modules in Python.

    Attributes:
        kernel: spelling of operations on samples, with {0}, {1} for what they take.
        prepare: that of operations on parameters.
        where: spelling of a choice by sample, from condition, first and second value.
        choice: that of a choice by parameters.
        decorator: what makes a formula a function.
        missing: spelling of a parameter that is not given and has no default.
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
    pair: Callable[[sp.Expr, frozenset[sp.Symbol], Language, Callable[[str], str]], str]
    broken: Callable[[str], list[str]]
    single: bool

    def language(
        self, calls: Mapping[str, str], symbol: Callable[[str], str], pair: Callable[[str], str] = str
    ) -> Language:
        """The language of expressions: `symbol` is the spelling of names, `pair` of those that are pairs."""

        def branches(cases: list[tuple[str, str]]) -> str:
            text = cases[-1][0]
            for value, condition in reversed(cases[:-1]):
                text = self.choice.format(condition, value, text)
            return text

        return Language(
            symbol=symbol,
            low=lambda name: f"{pair(name)}.low",
            number=number,
            call=lambda name, arguments: calls[name].format(*arguments),
            pick=lambda a, relation, b, x, y: self.where.format(f"{a} {relation} {b}", x, y),
            branches=branches,
        )


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
