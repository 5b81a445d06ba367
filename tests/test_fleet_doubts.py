"""A joint that cannot be judged is said to be one, and a rig of another joint is told."""

from __future__ import annotations

import csv
import shutil
from pathlib import Path

import pytest

import eccentric

pytest.importorskip("distributed")
pytest.importorskip("pyarrow")
pytestmark = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)


def rows_of(table: Path) -> list[dict[str, str]]:
    """The rows of a table."""
    with table.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_rows(table: Path, rows: list[dict[str, str]]) -> None:
    """Write them in its place."""
    with table.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


@pytest.mark.slow
def test_a_joint_with_the_rig_of_another_is_not_judged_and_a_late_one_is_told(tmp_path: Path) -> None:
    """A wrong rig takes a joint out of the tests, and changes those of no other; a missing month is said."""
    eccentric.bench_fleet(tmp_path / "fleet", joints=4, months=6, degrading=1, bad_sensors=0, seconds=30.0)
    logs, table = tmp_path / "fleet" / "logs", tmp_path / "fleet" / "rigs.csv"
    shutil.rmtree(next(logs.glob("joint=*4/*06")))
    right = eccentric.diagnose_fleet(logs, table, tmp_path / "right", workers=1)
    rows = rows_of(table)
    changed = {one.joint for one in right.drifting}
    wrong = next(row for row in rows if row["joint"] not in changed)
    wrong["M_kg"] = str(3.0 * float(wrong["M_kg"]))
    write_rows(table, rows)
    again = eccentric.diagnose_fleet(logs, table, tmp_path / "again", workers=1)

    assert (right.document["joints_tested"], again.document["joints_tested"]) == (4, 3)
    assert list(right.document["joints_behind"].values()) == ["2025-05"]
    assert "1 joint without an answer in the last period" in right.summary()
    assert {one.joint for one in again.drifting} == changed
    tested = [_tests(tmp_path / out) for out in ("right", "again")]
    assert wrong["joint"] in {joint for joint, _ in tested[0]}
    assert wrong["joint"] not in {joint for joint, _ in tested[1]}
    assert {joint for joint, called in tested[1] if called == "1"} == changed


def _tests(out: Path) -> set[tuple[str, str]]:
    """The joints of changes.csv, each with whether it is said to have changed."""
    return {(row["joint"], row["joint_changed"]) for row in rows_of(out / "changes.csv")}


def test_what_cannot_be_judged_is_told(tmp_path: Path) -> None:
    """Four periods are too few to test; three times the mass is another joint's; no mass is told once."""
    eccentric.bench_fleet(tmp_path / "fleet", joints=3, months=4, degrading=1, bad_sensors=0, seconds=15.0)
    table = tmp_path / "fleet" / "rigs.csv"
    rows = rows_of(table)
    _, heavy, without = (row["joint"] for row in rows)
    rows[1]["M_kg"] = str(3.0 * float(rows[1]["M_kg"]))
    rows[2]["M_kg"] = ""
    write_rows(table, rows)

    found = eccentric.diagnose_fleet(tmp_path / "fleet" / "logs", table, tmp_path / "out", workers=1)
    problems = [(one.joint, one.kind) for one in found.problems]

    assert problems == sorted(
        [*((row["joint"], "not tested") for row in rows[:2]), (heavy, "another rig"), (without, "no rig")]
    )
    assert "No joint could be tested for a change" in found.summary()
    (rig,) = [one.text for one in found.problems if one.kind == "another rig"]
    assert "got 0.3" in rig
