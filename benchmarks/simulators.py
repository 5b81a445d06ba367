"""Exported friction in simulators: its torque, where a link comes to rest, whether it stays, and its cost.

The drive is a fit of the bundled log, rounded. Simulators that are not installed are named and left out.
"""

from __future__ import annotations

import importlib
import importlib.util
import math
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.record import Measured, Part, progress
from eccentric.exports import Exported, ExportedDrive, export
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
SPEEDS = (0.81, 40.0)
"""Motor speeds [rad/s] of that log."""
STARTS = (2.1, -2.8, 3.0)
"""Link angles [rad] from which a link swings down."""
STEADY, DT, FINE = 0.4, 2e-3, 1e-4
"""Link angle that friction holds [rad]; time steps of the simulator and of the reference [s]."""
WORLDS = (1, 4096)


def measured(quick: bool) -> Part:
    """Torque beside the emitted one, ends of a swing, drift at rest; time of a step beside the engine's own."""
    name, figures = "c2_parallel", dict[str, Measured]()
    of = ExportedDrive(with_values(load_model(name), VALUES, name), name, SPEEDS)
    lines, rows, costs = list[str](), list[str](), list[str]()
    for title, package, run in SIMULATORS:
        if importlib.util.find_spec(package) is None:
            lines.append(f"{title}: not installed.")
            continue
        progress(f"simulators: {title}")
        with tempfile.TemporaryDirectory() as folder:
            sys.path.insert(0, folder)
            try:
                found = run(of, Path(folder), quick)
            finally:
                sys.path.remove(folder)
        torque, swing, drift = found.errors
        rows.append(f"| {title} | {torque:.2g} | {swing:.2g} | {drift:.2g} |")
        figures |= {
            f"export {title} torque": Measured(torque),
            f"export {title} swing": Measured(swing),
            f"export {title} rest": Measured(drift),
        }
        costs += found.costs
        lines += found.notes
    head = ["| | torque, relative | end of a swing, mrad | drift in 5 s, mrad |", "|---|---|---|---|"]
    cost = [
        "| steps of all worlds a second | with the drive's friction | with the engine's own |",
        "|---|---|---|",
    ]
    return Part(figures, [*lines, "", *head, *rows, "", *cost, *costs])


@dataclass(frozen=True)
class Found:
    """Torque [relative], end of a swing and drift [mrad]; rows of the cost; what is to be said."""

    errors: tuple[float, float, float]
    costs: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


def exported(of: ExportedDrive, target: str, folder: Path) -> Exported:
    """Write what is exported to a target into the folder."""
    found = export(of, target)
    for file, content in found.files.items():
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_bytes(content if isinstance(content, bytes) else content.encode())
    return found


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


def native(of: ExportedDrive, folder: Path, quick: bool) -> Found:
    """MuJoCo, levels and damping written before each step."""
    import mujoco

    exported(of, "budget", folder)
    model = mujoco.MjModel.from_xml_path(f"{folder}/{of.name}.xml")
    data, friction = mujoco.MjData(model), importlib.import_module(f"{of.name}_budget").Budget(model)
    errors = in_mujoco(model, data, lambda: friction.write(model, data), lambda *x: emitted(of, *x), ends(of))
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
    return Found(errors, (f"| MuJoCo, 1 world | {rates[0]:,.0f} | {rates[1]:,.0f} |",))


def in_mujoco(
    model: Any,
    data: Any,
    write: Callable[[], object],
    expected: Callable[[np.ndarray, np.ndarray], np.ndarray],
    rest: Sequence[float],
) -> tuple[float, float, float]:
    """Errors of a pendulum in MuJoCo, against a friction torque and the angles at which it comes to rest."""
    import mujoco

    angle, velocity = states()
    found = []
    for data.qpos[0], data.qvel[0] in zip(angle, velocity, strict=True):
        write()
        mujoco.mj_forward(model, data)
        found.append(-float(data.qfrc_passive[0] + data.qfrc_constraint[0] + data.qfrc_applied[0]))
    torque = float(np.abs(np.array(found) / expected(angle, velocity) - 1.0).max())

    def run(start: float, seconds: float) -> float:
        mujoco.mj_resetData(model, data)
        data.qpos[0] = start
        while data.time < seconds:
            write()
            mujoco.mj_step(model, data)
        return float(data.qpos[0])

    swing = 1e3 * max(abs(run(x, 6.0) - y) for x, y in zip(STARTS, rest, strict=True))
    return torque, swing, 1e3 * abs(run(STEADY, 5.0) - STEADY)


def in_warp(of: ExportedDrive, folder: Path, quick: bool) -> Found:
    """mujoco-warp, by the kernel."""
    import mujoco

    # Not in the environment that types are checked in.
    mujoco_warp, wp = (importlib.import_module(name) for name in ("mujoco_warp", "warp"))

    exported(of, "budget", folder)
    model = mujoco.MjModel.from_xml_path(f"{folder}/{of.name}.xml")
    module = importlib.import_module(f"{of.name}_budget_warp")
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
    errors, costs = (torque, swing, 1e3 * float(abs(end[-1] - np.float32(STEADY)))), []
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
        costs.append(
            f"| mujoco-warp on a {where}, {worlds:,} {'world' if worlds == 1 else 'worlds'} | {rates[0]:,.0f} | {rates[1]:,.0f} |"
        )
    return Found(errors, tuple(costs))


def in_newton(of: ExportedDrive, folder: Path, _quick: bool) -> Found:
    """Newton's Featherstone solver, which has no dry friction, by the drive component."""
    newton = importlib.import_module("newton")
    exported(of, "newton", folder)
    module = importlib.import_module(f"{of.name}_newton")

    def put(angle: np.ndarray, velocity: np.ndarray) -> tuple[Any, Any, Any]:
        builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, -of.p.g))
        for _ in angle:
            about = (of.inertia * np.eye(3)).astype(np.float32)
            link = builder.add_link(mass=of.mass, com=(0.0, 0.0, -of.centre), inertia=about)
            joint = builder.add_joint_revolute(
                parent=-1, child=link, axis=newton.Axis.Y, armature=of.armature, friction=0.0, damping=0.0
            )
            builder.add_articulation([joint])
            builder.add_actuator(module.FrictionDrive, index=builder.joint_qd_start[joint])
        model = builder.finalize(device="cpu")
        state = model.state()
        state.joint_q.assign(angle.astype(np.float32))
        state.joint_qd.assign(velocity.astype(np.float32))
        newton.eval_fk(model, state.joint_q, state.joint_qd, state)
        return model, state, model.control()

    def act(model: Any, state: Any, control: Any) -> None:
        newton.eval_inverse_dynamics_passive(model, state, gravity_force=control.joint_load)
        control.joint_f.zero_()
        for actuator in model.actuators:
            actuator.step(state, control, dt=DT)

    angle, velocity = states(200)
    model, state, control = put(angle, velocity)
    act(model, state, control)
    torque = relative(-control.joint_f.numpy(), in_a_step(of, angle, velocity, DT))
    model, state, control = put(np.array([*STARTS, STEADY]), np.zeros(len(STARTS) + 1))
    solver, after = newton.solvers.SolverFeatherstone(model, angular_damping=0.0), model.state()
    for _ in range(round(6.0 / DT)):
        act(model, state, control)
        solver.step(state, after, control, None, DT)
        state, after = after, state
    end = state.joint_q.numpy().astype(float)
    swing = 1e3 * float(np.abs(end[:-1] - ends(of)).max())
    return Found((torque, swing, 1e3 * float(abs(end[-1] - np.float32(STEADY)))))


def in_fmpy(of: ExportedDrive, folder: Path, _quick: bool) -> Found:
    """The FMU, built and run by FMPy."""
    import fmpy
    from fmpy.build import build_platform_binary

    exported(of, "fmu", folder)
    unpacked = Path(fmpy.extract(str(folder / f"{of.name}.fmu"), str(folder / "unpacked")))
    (folder / "build").mkdir()
    build_platform_binary(unpacked, folder / "build")
    description = fmpy.read_model_description(str(unpacked))
    at = {x.name: x.valueReference for x in description.modelVariables}
    unit: Any = fmpy.instantiate_fmu(str(unpacked), description, fmi_type="CoSimulation")
    angle, velocity = states(200)
    found = []
    for theta_m, omega_m in np.stack([angle, velocity], axis=1).astype(float) / of.p.mu:
        unit.enterInitializationMode()
        unit.setFloat64([at["theta_m"], at["omega_m"]], [theta_m, omega_m])
        found += unit.getFloat64([at["friction"]])
        unit.exitInitializationMode()
        unit.reset()
    unit.freeInstance()

    def run(start: float, seconds: float) -> float:
        result: Any = fmpy.simulate_fmu(
            str(unpacked),
            stop_time=seconds,
            step_size=DT,
            start_values={"theta_m": start / of.p.mu},
            output=["theta_m"],
        )
        return float(result["theta_m"][-1]) * of.p.mu

    torque = relative(np.array(found) / of.p.mu, in_a_step(of, angle, velocity, FINE))
    swing = 1e3 * max(abs(run(x, 6.0) - y) for x, y in zip(STARTS, ends(of), strict=True))
    return Found((torque, swing, 1e3 * abs(run(STEADY, 5.0) - STEADY)))


def in_a_step(of: ExportedDrive, angle: np.ndarray, velocity: np.ndarray, dt: float) -> np.ndarray:
    """The friction torque of `friction_step` at the joint [N m]."""
    theta_m, omega_m = angle.astype(float) / of.p.mu, velocity.astype(float) / of.p.mu
    torque = -of.module.gravity_torque(theta_m, of.p)
    return of.module.friction_step(theta_m, omega_m, torque, dt, of.p)[:, 1] / of.p.mu


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    """The largest relative error."""
    return float(np.abs(found / expected - 1.0).max())


def constant(of: ExportedDrive, folder: Path, target: str, ending: str) -> Found:
    """A file with constant coefficients, in MuJoCo: against the friction in it, which is not the drive's."""
    import mujoco

    law = exported(of, target, folder).law
    assert law is not None
    model = mujoco.MjModel.from_xml_path(f"{folder}/{of.name}.{ending}")
    # What a URDF cannot say, as the other files for MuJoCo have it.
    model.dof_armature[0], model.opt.noslip_iterations = of.armature, 10
    model.dof_solref[0], model.dof_solimp[0, :3] = (1e-4, 1.0), (0.9999, 0.9999, 1e-3)
    a, b, c = law.damping

    def friction(_: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        v = velocity.astype(float)
        return np.sign(v) * law.level + (a + b * np.abs(v) + c * v**2) * v

    rest = []
    inertia, load = of.p.J_l + of.armature, of.p.M * of.p.L * -model.opt.gravity[2]
    for start in STARTS:
        angle, velocity = start, 0.0
        for _ in range(round(6.0 / FINE)):
            momentum = inertia * velocity - FINE * load * math.sin(angle)
            sliding = math.copysign(max(abs(momentum) - FINE * law.level, 0.0), momentum)
            velocity = sliding / (inertia + FINE * (a + b * abs(velocity) + c * velocity**2))
            angle += FINE * velocity
        rest.append(angle)
    errors = in_mujoco(model, mujoco.MjData(model), lambda: None, friction, rest)
    share = 100.0 * law.error_rms / law.friction_rms
    said = f"{target.upper()} has constant coefficients, {share:.2g} % RMS from the friction of the drive: its errors are those against the coefficients in the file."
    return Found(errors, notes=(said,))


SIMULATORS: tuple[tuple[str, str, Callable[[ExportedDrive, Path, bool], Found]], ...] = (
    ("MuJoCo", "mujoco", native),
    ("mujoco-warp", "mujoco_warp", in_warp),
    ("Newton", "newton", in_newton),
    ("FMU in FMPy", "fmpy", in_fmpy),
    ("MJCF in MuJoCo", "mujoco", lambda of, folder, _: constant(of, folder, "mjcf", "xml")),
    ("URDF in MuJoCo", "mujoco", lambda of, folder, _: constant(of, folder, "urdf", "urdf")),
)
"""Title, package, and what is measured in it."""
