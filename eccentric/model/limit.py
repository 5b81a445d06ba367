"""Limits of a model: substitute parameters, replace definitions, drop vanishing parts. Such are C1 and C2."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import sympy as sp

from eccentric.model import vocabulary as v
from eccentric.model.balance import Balance, Term
from eccentric.model.definition import Definition
from eccentric.model.equation import Equation
from eccentric.model.model import Model
from eccentric.model.quantity import Quantity
from eccentric.model.steps import Gated

_KEPT = frozenset({v.F_N.symbol, v.B.symbol, v.C.symbol})
"""Definitions that are always emitted, even if no term needs them."""


def limit(
    model: Model,
    name: str,
    title: str,
    substitutions: Mapping[sp.Symbol, sp.Expr],
    definitions: Mapping[Quantity, sp.Expr],
    equations: tuple[Equation, ...],
) -> Model:
    """The model with parameters set to values, definitions replaced, and vanishing or unused parts dropped.

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
    # What became 0, or a second name for a symbol, is substituted: terms and code do not keep it.
    plain = {d.symbol: d.value for d in values if d.value.is_number or d.value.is_Symbol}
    values = [Definition(d.quantity, d.value.subs(plain)) for d in values if d.symbol not in plain]
    balances = []
    for balance in model.balances:
        terms = [replace(term, basis=term.basis.subs(substitutions).subs(plain)) for term in balance.terms]
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
    """The model without the inputs, parameters and definitions that neither terms nor `_KEPT` need."""
    needed: set[sp.Symbol] = set()
    for balance in model.balances:
        for term in balance.terms:
            needed |= term.value.free_symbols
    needed |= {d.symbol for d in model.definitions if d.symbol in _KEPT}
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
    terms: list[Term] = []
    for term in model.balance("mechanical").terms:
        if term.kind != "friction":
            terms.append(term)
            continue
        for direction, gate in gates.items():
            terms.append(
                replace(
                    term,
                    name=f"{term.name}_{direction}",
                    basis=Gated(term.basis, gate),
                    coefficient=renamed[term.coefficient][direction].symbol,
                )
            )
    parameters: list[Quantity] = []
    for quantity in model.parameters:
        parameters.extend(renamed[quantity.symbol].values() if quantity.symbol in renamed else [quantity])
    definitions: list[Definition] = []
    for definition in model.definitions:
        if definition.value.free_symbols & set(renamed):
            for direction in gates:
                swap = {old: new[direction].symbol for old, new in renamed.items()}
                definitions.append(
                    Definition(v.directed(definition.quantity, direction), definition.value.subs(swap))
                )
        else:
            definitions.append(definition)
    mechanical = replace(model.balance("mechanical"), terms=tuple(terms))
    balances: tuple[Balance, ...] = tuple(mechanical if b.name == "mechanical" else b for b in model.balances)
    return replace(
        model,
        name=name,
        title=title,
        parameters=tuple(parameters),
        definitions=tuple(definitions),
        balances=balances,
        equations=equations,
    )
