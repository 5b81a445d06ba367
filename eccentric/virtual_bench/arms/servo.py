"""The servo drives of an arm: encoders on the motors, position and velocity loops, motor currents."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, pi

import numpy as np


@dataclass(frozen=True)
class ArmServo:
    """How the drives measure and control, one entry a joint.

    A position loop gives the velocity that is wanted beyond the reference, a PI velocity loop the torque of
    the joint. The current is that torque times mu/k_i: the current loop is taken as perfect.

    Attributes:
        counts: encoder counts per motor turn.
        filter_hz: corner of the velocity filter, one pole.
        position: gain of the position loop [1/s].
        velocity: gain of the velocity loop [N m s/rad].
        integral: of it, over `velocity` [1/s].
    """

    counts: np.ndarray
    filter_hz: float
    position: np.ndarray
    velocity: np.ndarray
    integral: np.ndarray


class ArmLoop:
    """The loops at work: one `torque` every `dt`, from rest and with the torque that holds the arm there."""

    def __init__(
        self, servo: ArmServo, mu: np.ndarray, dt: float, q: np.ndarray, holding: np.ndarray
    ) -> None:
        self._servo, self._dt = servo, dt
        self._quantum = 2.0 * pi * mu / servo.counts
        self._pole = 1.0 - exp(-2.0 * pi * servo.filter_hz * dt)
        self._gain = servo.integral * servo.velocity * dt
        self.angle = self._read(q)
        self.speed = np.zeros_like(q)
        self._sum = holding.copy()

    def _read(self, q: np.ndarray) -> np.ndarray:
        return np.floor(q / self._quantum + 0.5) * self._quantum

    def torque(self, q: np.ndarray, wanted: np.ndarray, speed: np.ndarray) -> np.ndarray:
        """Return the torques of the joints [N m] at angles q, where `wanted` [rad] at `speed` [rad/s] was."""
        angle = self._read(q)
        self.speed = self.speed + self._pole * ((angle - self.angle) / self._dt - self.speed)
        self.angle = angle
        error = speed + self._servo.position * (wanted - angle) - self.speed
        self._sum = self._sum + self._gain * error
        return self._servo.velocity * error + self._sum
