"""What a model is changed by: terms that are added, quantities that are replaced, friction that is scaled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import sympy as sp

from eccentric.model.balance import Term
from eccentric.model.definition import Definition, State
from eccentric.model.equation import Equation
from eccentric.model.quantity import Quantity
from eccentric.model.role import Role


@dataclass(frozen=True)
class Change:
    """What is changed in a model.

    Attributes:
        terms: name of balance -> terms added to it; a coefficient may enter both balances.
        definitions: quantities that it brings along, each after those it uses.
        states: hidden states that it brings along.
        inputs: inputs that it takes, of the vocabulary; those that the model has already may be among them.
        replaces: symbol of the model -> symbol of one of `definitions`, to be used in its place.
        scales: role -> symbol of one of `definitions` that multiplies the friction terms of that role.
    """

    terms: Mapping[str, tuple[Term, ...]] = field(default_factory=dict)
    definitions: tuple[Definition, ...] = ()
    states: tuple[State, ...] = ()
    inputs: tuple[Quantity, ...] = ()
    replaces: Mapping[sp.Symbol, sp.Symbol] = field(default_factory=dict)
    scales: Mapping[Role, sp.Symbol] = field(default_factory=dict)

    def reach_term(self, term: Term) -> Term:
        """A term of somebody else under the rules of this change."""
        basis = term.basis * self.scales[term.role] if term.role in self.scales else term.basis
        coefficient, basis = (part.xreplace(dict(self.replaces)) for part in (term.coefficient, basis))
        return replace(term, coefficient=coefficient, basis=basis)

    def reach_definition(self, definition: Definition) -> Definition:
        """A definition of somebody else under the rules of this change."""
        return replace(definition, value=definition.value.xreplace(dict(self.replaces)))

    def reach_state(self, state: State) -> State:
        """A hidden state of somebody else under the rules of this change."""
        return replace(state, update=state.update.xreplace(dict(self.replaces)))


@dataclass(frozen=True)
class Extension:
    """A change with its name, its parameters and its steps of the derivation.

    Attributes:
        name: in messages.
        change: what it changes.
        parameters: that it brings along, with their defaults.
        equations: its steps of the derivation.
    """

    name: str
    change: Change
    parameters: tuple[Quantity, ...] = ()
    equations: tuple[Equation, ...] = ()

    @property
    def names(self) -> frozenset[str]:
        """Names of the parameters, definitions and states that it brings along."""
        own = (*self.change.definitions, *self.change.states)
        return frozenset(q.name for q in (*self.parameters, *(x.quantity for x in own)))
