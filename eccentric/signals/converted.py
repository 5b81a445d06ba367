"""The columns of a log as the channels of a rig, in SI; nothing is dropped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, counted, few, meant
from eccentric.logs import Log, LogStream, evaluate, is_arithmetic
from eccentric.rigs import COASTING, ArmRig, ColumnSource, Rig, channels_of
from eccentric.signals import limits

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_LABELS = ("run", "use", "motor_off")
CONTROLLER = "controller."
"""The columns that a controller uses are channels whose names begin with this."""
_WITHOUT_CLOCK = ", or, if there is none, give the sampling rate, as in sample_rate_hz = 500"
_DRIVES = ("voltage", "current", "torque", "torque_l")


@dataclass(frozen=True)
class Converted:
    """Channels of all rows in SI (n,), conditions as 0 and 1; `named` is the column of runs, None for none.

    `by_rate` says that no column is the time, which follows from the rate of the rig.

    Nothing is dropped: what is not a number is NaN or infinite.
    """

    sources: Mapping[str, ColumnSource]
    values: Mapping[str, Array]
    use: Array
    motor_off: Array
    named: NDArray[Any] | None
    by_rate: bool = False

    @property
    def numbers(self) -> Mask:
        """Rows (n,) that are numbers in every channel."""
        return np.logical_and.reduce(
            [np.isfinite(x) for x in (*self.values.values(), self.use, self.motor_off)]
        )

    def runs(self, name: str, alone: bool) -> tuple[NDArray[np.int64], list[str]]:
        """The number of the run of each row (n,), from 0, and names: a run that returns has two numbers.

        A run is named by the log, the run column, or both if two logs name a run alike.
        """
        return _numbered(self.named, len(self.use), name, alone)

    def repeated(self, kept: Mask, labels: NDArray[np.int64]) -> Mask:
        """Rows (n,) equal in every column to the kept row before them: the logger wrote them twice.

        `labels` (n,) are the same for rows of one run.
        """
        rows = np.flatnonzero(kept)
        t = self.values["time"][rows]
        # Nearly all rows differ in time already.
        later = np.flatnonzero(t[1:] == t[:-1]) + 1
        row, before = rows[later], rows[later - 1]
        columns = (*self.values.values(), self.use, self.motor_off, labels)
        same = np.logical_and.reduce([x[row] == x[before] for x in columns])
        again = np.zeros(len(kept), dtype=bool)
        again[row[same]] = True
        return again


def _numbered(
    named: NDArray[Any] | None, rows: int, name: str, alone: bool
) -> tuple[NDArray[np.int64], list[str]]:
    if named is None:
        return np.zeros(rows, dtype=np.int64), [name]
    again = named[1:] == named[:-1]
    if named.dtype.kind == "f":
        again |= np.isnan(named[1:]) & np.isnan(named[:-1])
    begins = np.concatenate([[True], ~again])
    texts = map(_text, named[begins])
    return np.cumsum(begins) - 1, [text if alone else f"{name}/{text}" for text in texts]


def run_numbers(log: Log, rig: Rig, name: str, alone: bool) -> tuple[NDArray[np.int64], list[str]]:
    """The runs of a log as `Converted.runs` returns them, of which no other column is looked at."""
    column = run_column(log, rig)
    return _numbered(log.text(column[0]) if column else None, log.rows, name, alone)


def converted(log: Log, rig: Rig) -> Converted:
    """Return the channels of a log under a rig.

    Raises InputError for a missing or non-numeric column, a channel that a fit needs, and a value of a size
    that no sensor gives.
    """
    sources = _sources(log, rig)
    values = {c: _values(log, rig, c, source) for c, source in sources.items() if c not in _LABELS}
    if rig.log.drive == COASTING:
        values["torque"] = np.zeros(log.rows)
    if without_clock := "time" not in sources:
        sources, values = _by_rate(log, rig, sources, values)
    return Converted(
        sources,
        values,
        _condition(log, rig, sources, "use", otherwise=1.0),
        _condition(log, rig, sources, "motor_off", otherwise=0.0),
        log.text(sources["run"].text) if "run" in sources else None,
        without_clock,
    )


def _by_rate(
    log: Log, rig: Rig, sources: Mapping[str, ColumnSource], values: Mapping[str, Array]
) -> tuple[Mapping[str, ColumnSource], Mapping[str, Array]]:
    """The channels of a log without a clock: its time is the number of the row over the rate of the rig."""
    rate = rig.log.sample_rate_hz or 1.0
    row = np.arange(log.rows) if log.numbered is None else log.numbered - 1
    said = ColumnSource(f"the number of the row / {rate:g}")
    return {"time": said, **sources}, {"time": row / rate, **values}


def used_columns(log: Log, rig: Rig) -> list[str]:
    """The columns of a log that the channels of a rig are made of.

    Raises InputError if one is missing, or a channel that a fit needs.
    """
    used: dict[str, None] = {}

    def column(name: str) -> Array:
        used[name] = None
        log.text(name)
        return np.zeros(1)

    for channel, source in _sources(log, rig).items():
        named = channel == "run" or channel.startswith(CONTROLLER)
        if named or _is_name(log, source.text):
            column(source.text)
        else:
            evaluate(source.text, column, f"{rig.path}: [columns] {rig.axis.named(channel)}")
    return list(used)


def stream_columns(stream: LogStream, rig: Rig) -> list[str]:
    """The columns of a log that has not been read which the channels of a rig are made of.

    Raises InputError as `used_columns` does.
    """
    return used_columns(Log(stream.path, dict.fromkeys(stream.names, np.empty(0)), 0), rig)


def named_apart(logs: Iterable[Iterable[Log]], rig: Rig) -> bool:
    """Whether the runs of several logs are known by their own names: no two logs have one in common.

    Args:
        logs: each as its batches, or as one batch.
        rig: what is known about them.
    """
    seen: set[str] = set()
    for log in logs:
        names = {name for batch in log for name in _run_names(batch, rig)}
        if seen & names:
            return False
        seen |= names
    return True


def run_column(log: Log, rig: Rig) -> list[str]:
    """The column that names the runs, none or one."""
    source = _sources(log, rig).get("run")
    return [] if source is None else [source.text]


def _run_names(log: Log, rig: Rig) -> set[str]:
    return {_text(value) for name in run_column(log, rig) for value in np.unique(log.text(name))}


def _sources(log: Log, rig: Rig) -> Mapping[str, ColumnSource]:
    """Return the mapped columns, or the available standard ones; require the minimum for a fit."""
    channels = channels_of(rig.axis)
    standard = {c: ColumnSource(column) for c, (column, _) in channels.items() if column in log.columns}
    sources = standard if rig.log.columns is None else rig.log.columns
    for choice in (
        ("time",),
        ("theta_m", "theta_l", "omega_m", "omega_l"),
        _DRIVES,
    ):
        if choice == ("time",) and rig.log.sample_rate_hz is not None:
            continue  # the rate is the clock
        if "theta_m" in choice and rig.log.events:
            continue  # each row is a turn
        if choice == _DRIVES and rig.log.drive == COASTING:
            sources = {c: source for c, source in sources.items() if c not in _DRIVES}
            continue  # an idle supply is none
        if not any(channel in sources for channel in choice):
            needed = " or ".join(
                f"{rig.axis.named(channel)} (column {channels[channel][0]!r})"
                for channel in choice
                if channel in channels
            )
            raise InputError(
                log.path,
                problem=f"expected a column for {needed}; map it in [columns] of {rig.path}"
                f"{_WITHOUT_CLOCK if choice == ('time',) else ''}; the log has {few(log.columns)}",
            )
    return {**sources, **_of_controller(rig)}


def _of_controller(rig: Rig) -> dict[str, ColumnSource]:
    """The columns that the controller of a rig uses, as channels of their own names."""
    used = () if rig.controller is None else rig.controller.columns
    return {f"{CONTROLLER}{name}": ColumnSource(name) for name in used}


def _values(log: Log, rig: Rig, channel: str, source: ColumnSource) -> Array:
    if channel.startswith(CONTROLLER):
        return log.numbers(source.text)
    where = f"{rig.path}: [columns] {rig.axis.named(channel)}"
    raw = numbers_of(log, source.text, where)
    if raw.dtype == bool:
        raise InputError(where, "a number", f"{source.text!r}")
    with np.errstate(over="ignore"):
        values = raw if source.unit is None else source.unit.to_si(raw)
    size = np.abs(np.where(np.isfinite(raw), values, 0.0))
    damaged = size > limits.LARGEST
    if np.any(damaged) and np.count_nonzero(damaged) <= limits.MOST_TOO_LARGE * log.rows:
        values, size = np.where(damaged, np.nan, values), np.where(damaged, 0.0, size)
    _require_size(log, rig, channel, source, values, size)
    return values


def _require_size(log: Log, rig: Rig, channel: str, source: ColumnSource, values: Array, size: Array) -> None:
    largest = int(np.argmax(size))
    where = f"column {source.text!r} ({rig.axis.named(channel)})"
    unit = channels_of(rig.axis)[channel][1]
    if size[largest] > limits.LARGEST:
        raise InputError(
            f"{log.path}: {log.place(largest)}, {where}",
            f"at most {limits.LARGEST:g} {unit}",
            f"{values[largest]:.6g} {unit}: are its units right?",
        )
    if channel in _DRIVES and 0.0 < size[largest] < limits.SMALLEST:
        raise InputError(
            f"{log.path}: {where}",
            f"a value of at least {limits.SMALLEST:g} {unit}",
            f"at most {size[largest]:.6g} {unit}: are its units right?",
        )


def _condition(
    log: Log, rig: Rig, sources: Mapping[str, ColumnSource], channel: str, otherwise: float
) -> Array:
    """A column of 0 and 1, or a condition on columns; one number for all rows if neither is mapped."""
    if channel not in sources:
        return np.full(log.rows, otherwise)
    where = f"{rig.path}: [columns] {rig.axis.named(channel)}"
    return numbers_of(log, sources[channel].text, where).astype(float)


def numbers_of(log: Log, text: str, where: str) -> NDArray[Any]:
    """The numbers (rows,) of a column, or of arithmetic on columns; InputError that begins with `where`."""
    return log.numbers(text) if _is_name(log, text) else evaluate(text, log.numbers, where)


def _is_name(log: Log, text: str) -> bool:
    return text in log.columns or not is_arithmetic(text, log.columns)


def _text(value: Any) -> str:
    return f"{value:.12g}" if isinstance(value, float) else str(value)


# The columns of an arm's log: one for every joint by the patterns of the rig, and none for another joint.


def require_columns(log: Log, rig: ArmRig) -> None:
    """Raise InputError, one line, unless the log has the columns of all joints and of no further one."""
    for channel in rig.patterns:
        names = [rig.column(channel, j) for j in range(len(rig.joints) + 1)]
        _require_all(log, rig, channel, names[:-1])
        if names[-1] in log.columns:
            of = f"the {counted(len(rig.joints), 'joint')} of {rig.chain.name}"
            raise InputError(
                f"{log.path}: {channel}",
                problem=f"expected columns of {of}, the log has"
                f" {names[-1]!r} for a joint {rig.number(len(rig.joints))} that the arm does not have",
            )


def _require_all(log: Log, rig: ArmRig, channel: str, names: list[str]) -> None:
    missing = [j for j, name in enumerate(names) if name not in log.columns]
    if not missing or (len(missing) == len(names) and is_arithmetic(names[0], log.columns)):
        return
    j, there = missing[0], len(names) - len(missing)
    some = f", got {there} of {counted(len(names), 'joint')}" if there else ""
    of = f"joint {rig.number(j)} of {rig.chain.name}"
    raise InputError(
        f"{log.path}: {channel}",
        problem=f"expected column {names[j]!r} for {of}"
        f" (columns count from first = {rig.first}){some}, the log has {few(log.columns)}"
        f"{meant(names[j], log.columns)}",
    )
