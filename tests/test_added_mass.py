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
from eccentric.core import InputError
from eccentric.fleet.gathered import Assigned
from eccentric.identification import base_columns, drive_of, fit_data_of, load_torque
from eccentric.identification.fit_data import Residuals
from eccentric.model import vocabulary as v
from eccentric.rigs import arm_rig_complaints, read_arm_rig, read_rig, rig_complaints
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


@pytest.mark.parametrize(
    ("case", "rows"),
    [
        ("C1", {}),
        ("C2", {"average_over": "0.1 s"}),
        pytest.param("C2", {}, marks=pytest.mark.slow),
        pytest.param("C2", {"low_pass_hz": 10.0}, marks=pytest.mark.slow),
    ],
)
def test_the_residual_of_each_run_is_that_of_its_own_link(case: str, rows: dict[str, object]) -> None:
    """Of both logs together, as of each alone with a rig file of its own link."""
    logs = _pair(case)
    model = model_of(read_rig(_rig(logs[0])).model)
    values = {q.name: 0.01 for q in model.friction_parameters}

    def residual(columns: list[dict[str, np.ndarray]], given: dict[str, Any]) -> tuple[np.ndarray, ...]:
        own = read_rig({**given, **rows})
        drive = drive_of(read_channels(columns, own), own, model)
        data = fit_data_of(drive, own, model)
        found = Residuals(model, drive, data.rows, {**drive.known, **values})
        friction = 0.01 * base_columns(model, data.signals).sum(axis=1)
        target = drive.torque() - load_torque(model, data.signals) - friction
        return found.rows("mechanical", {**drive.known, **values}), data.rows.run, target

    both, run, target = residual([log.columns for log in logs], _rig(logs[0]))
    size = len(target) // 2
    for number, log in enumerate(logs):
        alone, _, own = residual([log.columns], _rig(log, added={}))
        assert np.max(np.abs(both[run == number] - alone)) < 1e-9 * np.max(np.abs(alone))
        # What the search sees, away from the ends.
        there = target[number * size : (number + 1) * size]
        assert np.max(np.abs(there - own)) < 1e-9 * np.max(np.abs(own))
    ignored, _, _ = residual([log.columns for log in logs], _rig(logs[0], added={}))
    assert np.sqrt(np.mean((both - ignored)[run == 1] ** 2)) > 0.1 * np.std(both)


def test_a_link_without_a_mass_of_its_own_may_carry_one() -> None:
    """Then all of the moment is the added one, and what is declared has no part in it."""
    logs = _pair("C2")
    known = {**_rig(logs[0])["known"], "M_kg": 0.0}
    rig = read_rig({**_rig(logs[0]), "known": known})
    model = model_of(rig.model)
    signals = fit_data_of(
        drive_of(read_channels([log.columns for log in logs], rig), rig, model), rig, model
    ).signals
    part = np.asarray(signals.part(v.M.symbol))
    size = len(part) // 2
    assert np.all(part[:size] == 1.0)
    assert np.all(part[size:] == 0.0)
    assert np.all(np.isfinite(base_columns(model, signals)))


def test_a_run_with_the_mass_stays_in_training() -> None:
    """Of three logs the third would be held out, and the mass with it."""
    logs = _pair("C1")
    rig = _rig(logs[0], added={"table?3": ADDED})
    rig.pop("holdout_intervals_s")
    third = {name: x.copy() for name, x in logs[0].columns.items()}
    channels = read_channels([logs[0].columns, third, logs[1].columns], read_rig(rig))
    ((carrying, _),) = channels.carried
    for rows in (carrying, ~carrying):
        assert np.any(rows & ~channels.selection.held_out)


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


@pytest.mark.slow
def test_a_second_mass_settles_what_one_leaves_open() -> None:
    """A torque constant that is 4 % off in C1: with one mass, the inertia may be off as well."""
    logs = _pair("C1", noise=0.003)
    rig = _rig(logs[0])
    rig["known"] = {**rig["known"], "k_i_Nm_per_A": 0.96 * logs[0].scenario.plant.k_i}
    columns = [log.columns for log in logs]

    alone = eccentric.diagnose(columns[:1], {**rig, "added": {}}).document
    assert [effect["family"] for effect in alone["effects"]] == ["inertia_mismatch"]

    both = eccentric.diagnose(columns, rig).document
    assert both["verdict"] == "named"
    (effect,) = both["effects"]
    assert effect["family"] == "ki_mismatch"


@pytest.mark.parametrize(
    ("added", "said"),
    [
        ({"table 3": "0.2 kg"}, r"\[added\]: expected one of table 1, table 2, got 'table 3'"),
        ({"table 2": "0.2 kg", "table*": "0.1 kg"}, r"\[added\]: expected one mass for a run"),
        ({"table 2": "0.2 m"}, r"\[added\] table 2: .*kg"),
        ({"table 2": 0.2}, r"\[added\] table 2: expected a text with a unit"),
        ({"table 2": "0 kg"}, r"\[added\] table 2: expected a mass above 0 kg, got '0 kg'"),
        ({"table 2": "-1 kg"}, r"\[added\] table 2: expected a value at least 0 kg"),
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


@pytest.mark.slow
def test_what_is_put_in_from_the_start_is_of_the_rig_as_well() -> None:
    """With the declared inertia 7 % too large, and the correction in the model: nothing is missing."""
    logs = _pair("C2", noise=0.003)
    rig = _rig(logs[0])
    factors = WRONG["inertia_mismatch"][1]
    rig["known"] = {key: x * factors[key] if key in factors else x for key, x in rig["known"].items()}
    found = eccentric.diagnose([log.columns for log in logs], rig, including=["inertia_mismatch"]).document
    assert found["verdict"] == "nothing_missing"


def test_a_rig_with_an_added_mass_is_checked_entry_by_entry() -> None:
    """A good one has no complaints; of a bad one each mass is told, and where M or L is missing."""
    known = {"case": "C1", "M": "0.5 kg", "L": "0.2 m", "mu": "1", "k_i": "0.1 N m/A"}
    assert rig_complaints({"known": known, "added": {"b": "0.2 kg", "M": "0.1 kg"}})[0] == []
    found, rest = rig_complaints({"known": known, "added": {"b": "0.2 kg", "c": "0.2 m", "d": 0.2}})
    assert len(found) == 2
    assert rest["added"] == {"b": "0.2 kg"}
    found, _ = rig_complaints({"known": {"case": "C1", "M": "0.5 kg"}, "added": {"b": "0.2 kg"}})
    assert any("expected [known] L with [added]" in one.text for one in found)


def test_an_added_mass_needs_the_mass_that_is_there(tmp_path: Path) -> None:
    """Where it is not known, the place of the added one is not known either; others take none."""
    rig = {"known": {"case": "C1", "L": "0.2 m", "mu": "1", "k_i": "0.1 N m/A"}, "added": {"b": "0.2 kg"}}
    with pytest.raises(InputError, match=r"expected \[known\] M with \[added\], got none"):
        read_rig(rig)
    with pytest.raises(InputError, match=r"'added'"):
        read_rig({"kind": "linear", "known": {"mass": "9 kg"}, "added": {"b": "0.2 kg"}})
    path = tmp_path / "rig.toml"
    path.write_text('[known]\ncase = "C1"\nM = "1 kg"\nL = "1 m"\nmu = "1"\n[added]\nb = "0.2 kg"\n')
    with pytest.raises(InputError, match=re.escape("[added]: expected a log of one mass")):
        eccentric.adapt(str(path), str(path))
    with pytest.raises(InputError, match=re.escape("[added]: expected logs of one mass in a fleet")):
        Assigned(str(path))
    arm = {"arm": "arm.toml", "added": {"b": "0.2 kg"}}
    with pytest.raises(InputError, match=r"\[?added"):
        read_arm_rig(arm)
    assert any(("added",) == error.keys for error in arm_rig_complaints(arm)[0])
