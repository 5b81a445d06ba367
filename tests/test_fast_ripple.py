"""A ripple near the Nyquist frequency: its product with a measured current has twice that frequency."""

from __future__ import annotations

import math

import numpy as np

from eccentric.diagnosis.stage import stage_of
from eccentric.logs import read_log
from eccentric.model import load_model
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from eccentric.virtual_bench import simulate
from tests.virtual import drawn_scenario

ORDER, RIPPLE_A = 6, 1.0


def test_the_ripple_of_the_current_makes_no_slow_torque() -> None:
    """Sampled at 2 n omega, cos^2(n theta) stands still; half of it is at 2 n omega in the drive.

    Seed 3 has a run at 130 rad/s, 6 periods a turn at 124 Hz, sampled at 250 Hz. The current is given a
    ripple there, in quadrature with that of the torque constant, as inertia makes it: its mean power is none.
    """
    run = simulate(drawn_scenario(3, case="C1", mu=1.0 / 30.0, seconds=40.0))
    t, theta = np.asarray(run.columns["time_s"]), np.asarray(run.columns["theta_m_rad"])
    run.columns["current_A"] = RIPPLE_A * np.sin(ORDER * theta)
    channels = read_channels([read_log(run.columns)], read_rig(run.rig))
    stage = stage_of(channels, load_model(channels.rig.model), None, "log")
    (effect,) = [e for e in stage.offered if e.id == f"kt_ripple[n={ORDER}]"]
    (candidate,) = stage.candidates([effect])
    rows = stage.data.rows
    speed = rows.mean(np.gradient(theta, t))
    twice = np.abs(2.0 * ORDER * np.abs(speed) / (2.0 * math.pi) - 250.0)

    torque = rows.mean(candidate.in_the("mechanical").columns({}))[twice < 10.0]

    assert len(torque) > 20
    assert np.sqrt(np.mean(torque**2)) < 0.02 * run.rig["known"]["k_i_Nm_per_A"] * RIPPLE_A / 2.0
