"""`eccentric rig --check` for an arm: all that is wrong at once, or what the log determines of each joint."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.cli import main
from tests.arm_logs import arm_log_of, arm_rig_of, plain, planar_arm

ARM = planar_arm()
LOG = arm_log_of(plain, runs=3, seconds=10.0)


def test_a_rig_without_faults_is_fitted() -> None:
    """The friction of each joint with its interval, which holds what was put in, on the motor side."""
    found = eccentric.check_rig(LOG, arm_rig_of(ARM))

    assert found.complaints == ()
    for joint, C in (("1", 0.30 * float(ARM.joints[0].mu)), ("2", 0.12 * float(ARM.joints[1].mu))):
        (line,) = (x for x in found.estimated if x.split()[:1] == [joint] and " C_m " in x)
        assert float(line.split(" C_m ")[1].split()[0]) == pytest.approx(C, rel=0.02)


def test_every_fault_is_listed_once() -> None:
    """Faults of every table, each once, and nothing that only follows from leaving one of them out."""
    rig = arm_rig_of(ARM, drives={"k_i": ["0.1 Nm/A"], "RR": 1}, joints={"first": -1}, known={"M": "1 kg"})
    rig["columns"]["speed"], rig["low_pass_hz"] = "x", "a"
    found = eccentric.check_rig(LOG, rig).complaints

    said = [
        "[known]",
        "[joints] first",
        "[drives]: unknown key 'RR'",
        "[drives] k_i",
        "key 'speed'",
        "low_pass_hz",
    ]
    assert len(found) == len(said)
    assert all(sum(words in line for line in found) == 1 for words in said)


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"theta_l": "qq_{j}", "torque_l": "tau_Nm_{j}"}, ["no column 'qq_1'", "no column 'qq_2'"]),
        ({"theta_l": 3, "torque_l": "tau_Nm_{j}"}, ["[columns] theta_l"]),
        ({"theta_l": "q_rad_{j}"}, ["expected what measures the drive of every joint"]),
    ],
)
def test_columns_are_held_against_the_log(columns: dict[str, Any], words: list[str]) -> None:
    """Those of each joint that the log lacks; what is no column at all; what is not there."""
    own = {"time": "t_s", "run": "run", **columns}
    found = eccentric.check_rig(LOG, {**arm_rig_of(ARM), "columns": own}).complaints

    assert len(found) == len(words)
    assert all(word in line for word, line in zip(words, found, strict=True))


def test_a_log_of_another_arm_does_not_fit() -> None:
    """Torques of both joints swapped: the loads of the arm do not explain them, and that is the complaint."""
    swapped = {**LOG, "tau_Nm_1": LOG["tau_Nm_2"], "tau_Nm_2": LOG["tau_Nm_1"]}
    (line,) = eccentric.check_rig(swapped, arm_rig_of(ARM)).complaints

    assert line.startswith("rig: ")
    assert "R^2" in line


def test_the_command_lists_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """From files: the arm beside the rig, status 1, each complaint with the path of the rig file."""
    arm = tmp_path / "arm.toml"
    arm.write_text(
        'gravity = [0, "-9.81 m/s^2", 0]\n[[joint]]\nname = "base"\naxis = [0, 0, 1]\nmu = "1/9"\n'
        'body = { mass = "0.8 kg", centre = [0, "-0.3 m", 0] }\n',
        encoding="utf-8",
    )
    log, rig = tmp_path / "log.csv", tmp_path / "rig.json"
    table = np.column_stack([LOG[name] for name in ("t_s", "q_rad_1", "tau_Nm_1")])
    np.savetxt(log, table, delimiter=",", header="t_s,q_rad_1,tau_Nm_1", comments="")
    columns = {"time": "t_s", "theta_l": "q_rad_{j}", "torque_l": "torque_{j}"}
    rig.write_text(json.dumps({"arm": "arm.toml", "drive": "torque", "columns": columns, "name": 7}))

    assert main(["rig", str(log), "--check", str(rig)]) == 1
    found = capsys.readouterr().out.splitlines()
    assert any("no column 'torque_1'" in line for line in found)
    assert all(str(rig) in line for line in found)
