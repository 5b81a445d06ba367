"""Chains: joints in series, each with the body it moves; one joint is the paper's rotating link."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eccentric.core import InputError, counted, few
from eccentric.model.chain.links import Body, Joint, Moments, exact, vector
from eccentric.model.quantity import Quantity, require_free

_LONG = 10**18
"""Smallest denominator of a fraction that is rounded to 17 digits."""


@dataclass(frozen=True)
class Link:
    """A joint in the form of the recursion: its axis is x, y or z of the frame."""

    joint: Joint  # the original joint
    axis: int  # 0, 1 or 2 for x, y or z
    sign: int  # 1, or -1 if the joint moves along or about the opposite direction
    rotation: sp.ImmutableMatrix  # of the frame in that of the parent
    position: sp.ImmutableMatrix  # of its origin there
    moments: Moments  # of the body in this frame, payload included [kg, kg m, kg m^2]
    tilt: sp.ImmutableMatrix  # of this frame in the joint's frame; the identity unless the axis is oblique


class Chain:
    """A serial chain on a fixed base.

    Args:
        name: in code.
        joints: from the base outwards.
        bodies: the body moved by each joint, or its moments of mass.
        gravity: acceleration of free fall in the frame of the base [m/s^2].
        payload: a body fixed to the last one, in the frame of the last joint.
        parameters: the quantities whose symbols occur in joints, bodies, gravity and payload.

    Raises:
        InputError: no joints, a joint without a body, or a symbol that is not a parameter.
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
            raise InputError(name, "at least one joint", "none")
        if len(self.joints) != len(self.bodies):
            raise InputError(
                name, "one body for each joint", f"{len(self.joints)} joints and {len(self.bodies)} bodies"
            )
        used = self.gravity.free_symbols.union(*(_symbols(link) for link in self.links))
        if unknown := sorted(map(str, used - {q.symbol for q in self.parameters})):
            raise InputError(name, problem=f"expected {unknown[0]} among its parameters")

    def __repr__(self) -> str:
        return (
            f"<Chain {self.name}: {counted(len(self.joints), 'joint')}, {few(x.name for x in self.joints)}>"
        )

    @property
    def links(self) -> tuple[Link, ...]:
        """Its joints, with frames rotated so that an oblique axis becomes z."""
        links, outer = [], sp.eye(3)
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
            links.append(Link(joint, axis, sign, rotation, position, moments, sp.ImmutableMatrix(tilt)))
            outer = tilt
        return tuple(links)


def _symbols(link: Link) -> set[sp.Symbol]:
    joint, moments = link.joint, link.moments
    single = set().union(*(x.free_symbols for x in (joint.mu, joint.J_m, joint.bearing, moments.mass)))
    matrices = (link.rotation, link.position, moments.first, moments.second)
    return single.union(*(x.free_symbols for x in matrices))


def _onto(axis: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """A rotation of z onto an axis in its half-space: by half a turn about the bisector."""
    half = axis + sp.Matrix([0, 0, 1])
    return sp.ImmutableMatrix(2 * half * half.T / half.dot(half) - sp.eye(3)).applyfunc(_short)


def _short(entry: sp.Expr) -> sp.Expr:
    """Round a product of decimals to 17 digits; short numbers stay exact."""
    if not entry.is_number or (entry.is_Rational and entry.q < _LONG):
        return entry
    return exact(float(entry), "entry")


def with_numbers(chain: Chain) -> Chain:
    """The chain with every parameter replaced by its default; without parameters, the chain itself.

    Raises:
        InputError: a parameter has no default.
    """
    if not chain.parameters:
        return chain
    values = {}
    for q in chain.parameters:
        if q.default is None or not q.default.is_number:
            raise InputError(chain.name, f"a number for {q.name}", "none")
        values[q.symbol] = q.default
    payload = chain.payload
    return Chain(
        chain.name,
        [_joint(joint, values) for joint in chain.joints],
        [Moments(*_numbers(body.moments, ("mass", "first", "second"), values)) for body in chain.bodies],
        chain.gravity.xreplace(values),
        payload and Body(*_numbers(payload, ("mass", "centre", "inertia"), values), name=payload.name),
    )


def _numbers(of: Any, names: Sequence[str], values: dict[sp.Symbol, Any]) -> list[Any]:
    return [getattr(of, name).xreplace(values) for name in names]


def _joint(joint: Joint, values: dict[sp.Symbol, Any]) -> Joint:
    numeric = copy.copy(joint)
    numeric.placement = copy.copy(joint.placement)
    numeric.mu, numeric.J_m, numeric.bearing = _numbers(joint, ("mu", "J_m", "bearing"), values)
    place = numeric.placement
    place.position, place.rotation = _numbers(joint.placement, ("position", "rotation"), values)
    return numeric


_ALIKE = 1e-9
"""Relative and absolute tolerance for numbers of the same arm, rounded in a file."""


def identity_of(chain: Chain) -> dict[str, Any]:
    """The arm as SI numbers, without its bodies, which a fit may replace and a payload changes."""
    numeric = with_numbers(chain)
    return {"gravity": _floats(numeric.gravity), "joints": [_of_joint(joint) for joint in numeric.joints]}


def unlike(chain: Chain, given: Mapping[str, Any]) -> str:
    """The first difference of a chain from an identity, in words; "" if there is none.

    Args:
        chain: the chain.
        given: an identity as from `identity_of`, possibly from a file.
    """
    identity, joints = identity_of(chain), given.get("joints")
    names, others = ([x.get("name") for x in table] for table in (identity["joints"], joints or []))
    if names != others:
        return f"it has the joints {', '.join(map(str, others)) or 'none'}, not {', '.join(map(str, names))}"
    for here, there in zip(identity["joints"], joints or [], strict=True):
        for key, value in here.items():
            if not _same(value, there.get(key)):
                return f"{key} of {here['name']} is {_shown(there.get(key))}, not {_shown(value)}"
    if not _same(identity["gravity"], given.get("gravity")):
        return f"gravity is {_shown(given.get('gravity'))}, not {_shown(identity['gravity'])}"
    return ""


def _of_joint(joint: Joint) -> dict[str, Any]:
    return {
        "name": joint.name,
        "kind": joint.kind,
        "mu": float(joint.mu),
        "J_m": float(joint.J_m),
        "axis": _floats(joint.axis),
        "position": _floats(joint.placement.position),
        "rotation": _floats(joint.placement.rotation),
        "bearing": float(joint.bearing),
    }


def _floats(matrix: Any) -> list[float]:
    return [float(x) for x in matrix]


def _same(left: object, right: object) -> bool:
    if isinstance(left, list) and isinstance(right, list):
        return len(left) == len(right) and all(map(_same, left, right))
    if isinstance(left, float) and isinstance(right, int | float):
        return math.isclose(left, right, rel_tol=_ALIKE, abs_tol=_ALIKE)
    return left == right


def _shown(value: object) -> str:
    if isinstance(value, list):
        return f"({', '.join(map(_shown, value))})"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
