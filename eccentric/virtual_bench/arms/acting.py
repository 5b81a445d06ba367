"""An effect of one joint at work beside that joint's own friction."""

from __future__ import annotations

from dataclasses import dataclass
from math import tanh

from eccentric.virtual_bench.arms.motion import JointMotion
from eccentric.virtual_bench.effects import PlantedEffect
from eccentric.virtual_bench.plant import Plant

SMOOTH = 0.003
"""Part of a joint's top speed over which Coulomb friction turns: sgn w is tanh(w/w_0)."""


@dataclass(frozen=True)
class JointEffect:
    """A planted effect, its joint (from 0), and that joint as a drive by itself.

    Attributes:
        top_speed: of the motor [rad/s].
        starts: of each run, the temperature [deg C] and the distance travelled by the motor [rad].
    """

    joint: int
    effect: PlantedEffect
    plant: Plant
    top_speed: float
    starts: tuple[tuple[float, float], ...] = ()


class Acting:
    """An effect at work. The caller moves `motion`; `torques` says what the effect adds, motor side."""

    def __init__(self, planted: JointEffect, run: int) -> None:
        self.joint, self.effect, self.plant = planted.joint, planted.effect, planted.plant
        self._laws = list(self.effect.start().items())
        self.motion = JointMotion(planted.plant, len(self._laws))
        self.motion.temperature, self.motion.travel = planted.starts[run]
        self._width = SMOOTH * planted.top_speed
        self.torque = 0.0  # the effect's, for the truth [N m]
        self.bias = 0.0  # added to the logged current only [A]

    def torques(self, dry: float, viscous: float) -> tuple[float, float, float]:
        """Return what the effect adds: to the Coulomb level, to the viscous coefficient, against the motor.

        `dry` [N m] and `viscous` [N m s/rad] are the joint's own friction.
        """
        s, amplitude = self.motion, self.effect.amplitude
        level = coefficient = against = near_rest = 0.0
        self.bias = 0.0
        for port, law in self._laws:
            value = law(s, amplitude)
            if port in {"dry", "rise"}:
                level += value
                near_rest += value if port == "rise" else 0.0
            elif port in {"viscous", "drag"}:
                coefficient += value
            elif port == "warm dry":
                level += value * dry
            elif port == "warm viscous":
                coefficient += value * viscous
            elif port == "warm rise":
                level += value * near_rest
            elif port == "torque":
                against += value
            elif port == "flux":
                against -= value * self.plant.k_i * s.i
            elif port == "current":
                self.bias += value
            else:
                raise NotImplementedError(port)
        self.torque = level * tanh(s.w_mid / self._width) + coefficient * s.w_mid + against
        self.torque += self.plant.k_i * self.bias
        return level, coefficient, against

    def advance(self, dry: float, viscous: float, dt: float) -> None:
        """Travel, and warm the drive by its losses, over a step."""
        s, plant = self.motion, self.plant
        s.travel += abs(s.w_mid) * dt
        if plant.Rth:
            speed = abs(s.w_mid)
            lost = plant.R * s.i**2 + (dry + viscous * speed) * speed
            s.temperature += dt / plant.tau * (plant.Rth * lost - (s.temperature - plant.Tamb))
