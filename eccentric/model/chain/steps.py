"""The recursion as a list of named scalars: each value is written once, what is trivial gets no name."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from eccentric.model.chain.motion import AXES
from eccentric.model.definition import Definition
from eccentric.model.quantity import quantity


class Steps:
    """Ordered definitions; called, it names a value and returns what stands for it."""

    def __init__(self) -> None:
        self.definitions: list[Definition] = []

    def __call__(self, name: str, unit: str, meaning: str, value: sp.Expr) -> sp.Expr:
        """A symbol for the value; a number, a symbol and its negative stand for themselves."""
        if value.is_Atom or (-value).is_Symbol:
            return value
        definition = Definition(quantity(name, unit, meaning), value)
        self.definitions.append(definition)
        return definition.symbol

    def vector(self, name: str, unit: str, meaning: str, values: sp.MatrixBase) -> sp.ImmutableMatrix:
        """The same for three components, name_x, name_y, name_z."""
        return sp.ImmutableMatrix(
            [self(f"{name}_{AXES[k]}", unit, f"{meaning}, component {AXES[k]}", values[k]) for k in range(3)]
        )


def substituted(
    template: sp.MatrixBase, *pairs: tuple[Sequence[sp.Expr], Sequence[sp.Expr]]
) -> sp.ImmutableMatrix:
    """A derived formula with values in place of its letters; zeros and ones fold."""
    values = {
        letter: value
        for letters, given in pairs
        for letter, value in zip(letters, given, strict=True)
        if letter != value
    }
    return sp.ImmutableMatrix(template.xreplace(values))
