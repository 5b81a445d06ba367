"""A joint that cannot be judged is said to be one, and a rig of another joint is told."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

import eccentric

pytest.importorskip("distributed")
pytest.importorskip("pyarrow")
pytestmark = pytest.mark.filterwarnings(
    "ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)


def test_what_cannot_be_judged_is_told(tmp_path: Path) -> None:
    """Four periods are too few to test; three times the mass is another joint's; no mass is told once."""
    eccentric.bench_fleet(tmp_path / "fleet", joints=3, months=4, degrading=1, bad_sensors=0, seconds=30.0)
    table = tmp_path / "fleet" / "rigs.csv"
    with table.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    _, heavy, without = (row["joint"] for row in rows)
    rows[1]["M_kg"] = str(3.0 * float(rows[1]["M_kg"]))
    rows[2]["M_kg"] = ""
    with table.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)

    found = eccentric.diagnose_fleet(tmp_path / "fleet" / "logs", table, tmp_path / "out", workers=1)
    problems = [(one.joint, one.kind) for one in found.problems]

    assert problems == sorted(
        [*((row["joint"], "not tested") for row in rows[:2]), (heavy, "another rig"), (without, "no rig")]
    )
    assert "No joint could be tested for a change" in found.summary()
    (rig,) = [one.text for one in found.problems if one.kind == "another rig"]
    assert "received 0.3" in rig
