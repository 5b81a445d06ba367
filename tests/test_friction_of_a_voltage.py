"""What is emitted from a voltage alone: the friction that contains the back-EMF is not called mechanical."""

from __future__ import annotations

import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cffi
import numpy as np
import pytest

import eccentric
from eccentric.virtual_bench import simulate
from tests import paper
from tests.compiled import FLAGS
from tests.planted import (
    FRICTION,
    INERTIA,
    K_E,
    K_I,
    KNOWN,
    M_L,
    MASS,
    MOTOR,
    MU,
    NUMPY,
    L,
    M,
    R,
    motion,
    torque,
    voltage,
    written,
)
from tests.swing import VOLTAGE, Swing, log_of, write_rig, write_runs
from tests.virtual import drawn_scenario

# `make test` has a voltage alone in test_voltage_alone.
pytestmark = pytest.mark.slow

BY_CURRENT = f"k_i_Nm_per_A = {K_I}\nJ_m_kgm2 = {INERTIA}\nJ_l_kgm2 = 0.0\n"
OF_CURRENT = {"current", "mechanical_residual", "electrical_residual"}
OF_VOLTAGE = {"voltage", "electrical_residual"}
WITHOUT_BACK_EMF = {"mechanical_friction_torque", *OF_CURRENT}
PLANTED = SimpleNamespace(M=M, M_l=M_L, L=L, mu=MU, g=9.81, R=R, k_i=K_I, k_e=K_E, **FRICTION)
SAMPLES = motion()[0][::997], motion()[1][::997]


def fitted_to(folder: Path, known: str) -> eccentric.FitResult:
    """The fit of case C2 to the voltage that the planted rig requires."""
    written(folder, f'case = "C2"\n{KNOWN}{known}', {"voltage_V": voltage("C2")})
    return eccentric.fit(folder / "log.csv", folder / "rig.toml")


def resultant() -> np.ndarray:
    """The paper's F with the back-EMF, eq (18), on the samples [N m]."""
    return paper.friction_torque_c2(*SAMPLES, PLANTED, NUMPY)


def test_without_k_e_only_the_resultant_friction_is_emitted(tmp_path: Path) -> None:
    """F is that of the paper; what needs the friction alone is in neither the module nor the C."""
    found = fitted_to(tmp_path, "")
    found.emit(tmp_path / "arm", "arm")

    assert found.module.friction_torque(*SAMPLES) == pytest.approx(resultant(), rel=1e-2)
    assert set() == WITHOUT_BACK_EMF & set(dir(found.module))
    header = (tmp_path / "arm" / "arm.h").read_text(encoding="utf-8")
    assert [] == [name for name in WITHOUT_BACK_EMF if name in header]
    assert "Start with arm_friction_torque, which contains the back-EMF" in header
    assert "regressor times friction_coefficients is friction_torque" in header
    at = [float(x[0]) for x in SAMPLES]
    assert in_c(tmp_path / "arm", *at) == pytest.approx(float(resultant()[0]), rel=1e-2)


def in_c(folder: Path, theta: float, omega: float) -> float:
    """F by the emitted C."""
    subprocess.run(
        ["gcc", *FLAGS, "-shared", "-fPIC", "arm.c", "-o", "arm.so", "-lm"], check=True, cwd=folder
    )
    ffi = cffi.FFI()
    ffi.cdef(
        "double arm_friction_torque_double(double, double, const void *); extern char arm_default_double;"
    )
    arm: Any = ffi.dlopen(str(folder / "arm.so"))
    return arm.arm_friction_torque_double(theta, omega, ffi.addressof(arm, "arm_default_double"))


def test_with_k_e_the_friction_alone_is_emitted(tmp_path: Path) -> None:
    """A rig that gives k_e separates the two: f is F without k_i k_e/R omega."""
    found = fitted_to(tmp_path, MOTOR)
    expected = resultant() - K_I * K_E / R * SAMPLES[1]

    assert found.module.mechanical_friction_torque(*SAMPLES) == pytest.approx(expected, rel=1e-2)
    assert set(dir(found.module)) >= WITHOUT_BACK_EMF


def test_a_fit_with_a_current_starts_anew_from_such_a_model(tmp_path: Path) -> None:
    """As the base of a further fit it has all functions; with the current its friction is mechanical."""
    before = fitted_to(tmp_path, "").model
    signal = {"current_A": torque("C2", FRICTION) / K_I}
    written(tmp_path, f'case = "C2"\n{KNOWN}{BY_CURRENT}', signal)
    module = eccentric.fit(tmp_path / "log.csv", tmp_path / "rig.toml", before).module
    expected = resultant() - K_I * K_E / R * SAMPLES[1]

    assert module.mechanical_friction_torque(*SAMPLES) == pytest.approx(expected, rel=1e-2)


@pytest.mark.parametrize(
    ("declared", "expected"),
    [
        ("", set()),
        (f"R_ohm = {R}\n", set()),
        (f"k_e_Vs_per_rad = {K_E}\n", set()),
        (f"R_ohm = {R}\nk_e_Vs_per_rad = {K_E}\n", OF_VOLTAGE),
    ],
    ids=["neither", "R", "k_e", "both"],
)
def test_a_current_gives_a_voltage_only_with_the_armature(
    tmp_path: Path, declared: str, expected: set[str]
) -> None:
    """Without R and k_e there is none, and no electrical residual; all else stays."""
    signal = {"current_A": torque("C2", FRICTION) / K_I}
    written(tmp_path, f'case = "C2"\n{KNOWN}{BY_CURRENT}{declared}', signal)
    found = eccentric.fit(tmp_path / "log.csv", tmp_path / "rig.toml")
    found.emit(tmp_path / "arm", "arm")

    given = set(dir(found.module))
    emf = found.module.friction_torque(*SAMPLES) - found.module.mechanical_friction_torque(*SAMPLES)
    known = K_I * K_E / R * SAMPLES[1] if expected else np.zeros(len(SAMPLES[1]))
    assert emf == pytest.approx(known, rel=1e-6, abs=1e-12)
    assert given >= {"mechanical_friction_torque", "friction_torque", "current", "mechanical_residual"}
    assert expected == given & OF_VOLTAGE
    header = (tmp_path / "arm" / "arm.h").read_text(encoding="utf-8")
    assert (header.count("arm_voltage(") > 0) == bool(expected)


@pytest.mark.parametrize(("declared", "expected"), [("", set()), (f"k_i_Nm_per_A = {K_I}\n", OF_VOLTAGE)])
def test_a_torque_gives_a_voltage_only_with_the_torque_constant_too(
    tmp_path: Path, declared: str, expected: set[str]
) -> None:
    """The current in R i is the torque over k_i."""
    armature = f"R_ohm = {R}\nk_e_Vs_per_rad = {K_E}\nJ_m_kgm2 = {INERTIA}\nJ_l_kgm2 = 0.0\n"
    written(tmp_path, f'case = "C2"\n{KNOWN}{armature}{declared}', {"torque_Nm": torque("C2", FRICTION)})
    module = eccentric.fit(tmp_path / "log.csv", tmp_path / "rig.toml").module

    assert expected == set(dir(module)) & OF_VOLTAGE


def test_the_model_of_a_diagnosis_has_no_voltage_either(tmp_path: Path) -> None:
    """Of a current without R and k_e: neither what is emitted nor the derivation that is written."""
    noise = 0.02 * np.random.default_rng(3).standard_normal(len(motion()[0]))
    written(
        tmp_path, f'case = "C2"\n{KNOWN}{BY_CURRENT}', {"current_A": torque("C2", FRICTION) / K_I + noise}
    )
    found = eccentric.diagnose(tmp_path / "log.csv", tmp_path / "rig.toml")
    found.write(tmp_path / "found")
    again = eccentric.load_model(tmp_path / "found" / "model.py")

    assert set() == set(dir(found.module)) & OF_VOLTAGE
    assert (False, False) == (found.model.voltage_known, again.voltage_known)


def test_a_diagnosis_keeps_the_declared_motor(tmp_path: Path) -> None:
    """R and k_i are those of the rig, as the report says; the emitted current is torque over k_i [A]."""
    noise = 0.02 * np.random.default_rng(3).standard_normal(len(motion()[0]))
    written(tmp_path, f'case = "C2"\n{KNOWN}{MOTOR}{MASS}', {"voltage_V": voltage("C2") + noise})
    found = eccentric.diagnose(tmp_path / "log.csv", tmp_path / "rig.toml")
    motor = {q.name: q for q in found.model.parameters if q.name in {"R", "k_i"}}
    origins = {row[0]: row[-1] for row in found.table().rows}
    expected = torque("C2", FRICTION)[::997] / K_I

    assert {"R": R, "k_i": K_I} == pytest.approx({n: float(q.default or 0) for n, q in motor.items()})
    assert not any("identified" in q.meaning for q in motor.values())
    assert ("rig", "rig") == (origins["R"], origins["k_i"])
    at = [x[::997] for x in motion()]
    assert found.module.current(*at) == pytest.approx(expected, rel=1e-2, abs=1e-2)


@pytest.mark.parametrize(
    ("known", "missing"),
    [
        (f"k_e_Vs_per_rad = {K_E}\n", OF_CURRENT),
        (f"k_e_Vs_per_rad = {K_E}\nk_i_Nm_per_A = {K_I}\n", set()),
        (f"k_e_Vs_per_rad = {K_E}\nR_ohm = {R}\n", set()),
    ],
    ids=["ratio alone", "k_i", "R"],
)
def test_a_current_needs_more_than_the_ratio(tmp_path: Path, known: str, missing: set[str]) -> None:
    """With R/k_i from gravity, a declared R or k_i gives the current in amperes; without, none is emitted."""
    module = fitted_to(tmp_path, known).module
    emitted = set(dir(module))

    assert missing == WITHOUT_BACK_EMF - emitted
    if not missing:
        at = [x[::997] for x in motion()]
        expected = torque("C2", FRICTION)[::997] / K_I
        assert module.current(*at) == pytest.approx(expected, rel=1e-2, abs=1e-2)


def called(result: eccentric.DiagnosisResult) -> str:
    """The name of the function that the summary calls, without its prefix."""
    line = next(line for line in result.lines if "to call" in line)
    return line.split(f"{result.model.name}_", 1)[1].split("(")[0]


@pytest.mark.parametrize(
    ("swings", "expected"),
    [(False, "friction_torque"), pytest.param(True, "mechanical_friction_torque", marks=pytest.mark.slow)],
)
def test_the_summary_calls_the_friction_that_was_found(tmp_path: Path, swings: bool, expected: str) -> None:
    """Free swings separate the back-EMF from friction, driven runs alone do not; the script says which."""
    rig = Swing()
    log = write_runs(tmp_path / "log.csv", log_of(rig, swings=swings), VOLTAGE)
    found = eccentric.diagnose(
        log, write_rig(tmp_path / "rig.toml", rig.known, 'holdout_runs = ["driven_2"]\n')
    )
    omega = 5.0
    damping = rig.B + (0.0 if swings else rig.k_i * rig.k_e / rig.R)

    assert expected == called(found)
    assert getattr(found.module, expected)(0.0, omega) == pytest.approx(rig.C + damping * omega, rel=1e-2)
    found.write(tmp_path / "out")
    loaded = eccentric.load_model(str(tmp_path / "out" / "model.py"))
    assert swings is not loaded.back_emf_in_friction


def test_without_a_scale_the_summary_calls_the_voltage(tmp_path: Path) -> None:
    """Case C1 by voltage alone has no torque: the emitted voltage is that of the rig, in volts."""
    noise = 0.02 * np.random.default_rng(3).standard_normal(len(motion()[0]))
    written(tmp_path, f'case = "C1"\n{KNOWN}', {"voltage_V": voltage("C1") + noise})
    found = eccentric.diagnose(tmp_path / "log.csv", tmp_path / "rig.toml")
    omega, alpha = motion()[1][::997], motion()[2][::997]

    assert "voltage" == called(found)
    found.write(tmp_path / "out")
    header = (tmp_path / "out" / f"{found.model.name}.h").read_text(encoding="utf-8")
    assert f"Start with {found.model.name}_voltage" in header
    assert "voltage" == eccentric.load_model(str(tmp_path / "out" / "model.py")).first_function
    expected = voltage("C1")[::997]
    assert found.module.voltage(omega, alpha) == pytest.approx(expected, rel=1e-2, abs=1e-2)
    assert set() == WITHOUT_BACK_EMF & set(dir(found.module))


@pytest.mark.parametrize(
    ("drive", "column", "signal"),
    [("voltage", "voltage_V", voltage("C1")), ("current", "current_A", torque("C1", FRICTION) / K_I)],
)
def test_a_fit_without_a_scale_begins_with_the_drive(
    tmp_path: Path, drive: str, column: str, signal: np.ndarray
) -> None:
    """Case C1 without a scale: the header begins with the one function in its unit, right in that unit."""
    opened = "[unknown]\nk_i_Nm_per_A = [0.01, 0.2]\n" if drive == "current" else ""
    written(tmp_path, f'case = "C1"\n{KNOWN}{opened}', {column: signal})
    found = eccentric.fit(tmp_path / "log.csv", tmp_path / "rig.toml")
    found.emit(tmp_path / "arm", "arm")
    omega, alpha = motion()[1][::997], motion()[2][::997]

    assert f"Start with arm_{drive}," in (tmp_path / "arm" / "arm.h").read_text(encoding="utf-8")
    assert getattr(found.module, drive)(omega, alpha) == pytest.approx(signal[::997], rel=1e-2, abs=1e-2)


def test_without_a_scale_the_rotor_stands_for_all_of_the_inertia() -> None:
    """In volts there is J R/k_i; nothing in kg m^2, such as M L^2 of the link, is subtracted from it."""
    run = simulate(drawn_scenario(3, case="C1", log_type="traj", noise=0.004, seconds=60.0))
    plant = run.scenario.plant
    known = {"case": "C1", "mu": plant.mu, "M_kg": plant.M, "M_l_kg": plant.M_l, "L_m": plant.L}
    rig = {"known": known, "encoder_counts_per_rev": run.rig["encoder_counts_per_rev"]}
    log = {name: run.columns[name] for name in ("time_s", "theta_m_rad", "voltage_V")}
    found = eccentric.diagnose(log, rig, only="stribeck").document["rig_identified"]

    assert list(found) == ["J_m"]
    assert found["J_m"]["unit"] == "V s^2/rad"
    assert found["J_m"]["value"] == pytest.approx(plant.inertia * plant.R / plant.k_i, rel=0.002)
    assert found["J_m"]["value"] == pytest.approx(
        eccentric.fit(log, rig).estimates["J*R/k_i"].value, rel=1e-6
    )
