"""A draft of a log with the angle of one side of the gear and the speed of the other."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping

import numpy as np
import pytest

from eccentric.api import draft_rig, fit
from eccentric.virtual_bench import random_scenario, simulate

MU = 0.2
DEG, RPM = 180.0 / np.pi, 30.0 / np.pi


def log_of(case: str, angle: tuple[str, float], speed: tuple[str, float]) -> dict[str, np.ndarray]:
    """A simulated log whose angle and speed, of the motor in SI, have other names and factors."""
    rng = np.random.default_rng(5)
    run = simulate(random_scenario(rng, case=case, mu=MU, log_type="traj", seconds=25.0)).columns
    named = {"theta_m_rad": angle, "omega_m_rad_s": speed}
    return {named[k][0] if k in named else k: x * named[k][1] if k in named else x for k, x in run.items()}


def channels(columns: Mapping[str, np.ndarray]) -> tuple[set[str], object]:
    """The channels of angle and speed, and mu, of the draft."""
    rig = tomllib.loads(draft_rig(columns).text)
    return {c for c in rig["columns"] if c.startswith(("theta", "omega"))}, rig["known"]["mu"]


@pytest.mark.parametrize("case", ["C1", "C2"])
@pytest.mark.parametrize("names", [("arm_angle_deg", "motor_speed_rpm"), ("angle_deg", "speed_rpm")])
def test_a_faster_speed_is_that_of_the_motor(case: str, names: tuple[str, str]) -> None:
    """In C1, where gravity shows no gear, the slope does."""
    columns = log_of(case, (names[0], MU * DEG), (names[1], RPM))
    assert channels(columns) == ({"theta_l", "omega_m"}, "1/5")


@pytest.mark.parametrize("case", ["C1", "C2"])
def test_a_slower_speed_is_that_of_the_link(case: str) -> None:
    """The other way round."""
    columns = log_of(case, ("motor_angle_deg", DEG), ("arm_speed_rpm", MU * RPM))
    assert channels(columns) == ({"theta_m", "omega_l"}, "1/5")


def test_a_name_that_says_otherwise_is_believed() -> None:
    """A speed called that of the arm, five times as fast as the arm's angle, is no gear."""
    columns = log_of("C2", ("arm_angle_deg", MU * DEG), ("arm_speed_rpm", RPM))
    found, mu = channels(columns)
    assert (found, mu) == ({"theta_l", "omega_l"}, 1)


def test_the_draft_fits_as_the_rig_does() -> None:
    """The friction of a mixed log is that of the plain one."""
    plain = log_of("C1", ("theta_m_rad", 1.0), ("omega_m_rad_s", 1.0))
    mixed = log_of("C1", ("arm_angle_deg", MU * DEG), ("motor_speed_rpm", RPM))
    values = {"M": "0.5 kg", "L": "0.3 m", "k_i": "0.06 N m/A"}
    errors = []
    for columns in (plain, mixed):
        rig = tomllib.loads(draft_rig(columns).text)
        rig["known"] |= values | {"mu": MU}
        errors.append(fit(columns, rig).rmse["paper"])
    assert errors[1] == pytest.approx(errors[0], rel=1e-3)
