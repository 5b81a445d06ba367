"""Friction written into MuJoCo before each step: that of the model, in motion, swinging down and at rest."""

from collections.abc import Iterator
from types import ModuleType
from typing import Any

import pytest

from eccentric.exports import ExportedDrive, export
from eccentric.model import load_model
from eccentric.presentation import export_lines
from tests.exports import BENCH, BENCH_UNEQUAL, STEADY, drive, imported, link_states, swing_down, written

mujoco = pytest.importorskip("mujoco", reason="MuJoCo (mujoco-core) is not installed")


@pytest.fixture(
    scope="module",
    params=[("c2_parallel", BENCH), ("c2_asymmetric", BENCH_UNEQUAL), ("rotating_link", BENCH)],
    ids=lambda x: x[0],
)
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple]:
    """A drive, the written module, and a pendulum with its state, as a user has them."""
    of = drive(*request.param)
    folder = written(export(of, "budget").files, tmp_path_factory.mktemp("budget"))
    model = mujoco.MjModel.from_xml_path(str(folder / f"{of.name}.xml"))
    with imported(folder, f"{of.name}_budget", of.name) as module:
        yield of, module, model, mujoco.MjData(model)


Case = tuple[ExportedDrive, ModuleType, Any, Any]


def test_torque_is_the_emitted_one(case: Case) -> None:
    """In motion, to 1e-12, also where levels differ by direction and friction follows the acceleration."""
    of, module, model, data = case
    friction = module.Budget(model)
    for angle, velocity in zip(*link_states(), strict=True):
        mujoco.mj_resetData(model, data)
        data.qpos[0], data.qvel[0], data.qacc[0] = angle, velocity, 3.0
        friction.write(model, data)
        state = {"theta_m": angle / of.p.mu, "omega_m": velocity / of.p.mu, "alpha_m": 3.0 / of.p.mu}
        expected = float(of.module.mechanical_friction_torque(*(state[x] for x in of.inputs), of.p)) / of.p.mu
        mujoco.mj_forward(model, data)
        found = -float(data.qfrc_passive[0] + data.qfrc_constraint[0] + data.qfrc_applied[0])
        assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("angle", [2.1, -2.8])
def test_a_link_swings_down_to_where_it_should(case: Case, angle: float) -> None:
    """In steps of 2 ms it comes to rest within 1 mrad of where `friction_step` ends in steps of 0.1 ms."""
    of, module, model, data = case
    if of.takes("alpha_m"):
        pytest.skip("friction_step takes an acceleration; the drive is that of c2_parallel in all else")
    friction = module.Budget(model)
    mujoco.mj_resetData(model, data)
    data.qpos[0] = angle
    while data.time < 6.0:
        friction.write(model, data)
        mujoco.mj_step(model, data)
    end = data.qpos[0]
    for _ in range(500):
        friction.write(model, data)
        mujoco.mj_step(model, data)

    assert end == pytest.approx(swing_down(of, angle), abs=1e-3)
    assert data.qpos[0] == end


def test_what_friction_holds_stays(case: Case) -> None:
    """A link within the levels has not moved after 5 s, by no bit."""
    _, module, model, data = case
    friction = module.Budget(model)
    mujoco.mj_resetData(model, data)
    data.qpos[0] = STEADY
    while data.time < 5.0:
        friction.write(model, data)
        mujoco.mj_step(model, data)

    assert data.qpos[0] == STEADY


def test_arrays_are_written_at_once(case: Case) -> None:
    """`at` takes the states of many links: each as alone."""
    of, module, model, _ = case
    friction = module.Budget(model)
    states = (*link_states(20), *([link_states(20, 2)[0]] if of.takes("alpha_m") else []))

    together = friction.at(*states)
    for k in range(20):
        assert friction.at(*(x[k] for x in states)) == tuple(x[k] for x in together)


def test_without_inertia_there_is_no_pendulum() -> None:
    """The module needs none: it writes into a user's own model; the command says what is missing."""
    of = ExportedDrive(load_model("c2_parallel"), "c2_parallel")
    found = export(of, "budget")

    assert "left out: the pendulum c2_parallel.xml, which requires J_m and J_l" in export_lines(of, found)[-1]
    assert sorted(found.files) == [
        "c2_parallel.py",
        "c2_parallel_budget.py",
        "c2_parallel_budget_warp.py",
        "eccentric_runtime.py",
    ]


def test_a_bare_motor_has_no_pendulum() -> None:
    """Its J_l of 0 declares no link: the module is written, the pendulum is left out."""
    of = drive("c1_perpendicular", {"J_m": 1e-5, "J_l": 0.0, "M": 0.0, "M_l": 0.0, "L": 0.0, "mu": 1.0})
    found = export(of, "budget")

    assert "c1_perpendicular.xml, which requires J_l: declare it" in export_lines(of, found)[-1]
    assert "c1_perpendicular_budget.py" in found.files


@pytest.mark.parametrize(
    ("values", "mend"),
    [
        ({"J_m": 1e-4}, "give it with --parameters"),
        ({"J_m": 1e-4, "J_l": 0.0}, "declare it in the rig file and fit again"),
    ],
)
def test_what_mends_a_missing_inertia(values: dict[str, float], mend: str) -> None:
    """--parameters for a model without one; the rig for a fit, beside which --parameters is refused."""
    of = drive("c2_parallel", values)

    assert export_lines(of, export(of, "budget"))[-1].endswith(f"which requires J_l: {mend}")
