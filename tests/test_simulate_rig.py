"""The controller of a rig in a simulation, parameters refined on simulated motion, and parameter sets."""

from __future__ import annotations

import copy
import dataclasses
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError
from eccentric.model import TURNING
from eccentric.presentation import refined_warnings
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from eccentric.simulation import Refined, Servo, integrate, recording_of, whole_runs
from tests.test_simulate import plant
from tests.test_tutorial import blocks

ROOT = Path(__file__).resolve().parents[1]
LOG, RIG = (ROOT / "examples" / "bench" / name for name in ("bench.csv.gz", "bench.toml"))
SERVO = ROOT / "examples" / "servo" / "servo.py"
MEASURED = ROOT.parent / "shared" / "data" / "measured" / "bam_xl330_pendulum" / "data.csv.gz"
BAM = ROOT / "examples" / "rigs" / "bam_xl330_pendulum.toml"

J, K, D = 0.01, 2.0, 0.08  # inertia, position gain, damping of a servo without friction
CONTENT: dict[str, Any] = {
    "drive": "torque",
    "encoder_counts_per_rev": 1e6,
    "moving_threshold_rad_s": 0.0,
    "columns": {"time": "t", "run": "run", "theta_m": "q", "torque": "tau"},
    "known": {
        "case": "C1",
        "mu": 1,
        "M": "0 kg",
        "M_l": "0 kg",
        "L": "0.1 m",
        "J_m": "0.01 kg m^2",
        "J_l": "0 kg m^2",
    },
    "controller": {
        "set_point": {"column": "goal_deg", "unit": "deg"},
        "position_gain": "P * scale",
        "speed_gain": D,
        "by_run": {"P": {"a": 1.0, "b*": 4.0}},
    },
}


def steps(t: np.ndarray, gain: float) -> np.ndarray:
    """The closed form of J q'' + D q' + gain q = gain from rest."""
    decay = D / (2.0 * J)
    omega = np.sqrt(gain / J - decay**2)
    return 1.0 - np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))


def log() -> dict[str, np.ndarray]:
    """Two runs of a step of one radian at two gains, each by its closed form."""
    t = np.arange(0.0, 3.0, 2e-3)
    q = [steps(t, K), steps(t, 4.0 * K)]
    rows = len(t)
    return {
        "t": np.tile(t, 2),
        "run": np.repeat(["a", "b1"], rows),
        "q": np.concatenate(q),
        "tau": np.concatenate([K * (1.0 - q[0]), 4.0 * K * (1.0 - q[1])]),
        "goal_deg": np.full(2 * rows, np.degrees(1.0)),
        "scale": np.full(2 * rows, K),
    }


def closed(content: dict[str, Any], step: float = 1e-3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, span and simulated angle of both runs, with the controller of a rig, from rest at 0."""
    channels = read_channels([log()], read_rig(content))
    given = recording_of(channels)
    rest = np.zeros(len(given.t))
    given = dataclasses.replace(given, theta_m=rest, omega_m=rest)
    assert channels.rig.controller is not None
    servo = Servo(channels.rig.controller, channels, given.zero)
    model = plant("c1_perpendicular", J_m=J)
    found = integrate(model, given, whole_runs(given), servo, longest_step_s=step)
    return given.t[found.rows], found.span, found.theta_m


def test_a_position_servo_has_its_closed_form() -> None:
    """Without friction a step is a damped oscillation at the frequency of its gain, run by run."""
    t, span, theta = closed(CONTENT)

    for number, gain in enumerate((K, 4.0 * K)):
        own = span == number
        assert np.max(np.abs(theta[own] - steps(t[own], gain))) < 5e-3


def test_arithmetic_on_states_is_the_same_controller() -> None:
    """The same law as feed-forward of the states moves alike; with a limit of no size nothing moves."""
    own = copy.deepcopy(CONTENT)
    own["controller"] = {
        "feed_forward": f"P * scale * (goal_deg / 57.29577951308232 - theta) - {D} * omega",
        "by_run": CONTENT["controller"]["by_run"],
    }
    held = copy.deepcopy(CONTENT)
    held["controller"]["limit"] = ["0 * scale", "0 * scale"]

    assert closed(own)[2] == pytest.approx(closed(CONTENT)[2], abs=1e-9)
    assert np.all(closed(held)[2] == 0.0)


def test_a_gain_of_the_link_acts_at_the_link() -> None:
    """With a gear of 1/5 and the angle of the link mapped, gains act on a fifth of the motor angle."""
    own = copy.deepcopy(CONTENT)
    own["known"] |= {"mu": 0.2}
    own["columns"] = {"time": "t", "run": "run", "theta_l": "q", "torque": "tau"}
    own["controller"]["speed_gain"] = 5.0 * D

    t, span, theta = closed(own)

    first = span == 0
    assert np.max(np.abs(0.2 * theta[first] - steps_of(t[first], 0.2 * K, D))) < 5e-3


def steps_of(t: np.ndarray, gain: float, damping: float) -> np.ndarray:
    """The closed form for another damping."""
    decay = damping / (2.0 * J)
    omega = np.sqrt(gain / J - decay**2)
    return 1.0 - np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"position_gian": 1.0}, "position_gian"),
        ({"position_gain": True}, "position_gain"),
        ({"set_point": {"column": "goal_deg", "unit": "V"}}, "a unit like"),
        ({"position_gain": "P *"}, "position_gain"),
        ({"position_gain": "goal_deg > 1"}, "a number"),
        ({"limit": -1.0}, "above 0"),
        ({"limit": [2.0, 1.0]}, "lower below upper"),
        ({"limit": [1.0]}, "[lower, upper]"),
        ({"set_point": None}, "set_point"),
        ({"by_run": {"P": {"a": 1.0}}}, "'b1'"),
        ({"by_run": {"P": {"*": 1.0, "a": 1.0}}}, "2 of"),
        ({"by_run": {"theta": {"*": 1.0}}}, "theta"),
        ({"by_run": {"P": {"*": "x"}}}, "a number"),
        ({"speed_gain": "no_column"}, "no_column"),
    ],
)
def test_a_controller_that_makes_no_signal_is_refused(change: dict[str, Any], said: str) -> None:
    """Unknown keys, wrong units, missing columns and constants: an InputError names the entry."""
    content = copy.deepcopy(CONTENT)
    content["controller"] |= change
    content["controller"] = {key: x for key, x in content["controller"].items() if x is not None}

    with pytest.raises(InputError) as error:
        closed(content)

    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_no_gain_is_no_controller() -> None:
    """A set point alone is refused."""
    with pytest.raises(InputError, match="position_gain, speed_gain, feed_forward"):
        read_rig({**CONTENT, "controller": {"set_point": "goal_deg"}})


# Parameters refined on the simulated motion.


@pytest.fixture(scope="module")
def diagnosed() -> eccentric.DiagnosisResult:
    """The bundled log with the effect that it has."""
    return eccentric.diagnose(LOG, RIG, only="link_harmonic_friction")


def test_a_refined_fit_moves_closer_and_keeps_its_values(diagnosed: eccentric.DiagnosisResult) -> None:
    """On the bundled log, extended, refining lowers the training error and keeps what the fit has found."""
    plain = eccentric.fit(LOG, RIG, diagnosed.model)

    refined = eccentric.fit(LOG, RIG, diagnosed.model, simulated=True)

    said = refined.document["simulated"]
    assert said["training"]["after"] < said["training"]["before"]
    assert said["horizon_s"] == 0.5
    for name, estimate in plain.estimates.items():
        low, high = estimate.interval
        assert low - (high - low) < refined.estimates[name].value < high + (high - low)


@pytest.mark.parametrize(("after", "worse"), [(0.1959, True), (0.1, False)])
def test_a_refinement_that_helps_the_training_part_alone_is_a_warning(after: float, worse: bool) -> None:
    """The held-out error decides."""
    found = Refined(None, 0.2, 0.1, (0.1546, after), 4, 0.5)  # pyright: ignore[reportArgumentType]
    told = refined_warnings(found, TURNING)
    assert [f"from 0.1546 to {after} rad" in text for text in told] == [True] * worse


def test_without_a_whole_training_run_a_controller_is_not_refined() -> None:
    """Where parts of the only run are held out, there is none to simulate with the controller."""
    rig = read_rig(RIG)
    with_loop = read_rig({"known": {"case": "C2"}, "controller": {"speed_gain": 0.1}}).controller

    with pytest.raises(InputError, match="a whole run to fit on"):
        eccentric.fit(LOG, dataclasses.replace(rig, controller=with_loop), simulated=True)


@pytest.mark.slow
def test_intervals_of_a_refined_fit_contain_the_plant(tmp_path: Path) -> None:
    """A servo simulated by the script of the manual: each planted value lies in its interval."""
    files = dict(blocks("simulate"))
    for name in ("servo_log.py", "servo.toml"):
        (tmp_path / name).write_text(files[name], encoding="utf-8")
    subprocess.run([sys.executable, "servo_log.py"], cwd=tmp_path, check=True)

    found = eccentric.fit(tmp_path / "servo.csv", tmp_path / "servo.toml", str(SERVO), simulated=True)

    ratio = 8.0
    planted = {"K_m": 0.25, "K_m2": 0.3, "K_g": 0.0, "C_m": 0.01, "B_m": 0.003, "J": 0.008}
    values = {f"{name}*R/k_i": value * ratio for name, value in planted.items()} | {
        "R/k_i": ratio,
        "k_e": 0.3,
    }
    for name, value in values.items():
        low, high = found.estimates[name].interval
        assert low <= value <= high, name
    assert found.estimates["K_m*R/k_i"].interval[0] > 1.5
    assert found.fits_the_rig


@pytest.mark.slow
def test_a_hobby_servo_moves_within_33_mrad() -> None:
    """Refined on eight runs with its controller: at most 33 mrad over twelve runs and over those held out."""
    if not MEASURED.exists():
        pytest.skip("the recordings of the servo are not bundled: see examples/rigs/bam_xl330_pendulum.toml")

    found = eccentric.fit(MEASURED, BAM, str(SERVO), simulated=True).document["simulated"]
    linear = eccentric.fit(MEASURED, BAM, simulated=True).document["simulated"]

    held = found["held_out"]["after"]
    assert held <= 0.033
    assert (8 * found["training"]["after"] + 4 * held) / 12 <= 0.033
    assert (8 * linear["training"]["after"] + 4 * linear["held_out"]["after"]) / 12 > 0.045


# Parameter sets.


def test_parameter_sets_have_the_joint_uncertainty(diagnosed: eccentric.DiagnosisResult) -> None:
    """95 % of the draws lie in each interval, correlated as the estimates, and the same for one seed."""
    found = diagnosed
    sets = found.samples(4000, seed=3)

    assert {len(x) for x in sets.values()} == {4000}
    assert set(found.module.Parameters.__dataclass_fields__) == set(sets)
    for name, e in found.estimates.items():
        inside = np.mean((sets[name] >= e.interval[0]) & (sets[name] <= e.interval[1]))
        assert inside == pytest.approx(0.95, abs=0.015)
    drawn = np.corrcoef(sets["C_lN"], sets["C_m"])[0, 1]
    assert drawn == pytest.approx(found.correlation["C_lN", "C_m"], abs=0.05)
    again = found.samples(4000, seed=3)
    assert all(np.array_equal(x, again[name]) for name, x in sets.items())
    assert np.all(sets["M"] == 0.489)


@pytest.fixture(scope="module")
def fitted() -> eccentric.FitResult:
    """The bundled log with the paper's model."""
    return eccentric.fit(LOG, RIG)


def test_parameter_sets_lie_within_bounds(fitted: eccentric.FitResult) -> None:
    """Friction is never negative, though its interval ends at 0; the emitted Parameters take each set."""
    found = fitted
    assert found.estimates["B_m"].interval[0] == 0.0

    sets = found.samples(500)

    assert all(np.all(sets[name] >= 0.0) for name in ("B_lN", "C_lN", "B_m", "C_m"))
    for k in range(0, 500, 100):
        found.module.Parameters(**{name: float(x[k]) for name, x in sets.items()})


@pytest.mark.parametrize("n", [0, -1, 1.5, True, "2"])
def test_a_number_of_sets_is_a_whole_number(n: Any, fitted: eccentric.FitResult) -> None:
    """Anything else is refused."""
    with pytest.raises(InputError, match="a whole number of at least 1"):
        fitted.samples(n)
