"""Logs, rigs, arms and truths of the bench for arms, its function and its command."""

from __future__ import annotations

import json
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric import InputError, cli
from eccentric.rigs import read_arm
from eccentric.virtual_bench import ARM_EFFECTS, ARM_VARIANTS, ArmRun, random_arm_scenario, simulate_arm
from tests.armbench import drawn_arm_scenario, require_mujoco

require_mujoco()


@pytest.fixture(scope="module")
def control() -> ArmRun:
    """An arm without effects."""
    return simulate_arm(drawn_arm_scenario(4))


def test_a_control_differs_by_nothing_but_the_effect(control: ArmRun) -> None:
    """Arm, rig and friction coefficients are the same; the truth of one has an effect, the other's none."""
    other = simulate_arm(drawn_arm_scenario(4, effects=["viscous_asymmetry@1"]))

    assert (control.arm, control.rig) == (other.arm, other.rig)
    assert [j["friction"] for j in control.truth["joints"]] == [j["friction"] for j in other.truth["joints"]]
    assert ([], [("viscous_asymmetry", 1)]) == (
        control.truth["effects"],
        [(e["family"], e["joint"]) for e in other.truth["effects"]],
    )
    assert (control.columns["i_A_1"] != other.columns["i_A_1"]).any()


def test_the_log_has_runs_from_rest_on_one_clock(control: ArmRun) -> None:
    """Three runs, time that grows, every joint at rest at the start of each."""
    run, t = control.columns["run"], control.columns["t_s"]
    starts = np.flatnonzero(np.diff(run, prepend=0.0))

    assert [1.0, 2.0, 3.0] == run[starts].tolist()
    assert (np.diff(t) > 0.0).all()
    assert (np.abs(control.columns["w_rad_s_1"][starts]) < 0.02).all()


def test_torque_is_current_over_the_gear(control: ArmRun) -> None:
    """A log of torques is that of currents times k_i/mu, and its rig declares no motor."""
    torque = simulate_arm(drawn_arm_scenario(4, measured="torque"))
    k_i = control.rig["drives"]["k_i_Nm_per_A"][1]
    mu = control.truth["joints"][1]["mu"]

    np.testing.assert_allclose(
        control.columns["i_A_2"] * k_i / mu, torque.columns["tau_Nm_2"], atol=1e-5 * (1.0 + k_i / mu)
    )
    assert "drives" not in torque.rig
    assert "tau_Nm_{j}" == torque.rig["columns"]["torque_l"]


def test_an_effect_of_temperature_brings_its_column() -> None:
    """Every joint's temperature is logged where an effect needs it, and rises from the surroundings'."""
    run = simulate_arm(drawn_arm_scenario(4, effects=["coulomb_temperature@1"]))

    assert "temperature_C_{j}" == run.rig["columns"]["temperature"]
    for j in (1, 2):
        warm = run.columns[f"temperature_C_{j}"]
        assert 22.0 == pytest.approx(warm[0], abs=0.3)
        assert warm[-1] > 25.0


def test_the_arm_file_is_read_as_the_arm(tmp_path: Path) -> None:
    """Gears, rotors, bodies and gravity; the rig names the arm file and every column of the log."""
    result = eccentric.bench_arm("3", seconds=15, runs=3, seed=2, out=tmp_path / "log.csv.gz")
    rig = tomllib.loads((tmp_path / "log.toml").read_text())
    chain = read_arm(tmp_path / rig["arm"])

    for joint, body, given in zip(chain.joints, chain.bodies, result.arm["joint"], strict=True):
        assert given["name"] == joint.name
        assert given["mu"] == str(joint.mu)
        assert pytest.approx(given["J_m_kgm2"]) == float(joint.J_m)
        assert pytest.approx(given["body"]["mass_kg"]) == float(body.mass)
    named = {text.replace("{j}", str(j)) for text in rig["columns"].values() for j in (1, 2, 3)}
    assert set(eccentric.read_log(tmp_path / "log.csv.gz").columns) == named
    assert result.truth["effects"] == json.loads((tmp_path / "log.truth.json").read_text())["effects"]


def test_the_command_writes_what_the_function_returns(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Four files, byte for byte, and two lines; nothing is drawn on what is no terminal."""
    wanted = ["--effect", "stribeck@2=0.2", "--seconds", "15", "--runs", "3", "--seed", "6"]
    assert 0 == cli.main(["bench", "--arm", "2r", "--out", str(tmp_path / "log.csv.gz"), *wanted])
    said = capsys.readouterr()
    result = eccentric.bench_arm("2r", {"stribeck@2": 0.2}, seconds=15, runs=3, seed=6)

    for path in result.write(tmp_path / "function" / "log.csv.gz"):
        assert path.read_bytes() == (tmp_path / path.name).read_bytes()
    assert "3750 rows in 3 runs, 2 joints" in said.out
    assert f"sealed in {tmp_path}/log.truth.json: 1 effect\n" == said.out.splitlines(keepends=True)[1]
    assert "" == said.err
    assert "stribeck" not in (tmp_path / "log.toml").read_text() + (tmp_path / "log.arm.toml").read_text()


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["--arm", "7"], "--arm: expected 2r or 3 or 6, got 7"),
        (["--arm", "2r", "--effect", "stribec@1"], "--effect stribec@1: expected one of stribeck, "),
        (["--arm", "2r", "--effect", "stribeck@3"], "--effect stribeck@3: expected a joint from 1 to 2, "),
        (["--arm", "2r", "--effect", "stribeck@0"], "--effect stribeck@0: expected a joint from 1 to 2, "),
        (
            ["--arm", "2r", "--effect", "stribeck@1=2"],
            "--effect stribeck@1: expected a strength above 0 and at most 1",
        ),
        (["--arm", "2r", "--effect", "stribeck[x]"], "--effect stribeck: expected no variant, got x"),
        (["--arm", "2r", "--runs", "2"], "--runs: expected 3 to 20, got 2"),
        (["--arm", "2r", "--seconds", "5"], "--seconds: expected 15 to 3600, got 5.0"),
        (["--arm", "2r", "--rate", "100"], "--rate: expected 250 or 500, got 100"),
        (["--arm", "2r", "--measured", "voltage"], "--measured: expected current or torque, "),
        (["--arm", "2r", "--mu", "0.1"], "--mu: expected no --arm with it, got 2r"),
        (["--runs", "4"], "--runs: expected --arm with it, got none"),
    ],
)
def test_what_is_no_bench_is_one_line(
    arguments: list[str], line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The option, what is required, what was received; and no file."""
    assert 2 == cli.main(["bench", "--out", str(tmp_path / "log.csv.gz"), *arguments])
    said = capsys.readouterr().err
    assert said.startswith(f"eccentric: error: {line}")
    assert 1 == said.count("\n")
    assert [] == list(tmp_path.iterdir())


def test_without_mujoco_its_command_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """One line that says what to install."""
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(InputError, match=r"MuJoCo is required .*: pip install 'eccentric\[arms-bench\]'$"):
        eccentric.bench_arm("2r")


@pytest.mark.parametrize(
    "family",
    [pytest.param(family, marks=pytest.mark.slow if k % 4 else ()) for k, family in enumerate(ARM_EFFECTS)],
)
def test_every_family_can_be_drawn(family: str) -> None:
    """Each has a law that the course shows, with an amplitude for its strength."""
    scenario = random_arm_scenario(
        np.random.default_rng(1), effects=[f"{family}@2"], seconds=15, runs=3, arm="2r"
    )
    (one,) = scenario.effects

    assert (family, 1) == (one.effect.family, one.joint)
    assert one.effect.amplitude > 0.0
    assert one.effect.variant in {*ARM_VARIANTS.get(family, ("",))}


def test_the_table_and_the_figure_show_every_joint() -> None:
    """Columns with their ranges; angle, velocity and current of each joint over time."""
    from matplotlib import pyplot as plt

    result = eccentric.bench_arm("2r", seconds=15, runs=3, seed=4)
    axes = result.plot()

    assert list(result.log.columns) == result.table()["column"]
    assert [2, 2, 2] == [len(one.lines) for one in axes]
    assert "3750 rows of 15 s in 3 runs, bench_2r" == result.summary() == str(result)
    assert "q_rad_1" in result._repr_html_()
    plt.close("all")
