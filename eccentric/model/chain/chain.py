"""Chains: joints in a row, each with the body that it moves; one joint is the paper's rotating link."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eccentric.errors import InputError, counted, few
from eccentric.model.chain.body import Body, Moments
from eccentric.model.chain.exact import exact, vector
from eccentric.model.chain.joint import Joint
from eccentric.model.quantity import Quantity
from eccentric.model.reserved import require_free

_LONG = 10**18
"""Least denominator of a fraction that is rounded to 17 digits."""


@dataclass(frozen=True)
class Link:
    """A joint as the recursion takes it: the axis is x, y or z of its frame.

    Attributes:
        joint: as it was given.
        axis: 0, 1 or 2 for x, y or z.
        sign: 1, or -1 if the joint moves along or about the opposite direction.
        rotation, position: of the frame in that of the parent.
        moments: of the body in this frame, payload included [kg, kg m, kg m^2].
        tilt: this frame in the joint's own one: its axes as columns; the unit matrix but for an oblique axis.
    """

    joint: Joint
    axis: int
    sign: int
    rotation: sp.ImmutableMatrix
    position: sp.ImmutableMatrix
    moments: Moments
    tilt: sp.ImmutableMatrix


class Chain:
    """A serial chain on a fixed base.

    Args:
        name: in code.
        joints: from the base outwards.
        bodies: the body that each joint moves, or its moments of mass.
        gravity: acceleration of free fall in the frame of the base [m/s^2].
        payload: a body fixed to the last one, in the frame of the last joint.
        parameters: the quantities whose symbols stand in joints, bodies, gravity and payload.

    Raises:
        InputError: no joints, a joint without a body, or a symbol that no parameter has.
    """

    def __init__(
        self,
        name: str,
        joints: Sequence[Joint],
        bodies: Sequence[Body | Moments],
        gravity: Any = (0, 0, "-9.81"),
        payload: Body | None = None,
        parameters: Sequence[Quantity] = (),
    ) -> None:
        require_free(name, "name")
        self.name, self.joints, self.bodies = name, tuple(joints), tuple(bodies)
        self.gravity = vector(gravity, f"{name}: gravity")
        self.payload, self.parameters = payload, tuple(parameters)
        if not self.joints:
            raise InputError(f"{name}: at least one joint is required, received none")
        if len(self.joints) != len(self.bodies):
            raise InputError(
                f"{name}: one body for each joint is required, received {len(self.joints)} joints and"
                f" {len(self.bodies)} bodies"
            )
        used = self.gravity.free_symbols.union(*(_symbols(link) for link in self.links))
        if unknown := sorted(map(str, used - {q.symbol for q in self.parameters})):
            raise InputError(f"{name}: {unknown[0]} is required among its parameters")

    def __repr__(self) -> str:
        return (
            f"<Chain {self.name}: {counted(len(self.joints), 'joint')}, {few(x.name for x in self.joints)}>"
        )

    @property
    def links(self) -> tuple[Link, ...]:
        """Its joints, with the frames of those with an oblique axis turned so that z is the axis."""
        found, outer = [], sp.eye(3)
        for place, (joint, body) in enumerate(zip(self.joints, self.bodies, strict=True)):
            moments = body.moments
            if self.payload is not None and place == len(self.joints) - 1:
                moments += self.payload.moments
            tilt, (axis, sign) = sp.eye(3), joint.along or (2, 1)
            if joint.along is None:
                sign = 1 if joint.axis[2] > 0 else -1
                tilt = _onto(sign * joint.axis)
                moments = moments.turned(tilt)
            rotation = outer.T * joint.placement.rotation * tilt
            position = outer.T * joint.placement.position
            rotation, position = (sp.ImmutableMatrix(x.applyfunc(_short)) for x in (rotation, position))
            found.append(Link(joint, axis, sign, rotation, position, moments, sp.ImmutableMatrix(tilt)))
            outer = tilt
        return tuple(found)


def _symbols(link: Link) -> set[sp.Symbol]:
    joint, moments = link.joint, link.moments
    single = set().union(*(x.free_symbols for x in (joint.mu, joint.J_m, joint.bearing, moments.mass)))
    matrices = (link.rotation, link.position, moments.first, moments.second)
    return single.union(*(x.free_symbols for x in matrices))


def _onto(axis: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """A rotation that brings z onto an axis on its side: by half a turn about the line halfway."""
    half = axis + sp.Matrix([0, 0, 1])
    return sp.ImmutableMatrix(2 * half * half.T / half.dot(half) - sp.eye(3)).applyfunc(_short)


def _short(entry: sp.Expr) -> sp.Expr:
    """A product of decimals as a decimal of 17 digits again; what is short stays exact."""
    if not entry.is_number or (entry.is_Rational and entry.q < _LONG):
        return entry
    return exact(float(entry), "entry")
