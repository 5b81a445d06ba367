"""Constant speeds: a constant load and Stribeck friction from run means, orders per turn inside the runs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import find_peaks, lombscargle

from eccentric.core import InputError
from eccentric.diagnosis import Diagnosis, diagnose, orders_of, score
from eccentric.diagnosis.score import peaks
from eccentric.presentation import diagnosis_document
from eccentric.signals.motion import turn_line
from tests import screw
from tests.logged import SHARED, needs_shared
from tests.screw import Array

RIPPLE = {1: 0.3e-3, 3: 0.15e-3}


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    """The diagnosis of a simulated screw drive."""
    folder = tmp_path_factory.mktemp("screw")
    (folder / "rig.toml").write_text(screw.RIG, encoding="utf-8")
    return diagnose([screw.write_log(folder / "log.csv", RIPPLE)], folder / "rig.toml")


def test_stribeck_friction_is_named_from_the_means_of_runs(found: Diagnosis) -> None:
    """One mean a run is enough to name it, and to find its torque and velocity to three standard errors."""
    assert ["stribeck[d=2]"] == [effect.id for effect, _ in found.effects]
    for name, truth in (("stribeck_A", screw.STRIBECK), ("stribeck_v", screw.VELOCITY)):
        estimate = found.models.extended.estimates[name]
        assert abs(estimate.value - truth) <= 3.0 * estimate.std_error
    assert found.rows.description == "whole runs"
    assert np.count_nonzero(found.rows.train | found.rows.score) == len(screw.SPEEDS)


def test_constant_load_is_identified_and_no_friction_by_a_mass_that_is_not_there(found: Diagnosis) -> None:
    """T_load is recovered with its sign with Coulomb and viscous friction; F_N has no coefficients."""
    estimates = found.models.extended.estimates
    truths = {"T_load": screw.LOAD, "C_m": screw.COULOMB, "B_m": screw.VISCOUS}
    # A second is cut off each run: of the ripple, a part of one turn is left in the nine of the fastest.
    left = sum(RIPPLE.values()) / np.pi / 8.8
    allowed = {"T_load": left, "C_m": left, "B_m": left / max(screw.SPEEDS)}
    for name, truth in truths.items():
        assert abs(estimates[name].value - truth) <= 3.0 * estimates[name].std_error + allowed[name]
    assert set(estimates) == {*truths, "stribeck_A", "stribeck_v"}


def test_every_run_is_predicted_from_the_others(found: Diagnosis) -> None:
    """Left out one by one, most runs are better predicted with the effect, clearly over all of them."""
    over = found.score.over_runs
    assert over is not None
    _, (low, _), better = over.gains["extended"]
    assert (over.runs, low > 0.0) == (len(screw.SPEEDS), True)
    assert better > over.runs / 2


def test_orders_of_a_log_are_those_of_its_ripple(found: Diagnosis) -> None:
    """One and three periods per turn are found in every run, at the amplitudes planted, and nothing else."""
    assert sorted(RIPPLE) == sorted(round(o.per_turn) for o in found.orders)
    for order in found.orders:
        whole = round(order.per_turn)
        assert order.per_turn == pytest.approx(whole, abs=0.02)
        assert order.amplitude == pytest.approx(RIPPLE[whole], rel=0.05)
        assert order.seen == order.stretches == len(screw.SPEEDS)
        variance = screw.NOISE**2 + sum(a**2 / 2.0 for a in RIPPLE.values())
        assert order.share == pytest.approx(RIPPLE[whole] ** 2 / 2.0 / variance, rel=0.1)


def test_means_of_whole_runs_have_no_error_below_a_low_pass(found: Diagnosis) -> None:
    """One mean a run is no signal in time: the document has the key, without a value."""
    document = diagnosis_document(found)

    assert "error_band" in document
    assert document["error_band"] is None


def noise(found: Diagnosis, seed: int) -> Array:
    """White noise on the samples."""
    return screw.NOISE * np.random.default_rng(seed).standard_normal(len(found.channels.time.t))


def test_peaks_are_those_of_scipy() -> None:
    """Of two peaks too near each other the higher counts, whatever stands beside both."""
    rng = np.random.default_rng(1)
    for _ in range(300):
        mean, apart = rng.random(200), int(rng.integers(1, 20))
        least = np.maximum(0.3, 0.9 * rng.random(200))
        assert peaks(mean, least, apart) == find_peaks(mean, height=least, distance=apart)[0].tolist()


@pytest.mark.parametrize("seed", range(5))
def test_noise_has_no_order(found: Diagnosis, seed: int) -> None:
    """Nothing is periodic in white noise."""
    assert () == orders_of(found.data, noise(found, seed))


@pytest.mark.parametrize("hertz", [0.3, 1.0, 3.0])
def test_what_is_periodic_in_time_is_no_order(found: Diagnosis, hertz: float) -> None:
    """A hum of one frequency has another order at every speed, and is not called one."""
    hum = 0.5e-3 * np.sin(2.0 * np.pi * hertz * found.channels.time.t)
    assert () == orders_of(found.data, hum + noise(found, 1))


def test_a_fraction_of_the_turn_is_found_as_such(found: Diagnosis) -> None:
    """A gear that turns 2.5 times per turn of the motor shows as 2.5, not as its neighbours."""
    (order,) = orders_of(found.data, 0.2e-3 * np.cos(2.5 * found.channels.motion.theta_m) + noise(found, 2))
    assert order.per_turn == pytest.approx(2.5, abs=0.02)
    assert order.amplitude == pytest.approx(0.2e-3, rel=0.05)


def test_a_drift_over_a_stretch_is_no_part_of_a_ripple(found: Diagnosis) -> None:
    """A torque that rises evenly with time leaves every order as it is."""
    ripple = 0.2e-3 * np.cos(2.5 * found.channels.motion.theta_m) + noise(found, 2)
    (still,) = orders_of(found.data, ripple)
    (drifting,) = orders_of(found.data, ripple + 0.1e-3 * found.channels.time.t)

    assert still.seen == drifting.seen
    assert still.per_turn == pytest.approx(drifting.per_turn, rel=1e-6)
    assert still.amplitude == pytest.approx(drifting.amplitude, rel=1e-4)
    assert still.share == pytest.approx(drifting.share, rel=1e-4)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_spectrum_over_the_angle_is_that_of_lomb_and_scargle(sign: float) -> None:
    """SciPy's normalised periodogram, on uneven angles in either direction."""
    rng = np.random.default_rng(1)
    angle = sign * np.cumsum(rng.uniform(0.01, 0.1, 800))
    y = np.cos(3.0 * angle + 1.0) + rng.normal(size=800)

    np.testing.assert_allclose(
        score._spectrum(angle, y), lombscargle(angle, y, score._GRID, normalize=True), atol=1e-12
    )


@pytest.mark.parametrize("steps", [4, 8, 16])
def test_a_spectrum_over_few_angles_a_turn_has_no_holes(steps: int) -> None:
    """Where sine and cosine of an order are one column, or nothing, its share is finite and in range."""
    rng = np.random.default_rng(2)
    share = score._spectrum(2.0 * np.pi / steps * np.arange(400), rng.normal(size=400))

    assert np.all(np.isfinite(share))
    assert -1e-9 <= np.min(share) <= np.max(share) <= 1.0 + 1e-9


@pytest.mark.parametrize(("order", "share"), [(1, 1.0), (5, 1.04)])
def test_the_line_of_a_drive_gives_the_angle(order: int, share: float) -> None:
    """A cosine of the angle at a slowly varying speed: its phase is the angle, though the clock is off."""
    t = np.arange(0.0, 6.0, 0.0005)
    theta = 90.0 * t + 0.4 * np.sin(1.3 * t)
    signal = 3.0 + 0.5 * np.cos(order * theta + 0.7) + np.random.default_rng(3).normal(0.0, 0.5, len(t))
    line = turn_line(t, signal, np.full(len(t), 90.0 / share))

    assert line.order == order
    assert line.frequency == pytest.approx(90.0 / (2.0 * np.pi), rel=0.005)  # as it varies
    assert line.amplitude == pytest.approx(0.5, rel=0.05)
    inner = slice(2000, -2000)
    error = line.theta - theta
    # Noise as large as the amplitude, averaged over eight cycles: sqrt(3/rows) of a radian.
    assert np.std(error[inner]) * order < 2.0 * np.sqrt(3.0 / (8.0 * 2000.0 / (order * line.frequency)))
    with pytest.raises(InputError, match="expected a line at 1 to 5 times the speed in the drive signal"):
        turn_line(t, signal - 0.5 * np.cos(order * theta + 0.7), np.full(len(t), 90.0))


@needs_shared
def test_two_lines_of_a_motor_agree_that_its_clock_is_off() -> None:
    """Measured: its unbalance and, without the disc, its poles give the same 4 % between line and speed."""
    ratios = []
    for path in sorted((SHARED / "field" / "logs").glob("15-*/*.csv")):
        counts, rpm = np.loadtxt(path, delimiter=",", skiprows=1).T
        speed = rpm * np.pi / 30.0
        line = turn_line(np.arange(len(counts)) / 2000.0, counts, speed)
        ratios.append(line.frequency / (np.median(speed) / (2.0 * np.pi)))

    assert len(ratios) == 2
    assert ratios[0] == pytest.approx(ratios[1], rel=2e-3)
    assert ratios[0] == pytest.approx(1.042, abs=2e-3)
