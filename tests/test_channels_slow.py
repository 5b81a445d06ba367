"""Logs that are too coarse for the low pass: points between their rows."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from eccentric.rigs import read_rig
from eccentric.signals import Channels, read_channels
from tests.logged import (
    RIG,
    RIGS,
    SHARED,
    SWING,
    channels_of,
    needs_shared,
)

SLOW_T = np.arange(0.0, 20.0, 0.025)


def slow(tmp_path: Path, rig: str = RIG) -> Channels:
    """Channels of a slow sine at 40 rows per second, under a voltage that rises in steps."""
    log = {"time_s": SLOW_T, "theta_m_rad": 8.0 * np.sin(SWING * SLOW_T), "voltage_V": 3.0 * SLOW_T}
    return channels_of(tmp_path, log, rig)


def test_slow_sampling_is_refined_by_a_spline_and_said(tmp_path: Path) -> None:
    """At 40 Hz there is no 25 Hz low pass: four points a row, on the sine and its derivatives; it is said."""
    c = slow(tmp_path)
    assert (c.time.points_per_row, c.time.logged_step_s) == (4, pytest.approx(0.025))
    np.testing.assert_allclose(c.time.t, np.arange(4 * len(SLOW_T) - 3) * 0.00625, atol=1e-12)
    middle = (c.time.t > 0.5) & (c.time.t < 19.0)
    sine, cosine = 8.0 * np.sin(SWING * c.time.t[middle]), 8.0 * np.cos(SWING * c.time.t[middle])
    np.testing.assert_allclose(c.motion.theta_m[middle], sine, atol=1e-7)
    np.testing.assert_allclose(c.motion.omega_m[middle], SWING * cosine, atol=1e-5)
    np.testing.assert_allclose(c.motion.alpha_m[middle], -(SWING**2) * sine, atol=1e-3)
    assert any("too coarse for the low pass" in warning for warning in c.intake.warnings)


def test_slow_voltage_is_held_if_the_rig_says_so(tmp_path: Path) -> None:
    """Between two rows a command is that of the first, and at a row it goes halfway to the next."""
    c = slow(tmp_path, RIG.replace("[known]", '[kinds]\nvoltage = "held"\n[known]'))
    assert c.motor.voltage is not None
    np.testing.assert_allclose(c.motor.voltage[10:-10:4], 3.0 * SLOW_T[2:-3])
    np.testing.assert_allclose(c.motor.voltage[8:-8:4], 3.0 * (SLOW_T[2:-2] - 0.0125))


def test_slow_samples_are_joined_by_lines_and_rows_are_counted_as_logged(tmp_path: Path) -> None:
    """A ramp of the voltage stays one; counts are of the log, not of its points."""
    c = slow(tmp_path, "holdout_intervals_s = [[4.0, 8.0]]\n" + RIG)
    assert c.motor.voltage is not None
    np.testing.assert_allclose(c.motor.voltage, 3.0 * c.time.t, atol=1e-12)
    assert c.counts["read"] == len(SLOW_T)
    # 19 s are clear of the ends; of each second with its reversal, 60 ms and some rows are lost either side.
    assert 19 * 40 * (1.0 - 2.0 * 0.1) < c.counts["used"] < 19 * 40 * (1.0 - 2.0 * 0.05)
    assert c.counts["held_out"] == pytest.approx(4.0 / 19.0 * c.counts["used"], abs=4)


def test_slow_sampling_under_a_slower_low_pass_or_average_is_left_alone(tmp_path: Path) -> None:
    """A low pass that 40 Hz allows, or averages that the rig requires, need no points between the rows."""
    for wish in ("low_pass_hz = 8\n", 'average_over = "0.3 s"\n'):
        c = slow(tmp_path, wish + RIG)
        assert (c.time.points_per_row, len(c.time.t)) == (1, len(SLOW_T))


@needs_shared
def test_real_rig_is_read_as_its_readme_says() -> None:
    """The unbalanced disc: 24500 rows, pi/1000 rad per count, speeds up to 19 rad/s, voltage only."""
    rig = read_rig(RIGS / "tue_unbalanced_disc.toml")
    path = SHARED / "measured" / "tue_unbalanced_disc" / "data.csv.gz"
    counts = np.loadtxt(path, delimiter=",", skiprows=1, usecols=3)
    c = read_channels([path], rig)
    assert c.counts["read"] == 24500
    assert (c.time.points_per_row, c.time.logged_step_s) == (4, pytest.approx(0.025))
    assert c.time.run_names == ("2024",)
    assert c.motion.quantum_rad == pytest.approx(math.pi / 1000.0)
    assert c.motor.measured_by == "voltage"
    assert float(np.max(np.abs(c.motion.omega_m))) == pytest.approx(19.0, abs=0.5)
    # Every fourth point is a row of the log.
    np.testing.assert_allclose(c.motion.theta_logged[::4], counts * math.pi / 1000.0, atol=1e-9)
    assert rig.estimate == {"input_delay_s", "theta_zero_rad", "voltage_offset_V"}
