"""ArmTrace -> the log as recorded by the drives, its rig, the declared arm, and the sealed truth."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import lfilter

from eccentric.virtual_bench.arms.effects import COLD_C, RISE_K, TAU_S, JointEffect
from eccentric.virtual_bench.arms.plant import rms
from eccentric.virtual_bench.arms.scenario import ArmScenario
from eccentric.virtual_bench.arms.simulation import ArmTrace, Progress, trace
from eccentric.virtual_bench.files import LOG, csv_archive, json_bytes, new_paths, write_new

# Drive temperatures: as simulated for drives with an effect, from the losses for the others.


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
    """Content of the rig file: arm, columns, drives."""
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


# ArmRun -> LOG.csv.gz, LOG.toml (the rig), LOG.arm.toml and LOG.truth.json (sealed).


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
