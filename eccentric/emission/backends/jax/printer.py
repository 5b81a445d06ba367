"""JAX as a language of expressions: how operations are spelled in kernels, and in `_prepare`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

import sympy as sp

from eccentric.emission.backends.expression import Language, printed
from eccentric.emission.backends.text import number
from eccentric.emission.program import ROUNDER, Call, Minus, Over, Pick, Plus, Program, Times, TurnLeft

KERNEL = {
    "sqrt": "_sqrt({0})",
    "fabs": "abs({0})",
    "sgn": "jnp.sign({0})",
    "forward": "jnp.heaviside({0}, 0.0)",
    "backward": "jnp.heaviside(-({0}), 0.0)",
    "exp": "jnp.exp({0})",
    "at_most": "jnp.minimum({0}, {1})",
    "within": "jnp.clip({0}, -{1}, {1})",
    "in_single": "{0} if c.single else {1}",
    "sine_ratio": "_sine_ratio({0})",
    "cosine": "_cosine({0})",
    "rounded_off": "jnp.round({0})",
    "nonzero": "_nonzero({0})",
}
PREPARE = {
    "sqrt": "_sqrt({0})",
    "fabs": "abs({0})",
    "sin": "_math({0}).sin({0})",
    "cos": "_math({0}).cos({0})",
    "exp": "_math({0}).exp({0})",
    "rounded": "c.rounded({0})",
    "leading": "c.leading({0})",
    "in_single": "{0} if c.single else {1}",
}


def language(
    calls: Mapping[str, str], symbol: Callable[[str], str], pair: Callable[[str], str] = str
) -> Language:
    """JAX with `calls` as above, `symbol` the spelling of names and `pair` of those that are pairs."""

    def branches(pairs: list[tuple[str, str]]) -> str:
        text = pairs[-1][0]
        for value, condition in reversed(pairs[:-1]):
            text = f"_choose({condition}, {value}, {text})"
        return text

    return Language(
        symbol=symbol,
        low=lambda name: f"{pair(name)}.low",
        number=number,
        call=lambda name, arguments: calls[name].format(*arguments),
        pick=lambda a, relation, b, x, y: f"jnp.where({a} {relation} {b}, {x}, {y})",
        branches=branches,
    )


def differentiable(program: Program) -> Program:
    """The program with kernels that JAX compiles and differentiates; their values are the same.

    Rounding by adding and subtracting one number, which XLA would cancel, is a call. A branch that is not
    taken never divides by 0, since derivatives would propagate the result. And a missing parameter needs no
    gate: no function that reads it is called without it.
    """

    def rewritten(parts: Iterable[Any]) -> tuple[Any, ...]:
        return tuple(
            replace(p, assignments=tuple(replace(a, value=_smooth(a.value)) for a in p.assignments))
            for p in parts
        )

    return replace(program, helpers=rewritten(program.helpers), routines=rewritten(program.routines))


def _smooth(e: sp.Expr) -> sp.Expr:
    e = e.func(*map(_smooth, e.args)) if e.args else e
    if isinstance(e, Minus) and e.args[1] == ROUNDER and isinstance(e.args[0], Plus):
        return Call(sp.Symbol("rounded_off"), e.args[0].args[0])
    if isinstance(e, Pick) and e.args[1].name == "==" and e.args[2] == 0:
        by, _, _, x, y = e.args
        if (x, y) == (1, Over(1, by)):
            return Over(1, Call(sp.Symbol("nonzero"), by))
        if x == 0 and isinstance(y, Times) and y.args[1] == by:
            return y
    return e


def pair(e: sp.Expr, pairs: frozenset[sp.Symbol], plain: Language, name: Callable[[str], str]) -> str:
    """The expression as a formula of pairs.

    Args:
        e: what to print.
        pairs: the symbols that are pairs.
        plain: how to print what is a float and counts as exact.
        name: the spelling of a pair.
    """
    if isinstance(e, sp.Piecewise):
        # Conditions are plain; only the values are pairs.
        values = {f"value_{k}": pair(value, pairs, plain, name) for k, (value, _) in enumerate(e.args)}
        choice = sp.Piecewise(*((sp.Symbol(s), c) for s, (_, c) in zip(values, e.args, strict=True)))
        return printed(choice, replace(plain, symbol=lambda s: values.get(s) or plain.symbol(s)))
    inner = {
        part: f"_turn_less({', '.join(printed(a, plain) for a in part.args)})"
        if isinstance(part, TurnLeft)
        else f"_pair({printed(part, plain)})"
        for part in e.atoms(sp.Function)
    }
    spelled = {text: text for text in inner.values()} | {s.name: name(s.name) for s in pairs}
    spelling = replace(
        plain,
        symbol=lambda s: spelled.get(s) or f"_pair({plain.symbol(s)})",
        number=lambda decimal: f"_pair({number(decimal)})",
    )
    return printed(e.xreplace({part: sp.Symbol(text) for part, text in inner.items()}), spelling)
