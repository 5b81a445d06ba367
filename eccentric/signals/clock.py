"""The clock of a log as it should have been written: stamps of packets, clocks that start again or fall.

A logger that receives packets of rows gives all rows of one the same time; a recording that is started again
appends to the file of the last one; an export can list the newest row first. Such a clock is put right where
there is one way to do it, and everything that was done is reported.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.core import counted, so_more
from eccentric.logs import Log
from eccentric.signals.finding import Finding
from eccentric.signals.limits import (
    CHANGING,
    FALLING,
    FEWEST_IN_PACKETS,
    FROZEN_ROWS,
    FROZEN_TIMES,
    LONGEST_BREAK,
    MOST_OUT_OF_ORDER,
)

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
    return len(steps) > 2 and bool(np.count_nonzero(steps < 0.0) > FALLING * len(steps))


def backwards(log: Log) -> Log:
    """Return a log with its last row first."""
    return log.rows_of(slice(None, None, -1))


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
    if len(again) < FEWEST_IN_PACKETS * len(rows):
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
    """Whether the first time is one of another recording: further away than all others last."""
    return len(t) > LONGEST_BREAK and t[1] - t[0] > 10.0 * float(t[-1] - t[1]) > 0.0


def _out_of_order(t: Array, k: int) -> slice | None:
    """The rows at the fall after row k that do not belong between those beside them; None if many."""
    for m in range(1, MOST_OUT_OF_ORDER + 1):
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
    each = np.where(lasts > LONGEST_BREAK * row * size, row, lasts / size)
    place = np.arange(len(t)) - np.repeat(first, size)
    usual = int(np.median(size))
    fine = t + place * np.repeat(each, size)
    # A row that slipped into the next packet was taken in time all the same, if all were at one rate.
    even = t[0] + np.polyval(np.polyfit(first, t[first] - t[0], 1), np.arange(len(t)))
    if np.all(np.abs(even - fine) <= usual * row):
        fine = even + float(np.median(fine - even))
    return fine, (usual, usual * row)


@dataclass(frozen=True)
class ClockOfLog:
    """The clock of all rows (n,) of a log, that of each run put right; fields as of `Mended`."""

    t: Array
    kept: Mask
    part: Integers
    findings: tuple[Finding, ...]


def clock_of(log: Log, labels: Integers, t: Array, kept: Mask) -> ClockOfLog:
    """Put the clock of every run of a log right.

    Args:
        log: for messages.
        labels: (n,) the same for rows of one run.
        t: (n,) its times [s].
        kept: (n,) the rows that count; a time is a number there.
    """
    fine, good, part = t.copy(), kept.copy(), np.zeros(len(t), dtype=np.int64)
    lost: list[int] = []
    again: list[int] = []
    packets: list[tuple[int, float, int]] = []
    for own in _stretches(labels, kept):
        found = mended(t[own])
        fine[own], part[own] = found.t, found.part
        good[own] = found.kept
        lost += own[~found.kept].tolist()
        again += own[1:][np.diff(found.part) > 0].tolist()
        if found.packet[0]:
            packets.append((*found.packet, len(own)))
    said: list[Finding] = []
    if lost:
        text = (
            f"{log.path}: {counted(len(lost), 'row')} with a time out of order or twice (first:"
            f" {log.place(lost[0])}): such rows are dropped"
        )
        said.append(Finding("bad_time", "time", text, len(lost), "warning"))
    if again:
        text = (
            f"{log.path}: time starts again at {log.place(again[0])}{so_more(len(again) - 1)}: each recording"
            " is a run, unless a column for run says otherwise"
        )
        said.append(Finding("restart", "run", text, len(again), "warning"))
    if packets:
        size, lasts, _ = max(packets)
        text = (
            f"{log.path}: groups of {size} rows share one time stamp (packets of {lasts:.3g} s): they are"
            " spread evenly up to the next stamp"
        )
        said.append(Finding("packets", "time", text, sum(rows for *_, rows in packets), "warning"))
    return ClockOfLog(fine, good, part, tuple(said))


def reversed_time(log: Log) -> Finding:
    """What is said of a log that was turned round."""
    text = f"{log.path}: time runs backwards: its last row is taken for the first"
    return Finding("reversed", "time", text, log.rows, "note")


@dataclass(frozen=True)
class Tails:
    """Rows (n,) at the ends of runs in which no channel changes any more, and what is said of them."""

    rows: Mask
    findings: tuple[Finding, ...]


def frozen_tails(log: Log, labels: Integers, channels: Sequence[Array], kept: Mask) -> Tails:
    """The rows at the end of a run that all repeat one, where nearly every row before them differs.

    A logger that has lost its device goes on writing its last values. At rest, without noise, rows repeat as
    well: then they do so before the end, too.
    """
    rows = np.zeros(len(kept), dtype=bool)
    for own in _stretches(labels, kept):
        same = np.logical_and.reduce([x[own][1:] == x[own][:-1] for x in channels])
        changes = np.flatnonzero(~same)
        if len(changes) < FROZEN_ROWS:
            continue
        tail = len(same) - 1 - int(changes[-1])
        usual = len(changes) / (changes[-1] + 1.0)
        longest = int(np.max(np.diff(changes), initial=1))
        if tail >= max(FROZEN_ROWS, FROZEN_TIMES * longest) and usual >= CHANGING:
            rows[own[len(own) - tail :]] = True
    count = int(np.count_nonzero(rows))
    if not count:
        return Tails(rows, ())
    text = (
        f"{log.path}: in the last {counted(count, 'row')} of a run no channel changes (first:"
        f" {log.place(int(np.flatnonzero(rows)[0]))}), in nearly all others some does: such rows are dropped"
    )
    return Tails(rows, (Finding("frozen_tail", "time", text, count, "warning"),))


def _stretches(labels: Integers, kept: Mask) -> list[Integers]:
    """The kept rows of each run, in order."""
    rows = np.flatnonzero(kept)
    if not len(rows):
        return []
    return np.split(rows, np.flatnonzero(np.diff(labels[rows]) != 0) + 1)
