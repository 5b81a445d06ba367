"""An effect in one joint: drawn, and sized on the reference."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, tanh

import numpy as np

from eccentric.core import InputError
from eccentric.virtual_bench.arms.engine import SURVEY_S, Survey, rms
from eccentric.virtual_bench.arms.families import ARM_EFFECTS, ARM_VARIANTS, EffectRequest, JointMotion
from eccentric.virtual_bench.arms.plant import BenchArm, FrictionLaw
from eccentric.virtual_bench.arms.trajectory import ArmCourse
from eccentric.virtual_bench.effects import PlantedEffect, PlantSetting, Request
from eccentric.virtual_bench.plant import Plant

# An effect of one joint at work beside that joint's own friction.


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


MOVING = 0.02
"""Part of a joint's top speed above which a row counts as in motion."""
GAP_S = 1.0
"""Between two runs, unlogged."""
RISE_K, TAU_S, COLD_C = 40.0, 60.0, 22.0
"""Of a drive by its mean losses, in the end; how fast; before."""
_DRAWS = 10
"""Shapes that are tried."""
_SIZED = 2e-3
"""Relative error of a strength along the reference."""
_OUT_OF_SIGHT = 5.0
"""An amplitude so many times the first guess belongs to a shape that the course hardly meets."""


def planted(
    rng: np.random.Generator, arm: BenchArm, course: ArmCourse, gone: Survey, request: EffectRequest
) -> JointEffect:
    """Draw an effect, with the amplitude that gives it the requested strength along the reference.

    Raises InputError if the course does not show it: a gear that passes on no torque has no losses.
    """
    drawn = rng.permutation(len(arm)).tolist()  # also if one is given, for the same shapes
    variant = str(rng.choice(ARM_VARIANTS.get(request.family, ("",))))
    joints = drawn if request.joint is None else [request.joint]
    for joint in joints:
        found = _in_joint(rng, arm, course, gone, request, joint, variant)
        if found is not None:
            return found
    where = " or ".join(str(joint + 1) for joint in sorted(joints))
    raise InputError(
        f"effect {request.family}",
        problem=f"expected a course that shows it in joint {where}; try another seed",
    )


def _in_joint(
    rng: np.random.Generator,
    arm: BenchArm,
    course: ArmCourse,
    gone: Survey,
    request: EffectRequest,
    joint: int,
    variant: str,
) -> JointEffect | None:
    """Draw an effect in this joint; None if no shape of a plausible amplitude has the strength."""
    friction = friction_of(arm, gone)[:, joint] * arm.links[joint].mu
    setting = _setting(arm, course, gone, joint, friction)
    asked = Request(request.strength, request.variant or variant, request.variant is not None, setting, rng)
    moving = np.abs(gone.w[:, joint]) > MOVING * course.top[joint]
    cold = ((COLD_C, 0.0),) * course.runs
    for _ in range(_DRAWS):
        effect = replace(ARM_EFFECTS[request.family](asked), strength=request.strength)
        found = JointEffect(joint, effect, setting.plant, setting.top_speed, cold)
        for _ in range(6):
            torque, starts = _along(found, arm, course, gone)
            found = replace(found, starts=starts)
            share = float(rms(torque[moving]) / rms(friction[moving]))
            if abs(share / request.strength - 1.0) < _SIZED:
                break
            found = corrected(found, share)
        if found.effect.amplitude < _OUT_OF_SIGHT * effect.amplitude:
            return found
    return None


def corrected(found: JointEffect, share: float) -> JointEffect:
    """Return the effect with an amplitude that makes its share of the friction its strength."""
    effect = found.effect
    factor = min(5.0, max(0.2, effect.strength / max(share, 1e-9)))
    return replace(found, effect=replace(effect, amplitude=min(effect.bound, effect.amplitude * factor)))


def friction_of(arm: BenchArm, gone: Survey) -> np.ndarray:
    """Friction of the joints without effects along a survey [N m], shape (rows, joints)."""
    dry, viscous = FrictionLaw(arm).of(gone.bearing)
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
        C_lN=own.C_lN, B_lN=own.B_lN, gamma_T=0.0, beta_T=0.0, Rth=RISE_K / loss, tau=TAU_S, Tamb=COLD_C,
    )  # fmt: skip
    warming = RISE_K * (1.0 - (1.0 - exp(-seconds / TAU_S)) * TAU_S / seconds)
    top = float(course.top[joint]) / mu
    return PlantSetting(
        plant, float(rms(friction)), float(rms(speed)), top, float(rms(current)), warming, seconds, loss
    )


def _along(
    found: JointEffect, arm: BenchArm, course: ArmCourse, gone: Survey
) -> tuple[np.ndarray, tuple[tuple[float, float], ...]]:
    """Torque of an effect along the survey [N m, motor side], (rows,), and `starts` of the runs."""
    law, j, rows, starts = FrictionLaw(arm), found.joint, [], [(COLD_C, 0.0)]
    mu, per_run = arm.links[j].mu, len(gone.q) // course.runs
    dry, viscous = (part[:, j] * gear for part, gear in zip(law.of(gone.bearing), (mu, mu**2), strict=True))
    w, alpha, link = gone.w[:, j] / mu, gone.alpha[:, j] / mu, gone.q[:, j]
    normal, gravity, passed = gone.bearing[:, 0, j], gone.gravity[:, j] * mu, gone.transmitted[:, j] * mu
    current = (gone.torque[:, j] * mu + dry * np.sign(w) + viscous * w) / found.plant.k_i
    for run in range(course.runs):
        acting = Acting(replace(found, starts=tuple(starts)), run)
        s = acting.motion
        for row in range(per_run):
            n = run * per_run + row
            s.t = run * (course.seconds + GAP_S) + row * SURVEY_S
            s.w_before, s.w = s.w, float(w[n])
            s.w_mid, s.w_link, s.alpha = s.w, s.w * mu, float(alpha[n])
            s.link, s.theta = float(link[n]), float(link[n]) / mu
            s.normal, s.gravity, s.transmitted = float(normal[n]), float(gravity[n]), float(passed[n])
            s.dry, s.viscous, s.i = float(dry[n]), float(viscous[n]), float(current[n])
            acting.torques(s.dry, s.viscous)
            acting.advance(s.dry, s.viscous, SURVEY_S)
            rows.append(acting.torque)
        starts.append((s.temperature, s.travel))
    return np.array(rows), tuple(starts[:-1])
