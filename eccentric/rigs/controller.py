"""The controller of a rig: what makes the drive signal from a set point and the state of the drive.

    signal = position_gain (set_point - theta) + speed_gain (set_speed - omega) + feed_forward, within limits

in the unit of the drive signal (V, A, N m); theta and omega are the angle that the rig maps and its speed, in
rad and rad/s (m and m/s on a carriage).
"""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from eccentric.core import InputError, few, read_number, read_table, refuse_unknown
from eccentric.logs import column_names, require_unit
from eccentric.model import TURNING, AxisKind

STATES = ("theta", "omega")
"""Names of the simulated angle and speed in arithmetic."""
_GAINS = ("position_gain", "speed_gain", "feed_forward")
_SET_POINTS = {"set_point": "rad", "set_speed": "rad/s"}
_KEYS = (*_SET_POINTS, *_GAINS, "limit", "by_run")


@dataclass(frozen=True)
class Controller:
    """The controller as the rig describes it; each entry is a number or arithmetic on columns and states.

    Attributes:
        entries: set_point, set_speed, position_gain, speed_gain, feed_forward, lower and upper limit, those
            that the rig gives.
        factors: what a set point is multiplied by to be in SI.
        by_run: constants that differ from run to run: name -> run or pattern of runs -> value.
        columns: names of the columns that it uses.
    """

    entries: Mapping[str, str | float]
    factors: Mapping[str, float] = field(default_factory=dict)
    by_run: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    columns: tuple[str, ...] = ()

    def constants(self, runs: Sequence[str], where: str) -> dict[str, list[float]]:
        """The constants by name, a value for each run.

        Raises InputError for a run that no pattern of a constant matches, or two.
        """
        found: dict[str, list[float]] = {}
        for name, by_pattern in self.by_run.items():
            place = f"{where}: [controller.by_run] {name}"
            found[name] = []
            for run in runs:
                values = [x for p, x in by_pattern.items() if fnmatch.fnmatchcase(run, p)]
                if len(values) != 1:
                    got = f"{len(values)} of {few(by_pattern)}"
                    raise InputError(place, f"one pattern for run {run!r}", got)
                found[name].append(values[0])
        return found


def read_controller(value: object, where: str, axis: AxisKind = TURNING) -> Controller:
    """Read the table `[controller]` of a rig file.

    Raises InputError for an unknown key, what is neither a number nor arithmetic, a wrong unit, gains without
    a set point, and no gain at all.
    """
    table = read_table(value, where)
    refuse_unknown(table, _KEYS, where)
    entries: dict[str, str | float] = {}
    factors: dict[str, float] = {}
    for key, unit in _SET_POINTS.items():
        if key in table:
            entries[key], factors[key] = _set_point(table[key], axis.unit(unit), f"{where} {key}")
    for key in _GAINS:
        if key in table:
            entries[key] = _number_or_text(table[key], f"{where} {key}")
    if "limit" in table:
        entries |= _limits(table["limit"], f"{where} limit")
    if not set(_GAINS) & set(entries):
        raise InputError(where, f"one of {', '.join(_GAINS)}", "none")
    if "position_gain" in entries and "set_point" not in entries:
        raise InputError(f"{where} set_point", "a column of set points", "none", why="with position_gain")
    by_run = _by_run(table.get("by_run", {}), f"{where.removesuffix(']')}.by_run]")
    own = {*by_run, *STATES}
    texts = {key: text for key, text in entries.items() if isinstance(text, str)}
    names = [name for key, text in texts.items() for name in column_names(text, f"{where} {key}")]
    columns = tuple(dict.fromkeys(name for name in names if name not in own))
    return Controller(entries, factors, by_run, columns)


def _set_point(value: object, unit: str, where: str) -> tuple[str | float, float]:
    """The source of a set point, and what makes it SI."""
    entry = read_table(value, where) if isinstance(value, Mapping) else {"column": value}
    refuse_unknown(entry, ("column", "unit"), where)
    source, given = _number_or_text(entry.get("column"), where), entry.get("unit", unit)
    if not isinstance(given, str):
        raise InputError(f"{where} unit", "a unit as text", f"{given!r}")
    return source, require_unit(given, unit, where).factor


def _limits(value: object, where: str) -> dict[str, str | float]:
    """Lower and upper limit: one for both sides, or a list of two."""
    if isinstance(value, list):
        if len(value) != 2:
            raise InputError(where, "one limit, or a list [lower, upper]", f"{value!r}")
        lower, upper = (_number_or_text(one, where) for one in value)
        if isinstance(lower, float) and isinstance(upper, float) and lower >= upper:
            raise InputError(where, "lower below upper", f"{value!r}")
        return {"lower": lower, "upper": upper}
    one = _number_or_text(value, where)
    if isinstance(one, float):
        if one <= 0.0:
            raise InputError(where, "a limit above 0", f"{value!r}")
        return {"lower": -one, "upper": one}
    return {"lower": f"-({one})", "upper": one}


def _number_or_text(value: object, where: str) -> str | float:
    if isinstance(value, str) and value.strip():
        return value.strip()
    if isinstance(value, str | bool) or not isinstance(value, int | float):
        raise InputError(where, "a number, a column or arithmetic", f"{value!r}")
    return read_number(value, where, -math.inf)


def _by_run(value: object, where: str) -> dict[str, dict[str, float]]:
    """Constants that differ from run to run: tables of numbers by run or pattern of runs."""
    found: dict[str, dict[str, float]] = {}
    table: Mapping[str, Any] = read_table(value, where)
    for name, by_pattern in table.items():
        at = f"{where} {name}"
        if not name.isidentifier() or name in STATES:
            raise InputError(where, f"names that are words and not {' or '.join(STATES)}", f"{name!r}")
        patterns = read_table(by_pattern, at)
        if not patterns:
            raise InputError(at, "a value by run or pattern of runs", "none")
        found[name] = {run: read_number(x, f"{at} {run}") for run, x in patterns.items()}
    return found
