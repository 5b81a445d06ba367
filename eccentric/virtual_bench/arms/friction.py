"""Friction of every joint at once, in closed form: a level opposing the motion, and a viscous part."""

from __future__ import annotations

import numpy as np

from eccentric.virtual_bench.arms.plant import BenchArm


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
