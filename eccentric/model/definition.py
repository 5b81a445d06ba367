"""Quantities that follow from others: at once (a definition), or from one time step to the next (a state)."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from eccentric.model.quantity import Quantity


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
