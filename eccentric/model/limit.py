"""Limiting cases of a model: substitute parameters, replace definitions, drop zero parts; dimensions."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

import sympy as sp

from eccentric.model import steps
from eccentric.model import vocabulary as v
from eccentric.model.balance import Equation, Term
from eccentric.model.model import Model
from eccentric.model.quantity import Definition, Quantity
from eccentric.model.steps import Gated

_KEPT = frozenset({v.F_N.symbol, v.B.symbol, v.C.symbol})
"""Definitions that are always emitted, even if no term uses them."""


def limit(
    model: Model,
    name: str,
    title: str,
    substitutions: Mapping[sp.Symbol, sp.Expr],
    definitions: Mapping[Quantity, sp.Expr],
    equations: tuple[Equation, ...],
) -> Model:
    """The model with parameters substituted, definitions replaced, and zero or unused parts dropped.

    Args:
        model: the general model.
        name, title: of the result.
        substitutions: parameter symbol -> value.
        definitions: quantity -> its simpler definition in this limit; new ones come last.
        equations: the derivation of the limit.

    Raises:
        InputError: by Model, if a definition refers to something unknown.
    """
    known = {definition.quantity: definition.value for definition in model.definitions} | dict(definitions)
    values = [Definition(q, sp.sympify(value).subs(substitutions)) for q, value in known.items()]
    # Definitions that became 0, or a second name for a symbol, are substituted.
    trivial = {d.symbol: d.value for d in values if d.value.is_number or d.value.is_Symbol}
    values = [Definition(d.quantity, d.value.subs(trivial)) for d in values if d.symbol not in trivial]
    balances = []
    for balance in model.balances:
        terms = [replace(term, basis=term.basis.subs(substitutions).subs(trivial)) for term in balance.terms]
        balances.append(replace(balance, terms=tuple(term for term in terms if term.basis != 0)))
    return prune(
        replace(
            model,
            name=name,
            title=title,
            definitions=tuple(values),
            balances=tuple(balances),
            equations=equations,
        )
    )


def prune(model: Model) -> Model:
    """The model without inputs, parameters and definitions that neither terms nor `_KEPT` use."""
    needed = {d.symbol for d in model.definitions if d.symbol in _KEPT}
    needed = needed.union(*(t.value.free_symbols for b in model.balances for t in b.terms))
    for definition in reversed(model.definitions):
        if definition.symbol in needed:
            needed |= definition.value.free_symbols
    for quantity in model.parameters:
        if quantity.symbol in needed and quantity.default is not None:
            needed |= quantity.default.free_symbols
    return replace(
        model,
        inputs=tuple(q for q in model.inputs if q.symbol in needed),
        parameters=tuple(q for q in model.parameters if q.symbol in needed),
        definitions=tuple(d for d in model.definitions if d.symbol in needed),
    )


def directed(
    model: Model, name: str, title: str, gates: Mapping[str, sp.Expr], equations: tuple[Equation, ...]
) -> Model:
    """The model with one set of friction coefficients for each direction of motion.

    Args:
        model: the symmetric model.
        name, title, equations: of the result.
        gates: direction ("pos", "neg") -> expression that is 1 in that direction and 0 otherwise.
    """
    renamed = {q.symbol: {d: v.directed(q, d) for d in gates} for q in model.friction_parameters}
    swaps = {d: {old: new[d].symbol for old, new in renamed.items()} for d in gates}

    def directed_terms(term: Term) -> list[Term]:
        if term.kind != "friction":
            return [term]
        return [
            replace(
                term,
                name=f"{term.name}_{d}",
                basis=Gated(term.basis, gate),
                coefficient=swaps[d][term.coefficient],
            )
            for d, gate in gates.items()
        ]

    def directed_definitions(x: Definition) -> list[Definition]:
        if not x.value.free_symbols & set(renamed):
            return [x]
        return [Definition(v.directed(x.quantity, d), x.value.subs(swaps[d])) for d in gates]

    mechanical = model.balance("mechanical")
    split = replace(mechanical, terms=tuple(t for term in mechanical.terms for t in directed_terms(term)))
    return replace(
        model,
        name=name,
        title=title,
        parameters=tuple(x for q in model.parameters for x in renamed.get(q.symbol, {"": q}).values()),
        definitions=tuple(d for x in model.definitions for d in directed_definitions(x)),
        balances=tuple(split if b.name == "mechanical" else b for b in model.balances),
        equations=equations,
    )


# Dimensions: the SI exponents of a unit and of an expression, to check equations against units.

# kg, m, s, A, K; radians and revolutions are pure numbers.
_BASE = {
    "1": (0, 0, 0, 0, 0), "rad": (0, 0, 0, 0, 0), "radian": (0, 0, 0, 0, 0),
    "kg": (1, 0, 0, 0, 0), "m": (0, 1, 0, 0, 0),
    "s": (0, 0, 1, 0, 0), "A": (0, 0, 0, 1, 0), "K": (0, 0, 0, 0, 1), "N": (1, 1, -2, 0, 0),
    "J": (1, 2, -2, 0, 0), "W": (1, 2, -3, 0, 0), "V": (1, 2, -3, -1, 0), "Ohm": (1, 2, -3, -2, 0),
}  # fmt: skip

Dimension = tuple[sp.Rational, ...]
PURE: Dimension = (sp.Integer(0),) * 5


def of_unit(unit: str) -> Dimension:
    """SI exponents (kg, m, s, A, K) of a unit such as "N m s/rad".

    Raises:
        ValueError: a factor of the unit is unknown.
    """
    total = list(PURE)
    for place, side in enumerate(unit.split("/")):
        sign = -1 if place else 1
        for factor in side.strip(" ()").split():
            match = re.fullmatch(r"([A-Za-z]+|1)(?:\^(-?\d+))?", factor)
            if match is None or match[1] not in _BASE:
                raise ValueError(f"unit {unit!r}: unknown factor {factor!r}; known are {', '.join(_BASE)}")
            power = sign * int(match[2] or 1)
            total = [old + power * new for old, new in zip(total, _BASE[match[1]], strict=True)]
    return tuple(total)


def of_expression(expression: sp.Basic, units: Mapping[sp.Symbol, str]) -> Dimension:
    """SI exponents of an expression; `units` gives the unit of every symbol in it.

    Raises:
        ValueError: addends of different dimension, or a pure number required and something else given.
    """
    expression = sp.sympify(expression)
    if isinstance(expression, sp.Symbol):
        return of_unit(units[expression])
    if expression.is_number:
        return PURE
    if isinstance(expression, sp.Pow):
        base = of_expression(expression.base, units)
        return tuple(exponent * sp.Rational(expression.exp) for exponent in base)
    parts = [of_expression(argument, units) for argument in _values(expression)]
    if isinstance(expression, sp.Mul | steps.Gated):
        return tuple(sum(column, sp.Integer(0)) for column in zip(*parts, strict=True))
    if isinstance(expression, sp.Abs | steps.Bounded | steps.Leading):
        return parts[0]
    if isinstance(expression, steps.SquareDifference):
        _same(expression, parts)
        return tuple(2 * exponent for exponent in parts[0])
    if isinstance(expression, sp.Piecewise):
        # A bare number stands for a missing physical value (the critical velocity of a balanced mass).
        return _same(
            expression,
            [p for p, value in zip(parts, _values(expression), strict=True) if not value.is_number],
        )
    if isinstance(expression, sp.Add | sp.Max | sp.Min | steps.Magnitude):
        return _same(expression, parts)
    if isinstance(expression, steps.Along | steps.Across):
        _same(expression, parts)
        return PURE
    # The rest are functions of a number: trigonometric ones, the sign, the half-turn cosine, exp.
    for part, value in zip(parts, _values(expression), strict=True):
        if part != PURE and not isinstance(
            expression, sp.sign | sp.Heaviside | steps.Sgn | steps.Forward | steps.Backward
        ):
            raise ValueError(f"{value} in {expression}: expected a pure number")
    return PURE


def _values(expression: sp.Basic) -> list[sp.Basic]:
    if isinstance(expression, sp.Piecewise):
        return [branch.expr for branch in expression.args]
    return list(expression.args)


def _same(expression: sp.Basic, parts: list[Dimension]) -> Dimension:
    if len(set(parts)) > 1:
        raise ValueError(f"addends of different dimension in {expression}")
    return parts[0] if parts else PURE
