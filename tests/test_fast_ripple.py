"""A ripple near the Nyquist frequency: its product with a measured current has twice that frequency."""

import math

import numpy as np
import pytest

from eccentric.diagnosis.stage import stage_of
from eccentric.identification import Refit, refit, rms
from eccentric.logs import read_log
from eccentric.model import load_model
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from eccentric.virtual_bench import BenchRun, simulate
from tests.virtual import drawn_scenario

Array = np.ndarray
ORDER = 6


@pytest.fixture(scope="module")
def run() -> BenchRun:
    """A log at 250 Hz with a run at 130 rad/s: 6 periods a turn are 124 Hz."""
    return simulate(drawn_scenario(3, case="C1", mu=1.0 / 30.0, seconds=40.0))


def torque_of_the_cosine(run: BenchRun, current: Array) -> tuple[Array, Array, Array]:
    """Speed [rad/s], -k_i cos(n theta) [N m/A] and the torque of a ripple by that cosine, on the rows."""
    t, theta = np.asarray(run.columns["time_s"]), np.asarray(run.columns["theta_m_rad"])
    channels = read_channels([read_log({**run.columns, "current_A": current})], read_rig(run.rig))
    stage = stage_of(channels, load_model(channels.rig.model), None, "log")
    (effect,) = [e for e in stage.offered if e.id == f"kt_ripple[n={ORDER}]"]
    (candidate,) = stage.candidates([effect])
    rows = stage.data.rows
    torque = rows.mean(candidate.in_the("mechanical").columns({}))[:, 0]
    alone = -run.rig["known"]["k_i_Nm_per_A"] * np.cos(ORDER * theta)
    return np.abs(rows.mean(np.gradient(theta, t))), rows.mean(alone), torque


def test_the_ripple_of_the_current_makes_no_slow_torque(run: BenchRun) -> None:
    """In quadrature, as inertia makes it, it gives half of sin(2 n theta), which is fast in the drive.

    Sampled near 2 n omega it stands still.
    """
    theta = np.asarray(run.columns["theta_m_rad"])
    speed, _, torque = torque_of_the_cosine(run, np.sin(ORDER * theta))
    still = np.abs(2.0 * ORDER * speed / (2.0 * math.pi) - 250.0) < 10.0

    assert np.count_nonzero(still) > 20
    assert np.sqrt(np.mean(torque[still] ** 2)) < 0.02 * run.rig["known"]["k_i_Nm_per_A"] / 2.0


def test_a_slow_current_makes_the_torque_of_the_ripple(run: BenchRun) -> None:
    """The low pass leaves it as it is; the angle is that of the log to a part of its steps."""
    _, alone, torque = torque_of_the_cosine(run, np.full(len(run.columns["time_s"]), 2.0))

    np.testing.assert_allclose(torque[50:-50], 2.0 * alone[50:-50], atol=0.1 * np.max(np.abs(alone)))


EFFECTS = ((f"cogging[n={ORDER}]", 0.5), (f"kt_ripple[n={ORDER}]", 0.05))


def refitted(seed: int, noise: float) -> tuple[BenchRun, Refit]:
    """A log with cogging of half of the friction and a ripple of the torque constant, and the true model."""
    run = simulate(drawn_scenario(seed, effects=EFFECTS, case="C1", mu=1.0 / 30.0, seconds=40.0, noise=noise))
    channels = read_channels([read_log(run.columns)], read_rig(run.rig))
    stage = stage_of(channels, load_model(channels.rig.model), None, "log")
    by_id = {effect.id: effect for effect in stage.offered}
    return run, refit(stage.base, tuple((by_id[name], {}) for name, _ in EFFECTS), stage.data)


def test_a_ripple_of_the_speed_is_none_of_the_torque_constant() -> None:
    """Its back-EMF near the cut-off passes the low pass once, like the voltage, and leaves nothing there.

    Both have the order, and the circuit alone determines that of the torque constant.
    """
    run, found = refitted(7, noise=0.006)
    (true,) = [e for e in run.truth["effects"] if e["family"] == "kt_ripple"]
    cosine, sine = (found.estimates[f"kt_ripple_{part}{ORDER}"].value for part in "cs")

    phase = true["shape"][1]
    expected = true["amplitude"] * math.cos(phase), -true["amplitude"] * math.sin(phase)
    assert (cosine, sine) == pytest.approx(expected, abs=0.1 * true["amplitude"])


@pytest.mark.parametrize("seed", [7, pytest.param(8, marks=pytest.mark.slow)])
def test_the_true_model_leaves_nothing_of_the_circuit_below_the_low_pass(seed: int) -> None:
    """Without noise, all that is left is ripple above it, which the filtered speed lacks."""
    _, found = refitted(seed, noise=0.0)
    held_out = found.data.rows.score
    left = rms(found.smooth_residual("electrical")[held_out])

    assert left < 0.1 * rms(found.residuals["electrical"][held_out])


def test_the_back_emf_in_a_torque_from_the_voltage_passes_the_low_pass_once() -> None:
    """Of a sine in the speed the low pass leaves a known part g, that of a Butterworth without phase.

    Below it the voltage has g times its torque, and so have J alpha and k_i k_e/R omega from the angle: of
    them nothing is left. Friction B omega of the filtered speed passes again and leaves (g - g^2) B omega.
    Filtered twice, the back-EMF would leave as much of itself, which is twelve times as large here.
    """
    rate, hertz, size, cut = 500.0, 20.0, 2.0, 25.0
    mu, R, k_i, k_e, B, C, J_m, J_l = 0.2, 2.0, 0.05, 0.05, 1e-4, 5e-3, 2e-5, 1e-4
    t = np.arange(0.0, 40.0, 1.0 / rate)
    fast, slow = 2.0 * math.pi * hertz, 0.2 * math.pi
    theta = -40.0 / slow * np.cos(slow * t) - size / fast * np.cos(fast * t)
    omega = 40.0 * np.sin(slow * t) + size * np.sin(fast * t)
    alpha = 40.0 * slow * np.cos(slow * t) + size * fast * np.cos(fast * t)
    torque = (J_m + mu**2 * J_l) * alpha + B * omega + C * np.sign(omega)
    log = {"time_s": t, "theta_m_rad": theta, "voltage_V": R / k_i * torque + k_e * omega}
    known = {"case": "C1", "M_kg": 0.0, "M_l_kg": 0.0, "L_m": 0.3, "mu": mu, "g_m_s2": 9.81}
    known |= {"R_ohm": R, "k_i_Nm_per_A": k_i, "k_e_Vs_per_rad": k_e, "J_m_kgm2": J_m, "J_l_kgm2": J_l}
    # Rows that are fitted have passed the low pass, those held out have not.
    rig = {"known": known, "drive": "voltage", "low_pass_hz": cut, "holdout_intervals_s": [[11.0, 14.0]]}
    channels = read_channels([read_log(log)], read_rig(rig | {"columns": list(log)}))
    stage = stage_of(channels, load_model(channels.rig.model), None, "log")
    found = refit(stage.base, (), stage.data)

    inside = np.abs(t - 12.5) < 1.0
    waves = [wave(fast * t[inside]) for wave in (np.sin, np.cos)]
    columns = np.column_stack([*waves, *(t[inside] ** k for k in range(3))])
    sine, cosine, *_ = np.linalg.lstsq(columns, found.smooth_residual()[inside], rcond=None)[0]

    gain = 1.0 / (1.0 + (math.tan(math.pi * hertz / rate) / math.tan(math.pi * cut / rate)) ** 4)
    expected = size * gain * (B - found.values["B_m"] * gain)
    assert (sine, cosine) == pytest.approx(
        (expected, 0.0), abs=1e-3 * size * k_i * k_e / R * gain * (1 - gain)
    )
    # On the fitted rows as well: passed twice, the back-EMF would make it 1.8 % too large.
    assert found.values["B_m"] == pytest.approx(B, rel=3e-3)
