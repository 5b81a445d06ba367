"""A table whose rows belong to different channels, as loggers of several topics write it, on one clock.

Either each row names its channel (time, name, value), or each row fills the columns of one topic and leaves
the others empty. A log that merely lost values is neither: there all columns are filled in some row. Nor is
a log with a full column and some that are sampled more slowly. Or several columns are clocks, each of the
columns after it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from eccentric.logs.assemble import Column, Read, Recorded, on_one_clock
from eccentric.logs.limits import MOST_PARTS, SHORTEST_VECTOR
from eccentric.logs.units import seconds_in


def of_topics(read: Read, path: Path) -> Read:
    """Return a table with one row for each moment; unchanged if its rows are of one kind."""
    by_name = _named(read.columns)
    if by_name is not None:
        time, channels = by_name
        return _joined(read, channels, path, time, "rows of several channels, each named in its row")
    by_gaps = _sparse(read.columns)
    if by_gaps is not None:
        time, channels = by_gaps
        return _joined(read, channels, path, time, "rows of several topics, each with columns of its own")
    return read


def _joined(read: Read, channels: list[Recorded], path: Path, time: str, what: str) -> Read:
    start = min(c.time[0] for c in channels)
    moved = [Recorded(c.name, c.time - start, c.values, read.units.get(c.name, "")) for c in channels]
    found = on_one_clock(moved, path, (*read.notes, what), time)
    return Read(found.columns, notes=found.notes, units={**found.units, time: read.units.get(time, "")})


def of_clocks(read: Read, clocks: Sequence[int], path: Path) -> Read:
    """Return a table whose columns at these places are each the time of the columns after it.

    Equal clocks are one column; others are joined as channels of several clocks are.
    """
    names = list(read.columns)
    ends = [*clocks[1:], len(names)]
    unit = read.units.get(names[clocks[0]], "")
    groups = [(names[a], names[a + 1 : b]) for a, b in zip(clocks, ends, strict=True)]
    if any(read.columns[clock].dtype.kind != "f" for clock, _ in groups):
        return read  # a time that is text is named where it is used
    first = read.columns[groups[0][0]]
    if all(np.array_equal(read.columns[clock], first, equal_nan=True) for clock, _ in groups):
        kept = {n: x for n, x in read.columns.items() if n == groups[0][0] or n not in dict(groups)}
        units = {n: u for n, u in read.units.items() if n in kept}
        return Read(kept, read.lines, read.notes, units)
    # What is joined is in seconds, where the file says of what unit its clocks are.
    scale = seconds_in(unit)
    channels = [
        Recorded(name, scale * read.columns[clock], read.columns[name], read.units.get(name, ""))
        for clock, inside in groups
        for name in inside
    ]
    what = f"{len(groups)} groups of columns, each with a time of its own"
    found = on_one_clock(channels, path, (*read.notes, what), groups[0][0])
    units = {**found.units, groups[0][0]: "s" if unit else ""}
    return Read(found.columns, notes=found.notes, units=units)


def _named(columns: Mapping[str, Column]) -> tuple[str, list[Recorded]] | None:
    """Two columns of numbers and one of names that change from row to row."""
    texts = [name for name, x in columns.items() if x.dtype.kind != "f"]
    numbers = [name for name, x in columns.items() if x.dtype.kind == "f"]
    if len(texts) != 1 or len(numbers) != 2:
        return None
    names = columns[texts[0]]
    kinds = np.unique(names)
    changes = np.count_nonzero(names[1:] != names[:-1])
    if not 2 <= len(kinds) <= MOST_PARTS or changes < 5 * len(kinds):
        return None
    time = next((name for name in numbers if _rises(columns[name])), None)
    if time is None:
        return None
    (value,) = (name for name in numbers if name != time)
    return time, [Recorded(str(k), columns[time][names == k], columns[value][names == k]) for k in kinds]


def _sparse(columns: Mapping[str, Column]) -> tuple[str, list[Recorded]] | None:
    """A column of time, the only full one, and at least two others that are never filled in the same row."""
    numbers = {name: x for name, x in columns.items() if x.dtype.kind == "f"}
    time = next((name for name, x in numbers.items() if np.all(np.isfinite(x)) and _rises(x)), None)
    if time is None:
        return None
    there = {name: np.isfinite(x) for name, x in numbers.items() if name != time}
    there = {name: rows for name, rows in there.items() if np.count_nonzero(rows) >= SHORTEST_VECTOR}
    parts = [name for name, rows in there.items() if not np.all(rows)]
    # With another full column, each row is a moment.
    if len(parts) < len(there):
        return None
    if not any(not np.any(there[a] & there[b]) for k, a in enumerate(parts) for b in parts[k + 1 :]):
        return None
    return time, [Recorded(name, numbers[time][rows], numbers[name][rows]) for name, rows in there.items()]


def _rises(x: Column) -> bool:
    return bool(np.all(np.isfinite(x))) and len(x) > 1 and bool(np.all(np.diff(x) >= 0.0)) and x[-1] > x[0]
