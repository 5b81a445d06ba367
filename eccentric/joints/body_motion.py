"""What the bodies of an arm require of its drives along a log: torques and loads, from the emitted module."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eccentric.emission import Choice, executed, render_arm
from eccentric.model import Chain, letters_of, recursion, with_letters

__all__ = ["Bodies", "BodyModule", "JointMotions"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class JointMotions:
    """The motion of all motors: angle [rad], velocity [rad/s], acceleration [rad/s^2], each (n, joints)."""

    theta_m: Array
    omega_m: Array
    alpha_m: Array

    @property
    def still(self) -> JointMotions:
        """The same angles at rest: what is left is gravity."""
        zero = np.zeros_like(self.theta_m)
        return JointMotions(self.theta_m, zero, zero)


@dataclass(frozen=True)
class Bodies:
    """What one joint meets, each (n,), on the motor side where it is a torque [N m].

    Attributes:
        gravity: torque that holds the arm.
        moving: torque that moves the bodies, gravity aside: inertia, centrifugal and Coriolis.
        rotor: torque that accelerates the motor's own rotor.
        F_N, F_T, M_B: loads of the bearing [N, N, N m], 0 where a guide has none.
    """

    gravity: Array
    moving: Array
    rotor: Array
    F_N: Array
    F_T: Array
    M_B: Array

    @property
    def whole(self) -> Array:
        """What the drive has to supply without friction."""
        return self.gravity + self.moving + self.rotor

    def scaled(self, factor: float) -> Bodies:
        """The torques in another unit; the loads stay."""
        if factor == 1.0:
            return self
        return replace(
            self, gravity=factor * self.gravity, moving=factor * self.moving, rotor=factor * self.rotor
        )

    @property
    def transmitted(self) -> Array:
        """What the gear passes on, with its sign."""
        return self.gravity + self.moving


class BodyModule:
    """The emitted NumPy module of a chain with letters for its bodies: called with the values at hand."""

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        lettered = with_letters(chain, f"{chain.name}_letters")
        found, choice = recursion(lettered), Choice(("inverse_dynamics", "bearing_loads"), "none")
        files = render_arm(found, lettered.name, chain.name, "eccentric", ("numpy",), choice=choice)
        self._module = executed(files, lettered.name)
        self._names = [q.name for j in range(len(chain.joints)) for q in letters_of(j)]
        self._mu = np.array([float(joint.mu) for joint in chain.joints])
        self._J_m = np.array([float(joint.J_m) for joint in chain.joints])

    @property
    def loads(self) -> tuple[str, ...]:
        """Labels of the values of `bearing_loads`."""
        return self._module.BEARING_LOADS

    @property
    def count(self) -> int:
        """Number of inertial parameters."""
        return len(self._names)

    def torques(self, motion: JointMotions, values: Array) -> Array:
        """Torque that moves bodies and rotors, motor side [N m], shape (n, joints).

        Args:
            motion: of the motors.
            values: inertial parameters (joints, 10).
        """
        return self._module.inverse_dynamics(*self._inputs(motion), self._parameters(values))

    def regressor(self, motion: JointMotions, places: Sequence[int] | None = None) -> Array:
        """The torques per unit of inertial parameters, rotors aside, shape (n, joints, parameters).

        Args:
            motion: of the motors.
            places: of the parameters, among 10 joints; by default all.
        """
        chosen = range(self.count) if places is None else places
        rotors, unit = self.torques(motion, np.zeros(self.count)), np.eye(self.count)
        found = np.empty((*motion.theta_m.shape, len(chosen)))
        for k, place in enumerate(chosen):
            found[:, :, k] = self.torques(motion, unit[place]) - rotors
        return found

    def met(self, motion: JointMotions, values: Array) -> tuple[Bodies, ...]:
        """What every joint meets, for the inertial parameters (joints, 10)."""
        parameters = self._parameters(values)
        every = self._module.bearing_loads(*self._inputs(motion), parameters)
        loads = dict(zip(self._module.BEARING_LOADS, np.moveaxis(every, -1, 0), strict=True))
        whole, gravity = self.torques(motion, values), self.torques(motion.still, values)
        none = np.zeros(len(whole))
        found = []
        for j in range(len(self._mu)):
            # Its size is a load; its sign is that of what is left without the rotor.
            size, rest = self._mu[j] * loads[f"T_{j}"], whole[:, j] - self._J_m[j] * motion.alpha_m[:, j]
            passed = np.where(rest < 0.0, -size, size) if self._J_m[j] else whole[:, j]
            found.append(
                Bodies(
                    gravity[:, j],
                    passed - gravity[:, j],
                    whole[:, j] - passed,
                    *(loads.get(f"{name}_{j}", none) for name in ("F_N", "F_T", "M_B")),
                )
            )
        return tuple(found)

    def _inputs(self, motion: JointMotions) -> Sequence[Array]:
        return motion.theta_m, motion.omega_m, motion.alpha_m

    def _parameters(self, values: Array):  # noqa: ANN202 - a class of the emitted module
        return self._module.Parameters(**dict(zip(self._names, map(float, np.ravel(values)), strict=True)))
