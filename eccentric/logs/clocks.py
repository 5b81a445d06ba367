"""Clocks: one that is put right, and several that become one.

A logger that receives packets of rows gives all rows of one the same time; a recording that is started again
appends to the file of the last one; an export can list the newest row first. Such a clock is put right where
there is one way to do it.

Channels that were recorded on clocks of their own become columns on one of them, whether a file stores them
apart or a table has rows, or groups of columns, of several channels.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, counted, few
from eccentric.logs import limits
from eccentric.logs.assemble import Column, Read
from eccentric.logs.units import seconds_in

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Mended:
    """A clock put right, for rows (n,) of one run.

    `t` are its times, `kept` the rows whose time fits between those beside it, `part` the number of the
    recording of each row, from 0. `packet` is how many rows share a stamp and how long they last, (0, 0.0)
    where each has its own.
    """

    t: Array
    kept: Mask
    part: Integers
    packet: tuple[int, float] = (0, 0.0)


def falls(t: Array) -> bool:
    """Whether a clock (n,) runs backwards: nearly every step of it that is one is downwards."""
    steps = np.diff(t[np.isfinite(t)])
    steps = steps[steps != 0.0]
    return len(steps) > 2 and bool(np.count_nonzero(steps < 0.0) > limits.FALLING * len(steps))


def mended(t: Array) -> Mended:
    """Put the clock (n,) of one run right; its times are numbers.

    A few rows out of order are not kept, as is a first row that is left from another time. Where rows share
    stamps, they are spread evenly up to the next stamp. Any other fall starts another recording.
    """
    kept = np.ones(len(t), dtype=bool)
    part = np.zeros(len(t), dtype=np.int64)
    if len(t) < 2 or bool(np.all(np.diff(t) > 0.0) and not _is_stale(t)):
        return Mended(t, kept, part)
    kept[0] = not _is_stale(t)
    starts = [0]
    for k in np.flatnonzero(np.diff(t) < 0.0).tolist():
        if not kept[k] or not kept[k + 1]:
            continue
        out = _out_of_order(t, k)
        if out is None:
            starts.append(k + 1)
        else:
            kept[out] = False
    part[starts[1:]] = 1
    part = np.cumsum(part)
    rows = np.flatnonzero(kept)
    again = np.flatnonzero((np.diff(t[rows]) <= 0.0) & (np.diff(part[rows]) == 0)) + 1
    if len(again) < limits.FEWEST_IN_PACKETS * len(rows):
        # A stamp that two rows share by mistake: the second would have to be guessed.
        kept[rows[again]] = False
        return Mended(t, kept, part)
    fine, packet = t.copy(), (0, 0.0)
    for number in range(int(part[-1]) + 1):
        own = rows[part[rows] == number]
        if len(own) > 1:
            fine[own], found = _spread(t[own])
            packet = max(packet, found)
    return Mended(fine, kept, part, packet)


def _is_stale(t: Array) -> bool:
    """Whether the first time is one of another recording: many times as far away as all others last."""
    return len(t) >= limits.FEWEST_AFTER and t[1] - t[0] > limits.FAR_AWAY * float(t[-1] - t[1]) > 0.0


def _out_of_order(t: Array, k: int) -> slice | None:
    """The rows at the fall after row k that do not belong between those beside them; None if many."""
    for m in range(1, limits.MOST_OUT_OF_ORDER + 1):
        if k - m < 0 or t[k + 1] > t[k - m]:
            return slice(max(0, k - m + 1), k + 1)
        if k + 1 + m < len(t) and t[k + 1 + m] > t[k]:
            return slice(k + 1, k + 1 + m)
    return None


def _spread(t: Array) -> tuple[Array, tuple[int, float]]:
    """Rows that share a stamp, evenly up to the next, or all at one rate where no stamp contradicts that.

    Also the usual number of rows with one stamp, and how long they last.
    """
    first = np.flatnonzero(np.diff(t, prepend=-np.inf) > 0.0)
    size = np.diff(np.append(first, len(t)))
    lasts = np.diff(t[first])
    if not len(lasts):
        return t, (0, 0.0)
    row = float(np.median(lasts / size[:-1]))
    # A gap before the next stamp is none of the packet's.
    lasts = np.append(lasts, row * size[-1])
    each = np.where(lasts > limits.LONGEST_BREAK * row * size, row, lasts / size)
    place = np.arange(len(t)) - np.repeat(first, size)
    usual = int(np.median(size))
    fine = t + place * np.repeat(each, size)
    # A row that slipped into the next packet was taken in time all the same, if all were at one rate.
    even = t[0] + np.polyval(np.polyfit(first, t[first] - t[0], 1), np.arange(len(t)))
    if np.all(np.abs(even - fine) <= usual * row):
        fine = even + float(np.median(fine - even))
    return fine, (usual, usual * row)


# Channels that were recorded on clocks of their own, as columns on one of them.
#
# The clock with the most rows is kept as it is, within the time that it shares with the channels of a
# similar rate. Other channels are interpolated linearly between their samples, and what is whole numbers or
# text keeps its last value: a mode has no value in between. A slow channel, or one that was recorded for a
# part of the time, does not shorten the log: outside its own time it has no value. The notes say so.


TIME = "time_s"
"""The column of the time that all channels were put on."""


@dataclass(frozen=True)
class Recorded:
    """A signal: time [s] (n,), not falling, and values (n,), numbers or text."""

    name: str
    time: NDArray[np.float64]
    values: Column
    unit: str = ""


def on_one_clock(
    channels: Sequence[Recorded], path: Path | str, notes: Sequence[str] = (), time: str = TIME
) -> Read:
    """Return the channels as columns on the clock of the one with the most rows, whose times are in `time`.

    Raises:
        InputError: no channel has rows, or those on other clocks share no time with it.
    """
    filled = [c for c in (_clean(c) for c in channels) if len(c.time) > 1]
    if not filled:
        empty = f"{path}: expected a log with numbers over time, got none"
        raise InputError("; ".join((empty, *notes)))
    lead = max(filled, key=lambda c: len(c.time))
    others = [c for c in filled if not np.array_equal(c.time, lead.time)]
    similar = [lead, *(c for c in others if _is_similar(c, lead))]
    first, last = max(c.time[0] for c in similar), min(c.time[-1] for c in similar)
    rows = (lead.time >= first) & (lead.time <= last)
    t = lead.time[rows]
    if len(t) < 2 or (others and not any(_seconds_shared(c, lead) > 0.0 for c in others)):
        first, last = max(c.time[0] for c in filled), min(c.time[-1] for c in filled)
        raise InputError(
            path,
            "channels that share a time",
            (
                f"{lead.name} from {lead.time[0]:.6g} to {lead.time[-1]:.6g} s and others from {first:.6g}"
                f" or to {last:.6g} s"
            ),
        )
    columns: dict[str, Column] = {time: t - t[0]}
    units = {time: "s"}
    linear, held, partly = [], [], []
    for c in filled:
        name = _free(c.name, columns)
        if c.unit:
            units[name] = c.unit
        if np.array_equal(c.time, lead.time):
            columns[name] = c.values[rows]
            continue
        # Up to the time of its next sample, a channel is where it was.
        step = float(np.median(np.diff(c.time)))
        outside = t < c.time[0] - step
        if _is_held(c.values):
            columns[name] = c.values[np.clip(np.searchsorted(c.time, t, "right") - 1, 0, None)]
            held.append(name)
        else:
            columns[name] = np.interp(t, c.time, c.values)
            linear.append(name)
            outside |= t > c.time[-1] + step
        if np.any(outside):
            columns[name] = np.where(outside, np.nan if c.values.dtype.kind != "U" else "", columns[name])
            partly.append(name)
    said = [*notes]
    if linear or held:
        how = [
            f"{few(names, 5)} {words}"
            for names, words in ((linear, "linearly"), (held, "by the last value"))
            if names
        ]
        said.append(f"put on the clock of {lead.name}, {len(t)} rows: {'; '.join(how)}")
    if partly:
        said.append(f"without a value in rows outside their own time: {few(partly, 5)}")
    if len(t) < len(lead.time):
        said.append(
            f"{len(lead.time) - len(t)} rows of {lead.name} are left out, before or after other channels"
        )
    return Read(columns, notes=tuple(said), units=units)


def _is_similar(c: Recorded, lead: Recorded) -> bool:
    """Whether a channel was recorded at a similar rate, and for most of the time."""
    many = len(c.time) >= limits.SIMILAR_RATE * len(lead.time)
    return many and _seconds_shared(c, lead) >= limits.SIMILAR_TIME * (lead.time[-1] - lead.time[0])


def _seconds_shared(c: Recorded, lead: Recorded) -> float:
    return float(min(c.time[-1], lead.time[-1]) - max(c.time[0], lead.time[0]))


def _clean(c: Recorded) -> Recorded:
    """Without samples that are no numbers or have no time, in the order of time."""
    good = np.isfinite(c.time)
    if c.values.dtype.kind == "f":
        good &= np.isfinite(c.values)
    time, values = c.time[good], c.values[good]
    if len(time) and np.any(np.diff(time) < 0.0):
        order = np.argsort(time, kind="stable")
        time, values = time[order], values[order]
    return Recorded(c.name, time, values, c.unit)


def _is_held(values: Column) -> bool:
    return values.dtype.kind != "f" or bool(np.all(values == np.round(values)))


def _free(name: str, taken: dict[str, Column]) -> str:
    if name not in taken:
        return name
    return next(f"{name}#{k}" for k in range(2, len(taken) + 3) if f"{name}#{k}" not in taken)


def of_topics(read: Read, path: Path) -> Read:
    """Return a table with one row for each moment; unchanged if its rows are of one kind."""
    by_name = _named(read.columns)
    if by_name is not None:
        time, channels = by_name
        lost = len(read.columns[time]) - sum(len(c.time) for c in channels) // (len(read.columns) - 2)
        what = "rows of several channels, each named in its row"
        what += f"; left out: {counted(lost, 'incomplete row')}" if lost else ""
        return _joined(read, channels, path, time, what)
    by_gaps = _sparse(read.columns)
    if by_gaps is not None:
        time, channels = by_gaps
        return _joined(read, channels, path, time, "rows of several topics, each with columns of its own")
    return read


def _joined(read: Read, channels: list[Recorded], path: Path, time: str, what: str) -> Read:
    start = min(c.time[0] for c in channels)
    units = {
        c.name: read.units.get(c.name) or read.units.get(c.name.rpartition("/")[2], "") for c in channels
    }
    moved = [Recorded(c.name, c.time - start, c.values, units[c.name]) for c in channels]
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
    """A column of time, one of names that change from row to row, and others of numbers.

    With one value beside the time, rows are in any order; with several, each time has a row of every name, or
    the column is called as one of joints or motors is. Names may be numbers of these.
    """
    texts = [name for name, x in columns.items() if x.dtype.kind != "f"]
    numbers = [name for name, x in columns.items() if x.dtype.kind == "f"]
    time = next((name for name in numbers if _rises(columns[name])), None)
    if len(texts) > 1 or time is None:
        return None
    for key in texts or [name for name in numbers if _JOINT.search(name)]:
        names, values = columns[key], [name for name in numbers if name not in (time, key)]
        kinds, which = np.unique(names, return_inverse=True)
        changes = np.count_nonzero(names[1:] != names[:-1])
        if not 2 <= len(kinds) <= limits.MOST_PARTS or changes < 5 * len(kinds) or not values:
            continue
        if texts and len(values) == 1:
            rows, called = [which == k for k in range(len(kinds))], list(map(str, kinds))
            return time, [
                Recorded(name, columns[time][own], columns[values[0]][own])
                for name, own in zip(called, rows, strict=True)
            ]
        kept = _cycles(columns[time], which, len(kinds))
        whole = bool(texts) or all(float(kind).is_integer() for kind in kinds)
        if kept is None and not (whole and _MACHINE.fullmatch(key) and changes > 0.5 * len(names)):
            continue  # a mode, a direction or a speed in steps that changes often is of one machine
        # Without its "id", which says of no quantity what it is.
        machine = _ID.sub("", key).strip(" _-.") or "joint"
        return time, [
            Recorded(f"{name}/{value}", columns[time][own], columns[value][own])
            for k, kind in enumerate(kinds)
            for name, own in [
                (
                    str(kind) if texts else f"{machine} {kind:g}",
                    (which == k) & (True if kept is None else kept),
                )
            ]
            for value in values
        ]
    return None


def _cycles(t: Column, which: NDArray[np.int64], kinds: int) -> Mask | None:
    """The rows whose time has one of every kind, without the few that were cut off; None if most have not."""
    _, stamp = np.unique(t, return_inverse=True)
    each = np.zeros((int(stamp[-1]) + 1, kinds), dtype=int)
    np.add.at(each, (stamp, which), 1)
    full = np.all(each == 1, axis=1)
    return full[stamp] if np.mean(full) > limits.WHOLE_CYCLES else None


_JOINT = re.compile(r"(?<![a-z])(id|joint|motor|axis|servo|actuator|device|node)(?![a-z])", re.IGNORECASE)
"""What a column is called that says of which of several machines a row is."""
_MACHINE = re.compile(
    r"(id|(joint|motor|axis|servo|actuator|device|node)([\s_.-]*(id|no|nr|number|index|name))?)",
    re.IGNORECASE,
)
"""The whole name of a column that can say nothing else."""
_ID = re.compile(r"(?<![a-z])id(?![a-z])", re.IGNORECASE)


def _sparse(columns: Mapping[str, Column]) -> tuple[str, list[Recorded]] | None:
    """A column of time, the only full one, and at least two others that are never filled in the same row."""
    numbers = {name: x for name, x in columns.items() if x.dtype.kind == "f"}
    time = next((name for name, x in numbers.items() if np.all(np.isfinite(x)) and _rises(x)), None)
    if time is None:
        return None
    there = {name: np.isfinite(x) for name, x in numbers.items() if name != time}
    there = {name: rows for name, rows in there.items() if np.count_nonzero(rows) >= limits.SHORTEST_VECTOR}
    parts = [name for name, rows in there.items() if not np.all(rows)]
    # With another full column, each row is a moment.
    if len(parts) < len(there):
        return None
    if not any(not np.any(there[a] & there[b]) for k, a in enumerate(parts) for b in parts[k + 1 :]):
        return None
    return time, [Recorded(name, numbers[time][rows], numbers[name][rows]) for name, rows in there.items()]


def _rises(x: Column) -> bool:
    return bool(np.all(np.isfinite(x))) and len(x) > 1 and bool(np.all(np.diff(x) >= 0.0)) and x[-1] > x[0]
