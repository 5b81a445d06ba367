"""CSV logs, plain and gzipped."""

from __future__ import annotations

import csv
import gzip
import io
from pathlib import Path

import numpy as np

from eccentric.errors import InputError
from eccentric.logs.assemble import Read, column_of, number_of
from eccentric.logs.limits import MOST_CHARACTERS
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
    try:
        return _read(path, text, skipped)
    except csv.Error as error:
        raise InputError(f"{path}: not a valid CSV file ({error})") from None


def text_of(path: Path) -> str:
    """Return the UTF-8 text of a file, unpacked if its name ends in .gz; InputError above a gigabyte."""
    opened = gzip.open if path.name.lower().endswith(".gz") else open
    with opened(path, "rt", encoding="utf-8-sig", newline="") as file:
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
    for line, row in found:
        if len(row) != len(header):
            hint = POINT if delimiter == "," and len(row) == 2 * len(header) else ""
            raise InputError(
                f"{path}: line {line}: {len(header)} values are required, received {len(row)}{hint}"
            )
    values = zip(*(row for _, row in found), strict=True)
    lines = np.array([line for line, _ in found], dtype=np.int64)
    return Read({name: column_of(column) for name, column in zip(header, values, strict=False)}, lines)


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
