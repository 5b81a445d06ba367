"""What is done with the windows of a long log: gaps, thinning, states, progress, arms and a diagnosis."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import eccentric
from eccentric.cli.arguments import bar
from eccentric.core import InputError
from eccentric.logs import Excerpt, Log, read_log, stream_log
from eccentric.rigs import read_arm_rig
from eccentric.signals import Channels, limits, read_channels, read_joints, read_long_joints
from eccentric.signals import long_log as choice
from eccentric.signals.channels import thinned
from eccentric.signals.table import read_table
from tests.arm_logs import RATE_HZ, arm_log_of, arm_rig_of, planar_arm
from tests.arm_logs import shoulder_by_load as by_load
from tests.long_logs import RIG, columns, parquet, plain, rig_of, stribeck

Columns = dict[str, Any]


def excerpt_of(log: Columns, *spans: tuple[float, float]) -> Log:
    """The rows in these spans of time [s], as windows of a longer log."""
    t = log["time_s"]
    rows = np.concatenate([np.flatnonzero((t >= a) & (t < b)) for a, b in spans])
    begins = np.flatnonzero(np.diff(rows) > 1) + 1
    read = read_log({name: x[rows] for name, x in log.items()})
    return Log(read.path, read.columns, read.rows, excerpt=Excerpt(len(t), 0, begins, "some windows"))


def test_a_gap_between_windows_is_no_gap_of_the_log() -> None:
    """A gap that the log has itself is found, one that the windows leave is not."""
    log = columns(100.0, 200.0)
    kept = (log["time_s"] < 14.0) | (log["time_s"] > 15.0)
    log = {name: x[kept] for name, x in log.items()}
    channels = read_channels([excerpt_of(log, (0.0, 30.0), (50.0, 80.0))], rig_of())
    gaps = [finding for finding in channels.intake.findings if finding.kind == "gap"]

    assert ["1 gap in time"] == [gap.text.split(",")[0] for gap in gaps]
    assert 3 == len(np.unique(channels.time.segment))


def test_windows_at_one_speed_each_are_no_map() -> None:
    """Ten windows of a run that goes through ten speeds: not ten runs of constant speed."""
    t = np.arange(200.0 * 100) / 200.0
    speed = 2.0 + 2.0 * np.floor(t / 10.0)
    theta = np.cumsum(speed) / 200.0
    log = {"time_s": t, "theta_m_rad": theta, "torque_Nm": plain(t, speed)}
    spans = [(10.0 * k + 1.0, 10.0 * k + 9.0) for k in range(10)]
    channels = read_channels([excerpt_of(log, *spans)], rig_of())

    assert 0.0 == channels.rig.sampling.average_over


def test_a_fine_log_is_thinned_to_means_of_its_rows() -> None:
    """1 kHz become 250 Hz for a low pass of 25 Hz: means within a window, whole ones only."""
    log = columns(60.0)
    read = excerpt_of(log, (0.0, 20.001), (30.0, 50.0))
    channels = read_channels([read], rig_of())
    torque, t = channels.motor.torque, channels.time.t

    assert (5000 + 5000, 4) == (len(t), channels.time.rows_per_point)
    assert torque is not None
    np.testing.assert_allclose(torque[:3], log["torque_Nm"][:12].reshape(3, 4).mean(axis=1), rtol=1e-12)
    np.testing.assert_allclose(torque[5000], log["torque_Nm"][30_000:30_004].mean(), rtol=1e-12)
    assert [5000] == np.flatnonzero(channels.time.skipped).tolist()


def test_a_wrapped_angle_is_thinned_after_it_is_unwrapped() -> None:
    """The angle of an encoder that starts again at every turn gives the same motion."""
    log = columns(60.0)
    wrapped = log | {"theta_m_rad": np.mod(log["theta_m_rad"], 2.0 * np.pi)}
    found = [read_channels([excerpt_of(one, (0.0, 40.0))], rig_of()) for one in (log, wrapped)]

    np.testing.assert_allclose(found[0].motion.omega_m, found[1].motion.omega_m, atol=1e-6)


def test_a_point_with_the_motor_switched_inside_is_not_wanted() -> None:
    """Three rows on, one off: neither driven nor free."""
    log = columns(10.0)
    log["motor_off"] = (np.arange(10_000) >= 5_002).astype(float)
    table = thinned(read_table([log], rig_of()), 4)

    assert [1250] == np.flatnonzero(~table.use).tolist()
    assert 1251 == int(np.argmax(table.motor_off))


def test_what_warms_up_goes_on_between_windows() -> None:
    """A first-order lag under a constant push, seen in two windows: 1 - exp(-t/tau) in both."""
    from eccentric.identification.expressions import States

    tau, dt = 20.0, 0.01
    t = np.concatenate([np.arange(0.0, 10.0, dt), np.arange(45.0, 55.0, dt)])
    gain, push = np.full(len(t), 1.0 - dt / (tau + dt)), np.full(len(t), dt / (tau + dt))

    class Signals:
        starts, bridged, size = (0, 1000), {1000: 3501}, len(t)

    states = States.__new__(States)
    states._signals = Signals()  # pyright: ignore[reportAttributeAccessIssue]
    found = states._affine(0.0, gain, push)

    np.testing.assert_allclose(found, 1.0 - np.exp(-t / tau), atol=1e-3)


def test_there_is_a_bar_on_a_terminal_only(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the part that is done and the seconds that are left; it is wiped at the end."""
    assert bar() is None
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    show = bar()
    assert show is not None
    show(0.5)
    shown = capsys.readouterr().err
    show(1.0)

    assert "50%" in shown
    assert "s left" in shown
    assert capsys.readouterr().err.endswith("\r")


def test_a_bar_tells_stages_apart(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each stage has a name and a time of its own: after 2 of 8 s, 6 s are left; the third told no begin."""
    clock = iter([0.0, 100.0, 200.0, 202.0, 208.0, 218.0])
    monkeypatch.setattr("eccentric.cli.arguments.time.monotonic", lambda: next(clock))
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    show = bar()
    assert show is not None
    show(1.0, "sums")
    show(0.0, "diagnoses")
    show(0.25, "diagnoses")

    shown = capsys.readouterr().err.split("\r")[-1]
    assert shown.startswith("  diagnoses    [")
    assert "25%, 6 s left" in shown
    show(1.0, "diagnoses")
    show(0.5, "reports")
    assert "50%, 10 s left" in capsys.readouterr().err.split("\r")[-1]


def test_a_diagnosis_of_windows_names_what_was_planted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stribeck friction in 24,000 rows."""
    monkeypatch.setattr("eccentric.signals.limits.LONG_ROWS", 10_000)
    log = parquet(tmp_path / "log.parquet", columns(240.0, 100.0, stribeck))
    found = eccentric.diagnose(log, RIG, only=["stribeck", "time_drift"])

    assert "named" == found.verdict
    assert found.effects[0].startswith("stribeck")
    assert found.document["excerpt"] in found.summary()
    assert 24_000 == found.document["rows"]["read"]


# Not `getrusage`, whose peak begins with that of the process that has started this one: the tests' own.
_PEAK = """
import sys
import eccentric
from tests.long_logs import RIG
found = eccentric.diagnose(sys.argv[1], RIG)
peak = next(line for line in open("/proc/self/status") if line.startswith("VmHWM:"))
print(*found.effects, peak.split()[1])
"""


@pytest.mark.slow
def test_an_hour_at_a_kilohertz_takes_less_than_1500_megabytes(tmp_path: Path) -> None:
    """3.6 million rows with Stribeck friction, the whole library on offer."""
    path = parquet(tmp_path / "hour.parquet", columns(3600.0, 1000.0, stribeck))
    told = subprocess.run(
        [sys.executable, "-c", _PEAK, path], capture_output=True, text=True, check=True, cwd=Path.cwd()
    )
    *effects, kilobytes = told.stdout.split()

    assert effects[0].startswith("stribeck")
    assert int(kilobytes) < 1_500_000


def test_stretches_of_one_length_are_filtered_as_alone() -> None:
    """Five windows, four of one length: what SciPy gives for each alone up to rounding, one signal or two."""
    from scipy.signal import butter, sosfiltfilt

    from eccentric.signals import low_pass_of

    lengths = (500, 500, 333, 500, 500)
    segment = np.repeat(np.arange(5), lengths)
    t = np.concatenate([100.0 * k + np.arange(n) / 250.0 for k, n in enumerate(lengths)])
    x = np.random.default_rng(3).standard_normal((len(t), 2))
    passed = low_pass_of(t, segment, 25.0, alike=True)
    sections = butter(2, 25.0, fs=1.0 / float(np.median(np.diff(t[:500]))), output="sos")
    expected = np.concatenate([sosfiltfilt(sections, x[segment == k], axis=0) for k in range(5)])

    np.testing.assert_allclose(passed(x), expected, rtol=0.0, atol=1e-13)
    np.testing.assert_array_equal(passed(x)[:, 1], passed(x[:, 1]))


@pytest.mark.parametrize(
    ("lost", "expected"),
    [
        ([], [3, 6]),
        ([6, 7], [3]),
        ([3, 4, 5], [3]),
        ([0, 1, 2], [3]),
        ([0, 3, 7], [2, 4]),
        ([*range(3, 8)], []),
    ],
    ids=["none", "the last window", "one within", "the first", "single rows", "all but the first"],
)
def test_a_window_that_loses_all_its_rows_is_gone(lost: list[int], expected: list[int]) -> None:
    """Of three windows in eight rows; those that are left begin where their first rows are now."""
    good = np.ones(8, dtype=bool)
    good[lost] = False
    left = Excerpt(100, 0, np.array([3, 6]), "some windows").rows_of(good)

    assert expected == left.begins.tolist()


def test_models_are_compared_on_windows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not on all of a long log; the table and the document say so, and who reads is told how far it is."""
    monkeypatch.setattr(limits, "LONG_ROWS", 10_000)
    log = parquet(tmp_path / "long.parquet", columns(360.0, 100.0, stribeck))
    parts: list[float] = []

    found = eccentric.compare(log, RIG, ["c2_parallel", "c2_parallel+stribeck"], reading=parts.append)

    assert "c2_parallel+stribeck" == next(iter(found.rmse["mechanical"]))
    assert "of 36 windows of 10 s are used" in found.document["excerpt"]
    assert found.document["excerpt"] in found.summary()
    assert sorted(parts) == parts
    assert parts[-1] == 1.0


@pytest.fixture(scope="module")
def arm() -> tuple[dict[str, Any], dict[str, Any]]:
    """Twelve minutes of a planar arm whose shoulder has friction by its load, and its rig."""
    return arm_log_of(by_load, seconds=120.0), arm_rig_of(planar_arm())


@pytest.mark.slow
def test_an_arm_is_fitted_on_windows(
    arm: tuple[dict[str, Any], dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same rows for every joint, and the whole log's coefficients, within four standard errors."""
    log, rig = arm
    found = eccentric.fit_arm(log, rig)
    monkeypatch.setattr(limits, "LONG_ROWS", len(log["t_s"]))
    whole = eccentric.fit_arm(log, rig)
    times = [channels.time.t for channels in found.fit.log.channels]

    np.testing.assert_array_equal(times[0], times[1])
    assert len(times[0]) < 0.5 * len(whole.fit.log.channels[0].time.t)
    assert "excerpt" not in whole.document
    assert "of 72 windows of 10 s are used" in found.document["excerpt"]
    assert f"of {6 * (120.0 - 1 / RATE_HZ) - 11 * 6 / RATE_HZ:.5g} s" in found.document["excerpt"]
    assert found.document["excerpt"] in found.summary()
    assert len(log["t_s"]) == found.document["rows"]["read"]
    for ours, theirs in zip(found.fit.joints, whole.fit.joints, strict=True):
        assert theirs.loads.followed == ours.loads.followed
        for name, estimate in theirs.friction.items():
            assert ours.friction[name].value == pytest.approx(
                estimate.value, abs=4.0 * ours.friction[name].std_error
            )


def test_rows_without_a_number_leave_the_windows_where_they_begin(
    arm: tuple[dict[str, Any], dict[str, Any]],
) -> None:
    """Rows that one joint lacks are lost for all: the first row of a window, and a window as a whole."""
    log, rig = dict(arm[0]), read_arm_rig(arm[1])
    (read,) = read_long_joints([log], rig)
    assert read.excerpt is not None
    first, second, third = read.excerpt.begins[:3].tolist()
    values = read.columns["tau_Nm_2"].copy()
    values[[first, *range(second, third)]] = np.nan
    damaged = replace(read, columns={**read.columns, "tau_Nm_2": values})

    damaged_begins, whole_begins = (_begins(read_joints([log], rig)[0]) for log in (damaged, read))
    gone = [(str(read.columns["run"][k]), float(read.columns["t_s"][k])) for k in (first, second)]
    step = 1.0 / RATE_HZ

    assert whole_begins - damaged_begins == set(gone)
    assert {(run, round(t - step, 6)) for run, t in damaged_begins - whole_begins} == {gone[0]}


def _begins(channels: Channels) -> set[tuple[str, float]]:
    """Run and time of the rows that a window begins with."""
    time = channels.time
    return {(time.run_names[time.run[k]], float(time.t[k])) for k in np.flatnonzero(time.skipped)}


def test_columns_of_another_arm_are_refused_before_anything_is_read(
    arm: tuple[dict[str, Any], dict[str, Any]],
) -> None:
    """As those of a short log are: one line."""
    log = {name: values for name, values in arm[0].items() if not name.endswith("2")}

    with pytest.raises(InputError, match="expected column 'q_rad_2' for joint 2 of planar"):
        eccentric.fit_arm(log, arm[1])


def test_what_was_read_of_a_parquet_file_is_not_kept(tmp_path: Path) -> None:
    """In batches, a file of 30 MB takes no more of Arrow's memory than a few batches do."""
    path, rows = tmp_path / "log.parquet", 1_000_000
    values = np.random.default_rng(0).normal(size=rows)
    pq.write_table(pa.table({"a": values, "b": values[::-1], "c": values**2}), path, row_group_size=50_000)
    before, most = pa.total_allocated_bytes(), 0

    for batch in stream_log(path).batches():
        most = max(most, pa.total_allocated_bytes() - before)
        assert batch.rows <= 131_072

    assert most < path.stat().st_size / 2


@pytest.mark.parametrize(
    ("count", "expected"), [(5, {0, 25, 50, 75, 100}), (3, {0, 50, 100}), (1, {0}), (0, set())]
)
def test_windows_are_spread_evenly(count: int, expected: set[int]) -> None:
    """Of 101 windows the first, the last and those between at equal distances; of none wanted, none."""
    assert expected == choice._even(range(101), count)
