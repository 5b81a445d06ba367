"""What is found of a joint that drifts, in words: what changed, since when, how urgent it is."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote

from eccentric.fleet.drift import FRICTION, RESIDUAL, Changed, FleetChange
from eccentric.fleet.limits import EFFECT_PERCENT
from eccentric.fleet.periods import History, Period
from eccentric.fleet.sources import NO_RIG, FleetProblem, in_order
from eccentric.fleet.work import Sample, arrow_of
from eccentric.rigs import Rig

_KINDS = {
    "viscous": "viscous friction",
    "coulomb": "Coulomb friction",
    "load": "friction that follows the load",
    "friction": "friction",
    "inertia": "inertia",
    "scale": "gain of the drive signal, or the load carried",
    "offset": "offset of the drive signal, or a constant load",
}
_NO_COEFFICIENT = "a change that no coefficient explains"
NOT_FRICTION = frozenset({"scale", "offset", "inertia"})
"""Kinds of columns that are not friction: of these a sensor or a load is the cause."""


@dataclass(frozen=True)
class Suspect:
    """A joint that drifts, before its diagnosis: its significant changes, strongest first; what sums say.

    `content` is that of its rig as a file, None where one file holds for all joints. `past` and `recent` are
    the logs that a diagnosis compares, None where no log of the time is there.
    """

    joint: str
    rig: Rig
    content: Mapping[str, Any] | None
    changes: tuple[FleetChange, ...]
    changed: Changed
    past: Sample | None
    recent: Sample | None


@dataclass(frozen=True)
class Examined:
    """What a diagnosis of recent logs says that one of the past does not: new effects, family and words.

    `friction` is false where each of them is a declared value that is wrong, or is found from the circuit.
    `before` and `after` are held-out errors of the recent log, without and with all effects found in it, in
    `unit`; `again` are families of the past among these: the errors are then theirs as well, and say nothing
    of the new ones alone. `tied` are families that the recent log does not distinguish, if so. `report` is
    the path of its page below the folder of the fleet. `said` tells why there is none.
    """

    families: tuple[str, ...] = ()
    effects: tuple[str, ...] = ()
    before: float = 0.0
    after: float = 0.0
    unit: str = "N m"
    report: str = ""
    said: str = ""
    again: tuple[str, ...] = ()
    tied: tuple[str, ...] = ()
    friction: bool = True

    @property
    def gain_percent(self) -> float:
        """By how much the new effects reduce the error; 0 where that cannot be told from the past's."""
        return 0.0 if self.again or not self.families else 100.0 * (1.0 - self.after / self.before)


@dataclass(frozen=True)
class Drifting:
    """A joint that drifts: what changed in words and by name, since when, the errors before and after.

    `names` are coefficients or families of effects, empty where nothing explains the change; `sensor` says
    that they are none of friction. `part` is the change as a part of the friction torque; with
    `of_residual`, that of the logarithm of what the model leaves: `part_of_friction` and `residual_factor`
    are the one that it is, and NaN. All of this is of the change that is `shown`: of the quantity that is
    named, else of friction, else of the strongest.
    """

    joint: str
    what: str
    names: tuple[str, ...]
    sensor: bool
    since: str
    part: float
    p: float
    before: float
    after: float
    unit: str
    report: str
    shown: FleetChange = field(repr=False)
    changes: tuple[FleetChange, ...] = field(repr=False, default=())

    @property
    def of_residual(self) -> bool:
        """Whether the change is one of what the model leaves."""
        return self.shown.series.name == RESIDUAL

    @property
    def part_of_friction(self) -> float:
        """The change as a part of the friction torque."""
        return math.nan if self.of_residual else self.part

    @property
    def residual_factor(self) -> float:
        """What the model leaves, over what it left before."""
        return math.exp(self.part) if self.of_residual else math.nan

    @property
    def size(self) -> str:
        """The change in a word or two."""
        if self.of_residual:
            return f"residual × {self.residual_factor:.3g}"
        return f"{100.0 * self.part_of_friction:+.0f} % of the friction"

    @property
    def urgency(self) -> float:
        """What to look at first: the larger the change of the torque, the higher; sensors come after."""
        return (0.0 if self.sensor else 1e3) + abs(self.part)


@dataclass(frozen=True)
class FleetFound:
    """What a run found: the histories of all joints, tests, joints that drift (most urgent first), problems.

    This run read `files` logs, of which `problems` names those without sums; the sums of `reused` others were
    there, and those of `gone` count though these logs are no longer there. `without_log` are joints of the
    table of rigs that have neither a log nor sums.
    """

    histories: tuple[History, ...]
    changes: tuple[FleetChange, ...]
    drifting: tuple[Drifting, ...]
    problems: tuple[FleetProblem, ...]
    files: int
    reused: int
    gone: tuple[str, ...]
    without_log: tuple[str, ...]
    rate: float

    @property
    def joints(self) -> int:
        """How many joints have a log, or sums of one: those with a rig have a history."""
        return len(self.histories) + sum(problem.kind == NO_RIG for problem in self.problems)

    @property
    def behind(self) -> dict[str, str]:
        """Joints that have no answer in the last period of the fleet, each with its own last one."""
        last = {history.joint: history.periods[-1].period for history in self.histories if history.periods}
        newest = in_order(last.values())[-1:]
        return {joint: period for joint, period in last.items() if period not in newest}

    @property
    def unchanged(self) -> list[str]:
        """Joints that were tested and are not among those that changed."""
        return sorted(self.tested - {one.joint for one in self.drifting})

    @property
    def tested(self) -> frozenset[str]:
        """Joints that could be tested for a change."""
        return frozenset(change.series.joint for change in self.changes)


def drifting_of(suspect: Suspect, examined: Examined) -> Drifting:
    """The word on a joint: the coefficients that explain the change, else the new effect, else none."""
    changed, strongest = suspect.changed, suspect.changes[0]
    own = {change.series.name: change for change in suspect.changes}
    names, sensor = changed.names, False
    before, after, unit = changed.before, changed.after, suspect.rig.axis.said("N m")
    if names:
        sensor = all(kind in NOT_FRICTION for kind in changed.kinds)
        said = suspect.rig.axis.said
        parts = [f"{said(_KINDS[kind])} ({name})" for kind, name in zip(changed.kinds, names, strict=True)]
        what = " and ".join(parts)
    elif examined.gain_percent >= EFFECT_PERCENT:
        names, what = examined.families, "new: " + ", ".join(examined.effects)
        sensor = not examined.friction
        before, after, unit = examined.before, examined.after, examined.unit
    elif examined.families and examined.again:
        new, past = ", ".join(examined.effects), ", ".join(examined.again)
        what = f"{_NO_COEFFICIENT}; new beside {past}: {new}, whose own gain is not known"
    elif examined.tied:
        tied = " or ".join(examined.tied)
        what = f"{_NO_COEFFICIENT}: {tied}, which its log does not distinguish"
    elif examined.said:
        what = f"{_NO_COEFFICIENT}, and that was not diagnosed: {examined.said}"
    else:
        what = f"{_NO_COEFFICIENT}, nor any effect of the library"
    shown = next((own[name] for name in (*names, FRICTION) if name in own), strongest)
    return Drifting(
        *(suspect.joint, what, tuple(names), sensor, shown.since, shown.part, shown.p),
        *(before, after, unit, examined.report, shown, suspect.changes),
    )


# What a run found as files: coefficients by period, tests, joints that drift, all as one document.


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


def document_of(found: FleetFound) -> dict[str, Any]:
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
