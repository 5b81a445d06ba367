"""Hidden states along a log: skipping samples that change nothing loses none that do."""

import numpy as np
import pytest

from eccentric.identification import Signals
from eccentric.identification.expressions import state_series
from eccentric.model import load_model
from tests.extended import KNOWN, W_MAX, effects

DT, GAP = 0.01, 0.4  # s, rad


def left_open(omega: np.ndarray) -> list[float]:
    """Return what is left of the gap by its definition: opened by a change of side, closed by the motor.

    A drive stands below a hundredth of the top speed.
    """
    side, left, found = 0.0, 0.0, []
    for w in omega:
        found.append(left)
        now = np.sign(w) if abs(w) > 0.01 * W_MAX else 0.0
        changed = 1.0 if now * side < 0.0 else 0.0
        left = max(0.0, abs(changed - left) - abs(w) * DT / GAP)
        side = now or side
    return found


def test_a_gap_opens_and_closes_as_it_is_defined() -> None:
    """Two runs of swings with rests; the gap closes, is left open at a rest, and opens again half closed."""
    t = DT * np.arange(3000)
    omega = np.where(np.sin(0.7 * t) > 0.9, 0.0, 12.0 * np.sin(2.1 * t) * np.sin(0.4 * t))
    start = 1234  # of the second run, where the side is not known yet
    values = {name: np.zeros_like(t) for name in ("theta_m", "alpha_m", "i", "u")} | {
        "omega_m": omega,
        "t": t,
    }
    model = effects("C1")["backlash"].extend(load_model("c1_perpendicular"))
    signals = Signals(values, np.full_like(t, DT), (0, start), KNOWN)

    actual = state_series(model, signals, {"backlash_gap": GAP})["backlash_left"]
    expected = [*left_open(omega[:start]), *left_open(omega[start:])]

    assert expected == pytest.approx(actual, rel=1e-12, abs=1e-14)
    opened = np.count_nonzero((actual[1:] > 0.0) & (actual[:-1] == 0.0))
    assert opened > 10
    assert 0.2 < np.mean(actual == 0.0) < 0.9


def test_noise_of_a_standing_drive_opens_no_gap() -> None:
    """A speed of random sign before the first motion, small beside the top speed, decides on no side."""
    noise = 0.002 * W_MAX * np.random.default_rng(1).standard_normal(300)
    omega = np.r_[noise, np.full(300, 0.2 * W_MAX), noise, np.full(300, -0.2 * W_MAX)]
    values = {name: np.zeros_like(omega) for name in ("theta_m", "alpha_m", "i", "u", "t")}
    signals = Signals({**values, "omega_m": omega}, np.full_like(omega, DT), (0,), KNOWN)
    model = effects("C1")["backlash"].extend(load_model("c1_perpendicular"))

    left = state_series(model, signals, {"backlash_gap": GAP})["backlash_left"]

    assert not np.any(left[:901])
    assert left[901] > 0.5
