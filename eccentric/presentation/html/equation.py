"""The friction of a model as MathML, one term to a line, and the definitions of its letters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

import sympy as sp

from eccentric.model import KINDS, TURNING, AxisKind, Definition, Model, OpaqueStep, Term
from eccentric.model import vocabulary as v
from eccentric.presentation.html.data import Formula
from eccentric.presentation.html.formulas import Typesetter, aligned, equation, letter, plain

_ADDED = {
    "mechanical": ("Delta tau", "{torque} of the drive in addition to friction [{N m}{, motor side}]"),
    "electrical": ("Delta u", "voltage in addition to that of the armature [V]"),
}
_MOTOR_SIDE = {
    link.symbol: v.mu.symbol * motor.symbol
    for link, motor in ((v.theta_l, v.theta_m), (v.omega_l, v.omega_m), (v.alpha_l, v.alpha_m))
}


def typesetter_of(model: Model) -> Typesetter:
    """A printer of the expressions of a model, in its letters."""
    followed = [*(d.quantity for d in model.definitions), *(s.quantity for s in model.states)]
    return Typesetter([*model.inputs, *model.parameters, *followed])


def friction_equations(model: Model, effects: Sequence[Any], axis: AxisKind = TURNING) -> list[Formula]:
    """Friction torque of a model, what effects add to other terms, and the definitions both use.

    Args:
        model: with the effects in it, under the names of the axis.
        effects: those in it; their terms are marked (class "added").
    """
    own = {term.name for effect in effects for terms in effect.change.terms.values() for term in terms}
    typeset = typesetter_of(model)
    friction = [term for term in model.balance("mechanical").terms if term.kind == "friction"]
    shown = [
        _sum(
            typeset,
            "f",
            [(term, 1) for term in friction],
            own,
            axis.filled("friction {torque} [{N m}{, motor side}]"),
        )
    ]
    used = [term.value for term in friction]
    for there in model.balances:
        others = [term for term in there.terms if term.name in own and term not in friction]
        if others:
            left, note = _ADDED[there.name]
            shown.append(
                _sum(typeset, left, [(term, -KINDS[term.kind]) for term in others], own, axis.filled(note))
            )
            used += [term.value for term in others]
    replaced = {old: new for effect in effects for old, new in effect.change.replaces.items()}
    used += [new for effect in effects for new in effect.change.replaces.values()]
    return [*shown, *_definitions(typeset, model, used, replaced, axis)]


def _sum(
    typeset: Typesetter, left: str, terms: Iterable[tuple[Term, int]], own: set[str], note: str
) -> Formula:
    """One line for each term."""
    lines, marked = [], []
    for k, (term, sign) in enumerate(terms):
        ((minus, body),) = typeset.terms(sp.Mul(plain(sign * term.value)))
        start = "" if k else f"{letter(left)}<mo>=</mo>"
        lines.append((start, minus or ("<mo>+</mo>" if k else ""), body))
        marked += [k] if term.name in own else []
    return Formula(aligned(lines, marked), note)


def _definitions(
    typeset: Typesetter,
    model: Model,
    used: Sequence[sp.Expr],
    replaced: Mapping[sp.Symbol, sp.Symbol],
    axis: AxisKind,
) -> list[Formula]:
    """The definitions of the letters in expressions, down to inputs and parameters."""
    known = {d.symbol: d for d in model.definitions}
    waiting = sorted(set().union(*(e.free_symbols for e in used)) & set(known), key=str)
    theta_l, theta_m = v.theta_l.symbol, v.mu.symbol * v.theta_m.symbol
    shown: list[Formula] = []
    expressions = [plain(e) for e in used]
    done: set[sp.Symbol] = set()
    numbers: list[Definition] = []
    while waiting:
        symbol = waiting.pop(0)
        if symbol in done:
            continue
        done.add(symbol)
        if known[symbol].value.is_number:
            numbers.append(known[symbol])
            continue
        left, right = _own_form(model, symbol, replaced) or (symbol, known[symbol].value)
        waiting += sorted((right.free_symbols & set(known)) - done, key=str)
        expressions.append(plain(right))
        quantity = known[symbol].quantity
        body = equation(typeset, typeset(left), expressions[-1])
        shown.append(Formula(body, f"{quantity.meaning} [{quantity.unit}]"))
    if numbers:
        rows = ((typeset(d.symbol), f"<mo>=</mo>{typeset(plain(d.value))}", _unit(d)) for d in numbers)
        shown.append(Formula(aligned(rows), "; ".join(d.quantity.meaning for d in numbers)))
    if any(e.has(theta_l) for e in expressions):
        body = equation(typeset, typeset(theta_l), theta_m)
        shown.append(Formula(body, axis.text(f"{v.theta_l.meaning} [{v.theta_l.unit}]")))
    return shown


def _unit(definition: Definition) -> str:
    unit = definition.quantity.unit
    return "" if unit == "1" else f"<mtext>{escape(unit)}</mtext>"


def _own_form(
    model: Model, symbol: sp.Symbol, replaced: Mapping[sp.Symbol, sp.Symbol]
) -> tuple[sp.Expr, sp.Expr] | None:
    """The derivation's own formula of a quantity or its square, with the quantities that effects replace."""
    inputs = {q.symbol for q in (*model.inputs, *model.parameters)}
    for step in model.equations:
        left, right = step.left, step.right
        if left not in (symbol, symbol**2) or not isinstance(right, sp.Expr) or right.has(OpaqueStep):
            continue
        right = right.subs(_MOTOR_SIDE)
        if right.free_symbols <= inputs:
            return left, right if symbol in replaced.values() else right.xreplace(dict(replaced))
    return None
