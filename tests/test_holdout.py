"""Which rows and runs are read, and which of them are held out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.signals import read_channels
from tests.logged import (
    PHASE,
    RIG,
    STANDARD,
    SWING,
    T,
    channels_of,
    log_file,
    rig_file,
)


def test_default_held_out_part_of_one_run(tmp_path: Path) -> None:
    """One run: five contiguous blocks of equal length, 20 % of the rows."""
    c = channels_of(tmp_path, STANDARD)
    begins = np.count_nonzero(np.diff(c.selection.held_out.astype(int)) == 1)
    assert (begins, len(c.selection.holdout.intervals_s)) == (5, 5)
    assert np.mean(c.selection.held_out) == pytest.approx(0.2, abs=5.0 / len(T))
    assert "five contiguous blocks" in c.selection.holdout.rule.replace("5 ", "five ")


def test_default_held_out_part_of_several_logs(tmp_path: Path) -> None:
    """Three runs or more: whole runs, the third of three; the rule names it."""
    paths = [log_file(tmp_path / f"log{k}.csv", STANDARD) for k in range(3)]
    c = read_channels(paths, rig_file(tmp_path))
    assert c.time.run_names == ("log0", "log1", "log2")
    np.testing.assert_array_equal(c.selection.held_out, c.time.run == 2)
    assert c.selection.holdout.rule.endswith("log2")


@pytest.mark.parametrize(("off", "first"), [({2}, "fourth"), ({2, 7}, "fourth"), ({2, 5}, "third")])
def test_the_default_holds_out_neither_all_nor_only_rows_with_the_motor_off(
    off: set[int], first: str, tmp_path: Path
) -> None:
    """Only rows with the motor off separate back-EMF and viscous friction; only driven ones are scored."""
    paths = [
        log_file(tmp_path / f"log{k}.csv", STANDARD | {"motor_off": np.full(len(T), float(k in off))})
        for k in range(8)
    ]
    c = read_channels(paths, rig_file(tmp_path))

    assert f"every fifth from the {first} on" in c.selection.holdout.rule
    assert np.any(c.motor.off & ~c.selection.held_out)


def test_named_runs_are_held_out(tmp_path: Path) -> None:
    """Runs that the rig names are held out; a name that the log has not is refused with those that it has."""
    log = {name: np.concatenate([x, x]) for name, x in STANDARD.items()} | {
        "run": np.repeat([1.0, 2.0], len(T))
    }
    c = channels_of(tmp_path, log, 'holdout_runs = ["1"]\n' + RIG)
    np.testing.assert_array_equal(c.selection.held_out, c.time.run == 0)
    with pytest.raises(InputError, match="holdout_runs: expected one of 1, 2, got '3'"):
        channels_of(tmp_path, log, 'holdout_runs = ["3"]\n' + RIG)


def test_the_default_moving_threshold_does_not_look_at_the_held_out_part(tmp_path: Path) -> None:
    """Where only held-out rows swing three times as fast, it stays 3 % of the others' upper end."""
    fast = (T >= 4.0) & (T <= 8.0)
    angle = 8.0 * np.sin(np.where(fast, 3.0, 1.0) * SWING * (T - 4.0) + PHASE)
    c = channels_of(tmp_path, STANDARD | {"theta_m_rad": angle}, "holdout_intervals_s = [[4.0, 8.0]]\n" + RIG)
    # The 95th percentile of |cos| is sin(0.95 pi/2).
    expected = 0.03 * 8.0 * SWING * math.sin(0.95 * math.pi / 2.0)
    assert c.selection.moving_threshold_rad_s == pytest.approx(expected, rel=1e-2)


def three_runs() -> dict[str, Sequence[object]]:
    """Three runs with names."""
    log: dict[str, Sequence[object]] = {n: np.concatenate([x] * 3).tolist() for n, x in STANDARD.items()}
    return log | {"run": np.repeat(["slow_1", "slow_2", "fast_1"], len(T)).tolist()}


def test_patterns_choose_the_runs_that_are_read_and_held_out(tmp_path: Path) -> None:
    """`runs` leaves out what no pattern means, `holdout_runs` holds out what one means."""
    log = log_file(tmp_path / "log.csv", three_runs())
    some = read_channels([log], rig_file(tmp_path, 'runs = ["slow_*"]\nholdout_runs = ["*_2"]\n' + RIG))
    assert some.time.run_names == ("slow_1", "slow_2")
    np.testing.assert_array_equal(some.selection.held_out, some.time.run == 1)
    assert some.counts["read"] == 2 * len(T)
    two = read_channels([log], rig_file(tmp_path, 'holdout_runs = ["?low_1", "fast_1"]\n' + RIG))
    np.testing.assert_array_equal(two.selection.held_out, two.time.run != 1)
    assert two.selection.holdout.rule == "runs from the rig file: slow_1, fast_1"


@pytest.mark.parametrize("key", ["runs", "holdout_runs"])
def test_a_pattern_that_no_run_has_is_refused_in_one_line(tmp_path: Path, key: str) -> None:
    """A pattern without a match is refused with the runs of the log."""
    log = log_file(tmp_path / "log.csv", three_runs())
    with pytest.raises(InputError) as caught:
        read_channels([log], rig_file(tmp_path, f'{key} = ["slow_*", "drive?_*"]\n' + RIG))
    message = str(caught.value)
    assert f"{key}: expected one of slow_1, slow_2, fast_1, got 'drive?_*'" in message
    assert "\n" not in message


def test_rows_by_condition(tmp_path: Path) -> None:
    """Rows that the condition `use` excludes are neither fitted nor scored, and not rejected."""
    c = channels_of(
        tmp_path,
        STANDARD,
        RIG + '[columns]\ntime = "time_s"\ntheta_m = "theta_m_rad"\n'
        'current = "current_A"\nuse = "time_s < 3 or time_s >= 5"\n',
    )
    everything = channels_of(tmp_path, STANDARD)
    np.testing.assert_array_equal(c.selection.usable, everything.selection.usable & ((T < 3.0) | (T >= 5.0)))
    assert c.counts["rejected"] == 0


def test_intervals_outside_of_the_log_are_refused_with_its_ends(tmp_path: Path) -> None:
    """What is held out has to be in the log: the line says where that begins and ends."""
    with pytest.raises(InputError) as caught:
        channels_of(tmp_path, STANDARD, "holdout_intervals_s = [[100, 120.5]]\n" + RIG)
    ends = f"expected an interval with rows of the log; the log goes from {T[0]:g} to {T[-1]:g} s"
    said = f"rig.toml: holdout_intervals_s: {ends}, got [100, 120.5]: is time in s, and the log complete?"
    assert str(caught.value).endswith(said)
