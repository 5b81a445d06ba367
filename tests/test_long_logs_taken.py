"""Long logs beyond fit and diagnose: models compared, arms; and what a reader keeps in memory."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import eccentric
from eccentric.core import InputError
from eccentric.logs import stream_log
from eccentric.rigs import read_arm_rig
from eccentric.signals import Channels, limits, read_joints, read_long_joints
from eccentric.signals import long_choice as choice
from tests.arm_logs import RATE_HZ, arm_log_of, arm_rig_of, planar_arm
from tests.arm_logs import shoulder_by_load as by_load
from tests.long_logs import RIG, columns, parquet, stribeck


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
