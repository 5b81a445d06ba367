"""Long logs are read in windows that say what the whole log says, and it is told what they miss."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError
from eccentric.logs import read_log, stream_log
from eccentric.rigs import Rig
from eccentric.signals import read_long
from eccentric.signals.limits import COLUMNS
from eccentric.signals.long_log import choose, solved
from eccentric.signals.long_survey import Cells, LogSurvey, Window, state_name, states_of, survey
from eccentric.signals.table import read_table
from tests.long_logs import COULOMB, RIG, VISCOUS, columns, parquet, plain, rig_of

Columns = dict[str, Any]


def surveyed(log: Columns, rig: Rig | None = None) -> LogSurvey:
    """One pass over a log."""
    return survey(stream_log(log), rig or rig_of(), "log", True, lambda _: None)


def chosen_times(log: Columns, rig: Rig, most: int) -> list[tuple[float, float]]:
    """Begin and end of the chosen windows [s]."""
    found = surveyed(log, rig)
    return [
        (found.windows[k].begin, found.windows[k].finish) for k in choose(found.windows, rig, most).places
    ]


@pytest.fixture(scope="module")
def long_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ten minutes at 200 Hz, 120,000 rows."""
    return parquet(tmp_path_factory.mktemp("long") / "long.parquet", columns(600.0, 200.0))


def test_a_fit_of_windows_finds_what_was_planted(long_log: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Coulomb and viscous friction are in their intervals; all rows are read, some used, and it says why.

    Who reads is told how far it is, in parts that grow to one.
    """
    monkeypatch.setattr("eccentric.logs.limits.BATCH_ROWS", 20_000)
    parts: list[float] = []
    found = eccentric.fit(long_log, RIG, reading=parts.append)
    rows = found.document["rows"]

    truth = {"C_m": COULOMB, "B_m": VISCOUS}
    for name, value in truth.items():
        low, high = found.estimates[name].interval
        assert low <= value <= high
        assert value == pytest.approx(found.estimates[name].value, rel=0.05)
    assert (120_000, 0) == (rows["read"], rows["rejected"])
    assert 0 < rows["held_out"] < rows["used"] < 120_000
    assert "would add nothing" in found.document["excerpt"]
    assert found.document["excerpt"] in found.summary()
    assert sorted(parts) == parts
    assert parts[-1] == 1.0
    assert len(parts) > 3


def test_runs_that_restart_their_time_are_counted_one_by_one() -> None:
    """Forty runs of 12 s, each from 0 s: a window of each, and as many seconds as were logged."""
    one = columns(12.0, 250.0)
    log = {name: np.tile(x, 40) for name, x in one.items()}
    log["run"] = np.repeat([f"run {k}" for k in range(40)], len(one["time_s"]))
    named = {name: name for name in ("time_s", "theta_m_rad", "torque_Nm")}
    channels = {"time": named["time_s"], "theta_m": named["theta_m_rad"], "torque": named["torque_Nm"]}

    (read,) = read_long([log], rig_of(columns=channels | {"run": "run"}))

    assert read.excerpt is not None
    used, left = divmod(read.rows, len(one["time_s"]))
    assert 0 == left
    size = f"{used} of 40 windows of 10 s are used ({used * 11.996:.4g} of {40 * 11.996:.5g} s)"
    assert read.excerpt.note.startswith(size)


def test_held_out_intervals_shorter_than_a_window_are_in_the_windows() -> None:
    """Three seconds of each minute: their rows are read, so that there is an error to report."""
    log = columns(600.0, 200.0)
    intervals = [(60.0 * k + 33.0, 60.0 * k + 36.0) for k in range(10)]
    (read,) = read_long([log], rig_of(holdout_intervals_s=intervals))
    t = read.columns["time_s"]

    held = [np.count_nonzero((t >= a) & (t <= b)) for a, b in intervals]
    assert sum(600 <= rows <= 601 for rows in held) >= 5
    assert eccentric.fit(log, RIG | {"holdout_intervals_s": intervals}).document["rows"]["held_out"] > 500


def test_a_log_of_fifty_thousand_rows_is_read_whole() -> None:
    """The same columns as `read_log` gives, and no word of windows."""
    log = columns(50.0)
    (read,) = read_long([log], rig_of())

    assert read.excerpt is None
    for name, values in read_log(log).columns.items():
        np.testing.assert_array_equal(values, read.columns[name], name)
    assert "excerpt" not in eccentric.fit(columns(50.0, 100.0), RIG).document


def test_windows_are_every_row_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """In order, within a run, ten seconds each; the short end of a run belongs to the window before."""
    log = columns(64.0, 200.0)
    log["run"] = np.where(log["time_s"] < 33.0, "a", "b")
    expected = [("a", 0), ("a", 2000), ("a", 4000), ("b", 6600), ("b", 8600), ("b", 10600), ("b", 12800)]
    for size in (131_072, 1777):
        monkeypatch.setattr("eccentric.logs.limits.BATCH_ROWS", size)
        windows = surveyed(log).windows
        edges = [(w.run, w.first) for w in windows] + [(windows[-1].run, windows[-1].end)]

        assert expected == edges
        assert all(w.end == after.first for w, after in pairwise(windows))


def test_the_sums_of_all_windows_give_the_planted_friction() -> None:
    """Least squares on the sums of the survey: friction that was planted, by no filter and no model."""
    sums = sum(w.sums for w in surveyed(columns(120.0)).windows)
    found = solved(np.asarray(sums))

    assert found[0] == pytest.approx(COULOMB, rel=0.05)
    assert found[1] == pytest.approx(VISCOUS, rel=0.1)


def test_windows_are_the_rows_of_the_log(long_log: Path) -> None:
    """Values and places are those in the file; a begin is where rows were left out before."""
    whole = read_log(long_log)
    (read,) = read_long([long_log], rig_of())
    assert read.numbered is not None
    assert read.excerpt is not None
    rows = read.numbered - 1

    assert {"time_s", "theta_m_rad", "torque_Nm"} == set(read.columns)
    for name, values in read.columns.items():
        np.testing.assert_array_equal(whole.columns[name][rows], values, name)
    np.testing.assert_array_equal(np.flatnonzero(np.diff(rows) > 1) + 1, read.excerpt.begins)
    assert (0, whole.rows - 1) == (rows[0], rows[-1])


def test_friction_that_changes_in_the_last_quarter_is_in_the_windows() -> None:
    """A quarter of the windows, within one, are from there."""

    def late(t: np.ndarray, omega: np.ndarray) -> np.ndarray:
        return plain(t, omega) * np.where(t > 900.0, 2.0, 1.0)

    times = chosen_times(columns(1200.0, 200.0, late), rig_of(), 24)
    share = sum(begin >= 900.0 for begin, _ in times) / len(times)

    assert 0.2 <= share <= 0.4


def test_one_run_of_many_that_differs_is_in_the_windows() -> None:
    """Fifty runs and room for twelve windows: the run with twice the friction is among them."""

    def odd(t: np.ndarray, omega: np.ndarray) -> np.ndarray:
        return plain(t, omega) * np.where((t >= 460.0) & (t < 480.0), 3.0, 1.0)

    log = columns(1000.0, 200.0, odd)
    log["run"] = np.floor(log["time_s"] / 20.0)
    found = surveyed(log)
    choice = choose(found.windows, rig_of(), 12)

    assert "23" in {found.windows[k].run for k in choice.places}
    assert 50 - len({found.windows[k].run for k in choice.places}) == choice.runs


def test_a_rare_state_is_in_the_windows() -> None:
    """Three seconds with the motor switched off, in twenty minutes: only they separate k_e from friction."""
    log = columns(1200.0, 200.0)
    log["motor_off"] = ((log["time_s"] >= 751.0) & (log["time_s"] < 754.0)).astype(float)
    times = chosen_times(log, rig_of(), 16)

    assert any(begin <= 751.0 <= finish for begin, finish in times)


def test_held_out_intervals_are_in_the_windows() -> None:
    """A fifth of them, also where the intervals are a hundredth of the log."""
    intervals = [[600.0, 621.0], [900.0, 921.0]]
    times = chosen_times(columns(1200.0, 200.0), rig_of(holdout_intervals_s=intervals), 16)

    assert 2 <= sum(any(a <= begin and finish <= b for a, b in intervals) for begin, finish in times)


def runs_chosen(log: Columns, rig: Rig, most: int) -> set[str]:
    """The runs of the chosen windows."""
    found = surveyed(log, rig)
    return {found.windows[k].run for k in choose(found.windows, rig, most).places}


def test_runs_that_the_rig_does_not_name_do_not_count() -> None:
    """Windows are of the runs that match its patterns."""
    log = columns(400.0, 200.0)
    log["run"] = np.floor(log["time_s"] / 20.0)

    assert all(run.startswith("1") for run in runs_chosen(log, rig_of(runs=["1*"]), 8))


def test_a_run_that_the_rig_holds_out_is_in_the_windows() -> None:
    """Whichever of sixty it is, where twelve windows are read."""
    log = columns(1200.0, 200.0)
    log["run"] = np.floor(log["time_s"] / 20.0)

    assert all(
        name in runs_chosen(log, rig_of(holdout_runs=[name]), 12) for name in ("3", "17", "32", "44", "58")
    )


def test_a_short_run_among_long_ones_is_in_the_windows() -> None:
    """Ten seconds of twenty minutes, a run of their own."""
    log = columns(1200.0, 200.0)
    t = log["time_s"]
    log["run"] = np.where(t < 512.0, "before", np.where(t < 522.0, "short", "after"))

    assert {"before", "short", "after"} == runs_chosen(log, rig_of(), 12)


def hard_windows() -> list[Window]:
    """Six hundred in ten runs, each with six of sixty states, every seventh with eight times the drive."""
    rng = np.random.default_rng(0)
    windows = []
    for k in range(600):
        x = rng.normal(size=(400, COLUMNS + 1))
        x[:, -1] *= 8.0 if k % 7 == 3 else 1.0
        window = Window(f"r{k // 60}", k, 1000 * k, 1000 * (k + 1), 10.0 * k, 10.0 * k + 9.99, 400, x.T @ x)
        window.seen.update({int(state): 60 for state in rng.integers(0, 60, 6)})
        windows.append(window)
    return windows


@pytest.mark.parametrize("most", [12, 20, 30])
def test_no_more_windows_are_chosen_than_may_be(most: int) -> None:
    """With runs, held-out runs and intervals, states and windows unlike others, which all want some."""
    windows = hard_windows()
    for more in ({}, {"holdout_intervals_s": [[0.0, 1000.0], [3000.0, 6000.0]]}, {"holdout_runs": ["r*"]}):
        chosen = choose(windows, rig_of(**more), most).places

        assert most // 2 < len(chosen) <= most
        assert {0, 599} <= set(chosen)


@pytest.mark.parametrize("rates", [(1000.0, 400.0), (200.0, 2000.0)])
def test_a_run_at_another_rate_counts_like_the_first(rates: tuple[float, float]) -> None:
    """Its sums give the friction planted in it, and a minute of it has as many cells as one of the first."""

    def more(t: np.ndarray, omega: np.ndarray) -> np.ndarray:
        return 3.0 * plain(t, omega)

    one, two = columns(60.0, rates[0]), columns(60.0, rates[1], more)
    log: Columns = {name: np.concatenate([one[name], two[name]]) for name in one}
    log["run"] = np.repeat(["one", "two"], [len(one["time_s"]), len(two["time_s"])])
    found = surveyed(log)
    sums = {run: sum(w.sums for w in found.windows if w.run == run) for run in ("one", "two")}
    cells = {run: sum(w.cells for w in found.windows if w.run == run) for run in ("one", "two")}

    assert solved(np.asarray(sums["one"]))[0] == pytest.approx(COULOMB, rel=0.05)
    assert solved(np.asarray(sums["two"]))[0] == pytest.approx(3.0 * COULOMB, rel=0.05)
    assert cells["two"] == pytest.approx(cells["one"], rel=0.02)
    assert all(w.assessed for w in found.windows)


def test_windows_that_cannot_be_assessed_are_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the last run rows come in pairs with gaps between them: there is no cell, and a warning says so."""
    monkeypatch.setattr("eccentric.signals.limits.LONG_ROWS", 10_000)
    log: Columns = columns(200.0, 200.0)
    t = log["time_s"]
    paired = np.arange(len(t)) % 20 < 2
    kept = (t < 150.0) | paired
    log = {name: x[kept] for name, x in log.items()}
    log["run"] = np.where(log["time_s"] < 150.0, "even", "paired")
    (read,) = read_long([log], rig_of())
    assert read.excerpt is not None

    assert "5 windows could not be assessed" in read.excerpt.missed
    assert "150 to 159.91 s" in read.excerpt.missed


def test_what_the_windows_miss_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fifty runs that all differ, of which few are read: runs, and windows unlike the others, are named."""

    def all_differ(t: np.ndarray, omega: np.ndarray) -> np.ndarray:
        return plain(t, omega) * np.where(np.floor(t / 20.0) % 7 == 3, 8.0, 1.0)

    log = columns(1000.0, 200.0, all_differ)
    log["run"] = np.floor(log["time_s"] / 20.0)
    monkeypatch.setattr("eccentric.signals.limits.LONG_ROWS", 10_000)
    (read,) = read_long([log], rig_of(), points=2000)
    assert read.excerpt is not None

    assert "no more are read" in read.excerpt.note
    assert "runs" in read.excerpt.missed
    table = read_table([read], rig_of())
    assert [("excerpt", "note"), ("not_chosen", "warning")] == [(f.kind, f.severity) for f in table.findings]


def bad(change: str) -> Columns:
    """A log of 120,000 rows, wrong in row 100,001."""
    log, row = columns(120.0), 100_000
    if change == "again":
        log["time_s"][row:] -= log["time_s"][row] - 1e-3
    elif change == "run":
        log["run"] = np.where(
            np.arange(120_000) == row, "first", np.where(log["time_s"] < 50.0, "first", "b")
        )
    elif change == "size":
        log["torque_Nm"] *= 1e30
    elif change == "numbers":
        log["torque_Nm"][::4] = np.nan
    return log


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("again", r"time starts again at row 100001: each recording is a run.* run = \.\.\. in \[columns\]"),
        ("run", "row 100001: expected contiguous runs, got 'first' again"),
        ("size", r"row \d+, column 'torque_Nm' \(torque\): expected at most 1e\+12 N m"),
        ("numbers", r"no number in 30000 of 120000 rows \(first: row 1\); at most 20 % may be missing"),
    ],
)
def test_a_bad_row_deep_in_a_long_log_is_named(change: str, said: str) -> None:
    """As in a log that is read whole."""
    with pytest.raises(InputError, match=said):
        read_long([bad(change)], rig_of())


def spoilt(kind: str) -> Columns:
    """A log of 120,000 rows of which some do not count."""
    log = columns(120.0)
    torque = log["torque_Nm"]
    if kind == "a clock that falls back and a torque beyond any sensor's":
        log["time_s"][50_000] -= 0.5
        torque[70_000] = 1e30
    elif kind == "a text":
        log["torque_Nm"] = torque.astype(str)
        log["torque_Nm"][100_000] = "off"
    else:
        torque[50_000:50_100] = np.nan
        log = {name: np.insert(x, 70_000, x[69_999]) for name, x in log.items()}
    return log


@pytest.mark.parametrize(
    ("kind", "rows", "rejected"),
    [
        ("a clock that falls back and a torque beyond any sensor's", 120_000, 2),
        ("a text", 120_000, 1),
        ("a hundred rows without torque, and one written twice", 120_001, 101),
    ],
)
def test_rows_that_do_not_count_are_counted_in_the_whole_log(kind: str, rows: int, rejected: int) -> None:
    """As in a log that is read whole, wherever the windows are."""
    (read,) = read_long([spoilt(kind)], rig_of())

    assert (rows, rejected) == (read.excerpt and read.excerpt.rows, read.excerpt and read.excerpt.rejected)


def test_cells_have_states_where_they_move() -> None:
    """A cell at rest has none; another way is another state; each state is named by its kind."""
    t = np.array([1.0, 1.0, -1.0, 1.0])
    cells = Cells(0.04 * np.ones(4), 5.0 * t, t, t, None, None, np.ones(4, dtype=bool))
    moving = np.array([True, True, True, False])
    found = states_of(cells, moving, np.zeros(4, dtype=bool), (1.0, 1.0, 1.0))

    assert [-1] * 4 == [state[3] for state in found]
    assert [True] * 4 == [bool(state[0] == state[1] != state[2]) for state in found]
    assert ["speed", "drive", "acceleration", "speed and drive"] == [state_name(s[0]) for s in found]
    assert ["speed", "drive", "acceleration", "speed and drive"] == [state_name(s[2]) for s in found]
