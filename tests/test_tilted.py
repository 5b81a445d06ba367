"""Tilted planes of motion: effects are named as in an upright one, the tilt declared or left open."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.diagnosis import Diagnosis, diagnose
from eccentric.identification import drive_of, fit, fit_data_of, refit
from eccentric.model import Model, Role, Sgn, Term, load_model, quantity
from eccentric.model import vocabulary as v
from eccentric.presentation import diagnosis_sentence, emitted_parameters
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from tests.identified import is_found
from tests.planted import FRICTION, K_I, KNOWN, MASS, TORQUE, T, motion, torque, written
from tests.swing import Array, Swing, log_of, write_rig, write_runs

TILT = 0.7
CURRENT = ("time_s", "theta_m_rad", "current_A")
HELD_OUT = 'holdout_runs = ["driven_2"]\n'
C_LN, J_L = 0.004, 0.006


@dataclass(frozen=True)
class Tilted(Swing):
    """The rig in a plane tilted by TILT, with dry friction of its bearing by the force in the plane."""

    M_l: float = 0.3
    tilt: float = TILT

    def load(self, theta: Array) -> Array:
        """Gravity torque at the motor."""
        return np.cos(self.tilt) * super().load(theta)

    def torque(self, theta: Array, omega: Array, alpha: Array) -> Array:
        """Drive torque that the motion requires, the bearing's friction included."""
        bearing = self.mu * C_LN * self.force(theta, omega, alpha) * np.sign(omega)
        return super().torque(theta, omega, alpha) + bearing

    def force(self, theta: Array, omega: Array, alpha: Array) -> Array:
        """Newton for both masses in the plane: size of the bearing's force; x to the side, y up the slope."""
        angle, w, a = self.mu * theta, self.mu * omega, self.mu * alpha
        along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([np.sin(angle), -np.cos(angle)])
        pull = self.M * self.L * (a * along - w**2 * across)
        pull[1] += (self.M + self.M_l) * self.g * np.cos(self.tilt)
        return np.hypot(*pull)

    def rig(self, tilt: str) -> str:
        """What the rig file knows: all but friction; `tilt` is the line of phi, if it is known."""
        known = f"M_kg = {self.M}\nM_l_kg = {self.M_l}\nL_m = {self.L}\nmu = {self.mu}\n"
        rotor = self.J - self.mu**2 * J_L
        return f"{known}k_i_Nm_per_A = {self.k_i}\nJ_m_kgm2 = {rotor}\nJ_l_kgm2 = {J_L}\n{tilt}"


def twice_a_turn(theta: Array, omega: Array) -> Array:
    """Dry friction that varies twice per turn of the link [N m]."""
    return 0.012 * np.cos(2.0 * 0.5 * theta + 0.4) * np.sign(omega)


DECLARED = f"phi_rad = {TILT}\n"
OPEN = "[unknown]\nphi_rad = [0.2, 1.3]\n"
# Open is the harder one.
declared_or_open = pytest.mark.parametrize(
    "tilt", [pytest.param(DECLARED, id="declared", marks=pytest.mark.slow), pytest.param(OPEN, id="open")]
)


def diagnosed(folder: Path, rig: Tilted, tilt: str, model: str | None = None) -> Diagnosis:
    """The diagnosis of a current log of the rig."""
    log = write_runs(folder / "log.csv", log_of(rig, swings=False), CURRENT)
    return diagnose([log], write_rig(folder / "rig.toml", rig.rig(tilt), HELD_OUT), model)


@declared_or_open
def test_what_the_model_describes_lacks_nothing(tmp_path: Path, tilt: str) -> None:
    """Of friction by the paper's postulate nothing is missing; its coefficient is found, and an open tilt."""
    found = diagnosed(tmp_path, Tilted(), tilt)
    fitted = found.models.extended

    assert "nothing_missing" == found.attribution.verdict
    assert is_found(fitted, "C_lN", C_LN)
    assert fitted.values["phi"] == pytest.approx(TILT, abs=2e-3)
    assert ("phi" in fitted.estimates) == (tilt == OPEN)


@pytest.mark.slow
@declared_or_open
def test_an_effect_is_named_alone(tmp_path: Path, tilt: str) -> None:
    """Friction that varies over the turn is named, and an open tilt estimated beside it."""
    found = diagnosed(tmp_path, Tilted(more=twice_a_turn), tilt)
    fitted = found.models.extended

    assert ["link_harmonic_friction[n=2]"] == [effect.id for effect, _ in found.effects]
    assert fitted.values["phi"] == pytest.approx(TILT, abs=2e-3)


@pytest.mark.parametrize(("tilt", "bound"), [(0.0, "lower"), (0.02, None)])
def test_a_nearly_upright_plane_has_an_error_of_its_size(
    tmp_path: Path, tilt: float, bound: str | None
) -> None:
    """Gravity barely varies there: the interval holds the truth; at the bound there is no error."""
    log = write_runs(tmp_path / "log.csv", log_of(Tilted(tilt=tilt), swings=False), CURRENT)
    rig = write_rig(tmp_path / "rig.toml", Tilted().rig("[unknown]\nphi_rad = [0.0, 1.3]\n"), HELD_OUT)
    channels = read_channels([log], read_rig(rig))
    model = load_model("rotating_link")
    data = fit_data_of(drive_of(channels, channels.rig, model), channels.rig, model)
    phi = refit(model, (), data).estimates["phi"]
    low, high = phi.interval

    assert bound == phi.bound_active
    assert 0.0 == low <= tilt <= high < 0.1
    assert np.isnan(phi.std_error) if bound else abs(phi.value - tilt) < 2.0 * phi.std_error < 0.1


@pytest.mark.slow
def test_a_wrong_tilt_is_corrected(tmp_path: Path) -> None:
    """A tilt that is declared 0.15 rad too large is named with the right one."""
    found = diagnosed(tmp_path, Tilted(), f"phi_rad = {TILT + 0.15}\n")

    assert ["gravity_tilt[declared]"] == [effect.id for effect, _ in found.effects]
    assert found.models.extended.values["tilt_more"] == pytest.approx(-0.15, abs=2e-3)
    assert "phi should be 0.6998 rad; the rig file has" in diagnosis_sentence(found)


@pytest.mark.slow
def test_the_right_tilt_is_one_that_a_rig_file_takes(tmp_path: Path) -> None:
    """A plane declared upright is tilted by 0.3 rad, not by -0.3; a mass 4.5 % too large looks the same."""
    found = diagnosed(tmp_path, Tilted(tilt=0.3), 'case = "C2"\n', "rotating_link")
    ranked = found.attribution.searches["mechanical"].ranked
    (tilt,) = (fit.variants[-1] for fit in ranked if fit.last.id == "gravity_tilt[declared]")

    assert {"mass_mismatch", "gravity_tilt"} == set(found.attribution.tied)
    assert tilt.values["tilt_more"] == pytest.approx(0.3, abs=5e-3)


@pytest.mark.parametrize(
    ("tilt", "model", "said"),
    [
        (OPEN.replace("1.3", "1.5707"), None, 'case = "C1" in [known] is a level plane'),
        ("phi_rad = 1.5705\n", None, "[known] phi: expected gravity in the plane of motion"),
        ('case = "C1"\n', "rotating_link", "c1_perpendicular is its model"),
    ],
    ids=["open", "declared", "case C1"],
)
def test_a_level_plane_is_case_c1(tmp_path: Path, tilt: str, model: str | None, said: str) -> None:
    """Without gravity in the plane, the model of case C1 is named in one line."""
    with pytest.raises(InputError, match=re.escape(said)):
        diagnosed(tmp_path, Tilted(tilt=np.pi / 2.0), tilt, model)


# A model is tilted if its motion plane is, whatever the names of its parameters.


w = v.omega_m.symbol
DRAG, PITCH = 2e-6, 0.5


def fan() -> Model:
    """Case C2 with the drag D phi omega_m |omega_m| of a fan, phi = 1/2 the pitch of its blades."""
    base = load_model("c2_parallel")
    D = quantity("D", "N m s^2/rad^2", "drag of a fan", "", "nonnegative")
    pitch = quantity("phi", "1", "pitch of its blades", "", "positive", str(PITCH))
    term = Term("fan", "friction", D.symbol, pitch.symbol * w**2 * Sgn(w), "own", role=Role.DRAG)
    mechanical, electrical = base.balance("mechanical"), base.balance("electrical")
    return replace(
        base,
        name="with_fan",
        parameters=(*base.parameters, D, pitch),
        balances=(replace(mechanical, terms=(*mechanical.terms, term)), electrical),
    )


def log_and_rig(tmp_path: Path, case: str) -> tuple[Path, Path]:
    """A log of the drive with a fan, with noise, and its rig."""
    omega = motion()[1]
    noise = np.random.default_rng(3).normal(0.0, 2e-4, len(T))
    drive = torque("C2", FRICTION) + DRAG * PITCH * omega * np.abs(omega) + noise
    written(tmp_path, f'case = "{case}"\n' + KNOWN + TORQUE + MASS, {"current_A": drive / K_I})
    return tmp_path / "log.csv", tmp_path / "rig.toml"


def test_a_pitch_called_phi_is_no_tilt(tmp_path: Path) -> None:
    """Its own value holds and not the tilt of 0: in the fit, in what is emitted and in a diagnosis."""
    log, rig = log_and_rig(tmp_path, "C2")
    found = diagnose([log], rig, fan())
    fitted = fit(found.channels, read_rig(rig), fan())
    assert DRAG == pytest.approx(fitted.coefficients["D"].value, rel=2e-2)
    assert DRAG == pytest.approx(found.models.extended.estimates["D"].value, rel=2e-2)
    assert PITCH == emitted_parameters(fitted)[0]["phi"]
    assert () == found.effects


def test_a_model_of_another_case_is_refused_whatever_its_parameters_are_called(tmp_path: Path) -> None:
    """Gravity in a level plane is refused, also for a model with a parameter of the name phi."""
    log, rig = log_and_rig(tmp_path, "C1")
    with pytest.raises(InputError, match="with_fan requires case C2, got case C1"):
        diagnose([log], rig, fan())
