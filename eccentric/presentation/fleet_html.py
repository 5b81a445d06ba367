"""What changed in a fleet: the page, coefficients by period, tests, and all as one document.

The page shows what to look at first, each joint over its periods, and all joints in one figure.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from numpy.typing import NDArray

from eccentric.core import counted, few
from eccentric.fleet import (
    FRICTION,
    RESIDUAL,
    Drifting,
    FleetChange,
    FleetFound,
    History,
    Period,
    arrow_of,
    in_order,
)
from eccentric.model import AxisKind
from eccentric.presentation.fit_json import finite
from eccentric.presentation.html import number, rendered

Array = NDArray[np.float64]

_WIDE, _HIGH, _EDGE = 240.0, 90.0, 6.0
_LEVEL_RIGHT, _LEVEL_HIGH = 850.0, 260.0
_USUAL = 3
"""Periods that a joint's friction is compared with, at most."""
_LABEL_HIGH, _LABELS = 13.0, 16
"""Height of a name beside its line, and the most that fit: the most urgent."""


def fleet_page(found: FleetFound) -> str:
    """The page, one file that opens offline; joints lead to their own reports."""
    return rendered("fleet", _view(found))


def fleet_sentence(found: FleetFound) -> str:
    """The result in one sentence."""
    if not found.tested:
        return "No joint could be tested for a change; problems.csv says why."
    joints = counted(len(found.tested), "joint")
    if untested := found.joints - len(found.tested):
        joints += f" ({untested} more not tested: problems.csv says why)"
    worn = [one for one in found.drifting if not one.sensor]
    others = len(found.drifting) - len(worn)
    if not found.drifting:
        return f"None of {joints} changed."
    said = [f"Friction changed in {len(worn) or 'none'} of {joints}"]
    if others:
        said.append(f"a sensor or the load in {others}")
    first = found.drifting[0]
    return f"{', '.join(said)}; look first at {first.joint}: {first.what}, since {first.since}."


def joints_without_logs(found: FleetFound) -> list[str]:
    """In words: joints of the rigs' table that have no log, and those that have none in the last period."""
    said: list[str] = []
    if found.without_log:
        joints = counted(len(found.without_log), "joint")
        said.append(f"{joints} in the rig table without a log ({few(found.without_log, 3)})")
    if found.behind:
        joints = counted(len(found.behind), "joint")
        last = [f"{joint}: {period}" for joint, period in found.behind.items()]
        said.append(f"{joints} without a result in the last period (their last: {few(last, 3)})")
    return said


def _view(found: FleetFound) -> dict[str, Any]:
    periods = in_order({p.period for h in found.histories for p in h.periods})
    axes = {history.joint: history.axis for history in found.histories}
    span = f"{periods[0]} to {periods[-1]}" if periods else "no period"
    return {
        "title": "What changed in the fleet?",
        "verdict": "unexplained" if found.drifting else "nothing_missing",
        "badge": f"{counted(found.joints, 'joint')}, {counted(len(periods), 'period')}: {span}",
        "sentence": fleet_sentence(found),
        "rate": f"{100.0 * found.rate:g} %",
        "tests": len(found.changes),
        "rows": [_row(rank, one) for rank, one in enumerate(found.drifting, start=1)],
        "panels": [_panel(one, axes[one.joint]) for one in found.drifting],
        "levels": _levels(found, periods),
        "problems": found.problems,
        "without_logs": "; ".join(joints_without_logs(found)),
    }


def _row(rank: int, one: Drifting) -> dict[str, Any]:
    """A joint of the table: texts, and the numbers that it is sorted by."""
    return {
        "rank": rank,
        "joint": one.joint,
        "href": one.report,
        "what": one.what,
        "since": one.since,
        "part": one.size.replace("-", "−"),
        "part_value": abs(one.part),
        "p": number(one.p, 2),
        "p_value": one.p,
        "before": number(one.before, 3),
        "after": number(one.after, 3),
        "before_value": one.before,
        "after_value": one.after,
        "unit": one.unit,
    }


def _panel(one: Drifting, axis: AxisKind) -> dict[str, Any]:
    """The change of a joint over its periods, in the words of its axis."""
    s = one.shown.series
    values = np.exp(s.values) if s.name == RESIDUAL else s.values
    errors = values * s.errors if s.name == RESIDUAL else s.errors
    words = {
        FRICTION: f"mean friction {axis.term('torque')} [{axis.unit('N m')}]",
        RESIDUAL: f"RMS residual [{axis.unit('N m')}]",
    }
    return {
        "joint": one.joint,
        "href": one.report,
        "what": one.what,
        "label": words.get(s.name, f"{s.name} [{s.unit}]"),
        "svg": _small(values, 2.0 * errors, s.periods.index(one.since)),
        "first": s.periods[0],
        "last": s.periods[-1],
        "low": number(float(values.min()), 3),
        "high": number(float(values.max()), 3),
    }


def _small(values: Array, reach: Array, since: int) -> dict[str, Any]:
    """Points, bars and the beginning of a change in the units of a small drawing."""
    low, high = float(np.min(values - reach)), float(np.max(values + reach))
    x = _scaled(np.arange(len(values), dtype=float), 0.0, max(len(values) - 1, 1), _EDGE, _WIDE - _EDGE)
    y, top, bottom = (
        _scaled(at, low, high, _HIGH - _EDGE, _EDGE) for at in (values, values + reach, values - reach)
    )
    return {
        "line": _path(x, y),
        "points": _rounded(x, y),
        "bars": [(f"{a:.1f}", f"{b:.1f}", f"{c:.1f}") for a, b, c in zip(x, top, bottom, strict=True)],
        "since": f"{0.5 * (x[since] + x[max(since - 1, 0)]):.1f}",
    }


def _levels(found: FleetFound, periods: Sequence[str]) -> dict[str, Any]:
    """The friction of every joint over that of its first periods, of those that changed before they did."""
    drifting = {one.joint: one for one in found.drifting}
    place = {name: k for k, name in enumerate(periods)}
    lines: list[tuple[str, Array, Array]] = []
    for history in found.histories:
        level = np.array([p.friction[0] for p in history.periods])
        own = [p.period for p in history.periods]
        changed = own.index(drifting[history.joint].since) if history.joint in drifting else _USUAL
        usual = float(level[: min(max(changed, 1), _USUAL)].mean()) if len(level) else 0.0
        if len(level) >= 2 and np.all(np.isfinite(level)) and usual > 0.0:
            lines.append((history.joint, np.array([place[name] for name in own], float), level / usual))
    if not lines:
        return {}
    every = np.concatenate([y for _, _, y in lines])
    low, high = float(every.min()), float(every.max())

    def drawn(x: Array, y: Array) -> str:
        right = max(len(periods) - 1, 1)
        return _path(
            _scaled(x, 0.0, right, 40.0, _LEVEL_RIGHT), _scaled(y, low, high, _LEVEL_HIGH - 24.0, _EDGE)
        )

    def kind(joint: str) -> str:
        return "" if joint not in drifting else "sensor" if drifting[joint].sensor else "changed"

    ordered = sorted(lines, key=lambda line: line[0] in drifting)
    ends = {joint: float(_scaled(y[-1:], low, high, _LEVEL_HIGH - 24.0, _EDGE)[0]) for joint, _, y in lines}
    named = [joint for joint in drifting if joint in ends][:_LABELS]
    ticks = [t for t in np.arange(0.0, 20.0, 0.25 if high - low < 2.5 else 1.0) if low <= t <= high]
    return {
        "lines": [(joint, kind(joint), drawn(x, y)) for joint, x, y in ordered],
        "ticks": [
            (f"{float(_scaled(np.array(t), low, high, _LEVEL_HIGH - 24.0, _EDGE)):.1f}", f"{100 * t:.0f} %")
            for t in ticks
        ],
        "labels": [(joint, kind(joint), f"{y:.1f}") for joint, y in _apart({j: ends[j] for j in named})],
        "right": f"{_LEVEL_RIGHT:g}",
        "first": periods[0],
        "last": periods[-1],
    }


def _apart(wanted: Mapping[str, float]) -> list[tuple[str, float]]:
    """Heights of names, from above: as wanted or below the name before, moved up where the figure ends."""
    placed: list[tuple[str, float]] = []
    for joint, y in sorted(wanted.items(), key=lambda one: one[1]):
        placed.append((joint, max([y, *(at + _LABEL_HIGH for _, at in placed[-1:])])))
    limit = _LEVEL_HIGH - 24.0
    for k in range(len(placed) - 1, -1, -1):
        joint, y = placed[k]
        placed[k] = joint, min(y, limit)
        limit = placed[k][1] - _LABEL_HIGH
    return placed


def _scaled(x: Array, low: float, high: float, start: float, stop: float) -> Array:
    return start + (x - low) / ((high - low) or 1.0) * (stop - start)


def _rounded(x: Array, y: Array) -> list[tuple[str, str]]:
    return [(f"{a:.1f}", f"{b:.1f}") for a, b in zip(x, y, strict=True)]


def _path(x: Array, y: Array) -> str:
    return " ".join(f"{a},{b}" for a, b in _rounded(x, y))


# Files beside the page.


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
            rows.setdefault(period.period, []).extend(_coefficient_rows(history, period))
    for name in in_order(rows):
        place = folder / "coefficients" / f"period={quote(name, safe=' ')}.parquet"
        place.parent.mkdir(exist_ok=True)
        parquet.write_table(arrow.Table.from_pylist(rows[name]), place)


def _coefficient_rows(history: History, period: Period) -> list[dict[str, Any]]:
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


def _entry(one: Drifting) -> dict[str, Any]:
    return {
        "joint": one.joint,
        "what": one.what,
        "names": list(one.names),
        "sensor_or_load": one.sensor,
        "since": one.since,
        "part_of_friction": finite(one.part_of_friction),
        "residual_factor": finite(one.residual_factor),
        "p": one.p,
        "rmse_before": one.before,
        "rmse_after": one.after,
        "unit": one.unit,
        "report": one.report,
        "quantities": [c.series.name for c in one.changes],
    }
