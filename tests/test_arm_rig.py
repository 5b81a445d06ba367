"""The rig of an arm: columns by pattern, drives per joint; one clear line for each kind of bad input."""

from typing import Any

import numpy as np
import pytest

from eccentric.errors import InputError
from eccentric.rigs import names_arm, read_arm_rig, read_rig
from eccentric.signals import read_joints
from tests.arm_logs import MU, arm_log_of, arm_rig_of, plain, planar_arm

ARM = planar_arm()


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


def test_the_threshold_is_a_speed_of_the_joint() -> None:
    """Gears differ: what counts as moving is a speed of the joint, divided by the gear for its motor."""
    rig = read_arm_rig(arm_rig_of(ARM))

    assert pytest.approx([0.45, 0.3]) == [one.sampling.moving_threshold_rad_s for one in rig.joints]


def test_a_rig_that_names_an_arm_is_known_as_one() -> None:
    """And is refused where a single drive is required."""
    rig = arm_rig_of(ARM)

    assert names_arm(rig)
    with pytest.raises(InputError, match=r"rig: arm: the rig of a single drive is required here"):
        read_rig({"arm": "x.toml"})


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (
            {"columns": {"time": "t_s", "theta_l": "q_rad", "torque_l": "tau_Nm_{j}"}},
            r"\[columns\] theta_l: a pattern with \{j\}, the number of the joint, is required",
        ),
        (
            {"columns": {"time": "t_{j}", "theta_l": "q_rad_{j}", "torque_l": "tau_Nm_{j}"}},
            r"\[columns\] time: one column for all joints is required, received a pattern",
        ),
        (
            {"drives": {"k_i": ["0.1 Nm/A"]}},
            r"\[drives\] k_i: one value, or one for each of 2 joints, is requ",
        ),
        ({"drives": {"k_i": "0.1 V"}}, r"rig: \[drives\] k_i: "),
        ({"drives": {"mu": 0.1}}, r"\[drives\]: unknown key 'mu'"),
        ({"joints": {"inertial": "closed"}}, r'\[joints\] inertial: "known", "open" or a list of mass, cen'),
        (
            {"joints": {"inertial": ["centre"]}},
            r"mass before centre before inertia is required, received cent",
        ),
        ({"joints": {"inertial": ["mass", "inertia"]}}, r"received mass, inertia without what comes before"),
        ({"joints": {"inertial": ["mas"]}}, r"\[joints\] inertial: unknown key 'mas'"),
        (
            {"joints": {"first": -1}},
            r"\[joints\] first: a whole number of 0 or above is required, received -1",
        ),
        ({"known": {"M": "1 kg"}}, r"rig: unknown key 'known'"),
        ({"arm": 3}, r"rig: arm: the path of an arm"),
    ],
)
def test_bad_input_is_one_line(more: dict[str, Any], message: str) -> None:
    """File, key, what is required and what was received."""
    with pytest.raises(InputError, match=message):
        read_arm_rig(arm_rig_of(ARM) | more)


@pytest.fixture(scope="module")
def log() -> dict[str, Any]:
    """Three short runs of the arm."""
    return arm_log_of(plain, runs=3, seconds=6.0)


def test_a_column_for_some_joints_only_is_refused(log: dict[str, Any]) -> None:
    """The message counts the columns and names the first that is missing."""
    some = {name: values for name, values in log.items() if name != "tau_Nm_2"}

    with pytest.raises(
        InputError,
        match=r"torque_l: a column for each of 2 joints is required, received 1: 'tau_Nm_2' of joint 2",
    ):
        read_joints([some], read_arm_rig(arm_rig_of(ARM)))


def test_a_joint_number_that_the_log_lacks_is_refused(log: dict[str, Any]) -> None:
    """Columns that count from 1 under a rig that counts from 4."""
    with pytest.raises(InputError, match=r"theta_l: column 'q_rad_4' is required, the log has"):
        read_joints([log], read_arm_rig(arm_rig_of(ARM, joints={"first": 4})))


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
