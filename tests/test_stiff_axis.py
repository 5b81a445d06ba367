"""A stiff axis on a log of 1 kHz: the load moves faster than the default low pass, and the encoder shows it.

The motion is a sum of sines, so that angle, acceleration and torque are exact.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from eccentric.identification import Fit, fit
from eccentric.model import load_model
from eccentric.rigs import read_rig
from eccentric.signals import read_channels

INERTIA, COULOMB, VISCOUS = 2e-4, 0.05, 4e-4
K_I, NOISE = 0.05, 1.4e-4
LINES_HZ = np.array([0.3, 0.9, 2.1, 5.3, 11.0, 19.0, 31.0, 43.0])
RIG = {
    "moving_threshold_rad_s": 1.0,
    "known": {"case": "C1", "mu": 1.0, "M_kg": 0.0, "L_m": 0.0, "k_i_Nm_per_A": K_I, "J_l_kgm2": 0.0},
}


def log(rate_hz: float = 1000.0, counts: int = 2**20) -> dict[str, np.ndarray]:
    """Half a minute at 47 to 74 rad/s, without a reversal."""
    rng = np.random.default_rng(1)
    t = np.arange(0.0, 30.0, 1.0 / rate_hz)
    speed = np.array([3.0, 3.1, 3.9, 4.4, 5.4, 5.9, 7.5, 7.1]) / 6.0
    rate, phase = 2.0 * np.pi * LINES_HZ, rng.uniform(0.0, 2.0 * np.pi, len(LINES_HZ))
    angle = np.outer(t, rate) + phase
    theta = 60.0 * t + np.sin(angle) @ (speed / rate)
    omega, alpha = 60.0 + np.cos(angle) @ speed, -np.sin(angle) @ (speed * rate)
    torque = INERTIA * alpha + COULOMB + VISCOUS * omega
    quantum = 2.0 * np.pi / counts
    noise = NOISE * rng.standard_normal(len(t))
    return {
        "time_s": t,
        "theta_m_rad": np.round(theta / quantum) * quantum,
        "current_A": (torque + noise) / K_I,
    }


def fitted(columns: dict[str, np.ndarray], **keys: Any) -> Fit:
    """The axis fitted with an open inertia."""
    channels = read_channels([columns], read_rig(RIG | keys))
    return fit(channels, channels.rig, load_model("c1_perpendicular"))


def test_the_low_pass_follows_the_motion() -> None:
    """The error is nearly that of the noise, and the inertia right to a thousandth."""
    found = fitted(log())
    inertia = found.coefficients["J"]

    assert found.problem.drive.channels.rig.sampling.low_pass_hz == 200.0
    assert any("the load moves faster than 25 Hz" in text for text in found.warnings)
    assert found.rmse["paper"] < 2.0 * NOISE
    assert inertia.value == pytest.approx(INERTIA, rel=1e-3)
    assert found.band is not None
    assert not found.band.filtered


def test_a_low_pass_below_the_motion_biases_nothing_and_is_told() -> None:
    """Both sides are filtered alike, so only the held-out error is that of the filter."""
    found = fitted(log(), low_pass_hz=25.0)
    inertia = found.coefficients["J"]

    assert inertia.value == pytest.approx(INERTIA, rel=1e-3)
    assert inertia.interval[0] <= INERTIA <= inertia.interval[1]
    assert found.rmse["paper"] > 20.0 * NOISE
    assert found.band is not None
    assert found.band.below**2 + found.band.above**2 == pytest.approx(found.rmse["paper"] ** 2, rel=1e-9)
    assert found.band.filtered
    assert found.band.warning in found.warnings
    assert "above 25 Hz" in found.band.warning


@pytest.mark.parametrize(("rate_hz", "counts", "expected"), [(250.0, 2**20, 50.0), (1000.0, 2**10, 25.0)])
def test_the_low_pass_stays_within_what_the_log_resolves(
    rate_hz: float, counts: int, expected: float
) -> None:
    """Below 0.4 of the rate; and a coarse encoder shows no more acceleration at a higher one."""
    channels = read_channels([log(rate_hz, counts)], read_rig(RIG))

    assert channels.rig.sampling.low_pass_hz == expected
