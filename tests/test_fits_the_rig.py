"""Whether a log is from its rig at all is one question with one answer, in `fit` and in `diagnose`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eccentric.diagnosis import diagnose
from eccentric.identification import fit
from eccentric.logs import read_log
from eccentric.model import load_model
from eccentric.presentation import diagnosis_document, fit_sentence
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from eccentric.virtual_bench import simulate
from tests.planted import FRICTION, INERTIA, K_I, KNOWN, TORQUE, T, motion, torque, written
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
    assert "does not fit the rig" in fit_sentence(fitted)
    assert "does not fit the rig" in diagnosis_document(found)["sentence"]
    assert () == found.effects


@pytest.mark.parametrize(("factor", "fits"), [(1e3, False), (10.0, True)])
def test_a_voltage_in_millivolts_is_no_resistance(factor: float, fits: bool) -> None:
    """Read as volts, it is a thousand times what R i + k_e w says: no effect is named for it.

    Ten times could be a k_e in V/rpm.
    """
    run = simulate(drawn_scenario(3, case="C2", mu=0.2, seconds=20.0))
    found = diagnose([read_log({**run.columns, "voltage_V": factor * run.columns["voltage_V"]})], run.rig)

    assert fits == found.models.fits_the_rig
    if not fits:
        assert () == found.effects
        assert "the voltage is" in diagnosis_document(found)["sentence"]
