"""Parameters beyond double precision: which prepared values are computed as pairs of doubles, and how.

A pair is an unevaluated sum, high + low, good for some 104 bits. What ends in a low part (the critical
velocity, the period of the motor angle) is computed so from the parameters on: near the hollow the leading
digits of speed and angle cancel against it, and what is left hangs on the digits after them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import reduce

import sympy as sp

from eccentric.emit.expression import Language, printed
from eccentric.emit.primitive import Low, TurnLeft
from eccentric.emit.program import Assignment


def paired(prepare: Iterable[Assignment]) -> frozenset[sp.Symbol]:
    """The targets computed as pairs: those whose low part is asked for, and what they follow from."""
    values = {a.target: a.value for a in prepare}
    found: set[sp.Symbol] = set()
    waiting = {e.args[0] for value in values.values() for e in value.atoms(Low)}
    while waiting:
        symbol = waiting.pop()
        found.add(symbol)
        waiting |= (values[symbol].free_symbols & set(values)) - found
        waiting -= {s for e in values[symbol].atoms(TurnLeft) for s in e.free_symbols}
    return frozenset(found)


def pair_functions(prepare: Iterable[Assignment]) -> frozenset[str]:
    """The names of the pair functions that `pair_text` calls for these assignments, besides `exact`."""
    found: set[str] = set()

    def noted(name: str) -> str:
        found.add(name)
        return name

    prepare = tuple(prepare)
    pairs = paired(prepare)
    silent = Language(str, str, lambda *_: "", lambda *_: "", lambda _: "")
    for a in prepare:
        if a.target in pairs:
            pair_text(a.value, pairs, silent, noted)
    return frozenset(found)


def pair_text(e: sp.Expr, pairs: frozenset[sp.Symbol], plain: Language, call: Callable[[str], str]) -> str:
    """The expression as nested calls that return a pair.

    Args:
        e: what to print.
        pairs: symbols that are pairs themselves.
        plain: how to print what is a double and counts as exact.
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
