"""A constant load on the link: the weight on a screw drive, a spring at its working point.

Not a family of the library: a declared load belongs to the base model, and an undeclared one is
indistinguishable from friction that differs between the directions.
"""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import Effect, Words
from eccentric.effects.forms import addition
from eccentric.model import Model, quantity
from eccentric.model import vocabulary as v

T_load = quantity("T_load", "N m", "constant torque of the load on the link, against positive motion")

effect: Effect = addition(
    "constant_load",
    [(T_load, v.mu.symbol * sp.Integer(1))],
    kind="conservative",
    depends_on=("direction",),
    formula="mu T_load",
    reference="torque balance of the link, as gravity in the paper's eq (5), but constant",
    words=Words(headline="a constant load on the link", hint="another weight"),
)
"""The record that extends a model by the load."""


def with_constant_load(model: Model, value: float = 0.0) -> Model:
    """The model, extended by the load with this default [N m]; as it is where it has one already."""
    if T_load.name in {q.name for q in model.parameters}:
        return model
    return effect.extend(model, {T_load.name: value})
