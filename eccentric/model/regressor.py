"""The regressor: the columns that span the friction torque, one for each identifiable coefficient."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from eccentric.core import InputError
from eccentric.model.balance import Load, Role, Term
from eccentric.model.model import Model
from eccentric.model.quantity import Quantity
from eccentric.model.steps import Gated


@dataclass(frozen=True)
class Column:
    """A column of the regressor: one identifiable coefficient of friction and its basis.

    Attributes:
        name: of the coefficient, e.g. "B_lN", or "B" for B_m + mu^2 beta_T, which one log cannot separate.
        coefficient: its value in the model's parameters.
        basis: the column.
        unit: of the coefficient.
        bounds: of the coefficient.
        parameter: the parameter of the model that represents the coefficient: equal to it if the others of
            a combination are zero (B_m for B).
        role, load, joint: those of the term with this basis; all terms of a column have the same role.
        added: whether all its terms come from extensions.
    """

    name: str
    coefficient: sp.Expr
    basis: sp.Expr
    unit: str
    bounds: tuple[float | None, float | None]
    parameter: Quantity
    role: Role
    load: Load
    joint: int
    added: bool

    @property
    def linear(self) -> bool:
        """Whether it belongs to the linear model: viscous or Coulomb friction without load, no effect."""
        return self.role in {Role.VISCOUS, Role.COULOMB} and self.load is Load.NONE and not self.added


def regressor(model: Model) -> tuple[Column, ...]:
    """The columns that span the mechanical friction torque.

    No log can distinguish terms whose bases differ only by a factor in parameters; they form one column with
    the simplest basis. These terms are determined from the expressions, never declared.

    Raises:
        InputError: the coefficient of a friction term is not a parameter, a combination has no name, or terms
            of one column differ in role or joint.
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
    """The ratio of two bases; a common gate cancels."""
    return one.replace(Gated, sp.Mul) / other.replace(Gated, sp.Mul)


def _column(model: Model, group: list[Term]) -> Column:
    known = {quantity.symbol: quantity for quantity in model.parameters}
    names = ", ".join(term.name for term in group)
    for term in group:
        if term.coefficient not in known:
            raise InputError(
                f"model {model.name}: term {term.name}",
                "a parameter",
                term.coefficient,
                why="as coefficient of friction",
            )
    if len({(term.role, term.joint) for term in group}) > 1:
        received = ", ".join(f"{term.role} at joint {term.joint}" for term in group)
        raise InputError(
            f"model {model.name}: terms {names}: no log distinguishes them",
            "one role and one joint",
            received,
        )
    simplest = min(group, key=lambda term: sp.count_ops(term.basis))
    basis, parameter = simplest.basis, known[simplest.coefficient]
    added = {t.name for e in model.extensions for terms in e.change.terms.values() for t in terms}
    extra = all(term.name in added for term in group)
    follows = (parameter, simplest.role, simplest.load, simplest.joint, extra)
    if len(group) == 1:
        return Column(parameter.name, parameter.symbol, basis, parameter.unit, simplest.bounds, *follows)
    coefficient = sp.Add(*(term.coefficient * _ratio(term.basis, basis) for term in group))
    lows = [term.bounds[0] for term in group if term.bounds[0] is not None]
    low = sum(lows) if len(lows) == len(group) else None
    for definition in model.definitions:
        if sp.expand(definition.value - coefficient) == 0:
            quantity = definition.quantity
            return Column(quantity.name, definition.symbol, basis, quantity.unit, (low, None), *follows)
    raise InputError(
        f"model {model.name}",
        problem=f"terms {names}: no log distinguishes them; define a quantity for {coefficient}",
    )
