"""A log as a stream: its rows in batches, or those of some spans, and only the columns that are asked for.

    Parquet        row groups         memory of one batch
    CSV, CSV.gz    blocks of lines    memory of one block
    MAT 7.3        slices             memory of one slice
    others, and tables in memory      read whole

A batch is a `Log` whose rows know their place in the file, so that a message names the row there.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from eccentric.core import InputError, given_path, shown
from eccentric.logs.assemble import Column, Part, overlaps
from eccentric.logs.formats import format_of
from eccentric.logs.limits import BATCH_ROWS
from eccentric.logs.log import Log, LogSource, read_log, reader_errors


@dataclass(frozen=True)
class LogStream:
    """A log that has not been read yet.

    `path` is that of its file, or the name of a table in memory; `names` are its columns; `rows` how many it
    has, for a text file its lines, of which some may be empty. `notes` say what was left out, and why.
    `whole` reads all of it.
    """

    path: str
    names: tuple[str, ...]
    rows: int
    notes: tuple[str, ...]
    whole: Callable[[], Log]
    _parts: Callable[[Sequence[str], Sequence[tuple[int, int]]], Iterator[Part]]

    def batches(
        self, names: Sequence[str] | None = None, spans: Sequence[tuple[int, int]] | None = None
    ) -> Iterator[Log]:
        """Yield the rows in order, at most 131,072 at a time; each batch is of rows that follow each other.

        Args:
            names: the columns to read; all, if None.
            spans: [first, end) of the rows to read, counted from 0, sorted and disjoint; all, if None.

        Raises:
            InputError: the log has no such column, or is damaged; one line with file and place.
        """
        chosen = list(self.names if names is None else dict.fromkeys(names))
        if missing := [name for name in chosen if name not in self.names]:
            Log(self.path, dict.fromkeys(self.names, np.empty(0)), 0).text(missing[0])
        wanted = [(0, self.rows)] if spans is None else [span for span in spans if span[0] < span[1]]
        if not wanted or not chosen:
            return
        with reader_errors(Path(self.path)):
            for part in self._parts(chosen, wanted):
                rows = len(part.columns[chosen[0]])
                numbered = np.arange(part.first + 1, part.first + rows + 1)
                yield Log(self.path, part.columns, rows, part.lines, self.notes, numbered)

    def read(self, names: Sequence[str] | None = None, spans: Sequence[tuple[int, int]] | None = None) -> Log:
        """Return the rows of these spans as one log; arguments and errors as in `batches`.

        Raises:
            InputError: there is no row.
        """
        found = list(self.batches(names, spans))
        if not found:
            raise InputError("; ".join((f"{self.path}: expected a log with rows, got none", *self.notes)))
        columns: dict[str, Column] = {}
        for name in found[0].columns:
            parts = [batch.columns[name] for batch in found]
            # A column that has a text somewhere is text everywhere.
            if len({part.dtype.kind for part in parts}) > 1:
                parts = [part.astype(str) if part.dtype.kind == "U" else _as_text(part) for part in parts]
            columns[name] = np.concatenate(parts)
        lines = [batch.lines for batch in found if batch.lines is not None]
        numbered = [batch.numbered for batch in found if batch.numbered is not None]
        return Log(
            self.path,
            columns,
            sum(batch.rows for batch in found),
            np.concatenate(lines) if lines else None,
            self.notes,
            np.concatenate(numbered) if numbered else None,
        )


def stream_log(source: LogSource, name: str = "table") -> LogStream:
    """Open a log as a stream; arguments as those of `read_log`.

    Raises:
        InputError: it cannot be read, or has no rows.
    """
    if isinstance(source, str | os.PathLike):
        path = given_path(source, "log")
        with reader_errors(path):
            found = format_of(path).in_parts(path)
            if found is not None and (found.rows == 0 or not found.names):
                said = (f"{shown(path)}: expected a log with rows, got none", *found.notes)
                raise InputError("; ".join(said))
        if found is not None:
            whole = partial(read_log, path)
            return LogStream(shown(path), found.names, found.rows, found.notes, whole, found.parts)
    return _in_memory(read_log(source, name))


def _in_memory(log: Log) -> LogStream:
    """A log that is in memory already, in slices."""

    def parts(names: Sequence[str], spans: Sequence[tuple[int, int]]) -> Iterator[Part]:
        for at in range(0, log.rows, BATCH_ROWS):
            for first, end in overlaps(at, min(at + BATCH_ROWS, log.rows), spans):
                lines = None if log.lines is None else log.lines[first:end]
                yield Part(first, {name: log.columns[name][first:end] for name in names}, lines)

    return LogStream(log.path, tuple(log.columns), log.rows, log.notes, lambda: log, parts)


def _as_text(values: Column) -> Column:
    return np.array(["" if np.isnan(value) else f"{value:.12g}" for value in values], dtype=str)
