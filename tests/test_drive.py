"""Voltage, current or torque identify what the rig leaves open; free swings separate k_e from friction."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from eccentric.identification import Drive, Refit, drive_of, fit_data_of, loaded_model, refit
from eccentric.model import load_model
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from tests.identified import FILTERED, inertia, is_found
from tests.swing import HELD_OUT, VOLTAGE, Run, Swing, log_of, write_rig, write_runs

BENCH = Path(__file__).parents[1] / "examples" / "bench"
ONE_RUN = 'holdout_runs = ["driven_2"]\n'


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
    return refit(model, (), fit_data_of(drive, rig, model))


def test_voltage_alone_tells_scale_inertia_friction_and_by_free_swings_the_back_emf(tmp_path: Path) -> None:
    """R/k_i, k_e, J, Coulomb and viscous friction come back; what is logged while off does not count."""
    rig = Swing()
    fitted = refitted(tmp_path, log_of(rig), VOLTAGE, rig.known, HELD_OUT)
    assert is_found(fitted, "R/k_i", rig.R / rig.k_i, 1e-3)
    assert is_found(fitted, "k_e", rig.k_e, 1e-3)
    assert is_found(fitted, "B_m", rig.B, 1e-2)
    assert inertia(fitted, rig.mu) == pytest.approx(rig.J, rel=FILTERED)
    assert fitted.data.drive.unit == "N m"
    # Without unbalanced friction planted, that of the paper is none or takes its share from the motor's.
    low, high = fitted.estimates["C_m"].interval
    assert low <= rig.C <= high + 1e-3


def test_without_free_swings_back_emf_and_viscous_friction_are_one(tmp_path: Path) -> None:
    """All rows driven: k_e is not identifiable, and B_m is the sum that a voltage shows."""
    rig = Swing()
    fitted = refitted(tmp_path, log_of(rig, swings=False), VOLTAGE, rig.known, ONE_RUN)
    assert "k_e" not in fitted.estimates
    assert is_found(fitted, "B_m", rig.B + rig.k_e * rig.k_i / rig.R, 2e-3)
    assert is_found(fitted, "R/k_i", rig.R / rig.k_i, 1e-3)


def test_the_linear_model_of_an_asymmetric_one_is_that_of_the_symmetric_one(tmp_path: Path) -> None:
    """One coefficient for both directions, however many iterations a wrong scale takes."""
    rig = Swing()
    log = write_runs(tmp_path / "log.csv", log_of(rig, swings=False), VOLTAGE)
    channels = read_channels([log], read_rig(write_rig(tmp_path / "rig.toml", rig.known, ONE_RUN)))
    drive = drive_of(channels, channels.rig, load_model("c2_parallel"))
    assert drive.scale is not None
    assert drive.opens("gravity")
    drive = dataclasses.replace(drive, scale=1.1 * drive.scale)
    symmetric, asymmetric = (
        refit(model, (), fit_data_of(drive, channels.rig, model), linear=True)
        for model in (load_model("c2_parallel"), load_model("c2_asymmetric"))
    )
    assert asymmetric.values["C_m_neg"] == asymmetric.values["C_m_pos"]
    assert asymmetric.values["C_m_pos"] == pytest.approx(symmetric.values["C_m"], rel=1e-9)
    assert asymmetric.scale == pytest.approx(symmetric.scale, rel=1e-9)


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
    fitted = refitted(tmp_path, runs, VOLTAGE, rig.known, HELD_OUT + 'voltage_offset_V = "estimate"\n')
    assert is_found(fitted, "voltage_offset_V", 0.3)
    assert is_found(fitted, "R/k_i", rig.R / rig.k_i, 1e-3)


def test_current_with_k_i_known_by_a_range_gives_newton_metres_by_gravity(tmp_path: Path) -> None:
    """Only a range of k_i is known: gravity identifies 1/k_i, with it inertia and friction."""
    rig = Swing()
    known = rig.known + '[unknown]\nk_i = ["0.05 Nm/A", "1 Nm/A"]\n'
    names = ("time_s", "theta_m_rad", "current_A", "motor_off")
    fitted = refitted(tmp_path, log_of(rig), names, known, HELD_OUT)
    assert is_found(fitted, "1/k_i", 1.0 / rig.k_i, 1e-3)
    assert is_found(fitted, "B_m", rig.B, 1e-2)
    assert inertia(fitted, rig.mu) == pytest.approx(rig.J, rel=FILTERED)
    assert fitted.values["k_i"] == pytest.approx(rig.k_i, rel=2e-3)
    assert {"R", "k_e"} == fitted.data.drive.placeholders


def test_torque_with_an_arm_known_by_a_range_and_no_inertia(tmp_path: Path) -> None:
    """A torque signal identifies the gravity arm within its range and the inertia."""
    rig = Swing()
    known = rig.known.replace(f"L_m = {rig.L}\n", "") + '[unknown]\nL = ["5 cm", "30 cm"]\n'
    names = ("time_s", "theta_m_rad", "torque_Nm", "motor_off")
    fitted = refitted(tmp_path, log_of(rig), names, known, HELD_OUT)
    assert is_found(fitted, "L", rig.L, 1e-3)
    assert is_found(fitted, "B_m", rig.B, 1e-2)
    assert inertia(fitted, rig.mu) == pytest.approx(rig.J, rel=FILTERED)
    assert fitted.scale is None


def test_rig_that_is_known_leaves_nothing_open(tmp_path: Path) -> None:
    """With k_i, J_m and J_l known, the drive torque is k_i i and no column is free."""
    rig = Swing()
    known = rig.known + f"k_i_Nm_per_A = {rig.k_i}\nJ_m_kgm2 = {rig.J}\nJ_l_kgm2 = 0.0\n"
    names = ("time_s", "theta_m_rad", "current_A", "motor_off")
    runs = log_of(rig, noise_Nm=0.0)
    fitted = refitted(tmp_path, runs, names, known, HELD_OUT)
    drive: Drive = fitted.data.drive
    assert (drive.open, drive.scale, drive.unit) == ((), None, "N m")
    driven_rows = np.concatenate([run.columns["motor_off"] for run in runs.values()]) == 0.0
    torque = np.concatenate([run.columns["torque_Nm"] for run in runs.values()])
    np.testing.assert_allclose(drive.torque()[driven_rows], torque[driven_rows], atol=1e-8)
    np.testing.assert_array_equal(drive.torque()[~driven_rows], 0.0)


@pytest.mark.parametrize(("declared", "expected"), [(False, False), (True, True)])
def test_a_voltage_gives_amperes_where_k_i_is_declared(
    tmp_path: Path, declared: bool, expected: bool
) -> None:
    """Gravity gives R/k_i: without k_i no current can be told, and with it one can."""
    rig = Swing()
    known = rig.known + (f"k_i_Nm_per_A = {rig.k_i}\n" if declared else "")
    log = write_runs(tmp_path / "log.csv", log_of(rig), VOLTAGE)
    channels = read_channels([log], read_rig(write_rig(tmp_path / "rig.toml", known, HELD_OUT)))
    drive = drive_of(channels, channels.rig, load_model("c2_parallel"))

    assert (True, expected) == (drive.by_voltage, drive.current_known)


@pytest.mark.parametrize(
    "declared", [{}, {"R": 3.0}, {"R": 3.0, "k_e": 0.02}], ids=["nothing", "R", "R and k_e"]
)
def test_a_current_alone_shows_neither_resistance_nor_back_emf(declared: dict[str, float]) -> None:
    """Its scale gives k_i; what the rig does not declare is one ohm and no back-EMF."""
    channels = read_channels([BENCH / "bench.csv.gz"], read_rig(BENCH / "bench.json"))
    model = load_model("c2_parallel")
    drive = drive_of(channels, channels.rig, model)
    known = {name: x for name, x in drive.known.items() if name not in {"R", "k_e"}} | declared
    found = fit_data_of(dataclasses.replace(drive, known=known, scale=8.0), channels.rig, model)

    shown = {name: found.signals.known[name] for name in ("k_i", "R", "k_e")}
    assert {"k_i": 1.0 / 8.0, "R": 1.0, "k_e": 0.0} | declared == shown
