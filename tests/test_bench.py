"""Logs of the virtual bench contain what was requested, and its rigs what a user may declare."""

import ast
import json
from collections.abc import Callable
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from eccentric.virtual_bench import EFFECTS, BenchRun, simulate, simulation, write
from tests.virtual import drawn_scenario

ROOT = Path(__file__).resolve().parents[1]


def _mechanics(run: BenchRun) -> np.ndarray:
    """Return k_i i - J dw/dt - G - f from the logged angle and current, f by the sealed coefficients."""
    known, hidden = run.rig["known"], run.truth["hidden_parameters"]
    mu, dt = known["mu"], 1.0 / run.rig["sample_rate_hz"]
    theta = run.columns["theta_m_rad"]
    window = np.hanning(15) / np.hanning(15).sum()
    w = np.gradient(np.convolve(theta, window, "same"), dt)
    alpha = np.gradient(w, dt)
    load, weight = known["M_kg"] * known["L_m"], (known["M_kg"] + known["M_l_kg"]) * known["g_m_s2"]
    pull = load * (mu * w) ** 2
    normal = np.hypot(pull * np.sin(mu * theta), pull * np.cos(mu * theta) + weight)
    viscous = hidden["B_m"] + mu**2 * hidden["B_lN"] * normal
    friction = viscous * w + (hidden["C_m"] + mu * hidden["C_lN"] * normal) * np.sign(w)
    gravity = mu * load * known["g_m_s2"] * np.sin(mu * theta)
    inertia = known["J_m_kgm2"] + mu**2 * known["J_l_kgm2"]
    return known["k_i_Nm_per_A"] * run.columns["current_A"] - inertia * alpha - gravity - friction


def _circuit(run: BenchRun) -> np.ndarray:
    """Return (k_i/R)(u - k_e w) - k_i i from the logged voltage, angle and current."""
    known = run.rig["known"]
    w = np.gradient(run.columns["theta_m_rad"], 1.0 / run.rig["sample_rate_hz"])
    k_i = known["k_i_Nm_per_A"]
    lost = run.columns["voltage_V"] - known["k_e_Vs_per_rad"] * w
    return k_i * lost / known["R_ohm"] - k_i * run.columns["current_A"]


@pytest.mark.parametrize(
    ("effect", "residual"),
    [
        ("link_harmonic_friction[n=2]", _mechanics),
        ("coulomb_asymmetry", _mechanics),
        ("cable_spring", _mechanics),
        ("current_bias", _circuit),
        ("ke_mismatch", _circuit),
        ("resistance_temperature", _circuit),
    ],
)
def test_the_strength_stated_is_found_in_the_log(
    effect: str, residual: Callable[[BenchRun], np.ndarray]
) -> None:
    """A noise-free log's residual in motion has the rms that the truth states; filtering costs up to 3 %."""
    run = simulate(drawn_scenario(effects=[effect], strength=0.2, noise=0.0, seconds=30.0))
    speed = run.columns["omega_m_rad_s"]
    moving = np.abs(speed) > 3.0 * run.rig["moving_threshold_rad_s"]
    steady = np.convolve(moving, np.ones(51), "same") > 50.5
    steady[:125] = steady[-125:] = False

    rms = np.sqrt(np.mean(residual(run)[steady] ** 2))
    assert rms == pytest.approx(0.2 * run.truth["friction_rms_Nm"], rel=0.03)


# Backlash acts reversal by reversal: on a short log its strength comes in steps. It has a test of its own,
# and so has an encoder, whose error is bounded.
@pytest.mark.parametrize(
    "family",
    [
        pytest.param(family, marks=pytest.mark.slow if k % 6 else ())
        for k, family in enumerate(sorted(EFFECTS.keys() - {"backlash", "encoder_eccentricity"}))
    ],
)
def test_every_family_reaches_the_strength_asked_for(family: str) -> None:
    """Each family alone, at 5 % of the friction on a short trajectory, is present as requested."""
    run = simulate(drawn_scenario(effects=[family], strength=0.05, log_type="traj"))

    (effect,) = run.truth["effects"]
    assert effect["family"] == family
    assert effect["rms_fraction_of_friction"] == pytest.approx(0.05, rel=5e-3)
    assert all(np.isfinite(column).all() for column in run.columns.values())


def test_a_bounded_effect_is_as_strong_as_its_bound_allows() -> None:
    """An encoder is not read wrongly by more than 0.02 rad, and the truth says how strong that is."""
    run = simulate(drawn_scenario(effects=["encoder_eccentricity"], strength=0.5, log_type="traj"))

    (effect,) = run.truth["effects"]
    assert effect["amplitude"] == pytest.approx(0.02, rel=1e-9)
    assert 0.0 < effect["rms_fraction_of_friction"] < 0.5


def test_effects_combine() -> None:
    """Two effects in two balances each have their own strength."""
    run = simulate(drawn_scenario(effects=[("stribeck", 0.2), ("current_bias", 0.05)]))

    fractions = [effect["rms_fraction_of_friction"] for effect in run.truth["effects"]]
    assert fractions == pytest.approx([0.2, 0.05], rel=5e-3)
    assert run.truth["kind"] == "double"


def test_the_angle_comes_in_counts_of_the_encoder() -> None:
    """Every logged angle is a whole number of encoder steps, to the digits written."""
    run = simulate(drawn_scenario())
    counts = run.columns["theta_m_rad"] * run.rig["encoder_counts_per_rev"] / (2.0 * pi)

    step = 2.0 * pi / run.rig["encoder_counts_per_rev"]
    assert np.max(np.abs(counts - np.round(counts))) * step <= 0.5e-5 + 1e-12


def test_a_rippling_bus_shows_in_the_current_but_not_in_the_command() -> None:
    """A ripple of 5 % leaves (k_i/R) 0.05 u sin(2 pi f t) in the electrical residual."""
    scenario = drawn_scenario(noise=0.0)
    ripple = simulate(replace(scenario, controller=replace(scenario.controller, ripple=0.05, ripple_hz=30.0)))
    known, time = ripple.rig["known"], ripple.columns["time_s"]
    expected = 0.05 * ripple.columns["voltage_V"] * np.sin(2.0 * pi * 30.0 * time)

    found = -_circuit(ripple) * known["R_ohm"] / known["k_i_Nm_per_A"]
    assert np.sum(found * expected) / np.sum(expected**2) == pytest.approx(1.0, rel=0.02)


def test_a_wandering_bus_shows_in_the_current_but_not_in_the_command() -> None:
    """It leaves (k_i/R) g u in the electrical residual, g with the given RMS and correlation over time."""
    scenario = drawn_scenario(noise=0.0, seconds=120.0)
    wandering = simulate(
        replace(scenario, controller=replace(scenario.controller, wander=0.03, wander_s=0.1))
    )
    known, voltage = wandering.rig["known"], wandering.columns["voltage_V"]
    found = -_circuit(wandering) * known["R_ohm"] / known["k_i_Nm_per_A"]

    gain = found[np.abs(voltage) > 2.0] / voltage[np.abs(voltage) > 2.0]
    assert np.std(gain) == pytest.approx(0.03, rel=0.15)
    later = np.mean(gain[5:] * gain[:-5]) / np.mean(gain**2)
    assert later == pytest.approx(np.exp(-0.02 / 0.1), abs=0.07)


def test_an_ordinary_drive_keeps_plant_and_course() -> None:
    """The same seed has the same rig, course and start on a poorer drive: only the controller differs."""
    fine, ordinary = (drawn_scenario(drive=drive) for drive in ("fine", "ordinary"))

    assert replace(ordinary, controller=fine.controller) == fine
    assert ordinary.controller.wander > 0.0 < fine.controller.kp


def test_noise_is_what_was_asked_for() -> None:
    """Two logs that differ in noise only differ in the current only, by noise times its largest size."""
    quiet, noisy = (simulate(drawn_scenario(noise=noise)) for noise in (0.0, 0.02))
    differing = [name for name in quiet.columns if np.any(quiet.columns[name] != noisy.columns[name])]
    spread = np.std(noisy.columns["current_A"] - quiet.columns["current_A"])

    assert differing == ["current_A"]
    assert spread == pytest.approx(0.02 * np.max(np.abs(quiet.columns["current_A"])), rel=0.05)


@pytest.mark.parametrize(("case", "log_type"), [("C1", "runs"), ("C2", "traj")])
def test_the_rig_says_what_a_user_knows_and_no_more(case: str, log_type: str) -> None:
    """Its keys are those of the format; five disjoint blocks, about a fifth of the log, are held out."""
    scenario = drawn_scenario(case=case, log_type=log_type, seconds=60.0, effects=["current_bias"])
    rig = simulate(scenario).rig

    assert list(rig) == [
        "format", "name", "log_type", "known", "encoder_counts_per_rev", "sample_rate_hz", "columns",
        "moving_threshold_rad_s", "holdout_intervals_s",
    ]  # fmt: skip
    assert "bias" not in json.dumps(rig)
    edges = np.array(rig["holdout_intervals_s"])
    assert edges.shape == (5, 2)
    assert np.all(np.diff(edges.ravel()) >= 0.0)
    assert 0.0 <= edges.min() < edges.max() <= 60.0
    assert round(float(np.sum(edges[:, 1] - edges[:, 0]) / 60.0), 1) == 0.2


def test_runs_go_both_ways() -> None:
    """Speed runs come in both directions, as many forth as back."""
    speeds = np.array(drawn_scenario(seconds=60.0).course.speeds)

    assert abs(int(np.sign(speeds).sum())) <= 1


def test_a_control_has_the_same_rig_and_course_as_its_twin_with_an_effect() -> None:
    """The same seed draws the same plant, controller and course, whatever the effects."""
    control, twin = drawn_scenario(), drawn_scenario(effects=["cogging"])

    assert (control.plant, control.controller, control.course) == (twin.plant, twin.controller, twin.course)


def test_a_temperature_is_logged_where_an_effect_needs_it() -> None:
    """A temperature effect brings its column; a hidden drift warms without one."""
    shown = simulate(drawn_scenario(effects=["coulomb_temperature"]))
    hidden = simulate(drawn_scenario(effects=["hidden_thermal_drift"]))

    assert shown.rig["columns"][-1] == "temperature_C"
    assert "temperature_C" not in hidden.columns
    assert hidden.truth["temperature_range"][1] > hidden.truth["temperature_range"][0]


def test_the_same_seed_writes_the_same_bytes(tmp_path: Path) -> None:
    """Two runs of one seed give the same three files; the archive carries no time and no name."""
    first, second = (
        [
            path.read_bytes()
            for path in write(simulate(drawn_scenario(effects=["backlash"])), tmp_path / place / "a.csv.gz")
        ]
        for place in ("one", "two")
    )

    assert first == second
    assert first[0][3:8] == bytes(5)


def test_the_bench_shares_nothing_with_the_toolkit() -> None:
    """Of eccentric, the bench imports itself, the errors, and how files are written."""
    foreign = set()
    for path in (ROOT / "eccentric" / "virtual_bench").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [str(node.module)] if isinstance(node, ast.ImportFrom) and not node.level else []
            foreign |= {
                name for name in names if name.split(".")[0] in {"eccentric", "derivations", "generated"}
            }

    others = {name for name in foreign if not name.startswith("eccentric.virtual_bench")}

    assert others == {"eccentric.core"}


def test_the_angle_is_that_of_the_nearest_count() -> None:
    """An encoder is off by half a count at most, to either side alike, beside the digits written."""
    scenario = drawn_scenario()
    raw = simulation._run(scenario)
    count = 2.0 * pi / scenario.controller.counts
    off = simulation._log(scenario, raw)["theta_m_rad"] - raw.theta

    assert np.max(np.abs(off)) <= 0.5 * count + 0.5e-5 + 1e-12
    assert 0.0 == pytest.approx(np.mean(off) / count, abs=0.05)
