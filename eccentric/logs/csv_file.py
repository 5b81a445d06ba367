"""Tables as text, plain and gzipped: CSV, values between semicolons, tabs or blanks, exports of scopes.

A workbook is read as the text of its cells.
"""

from __future__ import annotations

import codecs
import csv
import dataclasses
import datetime as dt
import gzip
import io
import itertools
import re
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, few
from eccentric.logs import limits
from eccentric.logs.assemble import Column, InParts, Part, Read, number_of, overlaps
from eccentric.logs.cells import (
    EXACT,
    POINT,
    cells_to_column,
    is_number,
    lists_of,
    plain_column,
    plainly,
    signs_of,
    units_row,
)
from eccentric.logs.clocks import of_clocks, of_topics
from eccentric.logs.foreign import (
    library,
    opened_text,
    reading,
    require_room_for_numbers,
    require_room_for_text,
    text_of,
)
from eccentric.logs.labels import has_labels, of_labels
from eccentric.logs.layout import BLANKS, Layout, is_content, is_prose, layout_of, rows_of, uncommented

_NO_TABLES = {
    "version https://git-lfs": "a pointer of Git LFS: fetch the file itself, as with git lfs pull",
    "<": "a web page or XML: download the raw file, or export a CSV file",
    **dict.fromkeys(
        ("FMT, 128", "H Product:"),
        "a flight log of ArduPilot or Betaflight: decode it with mavlogdump.py or blackbox_decode",
    ),
}
"""How files begin that stand in place of a log, and what to do."""
_COMMA = re.compile(r"\d,\d")
_NO_TEXT = re.compile(r"[\x00-\x08\x0e-\x1f]")
_FRAMES = re.compile(
    r"\s*(\(\d+\.\d+\)\s+)?[vs]?l?can\d\s+[0-9A-Fa-f]{3,8}(#|\s+\[\d\])|;\$FILEVERSION|date \w+ .*\d{4}\s*$"
)
"""Lists of frames on a CAN bus: of candump, PEAK and Vector."""
_AROUND = (
    re.compile(r"\|?(.*?)\|?"),
    re.compile(r"\[([^\[\]]*[,\s][^\[\]]*)\],?"),
    re.compile(r"\(([^()]*[,\s][^()]*)\),?"),
    re.compile(r"\$([^*]*)\*[\dA-Fa-f]{2}"),
)
"""What a line may have around its values: borders, brackets of Python, "$" and a checksum as in NMEA 0183."""
_RULE = re.compile(r"\s*[|+]?(\s*:?[-=]{2,}:?\s*[|+])+(\s*:?[-=]{2,}:?)?\s*")
"""A line drawn in a table of text, as Markdown has one below the header."""


def read_csv(path: Path) -> Read:
    """Read a table as text: one header row, values between commas, semicolons, tabs or blanks.

    Lines of settings may come before the header and a row of units after it. Where a comma is no delimiter it
    may be the decimal separator. Dates and times of day become seconds. Rows of several topics, and groups of
    columns with a time of their own, are put on one clock. Leading lines that are empty or begin with `#` are
    skipped, except that the last of those is the header if none follows.
    """
    # Not `splitlines`, which also splits at form feeds and other separators inside cells.
    whole, said = _decoded(path)
    read = read_text(whole, path)
    return dataclasses.replace(read, notes=(*said, *read.notes))


def read_text(whole: str, path: Path) -> Read:
    """Return the table in a text, as `read_csv` reads it from a file; `path` is that of messages."""
    rows = 1 + max(whole.count("\n"), whole.count("\r"))
    require_room_for_text(path, whole, rows, rows + sum(map(whole.count, ",;\t")))
    text = io.StringIO(plainly(whole), newline="").readlines()
    if _is_labelled(text[: limits.LAYOUT_LINES]) and (labelled := of_labels(text)) is not None:
        return labelled
    if (around := _around(text[: limits.LAYOUT_LINES])) is not None:
        text = [_within(around, line) for line in text]
    with _csv_errors(path):
        layout = _start(path, text)
        read = _of_rows(path, text, layout)
        read_as = (*layout.notes, *read.read_as)
        read = of_clocks(read, layout.clocks, path) if layout.clocks else of_topics(read, path)
    return dataclasses.replace(read, read_as=read_as)


@contextmanager
def _csv_errors(path: Path) -> Iterator[None]:
    try:
        yield
    except csv.Error:  # of lines that are whole there is no other
        raise InputError(
            path,
            f"values of at most {csv.field_size_limit():,} characters",
            "a longer one: is a quotation mark left open?",
        ) from None


def csv_source(path: Path) -> InParts | None:
    """Return a CSV file as blocks of rows; it has at most as many as lines, which are counted.

    None for one whose first rows need more than reading numbers, such as dates, a row of units or topics, and
    for one that is not UTF-8 throughout.
    """
    try:
        with _csv_errors(path):
            lines = _first_lines(path, limits.LAYOUT_LINES)
            if _is_labelled(lines) or _around(lines) is not None:
                return None
            layout = _start(path, lines)
            if layout.clocks or layout.units or layout.every or not _plain(path, layout):
                return None
        rows = _lines(path)
    except UnicodeDecodeError:
        return None
    header, before = layout.names, layout.before
    sample = (
        row for _, row in rows_of(_first_lines(path, before + limits.SAMPLE_ROWS)[before:], layout.delimiter)
    )
    # Decided once, as for the whole: what follows and does not agree is text.
    signs = signs_of(list(itertools.zip_longest(*sample, fillvalue="")), layout.delimiter)

    def parts(names: Sequence[str], spans: Sequence[tuple[int, int]]) -> Iterator[Part]:
        chosen, at = [header.index(name) for name in names], 0
        with opened_text(path) as file, _csv_errors(path):
            for _ in range(before):
                next(file)
            rows = ((before + line, row) for line, row in rows_of(_plainly(file), layout.delimiter))
            while at < spans[-1][1] and (block := list(itertools.islice(rows, limits.BATCH_ROWS))):
                for first, end in overlaps(at, at + len(block), spans):
                    found = _rectangular(block[first - at : end - at], layout, path)
                    values = list(zip(*(row for _, row in found), strict=True))
                    columns = {
                        name: plain_column(values[k], signs[k]) for name, k in zip(names, chosen, strict=True)
                    }
                    yield Part(first, columns, np.array([line for line, _ in found], dtype=np.int64))
                at += len(block)

    return InParts(header, rows - before, parts, layout.notes)


def _around(lines: Sequence[str]) -> re.Pattern[str] | None:
    """What nine lines of ten have around their values, but for those drawn; None for nothing."""
    given = [line.strip() for line in lines if line.strip() and not _RULE.fullmatch(line)]
    if any(map(_RULE.fullmatch, lines)):
        return _AROUND[0]
    return next(
        (one for one in _AROUND[1:] if sum(map(bool, map(one.fullmatch, given))) > 0.9 * len(given)), None
    )


def _within(around: re.Pattern[str], line: str) -> str:
    found = around.fullmatch(line.strip())
    return "\n" if _RULE.fullmatch(line) else f"{found[1]}\n" if found else line


def _first_lines(path: Path, most: int) -> list[str]:
    with opened_text(path) as file:
        return list(_plainly(itertools.islice(file, most)))


def _plainly(lines: Iterator[str]) -> Iterator[str]:
    """Lines by `plainly`, in blocks: few need it, and to look at each one takes as long as to split it."""
    while block := list(itertools.islice(lines, limits.SAMPLE_ROWS)):
        whole = "".join(block)
        yield from block if plainly(whole) == whole else map(plainly, block)


def _start(path: Path, text: Sequence[str]) -> Layout:
    """Where the table of a text begins: at its header, or below lines of settings.

    Raises InputError for a text without a header.
    """
    skipped = next((k for k, line in enumerate(text) if is_content(line)), len(text))
    if skipped == len(text):
        raise InputError(path, "a header row with column names", "an empty file")
    other = next((said for start, said in _NO_TABLES.items() if text[skipped].lstrip().startswith(start)), "")
    if other:
        raise InputError(path, "a table of text", other)
    if text[skipped].rstrip().endswith(":") and sum(line.rstrip() == "---" for line in text[skipped:]) > 1:
        raise InputError(
            path,
            "a table of text",
            "YAML documents: record a bag, or print rows, as with ros2 topic echo --csv",
        )
    if _FRAMES.match(text[skipped]):
        raise InputError(
            path,
            "a table of text",
            "frames of a CAN bus: decode them by the drive's DBC or object dictionary, and write a table",
        )
    names, delimiter, is_row = _names(text[skipped - 1] if skipped else "", text[skipped])
    before = skipped + (not is_row)
    sample = text[: before + limits.LAYOUT_LINES]
    if not is_row and not _is_table(names, delimiter, sample[before:]):
        found = layout_of(sample, path)
        if found is not None:
            return dataclasses.replace(found, names=_unique(found, path))
    if not is_row and _only_numbers(re.split(r"[,;\s]+", text[skipped].strip())):
        line = " ".join(text[skipped].split())[:60]
        raise InputError(
            path, "a header row with column names, and rows below it", f"{line!r} in line {skipped + 1}"
        )
    return Layout(_header(names, path), delimiter, before)


def _is_labelled(lines: Sequence[str]) -> bool:
    """Whether most lines are labelled numbers, and the first is no header of a table whose cells are such."""
    if not has_labels(lines):
        return False
    first = next(k for k, line in enumerate(lines) if is_content(line))
    names, delimiter, is_row = _names(lines[first - 1] if first else "", lines[first])
    return not is_row and not _is_table(names, delimiter, lines[first + 1 :])


def _is_table(names: Sequence[str], delimiter: str, below: Sequence[str]) -> bool:
    """Whether the first line is the header of the lines below it, of which one of the first has a number."""
    every = [row for _, row in rows_of(iter(below), delimiter)]
    rows = every[:3]
    if not rows:
        return True
    if delimiter == "," and any(
        all(
            _COMMA.search(line) and apart in line and all(map(is_number, line.split(apart)))
            for line in below[:3]
        )
        for apart in ";\t"
    ):
        return False  # "time, s;angle, rad" above decimal commas
    if 2 * sum(len(row) == len(names) for row in every) < len(every):
        return False  # settings of two cells above a wider table
    if len(names) == 1 and any(len(row[0].split()) > 1 for row in rows if row):
        return False
    widths = {len(row) for row in rows} == {len(names)}
    return (
        widths
        and len(set(names)) == len(names)
        and (bool(names[-1].strip()) or not any(row[-1].strip() for row in rows))
        and not any(name.strip() and is_number(name) for name in names)
        and any(is_number(cell) for row in rows for cell in row)
    )


def _unique(layout: Layout, path: Path) -> tuple[str, ...]:
    """The names of a layout, in which those of several clocks are numbered."""
    clocks = {k: number for number, k in enumerate(layout.clocks, start=1)}
    called = [name if clocks.get(k, 1) == 1 else f"{name} {clocks[k]}" for k, name in enumerate(layout.names)]
    return _header(called, path)


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


def _names(comment: str, line: str) -> tuple[list[str], str, bool]:
    """Column names from the first line with content, or from the comment before it; if it is a row."""
    comment = uncommented(comment)
    delimiter = max(",;\t|", key=line.count)
    # numpy.savetxt writes the column names as a comment.
    if comment.strip() and _only_numbers(first := _cells(line, delimiter)):
        names = _cells(comment, delimiter)
        if at_blanks := len(names) != len(first):
            names = comment.split()
        if len(names) == len(first) and not is_prose(comment, at_blanks=at_blanks):
            return names, delimiter, True
    return _cells(line, delimiter), delimiter, False


def _plain(path: Path, layout: Layout) -> bool:
    """Whether the first rows are nothing but numbers and names, one row for each moment."""
    read = _of_rows(path, _first_lines(path, layout.before + limits.SAMPLE_ROWS), layout)
    return not read.notes and not read.units and of_topics(read, path) is read


def _of_rows(path: Path, text: Sequence[str], layout: Layout) -> Read:
    """The rows below the first lines of a text."""
    header, before = layout.names, layout.before
    if (numbers := _all_numbers(text[before:], layout)) is not None:
        lines = np.arange(before + 1, before + 1 + len(numbers))
        decimal = "." if any("." in line for line in text[before:]) else ""
        columns = dict(zip(header, numbers.T.copy(), strict=True))
        read = Read(columns, lines, units=layout.units, read_as=_signs(layout, decimal))
        return _timed(read, layout)
    found = [(before + line, row) for line, row in rows_of(text[before:], layout.delimiter)]
    units = units_row(header, *(row for _, row in found[:2])) if len(found) > 1 else {}
    found = _rectangular(found[1:] if units else found, layout, path)
    values = list(zip(*(row for _, row in found), strict=True))
    signs = signs_of(values, layout.delimiter)
    lines = np.array([line for line, _ in found], dtype=np.int64)
    columns: dict[str, Column] = {}
    notes: list[str] = []
    units = {**layout.units, **units}
    for name, cells, sign in zip(header, values, signs, strict=False):
        if (lists := lists_of(cells)) is not None:
            columns |= {f"{name}(:,{k})": column for k, column in enumerate(lists.T, start=1)}
            continue
        columns[name], unit, note = cells_to_column(name, cells, sign)
        notes += [note] if note else []
        units |= {name: unit} if unit else {}
    used = {
        mark
        for mark in ".,"
        for cells, sign in zip(values, signs, strict=True)
        if mark == sign.decimal and any(mark in cell and is_number(cell) for cell in cells)
    }
    return _timed(Read(columns, lines, tuple(notes), units, _signs(layout, used)), layout)


def _timed(read: Read, layout: Layout) -> Read:
    """The rows with the time that the lines above them state."""
    if layout.every is None or read.lines is None:
        return read
    name, start, step = layout.every
    count = read.columns.get(name, np.full(len(read.lines), np.nan))
    if count.dtype.kind != "f":  # a row with a text has no time
        count = np.array([np.nan if (x := number_of(cell)) is None else x for cell in count.tolist()])
    if not np.any(np.isfinite(count)):
        count = np.arange(len(read.lines), dtype=float)
    elif np.any(count[np.isfinite(count)] % 1.0):
        return read  # of a scope that wrote the times themselves
    columns = {name: start + step * count, **{n: c for n, c in read.columns.items() if n != name}}
    return dataclasses.replace(read, columns=columns, units={**read.units, name: "s"})


def _signs(layout: Layout, decimals: Collection[str]) -> tuple[str]:
    """How values are separated, and their decimal sign; both signs where columns differ."""
    marks = (mark for sign, mark in ((".", "decimal point"), (",", "decimal comma")) if sign in decimals)
    return ("; ".join((f"delimiter: {_DELIMITERS[layout.delimiter]}", *marks)),)


_DELIMITERS = {",": "comma", ";": "semicolon", "\t": "tab", "|": "vertical bar", BLANKS: "blanks"}


def _all_numbers(lines: Sequence[str], layout: Layout) -> NDArray[np.float64] | None:
    """The rows (n, columns) by NumPy's parser, which is faster; None unless every cell is a plain number."""
    if not all(map(str.strip, lines)) or not lines:
        return None  # what is empty has a line as well
    try:
        found = np.loadtxt(lines, delimiter=layout.delimiter or None, comments=None, ndmin=2)
    except ValueError:
        return None
    if found.shape[1] != len(layout.names) or np.any(np.abs(found) > EXACT):
        return None
    return found


def _decoded(path: Path) -> tuple[str, tuple[str, ...]]:
    """The text of a file, as Latin-1 with a note where it is not UTF-8; UnicodeDecodeError for no text."""
    try:
        return text_of(path), ()
    except UnicodeDecodeError as error:
        if error.object[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
            return text_of(path, "utf-16"), ()
        if text := _in_words(path, "cp932", _JAPANESE):
            return text, _read_as("Shift JIS")
        with suppress(UnicodeDecodeError):
            # Of two bytes above 0xA0 each, and of the usual Chinese characters: no text in Latin-1 is.
            text = text_of(path, "gb2312")
            # Nor is a text of signs such as two micros, which would be one of them.
            signs = {byte for byte in error.object if byte > 0x7F} <= {*"°±²³µ·".encode("latin-1")}
            if not signs and all(c.isascii() or c.encode("gb2312") < b"\xd8" for c in set(text)):
                return text, _read_as("GB 2312")
        if text := _in_words(path, "cp1251", _CYRILLIC):
            return text, _read_as("Windows-1251")
        text = text_of(path, "cp1252")  # raises where Latin-1 of Windows has no character
        if _NO_TEXT.search(text):
            raise
        return text, _read_as("Latin-1")


def _read_as(encoding: str) -> tuple[str]:
    return (f"not valid UTF-8: read as {encoding}",)


_JAPANESE = re.compile(
    r"([\u3040-\u30ff\u4e00-\u9fff\uff00-\uff60]{2,})|(?<![^\W_])[\u3040-\u30ff\u4e00-\u9fff](?![^\W_])|[°℃μΩ]"
)
_CYRILLIC = re.compile(r"([\u0400-\u04ff]{3,})|(?<![^\W_])[\u0400-\u04ff]{1,2}(?![^\W_])|[°±µ·]")
"""Long words; shorter ones, as of units, between other signs; and signs of units."""


def _in_words(path: Path, encoding: str, letters: re.Pattern[str]) -> str:
    """The text of a file in an encoding whose letters are in words, one of them long; "" for another file."""
    with suppress(UnicodeDecodeError):
        text = text_of(path, encoding)
        if any(one[1] for one in letters.finditer(text)) and letters.sub("", text).isascii():
            return text
    return ""


def _rectangular(
    found: list[tuple[int, list[str]]], layout: Layout, path: Path
) -> list[tuple[int, list[str]]]:
    """The rows, each with its line; a few that are broken, or the last one, are rows of missing values.

    Raises InputError for one with more values than names, or fewer, where there are many.
    """
    width = len(layout.names)
    if layout.clocks:  # a group that has ended leaves its places out
        found = [(line, [*row, *[""] * (width - len(row))]) for line, row in found]
    other = [k for k, (_, row) in enumerate(found) if len(row) != width]
    if other and (len(other) > limits.MOST_BROKEN * len(found) or len(found) < 1 / limits.MOST_BROKEN):
        rows = [row[:width] if not any(map(str.strip, row[width:])) else row for _, row in found]
        if all(len(row) == width for row in rows):  # a delimiter at the end of every row
            return [(line, row) for (line, _), row in zip(found, rows, strict=True)]
        line, row = found[other[0]]
        hint = POINT if layout.delimiter == "," and len(row) == 2 * width else ""
        raise InputError(f"{path}: line {line}", f"{width} values", f"{len(row)}{hint}")
    for k in other:
        found[k] = (found[k][0], [""] * width)
    return found


def _cells(line: str, delimiter: str) -> list[str]:
    return next(csv.reader([line], delimiter=delimiter))


def _only_numbers(cells: list[str]) -> bool:
    return all(number_of(cell) is not None for cell in cells)


def _header(cells: Sequence[str], path: Path) -> tuple[str, ...]:
    # A table exported with its index has no name above the first column.
    names = [cell.strip() or f"column {number}" for number, cell in enumerate(cells, start=1)]
    if _only_numbers(names):
        raise InputError(path, "a header row with column names", "numbers")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        named = f"{twice!r} {names.count(twice)}x: give each column a name of its own in the file"
        raise InputError(path, "unique column names", named)
    return tuple(names)


def read_xlsx(path: Path) -> Read:
    """Read the sheet with the most rows; formulas are not evaluated, their stored results are read."""
    openpyxl = library("openpyxl", "xlsx", path)
    with reading(path, "workbook"):
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        try:
            sheets = [sheet for sheet in book.worksheets if (sheet.max_row or 0) > 1]
            if not sheets:
                raise InputError(path, "a sheet with rows", "none")
            chosen = max(sheets, key=lambda sheet: sheet.max_row)
            require_room_for_numbers(path, chosen.max_row, chosen.max_row * (chosen.max_column or 1))
            text = io.StringIO()
            writer = csv.writer(text, delimiter=";", lineterminator="\n")
            for row in chosen.iter_rows(values_only=True):
                writer.writerow([_cell(value) for value in row])
        finally:
            book.close()
        others = [sheet.title for sheet in sheets if sheet is not chosen]
        notes = [f"sheet {chosen.title!r} is read"] if others else []
        if others:
            notes.append(f"left out, other sheets: {few(others, 5)}")
        read = read_text(text.getvalue(), path)
    # The delimiter is that of the text above, not of the workbook.
    return dataclasses.replace(read, notes=(*notes, *read.notes), read_as=read.read_as[:-1])


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, dt.datetime | dt.time):
        return value.isoformat(*([" "] if isinstance(value, dt.datetime) else []))
    return str(value)
