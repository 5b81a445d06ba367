"""A measured log as it was recorded: named columns, nothing converted, nothing dropped.

`read_log` reads it whole; `stream_log` its rows in batches, or those of some spans, and only the columns that
are asked for:

    Parquet        row groups         memory of one batch
    CSV, CSV.gz    blocks of lines    memory of one block
    MAT 7.3        slices             memory of one slice
    others, and tables in memory      read whole

A batch is a `Log` whose rows know their place in the file, so that a message names the row there.
"""

from __future__ import annotations

import gzip
import os
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, few, given_path, meant, shown
from eccentric.logs import limits
from eccentric.logs.assemble import EITHER, Column, Part, Read, number_of, overlaps
from eccentric.logs.cells import POINT
from eccentric.logs.formats import format_of
from eccentric.logs.tables import TableLike, read_memory

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence


@dataclass(frozen=True)
class Excerpt:
    """The log that some rows were chosen from.

    `rows` it has, `rejected` of them without a number or repeated; `begins` are the chosen rows whose
    previous row was not chosen. `note` says what was chosen and why, `missed` what is not in it, "" for
    nothing.
    """

    rows: int
    rejected: int
    begins: NDArray[np.int64]
    note: str
    missed: str = ""

    def rows_of(self, rows: NDArray[np.bool_] | slice) -> Excerpt:
        """Return the excerpt of these rows (n,) of the chosen ones; a window that has lost all is gone."""
        if isinstance(rows, slice):
            return self
        kept = np.concatenate([[0], np.cumsum(rows)])[self.begins]
        begins = np.unique(kept[kept < np.count_nonzero(rows)])
        return replace(self, begins=begins[begins > 0])


@dataclass(frozen=True)
class Log:
    """Columns of one log, all of one length: float64 with NaN for a missing value, or str for text.

    `path` is the path of its file, or the name of a table in memory. `lines` (rows,) are the line numbers of
    the rows in a text file, from 1; None for other formats. `notes` say what was left out, and why.
    `numbered` (rows,) are the row numbers in the file, from 1, if the log is a part of it; `excerpt` says
    which part, if windows of a long log were chosen. `units` are the units stated in the file, by column and
    unchanged; no reader applies them. `read_as` says how the file was read.
    """

    path: str
    columns: Mapping[str, Column]
    rows: int
    lines: NDArray[np.int64] | None = None
    notes: tuple[str, ...] = ()
    numbered: NDArray[np.int64] | None = None
    excerpt: Excerpt | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    read_as: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"<Log {self.path}: {self.rows} rows of {few(self.columns)}>"

    def place(self, row: int) -> str:
        """Return the place of a row (counted from 0): its line as an editor shows it, else its number."""
        if self.lines is not None:
            return f"line {self.lines[row]}"
        return f"row {row + 1 if self.numbered is None else self.numbered[row]}"

    def rows_of(self, rows: NDArray[np.bool_] | slice) -> Log:
        """Return a log of these rows (n,); messages still give their places in the file."""
        numbered = np.arange(1, self.rows + 1) if self.numbered is None else self.numbered
        kept = numbered[rows]
        return replace(
            self,
            columns={name: values[rows] for name, values in self.columns.items()},
            rows=len(kept),
            lines=None if self.lines is None else self.lines[rows],
            numbered=kept,
            excerpt=None if self.excerpt is None else self.excerpt.rows_of(rows),
        )

    def numbers(self, name: str) -> NDArray[np.float64]:
        """Return the column `name` as float64 (rows,), with NaN for occasional text such as "ERR".

        Raises InputError if the log has no such column, if more than a fifth of its rows are text, or if a
        number has a decimal comma or may be two numbers.
        """
        values = self.text(name)
        if values.dtype.kind == "f":
            return values
        numbers = [number_of(entry) for entry in values]
        texts = [row for row, number in enumerate(numbers) if number is None]
        for row in texts:
            entry = values[row]
            hint = POINT if number_of(entry.replace(",", ".")) is not None else ""
            two = EITHER in entry and number_of(entry.partition(EITHER)[0]) is not None
            if hint or two or len(texts) > limits.MOST_TEXT * len(values):
                raise InputError(
                    f"{self.path}: {self.place(row)}, column {name!r}",
                    "a number",
                    f"{str(entry)[:40]!r}{hint}",
                )
        return np.array([np.nan if number is None else number for number in numbers], dtype=float)

    def spoilt(self, name: str, row: int) -> str:
        """The text in a row of a column that is no number there, behind a comma; "" where there is none."""
        values = self.columns.get(name)
        if values is None or values.dtype.kind == "f" or number_of(values[row]) is not None:
            return ""
        return f", {str(values[row])[:40]!r}"

    def text(self, name: str) -> Column:
        """Return the column `name` as it was read, float64 or str; InputError if there is none."""
        if name not in self.columns:
            raise InputError(
                self.path,
                problem=f"expected column {name!r}, but the log has {few(self.columns)}"
                + meant(name, self.columns),
            )
        return self.columns[name]


LogSource: TypeAlias = str | os.PathLike[str] | Log | TableLike


class Named(Protocol):
    """What has the path of a log."""

    @property
    def path(self) -> str:
        """As messages show it."""
        ...


def log_names(logs: Sequence[Named]) -> tuple[str, ...]:
    """What messages and results call logs: their file names, equal ones with folders that tell them apart."""
    paths = [Path(log.path) for log in logs]
    names = [path.name for path in paths]
    for count in range(2, max((len(path.parts) for path in paths), default=0) + 1):
        names = [
            Path(*path.parts[-count:]).as_posix() if names.count(name) > 1 else name
            for path, name in zip(paths, names, strict=True)
        ]
    return tuple(names)


def log_stems(logs: Sequence[Named]) -> tuple[str, ...]:
    """The same without suffixes, as the names of runs have them; those that are still equal are numbered."""
    paths = [PurePosixPath(name) for name in log_names(logs)]
    stems = [(path.parent / path.name.split(".")[0]).as_posix() for path in paths]
    count = [stems[: k + 1].count(stem) for k, stem in enumerate(stems)]
    return tuple(stem if n == 1 else f"{stem}#{n}" for stem, n in zip(stems, count, strict=True))


def read_log(source: LogSource, name: str = "table") -> Log:
    """Read a log from a file or from a table in memory.

    Args:
        source: a path to a file of one of the `FORMATS`, some of which need an extra (docs/rig-reference.md);
            or a table: a mapping of names to arrays (n,), a structured array, or a table of pandas, polars,
            pyarrow or any library with the Arrow PyCapsule or the dataframe interchange protocol; or a Log,
            which is returned unchanged.
        name: name of a table in memory, in messages and results.

    Raises:
        InputError: the log cannot be read; the message names file, line and column.
    """
    if isinstance(source, Log):
        return source
    if isinstance(source, str | os.PathLike):
        path = given_path(source, "log")
        where, read = shown(path), _read_file(path)
    else:
        where, read = name, read_memory(source, name)
    rows = len(next(iter(read.columns.values()))) if read.columns else 0
    if rows == 0:
        raise InputError(where, "a log with rows", "none", hint="; ".join(read.notes))
    return Log(where, read.columns, rows, read.lines, read.notes, units=read.units, read_as=read.read_as)


def _read_file(path: Path) -> Read:
    with reader_errors(path):
        return format_of(path).read(path)


@contextmanager
def reader_errors(path: Path) -> Iterator[None]:
    """What a damaged file raises while it is read, as InputError."""
    try:
        yield
    except UnicodeDecodeError as error:
        raise InputError(path, problem=f"expected UTF-8 text, but byte {error.start} is not") from None
    except (EOFError, zlib.error, gzip.BadGzipFile):
        raise InputError(path, problem="the compressed file is damaged or cut off") from None
    except OSError as error:
        raise InputError(path, problem=f"cannot be read ({error.strerror or error})") from None


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
            raise InputError(self.path, "a log with rows", "none", hint="; ".join(self.notes))
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
                raise InputError(shown(path), "a log with rows", "none", hint="; ".join(found.notes))
        if found is not None:
            whole = partial(read_log, path)
            return LogStream(shown(path), found.names, found.rows, found.notes, whole, found.parts)
    return _in_memory(read_log(source, name))


def _in_memory(log: Log) -> LogStream:
    """A log that is in memory already, in slices."""

    def parts(names: Sequence[str], spans: Sequence[tuple[int, int]]) -> Iterator[Part]:
        for at in range(0, log.rows, limits.BATCH_ROWS):
            for first, end in overlaps(at, min(at + limits.BATCH_ROWS, log.rows), spans):
                lines = None if log.lines is None else log.lines[first:end]
                yield Part(first, {name: log.columns[name][first:end] for name in names}, lines)

    return LogStream(log.path, tuple(log.columns), log.rows, log.notes, lambda: log, parts)


def _as_text(values: Column) -> Column:
    return np.array(["" if np.isnan(value) else f"{value:.12g}" for value in values], dtype=str)
