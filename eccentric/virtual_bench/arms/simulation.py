"""Simulation of an arm under its servo drives, step by step.

One step of dt: the angles drift half a step, the velocities are kicked, the angles drift the other half.

    (M + dt/2 D) alpha = tau - bias - f(w_mid) - D (w - w_mid),   D = df/dw at w_mid

Everything is evaluated at the middle of the step, with w_mid extrapolated from the last two velocities:
second order in dt. Friction is implicit in the velocity, so that Coulomb friction, tanh(w/w_0), is stable
however steep; its loads are those of the previous step, 1 ms late: 0.6 % of a 1 Hz variation. With steps a
quarter as long the currents differ by 0.1 to 0.2 % of their rms.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import lfilter

from eccentric.virtual_bench.arms.effects import (
    COLD_C,
    GAP_S,
    MOVING,
    RISE_K,
    SMOOTH,
    TAU_S,
    Acting,
    JointEffect,
    corrected,
)
from eccentric.virtual_bench.arms.plant import FrictionLaw, JointLoads, RigidArm
from eccentric.virtual_bench.arms.scenario import ArmScenario
from eccentric.virtual_bench.arms.trajectory import ArmCourse, ArmLoop
from eccentric.virtual_bench.files import LOG, csv_archive, json_bytes, new_paths, write_new
from eccentric.virtual_bench.plant import rms

Progress = Callable[[float], None]
"""Called with the completed fraction, 0 to 1."""
_CLOSE = 0.03
"""Tolerated relative error of an effect's strength."""


@dataclass(frozen=True)
class ArmTrace:
    """The true motion, one row per sample, shape (rows, joints) unless stated; motor torques [N m]."""

    run: np.ndarray  # number of the run, (rows,)
    t: np.ndarray  # time [s] from the start of the first run, (rows,)
    q: np.ndarray  # angles of the joints
    w: np.ndarray  # their velocities
    speed: np.ndarray  # velocities measured by the drives
    current: np.ndarray  # of the motors, without noise [A]
    friction: np.ndarray  # of motor and bearing, without effects
    bearing: np.ndarray  # F_N, F_T [N], M_B [N m], (rows, 3, joints)
    effects: np.ndarray  # torque of each effect, (rows, effects)
    temperature: np.ndarray  # of each effect's drive [deg C], (rows, effects)

    def moving(self, course: ArmCourse) -> np.ndarray:
        """Rows in motion, by joint."""
        return np.abs(self.w) > MOVING * course.top

    def shares(self, scenario: ArmScenario) -> list[float]:
        """Rms of each effect over that of its joint's friction, over rows in motion."""
        moving, shares = self.moving(scenario.course), []
        for k, one in enumerate(scenario.effects):
            rows = moving[:, one.joint]
            shares.append(float(rms(self.effects[rows, k]) / rms(self.friction[rows, one.joint])))
        return shares


def trace(scenario: ArmScenario, progress: Progress | None = None) -> tuple[ArmScenario, ArmTrace]:
    """Run the arm; again with corrected amplitudes if an effect's strength is off by more than 3 %.

    Returns the scenario with the amplitudes used, and the motion.
    """
    run = _all_runs(scenario, progress)
    shares = run.shares(scenario)
    wrong = [
        abs(share / one.effect.strength - 1.0) > _CLOSE
        and not (share < one.effect.strength and one.effect.amplitude >= one.effect.bound)
        for one, share in zip(scenario.effects, shares, strict=True)
    ]
    if any(wrong):
        effects = tuple(corrected(*pair) for pair in zip(scenario.effects, shares, strict=True))
        scenario = replace(scenario, effects=effects)
        run = _all_runs(scenario, progress)
    return scenario, run


def _all_runs(scenario: ArmScenario, progress: Progress | None) -> ArmTrace:
    """Simulate all runs in parallel: arrays have one row per run."""
    arm, course, steps = scenario.arm, scenario.course, scenario.steps_per_sample
    dt, runs, n = 1.0 / (scenario.sample_rate_hz * steps), course.runs, len(arm)
    count = round(course.seconds * scenario.sample_rate_hz)
    time = np.arange(count * steps) * dt
    wanted, speeds = (
        np.stack(part, axis=1) for part in zip(*(course.reference(r, time) for r in range(runs)), strict=True)
    )
    begins = np.arange(runs) * (course.seconds + GAP_S)
    mu = arm.column("mu")
    per_amp = arm.column("k_i") / mu
    rigid, law, width = RigidArm(arm, runs), FrictionLaw(arm), SMOOTH * course.top
    acting = [[Acting(one, run) for one in scenario.effects] for run in range(runs)]

    q, w = wanted[0].copy(), np.zeros((runs, n))
    rigid.place(q, w)
    holding = rigid.gravity_torque()
    loads = rigid.loads(w)
    loop = ArmLoop(scenario.servo, mu, dt, q, holding)
    before, alpha, current = w, np.zeros((runs, n)), holding / per_amp
    diagonal, rows = np.arange(n), []
    for k in range(count * steps):
        last, at_start, moved = current, q, w
        torque = loop.torque(q, wanted[k], speeds[k])
        current = torque / per_amp
        middle = 1.5 * w - 0.5 * before
        middle = np.where(middle * w > 0.0, middle, w)
        q = q + 0.5 * dt * w
        rigid.place(q, middle)
        mass, pull = rigid.mass(), rigid.bias()
        base_dry, base_viscous = dry, viscous = law.of(loads.bearing)
        bias: float | np.ndarray = 0.0
        if scenario.effects:
            moving = _Step(begins + k * dt, dt, q, w, before, middle, alpha, current, rigid.gravity_torque())
            dry, viscous, against, bias = _with_effects(acting, moving, loads, base_dry, base_viscous, mu)
            torque = torque - against
        way = np.tanh(middle / width)
        friction, slope = dry * way + viscous * middle, dry * (1.0 - way * way) / width + viscous
        mass[:, diagonal, diagonal] += 0.5 * dt * slope
        right = torque - pull - friction - slope * (w - middle)
        alpha = np.linalg.solve(mass, right[:, :, None])[:, :, 0]
        if k % steps == 0:
            base_friction = mu * (base_dry * way + base_viscous * middle)
            # The drive averages the current over the two pulses around the sample, so it does not lead.
            logged = 0.5 * ((last if k else current) + current) + bias
            rows.append(
                (
                    begins + k * dt,
                    at_start,
                    moved,
                    loop.speed,
                    logged,
                    base_friction,
                    loads.bearing,
                    *_effect_rows(acting),
                )
            )
            if progress is not None and k % (100 * steps) == 0:
                progress(k / (count * steps))
        loads = rigid.loads(alpha)
        before, w = w, w + dt * alpha
        q = q + 0.5 * dt * w
    if progress is not None:
        progress(1.0)
    # From (rows of a run, runs, ...) to the runs in sequence.
    columns = (
        np.array(part).swapaxes(0, 1).reshape(runs * count, *np.shape(part[0])[1:])
        for part in zip(*rows, strict=True)
    )
    return ArmTrace(np.repeat(np.arange(1, runs + 1), count), *columns)


@dataclass(frozen=True)
class _Step:
    """The motion at one step: times of the runs (runs,), joint quantities (runs, joints)."""

    t: np.ndarray
    dt: float
    q: np.ndarray
    w: np.ndarray
    before: np.ndarray
    middle: np.ndarray
    alpha: np.ndarray
    current: np.ndarray
    gravity: np.ndarray


def _with_effects(
    acting: list[list[Acting]],
    step: _Step,
    loads: JointLoads,
    dry: np.ndarray,
    viscous: np.ndarray,
    mu: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Coulomb level and viscous coefficient with effects, opposing joint torque, current bias."""
    level, coefficient = dry.copy(), viscous.copy()
    against, bias = np.zeros_like(dry), np.zeros_like(dry)
    for run, effects in enumerate(acting):
        for one in effects:
            j, s = one.joint, one.motion
            at, ratio = (run, j), float(mu[j])
            s.t, s.i, s.alpha = float(step.t[run]), float(step.current[at]), float(step.alpha[at]) / ratio
            s.w_before, s.w = float(step.before[at]) / ratio, float(step.w[at]) / ratio
            s.link, s.w_link = float(step.q[at]), float(step.middle[at])
            s.theta, s.w_mid = s.link / ratio, s.w_link / ratio
            s.normal, s.transmitted = float(loads.bearing[run, 0, j]), float(loads.transmitted[at]) * ratio
            s.gravity = float(step.gravity[at]) * ratio
            s.dry, s.viscous = float(dry[at]) * ratio, float(viscous[at]) * ratio**2
            more, thicker, torque = one.torques(s.dry, s.viscous)
            one.advance(s.dry, s.viscous, step.dt)
            level[at] += more / ratio
            coefficient[at] += thicker / ratio**2
            against[at] += torque / ratio
            bias[at] += one.bias
    return level, coefficient, against, bias


def _effect_rows(acting: list[list[Acting]]) -> tuple[list[list[float]], list[list[float]]]:
    return (
        [[one.torque for one in effects] for effects in acting],
        [[one.motion.temperature for one in effects] for effects in acting],
    )


def logs_temperature(effects: Sequence[JointEffect]) -> bool:
    """Whether the log has a temperature of every drive: if an effect needs it."""
    return any(one.effect.needs_temperature for one in effects)


def warmed(rubbed: np.ndarray, current: np.ndarray, dt: float) -> np.ndarray:
    """Temperature of each drive [deg C], shape (rows, joints), heated half by friction, half by the winding.

    Args:
        rubbed: friction power [W], (rows, joints), in any scale.
        current: [A], (rows, joints), in any scale.
        dt: time between rows [s].
    """
    lost = rubbed / rubbed.mean(axis=0) + current**2 / np.mean(current**2, axis=0)
    step = dt / TAU_S
    return COLD_C + np.asarray(lfilter([0.5 * RISE_K * step], [1.0, step - 1.0], lost, axis=0))


@dataclass(frozen=True)
class ArmRun:
    """A log (`columns`: name -> array of shape (rows,), as written), its `rig`, `arm` and sealed `truth`."""

    columns: dict[str, np.ndarray]
    rig: dict[str, Any]
    arm: dict[str, Any]
    truth: dict[str, Any]


def simulate_arm(scenario: ArmScenario, progress: Progress | None = None) -> ArmRun:
    """Run the bench for arms; the same scenario gives the same run.

    Each effect has the requested strength, its rms over that of its joint's friction, to 3 %, or as close as
    its physical bound allows; the truth contains the actual one. `progress` gets the completed fraction.
    """
    scenario, motion = trace(scenario, progress)
    return ArmRun(_log(scenario, motion), _rig(scenario), declared(scenario), _truth(scenario, motion))


def _log(scenario: ArmScenario, motion: ArmTrace) -> dict[str, np.ndarray]:
    """Columns as recorded by a drive: quantised, noisy, rounded to the file's digits."""
    rng, arm = np.random.default_rng(scenario.seed), scenario.arm
    columns = {"run": motion.run.astype(float), "t_s": np.round(motion.t, 4)}
    mu = arm.column("mu")
    quantum = 2.0 * pi * mu / scenario.servo.counts
    peak = np.abs(motion.current).max(axis=0)
    bit = peak / 2048.0
    current = motion.current + scenario.noise * peak * rng.standard_normal(motion.current.shape)
    current = np.floor(current / bit + 0.5) * bit
    drive = {"current": ("i_A", current), "torque": ("tau_Nm", current * arm.column("k_i") / mu)}
    measured = {
        "q_rad": (np.floor(motion.q / quantum + 0.5) * quantum, 7),
        "w_rad_s": (motion.speed, 5),
        drive[scenario.measured][0]: (drive[scenario.measured][1], 5),
    }
    if logs_temperature(scenario.effects):
        warm = warmed(np.abs(motion.friction * motion.w) / mu, motion.current, 1.0 / scenario.sample_rate_hz)
        for k, one in enumerate(scenario.effects):
            warm[:, one.joint] = motion.temperature[:, k]
        sensed = warm + 0.05 * rng.standard_normal(warm.shape)
        measured["temperature_C"] = np.floor(sensed / 0.1 + 0.5) * 0.1, 2
    for name, (values, digits) in measured.items():
        for j in range(len(arm)):
            columns[f"{name}_{j + 1}"] = np.round(values[:, j], digits) + 0.0  # no negative zeros
    return columns


def _rig(scenario: ArmScenario) -> dict[str, Any]:
    columns = {"time": "t_s", "run": "run", "theta_l": "q_rad_{j}", "omega_l": "w_rad_s_{j}"}
    if scenario.measured == "torque":
        drives = {}
        columns["torque_l"] = "tau_Nm_{j}"
    else:
        drives = {"k_i_Nm_per_A": [link.k_i for link in scenario.arm.links]}
        columns["current"] = "i_A_{j}"
    if logs_temperature(scenario.effects):
        columns["temperature"] = "temperature_C_{j}"
    rig = {
        "arm": f"{scenario.name}.arm.toml",
        "drive": scenario.measured,
        "columns": columns,
        "joints": {"first": 1, "inertial": "known"},
    }
    return rig | ({"drives": drives} if drives else {})


def declared(scenario: ArmScenario) -> dict[str, Any]:
    """The arm without its friction."""
    joints = []
    for j, link in enumerate(scenario.arm.links):
        xx, yy, zz, xy, xz, yz = link.inertia
        joints.append({
            "name": f"joint_{j + 1}",
            "kind": "revolute",
            "axis": list(link.axis),
            "position_m": list(link.position),
            "rpy_rad": list(link.rpy),
            "mu": f"1/{round(1.0 / link.mu)}",
            "J_m_kgm2": link.J_m,
            "body": {"mass_kg": link.mass, "centre_m": list(link.centre),
                     "inertia_kgm2": [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]},
        })  # fmt: skip
    return {"name": scenario.arm.name, "gravity_m_s2": list(scenario.arm.gravity), "joint": joints}


def _truth(scenario: ArmScenario, motion: ArmTrace) -> dict[str, Any]:
    moving, shares = motion.moving(scenario.course), motion.shares(scenario)
    joints = [
        {"name": f"joint_{j + 1}", "mu": link.mu, "friction": asdict(link.friction),
         "friction_rms_Nm": float(rms(motion.friction[moving[:, j], j])),
         "load_rms": dict(zip(("F_N", "F_T", "M_B"),
                              rms(motion.bearing[moving[:, j], :, j]).tolist(), strict=True))}
        for j, link in enumerate(scenario.arm.links)
    ]  # fmt: skip
    return {
        "name": scenario.name,
        "arm": scenario.arm.name,
        "kind": "effect" if scenario.effects else "control",
        "log": scenario.course.log_type,
        "runs": scenario.course.runs,
        "rows": len(motion.t),
        "noise_frac_of_range": scenario.noise,
        "joints": joints,
        "effects": [
            {"joint": one.joint + 1, "id": one.effect.id, "family": one.effect.family,
             "form": one.effect.form, "amplitude": one.effect.amplitude, "shape": list(one.effect.shape),
             "rms_fraction_asked": one.effect.strength, "rms_fraction_of_friction": share,
             "rms_fraction_beyond_the_model": _beyond(scenario, motion, k),
             "depends_on": list(one.effect.depends_on)}
            for k, (one, share) in enumerate(zip(scenario.effects, shares, strict=True))
        ],
    }  # fmt: skip


def _beyond(scenario: ArmScenario, recorded: ArmTrace, k: int) -> float:
    """Rms residual of an effect after refitting friction by bearing loads, over the joint's friction."""
    j = scenario.effects[k].joint
    rows = recorded.moving(scenario.course)[:, j]
    w = recorded.w[rows, j]
    loads = [np.ones_like(w), *recorded.bearing[rows, :, j].T]
    base = np.stack([load * motion for load in loads for motion in (np.sign(w), w)], axis=1)
    torque = recorded.effects[rows, k]
    size = np.linalg.norm(base, axis=0)
    base = base[:, size > 1e-9] / size[size > 1e-9]
    coefficients, *_ = np.linalg.lstsq(base, torque, rcond=1e-9)
    return float(rms(torque - base @ coefficients) / rms(recorded.friction[rows, j]))


_BESIDE = (".toml", ".arm.toml", ".truth.json")


def write_arm(run: ArmRun, path: str | Path) -> tuple[Path, Path, Path, Path]:
    """Write the log to `path`, NAME.csv.gz, and next to it NAME.toml, NAME.arm.toml and NAME.truth.json.

    Returns the four paths. The same run gives the same bytes; nothing is left behind if writing fails. Raises
    InputError if the path does not end in .csv.gz, one of the files exists, or they cannot be written.
    """
    log, rig, arm, truth = free_arm_paths(path)
    stem = log.name.removesuffix(LOG)
    formats = {"run": "%d", "t_s": "%.4f", "q": "%.7f"}
    shown = [formats.get(name, formats.get(name.partition("_")[0], "%.5f")) for name in run.columns]
    write_new(
        {
            log: csv_archive(run.columns, shown),
            rig: _toml({**run.rig, "arm": arm.name}).encode("ascii"),
            arm: _toml(run.arm).encode("ascii"),
            truth: json_bytes({**run.truth, "name": stem}),
        }
    )
    return log, rig, arm, truth


def free_arm_paths(path: str | Path) -> tuple[Path, Path, Path, Path]:
    """Return the paths of log, rig, arm and truth, none of which exists; InputError as for `write_arm`."""
    log, rig, arm, truth = new_paths(path, _BESIDE)
    return log, rig, arm, truth


def _toml(content: dict[str, Any]) -> str:
    """TOML text of a table: values first, then tables and lists of tables, recursively."""
    return "\n".join(_lines(content, "")).strip() + "\n"


def _lines(table: dict[str, Any], place: str) -> list[str]:
    lines = [f"{key} = {json.dumps(value)}" for key, value in table.items() if not _is_table(value)]
    for key, value in table.items():
        if _is_table(value):
            name = f"{place}{key}"
            for inner in value if isinstance(value, list) else [value]:
                bracket = f"[[{name}]]" if isinstance(value, list) else f"[{name}]"
                lines += ["", bracket, *_lines(inner, f"{name}.")]
    return lines


def _is_table(value: object) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, list) and bool(value) and all(isinstance(x, dict) for x in value)
    )
