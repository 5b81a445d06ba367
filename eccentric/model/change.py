"""Changes of a model: terms to add, quantities to replace, friction to scale."""

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
    """A change of a model.

    Attributes:
        terms: name of balance -> terms added to it; a coefficient may enter both balances.
        definitions: quantities that it introduces, each after those it uses.
        states: hidden states that it introduces.
        inputs: inputs that it uses, from the vocabulary; the model may already have some of them.
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
        """A term from elsewhere under the rules of this change."""
        basis = term.basis * self.scales[term.role] if term.role in self.scales else term.basis
        coefficient, basis = (part.xreplace(dict(self.replaces)) for part in (term.coefficient, basis))
        return replace(term, coefficient=coefficient, basis=basis)

    def reach_definition(self, definition: Definition) -> Definition:
        """A definition from elsewhere under the rules of this change."""
        return replace(definition, value=definition.value.xreplace(dict(self.replaces)))

    def reach_state(self, state: State) -> State:
        """A hidden state from elsewhere under the rules of this change."""
        return replace(state, update=state.update.xreplace(dict(self.replaces)))


@dataclass(frozen=True)
class Extension:
    """A change with its name, its parameters and its steps in the derivation.

    Attributes:
        name: in messages.
        change: what it changes.
        parameters: those that it introduces, with their defaults.
        equations: its steps in the derivation.
    """

    name: str
    change: Change
    parameters: tuple[Quantity, ...] = ()
    equations: tuple[Equation, ...] = ()

    @property
    def names(self) -> frozenset[str]:
        """Names of the parameters, definitions and states that it introduces."""
        own = (*self.change.definitions, *self.change.states)
        return frozenset(q.name for q in (*self.parameters, *(x.quantity for x in own)))
