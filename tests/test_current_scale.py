"""A wrong k_i scales gravity and inertia by the same factor; a wrong mass, or inertia, does not."""

import json
from pathlib import Path

import pytest

from eccentric.diagnosis import diagnose
from eccentric.presentation import diagnosis_sentence
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from tests.virtual import log_of


def declared(rig: Path, *left_out: str, **factors: float) -> Path:
    """Return the rig with these quantities taken out, or declared by another factor."""
    content = json.loads(rig.read_text(encoding="utf-8"))
    for key in left_out:
        del content["known"][key]
    for key, factor in factors.items():
        content["known"][key] *= factor
    rig.write_text(json.dumps(content), encoding="utf-8")
    return rig


@pytest.mark.slow
def test_a_wrong_k_i_is_named_with_its_right_value(tmp_path: Path) -> None:
    """The one thing missing is k_i, at the value that made the log, whatever it was declared as."""
    log, rig = log_of(tmp_path, 9004, log_type="traj")
    true = json.loads(rig.read_text(encoding="utf-8"))["known"]["k_i_Nm_per_A"]
    found = diagnose([log], declared(rig, k_i_Nm_per_A=0.85))

    assert ("named", ["ki_mismatch"]) == (found.attribution.verdict, [e.id for e, _ in found.effects])
    (_, own), *_ = found.effects
    assert pytest.approx(true, rel=0.01) == 0.85 * true / (1.0 + own["current_scale"])
    assert "M g L" not in diagnosis_sentence(found)


@pytest.mark.slow
def test_a_wrong_mass_is_not_taken_for_a_wrong_k_i(tmp_path: Path) -> None:
    """With the inertia right, gravity alone is off: the mass."""
    log, rig = log_of(tmp_path, 9004, log_type="traj")
    found = diagnose([log], declared(rig, M_kg=1.11))

    assert ("named", ["mass_mismatch"]) == (found.attribution.verdict, [e.family for e, _ in found.effects])
    assert "k_i" not in diagnosis_sentence(found)


@pytest.mark.slow
def test_a_wrong_inertia_is_not_taken_for_a_wrong_k_i(tmp_path: Path) -> None:
    """With gravity right, the inertia alone is off."""
    log, rig = log_of(tmp_path, 9004, log_type="traj")
    found = diagnose([log], declared(rig, J_l_kgm2=1.15, J_m_kgm2=1.15))

    assert ("named", ["inertia_mismatch"]) == (found.attribution.verdict, [e.id for e, _ in found.effects])


@pytest.mark.slow
@pytest.mark.parametrize("wrong", ["k_i_Nm_per_A", "M_kg"])
def test_where_the_inertia_is_open_mass_and_k_i_are_told_together(wrong: str, tmp_path: Path) -> None:
    """Gravity alone is too little or too much then: the mass is named, k_i said to look the same."""
    log, rig = log_of(tmp_path, 9004, log_type="traj")
    found = diagnose([log], declared(rig, "J_m_kgm2", "J_l_kgm2", **{wrong: 1.11}))

    assert ["mass_mismatch"] == [e.family for e, _ in found.effects]
    assert "looks the same as ki_mismatch" in diagnosis_sentence(found)


def test_mu_the_wrong_way_round_is_told(tmp_path: Path) -> None:
    """Motor over link in place of link over motor: gravity fits the inverse; no unit is blamed."""
    log, rig = log_of(tmp_path, 9004, log_type="traj")
    channels = read_channels([log], read_rig(declared(rig, mu=25.0)))

    (finding,) = [f for f in channels.intake.findings if f.severity == "warning"]
    assert ("contradiction", "mu") == (finding.kind, finding.channel)
    assert "0.2 fits" in finding.text


def test_a_k_i_in_another_unit_is_told_before_any_unit_of_torque(tmp_path: Path) -> None:
    """All torques a thousand times too large, no torque logged: the scale of the current, or k_i."""
    log, rig = log_of(tmp_path, 9004, log_type="traj")
    channels = read_channels([log], read_rig(declared(rig, k_i_Nm_per_A=1000.0)))

    assert [("contradiction", "k_i")] == [
        (f.kind, f.channel) for f in channels.intake.findings if f.severity == "warning"
    ]
