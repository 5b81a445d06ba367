"""`--check`, `fit` and `diagnose` share their limits; R and k_e are held against the circuit of the log."""

from __future__ import annotations

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError

KNOWN = {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m"}


def motor(seconds: float, step: float = 2e-3, hertz: float = 2.0) -> dict[str, np.ndarray]:
    """A bare motor on a sine that swells, the current with noise: R 0.9 ohm, k_e = k_i = 0.03 V s/rad."""
    t = np.arange(0.0, seconds, step)
    swell = 0.6 + 0.4 * np.sin(0.6 * t)
    angle = -9.0 * swell * np.cos(2.0 * np.pi * hertz * t) / hertz
    speed, rise = np.gradient(angle, step), np.gradient(np.gradient(angle, step), step)
    noise = np.random.default_rng(4).normal(0.0, 5e-3, len(t))
    current = (2e-5 * rise + 8e-3 * np.tanh(speed / 2.0) + 2e-5 * speed) / 0.03 + noise
    return {
        "time_s": t,
        "theta_m_rad": angle,
        "current_A": current,
        "voltage_V": 0.9 * current + 0.03 * speed,
    }


@pytest.mark.parametrize(
    ("R", "k_e", "doubted"),
    [
        (0.9, 0.03, set()),
        (9.0, 0.03, {"R"}),
        (0.9, 0.1, {"k_e"}),
        (0.6, 0.1, {"R", "k_e"}),
        (0.8, 0.03, set()),
    ],
)
def test_a_resistance_and_a_back_emf_that_the_circuit_contradicts_are_doubted(
    R: float, k_e: float, doubted: set[str]
) -> None:
    """Also where every swing is too short for moving blocks; an eighth is a winding that is warm."""
    rig = {
        "drive": "current",
        "known": {**KNOWN, "R": f"{R} ohm", "k_e": f"{k_e} V s/rad", "k_i": "0.03 N m/A"},
    }
    said = eccentric.check_rig(motor(12.0), rig)
    found = {letter for letter in ("R", "k_e") for line in said.doubts if f" {letter} is " in line}

    assert said.complaints == ()
    assert found == doubted


def test_too_few_averages_are_refused_by_all_three_alike() -> None:
    """What a fit cannot determine, a diagnosis has no proof of."""
    log = {name: x for name, x in motor(8.0, 5e-3, 0.5).items() if name != "voltage_V"}
    held = {"holdout_intervals_s": [[1.0, 4.0]], "average_over": "0.3 s"}
    rig = {"drive": "current", **held, "known": {**KNOWN, "k_i": "0.03 N m/A"}}
    messages = [str(line) for line in eccentric.check_rig(log, rig).complaints]
    for command in (eccentric.fit, eccentric.diagnose):
        with pytest.raises(InputError) as refused:
            command(log, rig)
        messages.append(str(refused.value))

    assert len(messages) == 3
    assert len({message.partition("expected ")[0] for message in messages}) == 1
    assert "moving averages over 0.3 s to fit" in messages[0]
