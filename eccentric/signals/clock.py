"""The time axis of a log put right, and what is said of it: clocks, rows that only repeat, times of turns.

A Hall sensor and a magnet give one event a turn: the angle is exact at the events, and nothing is known
between them but that a heavy shaft turns smoothly.  So the angle is a quintic spline through the events, on
a grid of the usual turn.  A mean speed over a turn, which such loggers write beside it, belongs to the middle
of the turn and not to the row: it is not used.

Loggers of several shafts write a row for the turn of any, with the counts of all; a row counts for a shaft if
its count changes there.  Some write the count before the event, so that it changes in the next row; the even
one of the two readings is taken.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from eccentric.core import InputError, counted, so_more
from eccentric.logs import Log, mended
from eccentric.signals import limits

Severity = Literal["note", "warning"]
TURN = 2.0 * np.pi


DROPPED = ": such rows are dropped"
_DOUBTFUL = {"wrong_sign", "wrong_unit", "contradiction", "another_rig", "mismatch", "zero_angle"}


@dataclass(frozen=True)
class Finding:
    """One line about the data: `kind` (a word for tests and tables), the channel or letter, the text.

    `rows` counts the rows concerned. A "warning" makes results wrong unless it is corrected; a "note" has
    already been handled, or does little harm. `mend` is the line of the rig file that would put it right, ""
    where the log does not say which.
    """

    kind: str
    channel: str
    text: str
    rows: int
    severity: Severity
    mend: str = ""

    @property
    def doubts_the_rig(self) -> bool:
        """Whether log and rig file contradict each other: then no other conclusion is safe."""
        return self.severity == "warning" and self.kind in _DOUBTFUL


@contextmanager
def with_doubts(findings: Sequence[Finding]) -> Iterator[None]:
    """Where a log cannot be fitted, first say what in it contradicts the rig: that may be the reason."""
    try:
        yield
    except InputError as error:
        doubts = [finding.text for finding in findings if finding.doubts_the_rig]
        if type(error) is not InputError or not doubts:
            raise
        problem = f"{doubts[0]}; with this rig file: {error.statement}"
        raise InputError(error.place, problem=problem, keys=error.keys) from None


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
            f"{len(lost)} of {counted(int(np.count_nonzero(kept)), 'row')} out of order or repeated",
        )
    if lost:
        text = (
            f"{log.path}: {counted(len(lost), 'row')} with a time out of order or repeated (first:"
            f" {log.place(lost[0])}){DROPPED}"
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


def require_increasing(log: Log, rows: Integers, t: Array, begins: Any, last: float = -np.inf) -> None:
    """InputError for the first of the rows (m,) of a log whose time t [s] (m,) is not after the one before.

    Rows that begin a run, a mask (m,) or their places, follow nothing; `last` is the time before the first.
    """
    before = np.concatenate([[last], t[:-1]])
    before[begins] = -np.inf
    if len(stuck := np.flatnonzero(t <= before)):
        k = int(stuck[0])
        raise InputError(
            f"{log.path}: {log.place(int(rows[k]))}",
            problem=f"time stamps must increase, got {t[k]:.9g} s after {before[k]:.9g} s",
        )


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
        f" (first: {log.place(int(np.flatnonzero(rows)[0]))}){DROPPED}"
    )
    return Stale(rows, (Finding("frozen_tail", "time", text, count, "warning"),))


def astray(log: Log, labels: Integers, channels: Sequence[Array], kept: Mask) -> Stale:
    """The rows of which one of these channels, angles or speeds, is far from the rows on both sides of it."""
    rows = np.zeros(len(kept), dtype=bool)
    for own in _stretches(labels, kept):
        for x in channels:
            rows[own] |= far_from_others(x[own])
    count = int(np.count_nonzero(rows))
    if not count:
        return Stale(rows, ())
    text = (
        f"{log.path}: {counted(count, 'row')} with an angle or a speed far from its neighbours (first:"
        f" {log.place(int(np.flatnonzero(rows)[0]))}){DROPPED}"
    )
    return Stale(rows, (Finding("astray", "theta_m", text, count, "warning"),))


def far_from_others(x: Array) -> Mask:
    """Rows of an angle or a speed (n,) whose value no motion reaches and leaves again within a row.

    A transmission that failed, a first row left from before, a last one cut short: outside the range of all
    other rows, by steps far larger than all others. A row across the wrap of an angle is none: its step is
    about the range, or a turn.
    """
    out, steps = np.zeros(len(x), dtype=bool), np.abs(np.diff(x))
    if len(steps) < limits.FEWEST_BESIDE:
        return out
    usual = float(np.partition(steps, -2 * limits.LONE - 1)[-2 * limits.LONE - 1])
    far = steps > limits.ASTRAY * usual
    if usual <= 0.0 or not np.any(far):
        return out
    out[1:-1] = far[1:] & far[:-1] & (np.abs(x[2:] - x[:-2]) <= limits.ASTRAY * usual)
    out[0], out[-1] = far[0] and not out[1], far[-1] and not out[-2]
    low, high = float(np.min(x[~out])), float(np.max(x[~out]))
    out &= (x < low) | (x > high)
    size = np.r_[steps[:1], np.maximum(steps[:-1], steps[1:]), steps[-1:]]
    for turn in (high - low, TURN, 360.0):
        out &= np.abs(size - turn) > limits.WRAPS * turn
    return out if np.count_nonzero(out) <= limits.LONE else np.zeros_like(out)


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


@dataclass(frozen=True)
class Turns:
    """The events of one shaft: rows (n,) and turns counted up to each (n,), mended; what was mended.

    `late` says that the count of a row is that before its own event; `missed` and `double` are how many turns
    had no event, and two.
    """

    rows: Integers
    count: Array
    late: bool = False
    missed: int = 0
    double: int = 0


def turns_of(t: Array, count: Array | None) -> Turns:
    """The turns of a shaft by the times of rows t [s] (n,) and their count (n,); None: a row is a turn."""
    if count is None:
        return _mended(t, np.arange(len(t)), np.arange(len(t), dtype=float), late=False)
    changes = np.flatnonzero(np.diff(count) != 0.0)
    steps = np.abs(np.diff(count)[changes])
    if len(changes) == len(t) - 1:
        return _mended(t, np.arange(len(t)), np.concatenate([[0.0], np.cumsum(steps)]), late=False)
    total = np.cumsum(steps)
    late = _roughness(t[changes]) < limits.TURNS_SMOOTHER * _roughness(t[changes + 1])
    return _mended(t, changes if late else changes + 1, total, late=late)


def _roughness(t: Array) -> float:
    """The usual change from one turn to the next, relative to it; by the median, as some are missed."""
    lasts = np.diff(t)
    return float(np.median(np.abs(np.diff(lasts)) / lasts[1:])) if len(lasts) > 1 else 0.0


def _mended(t: Array, rows: Integers, count: Array, late: bool) -> Turns:
    """Without the second event of a turn that had two, and with the turns that had none."""
    lasts = np.diff(t[rows]) / np.maximum(np.diff(count), 1.0)
    both = lasts[1:-2] + lasts[2:-1]
    double = np.flatnonzero(_same(both, lasts[:-3]) & _same(both, lasts[3:])) + 2
    kept = np.delete(np.arange(len(rows)), double)
    steps = np.diff(count)
    steps[double - 1] = 0.0
    count = np.concatenate([[0.0], np.cumsum(steps)])[kept]
    rows, steps = rows[kept], np.diff(count)
    lasts = np.diff(t[rows]) / np.maximum(steps, 1.0)
    beside = 0.5 * (lasts[:-2] + lasts[2:])
    turns = np.round(lasts[1:-1] / beside)
    without = (turns > 1.0) & _same(lasts[:-2], lasts[2:]) & _same(lasts[1:-1], turns * beside)
    missed = np.where(without, turns - 1.0, 0.0)
    steps[1:-1] += missed
    return Turns(rows, np.concatenate([[0.0], np.cumsum(steps)]), late, int(missed.sum()), len(double))


def _same(one: Array, other: Array) -> NDArray[np.bool_]:
    return np.abs(one - other) < limits.SAME_TURN * other


@dataclass(frozen=True)
class EvenTurns:
    """The angle of a shaft on an even grid: times [s], angle [rad], and the row before each (m,)."""

    t: Array
    theta: Array
    row: Integers
    turns: tuple[Turns, ...]

    def finding(self, path: str) -> Finding:
        """What was mended."""
        late = any(found.late for found in self.turns)
        missed, double = (sum(getattr(found, name) for found in self.turns) for name in ("missed", "double"))
        said = [
            f"{missed} missed" if missed else "",
            f"{double} doubled" if double else "",
            "counts late" if late else "",
        ]
        used = sum(len(found.rows) for found in self.turns)
        text = f"{path}: {', '.join(filter(None, [counted(used, 'turn'), *said]))}"
        return Finding("turns", "theta", text, missed + double, "warning" if any(said) else "note")


def even_turns(t: Array, count: Array | None, run: Integers, names: Sequence[str], path: str) -> EvenTurns:
    """The angle by the times of turns, between events that take less than twice as long as those beside.

    Args:
        t: times of the rows [s] (n,).
        count: turns up to each row (n,); None where each row is a turn.
        run: number of the run (n,), from 0; `names` are theirs; `path` is the log's, for messages.

    Raises InputError for a run with too few turns.
    """
    parts: list[tuple[Array, Array, Integers]] = []
    every: list[Turns] = []
    for own in np.split(np.arange(len(t)), np.flatnonzero(np.diff(run)) + 1):
        found = turns_of(t[own], None if count is None else count[own])
        at, rows = t[own][found.rows], own[found.rows]
        pieces = _steady(at)
        longest = max(map(len, pieces))
        if longest < limits.FEWEST_TURNS:
            raise InputError(
                f"{path}: run {names[int(run[own[0]])]!r}",
                f"at least {limits.FEWEST_TURNS} turns without a jump of the speed",
                f"{longest}",
                why="with events = 'revolution'",
            )
        every.append(found)
        step = float(np.median(np.diff(at) / np.diff(found.count)))
        for piece in [piece for piece in pieces if len(piece) >= limits.FEWEST_TURNS]:
            start, before = float(at[piece[0]]), at[piece]
            grid = np.arange(start, before[-1], step)
            spline = make_interp_spline(before - start, TURN * found.count[piece], k=5)
            place = rows[piece][np.searchsorted(before, grid, side="right") - 1]
            parts.append((grid, np.asarray(spline(grid - start)), place))
    grid, theta, place = (np.concatenate(some) for some in zip(*parts, strict=True))
    return EvenTurns(grid, theta, place, tuple(every))


def _steady(t: Array) -> list[Integers]:
    """The events (n,) in pieces between which a turn takes more than twice as long as the one beside it."""
    lasts = np.diff(t)
    jumps = np.flatnonzero(np.abs(np.log(lasts[1:] / lasts[:-1])) > np.log(limits.CHANGED_TURN)) + 1
    return np.split(np.arange(len(t)), jumps)
