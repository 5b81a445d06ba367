"""The parameters of a model that its rig gives, and those that have a value without one."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import sympy as sp

from eccentric.effects import constant_load
from eccentric.errors import InputError
from eccentric.model import Model, regressor
from eccentric.model import vocabulary as v
from eccentric.rigs import KNOWNS

if TYPE_CHECKING:
    from eccentric.rigs import Rig

__all__ = ["following_letters", "load_letters", "own_letters", "require_case", "with_own"]


def own_letters(model: Model) -> dict[str, float]:
    """Parameters of a derivation or an effect that no rig knows, with their defaults, which hold."""
    # Every rig with a case has a tilt; a model without one may have another quantity of that name.
    of_rigs = {known.name for known in KNOWNS} - (set() if model.tilted else {v.phi.name})
    return {
        q.name: float(sp.Float(q.default))
        for q in model.parameters
        if q.name not in of_rigs and q.default is not None and q.default.is_number
    }


def with_own(rig: Rig, model: Model) -> Rig:
    """The rig with the model's own parameters besides friction, such as a flywheel's inertia, as known."""
    fitted = {q.name for q in model.friction_parameters}
    own = {name: value for name, value in own_letters(model).items() if name not in fitted}
    return dataclasses.replace(rig, known={**rig.known, **own})


def following_letters(model: Model) -> dict[str, sp.Expr]:
    """Parameters that follow from others by default, such as F_T = M_l g, with these defaults."""
    given = {q.name: q.default for q in model.parameters}
    return {name: x for name, x in given.items() if x is not None and x.free_symbols}


def require_case(rig: Rig, model: Model) -> None:
    """Raise InputError for a model of another axis or case than the rig's; one with a tilt fits each case.

    And for one without an unbalanced mass, where runs carry more of it.
    """
    if rig.added and not {v.M.name, v.L.name} <= {q.symbol.name for q in model.parameters}:
        raise InputError(
            f"{rig.path}: [added]: a model with an unbalanced mass is required, received {model.name}"
        )
    if model.axis is not rig.axis:
        raise InputError(
            f"{rig.path}: model {model.name} requires kind = {model.axis.name!r}, received {rig.axis.name!r};"
            f" {rig.model} fits it"
        )
    if model.tilted:
        return
    case = "C1" if model.balance("mechanical").sum_of("gravity") == 0 else "C2"
    if rig.case != case:
        received = f"case {rig.case}" if rig.case else "a tilted plane (no case)"
        raise InputError(
            f"{rig.path}: model {model.name} requires case {case}, received {received}; {rig.model} fits it"
        )


def load_letters(model: Model) -> set[str]:
    """Parameters that the regressor and gravity depend on, but for a constant load: it is a column."""
    expressions = [column.basis for column in regressor(model)]
    expressions.append(model.balance("mechanical").sum_of("gravity", "conservative"))
    found = {symbol.name for e in expressions for symbol in model.expand(e).free_symbols}
    loads = {quantity.name for quantity in constant_load.coefficients}
    return found & {quantity.name for quantity in model.parameters} - loads
