"""Each way in which a log can be bad is named; the same log undamaged has no such finding."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from eccentric.api import fit
from eccentric.core import InputError
from eccentric.model import TURNING
from eccentric.rigs import read_rig
from eccentric.signals import Finding, read_channels
from eccentric.signals.quality.causes import Logged, single_cause
from eccentric.signals.quality.findings import Record, _steady
from eccentric.signals.quality.limits import FROZEN_ROWS
from eccentric.signals.quality.ratios import Ratio
from eccentric.virtual_bench import BenchRun, random_scenario, simulate

ROOT = Path(__file__).resolve().parents[1]
SHARED = ROOT / ".." / "shared" / "data"
needs_shared = pytest.mark.skipif(not SHARED.exists(), reason="the shared logs are not beside this clone")

Columns = dict[str, NDArray[np.float64]]


@functools.cache
def bench(case: str, log_type: str) -> BenchRun:
    """A simulated log of 25 s without effects, and its rig."""
    rng = np.random.default_rng(3)
    return simulate(random_scenario(rng, case=case, mu=0.2, log_type=log_type, seconds=25.0))


def written(folder: Path, columns: Columns, rig: dict[str, Any]) -> tuple[Path, Path]:
    """Write a log and its rig; return both paths."""
    log, sidecar = folder / "log.csv", folder / "rig.json"
    rows = np.column_stack(list(columns.values()))
    np.savetxt(log, rows, "%.9g", ",", header=",".join(columns), comments="")
    sidecar.write_text(json.dumps({**rig, "columns": list(columns)}), encoding="utf-8")
    return log, sidecar


def findings(log: Path, sidecar: Path) -> tuple[Finding, ...]:
    """What is said of a log under a rig."""
    found = read_channels([log], read_rig(sidecar)).intake.findings
    assert all("\n" not in finding.text for finding in found)
    return found


def scaled(name: str, factor: float) -> Callable[[Columns], Columns]:
    """A column times a factor."""
    return lambda columns: columns | {name: factor * columns[name]}


def held(name: str, first: float, last: float) -> Callable[[Columns], Columns]:
    """A column that keeps its value over a part of the log."""

    def change(columns: Columns) -> Columns:
        x = columns[name].copy()
        a, b = (int(part * len(x)) for part in (first, last))
        x[a:b] = x[a]
        return columns | {name: x}

    return change


def clipped(name: str) -> Callable[[Columns], Columns]:
    """A column that goes no further than nine tenths of its rows."""

    def change(columns: Columns) -> Columns:
        limit = np.quantile(np.abs(columns[name]), 0.9)
        return columns | {name: np.clip(columns[name], -limit, limit)}

    return change


def without(*names: str) -> Callable[[Columns], Columns]:
    """A log without some columns."""
    return lambda columns: {name: x for name, x in columns.items() if name not in names}


def rows(keep: Callable[[int], NDArray[Any]]) -> Callable[[Columns], Columns]:
    """A log with the rows that are kept."""
    return lambda columns: {name: x[keep(len(x))] for name, x in columns.items()}


def missing(columns: Columns) -> Columns:
    """A log with a blank current in each fiftieth row."""
    return columns | {
        "current_A": np.where(np.arange(len(columns["current_A"])) % 50 == 7, np.nan, columns["current_A"])
    }


def same(columns: Columns) -> Columns:
    """The log as it is."""
    return columns


def both(*changes: Callable[[Columns], Columns]) -> Callable[[Columns], Columns]:
    """One change after the other."""
    return lambda columns: functools.reduce(lambda found, change: change(found), changes, columns)


THETA, OMEGA, VOLTAGE, CURRENT = "theta_m_rad", "omega_m_rad_s", "voltage_V", "current_A"
DEG = math.degrees(1.0)
RPM = 60.0 / math.tau
GAPS = rows(lambda n: np.r_[0 : n // 3, n // 3 + 200 : n // 2, n // 2 + 30 : n])
C1, C2, RUNS = ("C1", "traj"), ("C2", "traj"), ("C2", "runs")
NO_SPEED = without(OMEGA)
# name: (log, what happens to it, what becomes of the rig, kind and channel of the finding, words of it)
Damage = tuple[tuple[str, str], Callable[[Columns], Columns], dict[str, float | str], str, str, str]
DAMAGE: dict[str, Damage] = {
    "gaps": (C2, GAPS, {}, "gap", "time", "2 gaps in time, 0.037 of the log, the longest 0.804 s"),
    "missing": (C2, missing, {}, "missing", "current", "no number in 125 of 6250 rows"),
    "clipped current": (C2, clipped(CURRENT), {}, "saturated", "current", "stays at its largest value, "),
    "clipped voltage": (C1, clipped(VOLTAGE), {}, "saturated", "voltage", "stays at its smallest value, -"),
    "clipped speed": (RUNS, clipped(OMEGA), {}, "saturated", "omega_m", "clipped"),
    "frozen current": (C2, held(CURRENT, 0.4, 0.45), {}, "frozen", "current", "once, 1.24 s at "),
    "frozen twice": (
        C1,
        both(held(CURRENT, 0.4, 0.45), held(CURRENT, 0.7, 0.73)),
        *({}, "frozen", "current", "2 times, the longest 1.24 s"),
    ),
    "frozen speed": (C2, held(OMEGA, 0.4, 0.45), {}, "frozen", "omega_m", "once, 1.24 s"),
    "frozen angle": (C2, held(THETA, 0.4, 0.43), {}, "frozen", "theta_m", "once, 0.744 s"),
    "frozen angle alone": (RUNS, both(NO_SPEED, held(THETA, 0.4, 0.43)), {}, "frozen", "theta_m", "jumps"),
    "dead current": (C2, held(CURRENT, 0.0, 1.0), {}, "frozen", "current", "in all moving rows"),
    "speed in rpm": (C2, scaled(OMEGA, RPM), {}, "wrong_unit", "omega_m", "the speed is in rpm"),
    "speed reversed": (C2, scaled(OMEGA, -1.0), {}, "wrong_sign", "omega_m", "their signs differ"),
    "angle in deg": (C2, scaled(THETA, DEG), {}, "wrong_unit", "omega_m", "the angle is in deg"),
    "angle in deg, no speed": (
        C2,
        both(NO_SPEED, scaled(THETA, DEG)),
        *({}, "wrong_unit", "theta_m", "follows gravity if the angle is in deg"),
    ),
    "angle in deg, no gravity": (
        C1,
        both(NO_SPEED, scaled(THETA, DEG)),
        *(
            {},
            "wrong_unit",
            "theta_m",
            "the angle is in deg: k_e is 0.0011 V s/rad in the log and 0.063 in the rig file",
        ),
    ),
    "speed in rpm, no angle": (
        C1,
        both(without(THETA), scaled(OMEGA, RPM)),
        *({}, "wrong_unit", "omega_m", "the speed is in rpm"),
    ),
    "angle reversed": (
        C2,
        both(NO_SPEED, scaled(THETA, -1.0)),
        {},
        "wrong_sign",
        "theta_m",
        "opposite in sign to",
    ),
    "current reversed": (C2, scaled(CURRENT, -1.0), {}, "wrong_sign", "current", "put a minus before"),
    "voltage reversed": (C1, scaled(VOLTAGE, -1.0), {}, "wrong_sign", "voltage", "put a minus before"),
    "only a voltage, reversed": (
        C2,
        both(without(CURRENT), scaled(VOLTAGE, -1.0)),
        *({}, "wrong_sign", "voltage", "put a minus before"),
    ),
    "current and voltage swapped": (
        C2,
        lambda columns: columns | {CURRENT: columns[VOLTAGE], VOLTAGE: columns[CURRENT]},
        *({}, "contradiction", "k_e", "which is impossible: look for a wrong sign or swapped columns"),
    ),
    "current in mA": (C2, scaled(CURRENT, 1e3), {}, "wrong_unit", "current", "the current is in mA"),
    "voltage in mV": (C1, scaled(VOLTAGE, 1e3), {}, "wrong_unit", "voltage", "the voltage is in mV"),
    "k_e per turn": (
        C1,
        same,
        {"k_e_Vs_per_rad": 0.063 * math.tau},
        "contradiction",
        "k_e",
        "(in V s/rev?)",
    ),
    "k_e per rpm": (
        RUNS,
        same,
        {"k_e_Vs_per_rad": 0.063 / RPM},
        "contradiction",
        "k_e",
        "(in V/rpm?)",
    ),
    "R of two phases": (
        C2,
        same,
        {"R_ohm": 1.6},
        "contradiction",
        "R",
        "(two phases, and one in the log?)",
    ),
    "k_i": (C2, same, {"k_i_Nm_per_A": 0.19}, "contradiction", "k_i", "off by a factor of 3.0"),
    "J_l in kg cm^2": (C2, same, {"J_l_kgm2": 430.0}, "contradiction", "J", "(in kg cm^2?)"),
    "J_l": (C1, same, {"J_l_kgm2": 0.13}, "contradiction", "J", "or give the load's J_l in [unknown]"),
    "mass": (C2, same, {"M_kg": 1.9}, "contradiction", "M g L", "mu M g L is 0."),
    "mass in g": (
        C2,
        same,
        {"M_kg": 4.63e-4},
        "contradiction",
        "M g L",
        "(kg entered as g, or m as mm?)",
    ),
    "another rig": (
        C2,
        same,
        {"M_kg": 2.0, "J_l_kgm2": 0.4, "J_m_kgm2": 9e-4},
        *("another_rig", "current", "which may be from another rig"),
    ),
    "no gravity in the log": (C1, same, {"case": "C2"}, "contradiction", "M g L", "horizontal, case C1?"),
    "no gravity in the rig": (C2, same, {"case": "C1"}, "contradiction", "case", "vertical, case C2"),
    "angle upside down": (
        C2,
        lambda columns: columns | {THETA: columns[THETA] + math.pi / 0.2},
        *({}, "zero_angle", "theta_m", "set theta_zero_rad = "),
    ),
}


def test_gravity_alone_says_by_which_factor_k_i_may_be_off() -> None:
    """With a current the same factor is in k_i, unless the inertia of the rig is right."""
    gravity = Ratio.of("M g L", 1340.0, 1.0, 0.268, TURNING)
    inertia = Ratio.of("J", 0.0018, 1e-5, 0.0018, TURNING)
    logged = Logged("current", 0.2, angle=True)

    assert single_cause(gravity, logged, [gravity]) == (" (or is k_i off by a factor of 5000?)", None)
    assert single_cause(gravity, logged, [gravity, inertia]) == ("", None)


@pytest.mark.parametrize("name", DAMAGE)
def test_each_damage_is_named(name: str, tmp_path: Path) -> None:
    """A log or rig that is bad in one way has the finding of that way."""
    log, change, known, kind, channel, words = DAMAGE[name]
    run = bench(*log)
    rig = run.rig | {"known": run.rig["known"] | known}
    found = findings(*written(tmp_path, change(run.columns), rig))
    assert any((f.kind, f.channel) == (kind, channel) and words in f.text and f.rows for f in found), found


@pytest.mark.parametrize("wrong", ["mu", "angle", "nothing"])
def test_an_inverted_gear_is_not_taken_for_a_unit_of_the_angle(wrong: str, tmp_path: Path) -> None:
    """At 8:1 the inverse turns the link 64 times as far, an angle in deg 57.3 times: gravity knows which.

    With k_i left open no torque of the rig contradicts the log, only the angle does.
    """
    scenario = random_scenario(np.random.default_rng(4), case="C2", mu=1 / 8, log_type="traj", seconds=25.0)
    run = simulate(scenario)
    known = {
        k: x for k, x in run.rig["known"].items() if k not in {"k_i_Nm_per_A", "R_ohm", "k_e_Vs_per_rad"}
    }
    rig = {
        **run.rig,
        "known": {**known, "mu": 8.0 if wrong == "mu" else 1 / 8},
        "unknown": {"k_i_Nm_per_A": [1e-3, 20.0]},
    }
    columns = without(OMEGA)(without(VOLTAGE)(run.columns))
    columns = scaled(THETA, 360.0 / math.tau if wrong == "angle" else 1.0)(columns)
    found = findings(*written(tmp_path, columns, rig))

    expected = {"mu": [("contradiction", "mu", "mu = 0.125")], "angle": [("wrong_unit", "theta_m", "")]}
    assert expected.get(wrong, []) == [(f.kind, f.channel, f.mend) for f in found]


@pytest.mark.parametrize("left_out", ["nothing", OMEGA, VOLTAGE, CURRENT, THETA])
@pytest.mark.parametrize("log", [C1, C2, RUNS, ("C1", "runs")], ids=" ".join)
def test_an_undamaged_log_has_no_finding(log: tuple[str, str], left_out: str, tmp_path: Path) -> None:
    """Whatever of the channels is logged, nothing is odd about a good log of a rig that is its own."""
    run = bench(*log)
    assert findings(*written(tmp_path, without(left_out)(run.columns), run.rig)) == ()


@needs_shared
@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_the_shared_examples_have_no_finding(number: int) -> None:
    """Effects that the rig does not declare are no faults of the data."""
    folder = SHARED / "examples"
    assert findings(folder / f"example{number}.csv.gz", folder / f"example{number}.json") == ()


def test_what_cannot_be_fitted_says_what_contradicts_the_rig() -> None:
    """An angle in rad that is read in deg leaves hardly any speeds; the logged speed shows why."""
    run = bench("C2", "traj")
    columns = {
        "theta_m": {"column": "theta_m_rad", "unit": "deg"},
        "omega_m": "omega_m_rad_s",
        "time": "time_s",
        "current": "current_A",
    }
    rig = {**run.rig, "columns": columns, "moving_threshold_rad_s": 0.001}
    with pytest.raises(InputError, match=r"57\.\d+ times the slope of the angle.* or the angle is in rad"):
        fit(run.columns, rig)


def test_one_speed_is_told(tmp_path: Path) -> None:
    """A log at one speed cannot separate Coulomb from viscous friction; with a second speed it can."""
    t = np.arange(0.0, 40.0, 0.004)
    noise = 0.01 * np.random.default_rng(1).standard_normal(len(t))
    rig = {"known": {"case": "C1", "mu": 0.2, "k_i_Nm_per_A": 0.05}}
    for second, expected in ((20.0, ["one_speed"]), (40.0, [])):
        speed = np.where(t % 8.0 < 4.0, 20.0, second)
        theta = np.cumsum(speed) * 0.004
        columns = {"time_s": t, THETA: theta, CURRENT: 1.0 + 0.01 * speed + noise}
        assert [f.kind for f in findings(*written(tmp_path, columns, rig))] == expected


def test_a_row_that_repeats_is_dropped_and_counted(tmp_path: Path) -> None:
    """A row that was written twice is dropped and counted; the rest is as without it."""
    run = bench(*C2)
    log, sidecar = written(tmp_path, rows(lambda n: np.r_[0:8, 7:n, n - 1])(run.columns), run.rig)
    (found,) = findings(log, sidecar)
    assert ("repeated", "time", 2, "note") == (found.kind, found.channel, found.rows, found.severity)
    assert "2 of 6252 rows repeat the one before (first: line 10)" in found.text
    channels = read_channels([log], read_rig(sidecar))
    np.testing.assert_array_equal(channels.time.t, run.columns["time_s"])
    assert channels.intake.findings == (found,)
    assert found.text in channels.intake.warnings


def test_time_in_ms_is_refused_or_told(tmp_path: Path) -> None:
    """By held-out intervals in s; without them all rows move, and k_e and J give the unit of time away."""
    run = bench(*C2)
    log, sidecar = written(tmp_path, scaled("time_s", 1e3)(run.columns), run.rig)
    with pytest.raises(
        InputError, match=r"goes from 0 to 24996 s, got .*: is time in s, and the log complete\?$"
    ):
        findings(log, sidecar)

    rig = {k: v for k, v in run.rig.items() if k not in ("holdout_intervals_s", "sample_rate_hz")}
    columns = scaled("time_s", 1e3)(NO_SPEED(run.columns))
    found = findings(*written(tmp_path, columns, rig | {"moving_threshold_rad_s": 0.0}))
    assert ("wrong_unit", "time") in {(f.kind, f.channel) for f in found}


@pytest.mark.parametrize(("change", "steady"), [(0.005, True), (0.015, False)])
def test_a_speed_is_steady_within_a_hundredth_of_the_top_one(change: float, steady: bool) -> None:
    """A ramp that rises by less over a frozen stretch is, one that rises by more is not."""
    n = 10 * FROZEN_ROWS
    # The ramp, then as many rows at the top speed of 10 rad/s.
    speed = np.append(5.0 + 10.0 * change * np.arange(n) / FROZEN_ROWS, np.full(n, 10.0))
    none = np.zeros(2 * n, dtype=np.int64)
    record = Record(0.01 * np.arange(2.0 * n), none, none, none == 0, speed, 0.01 * np.cumsum(speed), None)

    assert steady == np.all(_steady(record)[: n - FROZEN_ROWS])
    assert steady == np.any(_steady(record)[: n - FROZEN_ROWS])
