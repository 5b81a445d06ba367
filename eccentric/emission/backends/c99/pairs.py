"""Printing of expressions in pairs of doubles: nested calls of the pair functions."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import reduce

import sympy as sp

from eccentric.emission.backends.expression import Language, printed
from eccentric.emission.program import Program, TurnLeft, paired


def pair_functions(program: Program) -> frozenset[str]:
    """The names of the pair functions that `pair_text` calls for the program."""
    found: set[str] = set()

    def noted(name: str) -> str:
        found.add(name)
        return name

    pairs = paired(program)
    silent = Language(str, str, str, lambda *_: "", lambda *_: "", lambda _: "")
    for a in program.prepare:
        if a.target in pairs:
            pair_text(a.value, pairs, silent, noted)
    return frozenset(found)


def pair_text(e: sp.Expr, pairs: frozenset[sp.Symbol], plain: Language, call: Callable[[str], str]) -> str:
    """The expression as nested calls that return a pair.

    Args:
        e: what to print.
        pairs: symbols that are pairs themselves.
        plain: how to print a double, which counts as exact.
        call: the spelling of a pair function: `exact`, `plus`, `times`, `over`, `root` or `turn_left`.
    """

    def text(part: sp.Expr) -> str:
        return pair_text(part, pairs, plain, call)

    def folded(name: str, parts: Iterable[sp.Expr]) -> str:
        return reduce(lambda a, b: f"{call(name)}({a}, {b})", map(text, parts))

    if e in pairs:
        return e.name
    if isinstance(e, sp.Piecewise):
        # Conditions are plain; only the values are pairs.
        values = {f"value_{k}": text(value) for k, (value, _) in enumerate(e.args)}
        stand_in = sp.Piecewise(*((sp.Symbol(s), c) for s, (_, c) in zip(values, e.args, strict=True)))
        return printed(stand_in, replace(plain, symbol=lambda name: values.get(name) or plain.symbol(name)))
    if isinstance(e, TurnLeft):
        return f"{call('turn_left')}({', '.join(printed(a, plain) for a in e.args)})"
    if e.is_Add:
        return folded("plus", e.as_ordered_terms())
    if e.is_Mul:
        above, below = e.as_numer_denom()
        if below != 1:
            return f"{call('over')}({text(above)}, {text(below)})"
        return folded("times", e.as_ordered_factors())
    if e.is_Pow and e.exp == sp.Rational(1, 2):
        return f"{call('root')}({text(e.base)})"
    if e.is_Pow and e.exp.is_Integer and e.exp > 0:
        return folded("times", [e.base] * int(e.exp))
    if e.is_Pow and e.exp.is_Integer:
        return f"{call('over')}({text(sp.Integer(1))}, {text(1 / e)})"
    return f"{call('exact')}({printed(e, plain)})"
