"""Joints, bodies and placements of a chain, with exact numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from eccentric.core import InputError, meant


def exact(value: Any, what: str) -> sp.Expr:
    """The value as an exact number (0.1, "0.1" and "1/10" are the same), or an expression unchanged.

    Raises:
        InputError: it is neither a finite number nor an expression; `what` names it.
    """
    if isinstance(value, sp.Expr) and not value.is_Float:
        if value.is_number and not value.is_finite:
            raise InputError(what, "a finite number", value)
        return value
    try:
        number = Fraction(value) if isinstance(value, str) else float(value)
    except (TypeError, ValueError, ZeroDivisionError):
        raise InputError(what, "a number", f"{value!r}") from None
    if not math.isfinite(number):
        raise InputError(what, "a finite number", f"{value!r}")
    return sp.Rational(number if isinstance(number, Fraction) else repr(number))


def vector(values: Iterable[Any], what: str) -> sp.ImmutableMatrix:
    """Three exact values, as a column.

    Raises:
        InputError: there are not three, or one of them is no number.
    """
    entries = list(values) if isinstance(values, Sequence | sp.MatrixBase) else None
    if entries is None and hasattr(values, "tolist"):
        entries = list(values)
    if entries is None or len(entries) != 3:
        raise InputError(what, "three numbers", f"{values!r}")
    return sp.ImmutableMatrix([exact(value, what) for value in entries])


def matrix(values: Any, what: str) -> sp.ImmutableMatrix:
    """Three rows of three exact values.

    Raises:
        InputError: there are not, or one of them is no number.
    """
    rows = values.tolist() if hasattr(values, "tolist") else values
    if not isinstance(rows, Sequence) or len(rows) != 3:
        raise InputError(what, "three rows of three numbers", f"{values!r}")
    return sp.ImmutableMatrix([list(vector(row, what)) for row in rows])


def skew(w: sp.MatrixBase) -> sp.ImmutableMatrix:
    """The matrix S(w) of the cross product: S(w) v is w x v."""
    return sp.ImmutableMatrix([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def is_zero(value: sp.Expr) -> bool:
    """Whether it is the number 0."""
    return value.is_zero is True


KINDS = ("revolute", "prismatic")
UNNAMED = "joint"
"""Name of an unnamed joint."""
_UNIT = 1e-6
"""Tolerance of the length of an axis: rounding to six digits."""
_RIGHT = 1e-6
"""Tolerance of a rotation's deviation from an orthonormal right-handed frame."""
_ROUNDED = 1e-15
"""Entries of a rotation this close to 0, 1 or -1 are these: the cosine of a rounded right angle is 6e-17."""


class Placement:
    """The fixed pose of a joint in the frame of its parent.

    Args:
        position: of the joint's frame in that of the parent [m].
        rotation: 3 by 3; its columns are the axes of the joint's frame.

    Raises:
        InputError: a number is missing, or the columns are no right-handed unit vectors.
    """

    def __init__(self, position: Any = (0, 0, 0), rotation: Any = None, name: str = "placement") -> None:
        self.position = vector(position, f"{name}: position")
        columns = matrix(sp.eye(3) if rotation is None else rotation, f"{name}: rotation")
        self.rotation = sp.ImmutableMatrix(columns.applyfunc(_folded))
        if all(entry.is_number for entry in self.rotation):
            rows = self.rotation.evalf(20)
            excess = (rows.T * rows - sp.eye(3)).norm() + abs(rows.det() - 1)
            if excess > _RIGHT:
                raise InputError(name, problem="rotation: expected columns that are a right-handed frame")

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
            is mounted on the parent.
        bearing: the centre of the bearing along the axis, from the origin of the joint's frame [m].
        name: in messages.

    Raises:
        InputError: an unknown kind, an axis of another length than 1, a gear ratio or inertia out of range.
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
            raise InputError(f"{name}: kind", f"one of {', '.join(KINDS)}", f"{kind!r}{meant(kind, KINDS)}")
        self.kind, self.name = kind, name
        self.axis = _unit(vector(axis, f"{name}: axis"), name)
        self.placement = placement or Placement()
        self.mu = exact(mu, f"{name}: mu")
        self.J_m = exact(J_m, f"{name}: J_m")
        self.bearing = exact(bearing, f"{name}: bearing")
        if self.mu.is_number and self.mu <= 0:
            raise InputError(f"{name}: mu", "a positive gear ratio", f"{float(self.mu):g}")
        if self.J_m.is_number and self.J_m < 0:
            raise InputError(f"{name}: J_m", "0 or above", f"{float(self.J_m):g} kg m^2")

    @property
    def turns(self) -> bool:
        """Whether it is revolute."""
        return self.kind == "revolute"

    @property
    def along(self) -> tuple[int, int] | None:
        """(0, 1 or 2 for x, y or z; sign) of an axis of the frame, None for an oblique one."""
        k = next((k for k in range(3) if self.axis[k] in {1, -1}), None)
        return None if k is None else (k, int(self.axis[k]))


def _unit(axis: sp.ImmutableMatrix, name: str) -> sp.ImmutableMatrix:
    if not all(entry.is_number for entry in axis):
        raise InputError(f"{name}: axis", "three numbers", tuple(axis))
    length = float(sp.sqrt(axis.dot(axis)).evalf())
    shown = ", ".join(f"{float(entry):g}" for entry in axis)
    if abs(length - 1) > _UNIT:
        raise InputError(f"{name}: axis", "a vector of length 1", f"({shown}) of length {length:g}")
    return axis if length == 1 else sp.ImmutableMatrix([exact(float(entry) / length, name) for entry in axis])


def _folded(entry: sp.Expr) -> sp.Expr:
    if entry.is_number:
        for value in (0, 1, -1):
            if abs(float(entry) - value) < _ROUNDED:
                return sp.Integer(value)
    return entry


_SLACK = 1e-9
"""Relative violation of the triangle inequality allowed for rounding in a drawing."""


@dataclass(frozen=True)
class Moments:
    """Mass, first and second moments of mass about the origin of a frame: additive over bodies.

    Attributes:
        mass: sum of dm [kg].
        first: sum of rho dm, mass times centre of mass [kg m].
        second: sum of rho rho^T dm, 3 by 3, symmetric [kg m^2]. The inertia tensor is its trace minus itself.
    """

    mass: sp.Expr
    first: sp.ImmutableMatrix
    second: sp.ImmutableMatrix

    def __add__(self, other: Moments) -> Moments:
        return Moments(self.mass + other.mass, self.first + other.first, self.second + other.second)

    @property
    def moments(self) -> Moments:
        """Itself, so that moments can be used in place of a body."""
        return self

    def turned(self, rotation: sp.MatrixBase) -> Moments:
        """The moments in the components of a rotated frame, whose axes are the columns."""
        return Moments(self.mass, rotation.T * self.first, rotation.T * self.second * rotation)


class Body:
    """A rigid body, in the frame of the joint that moves it.

    It includes the rotors of drives mounted on it, as if locked.

    Args:
        mass: [kg].
        centre: centre of mass in the frame of the joint [m].
        inertia: tensor about the centre of mass, axes parallel to the frame of the joint [kg m^2], 3 by 3.

    Raises:
        InputError: a number is missing or not finite, the mass is negative, the tensor is not symmetric or
            not that of a body: then one principal moment exceeds the sum of the others.
    """

    def __init__(self, mass: Any, centre: Any = (0, 0, 0), inertia: Any = None, name: str = "body") -> None:
        self.name = name
        self.mass = exact(mass, f"{name}: mass")
        self.centre = vector(centre, f"{name}: centre of mass")
        self.inertia = matrix([[0] * 3] * 3 if inertia is None else inertia, f"{name}: inertia")
        if self.mass.is_number and self.mass < 0:
            raise InputError(f"{name}: mass", "0 or above", f"{float(self.mass):g} kg")
        if self.inertia != self.inertia.T:
            raise InputError(name, problem="inertia: expected a symmetric tensor")
        if all(entry.is_number for entry in self.inertia):
            _require_possible(name, self.inertia)

    def __repr__(self) -> str:
        return f"Body(mass={self.mass}, centre={tuple(self.centre)}, inertia={self.inertia.tolist()})"

    @property
    def moments(self) -> Moments:
        """Moments of mass about the origin of the frame of the joint."""
        about_centre = self.inertia.trace() / 2 * sp.eye(3) - self.inertia
        steiner = self.mass * self.centre * self.centre.T
        return Moments(
            self.mass, sp.ImmutableMatrix(self.mass * self.centre), sp.ImmutableMatrix(about_centre + steiner)
        )


def _require_possible(name: str, inertia: sp.MatrixBase) -> None:
    """Require the triangle inequality: no principal moment exceeds the sum of the others."""
    import numpy as np

    principal = np.sort(np.linalg.eigvalsh(np.array(inertia.tolist(), dtype=float)))
    shown = ", ".join(f"{value:g}" for value in principal)
    slack = _SLACK * max(abs(principal[-1]), abs(principal[0]))
    if principal[0] < -slack:
        raise InputError(f"{name}: inertia", "principal moments of 0 or above", f"{shown} kg m^2")
    if principal[2] > principal[0] + principal[1] + slack:
        raise InputError(
            f"{name}: inertia",
            "principal moments",
            f"{shown} kg m^2",
            why="of which none exceeds the sum of the others",
        )
