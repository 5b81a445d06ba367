"""A log without a rig: of which format it is, what was understood of it, and what was not."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from eccentric.api.result import ResultBase
from eccentric.api.tables import ResultTable, with_unit
from eccentric.core import InputError, counted
from eccentric.drafting import clock_in
from eccentric.logs import Log, LogSource, format_of, read_log

_MOST_COLUMNS = 40


@dataclass(frozen=True, repr=False)
class LogDescription(ResultBase):
    """What a log contains, and how it was read.

    Attributes:
        path: of its file; "table" for a table in memory.
        format: what kind of file it is; "in memory" for none.
        rows: how many it has.
        numbers: numeric column -> its unit if the file states it, smallest and largest value, number of
            missing values.
        texts: text column -> number of different values.
        clock: the time column, its unit, and rows/s (median); None if no column increases like a
            time.
        clock_doubt: what is uncertain about the time column, or why there is none; "" if nothing is.
        notes: how it was read, and what was left out.
    """

    path: str
    format: str
    rows: int
    numbers: dict[str, tuple[str, float, float, int]]
    texts: dict[str, int]
    clock: tuple[str, str, float] | None
    clock_doubt: str
    notes: tuple[str, ...]

    def summary(self) -> str:
        """The result as text for a terminal."""
        return "\n".join(self._lines())

    def table(self) -> ResultTable:
        """A row for each numeric column: unit, lowest and highest value, number of missing values."""
        names = ("column", "unit", "lowest", "highest", "missing")
        return ResultTable(names, tuple((name, *found) for name, found in self.numbers.items()))

    def __repr__(self) -> str:
        return f"<LogDescription: {self.path}, {counted(self.rows, 'row')}>"

    def _lines(self) -> Iterator[str]:
        columns = len(self.numbers) + len(self.texts)
        yield f"{self.path}: {self.format}"
        yield f"  {counted(self.rows, 'row')}, {counted(columns, 'column')}"
        if self.clock:
            name, unit, rate = self.clock
            doubt = f" ({self.clock_doubt})" if self.clock_doubt else ""
            yield f"  clock: {with_unit(name, unit)}, {rate:.4g} rows/s{doubt}"
        else:
            yield f"  no clock: {self.clock_doubt}"
        for name, (unit, low, high, missing) in list(self.numbers.items())[:_MOST_COLUMNS]:
            span = f"{low:.6g} throughout" if low == high else f"{low:.6g} to {high:.6g}"
            lost = f", {missing} missing" if missing else ""
            yield f"  {with_unit(name, unit)}: {span if low <= high else 'no numbers'}{lost}"
        if len(self.numbers) > _MOST_COLUMNS:
            yield f"  and {len(self.numbers) - _MOST_COLUMNS} more columns of numbers"
        for name, kinds in self.texts.items():
            yield f"  {name}: text, {kinds} different"
        yield from (f"  {note}" for note in self.notes)


def describe_log(source: LogSource) -> LogDescription:
    """Describe a log: its format, columns and time, without a rig.

    Args:
        source: a file, a table in memory or a Log, as `read_log` accepts it.

    Raises:
        InputError: it cannot be read as a log; the message says why.
    """
    log = read_log(source)
    numbers = {name: log.numbers(name) for name, x in log.columns.items() if x.dtype.kind == "f"}
    texts = {name: len(np.unique(x)) for name, x in log.columns.items() if x.dtype.kind != "f"}
    clock, doubt = _clock(log)
    found = {name: (log.units.get(name, ""), *_span(x)) for name, x in numbers.items()}
    kind = format_of(Path(source)).title if isinstance(source, str | os.PathLike) else "in memory"
    return LogDescription(log.path, kind, log.rows, found, texts, clock, doubt, (*log.read_as, *log.notes))


def _span(x: np.ndarray) -> tuple[float, float, int]:
    """Smallest and largest number, and how many values are none."""
    there = x[np.isfinite(x)]
    low, high = (float(there.min()), float(there.max())) if len(there) else (np.inf, -np.inf)
    return low, high, len(x) - len(there)


def _clock(log: Log) -> tuple[tuple[str, str, float] | None, str]:
    try:
        clock = clock_in(log)
    except InputError as error:
        return None, error.inside(log.path).statement
    proposal = clock.proposal
    return (proposal.column, proposal.unit, clock.rate_hz), "; ".join(
        filter(None, (clock.uneven, proposal.doubt))
    )
