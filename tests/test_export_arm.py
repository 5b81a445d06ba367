"""Friction of an arm written into MuJoCo, at the engine's own loads, contacts and outer forces included."""

from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError
from eccentric.emission import Choice, executed, render
from eccentric.exports import ExportedArm, export
from eccentric.model import Body, Chain, Joint, Placement, arm, with_values
from tests.arms import random_chain
from tests.exports import imported, written
from tests.test_arm_rest import as_mjcf

mujoco = pytest.importorskip("mujoco", reason="MuJoCo (mujoco-core) is not installed")

ROOT = Path(__file__).resolve().parents[1]
FUNCTIONS = ("bearing_loads", "friction_budget", "friction_budget_from_loads", "mechanical_friction_torque")


def rubbing(chain: Chain, random: np.random.Generator) -> Any:
    """The arm with friction by every load in every joint."""
    model = arm(chain, "An arm")
    used = {t.coefficient for b in model.balances for t in b.terms if t.kind == "friction"}
    names = [q.name for q in model.parameters if q.symbol in used]
    return with_values(model, {name: float(10 ** random.uniform(-3, -1)) for name in names}, "arm")


@pytest.fixture(scope="module", params=[1, 2, 3])
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple]:
    """A random arm with gears and bearings beside its frames: emitted, exported, and in MuJoCo."""
    random = np.random.default_rng(request.param)
    chain = random_chain(random, request.param, geared=True, sliding=0.4)
    model = rubbing(chain, random)
    files = render(model, "a test", "a test", ("numpy",), choice=Choice(FUNCTIONS, "none"))
    folder = written(export(ExportedArm(model, "a test"), "budget").files, tmp_path_factory.mktemp("arm"))
    engine = mujoco.MjModel.from_xml_string(as_mjcf(chain))
    with imported(folder, "arm_budget", "arm") as module:
        yield chain, executed(files, "arm"), module, engine, mujoco.MjData(engine), random


Case = tuple[Chain, ModuleType, ModuleType, Any, Any, np.random.Generator]


def test_loads_and_friction_are_those_of_the_arm(case: Case) -> None:
    """In motion under any torques, by the recursion of the emitted arm at the engine's own accelerations."""
    chain, emitted, module, engine, data, random = case
    n = len(chain.joints)
    mu, p = np.array([float(joint.mu) for joint in chain.joints]), emitted.Parameters()
    labels = [(name, j) for name in ("F_N", "F_T", "M_B", "T") for j in range(n)]
    friction = module.Budget(engine, [joint.name for joint in chain.joints])
    for _ in range(20):
        mujoco.mj_resetData(engine, data)
        q, w, torque = random.uniform(-3, 3, n), random.normal(size=n) * 3, random.normal(size=n) * 20
        data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, w, torque
        mujoco.mj_forward(engine, data)
        motion = q / mu, w / mu, data.qacc / mu
        found = dict(zip(labels, np.ravel(friction.loads(engine, data)), strict=True))
        expected = dict(zip(emitted.BEARING_LOADS, emitted.bearing_loads(*motion, p), strict=True))
        for (name, j), value in found.items():
            assert value == pytest.approx(expected.get(f"{name}_{j}", 0.0), rel=1e-8, abs=1e-9)

        friction.write(engine, data, torque)
        mujoco.mj_fwdPosition(engine, data)
        mujoco.mj_passive(engine, data)
        slid = np.sign(w) * engine.dof_frictionloss - data.qfrc_passive - (data.qfrc_applied - torque)
        assert slid == pytest.approx(emitted.mechanical_friction_torque(*motion, p) / mu, rel=1e-8)


# Two links in a vertical plane, whose friction follows their loads.

MU = np.array([1 / 9, 1 / 6])
FRICTION = {
    "C_m_0": 0.01, "C_lN_0": 0.02, "B_m_0": 1e-4, "C_m_1": 0.004, "C_lN_1": 0.015, "C_lM_1": 0.03,
    "B_lN_1": 1e-3, "B_m_1": 1e-4,
}  # fmt: skip
MASSES = 1.35, 0.42


def two_links() -> Chain:
    """Both hang straight down at angle 0; no rotors, whose reaction on the links MuJoCo's armature lacks."""
    shoulder = Joint(axis=(0, 1, 0), mu="1/9", bearing="0.015", name="shoulder")
    at = Placement((0, "0.025", "-0.3"))
    elbow = Joint(axis=(0, 1, 0), placement=at, mu="1/6", bearing="0.01", name="elbow")
    upper = Body("1.35", (0, "0.012", "-0.21"), np.diag([0.0158, 0.0162, 0.0011]).tolist())
    lower = Body("0.42", (0, "0.006", "-0.118"), np.diag([0.0031, 0.0031, 0.0001]).tolist())
    return Chain("two_links", [shoulder, elbow], [upper, lower])


@pytest.fixture(scope="module")
def links(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[ModuleType, ModuleType, str]]:
    """The emitted arm, the written module, and the arm for MuJoCo with the options that it advises."""
    model = with_values(arm(two_links(), "Two links"), FRICTION, "two_links")
    choice = Choice(("friction_step", "inverse_dynamics", "breakaway_torque", "gravity_torque"), "none")
    files = render(model, "a test", "a test", ("numpy",), choice=choice)
    folder = written(export(ExportedArm(model, "a test"), "budget").files, tmp_path_factory.mktemp("links"))
    text = (folder / "two_links_budget.py").read_text()
    advised = 'noslip_iterations="50" noslip_tolerance="0"'
    assert advised in text
    joints = '<default><joint solreffriction="0.0001 1" solimpfriction="0.9999 0.9999 0.001"/></default>'
    xml = as_mjcf(two_links()).replace("<option ", f'<option timestep="0.002" {advised} ')
    with imported(folder, "two_links_budget", "two_links") as module:
        yield executed(files, "two_links"), module, xml.replace("<worldbody>", f"{joints}<worldbody>")


def swung(module: ModuleType, xml: str, start: tuple[float, float], seconds: float) -> tuple[Any, Any, Any]:
    """The budget, model and data of MuJoCo after so long, from rest."""
    engine = mujoco.MjModel.from_xml_string(xml)
    data, friction = mujoco.MjData(engine), module.Budget(engine)
    data.qpos[:] = start
    while data.time < seconds:
        friction.write(engine, data)
        mujoco.mj_step(engine, data)
    return friction, engine, data


Links = tuple[ModuleType, ModuleType, str]


def test_what_friction_holds_stays(links: Links) -> None:
    """Two links within their levels have not moved after 2 s, by no bit."""
    emitted, module, xml = links
    start = (0.05, 0.03)
    levels = emitted.breakaway_torque(np.array(start) / MU).reshape(2, 2)[:, 1]
    assert np.all(0.2 * levels < emitted.gravity_torque(np.array(start) / MU))
    *_, data = swung(module, xml, start, 2.0)

    assert tuple(data.qpos) == start


def test_links_swing_down_to_where_they_should(links: Links) -> None:
    """In steps of 2 ms both come to rest within 1 mrad of where `friction_step` ends, and stay there."""
    emitted, module, xml = links
    start, dt, still = np.array([0.3, 0.2]), 5e-4, 0
    friction, engine, data = swung(module, xml, (0.3, 0.2), 2.0)
    end = data.qpos.copy()
    for _ in range(200):
        friction.write(engine, data)
        mujoco.mj_step(engine, data)
    theta_m, omega_m, alpha_m = start / MU, np.zeros(2), np.zeros(2)
    while still < 100:
        torque = -emitted.inverse_dynamics(theta_m, omega_m, np.zeros(2))
        after = emitted.friction_step(theta_m, omega_m, alpha_m, torque, dt)[:2]
        theta_m, omega_m, alpha_m = theta_m + dt * after, after, (after - omega_m) / dt
        still = 0 if omega_m.any() else still + 1

    assert np.array_equal(data.qpos, end)
    assert np.abs(end - start).min() > 0.25
    assert end == pytest.approx(theta_m * MU, abs=1e-3)


def test_two_states_of_one_model_do_not_disturb_each_other(links: Links) -> None:
    """Each with its own budget, stepped in turn, moves as it does alone, bit for bit."""
    _, module, xml = links
    starts = (0.9, 0.7), (-0.4, 1.2)
    alone = [swung(module, xml, start, 0.2)[2].qpos.tolist() for start in starts]
    engine = mujoco.MjModel.from_xml_string(xml)
    both = [(mujoco.MjData(engine), module.Budget(engine)) for _ in starts]
    for (data, _), start in zip(both, starts, strict=True):
        data.qpos[:] = start
    while both[0][0].time < 0.2:
        for data, friction in both:
            friction.write(engine, data)
            mujoco.mj_step(engine, data)

    assert alone == [data.qpos.tolist() for data, _ in both]


def test_the_loads_are_those_of_the_state_before_the_step(links: Links) -> None:
    """In a swing the levels are those of this state solved once more, with them: the rest is a fifth of 1 %.

    That is what friction changes in a step of 2 ms; of the loads of the step before it would be 0.8 %. What
    MuJoCo starts its next step from, the warm start included, is as it was.
    """
    _, module, xml = links
    engine, kept = mujoco.MjModel.from_xml_string(xml), mujoco.mjtState.mjSTATE_FULLPHYSICS
    data, solved, friction = mujoco.MjData(engine), mujoco.MjData(engine), module.Budget(engine)
    kept |= mujoco.mjtState.mjSTATE_WARMSTART
    before, after = np.empty((2, mujoco.mj_stateSize(engine, kept)))
    data.qpos[:], levels = (0.9, 0.7), []
    while data.time < 1.0:
        mujoco.mj_getState(engine, data, before, kept)
        friction.write(engine, data)
        mujoco.mj_getState(engine, data, after, kept)
        mujoco.mj_setState(engine, solved, after, kept)
        mujoco.mj_forward(engine, solved)
        levels.append((engine.dof_frictionloss.copy(), friction.at(engine, solved)[0]))
        mujoco.mj_step(engine, data)

        assert np.array_equal(before, after)
    found, expected = np.swapaxes(levels, 0, 1)
    assert np.sqrt(np.mean((found - expected) ** 2)) < 2e-3 * np.sqrt(np.mean(expected**2))


def test_a_force_on_the_last_link_loads_both_bearings(links: Links) -> None:
    """50 N downwards at its centre of mass: both bearings carry it, and their levels rise by it."""
    _, module, xml = links
    engine = mujoco.MjModel.from_xml_string(xml)
    data, friction, levels = mujoco.MjData(engine), module.Budget(engine), []
    for force in (0.0, 50.0):
        data.xfrc_applied[-1, 2] = -force
        mujoco.mj_forward(engine, data)
        F_N, F_T, *_ = friction.loads(engine, data)
        levels.append(friction.at(engine, data)[0])
        below = 9.81 * np.array([sum(MASSES), MASSES[1]])

        assert pytest.approx(below + force, rel=1e-9) == F_N
        assert pytest.approx([0.0, 0.0], abs=1e-9) == F_T
    coefficients = np.array([FRICTION["C_lN_0"], FRICTION["C_lN_1"] + 0.03 * 0.004])
    assert levels[1] - levels[0] == pytest.approx(50.0 * coefficients, rel=1e-6)


FLOOR = '<geom type="plane" size="1 1 1" pos="0 0 -0.51"/>'


def test_a_contact_takes_load_off(links: Links) -> None:
    """An arm that stands on a floor: the bearings carry the weight less the force of the contact."""
    _, module, xml = links
    ball = '<geom type="sphere" size="0.02" pos="0 0 -0.2" mass="0"/></body></body>'
    xml = xml.replace('<flag contact="disable"/>', "").replace("<worldbody>", f"<worldbody>{FLOOR}")
    engine = mujoco.MjModel.from_xml_string(xml.replace("</body></body>", ball))
    data, friction, wrench = mujoco.MjData(engine), module.Budget(engine), np.zeros(6)
    mujoco.mj_forward(engine, data)
    F_N, *_ = friction.loads(engine, data)
    mujoco.mj_contactForce(engine, data, 0, wrench)
    moved = 9.81 * np.array([sum(MASSES), MASSES[1]]) - wrench[0]

    assert wrench[0] > 10.0
    assert pytest.approx(np.abs(moved), rel=1e-6) == F_N


def test_what_cannot_be_exported(tmp_path: Path) -> None:
    """Other targets, speeds, and gear ratios that are parameters are refused in one line."""
    path = ROOT / "examples" / "arms" / "planar_2r.toml"
    with pytest.raises(InputError, match="to: expected budget for an arm, got 'mjcf'"):
        eccentric.export(path, "mjcf", tmp_path / "a")
    with pytest.raises(InputError, match="speeds: expected none for an arm"):
        eccentric.export(path, "budget", tmp_path / "b", speeds=(1.0, 2.0))
    assert not list(tmp_path.iterdir())


def test_an_arm_without_friction_says_so(tmp_path: Path) -> None:
    """The friction of an arm file alone is 0; with parameters it is not."""
    path = ROOT / "examples" / "arms" / "planar_2r.toml"
    plain = eccentric.export(path, "budget", tmp_path / "a")
    fitted = eccentric.export(path, "budget", tmp_path / "b", parameters={"C_lN_0": 0.01})

    assert "all friction coefficients are 0: give those of a fit with --parameters" in plain.summary()
    assert "coefficients are 0" not in fitted.summary()
    assert [p.name for p in plain.paths] == ["planar_2r.py", "eccentric_runtime.py", "planar_2r_budget.py"]
