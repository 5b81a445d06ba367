"""What a run found of a fleet as files: coefficients by period, tests, and all as one document."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Collection, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any
from urllib.parse import quote

from eccentric.fleet import Drifting, FleetChange, FleetFound, History, Period, arrow_of, in_order


def write_coefficients(found: FleetFound, folder: Path) -> None:
    """Write coefficients/period=P.parquet below a folder, for each period: a row for each coefficient.

    Columns: joint, axis (turning, linear), name, unit, kind, value, std_error, lower, upper (95 %), and what
    the period covers: seconds in motion, speeds [rad/s], temperatures [deg C], friction and residual [N m];
    of a linear axis m/s and N.
    """
    arrow, parquet = arrow_of()
    rows: dict[str, list[dict[str, Any]]] = {}
    for history in found.histories:
        for period in history.periods:
            rows.setdefault(period.period, []).extend(_rows(history, period))
    for name in in_order(rows):
        place = folder / "coefficients" / f"period={quote(name, safe=' ')}.parquet"
        place.parent.mkdir(exist_ok=True)
        parquet.write_table(arrow.Table.from_pylist(rows[name]), place)


def _rows(history: History, period: Period) -> list[dict[str, Any]]:
    c = period.coverage
    covered = {
        "seconds": c.seconds,
        "speed_low": c.low,
        "speed_high": c.high,
        "temperature": c.temperature,
        "coldest": c.coldest,
        "warmest": c.warmest,
        "friction": period.friction[0],
        "residual": period.residual[0],
    }
    return [
        {
            "joint": history.joint,
            "axis": history.axis.name,
            "name": heading.name,
            "unit": heading.unit,
            "kind": heading.kind,
            "value": float(value),
            "std_error": float(error),
            "lower": float(value - period.reach * error),
            "upper": float(value + period.reach * error),
        }
        | covered
        for heading, value, error in zip(history.headings, period.values, period.errors, strict=True)
    ]


_CHANGES = [
    "joint",
    "quantity",
    "unit",
    "shape",
    "since",
    "before",
    "after",
    "part_of_friction",
    "p",
    "counts",
    "joint_changed",
]


def changes_csv(changes: Sequence[FleetChange], called: Collection[str]) -> str:
    """The content of changes.csv: every test, the most significant first.

    `called` are the joints that are said to have changed: coefficients that are alike may trade with each
    other, which counts, and moves no torque.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_CHANGES)
    for change in sorted(changes, key=lambda c: (c.p, c.series.joint, c.series.name)):
        s = change.series
        numbers = (f"{x:.6g}" for x in (change.before, change.after, change.part, change.p))
        what = (s.joint, s.name, s.unit, change.shape, change.since)
        writer.writerow([*what, *numbers, int(change.counts), int(s.joint in called)])
    return text.getvalue()


def fleet_document(found: FleetFound) -> dict[str, Any]:
    """The content of fleet.json."""
    return {
        "format": "eccentric-fleet/1",
        "joints": found.joints,
        "joints_tested": len(found.tested),
        "joints_without_log": list(found.without_log),
        "joints_behind": found.behind,
        "periods": in_order({p.period for h in found.histories for p in h.periods}),
        "false_discovery_rate": found.rate,
        "tests": len(found.changes),
        "drifting": [_entry(one) for one in found.drifting],
        "problems": [asdict(problem) for problem in found.problems],
    }


def _finite(x: float) -> float | None:
    """JSON has no NaN."""
    return x if math.isfinite(x) else None


def _entry(one: Drifting) -> dict[str, Any]:
    return {
        "joint": one.joint,
        "what": one.what,
        "names": list(one.names),
        "sensor_or_load": one.sensor,
        "since": one.since,
        "part_of_friction": _finite(one.part_of_friction),
        "residual_factor": _finite(one.residual_factor),
        "p": one.p,
        "rmse_before": one.before,
        "rmse_after": one.after,
        "unit": one.unit,
        "report": one.report,
        "quantities": [c.series.name for c in one.changes],
    }
