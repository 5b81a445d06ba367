"""CSV logs, plain and gzipped."""

from __future__ import annotations

import csv
import dataclasses
import gzip
import io
import re
from pathlib import Path

import numpy as np

from eccentric.errors import InputError
from eccentric.logs.assemble import Column, Read, number_of
from eccentric.logs.csv_cells import cells_to_column, units_row
from eccentric.logs.limits import MOST_CHARACTERS
from eccentric.logs.room import require_room_for_text
from eccentric.logs.topics import of_topics

_NO_TEXT = re.compile(r"[\x00-\x08\x0e-\x1f]")
POINT = "; a decimal point is required, as in 1.5"


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
        raise InputError(f"{path}: a header row with column names is required, received an empty file")
    try:
        read = of_topics(_read(path, text, skipped), path)
    except csv.Error as error:
        raise InputError(f"{path}: not a valid CSV file ({error})") from None
    return dataclasses.replace(read, notes=(*said, *read.notes))


def text_of(path: Path, encoding: str = "utf-8-sig") -> str:
    """Return the text of a file, unpacked if its name ends in .gz; InputError above a gigabyte."""
    opened = gzip.open if path.name.lower().endswith(".gz") else open
    with opened(path, "rt", encoding=encoding, newline="") as file:
        text = file.read(MOST_CHARACTERS + 1)
    if len(text) > MOST_CHARACTERS:
        raise InputError(f"{path}: at most {MOST_CHARACTERS:,} characters are required, received more")
    return text


def _read(path: Path, text: list[str], skipped: int) -> Read:
    # numpy.savetxt writes the column names as a comment.
    comment = text[skipped - 1].lstrip("# \t") if skipped else ""
    delimiter = max(",;\t", key=text[skipped].count)
    if comment.strip() and _only_numbers(first := _cells(text[skipped], delimiter)):
        names = _cells(comment, delimiter)
        if len(names) != len(first):
            names = comment.split()
        if len(names) == len(first):
            text[skipped - 1], skipped = delimiter.join(names) + "\n", skipped - 1
    header = _header(_cells(text[skipped], delimiter), path)
    reader = csv.reader(text[skipped + 1 :], delimiter=delimiter)
    found = [(skipped + 1 + reader.line_num, row) for row in reader if row]
    units = units_row(header, *(row for _, row in found[:2])) if len(found) > 1 else {}
    if units:
        found = found[1:]
    for line, row in found:
        if len(row) != len(header):
            hint = POINT if delimiter == "," and len(row) == 2 * len(header) else ""
            raise InputError(
                f"{path}: line {line}: {len(header)} values are required, received {len(row)}{hint}"
            )
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
