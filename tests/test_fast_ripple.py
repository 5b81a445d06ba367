"""A ripple near the Nyquist frequency: its product with a measured current has twice that frequency."""

from __future__ import annotations

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


@pytest.mark.parametrize("seed", [7, 8])
def test_the_true_model_leaves_nothing_of_the_circuit_below_the_low_pass(seed: int) -> None:
    """Without noise, all that is left is ripple above it, which the filtered speed lacks."""
    _, found = refitted(seed, noise=0.0)
    held_out = found.data.rows.score
    left = rms(found.smooth_residual("electrical")[held_out])

    assert left < 0.1 * rms(found.residuals["electrical"][held_out])


def test_the_back_emf_in_a_torque_from_the_voltage_passes_the_low_pass_once() -> None:
    """Below it: what is left of (k_i/R) u less friction, then k_i k_e/R omega and J alpha as they are."""
    run = simulate(drawn_scenario(7, effects=EFFECTS[:1], case="C1", mu=1.0 / 30.0, seconds=40.0, noise=0.0))
    channels = read_channels([read_log(run.columns)], read_rig(run.rig | {"drive": "voltage"}))
    stage = stage_of(channels, load_model(channels.rig.model), None, "log")
    found = refit(stage.base, (), stage.data)
    R, k_i, k_e = (channels.rig.value(name) for name in ("R", "k_i", "k_e"))
    motion = found.data.drive.channels.motion
    moving = found.values["J_m"] + channels.rig.value("mu") ** 2 * found.values["J_l"]
    filtered = moving * motion.alpha_m + k_i * k_e / R * motion.omega_m

    expected = channels.smooth(found.residuals["mechanical"] + filtered) - filtered
    assert found.smooth_residual() == pytest.approx(expected, abs=1e-9 * rms(filtered))
