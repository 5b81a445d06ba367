"""Equations of an effect as MathML, in the letters of its quantities."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from eccentric.effects import Effect
from eccentric.model import Quantity
from eccentric.model import vocabulary as v
from eccentric.presentation.html.formulas import Typesetter, equation, letter, plain

_LEFT = {"mechanical": "Delta tau", "electrical": "Delta u"}
_VOCABULARY = {q.symbol: q for q in vars(v).values() if isinstance(q, Quantity)}
_SIDE = sp.Symbol("S")
"""For the side of a gap that the load is on, which a formula would otherwise repeat."""


def typesetter(effect: Effect) -> Typesetter:
    """Prints what an effect is written in."""
    own = [
        *effect.parameters,
        *(d.quantity for d in effect.change.definitions),
        *(s.quantity for s in effect.change.states),
    ]
    used = set().union(*(e.free_symbols for e in _expressions(effect)))
    return Typesetter([*own, *(_VOCABULARY[s] for s in used if s in _VOCABULARY)])


def equations(effect: Effect) -> Iterator[str]:
    """What the effect adds, replaces or scales, then its definitions and states, each as MathML.

    A definition that only takes the place of a quantity, or only scales, is shown there.
    """
    typeset = typesetter(effect)
    values = {d.symbol: plain(d.value) for d in effect.change.definitions if not d.value.is_number}
    used = set().union(*(e.free_symbols for e in _expressions(effect)))
    inside = {
        new: values[new]
        for new in (*effect.change.replaces.values(), *effect.change.scales.values())
        if new not in used
    }
    for balance, terms in effect.change.terms.items():
        yield equation(typeset, letter(_LEFT[balance]), plain(sp.Add(*(term.value for term in terms))))
    for old, new in effect.change.replaces.items():
        yield equation(typeset, typeset(old), inside.get(new, new), "→")
    for new in dict.fromkeys(effect.change.scales.values()):
        yield equation(typeset, letter("f"), inside.get(new, new) * sp.Symbol("f"), "→")
    named = {s: e for s, e in values.items() if s not in inside}
    updates = {s.symbol: plain(s.update) for s in effect.change.states}
    side = _repeated([*named.values(), *updates.values()])
    for found, sign in ((named, "="), (updates, "←")):
        for symbol, value in found.items():
            yield equation(typeset, typeset(symbol), value.xreplace({side: _SIDE}), sign)
    if side != _SIDE:
        yield equation(typeset, letter(_SIDE.name), side)


def _expressions(effect: Effect) -> list[sp.Expr]:
    """All that is computed with: terms, definitions, updates of states."""
    terms = [term.value for terms in effect.change.terms.values() for term in terms]
    return [*terms, *(d.value for d in effect.change.definitions), *(s.update for s in effect.change.states)]


def _repeated(expressions: list[sp.Expr]) -> sp.Expr:
    """The sign of a sum that occurs more than once; `_SIDE` itself if there is none."""
    signs = [
        x
        for e in expressions
        for x in sp.preorder_traversal(e)
        if isinstance(x, sp.sign) and x.args[0].is_Add
    ]
    return next((x for x in signs if signs.count(x) > 1 and len(x.free_symbols) > 3), _SIDE)
