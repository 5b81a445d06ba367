"""The four measured rigs come out as their READMEs say: what is known of them, nothing invented."""

from __future__ import annotations

import functools
from pathlib import Path

import pytest

from eccentric.diagnosis import Diagnosis, diagnose
from eccentric.diagnosis.limits import ROUNDING
from eccentric.logs import read_log
from eccentric.presentation import diagnosis_sentence

ROOT = Path(__file__).resolve().parents[1]
MEASURED = ROOT.parent / "shared" / "data" / "measured"
DISC_ROWS = 10_000
"""Of 24,500: effects with states are followed row by row, and show as much in four minutes as in ten."""
pytestmark = pytest.mark.skipif(not MEASURED.exists(), reason="the measured logs are not beside this clone")


@functools.cache
def found(rig: str, folder: str | None = None) -> Diagnosis:
    """The diagnosis of a measured log under its example rig."""
    log = MEASURED / (folder or rig) / "data.csv.gz"
    return diagnose([log], ROOT / "examples" / "rigs" / f"{rig}.toml")


def screw_drive(number: int) -> Diagnosis:
    """Drive 1 or 3 of the screw drives."""
    return found(f"tro2021_drive{number}", "tro2021_screw_drives")


def servo() -> Diagnosis:
    """The hobby servo."""
    return found("bam_xl330_pendulum")


def order_near(diagnosis: Diagnosis, wanted: float) -> float:
    """Share of the variance inside runs of the order next to the one wanted; 0 if none is within 0.05."""
    return max((o.share for o in diagnosis.orders if abs(o.per_turn - wanted) < 0.05), default=0.0)


@pytest.mark.slow
def test_servo_lacks_friction_that_follows_the_load_of_its_gear() -> None:
    """The largest effect is load-dependent; the gain on held-out and on left-out runs is clear of none."""
    diagnosis = servo()
    over = diagnosis.score.over_runs
    assert over is not None
    assert (diagnosis.effects[0][0].family, diagnosis.unit) == ("load_dependent", "N m")
    assert diagnosis.score.interval[0] > 0.0
    assert over.gains["extended"][1][0] > 0.0


@pytest.mark.slow
def test_the_winding_of_the_servo_is_not_alone() -> None:
    """Its resistance follows the register of the temperature more than three times as steeply as copper's."""
    (check,) = [check for check in servo().ranges if check.effect == "resistance_temperature"]
    assert check.outside == "above"
    assert check.value > 3.0 * 0.393
    assert "times copper's: the winding is not the only cause." in diagnosis_sentence(servo())


@pytest.mark.slow
def test_normal_force_of_the_bearing_is_not_the_load_of_the_servo() -> None:
    """Friction by F_N does not help on unseen runs, and with the load of the gear nothing of it is left."""
    diagnosis = servo()
    over = diagnosis.score.over_runs
    assert over is not None
    assert over.gains["paper"][1][0] < ROUNDING
    held = {name: diagnosis.models.extended.estimates[name].bound_active for name in ("B_lN", "C_lN")}
    assert held == {"B_lN": "lower", "C_lN": "lower"}


@pytest.mark.slow
def test_motor_of_the_servo_is_that_of_other_logs() -> None:
    """R/k_i and k_e lie where R of 2.8 to 4.8 ohm and k_t = k_e of 0.32 to 0.39 N m/A put them."""
    estimates = servo().models.extended.estimates
    assert 2.8 / 0.39 < estimates["R/k_i"].value < 4.8 / 0.32
    assert 0.32 < estimates["k_e"].value < 0.39


@pytest.mark.slow
def test_free_swings_of_the_servo_have_the_same_friction() -> None:
    """With the motor off, where nothing electrical is, the same friction predicts as well as with it on."""
    diagnosis = servo()
    free = diagnosis.score.free
    assert free["extended"] < diagnosis.score.rmse["mechanical"]["extended"]
    assert free["extended"] < min(free["linear"], free["paper"])


def test_lead_screw_shows_stribeck_friction() -> None:
    """Run means of drive 1: what README puts at 0.14 mN m falls clearly by a Stribeck curve, alone named."""
    diagnosis = screw_drive(1)
    over = diagnosis.score.over_runs
    assert over is not None
    assert ["stribeck"] == [effect.family for effect, _ in diagnosis.effects]
    assert over.rmse["linear"] == pytest.approx(0.14e-3, abs=0.005e-3)
    assert diagnosis.score.interval[0] > 0.0
    assert over.gains["extended"][1][0] > 0.0


def test_lead_screw_is_periodic_in_its_turns() -> None:
    """Inside the runs of drive 1 the torque has one, two and three periods per turn, no other."""
    diagnosis = screw_drive(1)
    assert [1, 2, 3] == sorted(round(order.per_turn) for order in diagnosis.orders)
    assert all(order_near(diagnosis, wanted) > 0.0 for wanted in (1, 2, 3))


def test_worm_gear_is_periodic_in_its_turns_and_gets_no_wrong_name() -> None:
    """Drive 3 has one period per turn; run means show no angle, time or acceleration to name."""
    diagnosis = screw_drive(3)
    assert order_near(diagnosis, 1) > 0.4
    variables = {v for effect, _ in diagnosis.effects for v in effect.evidence.depends_on}
    assert variables <= {"velocity", "direction"}
    assert not diagnosis.effects or diagnosis.score.interval[0] > 0.0


@pytest.mark.slow
def test_nothing_is_invented_on_the_quasi_direct_drive() -> None:
    """Of the disturbed pendulum nothing can be proved beyond the paper; gravity is that of its README."""
    diagnosis = found("dfki_ak80_pendulum")
    assert ("nothing_missing", ()) == (diagnosis.attribution.verdict, diagnosis.effects)
    gravity = diagnosis.rig.known["M"] * 9.81 * diagnosis.models.paper.estimates["L"].value
    assert gravity == pytest.approx(3.68, rel=0.05)


@pytest.mark.slow
def test_disc_is_aligned_and_nothing_unsupported_is_named() -> None:
    """One to one and a half steps late, zero angle off by 0.05 rad; held-out data backs whatever is named."""
    log = read_log(MEASURED / "tue_unbalanced_disc" / "data.csv.gz")
    first = {name: column[:DISC_ROWS] for name, column in log.columns.items()}
    diagnosis = diagnose([first], ROOT / "examples" / "rigs" / "tue_unbalanced_disc.toml")
    channels = diagnosis.channels
    assert 0.02 < channels.alignment.input_delay_s < 0.045
    assert 0.04 < channels.alignment.theta_zero_rad < 0.06
    assert not diagnosis.effects or diagnosis.score.interval[0] > 0.0
    # README: rigid body, back-EMF and Coulomb leave 0.035 V on windows of 0.3 s.
    assert diagnosis.score.per_drive["linear"] < 0.035
