"""The rig of an arm: columns by pattern, drives per joint, one line for each bad input; and its check."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.cli import main
from eccentric.core import InputError
from eccentric.model import Chain, Joint
from eccentric.rigs import names_arm, read_arm_rig, read_rig
from eccentric.signals import read_joints
from tests.arm_logs import MU, arm_log_of, arm_rig_of, plain, planar_arm

ARM = planar_arm()
LOG = arm_log_of(plain, runs=3, seconds=10.0)


def test_each_joint_is_a_rig_of_its_own() -> None:
    """The number of the joint is in its columns; its gear and its share of the drives are known."""
    rig = read_arm_rig(
        arm_rig_of(ARM, drives={"k_i": ["0.1 Nm/A", "50 mNm/A"], "R_ohm": 2.0}, joints={"first": 1})
    )
    found = [(one.log.columns or {})["theta_l"].text for one in rig.joints]

    assert ["q_rad_1", "q_rad_2"] == found
    assert [0.1, 0.05] == [one.known["k_i"] for one in rig.joints]
    assert [2.0, 2.0] == [one.known["R"] for one in rig.joints]
    assert pytest.approx(MU) == [one.known["mu"] for one in rig.joints]


def test_the_parts_of_all_joints_or_of_each() -> None:
    """A word at the top is for all joints, a list under [drives] has one for each."""
    rig = read_arm_rig(arm_rig_of(ARM, drives={"gear": ["strain wave", "worm"]}) | {"motor": "brushless"})

    assert [("strain wave",), ("worm",)] == [one.parts["gear"] for one in rig.joints]
    assert [("brushless",)] * 2 == [one.parts["motor"] for one in rig.joints]


def test_the_threshold_is_a_speed_of_the_joint() -> None:
    """Gears differ: what counts as moving is a speed of the joint, divided by the gear for its motor."""
    rig = read_arm_rig(arm_rig_of(ARM))

    assert pytest.approx([0.45, 0.3]) == [one.sampling.moving_threshold_rad_s for one in rig.joints]


def test_a_rig_that_names_an_arm_is_known_as_one() -> None:
    """And is refused where a single drive is required."""
    rig = arm_rig_of(ARM)

    assert names_arm(rig)
    with pytest.raises(InputError, match=r"rig: arm: expected the rig of a single drive here"):
        read_rig({"arm": "x.toml"})


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (
            {"columns": {"time": "t_s", "theta_l": "q_rad", "torque_l": "tau_Nm_{j}"}},
            r"\[columns\] theta_l: expected a pattern with \{j\}, the number of the joint,",
        ),
        (
            {"columns": {"time": "t_{j}", "theta_l": "q_rad_{j}", "torque_l": "tau_Nm_{j}"}},
            r"\[columns\] time: expected one column for all joints, got a pattern",
        ),
        (
            {"drives": {"k_i": ["0.1 Nm/A"]}},
            r"\[drives\] k_i: expected one value, or one for each of 2 joints, got",
        ),
        ({"drives": {"k_i": "0.1 V"}}, r"rig: \[drives\] k_i: "),
        ({"drives": {"gear": "harmonic"}}, r"rig: gear: expected one of strain wave, planetary, worm, "),
        ({"drives": {"mu": 0.1}}, r"\[drives\]: unknown key 'mu'"),
        (
            {"joints": {"inertial": "closed"}},
            r'\[joints\] inertial: expected "known", "open" or a list of mass, cen',
        ),
        ({"joints": {"inertial": ["centre"]}}, r"expected mass before centre before inertia, got cent"),
        ({"joints": {"inertial": ["mass", "inertia"]}}, r"got mass, inertia without what comes before"),
        ({"joints": {"inertial": ["mas"]}}, r"\[joints\] inertial: unknown key 'mas'"),
        ({"joints": {"first": -1}}, r"\[joints\] first: expected a whole number of 0 or above, got -1"),
        (
            {"known": {"M": "1 kg"}},
            r"rig: \[known\]: expected bodies and gear ratios in the arm file, k_i, R and k_e in \[drives\]",
        ),
        (
            {"columns": {"time": "t_s", "omega_l": "w_{j}", "torque_l": "tau_Nm_{j}"}},
            r"\[columns\]: expected the angle of every joint, as in theta_l = \"q_rad_\{j\}\", got",
        ),
        (
            {"columns": {"time": "t_s", "theta_l": "q_{j}"}, "drive": "current"},
            r"expected what measures the drive of every joint, such as current = \"current_\{j\}\", got",
        ),
        (
            {"columns": {"time": "t_s", "theta_l": "q_{j}", "current": "i_{j}"}},
            r"expected what measures the drive of every joint, such as torque_l = \"torque_l_\{j\}\"",
        ),
        ({"arm": "nope.toml"}, r"^rig: arm: nope.toml: no such file$"),
        ({"arm": 3}, r"rig: arm: expected the path of an arm"),
    ],
)
def test_bad_input_is_one_line(more: dict[str, Any], message: str) -> None:
    """File, key, what is required and what was received."""
    with pytest.raises(InputError, match=message):
        read_arm_rig(arm_rig_of(ARM) | more)


@pytest.fixture(scope="module")
def log() -> dict[str, Any]:
    """Three short runs of the arm."""
    return LOG


def test_a_column_for_some_joints_only_is_refused(log: dict[str, Any]) -> None:
    """The message counts the columns and names the first that is missing."""
    some = {name: values for name, values in log.items() if name != "tau_Nm_2"}

    with pytest.raises(
        InputError, match=r"torque_l: expected column 'tau_Nm_2' for joint 2 of planar .*, got 1 of 2 joints"
    ):
        read_joints([some], read_arm_rig(arm_rig_of(ARM)))


def test_a_joint_number_that_the_log_lacks_is_refused(log: dict[str, Any]) -> None:
    """Columns that count from 1 under a rig that counts from 4: joint, arm and base are named."""
    said = r"theta_l: expected column 'q_rad_4' for joint 4 of planar \(columns count from first = 4\), the"
    with pytest.raises(InputError, match=said):
        read_joints([log], read_arm_rig(arm_rig_of(ARM, joints={"first": 4})))


def test_the_closest_column_is_proposed(log: dict[str, Any]) -> None:
    """A name with a space that is misspelt."""
    spaced = {name.replace("q_rad_", "Axis "): values for name, values in log.items()}
    columns = {"time": "t_s", "run": "run", "theta_l": "Axi {j}", "torque_l": "tau_Nm_{j}"}

    with pytest.raises(InputError, match=r"theta_l: expected column 'Axi 1' .*; did you mean 'Axis 1'\?"):
        read_joints([spaced], read_arm_rig(arm_rig_of(ARM, columns=columns)))


def test_a_log_of_more_joints_than_the_arm_is_refused(log: dict[str, Any]) -> None:
    """The first link alone under a log of two: the elbow would swing unseen."""
    one = Chain("alone", ARM.joints[:1], ARM.bodies[:1], ARM.gravity)

    with pytest.raises(
        InputError,
        match=r"expected columns of the 1 joint of alone, the log has 'q_rad_2' for a joint 2 that",
    ):
        read_joints([log], read_arm_rig(arm_rig_of(one)))


def test_arm_and_rig_that_are_swapped_are_told(tmp_path: Path) -> None:
    """The reverse is among the arm files that are refused."""
    (tmp_path / "arm.toml").write_text('[[joint]]\nname = "elbow"\n', encoding="utf-8")

    with pytest.raises(InputError, match=r"arm.toml: expected a rig file, got an arm file; a rig nam"):
        read_rig(tmp_path / "arm.toml")


def test_a_gear_upside_down_is_a_possible_cause(log: dict[str, Any]) -> None:
    """Angle at the joint, speed at the motor: with 9 for 1/9 they differ by 81, and mu is named."""
    joints = [Joint(mu=1 / MU[0], name="shoulder"), ARM.joints[1]]
    rig = arm_rig_of(Chain("planar", joints, ARM.bodies, ARM.gravity))
    t, moving = log["t_s"], dict(log)
    for j, mu in enumerate(MU, 1):
        moving[f"w_{j}"] = np.gradient(log[f"q_rad_{j}"]) / np.gradient(t) / mu
    shoulder, elbow = read_joints(
        [moving], read_arm_rig(rig | {"columns": rig["columns"] | {"omega_m": "w_{j}"}})
    )

    assert any(
        "mu = 9 is the reciprocal of what it should be? Correct" in x for x in shoulder.intake.warnings
    )
    assert not any("reciprocal" in x for x in elbow.intake.warnings)


def test_rows_without_a_number_for_one_joint_are_dropped_for_all(log: dict[str, Any]) -> None:
    """So that every joint has the motion of all others."""
    torn = dict(log)
    torn["q_rad_2"] = np.where(np.arange(len(log["t_s"])) % 50 == 7, np.nan, log["q_rad_2"])
    channels = read_joints([torn], read_arm_rig(arm_rig_of(ARM)))

    assert len(log["t_s"]) - np.count_nonzero(np.isnan(torn["q_rad_2"])) == len(channels[0].time.t)
    assert np.array_equal(channels[0].time.t, channels[1].time.t)


def test_all_joints_pass_one_low_pass(log: dict[str, Any]) -> None:
    """The motion of every joint loads the others: a coarse angle in one lowers the cut-off of all."""
    coarse = dict(log)
    coarse["q_rad_2"] = np.round(log["q_rad_2"], 2)
    channels = read_joints([coarse], read_arm_rig(arm_rig_of(ARM)))

    assert channels[0].rig.sampling.low_pass_hz == channels[1].rig.sampling.low_pass_hz < 25.0


# `eccentric rig --check` for an arm: all that is wrong at once, or what the log determines.


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
