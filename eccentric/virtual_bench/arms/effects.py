"""An effect in one joint: drawn, sized on the reference, and at work beside the joint's own friction."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, tanh

import numpy as np

from eccentric.virtual_bench.effects import PlantedEffect, PlantSetting, Request
from eccentric.virtual_bench.plant import Plant

from .course import ArmCourse
from .families import ARM_EFFECTS, ARM_VARIANTS
from .friction import FrictionLaw
from .motion import JointMotion
from .plant import BenchArm
from .request import EffectRequest
from .survey import SURVEY_S, Survey, rms

MOVING = 0.02
"""Part of a joint's top speed above which a row counts as in motion."""
SMOOTH = 0.003
"""Part of a joint's top speed over which Coulomb friction turns: sgn w is tanh(w/w_0)."""
GAP_S = 1.0
"""Between two runs, unlogged."""
_RISE_K, _TAU_S, _COLD_C = 40.0, 60.0, 22.0


@dataclass(frozen=True)
class JointEffect:
    """A planted effect, its joint (from 0), and that joint as a drive by itself, with its largest speed."""

    joint: int
    effect: PlantedEffect
    plant: Plant
    top_speed: float  # of the motor [rad/s]


class Acting:
    """An effect at work. The caller moves `motion`; `torques` says what the effect adds, motor side."""

    def __init__(self, planted: JointEffect) -> None:
        self.joint, self.effect, self.plant = planted.joint, planted.effect, planted.plant
        self._laws = list(self.effect.start().items())
        self.motion = JointMotion(planted.plant, len(self._laws))
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

    def heat(self, dry: float, viscous: float, dt: float) -> None:
        """Warm the drive by its losses over a step."""
        s, plant = self.motion, self.plant
        if plant.Rth:
            speed = abs(s.w_mid)
            lost = plant.R * s.i**2 + (dry + viscous * speed) * speed
            s.temperature += dt / plant.tau * (plant.Rth * lost - (s.temperature - plant.Tamb))


def planted(
    rng: np.random.Generator, arm: BenchArm, course: ArmCourse, gone: Survey, request: EffectRequest
) -> JointEffect:
    """Draw an effect, with the amplitude that gives it the requested strength along the reference."""
    drawn = int(rng.integers(len(arm)))  # also if one is given, for the same shapes
    joint = drawn if request.joint is None else request.joint
    variants = ARM_VARIANTS.get(request.family, ("",))
    variant = str(rng.choice(variants))
    friction = friction_of(arm, gone)[:, joint] * arm.links[joint].mu
    setting = _setting(arm, course, gone, joint, friction)
    asked = Request(request.strength, request.variant or variant, request.variant is not None, setting, rng)
    effect = replace(ARM_EFFECTS[request.family](asked), strength=request.strength)
    found = JointEffect(joint, effect, setting.plant, setting.top_speed)
    moving = np.abs(gone.w[:, joint]) > MOVING * course.top[joint]
    for _ in range(6):
        torque = _along(found, arm, course, gone)
        share = float(rms(torque[moving]) / rms(friction[moving]))
        found = corrected(found, share)
    return found


def corrected(found: JointEffect, share: float) -> JointEffect:
    """Return the effect with an amplitude that makes its share of the friction its strength."""
    effect = found.effect
    factor = min(5.0, max(0.2, effect.strength / max(share, 1e-9)))
    return replace(found, effect=replace(effect, amplitude=min(effect.bound, effect.amplitude * factor)))


def friction_of(arm: BenchArm, gone: Survey) -> np.ndarray:
    """Friction of the joints without effects along a survey [N m], shape (rows, joints)."""
    law = FrictionLaw(arm)
    parts = [law.of(bearing) for bearing in gone.bearing]
    dry, viscous = (np.array(part) for part in zip(*parts, strict=True))
    return dry * np.sign(gone.w) + viscous * gone.w


def _setting(
    arm: BenchArm, course: ArmCourse, gone: Survey, joint: int, friction: np.ndarray
) -> PlantSetting:
    """Magnitudes of one joint's motor; its plant is a single drive with the mean load of the joint."""
    link = arm.links[joint]
    mu, own = link.mu, link.friction
    speed, current = gone.w[:, joint] / mu, (gone.torque[:, joint] * mu + friction) / link.k_i
    R = 0.3 * 48.0 / float(np.abs(current).max())  # a third of a bus of 48 V
    seconds = course.runs * (course.seconds + GAP_S)
    loss = float(np.mean(R * current**2 + np.abs(friction * speed)))
    plant = Plant(
        case="C2", M=float(gone.bearing[:, 0, joint].mean()) / 9.81, M_l=0.0, L=0.0, mu=mu, R=R,
        k_i=link.k_i, k_e=0.0, J_m=link.J_m,
        J_l=float(gone.inertia[:, joint].mean()) - link.J_m / mu**2, g=9.81, C_m=own.C_m, B_m=own.B_m,
        C_lN=own.C_lN, B_lN=own.B_lN, gamma_T=0.0, beta_T=0.0, Rth=_RISE_K / loss, tau=_TAU_S, Tamb=_COLD_C,
    )  # fmt: skip
    warming = _RISE_K * (1.0 - (1.0 - exp(-seconds / _TAU_S)) * _TAU_S / seconds)
    top = float(course.top[joint]) / mu
    return PlantSetting(
        plant, float(rms(friction)), float(rms(speed)), top, float(rms(current)), warming, seconds, loss
    )


def _along(found: JointEffect, arm: BenchArm, course: ArmCourse, gone: Survey) -> np.ndarray:
    """Torque of an effect along the survey [N m, motor side], shape (rows,)."""
    acting, law, joint = Acting(found), FrictionLaw(arm), found.joint
    mu, s, rows = arm.links[joint].mu, acting.motion, []
    per_run = len(gone.q) // course.runs
    for n in range(len(gone.q)):
        levels, coefficients = law.of(gone.bearing[n])
        dry, viscous = float(levels[joint]) * mu, float(coefficients[joint]) * mu**2
        run, row = divmod(n, per_run)
        s.t = run * (course.seconds + GAP_S) + row * SURVEY_S
        s.w_before, s.w = s.w, float(gone.w[n, joint]) / mu
        s.w_mid, s.alpha = s.w, float(gone.alpha[n, joint]) / mu
        s.link, s.theta, s.w_link = float(gone.q[n, joint]), float(gone.q[n, joint]) / mu, s.w * mu
        s.normal, s.gravity = float(gone.bearing[n, 0, joint]), float(gone.gravity[n, joint]) * mu
        s.transmitted, s.dry, s.viscous = float(gone.transmitted[n, joint]) * mu, dry, viscous
        s.i = (
            float(gone.torque[n, joint]) * mu + dry * float(np.sign(s.w)) + viscous * s.w
        ) / acting.plant.k_i
        acting.torques(dry, viscous)
        acting.heat(dry, viscous, SURVEY_S)
        s.travel += abs(s.w) * SURVEY_S
        rows.append(acting.torque)
    return np.array(rows)
