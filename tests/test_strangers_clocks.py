"""Clocks and runs as strangers log them: packets, restarts, reversed, damaged, no time, short runs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric import cli
from eccentric.core import InputError
from eccentric.logs import mended
from eccentric.rigs import read_arm_rig, read_rig
from eccentric.signals import Table, read_channels, read_joints, read_table
from tests.arm_logs import arm_log_of, arm_rig_of, plain, planar_arm

RATE = 500.0
T = np.arange(6000) / RATE
THETA = 4.0 * np.sin(1.5 * T)
"""An angle at 500 rows a second."""
OMEGA = 6.0 * np.cos(1.5 * T)
CURRENT = 0.3 * np.sign(OMEGA) + 0.05 * OMEGA - 0.01 * 9.0 * np.sin(1.5 * T)
"""Of Coulomb friction 0.03 N m, viscous 0.005 N m s/rad and an inertia of 0.001 kg m^2 at 0.1 N m/A."""
KNOWN = {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m", "k_i": "0.1 N m/A"}
COLUMNS = {"time": "t", "theta_m": "theta", "current": "i"}

Columns = Mapping[str, np.ndarray]


def columns(**changed: np.ndarray) -> dict[str, np.ndarray]:
    """The log, some of its columns changed."""
    return {"t": T, "theta": THETA, "i": CURRENT} | changed


def rig_of(**keys: object) -> dict[str, object]:
    """The rig of the log, with more keys."""
    return {"drive": "current", "columns": COLUMNS, "known": KNOWN} | keys


def table_of(log: Columns, **keys: object) -> Table:
    """The table of a log."""
    return read_table([dict(log)], read_rig(rig_of(**keys)))


def kinds(table: Table) -> dict[str, int]:
    """The findings of a table: kind -> rows."""
    return {finding.kind: finding.rows for finding in table.findings}


def same(table: Table, **channels: np.ndarray) -> None:
    """Compare channels of a table."""
    for name, values in channels.items():
        np.testing.assert_allclose(table.channels[name], values, rtol=0, atol=1e-9)


@pytest.mark.parametrize("size", [2, 8, 25])
def test_rows_that_share_a_stamp_are_spread(size: int) -> None:
    """Packets of equal size: the clock is that of the rows, and the warning has their size and duration."""
    table = table_of(columns(t=T[np.arange(len(T)) // size * size]))

    same(table, time=T)
    assert {"packets": len(T)} == kinds(table)
    assert (
        f"groups of {size} rows share one time stamp (packets of {size / RATE:.3g} s)"
        in table.findings[0].text
    )


def test_a_row_that_slips_into_the_next_packet_keeps_its_time() -> None:
    """Packets of 7 and 9 among those of 8, as a transmission that waits makes them."""
    place = np.arange(len(T)) // 8
    late = np.arange(len(T)) % 80 == 7
    table = table_of(columns(t=T[(place + late) * 8 - 8 * ((place + late) * 8 >= len(T))]))

    # Which of a packet's rows bears its stamp is not to be known: one time for all is free.
    moved = table.channels["time"] - T
    np.testing.assert_allclose(moved, moved[0], atol=0.1 / RATE)


def test_packets_with_a_gap_between_them() -> None:
    """What is lost between two packets is not spread over the rows before it."""
    gap = np.where(T >= 6.0, 1.5, 0.0)
    table = table_of(columns(t=(T + gap)[np.arange(len(T)) // 8 * 8]))

    same(table, time=T + gap)


def test_time_that_starts_again_makes_runs() -> None:
    """Two recordings in one file are two runs, each with its own time; a run column has the same effect."""
    t = np.where(T < 5.0, T, T - 5.0)
    table = table_of(columns(t=t))
    named = table_of(columns(t=t, run=np.where(T < 5.0, "a", "b")), columns=COLUMNS | {"run": "run"})

    assert ("table#1", "table#2") == table.run_names
    np.testing.assert_array_equal(named.run, table.run)
    assert {"restart": 1} == kinds(table)
    assert "time starts again at row 2501" in table.findings[0].text
    assert {} == kinds(named)


def test_a_log_whose_newest_row_is_the_first() -> None:
    """It is the same log, read from its end."""
    table = table_of({name: x[::-1] for name, x in columns().items()})

    same(table, time=T, theta_m=THETA, current=CURRENT)
    assert {"reversed": len(T)} == kinds(table)


DAMAGED = {
    "a time from far away": (np.where(T == T[100], 1e154, T), [100]),
    "a time that falls back": (np.where(T == T[100], T[40], T), [100]),
    "three times from later": (np.where((T >= T[100]) & (T < T[103]), T + 3.0, T), [100, 101, 102]),
    "a stamp that two rows share": (np.where(T == T[100], T[99], T), [100]),
    "a first row of another recording": (np.where(T == 0.0, 80.0, T), [0]),
    "a first row from long before": (np.where(T == 0.0, -5000.0, T), [0]),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_rows_are_dropped_and_counted(name: str) -> None:
    """A few rows whose time cannot be are dropped, and the first of them is named."""
    t, lost = DAMAGED[name]
    table = table_of(columns(t=t))
    kept = np.delete(np.arange(len(T)), lost)

    same(table, time=T[kept], theta_m=THETA[kept])
    assert (len(T), len(lost)) == (table.rows_read, table.rows_rejected)
    assert [len(lost)] == list(kinds(table).values())
    assert f"(first: row {lost[0] + 1}" in table.findings[0].text


def test_a_frozen_tail_is_dropped() -> None:
    """A logger that goes on with its last values; a drive that comes to rest is no such thing."""
    last = np.minimum(np.arange(len(T)), 5499)
    noise = np.random.default_rng(0).normal(0.0, 1e-3, len(T))
    frozen = table_of(columns(theta=THETA[last], i=(CURRENT + noise)[last]))
    rest = table_of(columns(theta=THETA[last]))

    same(frozen, time=T[:5500])
    assert {"frozen_tail": 500} == kinds(frozen)
    assert (
        "500 rows at the end of a run repeat the one before in every channel (first: row 5501)"
        in frozen.findings[0].text
    )
    assert {} == kinds(rest)


def test_a_source_that_is_polled_too_often_counts_once() -> None:
    """Rows that repeat a sample say nothing new; at rest a row is kept in the time of a usual sample."""
    rng = np.random.default_rng(3)
    fresh = np.cumsum(rng.integers(2, 8, 1500))
    last = fresh[np.searchsorted(fresh, np.arange(fresh[0], len(T)), side="right") - 1]
    t = T[fresh[0] :]
    moving = last < 5000
    at = np.where(moving, last, 5000)
    found = table_of(columns(t=t, theta=THETA[at], i=CURRENT[at]))

    new = np.isin(np.arange(fresh[0], len(T)), fresh) & moving
    assert np.isin(t[new], found.channels["time"]).all()
    assert np.count_nonzero(found.channels["time"] < T[fresh[fresh < 5000][-1]]) == np.count_nonzero(new) - 1
    rest = found.channels["time"][found.channels["time"] > T[5010]]
    assert 0.7 < len(rest) * np.median(np.diff(fresh)) / 990.0 < 1.3
    assert ["polled"] == list(kinds(found))


def test_coarse_steps_of_two_sensors_are_no_repeats() -> None:
    """An encoder and a current with coarse digits change in few of the rows, and not together."""
    coarse = table_of(columns(theta=np.round(THETA, 1), i=np.round(CURRENT, 2)))
    assert len(T) == len(coarse.channels["time"])


def test_runs_that_the_rig_does_not_name_do_not_count() -> None:
    """Neither their damaged rows, nor text, nor time that stands still."""
    run = np.where(T < 6.0, "good", "bad")
    spoilt = columns(t=np.where(run == "bad", 1e154, T), i=np.where(run == "bad", np.nan, CURRENT), run=run)
    table = table_of(spoilt, columns=COLUMNS | {"run": "run"}, runs=["good"])

    same(table, time=T[T < 6.0], current=CURRENT[T < 6.0])
    assert ({}, 0, ("good",)) == (kinds(table), table.rows_rejected, table.run_names)
    with pytest.raises(InputError, match=r"column 't' .time.: expected at most 1e.12 s"):
        table_of(spoilt, columns=COLUMNS | {"run": "run"})
    with pytest.raises(InputError, match="runs: expected one of good, bad, got 'other'"):
        table_of(spoilt, columns=COLUMNS | {"run": "run"}, runs=["other"])


def test_the_rate_is_the_clock_where_no_column_is() -> None:
    """The same channels as with a column of time; without the rate, the message says how it is written."""
    without = {name: x for name, x in columns().items() if name != "t"}
    mapped = {name: column for name, column in COLUMNS.items() if name != "time"}
    table = table_of(without, columns=mapped, sample_rate_hz=RATE)

    same(table, time=T, theta_m=THETA)
    assert {"by_rate": len(T)} == kinds(table)
    with pytest.raises(
        InputError, match=r"expected a column for time .*; .* as in sample_rate_hz = 500; the"
    ):
        table_of(without, columns=mapped)


def test_the_draft_of_a_log_without_a_time(tmp_path: Path) -> None:
    """It is refused with what gives the rate; with it, the draft has the rate, and is a rig that fits."""
    path = tmp_path / "log.csv"
    content = np.column_stack([THETA, OMEGA, CURRENT])
    np.savetxt(
        path, content, delimiter=",", header="angle_rad,speed_rad_s,current_A", comments="", fmt="%.6f"
    )
    with pytest.raises(
        InputError, match=r"rises from row to row, the time, .*\(angle_rad, speed_rad_s, .*--rate 500 .sample"
    ):
        eccentric.draft_rig(path)
    assert 0 == cli.main(["rig", str(path), "--rate", "500", "--out", str(tmp_path / "rig.toml")])
    text = (tmp_path / "rig.toml").read_text(encoding="utf-8")

    assert "\nsample_rate_hz = 500\n" in text
    assert "\ntime = " not in text
    for asked, value in (("M = ", '"0 kg"'), ("L = ", '"0 m"'), ("k_i = ", '"0.1 N m/A"')):
        text = "\n".join(asked + value if f"#? {asked}" in line else line for line in text.split("\n"))
    (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    assert () == eccentric.check_rig(path, tmp_path / "rig.toml").complaints
    estimate = eccentric.fit(path, rig=tmp_path / "rig.toml").estimates["C"]
    assert abs(estimate.value / 0.03 - 1.0) < 0.05


def drafted(**clock: np.ndarray) -> eccentric.RigDraft:
    """The draft of a log with these columns as its clock."""
    return eccentric.draft_rig({**clock, "angle_rad": THETA, "speed_rad_s": OMEGA, "current_A": CURRENT})


@pytest.mark.parametrize(
    ("whole", "beyond"),
    [("stamp.sec", "stamp.nanosec"), ("time_sec", "time_nsec"), ("header.stamp.secs", "header.stamp.nsecs")],
)
def test_a_stamp_in_seconds_and_nanoseconds(whole: str, beyond: str) -> None:
    """As ROS and robot controllers write it: the time is their sum, and a rig file takes it so."""
    t = 1.7e9 + 0.3 + T
    draft = drafted(**{whole: np.floor(t), beyond: np.round((t % 1.0) * 1e9)})

    (time,) = [p for p in draft.proposals if p.channel == "time"]
    assert time.unit == "s"
    assert time.doubt == ""
    assert time.column.replace("`", "") == f"{whole} + {beyond} / 1000000000"


def test_a_rate_beside_a_time_is_refused() -> None:
    """One of the two would be wrong."""
    columns = {"Zeit [ms]": 1e3 * T, "angle_rad": THETA, "speed_rad_s": OMEGA, "current_A": CURRENT}

    with pytest.raises(InputError, match=r"a log without a column of time with a rate, got 'Zeit \[ms\]'"):
        eccentric.draft_rig(columns, rate_hz=50.0)


def test_a_date_names_no_run() -> None:
    """Midnight is in the middle of a log as any other time."""
    date = np.where(np.arange(len(T)) < len(T) // 2, "03.05.2022", "04.05.2022")

    assert "run" not in {p.channel for p in drafted(time_s=T, Datum=date).proposals}


@pytest.mark.parametrize("rate", [0.0, -1.0, float("nan")])
def test_a_rate_is_a_number_above_0(rate: float) -> None:
    """Anything else is refused."""
    with pytest.raises(InputError, match="rate: expected a number of rows per second above 0"):
        eccentric.draft_rig(columns(), rate_hz=rate)


CLOCKS = {
    "packets": (T[np.arange(len(T)) // 8 * 8], "groups of 8 rows share one stamp and are spread evenly"),
    "restart": (np.where(T < 5.0, T, T - 5.0), "time starts again in row 2501: each recording is a run"),
    "damage": (np.where(T == T[100], T[40], T), "the time of row 101 is out of order"),
}


@pytest.mark.parametrize("name", CLOCKS)
def test_the_draft_says_what_is_odd_about_the_clock(name: str) -> None:
    """As a doubt of the line of the time."""
    t, said = CLOCKS[name]
    draft = eccentric.draft_rig({"time_s": t, "angle_rad": THETA, "speed_rad_s": OMEGA, "current_A": CURRENT})

    assert any(said in doubt for doubt in draft.doubts)
    assert "time_s" == next(p.column for p in draft.proposals if p.channel == "time")


def test_short_records_keep_their_middle() -> None:
    """Of a record of less than two seconds a quarter is left out at either end, of others half a second."""
    for seconds, ends in ((0.8, 0.2), (1.6, 0.4), (6.0, 0.5)):
        rows = T <= seconds
        rig = read_rig(
            rig_of(
                moving_threshold_rad_s=0.01,
                holdout_intervals_s=[[0.4 * seconds, 0.6 * seconds]],
                low_pass_hz=25,
            )
        )
        log = {name: x[rows] for name, x in columns(theta=2.0 * T + 0.5 * T**2, i=CURRENT + 1.0).items()}
        channels = read_channels([log], rig)
        used = channels.time.t[channels.selection.usable]

        np.testing.assert_allclose([ends, seconds - ends], [used[0], used[-1]], atol=3.0 / RATE)


def test_a_default_threshold_is_named_before_the_units() -> None:
    """A coarse encoder: the message has the default and the key, and the value that it proposes works."""
    step = np.radians(2.0)
    log = columns(theta=step * np.round(THETA / 4.0 / step), i=CURRENT)
    with pytest.raises(
        InputError, match=r"the threshold is a default, 10 steps of 0\.0349 rad in 40 ms"
    ) as caught:
        read_channels([log], read_rig(rig_of()))
    said = str(caught.value)
    value = float(said.rsplit("moving_threshold_rad_s = ", 1)[1])

    assert "units" not in said
    assert np.count_nonzero(
        read_channels([log], read_rig(rig_of(moving_threshold_rad_s=value))).selection.usable
    )


def test_runs_without_a_row_are_listed() -> None:
    """Runs in which nothing moves contribute nothing, and the warning names them."""
    run = (T // 2.0).astype(int)
    log = columns(t=T - 2.0 * run, theta=np.where(run == 3, 1.0, THETA), run=run.astype(float))
    channels = read_channels([log], read_rig(rig_of(columns=COLUMNS | {"run": "run"})))

    assert [True] == [
        warning == "no row of 1 run of 6 is used, too short or too slow: 3"
        for warning in channels.intake.warnings
        if warning.startswith("no row of")
    ]


def test_a_time_that_stands_still_is_refused() -> None:
    """One stamp for all rows says nothing of their order in time."""
    with pytest.raises(InputError, match="row 2: time stamps must increase, got 1 s after 1 s"):
        table_of(columns(t=np.ones(len(T))))


def test_a_clock_that_is_right_is_left_alone() -> None:
    """Bit by bit, with uneven steps and gaps."""
    rng = np.random.default_rng(1)
    t = np.cumsum(rng.uniform(1e-3, 3e-3, 1000))
    t[500:] += 20.0
    found = mended(t)

    assert found.t is t
    assert (True, 0, (0, 0.0)) == (bool(found.kept.all()), int(found.part.max()), found.packet)


def test_a_run_that_the_rig_of_an_arm_does_not_name_does_not_count() -> None:
    """A time of 1e154 in it stops nothing; a torque of 1e30 in a row that counts takes this row alone."""
    log = arm_log_of(plain, runs=4, seconds=6.0)
    out, rows = log["run"] == "run_1", int(np.count_nonzero(log["run"] == "run_0"))
    log["t_s"] = np.where(out, 1e154, log["t_s"])
    log["tau_Nm_2"][500] = 1e30
    rig = read_arm_rig(arm_rig_of(planar_arm(), runs=["run_0", "run_2", "run_3"]))
    found = read_joints([log], rig)

    for channels in found:
        assert ("run_0", "run_2", "run_3") == channels.time.run_names
        assert 3 * rows - 1 == len(channels.time.t)


def test_windows_that_are_too_long_by_default_are_named_with_what_gives_more() -> None:
    """A short log at 40 rows a second: the message has the default and the key, and its value works."""
    rows = slice(0, 3600, 12)
    noise = np.random.default_rng(2).normal(0.0, 1e-3, 300)
    log = {"t": T[rows], "theta": THETA[rows], "i": CURRENT[rows] + noise}
    with pytest.raises(
        InputError, match=r"windows of .* a window is 12 steps by default, average_over = "
    ) as caught:
        eccentric.fit(log, rig=rig_of())
    value = str(caught.value).rsplit('average_over = "', 1)[1].split('"')[0]

    assert eccentric.fit(log, rig=rig_of(average_over=value)).estimates["C"].value > 0.0


def test_a_load_of_its_own_for_every_run_is_arithmetic() -> None:
    """A weight on a drum, another one in each run, subtracted from the motor's torque."""
    run = (T // 4.0).astype(int)
    grams = np.array([0.0, 250.0, 500.0])[run]
    load = grams * 9.81e-5
    log = columns(t=T - 4.0 * run, run=run.astype(float), load_g=grams, i=CURRENT + load / 0.1)
    mapped = {name: column for name, column in COLUMNS.items() if name != "current"} | {"run": "run"}
    rig = rig_of(drive="torque", columns=mapped | {"torque": "0.1 * i - load_g * 9.81e-5"})
    found = eccentric.fit(log, rig=rig).estimates

    for letter, value in {"C": 0.03, "B": 0.005, "J": 0.001}.items():
        assert abs(found[letter].value / value - 1.0) < 0.02


def test_a_clock_that_mostly_falls_is_refused() -> None:
    """A few damaged stamps are dropped; where every other one is, the log has no clock."""
    with pytest.raises(InputError, match="expected time stamps that increase, got 3000 of 6000 rows"):
        table_of(columns(t=T * (-1.0) ** np.arange(len(T))))


def test_a_recording_of_one_row_is_none() -> None:
    """A clock that starts again in the last row: the row is dropped, and there is one run."""
    found = table_of(columns(t=np.append(T[:-1], -1.0)))
    same(found, time=T[:-1])
    assert 1 == len(found.run_names)
