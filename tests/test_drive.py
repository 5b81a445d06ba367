"""What the rig leaves open, voltage, current or torque tells; free swings tell k_e from friction."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eccentric.identify.balances import bench_of
from eccentric.identify.channels import read_channels
from eccentric.identify.diagnose import Diagnosis, diagnose
from eccentric.identify.diagnosis import document
from eccentric.identify.drive import Drive, drive_of, loaded_model
from eccentric.identify.refit import Refit, refit
from eccentric.identify.report.gather import report_data
from eccentric.identify.rig import read_rig
from eccentric.model import load_model
from tests.swing import Array, Friction, Run, Swing, driven, free, write_rig, write_runs

VOLTAGE = ("time_s", "theta_m_rad", "voltage_V", "motor_off")
DIFFERENCES = 4e-3
"""Relative: what 25 Hz and central differences at 125 Hz take from an acceleration of 2 Hz and less."""
RUNS = 'holdout_runs = ["driven_2", "free_1"]\n'
ONE_RUN = 'holdout_runs = ["driven_2"]\n'


def log_of(rig: Swing, noise_V: float = 0.05, noise_Nm: float = 0.003, swings: bool = True) -> dict[str, Run]:
    """Six driven runs, two of them slow, and three free ones."""
    rng = np.random.default_rng(5)
    paces = (1.0, 0.2, 1.0, 1.0, 0.2, 1.0)
    runs = {f"driven_{k}": driven(rig, rng, noise_V, noise_Nm, p) for k, p in enumerate(paces)}
    return runs | ({f"free_{k}": free(rig, a) for k, a in enumerate((4.5, 5.5, 3.5))} if swings else {})


def refitted(
    tmp_path: Path, runs: dict[str, Run], names: tuple[str, ...], known: str, above: str = ""
) -> Refit:
    """The paper's model, fitted within its bounds as `diagnose` does."""
    log = write_runs(tmp_path / "log.csv", runs, names)
    channels = read_channels([log], read_rig(write_rig(tmp_path / "rig.toml", known, above)))
    rig = channels.rig
    base = load_model(rig.model)
    drive = drive_of(channels, rig, base)
    model = loaded_model(base, rig)
    return refit(model, (), bench_of(drive, rig, model))


def is_found(fitted: Refit, name: str, truth: float, bias: float = 0.0) -> bool:
    """Whether an estimate lies within three standard errors of the truth, and the errors of differences."""
    estimate = fitted.estimates[name]
    return abs(estimate.value - truth) <= 3.0 * estimate.std_error + bias * abs(truth)


def inertia(fitted: Refit, mu: float) -> float:
    """J_m + mu^2 J_l of the fit."""
    return fitted.values["J_m"] + mu**2 * fitted.values["J_l"]


def test_voltage_alone_tells_scale_inertia_friction_and_by_free_swings_the_back_emf(tmp_path: Path) -> None:
    """R/k_i, k_e, J, Coulomb and viscous friction come back; what is logged while off does not count."""
    rig = Swing()
    fitted = refitted(tmp_path, log_of(rig), VOLTAGE, rig.known, RUNS)
    assert is_found(fitted, "R/k_i", rig.R / rig.k_i, 1e-3)
    assert is_found(fitted, "k_e", rig.k_e, 1e-3)
    assert is_found(fitted, "B_m", rig.B, 1e-2)
    assert inertia(fitted, rig.mu) == pytest.approx(rig.J, rel=DIFFERENCES)
    assert fitted.bench.drive.unit == "N m"
    # Without unbalanced friction planted, that of the paper is none or takes its share from the motor's.
    low, high = fitted.estimates["C_m"].interval
    assert low <= rig.C <= high + 1e-3


def test_without_free_swings_back_emf_and_viscous_friction_are_one(tmp_path: Path) -> None:
    """All rows driven: no k_e is told, and B_m is the sum that a voltage shows."""
    rig = Swing()
    fitted = refitted(
        tmp_path, log_of(rig, swings=False), VOLTAGE, rig.known, 'holdout_runs = ["driven_2"]\n'
    )
    assert "k_e" not in fitted.estimates
    assert is_found(fitted, "B_m", rig.B + rig.k_e * rig.k_i / rig.R, 2e-3)
    assert is_found(fitted, "R/k_i", rig.R / rig.k_i, 1e-3)


def test_known_back_emf_is_not_asked_of_the_log(tmp_path: Path) -> None:
    """With k_e in the rig, the viscous friction comes out of driven rows alone."""
    rig = Swing()
    known = rig.known + f"k_e_Vs_per_rad = {rig.k_e}\n"
    fitted = refitted(tmp_path, log_of(rig, swings=False), VOLTAGE, known, ONE_RUN)
    assert is_found(fitted, "B_m", rig.B, 1e-2)
    assert fitted.values["k_e"] == rig.k_e


def test_offset_of_the_voltage_is_found(tmp_path: Path) -> None:
    """An offset that the rig leaves to the log comes back, and does not disturb the scale."""
    rig = Swing()
    runs = {
        name: Run({**run.columns, "voltage_V": run.columns["voltage_V"] + 0.3})
        for name, run in log_of(rig).items()
    }
    fitted = refitted(tmp_path, runs, VOLTAGE, rig.known, RUNS + 'voltage_offset_V = "estimate"\n')
    assert is_found(fitted, "voltage_offset_V", 0.3)
    assert is_found(fitted, "R/k_i", rig.R / rig.k_i, 1e-3)


def test_current_with_k_i_known_by_a_range_gives_newton_metres_by_gravity(tmp_path: Path) -> None:
    """Of k_i only a range is known: gravity tells 1/k_i, with it inertia and friction."""
    rig = Swing()
    known = rig.known + '[unknown]\nk_i = ["0.05 Nm/A", "1 Nm/A"]\n'
    names = ("time_s", "theta_m_rad", "current_A", "motor_off")
    fitted = refitted(tmp_path, log_of(rig), names, known, RUNS)
    assert is_found(fitted, "1/k_i", 1.0 / rig.k_i, 1e-3)
    assert is_found(fitted, "B_m", rig.B, 1e-2)
    assert inertia(fitted, rig.mu) == pytest.approx(rig.J, rel=DIFFERENCES)
    assert fitted.values["k_i"] == pytest.approx(rig.k_i, rel=2e-3)


def test_torque_with_an_arm_known_by_a_range_and_no_inertia(tmp_path: Path) -> None:
    """A torque signal tells the gravity arm within its range and the inertia."""
    rig = Swing()
    known = rig.known.replace(f"L_m = {rig.L}\n", "") + '[unknown]\nL = ["5 cm", "30 cm"]\n'
    names = ("time_s", "theta_m_rad", "torque_Nm", "motor_off")
    fitted = refitted(tmp_path, log_of(rig), names, known, RUNS)
    assert is_found(fitted, "L", rig.L, 1e-3)
    assert is_found(fitted, "B_m", rig.B, 1e-2)
    assert inertia(fitted, rig.mu) == pytest.approx(rig.J, rel=DIFFERENCES)
    assert fitted.scale is None


def test_rig_that_is_known_leaves_nothing_open(tmp_path: Path) -> None:
    """With k_i, J_m and J_l known, the drive torque is k_i i and no column is free."""
    rig = Swing()
    known = rig.known + f"k_i_Nm_per_A = {rig.k_i}\nJ_m_kgm2 = {rig.J}\nJ_l_kgm2 = 0.0\n"
    names = ("time_s", "theta_m_rad", "current_A", "motor_off")
    runs = log_of(rig, noise_Nm=0.0)
    fitted = refitted(tmp_path, runs, names, known, RUNS)
    drive: Drive = fitted.bench.drive
    assert (drive.open, drive.scale, drive.unit) == ((), None, "N m")
    driven_rows = np.concatenate([run.columns["motor_off"] for run in runs.values()]) == 0.0
    torque = np.concatenate([run.columns["torque_Nm"] for run in runs.values()])
    np.testing.assert_allclose(drive.torque()[driven_rows], torque[driven_rows], atol=1e-8)
    np.testing.assert_array_equal(drive.torque()[~driven_rows], 0.0)


DRAG = 2e-4


def drag(_: Array, omega: Array) -> Array:
    """Drag of the air, by the square of the speed [N m s^2/rad^2]."""
    return DRAG * omega * np.abs(omega)


def by_load(theta: Array, omega: Array) -> Array:
    """Friction of 15 % of the gravity that the gear carries."""
    return 0.15 * np.abs(0.5 * 0.5 * 9.81 * 0.1 * np.sin(0.5 * theta)) * np.sign(omega)


def diagnosed(folder: Path, more: Friction | None = None) -> Diagnosis:
    """The diagnosis of a voltage-only rig with this further friction."""
    rig = Swing() if more is None else Swing(more=more)
    log = write_runs(folder / "log.csv", log_of(rig), VOLTAGE)
    return diagnose([log], write_rig(folder / "rig.toml", rig.known, RUNS))


@pytest.fixture(scope="module")
def with_drag(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    """A voltage-only rig with drag."""
    return diagnosed(tmp_path_factory.mktemp("drag"), drag)


@pytest.fixture(scope="module")
def with_load(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    """A voltage-only rig with load-dependent friction."""
    return diagnosed(tmp_path_factory.mktemp("load"), by_load)


@pytest.fixture(scope="module")
def control(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    """A voltage-only rig that the paper's model describes."""
    return diagnosed(tmp_path_factory.mktemp("control"))


def test_drag_is_named_from_the_voltage_alone(with_drag: Diagnosis) -> None:
    """The effect is named alone, its coefficient within three standard errors."""
    assert "named" == with_drag.attribution.verdict
    assert ["quadratic_drag"] == [effect.family for effect, _ in with_drag.effects]
    (coefficient,) = with_drag.effects[0][0].coefficients
    assert is_found(with_drag.extended, coefficient.name, DRAG)


def test_load_dependent_friction_is_named_from_the_voltage_alone(with_load: Diagnosis) -> None:
    """The family is named alone, its coefficient within three standard errors."""
    assert "named" == with_load.attribution.verdict
    assert ["load_dependent"] == [effect.family for effect, _ in with_load.effects]
    assert is_found(with_load.extended, "load_eta", 0.15)


def stribeck(_: Array, omega: Array) -> Array:
    """Dry friction that is 0.02 N m higher at rest and falls with 2 rad/s."""
    return 0.02 * np.exp(-((omega / 2.0) ** 2)) * np.sign(omega)


def test_stribeck_friction_is_not_named_presliding(tmp_path: Path) -> None:
    """Dry friction that falls with speed and has no memory is not named as one that has."""
    found = diagnosed(tmp_path, stribeck)
    assert "presliding" not in {effect.family for effect, _ in found.effects}


def test_a_fit_that_is_stopped_too_early_says_so(
    with_load: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One turn takes back what the scale was too large by, and is not the last: result and page tell it."""
    bench = with_load.bench
    assert bench.drive.scale is not None
    wrong = replace(bench, drive=replace(bench.drive, scale=1.05 * bench.drive.scale))
    monkeypatch.setattr("eccentric.identify.turns._TURNS", 1)
    early = refit(with_load.base, (), wrong, bounds=False)
    found = replace(with_load, paper=early)

    assert early.change == pytest.approx(1.0 - 1.0 / 1.05, rel=1e-2)
    assert (True, False) == (with_load.paper.settled, early.settled)
    assert (True, False) == (document(with_load)["settled"], document(found)["settled"])
    for said in (document(found)["warnings"], report_data(found).warnings, found.warnings):
        assert any("fit of the model paper has not settled" in warning for warning in said)
    assert not any("settled" in warning for warning in with_load.warnings)


@pytest.mark.parametrize("name", ["with_drag", "with_load", "control"])
def test_rig_is_identified_beside_the_effect(name: str, request: pytest.FixtureRequest) -> None:
    """Scale, back-EMF and inertia of the extended model are those of the rig, effect or not."""
    found: Diagnosis = request.getfixturevalue(name)
    rig = Swing()
    fitted = found.shipped
    assert is_found(fitted, "R/k_i", rig.R / rig.k_i, 1e-3)
    assert is_found(fitted, "k_e", rig.k_e, 1e-3)
    assert inertia(fitted, rig.mu) == pytest.approx(rig.J, rel=DIFFERENCES)
    said = document(found)["rig_identified"]
    assert {"R/k_i", "k_e", "J_m"} <= set(said)
    assert said["R/k_i"]["unit"] == "V/(N m)"


def test_errors_in_volts_are_those_in_newton_metres_by_the_scale(with_drag: Diagnosis) -> None:
    """Both are told, and differ by R/k_i; the error after is that of the voltage's noise."""
    said = document(with_drag)
    volts, torques = said["rmse_holdout_V"]["mechanical"], said["rmse_holdout_Nm"]["mechanical"]
    scale = said["rig_identified"]["R/k_i"]["value"]
    for name in ("linear", "paper", "extended"):
        assert volts[name] == pytest.approx(scale * torques[name], rel=1e-9)
    # Driven rows have 0.05 V of noise, free ones none of it.
    assert volts["extended"] < 1.05 * 0.05 < volts["paper"]


@pytest.mark.parametrize("name", ["with_drag", "with_load"])
def test_free_swings_are_predicted_by_the_same_friction(name: str, request: pytest.FixtureRequest) -> None:
    """With the motor off the extended friction is all there is: the error falls to that of the encoder."""
    found: Diagnosis = request.getfixturevalue(name)
    free_error = found.score.free
    assert 3.0 * free_error["extended"] < min(free_error["paper"], free_error["linear"])
    # Rounding to an encoder step is noise of a twelfth of its square, of which differences see up to 25 Hz.
    step = 2.0 * np.pi / 65536 / np.sqrt(12.0)
    assert free_error["extended"] < Swing().J * step * (2.0 * np.pi * 25.0) ** 2


def test_each_run_is_predicted_better_from_the_others(with_drag: Diagnosis) -> None:
    """Left out as a whole, most runs gain by the planted effect, clearly over all of them."""
    over = with_drag.score.over_runs
    assert over is not None
    percent, (low, high), better = over.gains["extended"]
    assert over.runs == 9
    assert better > over.runs / 2
    assert 0.0 < low < percent < high


def test_control_by_voltage_alone_lacks_nothing(control: Diagnosis) -> None:
    """No effect explains the drive by itself: on a log of the paper's model none is adopted."""
    over = control.score.over_runs
    assert over is not None
    assert ("nothing_missing", ()) == (control.attribution.verdict, control.effects)
    assert control.extended is control.paper
    assert set(over.gains) == {"paper"}
    low, high = over.gains["paper"][1]
    assert low <= 0.0 <= high
