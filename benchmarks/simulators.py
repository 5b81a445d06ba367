"""Exported friction in simulators: its torque, where a link comes to rest, whether it stays, and its cost.

The drive is a fit of the bundled log, rounded. Simulators that are not installed are named and left out.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from benchmarks.record import Measured, Part, progress
from eccentric.exports import ExportedDrive, export
from eccentric.model import load_model, with_values

VALUES = {
    "M": 0.489,
    "M_l": 0.181,
    "L": 0.279,
    "mu": 0.2,
    "k_i": 0.063,
    "k_e": 0.063,
    "J_m": 1e-4,
    "J_l": 0.04276066,
    "B_lN": 0.006384,
    "C_lN": 0.07297,
    "B_m": 0.0009273,
    "C_m": 0.0443,
}
STARTS = (2.1, -2.8, 3.0)
"""Link angles [rad] from which a link swings down."""
STEADY, DT, FINE = 0.4, 2e-3, 1e-4
"""Link angle that friction holds [rad]; time steps of the simulator and of the reference [s]."""
WORLDS = (1, 4096)


def measured(quick: bool) -> Part:
    """Torque beside the emitted one, ends of a swing, drift at rest; time of a step beside the engine's own."""
    if importlib.util.find_spec("mujoco") is None:
        return Part({}, ["MuJoCo: not installed."])
    import mujoco

    name = "c2_parallel"
    of = ExportedDrive(with_values(load_model(name), VALUES, name), name)
    with tempfile.TemporaryDirectory() as folder:
        for file, content in export(of, "budget").files.items():
            (Path(folder) / file).write_bytes(content if isinstance(content, bytes) else content.encode())
        sys.path.insert(0, folder)
        try:
            model = mujoco.MjModel.from_xml_path(f"{folder}/{name}.xml")
            progress("simulators: MuJoCo")
            figures, rows = native(of, model, importlib.import_module(f"{name}_budget"), quick)
            lines = []
            if importlib.util.find_spec("mujoco_warp") is None:
                lines.append("mujoco-warp: not installed.")
            else:
                progress("simulators: mujoco-warp")
                rows += in_warp(of, model, importlib.import_module(f"{name}_budget_warp"), quick)
        finally:
            sys.path.remove(folder)
    head = ["| | torque, relative | end of a swing, mrad | drift in 5 s, mrad |", "|---|---|---|---|"]
    cost = [
        "",
        "| steps of all worlds a second | with the drive's friction | with the engine's own |",
        "|---|---|---|",
    ]
    table = [
        *head,
        *(row for row in rows if row.count("|") == 5),
        *cost,
        *(row for row in rows if row.count("|") == 4),
    ]
    return Part(figures, [*lines, "", *table])


def states(count: int = 1000) -> tuple[np.ndarray, np.ndarray]:
    """Angles and velocities of a moving link, in single precision."""
    random = np.random.default_rng(5)
    angle, speed = random.uniform(-9.0, 9.0, count), random.uniform(0.2, 12.0, count)
    return angle.astype(np.float32), (random.choice([-1.0, 1.0], count) * speed).astype(np.float32)


def emitted(of: ExportedDrive, angle: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """The torque of the emitted module at the joint [N m]."""
    mu = of.p.mu
    return (
        of.module.mechanical_friction_torque(angle.astype(float) / mu, velocity.astype(float) / mu, of.p) / mu
    )


def ends(of: ExportedDrive) -> list[float]:
    """Where `friction_step` brings the link to rest, in fine steps [rad]."""
    found = []
    for start in STARTS:
        theta_m, omega_m = start / of.p.mu, 0.0
        for _ in range(round(6.0 / FINE)):
            torque = -of.module.gravity_torque(theta_m, of.p)
            omega_m = float(of.module.friction_step(theta_m, omega_m, torque, FINE, of.p)[0])
            theta_m += FINE * omega_m
            if omega_m == 0.0:
                break
        found.append(theta_m * of.p.mu)
    return found


def native(
    of: ExportedDrive, model: Any, module: ModuleType, quick: bool
) -> tuple[dict[str, Measured], list[str]]:
    """Figures and rows of MuJoCo."""
    import mujoco

    data, friction = mujoco.MjData(model), module.Budget(model)
    angle, velocity = states()
    expected, found = emitted(of, angle, velocity), []
    for data.qpos[0], data.qvel[0] in zip(angle, velocity, strict=True):
        friction.write(model, data)
        mujoco.mj_forward(model, data)
        found.append(-float(data.qfrc_passive[0] + data.qfrc_constraint[0] + data.qfrc_applied[0]))
    torque = float(np.abs(np.array(found) / expected - 1.0).max())

    def run(start: float, seconds: float) -> float:
        mujoco.mj_resetData(model, data)
        data.qpos[0] = start
        while data.time < seconds:
            friction.write(model, data)
            mujoco.mj_step(model, data)
        return float(data.qpos[0])

    swing = 1e3 * max(abs(run(x, 6.0) - y) for x, y in zip(STARTS, ends(of), strict=True))
    drift = 1e3 * abs(run(STEADY, 5.0) - STEADY)
    steps = 2_000 if quick else 20_000

    def many(write: Callable[[Any, Any], object] | None) -> float:
        mujoco.mj_resetData(model, data)
        data.qpos[0] = 2.1
        start = time.perf_counter()
        for _ in range(steps):
            if write is not None:
                write(model, data)
            mujoco.mj_step(model, data)
        return steps / (time.perf_counter() - start)

    rates = np.median([[many(write) for write in (friction.write, None)] for _ in range(5)], axis=0)
    figures = {
        "export torque": Measured(torque),
        "export swing": Measured(swing),
        "export rest": Measured(drift),
    }
    return figures, [
        f"| MuJoCo | {torque:.1e} | {swing:.2g} | {drift:.2g} |",
        f"| MuJoCo, 1 world | {rates[0]:,.0f} | {rates[1]:,.0f} |",
    ]


def in_warp(of: ExportedDrive, model: Any, module: ModuleType, quick: bool) -> list[str]:
    """Rows of mujoco-warp."""
    import mujoco

    # Not in the environment that types are checked in.
    mujoco_warp, wp = (importlib.import_module(name) for name in ("mujoco_warp", "warp"))

    model.dof_frictionloss[:] = 1.0

    def put(angle: np.ndarray, velocity: np.ndarray) -> tuple[Any, Any, Any]:
        m = mujoco_warp.put_model(model)
        d = mujoco_warp.put_data(model, mujoco.MjData(model), nworld=len(angle))
        d.qpos.assign(angle[:, None].astype(np.float32))
        d.qvel.assign(velocity[:, None].astype(np.float32))
        return module.WarpBudget(model, m, d), m, d

    angle, velocity = states()
    friction, m, d = put(angle, velocity)
    friction.write(m, d)
    mujoco_warp.forward(m, d)
    found = -(d.qfrc_passive.numpy() + d.qfrc_constraint.numpy() + d.qfrc_applied.numpy())[:, 0]
    torque = float(np.abs(found / emitted(of, angle, velocity) - 1.0).max())
    start = np.array([*STARTS, STEADY])
    friction, m, d = put(start, np.zeros(len(start)))
    for _ in range(round(6.0 / DT)):
        friction.write(m, d)
        mujoco_warp.step(m, d)
    end = d.qpos.numpy()[:, 0].astype(float)
    swing = 1e3 * float(np.abs(end[:-1] - ends(of)).max())
    rows = [f"| mujoco-warp | {torque:.1e} | {swing:.2g} | {1e3 * abs(end[-1] - np.float32(STEADY)):.2g} |"]
    steps = 20 if quick else 100
    for worlds in WORLDS:
        pairs = []
        for _ in range(4):  # the first compiles
            pairs.append([])
            for own in (False, True):
                friction, m, d = put(np.linspace(-3.0, 3.0, worlds), np.zeros(worlds))
                begun = time.perf_counter()
                for _ in range(steps):
                    if not own:
                        friction.write(m, d)
                    mujoco_warp.step(m, d)
                wp.synchronize()
                pairs[-1].append(steps * worlds / (time.perf_counter() - begun))
        rates = np.median(pairs[1:], axis=0)
        where = "GPU" if d.qpos.device.is_cuda else "processor"
        rows.append(
            f"| mujoco-warp on a {where}, {worlds:,} {'world' if worlds == 1 else 'worlds'} | {rates[0]:,.0f} | {rates[1]:,.0f} |"
        )
    return rows
