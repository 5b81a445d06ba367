"""What a log and a rig have to hold, and what is said where they do not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.signals import read_channels
from tests.logged import (
    MAPPED,
    RIG,
    STANDARD,
    T,
    channels_of,
    log_file,
    rig_file,
)


def test_rows_that_are_not_numbers_are_dropped_counted_and_warned_of(tmp_path: Path) -> None:
    """A tenth of missing currents is dropped with a warning; the rest is as before."""
    current = STANDARD["current_A"].copy()
    missing = np.arange(len(T)) % 10 == 3
    current[missing] = np.nan
    c = channels_of(tmp_path, STANDARD | {"current_A": current})
    assert c.counts["read"] == len(T)
    assert c.counts["rejected"] == np.count_nonzero(missing)
    np.testing.assert_array_equal(c.time.t, T[~missing])
    assert any(
        "no number in 300 of 3000 rows (first: line 5; most: 'current_A')" in w for w in c.intake.warnings
    )


def test_drive_is_what_is_logged_or_what_the_rig_says(tmp_path: Path) -> None:
    """Current goes before torque and voltage, unless the rig says otherwise."""
    assert channels_of(tmp_path, STANDARD).motor.measured_by == "current"
    assert channels_of(tmp_path, STANDARD, 'drive = "voltage"\n' + RIG).motor.measured_by == "voltage"
    with pytest.raises(
        InputError, match=r"drive: expected a channel with .* \(current, voltage\), got 'torque'"
    ):
        channels_of(tmp_path, STANDARD, 'drive = "torque"\n' + RIG)


def changed(**columns: object) -> dict[str, object]:
    """Return the standard log with other columns; None takes one out."""
    log = {**STANDARD, **columns}
    return {name: x for name, x in log.items() if x is not None}


THIRD = np.where(np.arange(len(T)) % 3 == 0, np.nan, STANDARD["current_A"])
TEXT = ["broken" if row % 4 == 0 else x for row, x in enumerate(STANDARD["current_A"], start=4)]
SPLIT = np.where((T > 3.0) & (T < 4.0), 1.0, 0.0)
BAD = {
    "no time": (changed(time_s=None), RIG, "expected a column for time (column 'time_s')"),
    "no angle": (changed(theta_m_rad=None), RIG, "a column for theta_m (column 'theta_m_rad') or theta_l"),
    "no drive": (
        changed(voltage_V=None, current_A=None),
        RIG,
        "a column for voltage (column 'voltage_V') or",
    ),
    "column": (
        changed(),
        RIG + MAPPED + 'current = "amps"\n',
        "expected column 'amps', but the log has time_s",
    ),
    "column with its unit": (
        changed(),
        RIG + MAPPED + 'current = "Current (A)"\n',
        "expected column 'Current (A)', but the log has time_s",
    ),
    "arithmetic": (
        changed(),
        RIG + MAPPED + 'current = "current_A ** 2"\n',
        "[columns] current: expected a column of the log, or arithmetic",
    ),
    "condition": (changed(), RIG + MAPPED + 'current = "current_A > 2"\n', "current: expected a number"),
    "text": (
        changed(current_A=TEXT),
        RIG,
        "line 2, column 'current_A': expected a number, got 'broken'",
    ),
    "third": (changed(current_A=THIRD), RIG, "no number in 1000 of 3000 rows"),
    "split": (changed(run=SPLIT), RIG, "expected contiguous runs, got '0' again"),
    "stuck": (changed(theta_m_rad=0.0 * T + 1.5), RIG, "expected an angle that changes, got 1.5 rad"),
    "slow": (changed(theta_m_rad=1e-9 * T), "moving_threshold_rad_s = 1\n" + RIG, "moving rows (above"),
    "nothing": (changed(current_A=np.nan * T), RIG, "log.csv: column 'current_A' (current) has no numbers"),
    "no current": (
        changed(current_A=0.0 * T),
        RIG,
        "expected a current that drives the motor, got 0 in all moving rows: it is not recorded",
    ),
    "no current held out": (
        changed(current_A=np.where(T < 4.0, 0.0, 1.0)),
        "holdout_intervals_s = [[1, 3]]\n" + RIG,
        "got 0 in all moving held-out rows (1 intervals from the rig file): hold out others",
    ),
    "at the end": (
        changed(),
        "holdout_intervals_s = [[0.0, 0.1]]\n" + RIG,
        "to fit and to hold out",
    ),
    "link": (
        changed(theta_m_rad=None, theta_l_rad=T),
        '[known]\ncase = "C2"\n',
        "expected [known] mu here",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_log_under_a_rig_is_refused_in_one_line(tmp_path: Path, name: str) -> None:
    """What cannot be fitted on is refused with file, row, column, what is required and what came."""
    log, rig, expected = BAD[name]
    with pytest.raises(InputError) as caught:
        channels_of(tmp_path, log, rig)  # pyright: ignore[reportArgumentType]
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_logs_with_different_channels_are_refused(tmp_path: Path) -> None:
    """Logs read together have the same channels."""
    first = log_file(tmp_path / "a.csv", STANDARD)
    second = log_file(tmp_path / "b.csv", STANDARD | {"temperature_C": T})
    with pytest.raises(
        InputError,
        match=r"b\.csv: expected the same channels in every log, got in some only: temperature",
    ):
        read_channels([first, second], rig_file(tmp_path))
