"""Logs as one table in SI: columns mapped to channels, runs numbered, rows that are not numbers dropped."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from textwrap import shorten
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, few
from eccentric.logs import Log, LogSource, falls, log_stems, read_log
from eccentric.rigs import Rig
from eccentric.signals import limits
from eccentric.signals.clock import (
    DROPPED,
    TURN,
    ClockOfLog,
    Finding,
    Stale,
    astray,
    clock_of,
    even_turns,
    frozen_tails,
    polled,
    require_increasing,
    reversed_time,
)
from eccentric.signals.converted import CONTROLLER, converted, named_apart, run_numbers

# The held-out part of a log: named by the rig, or by a rule that is recorded.


Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
_ORDINALS = ("first", "second", "third", "fourth", "fifth")


@dataclass(frozen=True)
class Holdout:
    """Held-out rows (n,), the rule in a sentence, and the intervals [s] that they cover, in row order."""

    rows: NDArray[np.bool_]
    rule: str
    intervals_s: tuple[tuple[float, float], ...]

    @property
    def brief(self) -> str:
        """The rule shortened to one line: a log may have hundreds of runs."""
        return shorten(self.rule, 100, placeholder=" ...")


def hold_out(
    t: Array, run: NDArray[np.int64], run_names: tuple[str, ...], off: NDArray[np.bool_], rig: Rig
) -> Holdout:
    """Return the held-out part of rows with times t [s], run numbers and the motor switched off, each (n,).

    If the rig names intervals (in every run) or runs, those are held out. Otherwise it is every fifth run
    from the third on if there are three or more, else five contiguous blocks, the middle fifth of each fifth
    of the rows. If that would take all rows with the motor off, or all with it on, to one side, or hold out
    all that carry an added mass, or all that do not, every fifth run is counted from another one.

    Raises InputError for a run that is not in the log, and for intervals without rows.
    """
    if rig.holdout.intervals_s or rig.holdout.runs:
        rows, rule = _named(t, run, run_names, rig)
        if not rig.holdout.runs and len(run_names) == 1:
            return Holdout(rows, rule, rig.holdout.intervals_s)
    elif len(run_names) >= limits.FEWEST_RUNS_HELD_OUT:
        first, rows = _every_fifth(run, len(run_names), off, carriers(run, run_names, rig.added))
        names = ", ".join(run_names[k] for k in np.unique(run[rows]))
        rule = f"whole runs, every fifth from the {_ORDINALS[first]} on: {names}"
    else:
        position = (np.arange(len(t)) / len(t) * limits.HELD_OUT_BLOCKS) % 1.0
        rows = np.abs(position - 0.5) < limits.HELD_OUT_PART / 2.0
        part = f"{100 * limits.HELD_OUT_PART:.0f} % of the rows"
        rule = f"{limits.HELD_OUT_BLOCKS} contiguous blocks, {part}, evenly spread"
    return Holdout(rows, rule, _intervals(t, run, rows))


def carriers(run: NDArray[np.int64], run_names: Sequence[str], patterns: Iterable[str]) -> Mask:
    """Rows (n,) of the runs that match any of the names or patterns."""
    named = [k for k, name in enumerate(run_names) if any(fnmatch.fnmatchcase(name, p) for p in patterns)]
    return np.isin(run, named)


def _every_fifth(run: NDArray[np.int64], count: int, off: Mask, carrying: Mask) -> tuple[int, Mask]:
    """The first of every fifth of `count` runs, and their rows: the third, unless that splits them badly.

    Only rows with the motor off separate back-EMF from viscous friction, and only driven ones are scored.
    Only rows of two masses show what their difference does.
    """

    def suits(rows: Mask) -> bool:
        swings = not np.any(off) or bool(np.any(off & ~rows) and np.any(rows & ~off) and np.any(~off & ~rows))
        loads = not np.any(carrying) or np.all(carrying)
        return swings and bool(loads or (np.any(carrying & ~rows) and np.any(~carrying & ~rows)))

    every = {
        first: np.isin(run, range(first, count, round(1.0 / limits.HELD_OUT_PART)))
        for first in (2, 3, 4, 0, 1)
        if first < count
    }
    suited = (first for first, rows in every.items() if suits(rows))
    chosen = next(suited, 2)
    return chosen, every[chosen]


def _named(
    t: Array, run: NDArray[np.int64], run_names: tuple[str, ...], rig: Rig
) -> tuple[NDArray[np.bool_], str]:
    rows = np.zeros(len(t), dtype=bool)
    parts: list[str] = []
    for start, end in rig.holdout.intervals_s:
        rows |= (t >= start) & (t <= end)
    if rig.holdout.intervals_s and not np.any(rows):
        given = few(f"[{start:g}, {end:g}]" for start, end in rig.holdout.intervals_s)
        raise InputError(
            rig.path,
            problem=f"holdout_intervals_s: expected an interval with rows of the log; the log goes "
            f"from {np.min(t):.6g} to {np.max(t):.6g} s, got {given}: "
            "is time in s, and the log complete?",
        )
    if rig.holdout.intervals_s:
        parts.append(f"{len(rig.holdout.intervals_s)} intervals from the rig file")
    chosen = matching(rig.holdout.runs, run_names, f"{rig.path}: holdout_runs")
    rows |= np.isin(run, [run_names.index(name) for name in chosen])
    if chosen:
        parts.append(f"runs from the rig file: {', '.join(chosen)}")
    return rows, "; ".join(parts)


def matching(patterns: Sequence[str], run_names: Sequence[str], where: str) -> list[str]:
    """Return the runs that match any of the names or patterns (`*`, `?`), in the order of the log.

    Raises InputError for a name or pattern that matches no run.
    """
    for pattern in patterns:
        if not fnmatch.filter(run_names, pattern):
            raise InputError(where, f"one of {few(run_names)}", f"{pattern!r}")
    return [name for name in run_names if any(fnmatch.fnmatchcase(name, p) for p in patterns)]


def _intervals(t: Array, run: NDArray[np.int64], rows: NDArray[np.bool_]) -> tuple[tuple[float, float], ...]:
    """First and last time of each contiguous stretch of held-out rows."""
    label = np.where(rows, run, -1)
    begins = np.flatnonzero(np.concatenate([[True], label[1:] != label[:-1]]))
    ends = np.concatenate([begins[1:], [len(t)]]) - 1
    return tuple((float(t[a]), float(t[b])) for a, b in zip(begins, ends, strict=True) if rows[a])


# The rows of all logs as one table, and what is unusual about them.


@dataclass(frozen=True)
class Table:
    """Kept rows of all logs: channels by name in SI (temperature in degC), run number, masks; all (n,).

    `use` are the rows selected by the rig, `motor_off` those with the motor switched off and the link
    swinging freely. `after_dropped` are those whose previous row in the log was dropped, `after_skipped`
    those whose previous rows were not chosen from a long log, of which `is_excerpt` says that rows were.
    """

    channels: Mapping[str, Array]
    run: NDArray[np.int64]
    run_names: tuple[str, ...]
    use: NDArray[np.bool_]
    motor_off: NDArray[np.bool_]
    after_dropped: NDArray[np.bool_]
    after_skipped: NDArray[np.bool_]
    rows_read: int
    rows_rejected: int
    findings: tuple[Finding, ...]
    is_excerpt: bool

    def at(self, rows: NDArray[np.int64], channels: Mapping[str, Array], **more: Any) -> Table:
        """Return a table of other channels (m,), whose entries belong to these rows (m,) of this one."""
        masks = ("run", "use", "motor_off", "after_dropped", "after_skipped")
        return replace(
            self, **{"channels": channels, **{name: getattr(self, name)[rows] for name in masks}, **more}
        )


def read_table(logs: Sequence[LogSource], rig: Rig) -> Table:
    """Read and join logs, each a path, a table in memory or a Log.

    A row that repeats the one before it is dropped, like one that is not numbers.
    Raises InputError for what `read_log` refuses, a missing or non-numeric column, more than 20 % of rows
    that are not numbers, time stamps that do not increase within a run, a run in two pieces, and logs with
    different channels.
    """
    if not logs:
        raise InputError("", "a log", "none")
    read = [read_log(log) for log in logs]
    own = named_apart([[log] for log in read], rig)
    read, stems = of_runs(read, rig)
    tables = [_one(log, rig, stem, alone=own) for log, stem in zip(read, stems, strict=True)]
    names = set(tables[0].channels)
    for log, table in zip(read, tables, strict=True):
        if set(table.channels) != names:
            differ = few(sorted(names ^ set(table.channels)))
            raise InputError(log.path, "the same channels", f"in some only: {differ}", why="in every log")
    joined = tables[0] if len(tables) == 1 else _joined(tables)
    _require_carriers(joined.run_names, rig)
    return joined


def _require_carriers(run_names: Sequence[str], rig: Rig) -> None:
    """InputError for an added mass that no run carries, and for a run with two."""
    carried: dict[str, str] = {}
    for pattern in rig.added:
        for name in matching([pattern], run_names, f"{rig.path}: [added]"):
            if name in carried:
                raise InputError(
                    f"{rig.path}: [added]",
                    "one mass for a run",
                    f"{carried[name]!r} and {pattern!r} for {name!r}",
                )
            carried[name] = pattern


def _joined(tables: Sequence[Table]) -> Table:
    """Tables of the same channels as one, their runs numbered on."""
    offsets = np.cumsum([0, *(len(table.run_names) for table in tables)])
    masks = ("use", "motor_off", "after_dropped", "after_skipped")
    return Table(
        channels={
            name: np.concatenate([table.channels[name] for table in tables]) for name in tables[0].channels
        },
        run=np.concatenate([table.run + offset for table, offset in zip(tables, offsets, strict=False)]),
        run_names=tuple(name for table in tables for name in table.run_names),
        **{name: np.concatenate([getattr(table, name) for table in tables]) for name in masks},
        rows_read=sum(table.rows_read for table in tables),
        rows_rejected=sum(table.rows_rejected for table in tables),
        findings=tuple(finding for table in tables for finding in table.findings),
        is_excerpt=any(table.is_excerpt for table in tables),
    )


def of_runs(logs: Sequence[Log], rig: Rig) -> tuple[list[Log], list[str]]:
    """The rows of the runs that the rig names, and what the logs that have some are called.

    Nothing in another run counts, whatever it is. Raises InputError for a run that no log has.
    """
    stems, alone = list(log_stems(logs)), named_apart([[log] for log in logs], rig)
    if not rig.log.runs:
        return list(logs), stems
    runs = [run_numbers(log, rig, stem, alone) for log, stem in zip(logs, stems, strict=True)]
    names = list(dict.fromkeys(name for _, called in runs for name in called))
    chosen = matching(rig.log.runs, names, f"{rig.path}: runs")
    found: list[tuple[Log, str]] = []
    for log, stem, (number, called) in zip(logs, stems, runs, strict=True):
        rows = np.isin(number, [k for k, name in enumerate(called) if name in chosen])
        if np.any(rows):
            found.append((log.rows_of(rows), stem))
    return [log for log, _ in found], [stem for _, stem in found]


def _one(log: Log, rig: Rig, name: str, alone: bool) -> Table:
    found, turned = converted(log, rig), []
    if falls(found.values["time"]):
        log = log.rows_of(slice(None, None, -1))
        found, turned = converted(log, rig), [reversed_time(log)]
    values, use, motor_off, kept = found.values, found.use, found.motor_off, found.numbers
    number, names = found.runs(name, alone)
    # By name: rows of another run that are dropped leave no mark between two parts of one.
    place = {text: k for k, text in enumerate(dict.fromkeys(names))}
    labels = np.array([place[text] for text in names])[number]
    rejected = int(np.count_nonzero(~kept))
    findings = [Finding("left_out", "", f"{log.path}: {note}", 0, "note") for note in log.notes]
    findings += [*_excerpt(log), *turned]
    if found.by_rate:
        rate = f"{rig.log.sample_rate_hz:g} rows per second in the rig file"
        text = f"{log.path}: no column is the time: it follows from the number of the row, {rate}"
        findings.append(Finding("by_rate", "time", text, log.rows, "note"))
    if rejected:
        numbers = {c: int(np.count_nonzero(np.isfinite(x))) for c, x in values.items()}
        worst = min(numbers, key=lambda c: numbers[c])
        channel = rig.axis.named(worst)
        if not numbers[worst]:
            raise InputError(
                log.path, problem=f"column {found.sources[worst].text!r} ({channel}) has no numbers"
            )
        row, most = int(np.flatnonzero(~kept)[0]), found.sources[worst].text
        first = log.place(row) + log.spoilt(most, row)
        what = f"no number in {rejected} of {log.rows} rows (first: {first}; most: {most!r})"
        if rejected > limits.MOST_REJECTED * log.rows:
            raise InputError(
                log.path, problem=f"{what}; at most {100 * limits.MOST_REJECTED:.0f} % may be missing"
            )
        severity = "warning" if rejected > limits.MUCH_LOST * log.rows else "note"
        findings.append(Finding("missing", worst, f"{log.path}: {what}{DROPPED}", rejected, severity))
    again = found.repeated(kept, labels)
    if np.any(again):
        count, first = int(np.count_nonzero(again)), log.place(int(np.flatnonzero(again)[0]))
        repeat = f"{count} of {log.rows} rows {'repeats' if count == 1 else 'repeat'} the one before"
        text = f"{log.path}: {repeat} (first: {first}){DROPPED}"
        findings.append(Finding("repeated", "time", text, count, "note"))
        kept &= ~again
    clock = clock_of(log, labels, values["time"], kept)
    measured = [x for c, x in values.items() if c != "time" and not c.startswith(CONTROLLER)]
    stopped = stale = wild = Stale(np.zeros(log.rows, bool), ())
    if not rig.log.events:  # a count of turns repeats by nature
        stopped = frozen_tails(log, labels, measured, clock.kept)
        stale = polled(log, labels, measured, clock.kept & ~stopped.rows)
        motion = [x for c, x in values.items() if c.startswith(("theta", "omega"))]
        wild = astray(log, labels, motion, clock.kept & ~stopped.rows & ~stale.rows)
    values = {**values, "time": clock.t}
    kept = clock.kept & ~stopped.rows & ~stale.rows & ~wild.rows
    findings += [*clock.findings, *stopped.findings, *stale.findings, *wild.findings]
    # Where every row is kept, a slice avoids the copy that a mask makes.
    own = slice(None) if np.all(kept) else kept
    run, run_names = _runs(log, labels, list(place), clock, kept)
    table = Table(
        {c: x[own] for c, x in values.items()},
        run,
        run_names,
        use[own] != 0.0,
        motor_off[own] != 0.0,
        np.concatenate([[False], ~kept[:-1]])[kept],
        _after_skipped(log, kept),
        log.rows if log.excerpt is None else log.excerpt.rows,
        int(np.count_nonzero(~kept)) if log.excerpt is None else log.excerpt.rejected,
        tuple(findings),
        log.excerpt is not None,
    )
    return _of_turns(table, log.path) if rig.log.events else table


def _of_turns(table: Table, path: str) -> Table:
    """The table of a log whose rows are turns, on even times, with the angle in place of the count."""
    motion = ("theta_m", "theta_l", "omega_m", "omega_l")
    name = f"theta_{next((c[-1] for c in motion if c in table.channels), 'm')}"
    count, t = table.channels.get(name), table.channels["time"]
    found = even_turns(t, None if count is None else count / TURN, table.run, table.run_names, path)
    nothing = np.zeros(len(found.row), bool)
    rest = {c: np.interp(found.t, t, x) for c, x in table.channels.items() if c not in motion}
    return table.at(
        found.row,
        {**rest, "time": found.t, name: found.theta},
        after_dropped=nothing,
        after_skipped=nothing,
        findings=(*table.findings, found.finding(path)),
    )


def _excerpt(log: Log) -> list[Finding]:
    """How much of a long log was chosen, and what is not in it."""
    if (whole := log.excerpt) is None:
        return []
    found: list[Finding] = []
    if whole.note:
        found.append(Finding("excerpt", "time", f"{log.path}: {whole.note}", whole.rows - log.rows, "note"))
    if whole.missed:
        found.append(Finding("not_chosen", "time", f"{log.path}: {whole.missed}", 0, "warning"))
    return found


def _after_skipped(log: Log, kept: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Kept rows with skipped ones between them and the kept row before; all (kept rows,)."""
    begins = np.zeros(log.rows, dtype=bool)
    if log.excerpt is not None:
        begins[log.excerpt.begins] = True
    return np.diff(np.cumsum(begins)[kept], prepend=0) != 0


def _runs(
    log: Log, labels: NDArray[np.int64], names: Sequence[str], clock: ClockOfLog, kept: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    """The number of the run of each kept row, from 0, and names; `labels` (n,) are places in `names`.

    A recording that starts again within a run is a run of its own, by its number.
    """
    rows = np.flatnonzero(kept)
    labels, part = labels[rows], clock.part[rows]
    begins = (np.diff(labels, prepend=-1) != 0) | (np.diff(part, prepend=0) != 0)
    starts = np.flatnonzero(begins).tolist()
    several = {int(labels[k]) for k in starts if part[k]}
    called = [
        f"{names[int(labels[k])]}#{part[k] + 1}" if int(labels[k]) in several else names[int(labels[k])]
        for k in starts
    ]
    again = next((k for k, name in enumerate(called) if name in called[:k]), None)
    if again is not None:
        place = log.place(int(rows[starts[again]]))
        name = names[int(labels[starts[again]])]
        raise InputError(f"{log.path}: {place}", "contiguous runs", f"{name!r} again")
    require_increasing(log, rows, clock.t[rows], begins)
    return np.cumsum(begins) - 1, tuple(called)
