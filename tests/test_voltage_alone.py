"""A rig that logs a voltage and no current: effects are named, the rig is estimated jointly with them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eccentric.diagnosis import Diagnosis, diagnose
from eccentric.identification import refit
from eccentric.model import TURNING
from eccentric.presentation import diagnosis_document
from eccentric.presentation.html.gather import report_data
from eccentric.presentation.plan_text import measurement_sentence
from tests.identified import FILTERED, inertia, is_found
from tests.swing import HELD_OUT, VOLTAGE, Array, Friction, Swing, log_of, sines, write_rig, write_runs

DRAG = 2e-4
SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("with_drag", "with_load")]


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
    return diagnose([log], write_rig(folder / "rig.toml", rig.known, HELD_OUT))


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


@pytest.mark.slow
def test_drag_is_named_from_the_voltage_alone(with_drag: Diagnosis) -> None:
    """The effect is named alone, its coefficient within three standard errors."""
    assert "named" == with_drag.attribution.verdict
    assert ["quadratic_drag"] == [effect.family for effect, _ in with_drag.effects]
    (coefficient,) = with_drag.effects[0][0].coefficients
    assert is_found(with_drag.models.extended, coefficient.name, DRAG)


def test_a_gear_that_loses_unlike_amounts_gives_the_same_voltage() -> None:
    """Losses of eta driving and rho eta back-driven are those of `by_load` on a rig of another scale.

    (1 + rho)/2 eta |G| sgn w + (1 - rho)/2 eta G: the second part is gravity, and with the voltage alone the
    scale R/k_i is identified by gravity.  Every other torque is smaller by that factor.
    """
    rho = 0.5
    eta = 0.15 / ((1.0 + rho) / 2.0 - 0.15 * (1.0 - rho) / 2.0)
    by = 1.0 + eta * (1.0 - rho) / 2.0
    load = Swing().load

    def gear(theta: Array, omega: Array) -> Array:
        return eta * np.where(load(theta) * omega > 0.0, 1.0, rho) * np.abs(load(theta)) * np.sign(omega)

    rig = Swing(more=by_load)
    other = Swing(J=by * rig.J, C=by * rig.C, B=by * rig.B, R=rig.R / by, more=gear)
    _, theta, omega, alpha = sines(np.random.default_rng(5))
    voltage = rig.voltage(theta, omega, alpha)
    assert other.voltage(theta, omega, alpha) == pytest.approx(voltage, rel=1e-12, abs=1e-12)
    # Free swings need no voltage and have no scale: every torque times the same factor.
    torque = rig.torque(theta, omega, alpha)
    assert other.torque(theta, omega, alpha) == pytest.approx(by * torque, rel=1e-12, abs=1e-14)


@pytest.mark.slow
def test_load_dependent_friction_is_told_with_its_equal(with_load: Diagnosis) -> None:
    """Both families that give this log are listed and no other; one that separates them is proposed."""
    assert "not_identifiable" == with_load.attribution.verdict
    assert {"load_dependent", "gear_efficiency"} == set(with_load.attribution.tied)
    assert "current" in measurement_sentence(with_load.attribution.next_measurement, TURNING)
    assert is_found(with_load.models.extended, "load_eta", 0.15)


def stribeck(_: Array, omega: Array) -> Array:
    """Dry friction that is 0.02 N m higher at rest and falls with 2 rad/s."""
    return 0.02 * np.exp(-((omega / 2.0) ** 2)) * np.sign(omega)


@pytest.mark.slow
def test_stribeck_friction_is_not_named_presliding(tmp_path: Path) -> None:
    """Dry friction that falls with speed and has no memory is not named as one that has."""
    found = diagnosed(tmp_path, stribeck)
    assert "presliding" not in {effect.family for effect, _ in found.effects}


@pytest.mark.slow
def test_a_fit_that_is_stopped_too_early_says_so(
    with_load: Diagnosis, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One step takes back what the scale was too large by, and is not the last: result and page say so."""
    data = with_load.data
    assert data.drive.scale is not None
    wrong = replace(data, drive=replace(data.drive, scale=1.05 * data.drive.scale))
    monkeypatch.setattr("eccentric.identification.fit_data.MOST_STEPS", 1)
    early = refit(with_load.models.base, (), wrong, bounds=False)
    found = replace(with_load, models=replace(with_load.models, paper=early))

    assert early.change == pytest.approx(1.0 - 1.0 / 1.05, rel=1e-2)
    assert (True, False) == (with_load.models.paper.settled, early.settled)
    assert (True, False) == (diagnosis_document(with_load)["settled"], diagnosis_document(found)["settled"])
    for said in (diagnosis_document(found)["warnings"], report_data(found).log.warnings, found.warnings):
        assert any("fit of the model paper has not converged" in warning for warning in said)
    assert not any("converged" in warning for warning in with_load.warnings)


@pytest.mark.parametrize("name", [*SLOW, "control"])
def test_rig_is_identified_beside_the_effect(name: str, request: pytest.FixtureRequest) -> None:
    """Scale, back-EMF and inertia of the extended model are those of the rig, effect or not."""
    found: Diagnosis = request.getfixturevalue(name)
    rig = Swing()
    fitted = found.models.extended
    assert is_found(fitted, "R/k_i", rig.R / rig.k_i, 1e-3)
    assert is_found(fitted, "k_e", rig.k_e, 1e-3)
    assert inertia(fitted, rig.mu) == pytest.approx(rig.J, rel=FILTERED)
    said = diagnosis_document(found)["rig_identified"]
    assert {"R/k_i", "k_e", "J_m"} <= set(said)
    assert said["R/k_i"]["unit"] == "V/(N m)"


@pytest.mark.slow
def test_errors_in_volts_are_those_in_newton_metres_by_the_scale(with_drag: Diagnosis) -> None:
    """Newton metres count all rows, volts those with the motor on: a part p of the rows.

    T^2 = p (V k_i/R)^2 + (1 - p) T_off^2 with one p for all models.
    """
    said = diagnosis_document(with_drag)
    volts, torques = said["rmse_holdout_V"]["mechanical"], said["rmse_holdout_Nm"]["mechanical"]
    free, scale = said["rmse_holdout_motor_off_Nm"], said["rig_identified"]["R/k_i"]["value"]
    parts = [
        (torques[name] ** 2 - free[name] ** 2) / ((volts[name] / scale) ** 2 - free[name] ** 2)
        for name in ("linear", "paper", "extended")
    ]
    assert 0.0 < parts[0] < 1.0
    # Free errors are at the scale that each model identified; the three agree to some 1e-5.
    assert parts == pytest.approx([parts[0]] * 3, rel=1e-4)
    # Driven rows have 0.05 V of noise, free ones none of it.
    assert volts["extended"] < 1.05 * 0.05 < volts["paper"]


@pytest.mark.parametrize("name", SLOW)
def test_free_swings_are_predicted_by_the_same_friction(name: str, request: pytest.FixtureRequest) -> None:
    """With the motor off the extended friction is all there is: the error falls to that of the encoder."""
    found: Diagnosis = request.getfixturevalue(name)
    free_error = found.score.free
    # 2.75 times; more is not to be had, since noise of the encoder is most of what is left.
    assert 2.0 * free_error["extended"] < min(free_error["paper"], free_error["linear"])
    # Rounding to an encoder step is noise of a twelfth of its square, of which differences see up to 25 Hz.
    step = 2.0 * np.pi / 65536 / np.sqrt(12.0)
    assert free_error["extended"] < Swing().J * step * (2.0 * np.pi * 25.0) ** 2


@pytest.mark.slow
def test_each_run_is_predicted_better_from_the_others(with_drag: Diagnosis) -> None:
    """Left out as a whole, most runs gain by the planted effect, clearly over all of them."""
    over = with_drag.score.over_runs
    assert over is not None
    percent, (low, high), better = over.gains["extended"]
    assert over.runs == 9
    assert better > over.runs / 2
    assert 0.0 < low < percent < high


@pytest.mark.slow
def test_control_by_voltage_alone_lacks_nothing(control: Diagnosis) -> None:
    """No effect explains the drive by itself: on a log of the paper's model none is adopted."""
    over = control.score.over_runs
    assert over is not None
    assert ("nothing_missing", ()) == (control.attribution.verdict, control.effects)
    assert not control.models.adopted
    assert set(over.gains) == {"paper"}
    low, high = over.gains["paper"][1]
    assert low <= 0.0 <= high
