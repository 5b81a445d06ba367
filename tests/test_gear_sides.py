"""A motion read on the wrong side of the gear, or a wrong mu, is told as such, not as another k_e or k_i."""

from __future__ import annotations

import functools
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from eccentric.api import check_rig
from eccentric.virtual_bench import BenchRun, random_scenario, simulate

MU = 0.2
MOTOR, LINK = ("theta_m", "omega_m"), ("theta_l", "omega_l")


@functools.cache
def bench(case: str) -> BenchRun:
    """A log of the motor without effects, and its rig."""
    rng = np.random.default_rng(3)
    return simulate(random_scenario(rng, case=case, mu=MU, log_type="traj", seconds=15.0))


def told(
    case: str, folder: Path, at_link: bool, mapped: tuple[str, str], mu: float, k_e: float = 1.0
) -> tuple[str, ...]:
    """What is said of a log of one side of the gear under a rig with this mapping, mu and k_e off by this."""
    run = bench(case)
    columns: dict[str, NDArray[np.float64]] = dict(run.columns)
    for name in ("theta_m_rad", "omega_m_rad_s"):
        columns[name] = columns[name] * (MU if at_link else 1.0)
    np.savetxt(folder / "log.csv", np.column_stack([*columns.values()]), "%.9g", ",",
               header=",".join(columns), comments="")  # fmt: skip
    angle, speed = mapped
    channels = {"time": "time_s", angle: "theta_m_rad", speed: "omega_m_rad_s",
                "current": "current_A", "voltage": "voltage_V"}  # fmt: skip
    rig: dict[str, Any] = {**run.rig, "columns": channels, "known": {**run.rig["known"], "mu": mu}}
    rig["known"]["k_e_Vs_per_rad"] *= k_e
    (folder / "rig.json").write_text(json.dumps(rig), encoding="utf-8")
    return check_rig(str(folder / "log.csv"), str(folder / "rig.json")).complaints


@pytest.mark.parametrize(
    ("case", "at_link", "mapped", "mu", "words"),
    [
        ("C2", False, LINK, MU, "if the angle is the motor's, mapped as the link's"),
        ("C2", True, MOTOR, MU, "if the angle is the link's, mapped as the motor's"),
        ("C1", False, LINK, MU, "the angle is the motor's, mapped as the link's"),
        ("C1", True, MOTOR, MU, "the angle is the link's, mapped as the motor's"),
        ("C2", True, LINK, MU / 2.0, r"mu is 0\.1 in the rig file, and 0\.(2|199|201) makes k_e"),
        ("C1", True, LINK, MU / 2.0, r"\(or is mu 0\.(2|199|201)\?\)"),
        ("C2", False, MOTOR, 1.0, r"\[known\] mu = 1: the log shows"),
    ],
)
def test_the_gear_is_blamed_and_nothing_else(
    case: str, at_link: bool, mapped: tuple[str, str], mu: float, words: str, tmp_path: Path
) -> None:
    """One line, without a value of k_e or k_i that would only hide the cause."""
    (line,) = told(case, tmp_path, at_link, mapped, mu)
    assert re.search(words, line)
    assert "write" not in line


@pytest.mark.parametrize("mapped", [MOTOR, LINK])
@pytest.mark.parametrize(
    ("k_e", "words"), [(60.0 / math.tau, "k_e = "), (1.0 / math.tau, "V s/rev"), (1.8, "k_e = ")]
)
def test_a_wrong_constant_is_not_the_gear(
    k_e: float, words: str, mapped: tuple[str, str], tmp_path: Path
) -> None:
    """Gravity agrees with the rig: mu and the sides are right."""
    (line,) = told("C2", tmp_path, mapped == LINK, mapped, MU, 1.0 / k_e)
    assert words in line
    assert "mu" not in line
    assert "mapped as" not in line


@pytest.mark.parametrize(("at_link", "mapped"), [(False, MOTOR), (True, LINK)])
@pytest.mark.parametrize("case", ["C1", "C2"])
def test_the_right_side_is_not_doubted(
    case: str, at_link: bool, mapped: tuple[str, str], tmp_path: Path
) -> None:
    """The same logs with the mapping that is theirs."""
    assert told(case, tmp_path, at_link, mapped, MU) == ()
