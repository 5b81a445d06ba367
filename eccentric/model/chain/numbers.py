"""A chain with numbers in place of its letters: their defaults."""

from __future__ import annotations

import copy
from typing import Any

import sympy as sp

from eccentric.errors import InputError
from eccentric.model.chain.body import Body, Moments
from eccentric.model.chain.chain import Chain
from eccentric.model.chain.joint import Joint

__all__ = ["with_numbers"]


def with_numbers(chain: Chain) -> Chain:
    """The same chain with the default of every parameter in its place; without parameters, the chain itself.

    Raises:
        InputError: a parameter has no default.
    """
    if not chain.parameters:
        return chain
    values = {}
    for q in chain.parameters:
        if q.default is None or not q.default.is_number:
            raise InputError(f"{chain.name}: a number for {q.name} is required, received none")
        values[q.symbol] = q.default
    return Chain(
        chain.name,
        [_joint(joint, values) for joint in chain.joints],
        [_moments(body, values) for body in chain.bodies],
        chain.gravity.xreplace(values),
        None if chain.payload is None else _payload(chain.payload, values),
    )


def _joint(joint: Joint, values: dict[sp.Symbol, Any]) -> Joint:
    found = copy.copy(joint)
    found.placement = copy.copy(joint.placement)
    for name in ("mu", "J_m", "bearing"):
        setattr(found, name, getattr(joint, name).xreplace(values))
    for name in ("position", "rotation"):
        setattr(found.placement, name, getattr(joint.placement, name).xreplace(values))
    return found


def _moments(body: Body | Moments, values: dict[sp.Symbol, Any]) -> Moments:
    of = body.moments
    return Moments(*(x.xreplace(values) for x in (of.mass, of.first, of.second)))


def _payload(body: Body, values: dict[sp.Symbol, Any]) -> Body:
    mass, centre, inertia = (x.xreplace(values) for x in (body.mass, body.centre, body.inertia))
    return Body(mass, centre, inertia, body.name)
