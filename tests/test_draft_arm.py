"""The rig of an arm is drafted from its log: columns by pattern, side and unit of each."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric import cli
from eccentric.core import InputError
from eccentric.drafting import draft_of_arm
from eccentric.drafting.of_arm import _agreed
from eccentric.drafting.proposal import Proposal
from eccentric.logs import Log
from eccentric.rigs import read_arm, read_arm_rig
from eccentric.signals import read_joints
from tests.arm_logs import arm_log_of, plain, planar_arm

ARM = """
name = "planar"
gravity = [0, "-9.81 m/s^2", 0]
[[joint]]
name = "shoulder"
axis = [0, 0, 1]
mu = "1/9"
body = { mass = "0.8 kg", centre = [0, "-0.3 m", 0] }
[[joint]]
name = "elbow"
axis = [0, 0, 1]
position = [0, "-0.3 m", 0]
mu = "1/6"
body = { mass = "0.6 kg", centre = [0, "-0.25 m", 0] }
"""
DEG = 180.0 / np.pi


def log_with(names: dict[str, str], factors: dict[str, float], gear: float = 1.0) -> Log:
    """The log of the planar arm under other names and in other units; angles are `gear` times the joints'."""
    table = arm_log_of(plain, runs=3, seconds=10.0)
    columns = {}
    for j in range(2):
        own = {"q": gear * table[f"q_rad_{j + 1}"], "tau": table[f"tau_Nm_{j + 1}"]}
        columns |= {names[k].format(j=j): factors.get(k, 1.0) * x for k, x in own.items()}
    rows = len(table["t_s"])
    return Log("arm.csv", {"run": table["run"], "t": table["t_s"], **columns}, rows)


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """The file of the planar arm."""
    path = tmp_path / "planar.toml"
    path.write_text(ARM)
    return path


def test_columns_are_found_by_pattern_and_the_draft_is_a_rig(arm: Path, tmp_path: Path) -> None:
    """Degrees and millinewton metres of joints counted from 0 are read as that, in a rig file."""
    log = log_with({"q": "joint{j}_pos [deg]", "tau": "joint{j}_torque [mNm]"}, {"q": DEG, "tau": 1e3})
    found = eccentric.draft_rig(log, arm=arm, beside=tmp_path)
    out = found.write(tmp_path / "rig.toml")
    content = tomllib.loads(out.read_text(encoding="utf-8"))

    assert "planar.toml" == content["arm"]
    assert {"column": "joint{j}_pos [deg]", "unit": "deg"} == content["columns"]["theta_l"]
    assert {"column": "joint{j}_torque [mNm]", "unit": "mNm"} == content["columns"]["torque_l"]
    assert ("t", "run", 0) == (
        content["columns"]["time"],
        content["columns"]["run"],
        content["joints"]["first"],
    )
    assert () == found.needed
    shoulder, _ = read_joints([log], read_arm_rig(out))
    true = arm_log_of(plain, runs=3, seconds=10.0)["q_rad_1"]
    assert shoulder.motion.theta_logged / 9.0 == pytest.approx(true, abs=1e-6)


def test_an_angle_that_travels_far_is_the_motors() -> None:
    """No joint turns fifty times; the name says nothing, and that is a doubt."""
    log = log_with({"q": "pos_rad_{j}", "tau": "tau_{j}"}, {}, gear=100.0)
    found = {p.channel: p for p in draft_of_arm(log, planar_arm(), "arm.toml").proposals}

    assert "the motor's" in found["theta_m"].doubt
    assert "theta_l" not in found


def test_a_joint_at_rest_is_told_and_the_others_speak() -> None:
    """A joint that does not move has no vote, and is named in the draft."""
    log = log_with({"q": "q_{j}", "tau": "tau_{j}"}, {})
    columns = {**log.columns, "q_1": np.full(log.rows, 0.3)}
    found = draft_of_arm(Log("arm.csv", columns, log.rows), planar_arm(), "arm.toml")

    assert {"theta_l", "torque_l", "time", "run"} == {p.channel for p in found.proposals}
    assert any(fact.startswith("joint 1 shows no motion") for fact in found.facts)


def test_a_log_of_another_arm_is_refused() -> None:
    """Three joints where the log has two: what is required, and what there is."""
    log = log_with({"q": "q_{j}", "tau": "tau_{j}"}, {})
    two = planar_arm()
    three = type(two)("three", [*two.joints, two.joints[1]], [*two.bodies, two.bodies[1]], two.gravity)
    with pytest.raises(InputError, match="expected columns of 3 joints, such as q_1 to q_3, got at most 2"):
        draft_of_arm(log, three, "arm.toml")


def test_the_command_writes_the_path_of_the_arm_from_the_rig(arm: Path, tmp_path: Path) -> None:
    """A rig file in another folder than the arm finds it; constants of the drives are asked for."""
    table = log_with({"q": "q_rad_{j}", "tau": "i_A_{j}"}, {})
    log, out = tmp_path / "log.csv", tmp_path / "rigs" / "rig.toml"
    out.parent.mkdir()
    numbers = [name for name in table.columns if name != "run"]
    rows = np.column_stack([table.columns[name] for name in numbers])
    np.savetxt(log, rows, delimiter=",", header=",".join(numbers), comments="")

    assert 0 == cli.main(["rig", str(log), "--arm", str(arm), "--out", str(out)])
    text = out.read_text(encoding="utf-8")
    assert "../planar.toml" == tomllib.loads(text)["arm"]
    assert f"#? k_i = {json.dumps(['0.1 N m/A'] * 2)}" in text
    assert 2 == len(read_arm_rig(out).joints) == len(read_arm(arm).joints)


def test_a_column_that_all_joints_agree_on_is_no_doubt() -> None:
    """A doubt is where a joint that moves says otherwise, or nothing; the confidence is shared out."""
    angle = Proposal("theta_l", "q_1", "rad", ("its range",), 0.9)
    found = [_agreed("q_{j}", [angle] * votes, 3) for votes in (3, 2)]

    assert ["", "so in 2 of 3 joints that move"] == [p.doubt for p in found]
    assert pytest.approx([0.9, 0.6]) == [p.confidence for p in found]
