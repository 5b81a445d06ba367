"""Effects in a joint of an arm: families, requests, drawing, sizing along the reference, action."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from math import exp, tanh
from typing import cast

import numpy as np

from eccentric.core import InputError
from eccentric.virtual_bench.arms.plant import SURVEY_S, BenchArm, FrictionLaw, Survey
from eccentric.virtual_bench.arms.trajectory import ArmCourse
from eccentric.virtual_bench.effects import (
    EFFECTS,
    VARIANTS,
    Builder,
    PlantedEffect,
    PlantSetting,
    Request,
    Requested,
    back_driven,
    bearing_law,
    check_strength,
    gear_loss,
    known_family,
    simply,
    with_strengths,
)
from eccentric.virtual_bench.plant import Motion, Plant, rms


@dataclass(slots=True, eq=False)
class JointMotion(Motion):
    """`Motion` of the joint's motor, with the transmitted torque.

    `normal` is F_N, `gravity` the holding torque at rest, `transmitted` the signed torque transmitted by the
    gear without friction; both on the motor side [N m].
    """

    transmitted: float = 0.0


_OF_ONE_DRIVE = (
    "stribeck", "quadratic_drag", "cubic_drag", "oneway_windage", "coulomb_asymmetry", "viscous_asymmetry",
    "eddy_current", "sublinear_viscous", "hidden_thermal_drift", "wear_runin", "time_drift",
    "viscosity_temperature", "coulomb_temperature", "stribeck_temperature", "link_harmonic_friction",
    "motor_harmonic_friction", "nonsynchronous_friction",
    "cogging", "kt_ripple", "local_defect", "cable_spring", "presliding", "magnetic_hysteresis",
    "kt_saturation", "current_bias",
)  # fmt: skip
"""Effects whose laws depend only on the motion, current and temperature of one motor."""


def _transmitted(s: Motion) -> float:
    return cast("JointMotion", s).transmitted


def _gravity(s: Motion) -> float:
    return s.gravity


def load_dependent(request: Request) -> PlantedEffect:
    """Dry friction of the gear proportional to the transmitted torque, or to gravity alone."""
    by_gravity = request.variant == "gravity"
    load = _gravity if by_gravity else _transmitted
    return request.effect(
        f"A |{'G' if by_gravity else 'mu T'}| sgn w",
        request.strength,
        simply(dry=lambda s, a: a * abs(load(s))),
        ("gravity_load", "link_angle") if by_gravity else ("transmitted_torque",),
        bound=0.6,
    )


def gear_efficiency(request: Request) -> PlantedEffect:
    """Loss proportional to the transmitted torque, smaller or larger when back-driven."""
    back = back_driven(request)
    return request.effect(
        f"A |mu T| sgn w when driving, {back} A |mu T| sgn w when back-driven",
        request.strength,
        simply(dry=gear_loss(_transmitted, back)),
        ("transmitted_torque", "direction"),
        (back,),
        bound=0.6,
    )


def stribeck_load(request: Request) -> PlantedEffect:
    """Rise of dry friction near rest, proportional to the transmitted torque or F_N."""
    vs = request.draw(0.06, 0.14) * request.setting.top_speed
    by_force = request.variant == "F_N"

    def rise(s: Motion, a: float) -> float:
        return a * (s.normal if by_force else abs(_transmitted(s))) * exp(-((s.w_mid / vs) ** 2))

    return request.effect(
        f"A {'F_N' if by_force else '|mu T|'} exp(-(w/vs)^2) sgn w",
        2.0 * request.strength,
        simply(rise=rise),
        ("velocity", "link_angle") if by_force else ("transmitted_torque", "velocity"),
        (vs,),
    )


def bearing_load(request: Request) -> PlantedEffect:
    """Dry friction of the bearing by a power of F_N, or with a preload across it, in addition to that by F_N.

    It does not replace friction by F_N: the difference could be negative where F_N hardly varies.
    The powers are those of a Hertzian point contact, 2/3, and of a deep-groove ball bearing, 1.55 (Palmgren).
    """
    weight = request.plant.M * request.plant.g
    law, shape, carried = bearing_law(request, weight)
    return request.effect(
        f"A {law} sgn w{'' if request.variant == 'preload' else ', F_0 the mean load'}",
        request.torque() / weight,
        simply(dry=lambda s, a: a * carried(s.normal)),
        ("velocity", "link_angle"),
        (shape,),
    )


ARM_EFFECTS: dict[str, Builder] = {
    **{name: EFFECTS[name] for name in _OF_ONE_DRIVE},
    **{one.__name__: one for one in (load_dependent, gear_efficiency, stribeck_load, bearing_load)},
}
"""Family -> its builder."""

ARM_VARIANTS: dict[str, tuple[str, ...]] = {
    **{name: VARIANTS[name] for name in _OF_ONE_DRIVE if name in VARIANTS},
    "load_dependent": ("transmitted", "gravity"),
    "gear_efficiency": ("easy", "hard"),
    "stribeck_load": ("transmitted", "F_N"),
    "bearing_load": ("Hertz", "Palmgren", "preload"),
}
"""Variants of a family; one without an entry has none."""


STRENGTH = 0.15


@dataclass(frozen=True)
class EffectRequest:
    """One requested effect; without a variant or a joint (from 0), one is drawn."""

    family: str
    variant: str | None
    joint: int | None
    strength: float


def effect_requests(effects: Requested, joints: int) -> list[EffectRequest]:
    """Return the requested effects; raises InputError for one that is not allowed."""
    requests = []
    for name, strength in with_strengths(effects, STRENGTH):
        family, variant, joint = known_joint_effect(name)
        if joint is not None and not 1 <= joint <= joints:
            raise InputError(f"effect {name}", f"a joint from 1 to {joints}", joint)
        check_strength(name, strength)
        requests.append(EffectRequest(family, variant, None if joint is None else joint - 1, float(strength)))
    return requests


def known_joint_effect(name: str) -> tuple[str, str | None, int | None]:
    """Split `family[variant]@joint`; InputError, listing the known effects, for an unknown one."""
    match = re.fullmatch(r"(\w+)(?:\[(.+?)\])?(?:@(\d+))?", name)
    family, variant = known_family(name, match, ARM_EFFECTS, ARM_VARIANTS)
    return family, variant, int(match[3]) if match and match[3] else None


SMOOTH = 0.003
"""w_0 over a joint's top speed: Coulomb friction is smoothed to tanh(w/w_0)."""


@dataclass(frozen=True)
class JointEffect:
    """A planted effect, its joint (from 0), and that joint as a single drive."""

    joint: int
    effect: PlantedEffect
    plant: Plant
    top_speed: float  # of the motor [rad/s]
    # temperature [deg C] and motor travel [rad] at the start of each run
    starts: tuple[tuple[float, float], ...] = ()


class Acting:
    """An acting effect. The caller updates `motion`; `torques` returns the effect's parts, motor side."""

    def __init__(self, planted: JointEffect, run: int) -> None:
        self.joint, self.effect, self.plant = planted.joint, planted.effect, planted.plant
        self._laws = list(self.effect.start().items())
        self.motion = JointMotion(planted.plant, effects=len(self._laws))
        self.motion.temperature, self.motion.travel = planted.starts[run]
        self._width = SMOOTH * planted.top_speed
        self.torque = 0.0  # the effect's, for the truth [N m]
        self.bias = 0.0  # added to the logged current only [A]

    def torques(self, dry: float, viscous: float) -> tuple[float, float, float]:
        """Return the effect's parts: Coulomb level, viscous coefficient, torque against the motor.

        `dry` [N m] and `viscous` [N m s/rad] are the joint's friction without effects.
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
        """Update travel and temperature over a step."""
        s, plant = self.motion, self.plant
        s.travel += abs(s.w_mid) * dt
        if plant.Rth:
            speed = abs(s.w_mid)
            lost = plant.R * s.i**2 + (dry + viscous * speed) * speed
            s.temperature += dt / plant.tau * (plant.Rth * lost - (s.temperature - plant.Tamb))


MOVING = 0.02
"""Fraction of a joint's top speed above which a row counts as moving."""
GAP_S = 1.0
"""Unlogged time between runs."""
RISE_K, TAU_S, COLD_C = 40.0, 60.0, 22.0
"""Final temperature rise of a drive by its mean losses, its time constant, and the initial temperature."""
_DRAWS = 10
"""Largest number of shapes to try."""
_SIZED = 2e-3
"""Relative error of a strength along the reference."""
_OUT_OF_SIGHT = 5.0
"""Amplitude over the first guess from which the course hardly excites a shape."""


def planted(
    rng: np.random.Generator, arm: BenchArm, course: ArmCourse, survey: Survey, request: EffectRequest
) -> JointEffect:
    """Draw an effect with the amplitude for the requested strength along the reference.

    Raises InputError if the course does not excite it: a gear that transmits no torque has no losses.
    """
    drawn = rng.permutation(len(arm)).tolist()  # also if a joint is requested, for the same shapes
    variant = str(rng.choice(ARM_VARIANTS.get(request.family, ("",))))
    joints = drawn if request.joint is None else [request.joint]
    for joint in joints:
        found = _in_joint(rng, arm, course, survey, request, joint, variant)
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
    survey: Survey,
    request: EffectRequest,
    joint: int,
    variant: str,
) -> JointEffect | None:
    """Draw an effect in this joint; None if no shape reaches the strength with a plausible amplitude."""
    friction = friction_of(arm, survey)[:, joint] * arm.links[joint].mu
    setting = _setting(arm, course, survey, joint, friction)
    is_requested = request.variant is not None
    drawn = Request(request.family, request.strength, request.variant or variant, is_requested, setting, rng)
    moving = np.abs(survey.w[:, joint]) > MOVING * course.top[joint]
    cold = ((COLD_C, 0.0),) * course.runs
    for _ in range(_DRAWS):
        effect = ARM_EFFECTS[request.family](drawn)
        sized = JointEffect(joint, effect, setting.plant, setting.top_speed, cold)
        for _ in range(6):
            torque, starts = _along(sized, arm, course, survey)
            sized = replace(sized, starts=starts)
            share = float(rms(torque[moving]) / rms(friction[moving]))
            if abs(share / request.strength - 1.0) < _SIZED:
                break
            sized = corrected(sized, share)
        if sized.effect.amplitude < _OUT_OF_SIGHT * effect.amplitude:
            return sized
    return None


def corrected(one: JointEffect, share: float) -> JointEffect:
    """Return the effect with its amplitude scaled from this share of the friction to its strength."""
    effect = one.effect
    factor = min(5.0, max(0.2, effect.strength / max(share, 1e-9)))
    return replace(one, effect=replace(effect, amplitude=min(effect.bound, effect.amplitude * factor)))


def friction_of(arm: BenchArm, survey: Survey) -> np.ndarray:
    """Friction of the joints without effects along a survey [N m], shape (rows, joints)."""
    dry, viscous = FrictionLaw(arm).of(survey.bearing)
    return dry * np.sign(survey.w) + viscous * survey.w


def _setting(
    arm: BenchArm, course: ArmCourse, survey: Survey, joint: int, friction: np.ndarray
) -> PlantSetting:
    """Signal magnitudes of one joint's motor; its plant is a single drive with the joint's mean load."""
    link = arm.links[joint]
    mu, law = link.mu, link.friction
    speed, current = survey.w[:, joint] / mu, (survey.torque[:, joint] * mu + friction) / link.k_i
    R = 0.3 * 48.0 / float(np.abs(current).max())  # a third of a bus of 48 V
    seconds = course.runs * (course.seconds + GAP_S)
    loss = float(np.mean(R * current**2 + np.abs(friction * speed)))
    plant = Plant(
        case="C2", M=float(survey.bearing[:, 0, joint].mean()) / 9.81, M_l=0.0, L=0.0, mu=mu, R=R,
        k_i=link.k_i, k_e=0.0, J_m=link.J_m,
        J_l=float(survey.inertia[:, joint].mean()) - link.J_m / mu**2, g=9.81, C_m=law.C_m,
        B_m=law.B_m, C_lN=law.C_lN, B_lN=law.B_lN, gamma_T=0.0, beta_T=0.0,
        Rth=RISE_K / loss, tau=TAU_S, Tamb=COLD_C,
    )  # fmt: skip
    warming = RISE_K * (1.0 - (1.0 - exp(-seconds / TAU_S)) * TAU_S / seconds)
    top = float(course.top[joint]) / mu
    return PlantSetting(
        plant, float(rms(friction)), float(rms(speed)), top, float(rms(current)), warming, seconds, loss
    )


def _along(
    one: JointEffect, arm: BenchArm, course: ArmCourse, survey: Survey
) -> tuple[np.ndarray, tuple[tuple[float, float], ...]]:
    """Torque of an effect along the survey [N m, motor side], (rows,), and `starts` of the runs."""
    law, j, rows, starts = FrictionLaw(arm), one.joint, [], [(COLD_C, 0.0)]
    mu, per_run = arm.links[j].mu, len(survey.q) // course.runs
    dry, viscous = (part[:, j] * gear for part, gear in zip(law.of(survey.bearing), (mu, mu**2), strict=True))
    w, alpha, link = survey.w[:, j] / mu, survey.alpha[:, j] / mu, survey.q[:, j]
    normal, gravity, passed = (
        survey.bearing[:, 0, j],
        survey.gravity[:, j] * mu,
        survey.transmitted[:, j] * mu,
    )
    current = (survey.torque[:, j] * mu + dry * np.sign(w) + viscous * w) / one.plant.k_i
    for run in range(course.runs):
        acting = Acting(replace(one, starts=tuple(starts)), run)
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
