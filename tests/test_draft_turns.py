"""Logs of turns, of a line once per turn, and of masses by run: the draft asks, and the answer fits."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError
from eccentric.logs import Log
from eccentric.rigs import read_rig
from eccentric.signals import read_channels

DECAY, COULOMB, START = 0.02, 0.5, 120.0  # w' = -(0.5 rad/s^2 + 0.02 w), from 120 rad/s
TURN = 2.0 * np.pi


def turns() -> np.ndarray:
    """Times [s] of the turns of a coasting wheel, by the closed form of its angle."""
    t = np.linspace(0.0, 60.0, 600_001)
    rest = COULOMB / DECAY
    angle = (START + rest) / DECAY * (1.0 - np.exp(-DECAY * t)) - rest * t
    return np.interp(TURN * np.arange(1, angle[-1] // TURN), angle, t)


def log_of(**columns: np.ndarray) -> Log:
    """A log of these columns."""
    return Log("log.csv", columns, len(next(iter(columns.values()))))


def mean_speeds(t: np.ndarray) -> Log:
    """The times of turns, and the speed of the last turn in rpm."""
    return log_of(time_s=t[1:], speed_rpm=np.round(60.0 / np.diff(t), 2))


def counted(t: np.ndarray) -> Log:
    """The times of turns in whole microseconds, and their count."""
    return log_of(time_us=np.round(1e6 * t), wheel_turns=np.arange(len(t), dtype=float))


def answered(text: str, *keys: str) -> str:
    """A drafted rig with some of its questions uncommented."""
    return re.sub(rf"^#\? ({'|'.join(keys)}) =", r"\1 =", text, flags=re.MULTILINE)


@pytest.mark.parametrize("log", [mean_speeds(turns()), counted(turns())], ids=["speeds", "counts"])
def test_times_of_turns_are_asked_about_and_fit(log: Log, tmp_path: Path) -> None:
    """With the answer, the deceleration is that of the closed form."""
    draft = eccentric.draft_rig(log)
    assert '#? events = "revolution"' in draft.text

    rig = tmp_path / "rig.toml"
    rig.write_text(answered(draft.text, "events", "M", "L").replace('#? case = "C2"', 'case = "C1"'))
    found = eccentric.fit(log, rig)

    assert found.estimates["C"].value == pytest.approx(COULOMB, rel=0.02)
    assert found.estimates["B"].value == pytest.approx(DECAY, rel=0.02)


def test_samples_of_the_same_wheel_are_not_asked_about() -> None:
    """Even samples of its count, and uneven samples of its speed, are no turns."""
    t, own = np.arange(0.0, 50.0, 0.05), turns()
    uneven = np.cumsum(np.random.default_rng(1).uniform(0.01, 0.1, 600))
    speed = (START + COULOMB / DECAY) * np.exp(-DECAY * uneven) - COULOMB / DECAY

    for log in (
        log_of(time_s=t, wheel_turns=np.searchsorted(own, t).astype(float)),
        log_of(time_s=uneven, speed_rad_s=speed),
    ):
        assert "events" not in eccentric.draft_rig(log).text


def test_times_alone_are_refused_with_the_key_and_checked_with_it() -> None:
    """Nothing shows what they are of; a rig that says so needs no other column."""
    log = log_of(time_s=turns())
    known = {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m"}
    rig = {"drive": "none", "events": "revolution", "columns": {"time": "time_s"}, "known": known}
    with pytest.raises(InputError, match=r'got the time alone; where each row .* events = "revolution"'):
        eccentric.draft_rig(log)
    assert () == eccentric.check_rig(log, rig).complaints


def motor(amplitude: float) -> Log:
    """A motor at 800 rpm, logged 3 % too fast in whole rpm, and its current with ripple once per turn."""
    rng, t = np.random.default_rng(3), np.arange(0.0, 6.0, 1e-3)
    speed = 824.0 + rng.normal(0.0, 0.7, len(t))
    current = 0.4 + amplitude * np.sin(TURN * 800.0 / 60.0 * t) + 0.05 * rng.standard_normal(len(t))
    return log_of(time_s=t, speed_rpm=np.round(speed), current_A=current)


def test_a_line_once_per_turn_is_asked_about_and_is_the_angle() -> None:
    """With the answer, the angle is that of the motor, whatever the speed says."""
    log = motor(0.05)
    draft = eccentric.draft_rig(log)
    assert "current_A repeats 1/turn, at 13.33 Hz" in " ".join(draft.text.replace("#", "").split())

    text = answered(draft.text, "angle", "M", "L", "k_i")
    channels = read_channels([log], read_rig(tomllib.loads(text)))
    inner = channels.motion.theta_m[500:-500]

    assert np.ptp(inner) == pytest.approx(TURN * 800.0 / 60.0 * (len(inner) - 1) * 1e-3, rel=1e-3)


def test_without_a_line_or_beside_an_angle_none_is_asked_about() -> None:
    """Noise has none, and a logged angle needs none."""
    log = motor(0.05)
    t = np.asarray(log.columns["time_s"])
    angle = log_of(**log.columns, angle_rad=TURN * 800.0 / 60.0 * t)

    assert '"line"' not in eccentric.draft_rig(motor(0.0)).text
    assert '"line"' not in eccentric.draft_rig(angle).text


def test_masses_by_run_are_asked_about_as_added() -> None:
    """The least mass is that of the link; what the other runs carry beside it are the answers."""
    bench = eccentric.bench([], case="C2", mu=0.2, log_type="traj", seconds=20.0, seed=5).log
    columns = {name: np.tile(np.asarray(values), 3) for name, values in bench.columns.items()}
    numbers = np.repeat([1.0, 2.0, 3.0], bench.rows)
    text = eccentric.draft_rig(
        log_of(**columns, run=numbers, **{"load [g]": 200.0 + 150.0 * (numbers - 1.0)})
    ).text

    assert ['#? "2" = "150 g"', '#? "3" = "300 g"'] == text.split("\n[added]\n")[1].splitlines()[1::2]
    rig = read_rig(tomllib.loads(answered(text, '"2"', '"3"', "M", "L", "M_l")))
    assert {"2": pytest.approx(0.15), "3": pytest.approx(0.3)} == rig.added_kg
