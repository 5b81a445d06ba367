"""The arm that the bench simulates: joints with their links, drives and friction, in SI units.

Nothing here comes from the toolkit: the bench is an oracle for it, so the two share no code.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class JointFriction:
    """Friction of one joint: of the motor on its own side, of the bearing in proportion to its loads.

    f = (C_m + mu (C_lN F_N + C_lT F_T + C_lM M_B)) sgn w_m
        + (B_m + mu^2 (B_lN F_N + B_lT F_T + B_lM M_B)) w_m

    on the motor side [N m], with the loads of the moment: F_N across the axis, F_T along it [N], M_B across
    it about the origin of the joint [N m].
    """

    C_m: float = 0.0
    B_m: float = 0.0
    C_lN: float = 0.0
    B_lN: float = 0.0
    C_lT: float = 0.0
    B_lT: float = 0.0
    C_lM: float = 0.0
    B_lM: float = 0.0

    @property
    def dry(self) -> Vector:
        """Coulomb friction of the joint per F_N [m], F_T [m] and M_B [1]."""
        return self.C_lN, self.C_lT, self.C_lM

    @property
    def viscous(self) -> Vector:
        """Viscous friction of the joint per F_N [m s/rad], F_T [m s/rad] and M_B [s/rad]."""
        return self.B_lN, self.B_lT, self.B_lM


@dataclass(frozen=True)
class BenchLink:
    """A revolute joint, the link that it moves, and its drive, which sits on the link before.

    Attributes:
        position, rpy: of the joint's frame in that of the link before [m, rad]: turned by roll about x, then
            pitch about y, then yaw about z of that link.
        axis: unit vector in the joint's frame.
        mass, centre, inertia: of the link [kg], in the joint's frame [m]; the tensor about the centre of
            mass, as xx, yy, zz, xy, xz, yz [kg m^2].
        mu: gear ratio, joint over motor.
        J_m: inertia of the rotor about its axis, which is parallel to that of the joint [kg m^2]. Locked, it
            is part of the link that carries it.
        k_i: torque constant of the motor [N m/A].
    """

    position: Vector
    rpy: Vector
    axis: Vector
    mass: float
    centre: Vector
    inertia: tuple[float, float, float, float, float, float]
    mu: float
    J_m: float
    k_i: float
    friction: JointFriction = JointFriction()


@dataclass(frozen=True)
class BenchArm:
    """Links in a row on a fixed base; `gravity` is the free fall in the base's frame [m/s^2]."""

    name: str
    links: tuple[BenchLink, ...]
    gravity: Vector = (0.0, 0.0, -9.81)

    def __len__(self) -> int:
        return len(self.links)

    def column(self, letter: str) -> np.ndarray:
        """Return one number of each link, such as its mu, shape (joints,)."""
        return np.array([getattr(link, letter) for link in self.links])


# Friction of every joint at once, in closed form: a level opposing the motion, and a viscous part.


class FrictionLaw:
    """The friction of `JointFriction`, as torque of the joints: both parts over mu, the velocity times mu."""

    def __init__(self, arm: BenchArm) -> None:
        mu = arm.column("mu")
        all_of = [link.friction for link in arm.links]
        self.motor_dry = np.array([f.C_m for f in all_of]) / mu
        self.motor_viscous = np.array([f.B_m for f in all_of]) / mu**2
        self._dry = np.array([f.dry for f in all_of]).T
        self._viscous = np.array([f.viscous for f in all_of]).T

    def of(self, bearing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the level [N m] and the viscous coefficient [N m s/rad], each of shape (..., joints).

        `bearing` are F_N, F_T [N] and M_B [N m], shape (..., 3, joints).
        """
        dry = self.motor_dry + (self._dry * bearing).sum(axis=-2)
        viscous = self.motor_viscous + (self._viscous * bearing).sum(axis=-2)
        return dry, viscous
