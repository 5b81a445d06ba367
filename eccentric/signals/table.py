"""Logs as one table in SI: columns mapped to channels, runs numbered, rows that are not numbers dropped."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eccentric.errors import InputError, few
from eccentric.logs import Log, LogSource, evaluate, read_log
from eccentric.rigs import CHANNELS, ColumnSource, Rig
from eccentric.signals.finding import Finding
from eccentric.signals.holdout import matching
from eccentric.signals.limits import LARGEST, MOST_REJECTED, MUCH_LOST, SMALLEST

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

Array = NDArray[np.float64]

_LABELS = ("run", "use", "motor_off")
_DRIVES = ("voltage", "current", "torque", "torque_l")


@dataclass(frozen=True)
class Table:
    """Kept rows of all logs: channels by name in SI (temperature in degC), run number, masks; all (n,).

    `use` are the rows selected by the rig, `motor_off` those with the motor switched off and the link
    swinging freely. `after_dropped` are those whose previous row in the log was dropped.
    """

    channels: Mapping[str, Array]
    run: NDArray[np.int64]
    run_names: tuple[str, ...]
    use: NDArray[np.bool_]
    motor_off: NDArray[np.bool_]
    after_dropped: NDArray[np.bool_]
    rows_read: int
    rows_rejected: int
    findings: tuple[Finding, ...]


def read_table(logs: Sequence[LogSource], rig: Rig) -> Table:
    """Read and join logs, each a path, a table in memory or a Log.

    A row that repeats the one before it is dropped, like one that is not numbers.
    Raises InputError for what `read_log` refuses, a missing or non-numeric column, more than 20 % of rows
    that are not numbers, time stamps that do not increase within a run, a run in two pieces, and logs with
    different channels.
    """
    if not logs:
        raise InputError("a log is required, received none")
    tables: list[Table] = []
    stems: list[str] = []
    read = [read_log(log) for log in logs]
    own = _own_names(read, rig)
    for log in read:
        stem = Path(log.path).name.split(".")[0]
        stems.append(stem)
        name = stem if stems.count(stem) == 1 else f"{stem}#{stems.count(stem)}"
        tables.append(_one(log, rig, name, alone=own))
    names = set(tables[0].channels)
    for log, table in zip(read, tables, strict=True):
        if set(table.channels) != names:
            differ = few(sorted(names ^ set(table.channels)))
            raise InputError(
                f"{log.path}: the same channels are required in every log, {differ} is not in all of them"
            )
    offsets = np.cumsum([0, *(len(table.run_names) for table in tables)])
    joined = Table(
        channels={
            name: np.concatenate([table.channels[name] for table in tables]) for name in tables[0].channels
        },
        run=np.concatenate([table.run + offset for table, offset in zip(tables, offsets, strict=False)]),
        run_names=tuple(name for table in tables for name in table.run_names),
        use=np.concatenate([table.use for table in tables]),
        motor_off=np.concatenate([table.motor_off for table in tables]),
        after_dropped=np.concatenate([table.after_dropped for table in tables]),
        rows_read=sum(table.rows_read for table in tables),
        rows_rejected=sum(table.rows_rejected for table in tables),
        findings=tuple(finding for table in tables for finding in table.findings),
    )
    return _chosen(joined, rig) if rig.log.runs else joined


def _own_names(logs: Sequence[Log], rig: Rig) -> bool:
    """Whether the runs of several logs are known by their own names: no two logs have one in common."""
    seen: set[str] = set()
    for log in logs:
        source = _sources(log, rig).get("run")
        names = set() if source is None else set(_labels(log, source, "", alone=True).tolist())
        if seen & names:
            return False
        seen |= names
    return True


def _chosen(table: Table, rig: Rig) -> Table:
    """The runs that the rig names, renumbered."""
    names = matching(rig.log.runs, table.run_names, f"{rig.path}: runs")
    kept = np.isin(table.run, [table.run_names.index(name) for name in names])
    number = np.cumsum([name in names for name in table.run_names]) - 1
    return dataclasses.replace(
        table,
        channels={channel: x[kept] for channel, x in table.channels.items()},
        run=number[table.run[kept]],
        run_names=tuple(names),
        use=table.use[kept],
        motor_off=table.motor_off[kept],
        after_dropped=table.after_dropped[kept],
        rows_read=int(np.count_nonzero(kept)) + table.rows_rejected,
    )


def _one(log: Log, rig: Rig, name: str, alone: bool) -> Table:
    sources = _sources(log, rig)
    values = {c: _values(log, rig, c, source) for c, source in sources.items() if c not in _LABELS}
    use = _condition(log, rig, sources, "use", otherwise=1.0)
    motor_off = _condition(log, rig, sources, "motor_off", otherwise=0.0)
    labels = _labels(log, sources.get("run"), name, alone)
    numbers = {c: np.isfinite(x) for c, x in values.items()}
    kept = np.logical_and.reduce([*numbers.values(), np.isfinite(use), np.isfinite(motor_off)])
    rejected = int(np.count_nonzero(~kept))
    findings = [Finding("left_out", "", f"{log.path}: {note}", 0, "note") for note in log.notes]
    if rejected:
        worst = min(numbers, key=lambda c: np.count_nonzero(numbers[c]))
        if not np.any(numbers[worst]):
            raise InputError(f"{log.path}: column {sources[worst].text!r} ({worst}) has no numbers")
        first = log.place(int(np.flatnonzero(~kept)[0]))
        what = f"no number in {rejected} of {log.rows} rows (first: {first}; most: {sources[worst].text!r})"
        if rejected > MOST_REJECTED * log.rows:
            raise InputError(f"{log.path}: {what}; at most {MOST_REJECTED:.0%} may be missing")
        severity = "warning" if rejected > MUCH_LOST * log.rows else "note"
        findings.append(
            Finding("missing", worst, f"{log.path}: {what}: such rows are dropped", rejected, severity)
        )
    again = _repeated([*values.values(), use, motor_off, labels], kept)
    if np.any(again):
        count, first = int(np.count_nonzero(again)), log.place(int(np.flatnonzero(again)[0]))
        repeat = f"{count} of {log.rows} rows {'repeats' if count == 1 else 'repeat'} the one before"
        text = f"{log.path}: {repeat} (first: {first}): such rows are dropped"
        findings.append(Finding("repeated", "time", text, count, "note"))
        kept &= ~again
    run, run_names = _runs(log, labels, values["time"], kept)
    return Table(
        {c: x[kept] for c, x in values.items()},
        run,
        run_names,
        use[kept] != 0.0,
        motor_off[kept] != 0.0,
        np.concatenate([[False], ~kept[:-1]])[kept],
        log.rows,
        int(np.count_nonzero(~kept)),
        tuple(findings),
    )


def _repeated(columns: Sequence[NDArray[Any]], kept: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Rows (n,) equal in every column to the kept row before them: the logger wrote them twice."""
    rows = np.flatnonzero(kept)
    same = np.logical_and.reduce([x[rows[1:]] == x[rows[:-1]] for x in columns])
    again = np.zeros(len(kept), dtype=bool)
    again[rows[1:][same]] = True
    return again


def _sources(log: Log, rig: Rig) -> Mapping[str, ColumnSource]:
    """Return the mapped columns, or the available standard ones; require the minimum for a fit."""
    standard = {c: ColumnSource(column) for c, (column, _) in CHANNELS.items() if column in log.columns}
    sources = standard if rig.log.columns is None else rig.log.columns
    for choice in (
        ("time",),
        ("theta_m", "theta_l", "omega_m", "omega_l"),
        ("voltage", "current", "torque", "torque_l"),
    ):
        if not any(channel in sources for channel in choice):
            needed = " or ".join(f"{channel} (column {CHANNELS[channel][0]!r})" for channel in choice)
            raise InputError(
                f"{log.path}: a column for {needed} is required; map it in [columns] of {rig.path}; "
                f"the log has {few(log.columns)}"
            )
    return sources


def _values(log: Log, rig: Rig, channel: str, source: ColumnSource) -> Array:
    if source.text in log.columns:
        raw = log.numbers(source.text)
    else:
        raw = evaluate(source.text, log.numbers, f"{rig.path}: [columns] {channel}")
        if raw.dtype == bool:
            raise InputError(
                f"{rig.path}: [columns] {channel}: a number is required, received {source.text!r}"
            )
    with np.errstate(over="ignore"):
        values = raw if source.unit is None else source.unit.to_si(raw)
    _require_size(log, channel, source, np.where(np.isfinite(raw), values, 0.0))
    return values


def _require_size(log: Log, channel: str, source: ColumnSource, values: Array) -> None:
    size = np.abs(values)
    largest = int(np.argmax(size))
    where, unit = f"column {source.text!r} ({channel})", CHANNELS[channel][1]
    if size[largest] > LARGEST:
        raise InputError(
            f"{log.path}: {log.place(largest)}, {where}: at most {LARGEST:g} {unit} is required, "
            f"received {values[largest]:.6g} {unit}: are its units right?"
        )
    if channel in _DRIVES and 0.0 < size[largest] < SMALLEST:
        raise InputError(
            f"{log.path}: {where}: a value of at least {SMALLEST:g} {unit} is required, "
            f"received at most {size[largest]:.6g} {unit}: are its units right?"
        )


def _condition(
    log: Log, rig: Rig, sources: Mapping[str, ColumnSource], channel: str, otherwise: float
) -> Array:
    """A column of 0 and 1, or a condition on columns; one number for all rows if neither is mapped."""
    if channel not in sources:
        return np.full(log.rows, otherwise)
    text = sources[channel].text
    if text in log.columns:
        return log.numbers(text)
    return evaluate(text, log.numbers, f"{rig.path}: [columns] {channel}").astype(float)


def _labels(log: Log, source: ColumnSource | None, name: str, alone: bool) -> NDArray[np.str_]:
    """Name the run of each row: by the log, by the run column, or by both if two logs name a run alike."""
    if source is None:
        return np.full(log.rows, name)
    values = log.text(source.text)
    texts = [f"{v:.12g}" for v in values] if values.dtype.kind == "f" else [str(v) for v in values]
    return np.array(texts if alone else [f"{name}/{text}" for text in texts])


def _runs(
    log: Log, labels: NDArray[np.str_], t: Array, kept: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    rows = np.flatnonzero(kept)
    labels, t = labels[rows], t[rows]
    begins = np.concatenate([[True], labels[1:] != labels[:-1]])
    names = [str(label) for label in labels[begins]]
    again = next((k for k, name in enumerate(names) if name in names[:k]), None)
    if again is not None:
        place = log.place(int(rows[np.flatnonzero(begins)[again]]))
        raise InputError(
            f"{log.path}: {place}: contiguous runs are required, received {names[again]!r} again"
        )
    stuck = np.flatnonzero((np.diff(t) <= 0.0) & ~begins[1:])
    if len(stuck):
        k = int(stuck[0])
        raise InputError(
            f"{log.path}: {log.place(int(rows[k + 1]))}: time stamps must increase, "
            f"received {t[k + 1]:.9g} s after {t[k]:.9g} s"
        )
    return np.cumsum(begins) - 1, tuple(names)
