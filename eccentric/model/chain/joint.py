"""Joints: how a body moves in its parent, and the drive between them."""

from __future__ import annotations

import math
from typing import Any

import sympy as sp

from eccentric.errors import InputError, meant
from eccentric.model.chain.exact import exact, matrix, vector

KINDS = ("revolute", "prismatic")
UNNAMED = "joint"
"""Name of a joint that was given none."""
_UNIT = 1e-6
"""Most that the length of an axis may differ from 1: what six printed digits leave."""
_RIGHT = 1e-6
"""Most that a rotation may differ from a right-handed frame of unit vectors."""
_ROUNDED = 1e-15
"""Entries of a rotation this close to 0, 1 or -1 are those: the cosine of a rounded right angle is 6e-17."""


class Placement:
    """Where a joint sits in the frame of its parent: fixed.

    Args:
        position: of the joint's frame in that of the parent [m].
        rotation: 3 by 3; its columns are the axes of the joint's frame.

    Raises:
        InputError: a number is missing, or the columns are no right-handed unit vectors.
    """

    def __init__(self, position: Any = (0, 0, 0), rotation: Any = None, name: str = "placement") -> None:
        self.position = vector(position, f"{name}: position")
        given = matrix(sp.eye(3) if rotation is None else rotation, f"{name}: rotation")
        self.rotation = sp.ImmutableMatrix(given.applyfunc(_folded))
        if all(entry.is_number for entry in self.rotation):
            rows = self.rotation.evalf(20)
            excess = (rows.T * rows - sp.eye(3)).norm() + abs(rows.det() - 1)
            if excess > _RIGHT:
                raise InputError(f"{name}: rotation: columns that are a right-handed frame are required")

    @classmethod
    def turned(
        cls, position: Any, roll: float, pitch: float, yaw: float, name: str = "placement"
    ) -> Placement:
        """Turned by roll about x, then pitch about y, then yaw about z of the parent [rad]."""
        (sr, cr), (sp_, cp), (sy, cy) = ((math.sin(x), math.cos(x)) for x in (roll, pitch, yaw))
        rotation = [
            [cy * cp, cy * sp_ * sr - sy * cr, cy * sp_ * cr + sy * sr],
            [sy * cp, sy * sp_ * sr + cy * cr, sy * sp_ * cr - cy * sr],
            [-sp_, cp * sr, cp * cr],
        ]
        return cls(position, rotation, name)


class Joint:
    """A revolute or prismatic joint, and the drive that moves it.

    Args:
        kind: "revolute" or "prismatic".
        axis: unit vector in the frame of the joint; numbers.
        placement: of the joint in the frame of its parent.
        mu: gear ratio, joint over motor: 1 for a revolute joint [1], for a prismatic one [m/rad].
        J_m: inertia of the rotor about its axis, which is parallel to that of the joint [kg m^2]. The motor
            is
            mounted on the parent.
        bearing: the centre of the bearing along the axis, from the origin of the joint's frame [m].
        name: in messages.

    Raises:
        InputError: an unknown kind, an axis of another length than 1, a gear ratio or an inertia out of
            range.
    """

    def __init__(
        self,
        kind: str = "revolute",
        axis: Any = (0, 0, 1),
        placement: Placement | None = None,
        mu: Any = 1,
        J_m: Any = 0,
        bearing: Any = 0,
        name: str = UNNAMED,
    ) -> None:
        if kind not in KINDS:
            raise InputError(
                f"{name}: kind: one of {', '.join(KINDS)} is required, received {kind!r}" + meant(kind, KINDS)
            )
        self.kind, self.name = kind, name
        self.axis = _unit(vector(axis, f"{name}: axis"), name)
        self.placement = placement or Placement()
        self.mu = exact(mu, f"{name}: mu")
        self.J_m = exact(J_m, f"{name}: J_m")
        self.bearing = exact(bearing, f"{name}: bearing")
        if self.mu.is_number and self.mu <= 0:
            raise InputError(f"{name}: mu: a positive gear ratio is required, received {float(self.mu):g}")
        if self.J_m.is_number and self.J_m < 0:
            raise InputError(f"{name}: J_m: 0 or above is required, received {float(self.J_m):g} kg m^2")

    @property
    def turns(self) -> bool:
        """Whether it is revolute."""
        return self.kind == "revolute"

    @property
    def along(self) -> tuple[int, int] | None:
        """(0, 1 or 2 for x, y or z; sign) of an axis of the frame, None for an oblique one."""
        found = [k for k in range(3) if self.axis[k] in {1, -1}]
        return (found[0], int(self.axis[found[0]])) if found else None


def _unit(axis: sp.ImmutableMatrix, name: str) -> sp.ImmutableMatrix:
    if not all(entry.is_number for entry in axis):
        raise InputError(f"{name}: axis: three numbers are required, received {tuple(axis)}")
    length = float(sp.sqrt(axis.dot(axis)).evalf())
    shown = ", ".join(f"{float(entry):g}" for entry in axis)
    if abs(length - 1) > _UNIT:
        raise InputError(
            f"{name}: axis: a vector of length 1 is required, received ({shown}) of length {length:g}"
        )
    return axis if length == 1 else sp.ImmutableMatrix([exact(float(entry) / length, name) for entry in axis])


def _folded(entry: sp.Expr) -> sp.Expr:
    if entry.is_number:
        for value in (0, 1, -1):
            if abs(float(entry) - value) < _ROUNDED:
                return sp.Integer(value)
    return entry
