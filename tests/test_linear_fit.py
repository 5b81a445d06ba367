"""A fit of a simulated carriage: in metres, newtons and kilograms, and the truth is in the intervals."""

import gzip
from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric.api import FitResult
from eccentric.identification import in_drive_unit
from tests.carriage import RIG, SLIDE, TRUTH, Carriage, logged

SEEDS = 20
MOST_OUT = 9
"""Of 80 intervals of 95 %, 10 or more exclude the truth in less than one of a hundred such tests."""
UNITS = {"mass": "kg", "B": "N s/m", "C": "N", "F_load": "N"}


def outside(found: FitResult) -> list[str]:
    """The names of the estimates whose interval does not contain the truth."""
    ends = {name: found.estimates[name].interval for name in TRUTH}
    return [name for name, (low, high) in ends.items() if not low <= TRUTH[name] <= high]


@pytest.fixture(scope="module")
def found() -> FitResult:
    """One log of 24 s twice, fitted."""
    return eccentric.fit(logged(0), RIG)


def test_mass_friction_and_load_are_found(found: FitResult) -> None:
    """Each is within four standard errors of the truth, known to 1 %, and in its own unit."""
    errors = {name: abs(found.estimates[name].value - TRUTH[name]) for name in TRUTH}

    assert {name: e.unit for name, e in found.estimates.items()} == UNITS
    assert all(error < 4.0 * found.estimates[name].std_error for name, error in errors.items()), errors
    assert all(found.estimates[name].std_error < 0.01 * abs(TRUTH[name]) for name in TRUTH)
    assert found.warnings == ()


def test_the_residual_is_the_noise_and_the_steps(found: FitResult) -> None:
    """What is left is the white noise of the logged voltage, times the gain, and little beside."""
    noise = Carriage().gain * Carriage().noise_V

    assert (found.unit, found.rmse["mechanical"]["paper"]) == ("N", found.rmse["mechanical"]["linear"])
    assert noise < found.rmse["mechanical"]["paper"] < 2.0 * noise


@pytest.mark.slow
def test_the_truth_is_in_the_intervals_as_often_as_they_say() -> None:
    """Over 20 logs, the 95 % intervals of mass, friction and load contain the truth about that often."""
    missed = [(seed, name) for seed in range(SEEDS) for name in outside(eccentric.fit(logged(seed), RIG))]

    assert len(missed) <= MOST_OUT, missed


def test_a_wrong_gain_is_a_wrong_mass() -> None:
    """Twice the gain is twice the mass and twice the friction: a force scales them all."""
    log = logged(3, seconds=8.0, runs=1)
    columns = RIG["columns"] | {"force": {"column": "u_V", "gain": "70 N/V"}}
    one, two = eccentric.fit(log, RIG), eccentric.fit(log, RIG | {"columns": columns})

    for name in TRUTH:
        assert two.estimates[name].value == pytest.approx(2.0 * one.estimates[name].value, rel=1e-6)


def test_a_voltage_without_a_scale_is_the_force_over_its_gain() -> None:
    """Neither mass nor force constant known: all is times R/k_f in volts, for a fit and for an effect."""
    log = logged(3, Carriage(stribeck=12.0), seconds=12.0, runs=1)
    columns = {name: column for name, column in RIG["columns"].items() if name != "force"}
    unscaled = RIG | {"columns": {**columns, "voltage": "u_V"}}
    force, volts = eccentric.fit(log, RIG), eccentric.fit(log, unscaled)
    pairs = zip(
        (volts.estimates[name] for name in ("mass*R/k_f", "B*R/k_f + k_e", "C*R/k_f", "R*F_load/k_f")),
        (force.estimates[name] for name in ("mass", "B", "C", "F_load")),
        strict=True,
    )
    found, scaled = (eccentric.diagnose(log, rig, only="stribeck").document for rig in (unscaled, RIG))
    (effect,), (same,) = found["effects"], scaled["effects"]

    assert [e.unit for e in volts.estimates.values()] == ["V s/m", "V", "V s^2/m", "V"]
    assert all(Carriage().gain * one.value == pytest.approx(two.value, rel=1e-6) for one, two in pairs)
    assert {name: p["unit"] for name, p in effect["parameters"].items()} == {
        "stribeck_A": "V",
        "stribeck_v": "m/s",
    }
    for name, gain in (("stribeck_A", Carriage().gain), ("stribeck_v", 1.0)):
        one, two = effect["parameters"][name]["value"], same["parameters"][name]["value"]
        assert gain * one == pytest.approx(two, rel=1e-3)


@pytest.mark.parametrize(
    ("unit", "volts"),
    [
        ("N m", "V"),
        ("N m s^3/rad^3", "V s^3/rad^3"),
        ("N m/K", "V/K"),
        ("m s/rad", "V s/(N rad)"),
        ("kg m^2", "V s^2/rad"),
        ("1/(N m)", "1/V"),
        ("rad/s", "rad/s"),
        ("1/K", "1/K"),
    ],
)
def test_a_torque_in_volts_changes_the_units_with_a_torque(unit: str, volts: str) -> None:
    """By the dimension: each torque of a newton metre is a volt."""
    assert (unit, volts) == (in_drive_unit(unit, "N m"), in_drive_unit(unit, "V"))


def test_units_of_a_log_do_not_matter() -> None:
    """Millimetres, kilonewtons and milliseconds give what metres, newtons and seconds give."""
    log = logged(4, seconds=8.0, runs=1)
    plain = {"time_s": log["t_s"], "position_m": log["q_m"], "force_N": 35.0 * log["u_V"]}
    other = {"t": 1e3 * log["t_s"], "q": 1e3 * log["q_m"], "F": 0.035 * log["u_V"]}
    load = {"unknown": {"F_load": ["-0.05 kN", "50 N"]}}
    columns = {
        "time": {"column": "t", "unit": "ms"},
        "position": {"column": "q", "unit": "mm"},
        "force": {"column": "F", "unit": "kN"},
    }
    first = eccentric.fit(plain, {"kind": "linear", **load})
    second = eccentric.fit(other, {"kind": "linear", **load, "columns": columns})

    for name in TRUTH:
        assert second.estimates[name].value == pytest.approx(first.estimates[name].value, rel=1e-6)


def test_a_current_needs_the_force_constant_in_newtons_per_ampere() -> None:
    """A current of F/k_f with k_f known gives the fit of the force itself."""
    log = logged(5, seconds=8.0, runs=1)
    force = 35.0 * log["u_V"]
    common = {"time_s": log["t_s"], "position_m": log["q_m"]}
    rig = {"kind": "linear", "unknown": {"F_load_N": [-50, 50]}}
    by_force = eccentric.fit({**common, "force_N": force}, rig)
    by_current = eccentric.fit(
        {**common, "current_A": force / 80.0}, rig | {"known": {"k_f": "0.08 kN/A"}, "drive": "current"}
    )

    for name in TRUTH:
        assert by_current.estimates[name].value == pytest.approx(by_force.estimates[name].value, rel=1e-6)


def test_a_vertical_axis_carries_its_weight() -> None:
    """The load of a hanging mass is its weight, m g, upwards being positive."""
    weight = 95.0 * 9.81
    log = logged(6, Carriage(F_load=weight, gain=200.0), seconds=10.0, runs=1)
    columns = RIG["columns"] | {"force": {"column": "u_V", "gain": "200 N/V"}}
    found = eccentric.fit(log, RIG | {"columns": columns, "unknown": {"F_load_N": [0, 2000]}})

    assert found.estimates["F_load"].value == pytest.approx(weight, rel=1e-3)
    assert found.estimates["mass"].value == pytest.approx(95.0, rel=0.01)


def test_the_log_of_the_example_can_be_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """examples/slide/make_log.py writes the log that is there, beside itself from wherever it is run."""
    import runpy

    script, elsewhere = tmp_path / "slide" / "make_log.py", tmp_path / "elsewhere"
    for folder in (script.parent, elsewhere):
        folder.mkdir()
    script.write_bytes((SLIDE / "make_log.py").read_bytes())
    monkeypatch.chdir(elsewhere)
    runpy.run_path(str(script), run_name="__main__")
    again, there = (path / "slide.csv.gz" for path in (script.parent, SLIDE))

    assert gzip.decompress(there.read_bytes()) == gzip.decompress(again.read_bytes())
    assert list(elsewhere.iterdir()) == []


def test_parameters_follow_the_names_of_the_axis(found: FitResult) -> None:
    """The fitted model has the values under the names of a carriage; of a motor nothing is known."""
    parameters = found.parameters

    assert set(parameters) == {"mass", "B", "C", "F_load"}
    assert set(found.document["placeholders"]) == {"R", "k_f", "k_e"}
    assert all(np.isfinite(list(parameters.values())))
