"""The clocks of a log's runs put right, and what is said of it; rows at the end that only repeat."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, counted, so_more
from eccentric.logs import Log, mended
from eccentric.signals import limits
from eccentric.signals.finding import Finding

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


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
        # A recording of one or two rows has no motion: its rows are damaged ones.
        alone = (
            np.bincount(found.part[found.kept], minlength=int(found.part[-1]) + 1)
            < limits.FEWEST_OF_A_RECORDING
        )
        of_one = alone[found.part] & bool(found.part[-1])
        good[own] = found.kept & ~of_one
        lost += own[~good[own]].tolist()
        again += own[1:][np.diff(found.part) > 0].tolist()
        if found.packet[0]:
            packets.append((*found.packet, len(own)))
    said: list[Finding] = []
    if len(lost) > limits.MOST_REJECTED * np.count_nonzero(kept):
        raise InputError(
            f"{log.path}: {log.place(lost[0])}",
            "time stamps that increase",
            f"{len(lost)} of {counted(int(np.count_nonzero(kept)), 'row')} out of order or twice",
        )
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
class Stale:
    """Rows (n,) that say nothing new, and what is said of them."""

    rows: Mask
    findings: tuple[Finding, ...]


def frozen_tails(log: Log, labels: Integers, channels: Sequence[Array], kept: Mask) -> Stale:
    """The rows at the end of a run that all repeat one, where nearly every row before them differs.

    A logger that has lost its device goes on writing its last values. At rest, without noise, rows repeat as
    well: then they do so before the end, too.
    """
    rows = np.zeros(len(kept), dtype=bool)
    for own in _stretches(labels, kept):
        same = np.logical_and.reduce([x[own][1:] == x[own][:-1] for x in channels])
        changes = np.flatnonzero(~same)
        if len(changes) < limits.FROZEN_ROWS:
            continue
        tail = len(same) - 1 - int(changes[-1])
        usual = len(changes) / (changes[-1] + 1.0)
        longest = int(np.max(np.diff(changes), initial=1))
        if tail >= max(limits.FROZEN_ROWS, limits.FROZEN_TIMES * longest) and usual >= limits.CHANGING:
            rows[own[len(own) - tail :]] = True
    count = int(np.count_nonzero(rows))
    if not count:
        return Stale(rows, ())
    text = (
        f"{log.path}: {counted(count, 'row')} at the end of a run repeat the one before in every channel"
        f" (first: {log.place(int(np.flatnonzero(rows)[0]))}): such rows are dropped"
    )
    return Stale(rows, (Finding("frozen_tail", "time", text, count, "warning"),))


def polled(log: Log, labels: Integers, channels: Sequence[Array], kept: Mask) -> Stale:
    """The rows that a logger wrote again because its source had nothing new, most of a log.

    A source that is polled too often changes all its channels at once, or none; channels that merely have
    coarse steps change one by one. At rest a row is kept in the usual time between two changes.
    """
    rows = np.zeros(len(kept), dtype=bool)
    changed = np.ones(len(kept), dtype=bool)
    often = np.zeros(len(channels))
    count = 0
    for own in _stretches(labels, kept):
        each = np.array([x[own][1:] != x[own][:-1] for x in channels])
        changed[own[1:]] = np.any(each, axis=0)
        often += each.sum(axis=1)
        count += len(own) - 1
    new = int(np.count_nonzero(changed[kept]))
    if not count or new > limits.MOST_NEW * count or new > limits.AT_ONCE * float(np.max(often)):
        return Stale(rows, ())
    for own in _stretches(labels, kept):
        news = np.flatnonzero(changed[own])
        every = max(1, round(float(np.median(np.diff(news)))) if len(news) > 1 else 1)
        latest = np.searchsorted(news, np.arange(len(own)), side="right") - 1
        since, lasts = np.arange(len(own)) - news[latest], np.diff(news, append=len(own))[latest]
        # What lasts longer than a gap in time is rest: without any row it would be one.
        rows[own] = (since > 0) & ((lasts <= limits.GAP_STEPS * every) | (since % every != 0))
    dropped = int(np.count_nonzero(rows))
    text = (
        f"{log.path}: {dropped} of {counted(count, 'row')} repeat the one before in every channel: the log is"
        " written faster than its source changes; such rows are dropped"
    )
    return Stale(rows, (Finding("polled", "time", text, dropped, "note"),))


def _stretches(labels: Integers, kept: Mask) -> list[Integers]:
    """The kept rows of each run, in order."""
    rows = np.flatnonzero(kept)
    if not len(rows):
        return []
    return np.split(rows, np.flatnonzero(np.diff(labels[rows]) != 0) + 1)
