"""Extensions: how a model is changed by something that it omits, independently of the order of several.

A change has three parts: what it adds, what it replaces, and what it scales. Addition commutes. Replacing and
scaling are rules rather than single operations: the model remembers them and applies them to what later
extensions add as well. Hence the order of extensions makes no difference:

- a scale factor multiplies every friction term of its role, including those of other extensions;
- a quantity is replaced everywhere, including in the terms, definitions and states of other extensions;
- an extension's own parts are taken as written: M_true = M (1 + r) keeps its M.

Two extensions that introduce the same name, or replace the same quantity, are refused.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import sympy as sp

from eccentric.core import InputError
from eccentric.model import vocabulary as v
from eccentric.model.balance import Balance, Term
from eccentric.model.model import Change, Extension, Model
from eccentric.model.quantity import Definition, Quantity


def extended(model: Model, new: Extension) -> Model:
    """The model with one more extension; several give the same model in any order.

    Raises:
        InputError: the model already has this extension, or one that introduces the same name or replaces the
            same quantity; it lacks a quantity to replace or a balance to add terms to; or definitions would
            use each other in a circle.
    """
    _require_free_names(model, new)
    _require_replaceable(model, new)
    if unknown := sorted(set(new.change.terms) - {balance.name for balance in model.balances}):
        raise InputError(new.name, problem=f"expected a balance {unknown[0]!r}, but {model.name} has none")
    definitions, states, terms = new.change.definitions, new.change.states, dict(new.change.terms)
    for there in (extension.change for extension in model.extensions):
        definitions = tuple(map(there.reach_definition, definitions))
        states = tuple(map(there.reach_state, states))
        terms = {name: tuple(map(there.reach_term, added)) for name, added in terms.items()}
    inputs = sorted({q.symbol: q for q in (*new.change.inputs, *model.inputs)}.values(), key=_place)
    parameters = (*model.parameters, *new.parameters)
    states = (*map(new.change.reach_state, model.states), *states)
    definitions = (*definitions, *map(new.change.reach_definition, model.definitions))
    known = {q.symbol for q in (*inputs, *parameters, *(state.quantity for state in states))}
    names = " and ".join(sorted(e.name for e in (*model.extensions, new)))
    return replace(
        model,
        inputs=tuple(inputs),
        parameters=parameters,
        definitions=_ordered(definitions, known, f"{model.name} with {names}"),
        balances=tuple(_balance(b, new.change, terms.get(b.name, ())) for b in model.balances),
        states=states,
        equations=(*model.equations, *new.equations),
        extensions=(*model.extensions, new),
    )


def _balance(balance: Balance, change: Change, added: Iterable[Term]) -> Balance:
    return replace(balance, terms=(*map(change.reach_term, balance.terms), *added))


def _require_free_names(model: Model, new: Extension) -> None:
    for other in model.extensions:
        if other.name == new.name:
            raise InputError(new.name, problem=f"is already in {model.name}")
        if both := sorted(other.names & new.names):
            first, second = sorted((other.name, new.name))
            raise InputError(f"{first} and {second}", problem=f"both introduce {', '.join(both)}")
    own = (*model.definitions, *model.states)
    taken = {q.name for q in (*model.parameters, *model.inputs, *(x.quantity for x in own))}
    if clash := sorted(new.names & taken):
        raise InputError(
            new.name, problem=f"{', '.join(clash)}: {model.name} already has a quantity of that name"
        )


def _require_replaceable(model: Model, new: Extension) -> None:
    for other in model.extensions:
        if both := sorted(map(str, set(other.change.replaces) & set(new.change.replaces))):
            first, second = sorted((other.name, new.name))
            raise InputError(f"{first} and {second}", problem=f"both replace {', '.join(both)}")
    brought = {name for extension in model.extensions for name in extension.names}
    added = {term.name for e in model.extensions for terms in e.change.terms.values() for term in terms}
    used = set().union(
        *(d.value.free_symbols for d in model.definitions if d.quantity.name not in brought),
        *(t.value.free_symbols for b in model.balances for t in b.terms if t.name not in added),
    )
    if absent := sorted(map(str, set(new.change.replaces) - used)):
        raise InputError(new.name, problem=f"{absent[0]} does not occur in {model.name}")


_INPUTS = (v.theta_m, v.omega_m, v.i, v.u, v.t, v.temperature)


def _place(quantity: Quantity) -> int:
    """The place of an input: as in the vocabulary, alpha_m last."""
    if quantity.symbol == v.alpha_m.symbol:
        return len(_INPUTS) + 1
    known = [q.symbol for q in _INPUTS]
    return known.index(quantity.symbol) if quantity.symbol in known else len(_INPUTS)


def _ordered(definitions: Iterable[Definition], known: set[sp.Symbol], whose: str) -> tuple[Definition, ...]:
    """The definitions, each after those it uses."""
    waiting, done = list(definitions), []
    while waiting:
        ready = next((d for d in waiting if d.value.free_symbols <= known), None)
        if ready is None:
            names = ", ".join(sorted(d.quantity.name for d in waiting))
            raise InputError(whose, problem=f"{names} use each other in a circle, or something unknown")
        waiting.remove(ready)
        done.append(ready)
        known.add(ready.symbol)
    return tuple(done)
