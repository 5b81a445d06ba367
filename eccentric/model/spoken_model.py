"""A model in the words of its axis: letters, units and meanings, for whoever reads it."""

from __future__ import annotations

from dataclasses import replace

from eccentric.model.axis import TURNING
from eccentric.model.definition import Definition
from eccentric.model.model import Model
from eccentric.model.quantity import Quantity
from eccentric.model.spoken import in_letters_of, spoken_equation, spoken_quantity

__all__ = ["spoken"]


def spoken(model: Model) -> Model:
    """The same model in the words of its axis; nothing computes with it."""
    axis = model.axis
    if axis is TURNING:
        return model
    put = in_letters_of(axis)

    def quantity(q: Quantity) -> Quantity:
        return spoken_quantity(axis, q)

    return replace(
        model,
        title=axis.said(model.title),
        inputs=tuple(map(quantity, model.inputs)),
        parameters=tuple(map(quantity, model.parameters)),
        definitions=tuple(
            Definition(quantity(definition.quantity), put(definition.value))
            for definition in model.definitions
        ),
        balances=tuple(
            replace(
                balance,
                unit=axis.said(balance.unit),
                terms=tuple(
                    replace(term, coefficient=put(term.coefficient), basis=put(term.basis))
                    for term in balance.terms
                ),
            )
            for balance in model.balances
        ),
        equations=tuple(spoken_equation(axis, equation) for equation in model.equations),
        states=tuple(
            replace(
                state,
                quantity=quantity(state.quantity),
                initial=put(state.initial),
                update=put(state.update),
            )
            for state in model.states
        ),
        extensions=(),
        axis=TURNING,
    )
