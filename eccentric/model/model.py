"""Models: inputs, parameters, definitions, balances and the equations that led there. Immutable."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from eccentric.errors import InputError
from eccentric.model.balance import Balance, Term
from eccentric.model.equation import Equation, equation_named
from eccentric.model.quantity import Quantity
from eccentric.model.steps import Gated


@dataclass(frozen=True)
class Definition:
    """A quantity that follows from others."""

    quantity: Quantity
    value: sp.Expr

    @property
    def symbol(self) -> sp.Symbol:
        """The symbol defined."""
        return self.quantity.symbol


@dataclass(frozen=True)
class State:
    """A hidden state, stepped along time by the caller.

    Attributes:
        quantity: its name and unit.
        initial: its value before the first sample.
        update: its value one sample later, in inputs, parameters, definitions, states and the time step dt.
    """

    quantity: Quantity
    initial: sp.Expr
    update: sp.Expr

    @property
    def symbol(self) -> sp.Symbol:
        """The symbol of the state."""
        return self.quantity.symbol


@dataclass(frozen=True)
class Model:
    """What a derivation ends in and what is emitted.

    Attributes:
        name: in code; equals the stem of the derivation.
        title: one line.
        inputs: motor-side inputs; theta_m and omega_m first, alpha_m last.
        parameters: in the order in which code lists them.
        definitions: quantities that follow from others, each after those it uses.
        balances: mechanical and electrical.
        equations: the derivation, in reading order.
        states: hidden states that effects brought along; the paper's models have none.
        defaults: where the parameters' defaults come from, in words; "" for the quantities' own.

    Raises:
        InputError: a definition or term uses what is neither an input nor a parameter nor defined before it.
    """

    name: str
    title: str
    inputs: tuple[Quantity, ...]
    parameters: tuple[Quantity, ...]
    definitions: tuple[Definition, ...]
    balances: tuple[Balance, ...]
    equations: tuple[Equation, ...] = ()
    states: tuple[State, ...] = ()
    defaults: str = ""

    def __post_init__(self) -> None:
        states = (state.quantity for state in self.states)
        known = {q.symbol for q in (*self.inputs, *self.parameters, *states)}
        for definition in self.definitions:
            if unknown := definition.value.free_symbols - known:
                names = ", ".join(sorted(map(str, unknown)))
                raise InputError(
                    f"model {self.name}: {definition.quantity.name} uses {names} before its definition"
                )
            known.add(definition.symbol)
        for balance in self.balances:
            for term in balance.terms:
                if unknown := term.value.free_symbols - known:
                    names = ", ".join(sorted(map(str, unknown)))
                    raise InputError(
                        f"model {self.name}: term {term.name} uses {names}, which nothing defines"
                    )

    @cached_property
    def parameter_symbols(self) -> frozenset[sp.Symbol]:
        """Symbols that depend on parameters only, definitions among them included."""
        found = {quantity.symbol for quantity in self.parameters}
        for definition in self.definitions:
            if definition.value.free_symbols <= found:
                found.add(definition.symbol)
        return frozenset(found)

    def balance(self, name: str) -> Balance:
        """The balance of that name; KeyError if there is none."""
        return {balance.name: balance for balance in self.balances}[name]

    def definition(self, name: str) -> Definition:
        """The definition of the quantity of that name; KeyError if there is none."""
        return {definition.quantity.name: definition for definition in self.definitions}[name]

    def equation(self, name: str) -> Equation:
        """The equation of that name; KeyError if there is none."""
        return equation_named(self.equations, name)

    def expand(self, expression: sp.Expr) -> sp.Expr:
        """The expression with definitions put in for defined quantities, down to inputs and parameters."""
        for definition in reversed(self.definitions):
            expression = expression.xreplace({definition.symbol: definition.value})
        return expression

    def units(self) -> dict[sp.Symbol, str]:
        """The unit of every symbol of the model."""
        named = (*self.inputs, *self.parameters, *(d.quantity for d in self.definitions))
        named = (*named, *(state.quantity for state in self.states))
        return {quantity.symbol: quantity.unit for quantity in named}

    def __str__(self) -> str:
        """The derivation for a terminal, equation by equation."""
        heading = f"{self.title}\n{'=' * len(self.title)}"
        return "\n\n".join([heading, *(equation.text() for equation in self.equations)])

    def latex(self) -> str:
        """The derivation in LaTeX, equation by equation."""
        return "\n\n".join(
            [rf"\section*{{{self.title}}}", *(equation.latex() for equation in self.equations)]
        )


@dataclass(frozen=True)
class Column:
    """A column of the regressor: one identifiable coefficient of friction and what it multiplies.

    Attributes:
        name: of the coefficient, e.g. "B_lN", or "B" for B_m + mu^2 beta_T, which one log cannot tell apart.
        coefficient: its value in the model's parameters.
        basis: the column.
        unit: of the coefficient.
        bounds: of the coefficient.
    """

    name: str
    coefficient: sp.Expr
    basis: sp.Expr
    unit: str
    bounds: tuple[float | None, float | None]


def regressor(model: Model) -> tuple[Column, ...]:
    """The columns that span the mechanical friction torque.

    No log can tell terms apart whose bases differ by a factor of parameters only; they are one column, on the
    plainest of their bases. Which ones those are is computed from the expressions, never declared.

    Raises:
        InputError: the coefficient of a friction term is no parameter, or a combination has no name.
    """
    groups: list[list[Term]] = []
    for term in model.balance("mechanical").terms:
        if term.kind != "friction":
            continue
        for group in groups:
            if _ratio(term.basis, group[0].basis).free_symbols <= model.parameter_symbols:
                group.append(term)
                break
        else:
            groups.append([term])
    return tuple(_column(model, group) for group in groups)


def _ratio(one: sp.Expr, other: sp.Expr) -> sp.Expr:
    """One basis by the other; a gate that both have cancels."""
    return one.replace(Gated, sp.Mul) / other.replace(Gated, sp.Mul)


def _column(model: Model, group: list[Term]) -> Column:
    known = {quantity.symbol: quantity for quantity in model.parameters}
    for term in group:
        if term.coefficient not in known:
            raise InputError(
                f"model {model.name}: term {term.name}: required a parameter as coefficient of friction,"
                f" received {term.coefficient}"
            )
    if len(group) == 1:
        (term,) = group
        quantity = known[term.coefficient]
        return Column(quantity.name, term.coefficient, term.basis, quantity.unit, term.bounds)
    basis = min((term.basis for term in group), key=sp.count_ops)
    coefficient = sp.Add(*(term.coefficient * _ratio(term.basis, basis) for term in group))
    lows = [term.bounds[0] for term in group if term.bounds[0] is not None]
    low = sum(lows) if len(lows) == len(group) else None
    for definition in model.definitions:
        if sp.expand(definition.value - coefficient) == 0:
            quantity = definition.quantity
            return Column(quantity.name, definition.symbol, basis, quantity.unit, (low, None))
    names = ", ".join(term.name for term in group)
    raise InputError(
        f"model {model.name}: terms {names}: no log tells them apart; define a quantity for {coefficient}"
    )
