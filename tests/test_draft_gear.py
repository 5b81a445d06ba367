"""A draft of a log with the angle of one side of the gear and the speed of the other."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Mapping

import numpy as np
import pytest

from eccentric.api import check_rig, draft_rig, fit
from eccentric.drafting.against import log_complaints
from eccentric.drafting.draft import Draft
from eccentric.drafting.proposal import Proposal, RigLine
from eccentric.logs import Log
from eccentric.rigs import read_rig
from eccentric.virtual_bench import random_scenario, simulate

MU = 0.2
DEG, RPM = 180.0 / np.pi, 30.0 / np.pi


@functools.cache
def bench(case: str) -> dict[str, np.ndarray]:
    """A simulated log without effects."""
    rng = np.random.default_rng(5)
    return simulate(random_scenario(rng, case=case, mu=MU, log_type="traj", seconds=20.0)).columns


def log_of(case: str, angle: tuple[str, float], speed: tuple[str, float]) -> dict[str, np.ndarray]:
    """A simulated log whose angle and speed, of the motor in SI, have other names and factors."""
    run = bench(case)
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


def test_a_gear_by_a_guessed_unit_is_a_guess() -> None:
    """A speed without a unit in its header: the draft doubts its gear, and the check asks nothing of it."""
    columns = log_of("C2", ("phi_arm_deg", MU * DEG), ("n_mot", RPM))
    draft = draft_rig(columns)
    rig = tomllib.loads(draft.text)
    assert any("mu" in doubt for doubt in draft.doubts)

    rig["columns"]["omega_m"] = {"column": "n_mot", "unit": "rpm"}
    rig["known"] |= {"mu": MU, "M": "0.5 kg", "L": "0.3 m", "M_l": "0.2 kg"}
    assert not [line for line in check_rig(columns, rig).complaints if "[known] mu" in line]


@pytest.mark.slow
def test_the_draft_fits_as_the_rig_does() -> None:
    """Friction and inertia of a mixed log, with the gear of its draft, are those of the plain one."""
    plain = log_of("C1", ("theta_m_rad", 1.0), ("omega_m_rad_s", 1.0))
    mixed = log_of("C1", ("arm_angle_deg", MU * DEG), ("motor_speed_rpm", RPM))
    values = {"M": "0.5 kg", "L": "0.3 m", "k_i": "0.06 N m/A"}
    found = []
    for columns, gear in ((plain, {"mu": MU}), (mixed, {})):
        rig = tomllib.loads(draft_rig(columns).text)
        rig["known"] |= {**values, **gear}
        found.append({name: e.value for name, e in fit(columns, rig).estimates.items()})
    assert found[1] == pytest.approx(found[0], rel=1e-3)


@pytest.mark.parametrize("mapped", [("theta_m", "theta_m_rad"), ("omega_m", "omega_m_rad_s")])
def test_a_rig_of_one_side_is_not_contradicted_by_the_other(mapped: tuple[str, str]) -> None:
    """Everything seen at the arm, mu = 1: a speed of the motor that it does not map says nothing of it."""
    factors = {"theta_m_rad": MU, "omega_m_rad_s": 1.0} if mapped[0] == "theta_m" else {"omega_m_rad_s": MU}
    columns = log_of("C1", *((name, factors.get(name, 1.0)) for name in ("theta_m_rad", "omega_m_rad_s")))
    draft = tomllib.loads(draft_rig(columns).text)
    rig = {**draft, "columns": {"time": "time_s", "current": "current_A", mapped[0]: mapped[1]}}
    rig["known"] = {"case": "C1", "mu": 1, "M": "0.5 kg", "L": "0.3 m", "k_i": "0.3 N m/A"}

    assert not [line for line in check_rig(columns, rig).complaints if "mu" in line]


@pytest.mark.parametrize("mapped", [False, True])
def test_a_gear_between_two_columns_judges_a_rig_that_has_both(mapped: bool) -> None:
    """The arm's angle against the motor's speed shows 1/5; a rig without that speed may have mu = 1."""
    units = {"time": "s", "theta_l": "rad", "omega_m": "rad/s", "torque": "N m"}
    proposals = tuple(Proposal(name, name, unit, (), 0.9) for name, unit in units.items())
    draft = Draft("log.csv", proposals, (RigLine("known", "mu", '"1/5"', "the slope"),), {}, ())
    log = Log("log.csv", {name: np.arange(5.0) for name in units}, 5)
    columns = {name: {"column": name, "unit": units[name]} for name in units if mapped or name != "omega_m"}
    rig = read_rig({"columns": columns, "known": {"case": "C1", "mu": 1.0}})

    complaints = [one for one in log_complaints(rig, log, draft) if one.key == "mu"]

    assert mapped == bool(complaints)
