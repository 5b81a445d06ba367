"""A known mass that some runs carry: it calibrates the drive, and settles what one mass leaves open.

The oracle is the virtual bench, whose simulator shares no code with the models: the second log is of a link
whose mass, centre and inertia are worked out here.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.api.inputs import model_of
from eccentric.errors import InputError
from eccentric.fitting import drive_of, fit_data_of
from eccentric.fitting.residuals import Residuals
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from eccentric.virtual_bench import BenchRun, simulate
from tests.virtual import drawn_scenario

MASS = 0.4
ADDED = f"{MASS} kg"
SECOND = "table?2"
"""The run of the second table."""


def _pair(case: str, effects: tuple[tuple[str, float], ...] = (), noise: float = 0.005) -> list[BenchRun]:
    """A log of a drive, and one with the mass on the link."""
    scenario = drawn_scenario(5, case=case, seconds=30.0, noise=noise, log_type="traj", effects=effects)
    first = simulate(scenario)
    plant, drawn = scenario.plant, first.scenario
    heavy = replace(plant, M=plant.M + MASS, J_l=plant.J_l + MASS * plant.L**2)
    return [first, simulate(replace(drawn, plant=heavy, seed=drawn.seed + 1), again=True)]


def _rig(run: BenchRun, *unknown: str, **changed: Any) -> dict[str, Any]:
    """The rig of the first log by its current, without some of what is known."""
    known = {key: x for key, x in run.rig["known"].items() if key not in unknown}
    columns = [name for name in run.rig["columns"] if name != "voltage_V"]
    # Which rows move is not to depend on the log.
    rig = {**run.rig, "known": known, "columns": columns, "moving_threshold_rad_s": 0.7}
    return {**rig, "added": {SECOND: ADDED}, **changed}


WRONG = {
    "inertia_mismatch": ("inertia_ratio", {"J_m_kgm2": 1.07, "J_l_kgm2": 1.07}),
    "mass_mismatch": ("mass_ratio", {"M_kg": 1.07}),
}
"""Families that correct a declared value: their parameter, and what is declared with a factor."""


@pytest.mark.parametrize("case", ["C1", "C2"])
def test_the_residual_of_each_run_is_that_of_its_own_link(case: str) -> None:
    """Of both logs together, as of each alone with a rig file of its own link."""
    logs = _pair(case)
    rig = read_rig(_rig(logs[0]))
    model = model_of(rig.model)
    values = {q.name: 0.01 for q in model.friction_parameters}

    def residual(
        columns: list[dict[str, np.ndarray]], given: dict[str, Any]
    ) -> tuple[np.ndarray, np.ndarray]:
        own = read_rig(given)
        drive = drive_of(read_channels(columns, own), own, model)
        data = fit_data_of(drive, own, model)
        found = Residuals(model, drive, data.rows, {**drive.known, **values})
        return found.rows("mechanical", {**drive.known, **values}), data.rows.run

    both, run = residual([log.columns for log in logs], _rig(logs[0]))
    for number, log in enumerate(logs):
        alone, _ = residual([log.columns], _rig(log, added={}))
        assert np.max(np.abs(both[run == number] - alone)) < 1e-12 * np.max(np.abs(alone))
    ignored, _ = residual([log.columns for log in logs], _rig(logs[0], added={}))
    assert np.sqrt(np.mean((both - ignored)[run == 1] ** 2)) > 0.1 * np.std(both)


def test_a_known_mass_gives_the_torque_constant_where_gravity_does_not() -> None:
    """In C1 with inertia and k_i open: without the second mass, nothing in the log is in newton metres."""
    logs = _pair("C1")
    true = logs[0].scenario.plant
    rig = _rig(logs[0], "k_i_Nm_per_A", "J_m_kgm2", "J_l_kgm2", unknown={"k_i": ["0.03 N m/A", "0.2 N m/A"]})
    columns = [log.columns for log in logs]

    found = eccentric.fit(columns, rig).document["parameters"]
    assert found["k_i"] == pytest.approx(true.k_i, rel=0.01)
    assert found["J_m"] + true.mu**2 * found["J_l"] == pytest.approx(true.inertia, rel=0.01)

    without = eccentric.fit(columns[:1], {**rig, "added": {}}).document["parameters"]
    assert without["k_i"] == 1.0


@pytest.mark.slow
@pytest.mark.parametrize("family", WRONG)
def test_what_is_wrong_with_the_link_is_not_wrong_with_the_added_mass(family: str) -> None:
    """A declared value 7 % too large is found so, beside a mass that is known: with both, the model fits."""
    logs = _pair("C2", noise=0.003)
    name, factors = WRONG[family]
    rig = _rig(logs[0])
    rig["known"] = {
        key: x * factors.get(key, 1.0) if key in factors else x for key, x in rig["known"].items()
    }
    found = eccentric.diagnose([log.columns for log in logs], rig).document
    assert found["verdict"] == "named"
    (effect,) = found["effects"]
    assert effect["family"] == family
    assert effect["parameters"][name]["value"] == pytest.approx(1.0 / 1.07 - 1.0, abs=0.004)


def test_a_second_mass_settles_what_one_leaves_open() -> None:
    """A torque constant that is 4 % off in C1: with one mass, the inertia may be off as well."""
    logs = _pair("C1", noise=0.003)
    rig = _rig(logs[0])
    rig["known"] = {**rig["known"], "k_i_Nm_per_A": 0.96 * logs[0].scenario.plant.k_i}
    columns = [log.columns for log in logs]

    alone = eccentric.diagnose(columns[:1], {**rig, "added": {}}).document
    print(alone["verdict"], alone["effects"], alone["tied"])

    both = eccentric.diagnose(columns, rig).document
    print(both["verdict"], both["effects"], both["tied"])
    assert both["verdict"] == "named"
    (effect,) = both["effects"]
    assert effect["family"] == "ki_mismatch"


@pytest.mark.parametrize(
    ("added", "said"),
    [
        ({"table 3": "0.2 kg"}, r"\[added\]: one of table 1, table 2 is required, received 'table 3'"),
        ({"table 2": "0.2 kg", "table*": "0.1 kg"}, r"\[added\]: one mass for a run is required"),
        ({"table 2": "0.2 m"}, r"\[added\] table 2: .*kg"),
        ({"table 2": 0.2}, r"\[added\] table 2: a text with a unit is required"),
        ({"table 2": "0 kg"}, r"\[added\] table 2: a mass above 0 kg is required, received '0 kg'"),
        ({"table 2": "-1 kg"}, r"\[added\] table 2: a value at least 0 kg is required"),
        (["table 2"], r"\[added\]: "),
    ],
)
def test_an_added_mass_that_cannot_be_is_refused_in_one_line(added: object, said: str) -> None:
    """What it names, what is required, and what was received."""
    columns = {"time_s": np.linspace(0.0, 4.0, 1000), "theta_m_rad": np.linspace(0.0, 9.0, 1000)}
    log = {**columns, "current_A": np.ones(1000)}
    known = {"case": "C1", "M": "0.5 kg", "L": "0.2 m", "mu": "1", "k_i": "0.1 N m/A"}
    with pytest.raises(InputError, match=said) as error:
        eccentric.fit([log, dict(log)], {"known": known, "added": added})
    assert "\n" not in str(error.value)


def test_an_added_mass_needs_the_mass_that_is_there(tmp_path: Path) -> None:
    """Where it is not known, the place of the common centre is not known either; nor in a fleet."""
    rig = {"known": {"case": "C1", "L": "0.2 m", "mu": "1", "k_i": "0.1 N m/A"}, "added": {"b": "0.2 kg"}}
    with pytest.raises(InputError, match=r"\[known\] M is required with \[added\], received none"):
        read_rig(rig)
    with pytest.raises(InputError, match=r"'added'"):
        read_rig({"kind": "linear", "known": {"mass": "9 kg"}, "added": {"b": "0.2 kg"}})
    path = tmp_path / "rig.toml"
    path.write_text('[known]\ncase = "C1"\nM = "1 kg"\nL = "1 m"\nmu = "1"\n[added]\nb = "0.2 kg"\n')
    with pytest.raises(InputError, match=re.escape("[added]: a log of one mass is required")):
        eccentric.adapt(str(path), str(path))
