"""CSV logs, plain and gzipped."""

from __future__ import annotations

import csv
import gzip
import io
import itertools
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import numpy as np

from eccentric.errors import InputError
from eccentric.logs.assemble import InParts, Part, Read, column_of, number_of, overlaps
from eccentric.logs.limits import BATCH_ROWS, MOST_CHARACTERS
from eccentric.logs.room import require_room_for_text

POINT = "; a decimal point is required, as in 1.5"


def read_csv(path: Path) -> Read:
    """Read a CSV file with one header row; the delimiter is a comma, a semicolon or a tab.

    Leading lines that are empty or begin with `#` are skipped, except that the last of those is the
    header if none follows.
    """
    # Not `splitlines`, which also splits at form feeds and other separators inside cells.
    whole = text_of(path)
    rows = 1 + max(whole.count("\n"), whole.count("\r"))
    require_room_for_text(path, whole, rows, rows + sum(map(whole.count, ",;\t")))
    text = io.StringIO(whole, newline="").readlines()
    skipped = next((k for k, line in enumerate(text) if _is_content(line)), len(text))
    if skipped == len(text):
        raise InputError(f"{path}: a header row with column names is required, received an empty file")
    with _csv_errors(path):
        return _read(path, text, skipped)


@contextmanager
def _csv_errors(path: Path) -> Iterator[None]:
    try:
        yield
    except csv.Error as error:
        raise InputError(f"{path}: not a valid CSV file ({error})") from None


def text_of(path: Path) -> str:
    """Return the UTF-8 text of a file, unpacked if its name ends in .gz; InputError above a gigabyte."""
    with _opened(path) as file:
        text = file.read(MOST_CHARACTERS + 1)
    if len(text) > MOST_CHARACTERS:
        raise InputError(f"{path}: at most {MOST_CHARACTERS:,} characters are required, received more")
    return text


def csv_source(path: Path) -> InParts:
    """Return a CSV file as blocks of rows; it has at most as many as lines, which are counted."""
    with _csv_errors(path):
        header, delimiter, before = _start(path)

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
                    columns = {name: column_of(values[k]) for name, k in zip(names, chosen, strict=True)}
                    yield Part(first, columns, np.array([line for line, _ in found], dtype=np.int64))
                at += len(block)

    return InParts(tuple(header), _lines(path) - before, parts)


def _start(path: Path) -> tuple[list[str], str, int]:
    """Column names, delimiter, and the number of lines before the first row."""
    last = ""
    with _opened(path) as file:
        for skipped, line in enumerate(file):
            if _is_content(line):
                names, delimiter, is_row = _names(last, line)
                return _header(names, path), delimiter, skipped + (not is_row)
            last = line
    raise InputError(f"{path}: a header row with column names is required, received an empty file")


def _lines(path: Path) -> int:
    opened = gzip.open if path.name.lower().endswith(".gz") else open
    count = 1
    with opened(path, "rb") as file:
        while chunk := file.read(1 << 20):
            count += max(chunk.count(b"\n"), chunk.count(b"\r"))
    return count


def _opened(path: Path) -> IO[str]:
    opened = gzip.open if path.name.lower().endswith(".gz") else open
    return opened(path, "rt", encoding="utf-8-sig", newline="")


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


def _read(path: Path, text: list[str], skipped: int) -> Read:
    names, delimiter, is_row = _names(text[skipped - 1] if skipped else "", text[skipped])
    header, before = _header(names, path), skipped + (not is_row)
    reader = csv.reader(text[before:], delimiter=delimiter)
    found = _rectangular(
        [(before + reader.line_num, row) for row in reader if row], len(header), delimiter, path
    )
    values = zip(*(row for _, row in found), strict=True)
    lines = np.array([line for line, _ in found], dtype=np.int64)
    return Read({name: column_of(column) for name, column in zip(header, values, strict=False)}, lines)


def _rectangular(
    found: list[tuple[int, list[str]]], width: int, delimiter: str, path: Path
) -> list[tuple[int, list[str]]]:
    """The rows, each with its line; InputError for one with more values than names, or fewer."""
    for line, row in found:
        if len(row) != width:
            hint = POINT if delimiter == "," and len(row) == 2 * width else ""
            raise InputError(f"{path}: line {line}: {width} values are required, received {len(row)}{hint}")
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
        raise InputError(f"{path}: a header row with column names is required, received numbers")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(
            f"{path}: unique column names are required, received {twice!r} {names.count(twice)}x"
        )
    return names
