"""Whether a log is from its rig at all is one question with one answer, in `fit` and in `diagnose`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError
from eccentric.diagnosis import SearchRequest, diagnose
from eccentric.identification import fit
from eccentric.logs import read_log
from eccentric.model import load_model
from eccentric.presentation import diagnosis_document, diagnosis_lines, fit_sentence
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from eccentric.virtual_bench import simulate
from tests.planted import FRICTION, INERTIA, K_I, KNOWN, MASS, TORQUE, T, motion, torque, written
from tests.virtual import drawn_scenario

ROTOR = 1e-4
"""An inertia whose torque is small beside friction [kg m^2]."""


def test_friction_that_drives_does_not_fit_the_rig(tmp_path: Path) -> None:
    """With a current of the wrong sign friction would drive: negative coefficients would explain all of it.

    Within their bounds they are zero. The model is then J alpha, the drive -(J alpha + f), and what remains
    2 J alpha + f: the R^2 of both commands.
    """
    alpha = motion()[2]
    drive = torque("C1", FRICTION) + (ROTOR - INERTIA) * alpha
    noise = np.random.default_rng(5).normal(0.0, 1e-3, len(T))
    known = 'case = "C1"\n' + KNOWN + TORQUE + f"J_m_kgm2 = {ROTOR}\nJ_l_kgm2 = 0.0\n"
    written(tmp_path, known, {"current_A": (noise - drive) / K_I})
    log, rig = tmp_path / "log.csv", read_rig(tmp_path / "rig.toml")
    found = diagnose([log], rig)
    fitted = fit(read_channels([log], rig), rig, load_model(rig.model))
    rows = found.rows
    left, whole = (rows.mean(x)[rows.score] for x in (drive + ROTOR * alpha, drive))
    expected = 1.0 - np.sum(left**2) / np.sum(whole**2)
    assert expected < 0.0
    assert (expected, expected) == pytest.approx(
        (fitted.r_squared["paper"], found.models.r_squared), abs=2e-2
    )
    sentence = fit_sentence(fitted)
    assert "does not fit the rig" in sentence
    assert "zero angle" not in sentence, "which does not matter in a level plane"
    assert "does not fit the rig" in diagnosis_document(found)["sentence"]
    assert () == found.effects


def test_a_torque_constant_outside_its_range_does_not_fit_the_rig(tmp_path: Path) -> None:
    """A current in mA read as A: the k_i that gravity asks for is a thousandth of what the rig allows.

    Held at the end of its range, both commands leave the same part of the torque.
    """
    noise = np.random.default_rng(6).normal(0.0, 1e-3, len(T))
    little = {name: 0.1 * value for name, value in FRICTION.items()}
    current = 1e3 * (torque("C2", little) + noise) / K_I
    known = 'case = "C2"\n' + KNOWN + MASS + '[unknown]\nk_i = ["0.001 N m/A", "20 N m/A"]\n'
    channels, rig = written(tmp_path, known, {"current_A": current})
    found = diagnose([tmp_path / "log.csv"], rig, request=SearchRequest(only=("stribeck",)))
    fitted = fit(channels, rig, load_model(rig.model))

    assert (False, False) == (fitted.fits_the_rig, found.models.fits_the_rig)
    assert fitted.r_squared["paper"] == pytest.approx(found.models.r_squared, abs=2e-2)
    scale = found.models.paper.estimates["1/k_i"]
    assert (1e3, "upper") == (scale.value, scale.bound_active)
    assert () == found.effects


def test_a_voltage_in_millivolts_is_no_resistance() -> None:
    """Read as volts, it is a thousand times what R i + k_e w says: no effect is named for it.

    Ten times could be a k_e in V/rpm.
    """
    run = simulate(drawn_scenario(3, case="C2", mu=0.2, seconds=20.0))
    log, tenfold = (read_log({**run.columns, "voltage_V": x * run.columns["voltage_V"]}) for x in (1e3, 10.0))
    rig = read_rig(run.rig)
    found = diagnose([log], rig)

    assert not found.models.fits_the_rig
    assert () == found.effects
    assert not any("to call" in line for line in diagnosis_lines(found))
    assert "the voltage is" in diagnosis_document(found)["sentence"]
    assert fit(read_channels([tenfold], rig), rig, load_model(rig.model)).fits_the_rig


def test_no_code_is_emitted_of_a_log_that_does_not_fit_the_rig(tmp_path: Path) -> None:
    """Neither beside the report nor from its model.py, unless the misfit is accepted."""
    known = 'case = "C1"\n' + KNOWN + TORQUE + f"J_m_kgm2 = {ROTOR}\nJ_l_kgm2 = 0.0\n"
    drive = torque("C1", FRICTION) + (ROTOR - INERTIA) * motion()[2]
    written(tmp_path, known, {"current_A": -drive / K_I})
    found = eccentric.diagnose(tmp_path / "log.csv", tmp_path / "rig.toml")
    assert found.lines[0].endswith("verdict: log does not fit the rig")
    assert {"report.html", "diagnosis.json", "model.py"} == {p.name for p in found.write(tmp_path / "out")}
    script = tmp_path / "out" / "model.py"
    for call in (lambda: eccentric.emit(script, tmp_path / "c"), lambda: found.emit(tmp_path / "c")):
        with pytest.raises(InputError, match=r"accept_misfit: needed to use .*does not fit the rig"):
            call()
    with pytest.warns(UserWarning, match="of a log that does not fit its rig"):
        eccentric.emit(script, tmp_path / "c", accept_misfit=True)
    (header,) = (tmp_path / "c").glob("*.h")
    assert "Caution: the values are of a log that does not fit its rig." in header.read_text(encoding="utf-8")


BARE = {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m"}


def bare_motor(order: int, amplitude: float) -> dict[str, np.ndarray]:
    """A motor without load, turned slowly to and fro: cogging beside 2.4 mN m of Coulomb friction."""
    t = np.arange(0.0, 40.0, 2e-3)
    w = 1.6 * np.sin(0.1 * np.pi * t) + 0.5 * np.sin(0.46 * np.pi * t)
    angle = -16.0 / np.pi * np.cos(0.1 * np.pi * t) - 0.5 / (0.46 * np.pi) * np.cos(0.46 * np.pi * t)
    alpha = 0.16 * np.pi * np.cos(0.1 * np.pi * t) + 0.23 * np.pi * np.cos(0.46 * np.pi * t)
    friction = 2.4e-3 * np.sign(w) + 1e-5 * w + amplitude * np.sin(order * angle + 0.3)
    noise = 0.004 * np.random.default_rng(1).standard_normal(len(t))
    step = 2.0 * np.pi / 16384
    return {
        "time_s": t,
        "theta_m_rad": np.round(angle / step) * step,
        "current_A": (5e-6 * alpha + friction) / 0.025 + noise,
    }


BARE_RIG = {
    "drive": "current",
    "known": {**BARE, "k_i": "0.025 N m/A", "J_m": "5e-6 kg m^2", "J_l": "0 kg m^2"},
}


@pytest.mark.parametrize("amplitude", [1.2e-3, 4e-3])
def test_cogging_larger_than_friction_is_named(amplitude: float) -> None:
    """Most of the drive is ripple, so that R^2 of the paper's model says little: it is no wrong unit."""
    log = read_log(bare_motor(12, amplitude))
    found = diagnose([log], BARE_RIG)
    assert [effect.id for effect, _ in found.effects] == ["cogging[n=12]"]
    (_, values), *_ = found.effects
    assert np.hypot(values["cogging_c12"], values["cogging_s12"]) == pytest.approx(amplitude, rel=0.03)
    channels = read_channels([log], read_rig(BARE_RIG))
    fitted = fit(channels, channels.rig, load_model(channels.rig.model))
    assert fitted.fits_the_rig
    assert (fitted.r_squared["paper"] < 0.5) == any(
        "periodic in the angle" in text for text in fitted.warnings
    )


def test_cogging_of_a_high_order_is_found_in_the_spectrum() -> None:
    """12 slots and 14 poles: 84 per turn, which the low pass for this encoder would have taken away."""
    log, rig = read_log(bare_motor(84, 4e-3)), read_rig(BARE_RIG)
    channels = read_channels([log], rig)
    assert channels.lines == (84,)
    assert any("a ripple of 84 per turn stands out" in text for text in channels.intake.warnings)
    found = diagnose([log], rig)
    assert [effect.id for effect, _ in found.effects] == ["cogging[n=84]"]
    (_, values), *_ = found.effects
    assert np.hypot(values["cogging_c84"], values["cogging_s84"]) == pytest.approx(4e-3, rel=0.03)


def test_no_line_stands_out_of_noise() -> None:
    """Without cogging, and with that of an order that is always offered, there is no line."""
    for order, amplitude in ((84, 0.0), (12, 4e-3)):
        channels = read_channels([read_log(bare_motor(order, amplitude))], read_rig(BARE_RIG))
        assert channels.lines == ()


@pytest.mark.parametrize("factor", [1e3, 1e-3, -1.0])
def test_ripple_does_not_excuse_a_wrong_sign_or_unit(factor: float) -> None:
    """Gravity in another unit, or turned over, is a wave of the angle too: the log does not fit the rig."""
    run = simulate(drawn_scenario(3, case="C2", mu=0.2, seconds=20.0))
    log = read_log({**run.columns, "current_A": factor * run.columns["current_A"]})
    rig = read_rig(run.rig)
    fitted = fit(read_channels([log], rig), rig, load_model(rig.model))
    assert not fitted.fits_the_rig


@pytest.mark.parametrize("more", [0.0, 0.15])
def test_a_current_without_a_sign_is_named(more: float) -> None:
    """A supply's current, positive whichever way the motor turns, and `more` in one: one line says so.

    In case C1 the rig has no load that would account for one sign.
    """
    rng, rows = np.random.default_rng(1), np.arange(250)
    forwards = np.repeat(np.arange(10) % 2 == 0, 250)
    runs = [(-1.0) ** k * np.radians(60.0 + 10.0 * k) for k in range(10)]
    log = {
        "run": np.repeat(np.arange(10.0), 250),
        "time_s": np.tile(rows * 0.008, 10),
        "theta_m_rad": np.concatenate([w * rows * 0.008 for w in runs]),
        "current_A": 0.3 + more * forwards + 0.02 * rng.standard_normal(2500),
    }
    rig = read_rig({"drive": "current", "moving_threshold_rad_s": 0.3, "known": {**BARE, "k_i": "1 N m/A"}})
    found = diagnose([read_log(log)], rig)
    assert not found.models.fits_the_rig
    kinds = [finding.kind for finding in found.channels.intake.findings if finding.doubts_the_rig]
    assert ["wrong_sign"] == kinds
    assert "its sign is missing" in diagnosis_document(found)["sentence"]


@pytest.mark.parametrize(("second", "warned"), [(0.0, True), (4.0, False)])
def test_delay_and_inertia_at_one_frequency_are_not_told_apart(second: float, warned: bool) -> None:
    """A sine of the angle, delay and inertia open: the fit says what to declare; a second frequency tells."""
    t, omega = np.arange(0.0, 20.0, 2e-3), 2.0 * np.pi
    waves = [(3.0, omega, 0.0), (second / 4.0, 3.7 * omega, 1.0)]
    angle = sum(a * np.sin(w * t + p) for a, w, p in waves)
    speed = sum(a * w * np.cos(w * t + p) for a, w, p in waves)
    alpha = sum(-a * w * w * np.sin(w * t + p) for a, w, p in waves)
    noise = np.random.default_rng(2).normal(0.0, 1e-3, len(t))
    volts = 0.01 * alpha + 0.1 * speed + 0.2 * np.sign(speed) + noise
    log = read_log({"time_s": t, "theta_m_rad": angle, "voltage_V": volts})
    rig = read_rig({"drive": "voltage", "input_delay_s": "estimate", "known": BARE})
    fitted = fit(read_channels([log], rig), rig, load_model(rig.model))
    assert warned == any("a delay and an inertia cannot be told apart" in text for text in fitted.warnings)
