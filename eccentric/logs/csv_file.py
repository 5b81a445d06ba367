"""CSV logs, plain and gzipped."""

from __future__ import annotations

import codecs
import csv
import dataclasses
import gzip
import io
import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import IO

import numpy as np

from eccentric.core import InputError
from eccentric.logs.assemble import (
    MISSING,
    Column,
    InParts,
    Part,
    Read,
    Recorded,
    column_of,
    number_of,
    on_one_clock,
    overlaps,
)
from eccentric.logs.foreign import require_room_for_text
from eccentric.logs.limits import BATCH_ROWS, MOST_CHARACTERS, MOST_PARTS, SAMPLE_ROWS, SHORTEST_VECTOR

# Cells of a CSV log that are no plain numbers: decimal commas, dates, large counters, a row of units.


_COMMA = re.compile(r"\s*[-+]?(?:\d+(?:,\d*)?|,\d+)(?:[eE][-+]?\d+)?\s*")
_DATE = re.compile(r"\s*\d{4}-\d\d-\d\d[T ]\d\d:\d\d")
_UNIT = re.compile(r"[\[(]?\s*[A-Za-zµμΩ°%/^·* \d.²³-]{0,12}\s*[\])]?")
_EXACT = 2**53
"""Whole numbers above this are not exact as floating point: nanoseconds since 1970 are in steps of 256."""


def cells_to_column(name: str, cells: Sequence[str], *, decimal_comma: bool) -> tuple[Column, str, str]:
    """Return a column of text as numbers where it can be, its unit if the cells say it, and a note.

    Args:
        decimal_comma: whether a comma can be one, since it does not separate the cells.
    """
    column = plain_column(cells, decimal_comma=decimal_comma)
    if column.dtype.kind == "f":
        return _counter(name, cells, column)
    given = _given(cells)
    if given and all(map(_DATE.match, given)):
        return _dates(name, cells, column)
    return column, "", ""


def plain_column(cells: Sequence[str], *, decimal_comma: bool) -> Column:
    """Return cells as numbers, with decimal commas where most are such and a comma can be one, or as text."""
    column = column_of(cells)
    if column.dtype.kind == "f" or not decimal_comma:
        return column
    given = _given(cells)
    # A cell that is no number stays as it is: whoever asks for numbers is told its line.
    if given and 2 * sum(map(bool, map(_COMMA.fullmatch, given))) > len(given):
        return column_of([c.replace(",", ".") if _COMMA.fullmatch(c) else c for c in cells])
    return column


def _given(cells: Sequence[str]) -> list[str]:
    return [cell for cell in cells if cell.strip().lower() not in MISSING]


def _counter(name: str, cells: Sequence[str], column: Column) -> tuple[Column, str, str]:
    """A counter beyond what floating point resolves counts from its first value."""
    if (
        not len(column)
        or not np.nanmax(np.abs(column), initial=0.0) > _EXACT
        or not np.all(np.isfinite(column))
    ):
        return column, "", ""
    try:
        whole = [int(cell) for cell in cells]
    except ValueError:
        return column, "", ""
    said = f"{name} counts from its first value, {whole[0]}: floating point would round it"
    return np.array([float(one - whole[0]) for one in whole]), "", said


def _dates(name: str, cells: Sequence[str], column: Column) -> tuple[Column, str, str]:
    """Dates with a time in ISO 8601 as seconds from the first of them; text if one of them is none."""
    stamps: list[datetime | None] = []
    for cell in cells:
        text = cell.strip()
        try:
            stamps.append(None if text.lower() in MISSING else datetime.fromisoformat(text))
        except ValueError:
            return column, "", ""
    # Without a zone all are of one, whichever it is: only differences count.
    known = [s if s is None or s.tzinfo else s.replace(tzinfo=UTC) for s in stamps]
    first = next(s for s in known if s is not None)
    seconds = [float("nan") if s is None else (s - first).total_seconds() for s in known]
    return np.array(seconds), "s", f"{name}: dates, as seconds from {first.isoformat()}"


def units_row(names: Sequence[str], first: Sequence[str], second: Sequence[str] | None) -> dict[str, str]:
    """The units in the row below the header, by column; empty if that row is one of values.

    It is a row of units if none of its cells is a number, all look like one, and the row below has numbers.
    """
    if second is None or len(first) != len(names) or len(second) != len(names):
        return {}
    numbers = [_is_number(cell) for cell in second]
    said = [cell.strip() for cell in first]
    if not any(numbers) or any(_is_number(cell) and cell for cell in said) or not any(said):
        return {}
    over_numbers = [cell for cell, number in zip(said, numbers, strict=True) if number]
    if not all(map(_UNIT.fullmatch, said)) or not any(over_numbers):
        return {}
    return {name: cell.strip("[]() ") for name, cell in zip(names, said, strict=True) if cell.strip("[]()- ")}


def _is_number(cell: str) -> bool:
    found = number_of(cell)
    return (found is not None and found == found) or bool(cell.strip() and _COMMA.fullmatch(cell))  # noqa: PLR0124 - NaN


# A table whose rows belong to different channels, as loggers of several topics write it, on one clock.
#
# Either each row names its channel (time, name, value), or each row fills the columns of one topic and leaves
# the others empty. A log that merely lost values is neither: there all columns are filled in some row. Nor is
# a log with a full column and some that are sampled more slowly.


def of_topics(read: Read, path: Path) -> Read:
    """Return a table with one row for each moment; unchanged if its rows are of one kind."""
    by_name = _named(read.columns)
    if by_name is not None:
        time, channels = by_name
        return _joined(read, channels, path, time, "rows of several channels, each named in its row")
    by_gaps = _sparse(read.columns)
    if by_gaps is not None:
        time, channels = by_gaps
        return _joined(read, channels, path, time, "rows of several topics, each with columns of its own")
    return read


def _joined(read: Read, channels: list[Recorded], path: Path, time: str, what: str) -> Read:
    start = min(c.time[0] for c in channels)
    moved = [Recorded(c.name, c.time - start, c.values, read.units.get(c.name, "")) for c in channels]
    found = on_one_clock(moved, path, (*read.notes, what), time)
    return Read(found.columns, notes=found.notes, units={**found.units, time: read.units.get(time, "")})


def _named(columns: Mapping[str, Column]) -> tuple[str, list[Recorded]] | None:
    """Two columns of numbers and one of names that change from row to row."""
    texts = [name for name, x in columns.items() if x.dtype.kind != "f"]
    numbers = [name for name, x in columns.items() if x.dtype.kind == "f"]
    if len(texts) != 1 or len(numbers) != 2:
        return None
    names = columns[texts[0]]
    kinds = np.unique(names)
    changes = np.count_nonzero(names[1:] != names[:-1])
    if not 2 <= len(kinds) <= MOST_PARTS or changes < 5 * len(kinds):
        return None
    time = next((name for name in numbers if _rises(columns[name])), None)
    if time is None:
        return None
    (value,) = (name for name in numbers if name != time)
    return time, [Recorded(str(k), columns[time][names == k], columns[value][names == k]) for k in kinds]


def _sparse(columns: Mapping[str, Column]) -> tuple[str, list[Recorded]] | None:
    """A column of time, the only full one, and at least two others that are never filled in the same row."""
    numbers = {name: x for name, x in columns.items() if x.dtype.kind == "f"}
    time = next((name for name, x in numbers.items() if np.all(np.isfinite(x)) and _rises(x)), None)
    if time is None:
        return None
    there = {name: np.isfinite(x) for name, x in numbers.items() if name != time}
    there = {name: rows for name, rows in there.items() if np.count_nonzero(rows) >= SHORTEST_VECTOR}
    parts = [name for name, rows in there.items() if not np.all(rows)]
    # With another full column, each row is a moment.
    if len(parts) < len(there):
        return None
    if not any(not np.any(there[a] & there[b]) for k, a in enumerate(parts) for b in parts[k + 1 :]):
        return None
    return time, [Recorded(name, numbers[time][rows], numbers[name][rows]) for name, rows in there.items()]


def _rises(x: Column) -> bool:
    return bool(np.all(np.isfinite(x))) and len(x) > 1 and bool(np.all(np.diff(x) >= 0.0)) and x[-1] > x[0]


_NO_TEXT = re.compile(r"[\x00-\x08\x0e-\x1f]")
POINT = "; a decimal point is required, as in 1.5"


# The file.


def read_csv(path: Path) -> Read:
    """Read a CSV file with one header row; the delimiter is a comma, a semicolon or a tab.

    Between semicolons or tabs the decimal separator may be a comma. A row of units may follow the header, and
    dates in ISO 8601 become seconds. Rows of several topics are put on one clock. Leading lines that are
    empty or begin with `#` are skipped, except that the last of those is the header if none follows.
    """
    # Not `splitlines`, which also splits at form feeds and other separators inside cells.
    whole, said = _decoded(path)
    rows = 1 + max(whole.count("\n"), whole.count("\r"))
    require_room_for_text(path, whole, rows, rows + sum(map(whole.count, ",;\t")))
    text = io.StringIO(whole, newline="").readlines()
    skipped = next((k for k, line in enumerate(text) if _is_content(line)), len(text))
    if skipped == len(text):
        raise InputError(path, "a header row with column names", "an empty file")
    with _csv_errors(path):
        read = of_topics(_read(path, text, skipped), path)
    return dataclasses.replace(read, notes=(*said, *read.notes))


@contextmanager
def _csv_errors(path: Path) -> Iterator[None]:
    try:
        yield
    except csv.Error as error:
        raise InputError(f"{path}: not a valid CSV file ({error})") from None


def text_of(path: Path, encoding: str = "utf-8-sig") -> str:
    """Return the text of a file, unpacked if its name ends in .gz; InputError above a gigabyte."""
    with _opened(path, encoding) as file:
        text = file.read(MOST_CHARACTERS + 1)
    if len(text) > MOST_CHARACTERS:
        raise InputError(path, f"at most {MOST_CHARACTERS:,} characters", "more", plural=True)
    return text


def csv_source(path: Path) -> InParts | None:
    """Return a CSV file as blocks of rows; it has at most as many as lines, which are counted.

    None for one whose first rows need more than reading numbers, such as dates, a row of units or topics, and
    for one that is not UTF-8 throughout.
    """
    try:
        with _csv_errors(path):
            header, delimiter, before = _start(path)
            if not _plain(path, before, header, delimiter):
                return None
        lines = _lines(path)
    except UnicodeDecodeError:
        return None

    def parts(names: Sequence[str], spans: Sequence[tuple[int, int]]) -> Iterator[Part]:
        chosen, at = [header.index(name) for name in names], 0
        with _opened(path) as file, _csv_errors(path):
            for _ in range(before):
                next(file)
            reader = csv.reader(file, delimiter=delimiter)
            rows = ((before + reader.line_num, row) for row in reader if row)
            while at < spans[-1][1] and (block := list(itertools.islice(rows, BATCH_ROWS))):
                for first, end in overlaps(at, at + len(block), spans):
                    found = _rectangular(block[first - at : end - at], len(header), delimiter, path)
                    values = list(zip(*(row for _, row in found), strict=True))
                    columns = {
                        name: plain_column(values[k], decimal_comma=delimiter != ",")
                        for name, k in zip(names, chosen, strict=True)
                    }
                    yield Part(first, columns, np.array([line for line, _ in found], dtype=np.int64))
                at += len(block)

    return InParts(tuple(header), lines - before, parts)


def _start(path: Path) -> tuple[list[str], str, int]:
    """Column names, delimiter, and the number of lines before the first row."""
    last = ""
    with _opened(path) as file:
        for skipped, line in enumerate(file):
            if _is_content(line):
                names, delimiter, is_row = _names(last, line)
                return _header(names, path), delimiter, skipped + (not is_row)
            last = line
    raise InputError(path, "a header row with column names", "an empty file")


def _lines(path: Path) -> int:
    """How many lines a file may have; UnicodeDecodeError if it is not UTF-8 throughout."""
    opened = gzip.open if path.name.lower().endswith(".gz") else open
    decoder = codecs.getincrementaldecoder("utf-8")()
    count = 1
    with opened(path, "rb") as file:
        while chunk := file.read(1 << 20):
            count += max(chunk.count(b"\n"), chunk.count(b"\r"))
            decoder.decode(chunk)
        decoder.decode(b"", final=True)
    return count


def _opened(path: Path, encoding: str = "utf-8-sig") -> IO[str]:
    opened = gzip.open if path.name.lower().endswith(".gz") else open
    return opened(path, "rt", encoding=encoding, newline="")


def _names(comment: str, line: str) -> tuple[list[str], str, bool]:
    """Column names from the first line with content, or from the comment before it; if it is a row."""
    comment = comment.lstrip("# \t")
    delimiter = max(",;\t", key=line.count)
    # numpy.savetxt writes the column names as a comment.
    if comment.strip() and _only_numbers(first := _cells(line, delimiter)):
        names = _cells(comment, delimiter)
        if len(names) != len(first):
            names = comment.split()
        if len(names) == len(first):
            return names, delimiter, True
    return _cells(line, delimiter), delimiter, False


def _plain(path: Path, before: int, header: list[str], delimiter: str) -> bool:
    """Whether the first rows are nothing but numbers and names, one row for each moment."""
    with _opened(path) as file:
        lines = list(itertools.islice(file, before + SAMPLE_ROWS))
    read = _of_rows(path, lines, before, header, delimiter)
    return not read.notes and not read.units and of_topics(read, path) is read


def _read(path: Path, text: list[str], skipped: int) -> Read:
    names, delimiter, is_row = _names(text[skipped - 1] if skipped else "", text[skipped])
    return _of_rows(path, text, skipped + (not is_row), _header(names, path), delimiter)


def _of_rows(path: Path, text: list[str], before: int, header: list[str], delimiter: str) -> Read:
    """The rows below the first lines of a text."""
    reader = csv.reader(text[before:], delimiter=delimiter)
    found = [(before + reader.line_num, row) for row in reader if row]
    units = units_row(header, *(row for _, row in found[:2])) if len(found) > 1 else {}
    found = _rectangular(found[1:] if units else found, len(header), delimiter, path)
    values = zip(*(row for _, row in found), strict=True)
    lines = np.array([line for line, _ in found], dtype=np.int64)
    columns: dict[str, Column] = {}
    notes: list[str] = []
    for name, cells in zip(header, values, strict=False):
        columns[name], unit, note = cells_to_column(name, cells, decimal_comma=delimiter != ",")
        notes += [note] if note else []
        units |= {name: unit} if unit else {}
    return Read(columns, lines, tuple(notes), units)


def _decoded(path: Path) -> tuple[str, tuple[str, ...]]:
    """The text of a file, as Latin-1 with a note where it is not UTF-8; UnicodeDecodeError for no text."""
    try:
        return text_of(path), ()
    except UnicodeDecodeError:
        text = text_of(path, "cp1252")  # raises where Latin-1 of Windows has no character
        if _NO_TEXT.search(text):
            raise
        return text, ("read as Latin-1, since it is no UTF-8",)


def _rectangular(
    found: list[tuple[int, list[str]]], width: int, delimiter: str, path: Path
) -> list[tuple[int, list[str]]]:
    """The rows, each with its line; InputError for one with more values than names, or fewer."""
    for line, row in found:
        if len(row) != width:
            hint = POINT if delimiter == "," and len(row) == 2 * width else ""
            raise InputError(f"{path}: line {line}", f"{width} values", f"{len(row)}{hint}", plural=True)
    return found


def _is_content(line: str) -> bool:
    return bool(line.strip()) and not line.startswith("#")


def _cells(line: str, delimiter: str) -> list[str]:
    return next(csv.reader([line], delimiter=delimiter))


def _only_numbers(cells: list[str]) -> bool:
    return all(number_of(cell) is not None for cell in cells)


def _header(cells: list[str], path: Path) -> list[str]:
    # A table exported with its index has no name above the first column.
    names = [cell.strip() or f"column {number}" for number, cell in enumerate(cells, start=1)]
    if _only_numbers(names):
        raise InputError(path, "a header row with column names", "numbers")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(path, "unique column names", f"{twice!r} {names.count(twice)}x", plural=True)
    return names
