"""Sums on disk: what is written is read, the latest counts, and files do not pile up."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eccentric.fleet.gathered import gone_of, outdated_of, stored_of
from eccentric.fleet.limits import BLOCKS, MOST_PARTS
from eccentric.fleet.sources import LogFile
from eccentric.fleet.sums import Coverage, FileSums, Heading
from eccentric.fleet.work import Stored, joints_of, keys, read, write

pytest.importorskip("pyarrow")

HEADINGS = (Heading("C_m", "N m", "coulomb"), Heading("B_m", "N m s/rad", "viscous"))
OTHER_HEADINGS = (Heading("C_m", "N m", "coulomb"), Heading("offset", "N m", "offset"))
JOINT = "J 1/left"


def _row(period: str, value: float, recipe: str = "r", name: str = "log.parquet") -> Stored:
    coverage = Coverage(**dict.fromkeys(Coverage.__dataclass_fields__, value))  # pyright: ignore[reportArgumentType]
    sums = FileSums(np.full((BLOCKS, 3, 3), value), np.full(BLOCKS, int(value)), coverage)
    return Stored(period, name, 10, int(value), recipe, HEADINGS, sums)


def _write(out: Path, *rows: Stored) -> None:
    place = out / "new"
    place.mkdir(parents=True, exist_ok=True)
    write(out, JOINT, rows, place)


def _parts(out: Path) -> list[str]:
    return sorted(p.name for p in (out / "sums").glob("joint=*/*"))


def test_rows_are_read_as_they_were_written(tmp_path: Path) -> None:
    """Every array and number, in the order of periods, whatever the order in which they came."""
    _write(tmp_path, _row("2025-02", 2.0))
    _write(tmp_path, _row("2025-03", 3.0), _row("2025-01", 1.0))

    found = read(tmp_path, JOINT)

    assert [row.period for row in found] == ["2025-01", "2025-02", "2025-03"]
    for row, value in zip(found, (1.0, 2.0, 3.0), strict=True):
        expected = _row(row.period, value)
        np.testing.assert_array_equal(row.sums.triangles, expected.sums.triangles)
        np.testing.assert_array_equal(row.sums.windows, expected.sums.windows)
        assert replace(row, sums=expected.sums) == expected
        assert row.sums.coverage == expected.sums.coverage
    assert [key.changed for key in keys(tmp_path, JOINT)] == [1, 2, 3]
    assert not list((tmp_path / "new").iterdir())


def test_a_log_of_the_same_name_in_another_period_is_another_log(tmp_path: Path) -> None:
    """Logs are told apart by period and name."""
    _write(tmp_path, _row("2025-01", 1.0))
    _write(tmp_path, _row("2025-02", 2.0))

    assert [(row.period, row.changed) for row in read(tmp_path, JOINT)] == [("2025-01", 1), ("2025-02", 2)]


def test_sums_of_another_rig_stay_until_they_are_made_anew(tmp_path: Path) -> None:
    """A mistyped value in the rig does not cost the history of logs in an archive, whatever their columns."""
    _write(tmp_path, _row("2025-01", 1.0), _row("2025-02", 2.0))
    other = replace(_row("2025-02", 5.0, recipe="other"), headings=OTHER_HEADINGS)
    _write(tmp_path, other)

    assert [(row.period, row.recipe, row.headings, row.changed) for row in read(tmp_path, JOINT)] == [
        ("2025-01", "r", _row("2025-01", 1.0).headings, 1),
        ("2025-02", "other", OTHER_HEADINGS, 5),
    ]
    assert joints_of(tmp_path) == [JOINT]


@pytest.mark.parametrize("later", [_row("2025-01", 5.0), _row("2025-01", 5.0, recipe="other")])
def test_what_is_replaced_does_not_stay(tmp_path: Path, later: Stored) -> None:
    """A log that changed, or a rig: one file is left, without the old row."""
    _write(tmp_path, _row("2025-01", 1.0))
    _write(tmp_path, later)

    assert [(row.recipe, row.changed) for row in read(tmp_path, JOINT)] == [(later.recipe, 5)]
    assert _parts(tmp_path) == ["part-000002.parquet"]


def test_files_are_made_one_before_they_are_many(tmp_path: Path) -> None:
    """Each write adds a file, up to the limit; the next one holds all."""
    for n in range(MOST_PARTS):
        _write(tmp_path, _row(f"{n:04d}", float(n)))
    assert len(_parts(tmp_path)) == MOST_PARTS

    _write(tmp_path, _row("last", 99.0))

    assert _parts(tmp_path) == [f"part-{MOST_PARTS + 1:06d}.parquet"]
    assert [row.changed for row in read(tmp_path, JOINT)] == [*range(MOST_PARTS), 99]


def test_old_files_that_a_killed_run_left_do_not_count(tmp_path: Path) -> None:
    """Killed between writing the file of all and removing the others, a later row still wins."""
    _write(tmp_path, _row("2025-01", 1.0))
    (part,) = (tmp_path / "sums").glob("joint=*/*")
    before = part.read_bytes()
    _write(tmp_path, _row("2025-01", 2.0))
    part.write_bytes(before)

    assert [row.changed for row in read(tmp_path, JOINT)] == [2]


def test_a_damaged_file_counts_as_absent(tmp_path: Path) -> None:
    """Its logs are read again; the other files stay."""
    _write(tmp_path, _row("2025-01", 1.0))
    (part,) = (tmp_path / "sums").glob("joint=*/*")
    part.write_bytes(part.read_bytes()[:100])
    _write(tmp_path, _row("2025-02", 2.0))

    assert [row.period for row in read(tmp_path, JOINT)] == ["2025-02"]
    assert [key.period for key in keys(tmp_path, JOINT)] == ["2025-02"]


def test_the_sums_of_a_gone_log_do_not_outlive_its_rig(tmp_path: Path) -> None:
    """Logs in an archive cannot be read with the new rig: named; with the old one back, they count again."""
    _write(tmp_path, _row("2025-01", 1.0, "old"))
    _write(tmp_path, _row("2025-02", 1.0, "new", "other.parquet"))

    assert list(stored_of(tmp_path, JOINT, "old", [])) == ["2025-01"]
    assert [(p.period, p.kind) for p in outdated_of(tmp_path, JOINT, "old", [])] == [("2025-02", "no log")]
    assert gone_of(stored_of(tmp_path, JOINT, "new", []), []) == ["other.parquet"]


@pytest.mark.parametrize(
    ("name", "size", "counts"),
    [
        ("2025-01/log.csv", 10, 1),
        ("2025-01/log.csv", 11, 0),
        ("2025-01/log.parquet", 7, 0),
        ("archive/2025-01/log.csv", 10, 0),
        ("2025-01/other.csv", 11, 1),
    ],
    ids=["as it was", "changed", "converted", "moved", "another"],
)
def test_a_log_counts_once(name: str, size: int, counts: int, tmp_path: Path) -> None:
    """A log that is there under another name, or in another format, is not gone."""
    _write(tmp_path, _row("2025-01", 5.0, name="2025-01/log.csv"))
    there = LogFile(JOINT, "2025-01", name, Path(name), size, 5)

    assert sum(map(len, stored_of(tmp_path, JOINT, "r", [there]).values())) == counts
