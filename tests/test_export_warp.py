"""Friction written into mujoco-warp, all worlds at once, in single precision, on the processor."""

from collections.abc import Iterator
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from eccentric.exports import ExportedDrive, export
from tests.exports import BENCH, BENCH_UNEQUAL, STEADY, drive, imported, link_states, swing_down, written

mujoco = pytest.importorskip("mujoco", reason="MuJoCo (mujoco-core) is not installed")
mujoco_warp = pytest.importorskip("mujoco_warp", reason="mujoco-warp is not installed")
pytestmark = pytest.mark.filterwarnings("ignore")  # of Warp's own compiler


@pytest.fixture(
    scope="module",
    params=[("c2_parallel", BENCH), ("c2_asymmetric", BENCH_UNEQUAL), ("rotating_link", BENCH)],
    ids=lambda x: x[0],
)
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple]:
    """A drive, the written module, and the model of MuJoCo."""
    of = drive(*request.param)
    folder = written(export(of, "budget").files, tmp_path_factory.mktemp("warp"))
    model = mujoco.MjModel.from_xml_path(str(folder / f"{of.name}.xml"))
    model.dof_frictionloss[:] = 1.0
    with imported(folder, f"{of.name}_budget_warp", of.name) as module:
        yield of, module, model


Case = tuple[ExportedDrive, ModuleType, Any]


def worlds(
    case: Case, angle: np.ndarray, velocity: np.ndarray, acceleration: float = 0.0
) -> tuple[Any, Any, Any]:
    """Return friction, model and data of as many worlds, in these states."""
    _, module, model = case
    m = mujoco_warp.put_model(model)
    d = mujoco_warp.put_data(model, mujoco.MjData(model), nworld=len(angle))
    d.qpos.assign(angle[:, None].astype(np.float32))
    d.qvel.assign(velocity[:, None].astype(np.float32))
    d.qacc.assign(np.full((len(angle), 1), acceleration, np.float32))
    return module.WarpBudget(model, m, d), m, d


def test_torque_is_the_emitted_one(case: Case) -> None:
    """In motion, to 1e-6 of it: what single precision has."""
    of = case[0]
    angle, velocity = (x.astype(np.float32) for x in link_states())
    friction, m, d = worlds(case, angle, velocity, 3.0)
    friction.write(m, d)
    mujoco_warp.forward(m, d)
    found = -(d.qfrc_passive.numpy() + d.qfrc_constraint.numpy() + d.qfrc_applied.numpy())[:, 0]
    state = {"theta_m": angle.astype(float) / of.p.mu, "omega_m": velocity.astype(float) / of.p.mu}
    state["alpha_m"] = np.full(len(angle), 3.0 / of.p.mu)
    expected = of.module.mechanical_friction_torque(*(state[x] for x in of.inputs), of.p) / of.p.mu

    assert found == pytest.approx(expected, rel=1e-6)


def test_links_swing_down_to_where_they_should(case: Case) -> None:
    """Within 1 mrad of where `friction_step` ends in steps of 0.1 ms; what friction holds hardly moves."""
    of = case[0]
    if of.takes("alpha_m"):
        pytest.skip("friction_step takes an acceleration; the drive is that of c2_parallel in all else")
    start = np.array([2.1, -2.8, STEADY])
    friction, m, d = worlds(case, start, np.zeros(3))
    for _ in range(3000):
        friction.write(m, d)
        mujoco_warp.step(m, d)
    end, velocity = d.qpos.numpy()[:, 0], d.qvel.numpy()[:, 0]
    load = of.p.M * of.p.g * of.p.L * np.sin(STEADY) / (of.p.J_l + of.armature)

    assert end[:2] == pytest.approx([swing_down(of, x) for x in start[:2]], abs=1e-3)
    assert np.abs(velocity).max() <= 1e-4 * load * 0.002
    assert end[2] == pytest.approx(STEADY, abs=1e-6)
