"""The drive component for Newton, with a solver that has no dry friction."""

from collections.abc import Iterator
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.exports import ExportedDrive, export
from tests.exports import BENCH, STEADY, drive, imported, link_states, swing_down, written

newton = pytest.importorskip("newton", reason="Newton is not installed")
pytestmark = pytest.mark.filterwarnings("ignore")  # of Warp's own compiler
DT = 2e-3


@pytest.fixture(scope="module")
def of() -> ExportedDrive:
    """A fit of the bundled log."""
    return drive("c2_parallel", BENCH)


@pytest.fixture(scope="module")
def module(of: ExportedDrive, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """The written module."""
    folder = written(export(of, "newton").files, tmp_path_factory.mktemp("newton"))
    with imported(folder, f"{of.name}_newton", of.name) as module:
        yield module


def pendulums(
    of: ExportedDrive, module: ModuleType, angle: np.ndarray, velocity: np.ndarray
) -> tuple[Any, Any, Any]:
    """Return the model of as many pendulums, its state and its control."""
    builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=(0.0, 0.0, -of.p.g))
    for _ in angle:
        about = of.inertia * np.eye(3)
        link = builder.add_link(mass=of.mass, com=(0.0, 0.0, -of.centre), inertia=about.astype(np.float32))
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
    """Compute the torques of all joints."""
    newton.eval_inverse_dynamics_passive(model, state, gravity_force=control.joint_load)
    control.joint_f.zero_()
    for actuator in model.actuators:
        actuator.step(state, control, dt=DT)


def test_torque_is_that_of_the_step(of: ExportedDrive, module: ModuleType) -> None:
    """By the emitted step in NumPy, to 1e-6 of the largest: single precision."""
    angle, velocity = (x.astype(np.float32) for x in link_states())
    model, state, control = pendulums(of, module, angle, velocity)
    act(model, state, control)
    theta_m, omega_m = angle.astype(float) / of.p.mu, velocity.astype(float) / of.p.mu
    torque = -of.module.gravity_torque(theta_m, of.p)
    expected = -of.module.friction_step(theta_m, omega_m, torque, DT, of.p)[:, 1] / of.p.mu

    assert control.joint_f.numpy() == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())


def test_links_come_to_rest_where_they_should(of: ExportedDrive, module: ModuleType) -> None:
    """In steps of 2 ms they end within 1 mrad of steps of 0.1 ms; what is held hardly creeps."""
    start = np.array([2.1, -2.8, STEADY])
    model, state, control = pendulums(of, module, start, np.zeros(3))
    solver = newton.solvers.SolverFeatherstone(model, angular_damping=0.0)
    after = model.state()
    for _ in range(3000):
        act(model, state, control)
        solver.step(state, after, control, None, DT)
        state, after = after, state
    end, velocity = state.joint_q.numpy(), state.joint_qd.numpy()
    load = of.p.M * of.p.g * of.p.L * np.sin(STEADY) / (of.p.J_l + of.armature)

    assert end[:2] == pytest.approx([swing_down(of, x) for x in start[:2]], abs=1e-3)
    assert np.abs(velocity).max() <= 1e-4 * load * DT
    assert end[2] == pytest.approx(STEADY, abs=1e-4)


def test_friction_of_the_acceleration_is_refused() -> None:
    """A drive of Newton has no acceleration."""
    with pytest.raises(InputError, match="expected friction of angle and velocity"):
        export(drive("rotating_link", BENCH), "newton")
