"""Scenario of an arm -> log, rig, arm and sealed truth: the arm under its servo drives, step by step.

One step of dt: the angles drift half a step, the velocities are kicked, the angles drift the other half.

    (M + dt/2 D) alpha = tau - bias - f(w_mid) - D (w - w_mid),   D = df/dw at w_mid

All of it is taken in the middle of the step, where w_mid is extrapolated from the last two: second order in
dt. Friction is implicit in the velocity, so that Coulomb friction, tanh(w/w_0), is stable however steep it
is; its loads are those of the step before, 1 ms late: 0.6 % of what varies at 1 Hz.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .course import ArmCourse
from .effects import GAP_S, MOVING, SMOOTH, Acting, corrected
from .engine import RigidArm
from .friction import FrictionLaw
from .scenario import ArmScenario
from .servo import ArmLoop
from .survey import rms

Progress = Callable[[float], None]
"""Told the part that is done, 0 to 1."""
_CLOSE = 0.03
"""Relative error of an effect's strength that is good enough."""


@dataclass(frozen=True)
class ArmTrace:
    """The true motion, one row a sample: shape (rows, joints) unless stated; torques [N m] of the motors.

    Attributes:
        run: number of the run, (rows,).
        t: time [s] from the start of the first run, (rows,).
        q, w: angles and velocities of the joints.
        speed: velocities as the drives measure them.
        current: of the motors, without noise [A].
        friction: of motor and bearing, without effects.
        bearing: F_N, F_T [N], M_B [N m], (rows, 3, joints).
        transmitted: torque that each gear passes on, of the joint.
        effects: torque of each effect, (rows, effects).
        temperature: of each effect's drive [deg C], (rows, effects).
    """

    run: np.ndarray
    t: np.ndarray
    q: np.ndarray
    w: np.ndarray
    speed: np.ndarray
    current: np.ndarray
    friction: np.ndarray
    bearing: np.ndarray
    transmitted: np.ndarray
    effects: np.ndarray
    temperature: np.ndarray

    def moving(self, course: ArmCourse) -> np.ndarray:
        """Rows in motion, by joint."""
        return np.abs(self.w) > MOVING * course.top

    def shares(self, scenario: ArmScenario) -> list[float]:
        """Rms of each effect over that of its joint's friction, over rows in motion."""
        moving, found = self.moving(scenario.course), []
        for k, one in enumerate(scenario.effects):
            rows = moving[:, one.joint]
            found.append(float(rms(self.effects[rows, k]) / rms(self.friction[rows, one.joint])))
        return found


def trace(scenario: ArmScenario, progress: Progress | None = None) -> tuple[ArmScenario, ArmTrace]:
    """Run the arm; once more where an effect differs from its strength by over 3 %, with another amplitude.

    Returns the scenario with the amplitudes that were used, and the motion.
    """
    found = _all_runs(scenario, progress)
    shares = found.shares(scenario)
    wrong = [
        abs(share / one.effect.strength - 1.0) > _CLOSE
        and not (share < one.effect.strength and one.effect.amplitude >= one.effect.bound)
        for one, share in zip(scenario.effects, shares, strict=True)
    ]
    if any(wrong):
        effects = tuple(corrected(*pair) for pair in zip(scenario.effects, shares, strict=True))
        scenario = replace(scenario, effects=effects)
        found = _all_runs(scenario, progress)
    return scenario, found


def _all_runs(scenario: ArmScenario, progress: Progress | None) -> ArmTrace:
    acting = [Acting(one) for one in scenario.effects]
    rows: list[tuple[Any, ...]] = []
    for run in range(scenario.course.runs):
        _one_run(scenario, run, acting, rows)
        if progress is not None:
            progress((run + 1) / scenario.course.runs)
    run, t, q, w, speed, *rest = (np.array(part) for part in zip(*rows, strict=True))
    return ArmTrace(run, t, q, w, speed, *rest)


def _one_run(scenario: ArmScenario, run: int, acting: list[Acting], rows: list[tuple[Any, ...]]) -> None:
    """Append the samples of one run."""
    arm, course, steps = scenario.arm, scenario.course, scenario.steps_per_sample
    dt = 1.0 / (scenario.sample_rate_hz * steps)
    count = round(course.seconds * scenario.sample_rate_hz)
    time = np.arange(count * steps) * dt
    wanted, speeds = course.reference(run, time)
    begins = run * (course.seconds + GAP_S)
    mu, k_i, n = arm.column("mu"), arm.column("k_i"), len(arm)
    per_amp = k_i / mu
    rigid, law, width = RigidArm(arm), FrictionLaw(arm), SMOOTH * course.top

    q, w = wanted[0].copy(), np.zeros(n)
    rigid.place(q, w)
    holding = rigid.gravity_torque()
    loads = rigid.loads(np.zeros(n))
    loop = ArmLoop(scenario.servo, mu, dt, q, holding)
    before, alpha, current = w, np.zeros(n), holding / per_amp
    bias = np.zeros(n)
    for k in range(count * steps):
        last, at_start, moved = current, q, w
        torque = loop.torque(q, wanted[k], speeds[k])
        current = torque / per_amp
        middle = 1.5 * w - 0.5 * before
        middle = np.where(middle * w > 0.0, middle, w)
        q = q + 0.5 * dt * w
        rigid.place(q, middle)
        mass, pull = rigid.mass(), rigid.bias()
        dry, viscous = law.of(loads.bearing)
        own_dry, own_viscous = dry, viscous
        for one in acting:
            j = one.joint
            s, ratio = one.motion, float(mu[j])
            s.t, s.i, s.alpha = begins + k * dt, float(current[j]), float(alpha[j]) / ratio
            s.w_before, s.w, s.w_mid = float(before[j]) / ratio, float(w[j]) / ratio, float(middle[j]) / ratio
            s.link, s.w_link = float(q[j]), float(middle[j])
            s.theta = s.link / ratio
            s.normal, s.transmitted = float(loads.bearing[0, j]), float(loads.transmitted[j]) * ratio
            s.gravity = float(rigid.gravity_torque()[j]) * ratio
            s.dry, s.viscous = float(own_dry[j]) * ratio, float(own_viscous[j]) * ratio**2
            level, coefficient, against = one.torques(s.dry, s.viscous)
            dry, viscous, torque = dry.copy(), viscous.copy(), torque.copy()
            dry[j] += level / ratio
            viscous[j] += coefficient / ratio**2
            torque[j] -= against / ratio
            one.heat(s.dry, s.viscous, dt)
            s.travel += abs(s.w_mid) * dt
            bias[j] = one.bias
        way = np.tanh(middle / width)
        friction, slope = dry * way + viscous * middle, dry * (1.0 - way * way) / width + viscous
        left = mass.copy()
        left.flat[:: n + 1] += 0.5 * dt * slope
        alpha = np.linalg.solve(left, torque - pull - friction - slope * (w - middle))
        if k % steps == 0:
            own = mu * (own_dry * way + own_viscous * middle)
            # The drive averages the current over the two pulses around the sample: it does not lead.
            logged = 0.5 * ((last if k else current) + current) + bias
            rows.append(
                (run + 1, begins + k * dt, at_start, moved, loop.speed, logged, own, loads.bearing,
                 loads.transmitted, [one.torque for one in acting],
                 [one.motion.temperature for one in acting])
            )  # fmt: skip
        loads = rigid.loads(alpha)
        before, w = w, w + dt * alpha
        q = q + 0.5 * dt * w
