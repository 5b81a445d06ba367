"""Bodies: mass, centre of mass and inertia, and the moments of mass that follow from them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from eccentric.errors import InputError
from eccentric.model.chain.exact import exact, matrix, vector

_SLACK = 1e-9
"""Relative excess over the triangle inequality that rounding in a drawing may leave."""


@dataclass(frozen=True)
class Moments:
    """Mass, first and second moments of mass about the origin of a frame: linear in what is added.

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
        """Itself: a body may be given by its moments, in the frame of the joint that moves it."""
        return self

    def turned(self, rotation: sp.MatrixBase) -> Moments:
        """The same mass in the components of a frame with the same origin; its axes are the columns."""
        return Moments(self.mass, rotation.T * self.first, rotation.T * self.second * rotation)


class Body:
    """A rigid body, in the frame of the joint that moves it.

    Rotors of drives that are mounted on it belong to it, as if they were locked.

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
            raise InputError(f"{name}: mass: 0 or above is required, received {float(self.mass):g} kg")
        if self.inertia != self.inertia.T:
            raise InputError(f"{name}: inertia: a symmetric tensor is required")
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
    """A body's second moments are those of a positive mass: no principal moment exceeds the two others."""
    import numpy as np

    principal = np.sort(np.linalg.eigvalsh(np.array(inertia.tolist(), dtype=float)))
    shown = ", ".join(f"{value:g}" for value in principal)
    slack = _SLACK * max(abs(principal[-1]), abs(principal[0]))
    if principal[0] < -slack:
        raise InputError(
            f"{name}: inertia: principal moments of 0 or above are required, received {shown} kg m^2"
        )
    if principal[2] > principal[0] + principal[1] + slack:
        raise InputError(
            f"{name}: inertia: principal moments are required of which none exceeds the sum of the others,"
            f" received {shown} kg m^2"
        )
