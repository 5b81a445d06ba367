"""A model is tilted if its motion plane is, whatever the names of its parameters."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.diagnosis import diagnose
from eccentric.identification import fit
from eccentric.model import Model, Role, Sgn, Term, load_model, quantity
from eccentric.model import vocabulary as v
from eccentric.presentation import emitted_parameters
from eccentric.rigs import read_rig
from tests.planted import FRICTION, K_I, KNOWN, MASS, TORQUE, T, motion, torque, written

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
