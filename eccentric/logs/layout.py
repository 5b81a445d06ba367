"""Where the table of a text file is: its delimiter, the lines above it, the header and the units.

A file that begins with its header needs none of this. Scopes, traces and drive tools write lines of settings
first, of other widths or with the label of the line in its first cell. The table then begins at the first
line whose cells are numbers wherever those of the lines below are, and the header is the last line of text
above it that names every column once.
"""

from __future__ import annotations

import csv
import itertools
import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime

import numpy as np

from eccentric.core import InputError
from eccentric.logs import limits
from eccentric.logs.assemble import EITHER, MISSING, Column, column_of, number_of
from eccentric.logs.units import parse_unit

# Cells of a text log that are no plain numbers: decimal commas, dates, times of day, counters, units.


_GROUPED = {
    ",": re.compile(r"\s*[-+]?[1-9]\d{0,2}(?:,\d{3})+(?P<rest>\.\d*)?\s*"),
    ".": re.compile(r"\s*[-+]?[1-9]\d{0,2}(?:\.\d{3})+(?P<rest>,\d*)?\s*"),
}
"""Numbers with a comma, or a point, between groups of three digits."""
_WITH_UNIT = re.compile(
    r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([A-Za-z°µμΩ%][\w°µμΩ%/^·* ]*?)\s*"
)
POINT = "; expected a decimal point, as in 1.5"
_DECIMAL_COMMA = re.compile(r"\s*[-+]?(?:\d+(?:,\d*)?|,\d+)(?:[eE][-+]?\d+)?\s*")
_DATE = re.compile(r"\s*\d{4}-\d\d-\d\d[T ]\d\d:\d\d")
_UNIT = re.compile(r"[\[(]?\s*[A-Za-zµμΩ°%/^·* \d.²³-]{0,12}\s*[\])]?")
_TIME_OF_DAY = re.compile(
    r"\s*(?:(?:\d{1,4}[-./]\d{1,2}[-./]\d{1,4}|[A-Za-z]{3,9},?)[T ,]+)*"
    r"(?P<hour>[01]?\d|2[0-3]):(?P<minute>[0-5]\d)(?::(?P<second>[0-5]\d)(?P<fraction>[.,:]\d+)?)?"
    r"\s*(?:(?P<half>[AaPp])[Mm])?\s*"
)
EXACT = 2**53
"""Whole numbers above this are not exact as floating point: nanoseconds since 1970 are in steps of 256."""


@dataclass(frozen=True)
class Sign:
    """The decimal sign of a column: "." or ",", "" where it may be either.

    `proved` says that its own numbers show it, `assumed` that those of no column do.
    """

    decimal: str = "."
    proved: bool = False
    assumed: bool = False


def signs_of(columns: Sequence[Sequence[str]], delimiter: str) -> list[Sign]:
    """Return the decimal sign of each column of text, by its own numbers, else by those of the others.

    Groups of three digits prove nothing, unless there are several or the other sign follows: 1,234 may be
    1.234 or 1234.
    """
    signed = (c for cells in columns for c in cells if "," in c or c.count(".") > 1)
    if not any(_DECIMAL_COMMA.fullmatch(c) or _groups(c) for c in signed):
        return [Sign(assumed=not any("." in cell for cell in cells)) for cells in columns]
    proved = [_proved(cells) for cells in columns]
    table = set[str]().union(*proved)
    return [_sign(cells, own, table, delimiter) for cells, own in zip(columns, proved, strict=True)]


def _sign(cells: Sequence[str], own: set[str], table: set[str], delimiter: str) -> Sign:
    if len(own) == 1:
        return Sign(next(iter(own)), proved=True)
    if table:
        return Sign(next(iter(table)) if len(table) == 1 and not own else "")
    others = [number_of(cell) for cell in _given(cells) if "," not in cell]
    # Semicolons and tabs are written where the comma is taken; a zero may stand without its decimals.
    return Sign("") if delimiter == "," or any(others) else Sign(",", assumed=True)


def _proved(cells: Sequence[str]) -> set[str]:
    """The decimal signs that the numbers of a column prove; none where most cells are no numbers."""
    given = _given(cells)
    if 2 * sum(is_number(c) or _groups(c) is not None for c in given) <= len(given):
        return set()
    return {sign for cell in given if (sign := _decimal_sign(cell))}


def _groups(cell: str) -> tuple[str, bool] | None:
    """What separates the groups of three digits of a number, and whether it cannot be the decimal sign."""
    for of, form in _GROUPED.items():
        if of in cell and (one := form.fullmatch(cell)):
            return of, cell.count(of) > 1 or bool(one["rest"])
    return None


def _decimal_sign(cell: str) -> str:
    """The decimal sign that a cell proves, "" for none."""
    if found := _groups(cell):
        of, sure = found
        return (",", ".")[of == ","] if sure else ""
    if "," in cell:
        return "," if _DECIMAL_COMMA.fullmatch(cell) else ""
    return "." if "." in cell and number_of(cell) is not None else ""


def _with_point(cell: str, sign: Sign) -> str:
    """A number as `float` takes it; what is none, or not surely one, as text."""
    shown = _decimal_sign(cell)
    if shown:
        plain = cell.replace(",", "") if shown == "." else cell.replace(".", "").replace(",", ".")
        if shown == sign.decimal or not sign.decimal or (sign.assumed and "." not in cell):
            return plain
        # Of a part of a log, whose first rows prove the other sign; a decimal comma is reported as such.
        return cell if "." not in cell else f"{plain}{EITHER}another"
    if found := _groups(cell):
        of, plain = found[0], cell.strip().replace(",", ".")
        whole = plain.replace(".", "")
        return plain if sign.decimal == of else whole if sign.proved else f"{plain}{EITHER}{whole}"
    return cell.replace(",", ".") if _DECIMAL_COMMA.fullmatch(cell) else cell


def cells_to_column(name: str, cells: Sequence[str], sign: Sign) -> tuple[Column, str, str]:
    """Return a column of text as numbers where it can be, its unit if the cells say it, and a note.

    `sign` is that of the column, by `signs_of`.
    """
    given = _given(cells)
    column = plain_column(cells, sign)
    if (note := _said(name, given, sign)) and (column.dtype.kind == "f" or EITHER in note):
        return column, "", note
    if column.dtype.kind == "f":
        return _counter(name, cells, column)
    if len(units := {one[2] if (one := _WITH_UNIT.fullmatch(c)) else "" for c in given}) == 1 and (
        unit := _as_unit(units.pop())
    ):
        found = [_WITH_UNIT.fullmatch(cell) for cell in cells]
        return column_of([one[1] if one else "" for one in found]), unit, ""
    if given and all(map(_DATE.match, given)):
        return _dates(name, cells, column)
    if given and all(map(_TIME_OF_DAY.fullmatch, given)):
        return _times_of_day(name, cells)
    return column, "", ""


def _said(name: str, given: Sequence[str], sign: Sign) -> str:
    """How numbers with groups of three digits are read; "" where that is sure, or there are none."""
    grouped = [(cell, found) for cell in given if (found := _groups(cell))]
    if (sign.decimal == "." and all(of == "." and not sure for _, (of, sure) in grouped)) or not grouped:
        return ""
    either = next((cell for cell, _ in grouped if EITHER in _with_point(cell, sign)), None)
    if either is not None:
        return f"{name}: {either} may be {_with_point(either, sign)}"
    apart = next((of for _, (of, sure) in grouped if sure or sign.decimal != of), None)
    if apart is not None:
        return f"{name}: {apart!r} separates thousands"
    return f"{name}: {grouped[0][0]} taken as {_with_point(grouped[0][0], sign)}" if sign.assumed else ""


def plain_column(cells: Sequence[str], sign: Sign) -> Column:
    """Return cells as numbers, or as text where one is none; a number that can be two is text: both."""
    if sign.decimal == "." or not any("." in cell or "," in cell for cell in cells):
        column = column_of(cells)
        if column.dtype.kind == "f":
            return column
    # A cell that is no number stays as it is: whoever asks for numbers is told its line.
    return column_of([_with_point(cell, sign) for cell in cells])


def _as_unit(text: str) -> str:
    """A unit as cells and MATLAB's durations spell it; "" for none."""
    one = {"sec": "s", "secs": "s", "msec": "ms", "hr": "h", "C": "degC"}.get(text, text)
    with suppress(InputError):
        return parse_unit(one, "", 1.0).text
    return ""


def _given(cells: Sequence[str]) -> list[str]:
    return [cell for cell in cells if cell.strip().lower() not in MISSING]


def _counter(name: str, cells: Sequence[str], column: Column) -> tuple[Column, str, str]:
    """A counter beyond what floating point resolves counts from its first value."""
    if (
        not len(column)
        or not np.nanmax(np.abs(column), initial=0.0) > EXACT
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


def _times_of_day(name: str, cells: Sequence[str]) -> tuple[Column, str, str]:
    """Times of day, with or without a date before them, as seconds from the first; midnight goes on.

    The order of day and month does not matter: another date is the next day.
    """
    found = [_TIME_OF_DAY.fullmatch(cell) for cell in cells]
    seconds = np.array([math.nan if one is None else _of_day(one) for one in found])
    rows = np.flatnonzero(np.isfinite(seconds))
    steps = np.diff(seconds[rows])
    dates = [cells[k][: one.start("hour")].strip() for k in rows.tolist() if (one := found[k])]
    later = np.array([now != before for before, now in itertools.pairwise(dates)], bool)
    # Half a day back is a day on; less is a clock that was set.
    seconds[rows[1:]] += limits.DAY_S * np.cumsum(np.where(later, 1.0, np.round(-steps / limits.DAY_S)))
    first = cells[int(rows[0])].strip()
    return seconds - seconds[rows[0]], "s", f"{name}: times of day, as seconds from {first}"


def _of_day(found: re.Match[str]) -> float:
    hour = int(found["hour"])
    if found["half"]:
        hour = hour % 12 + (12 if found["half"] in "Pp" else 0)
    fraction = (found["fraction"] or "")[1:]
    return (
        3600.0 * hour + 60.0 * int(found["minute"]) + int(found["second"] or 0) + float(f"0.{fraction or 0}")
    )


def units_row(names: Sequence[str], first: Sequence[str], second: Sequence[str] | None) -> dict[str, str]:
    """The units in the row below the header, by column; empty if that row is one of values.

    It is a row of units if none of its cells is a number, all look like one, and the row below has numbers.
    """
    if second is None or len(first) != len(names) or len(second) != len(names):
        return {}
    numbers = [is_number(cell) for cell in second]
    said = [cell.strip() for cell in first]
    if not any(numbers) or any(is_number(cell) and cell for cell in said) or not any(said):
        return {}
    over_numbers = [cell for cell, number in zip(said, numbers, strict=True) if number]
    if not all(map(_UNIT.fullmatch, said)) or not any(over_numbers):
        return {}
    return {name: cell.strip("[]() ") for name, cell in zip(names, said, strict=True) if cell.strip("[]()- ")}


def is_number(cell: str) -> bool:
    """Whether a cell is a number, with a decimal point or comma."""
    found = number_of(cell)
    return (found is not None and found == found) or bool(cell.strip() and _DECIMAL_COMMA.fullmatch(cell))  # noqa: PLR0124 - NaN


BLANKS = ""
"""The delimiter of values between blanks."""
_SEEN = ("\t", ";", ",", "|", BLANKS)
_NAMES = frozenset({"name", "names", "channel", "channels", "channel name", "signal", "signal name"})
_UNITS = frozenset({"unit", "units", "unit name", "channel unit"})
_IN_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]+?)\s*[\])]")
_CLOCK = re.compile(r".*\d:\d\d(:\d\d)?([.,]\d+)?\s*([AaPp][Mm])?\s*Z?|\s*\d{4}-\d\d-\d\d.*")
_SETTING = re.compile(r"\s*[^\d\s,;=:][^,;=:]*[:=]\s*\S")
"""A line of settings, such as "Device: X"."""
_COMMA = re.compile(r"\s*[-+]?\d+,\d+\s*")
_PROSE = re.compile(
    r"[:=]\s*\S|\d{4}-\d\d-\d\d|\b(of|with|the|and|for|from|is|by|some|this|mit|der|die|das|und|von|für)\b",
    re.IGNORECASE,
)
_SETTING_OR_DATE = re.compile(r"[:=]\s*[-+.\d]|\d{4}-\d\d-\d\d")
_NAMED = re.compile(r"[^\W\d]\w*\s*[:=]\s*[-+]?[\d.]")


@dataclass(frozen=True)
class Layout:
    """A table in a text: `before` lines above its first row, the delimiter, and the names of its columns.

    `units` are by column, `clocks` the places of columns that are the time of those after them, where
    there is more than one; `notes` say which line was taken for the header.
    """

    names: tuple[str, ...]
    delimiter: str
    before: int
    units: Mapping[str, str] = field(default_factory=dict)
    clocks: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()


def rows_of(lines: Sequence[str] | Iterator[str], delimiter: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number of each line that has content, from 1, with its cells."""
    if delimiter == BLANKS:
        yield from ((k, row) for k, line in enumerate(lines, start=1) if (row := line.split()))
        return
    reader = csv.reader(lines, delimiter=delimiter)
    yield from ((reader.line_num, row) for row in reader if row)


def _may_be_number(cell: str) -> bool:
    """Whether a cell is a number, or marks a missing one, as "nan" and an empty cell do."""
    return number_of(cell) is not None or is_number(cell)


def layout_of(lines: Sequence[str], path: object) -> Layout | None:
    """Return where the table of a text is, by its first lines; None where they show none.

    Raises:
        InputError: a first row that may be names or values; the message says what to write above it.
    """
    require_bare_values(lines, path)
    body = _body(lines)
    if body is None:
        return None
    delimiter, first, rows = body
    width = len(rows[0])
    above = [
        (k, [cell.strip() for cell in cells])
        for k, line in enumerate(lines[:first], start=1)
        if not (
            line.startswith("#")
            and is_prose(line, at_blanks=delimiter == BLANKS and line.count(",") != width - 1)
        )
        for cells in _cells_above(line.lstrip("# \t") if line.startswith("#") else line, delimiter, width)
    ]
    found = _labelled(above, width) or _header(above, rows)
    if found is None:
        others = [k for k, line in enumerate(lines[:first]) if is_content(line) and not _SETTING.match(line)]
        if others and any(not is_number(cell) for _, cells in above for cell in cells):
            return None
        # Lines of other numbers are rows that the logger did not write whole.
        return _numbered(path, lines, first, min((first, *others)), delimiter, rows)
    line, names, units, clocks = found
    below = line > 2 or (line > 1 and (clocks or is_content(lines[0])))
    notes = (f"the header is line {line}",) if below else ()
    return Layout(tuple(names), delimiter, first, units, clocks, notes)


def require_bare_values(lines: Sequence[str], path: object) -> None:
    """InputError for lines of which most have a name before every value, as in "Time: 5001 Position: 596"."""
    named = [k for k, line in enumerate(lines) if len(_NAMED.findall(line)) > 1]
    if len(named) > max(1, 0.5 * len(lines)):
        line = " ".join(lines[named[0]].split())[:60]
        raise InputError(
            path,
            "a header row with column names, and values between commas below it",
            f"{line!r} in line {named[0] + 1}: write the names once, above the values",
        )


def is_content(line: str) -> bool:
    """Whether a line is neither empty nor a comment."""
    return bool(line.strip()) and not line.startswith("#")


def _cells_above(line: str, delimiter: str, width: int) -> list[list[str]]:
    """The cells of a line above a table: where blanks separate them, names may have single blanks in them."""
    for apart in (re.split(r"\t|\s{2,}", line.strip()), line.split(",")):
        if delimiter == BLANKS and len(apart) == width > 1:
            return [apart]
    return [cells for _, cells in rows_of([line], delimiter)]


def is_prose(comment: str, *, at_blanks: bool) -> bool:
    """Whether a comment is a sentence, a date or a setting, whose words are no names of columns.

    Names between commas may have such words, as "angle of link" has; those `at_blanks` are words alone.
    """
    return bool((_PROSE if at_blanks else _SETTING_OR_DATE).search(comment))


def has_rows(lines: Sequence[str]) -> bool:
    """Whether some lines are rows of a table: three or more, of two or more numbers each."""
    body = _body(lines)
    return body is not None and len(body[2]) >= limits.ROWS_OF_A_TABLE and len(body[2][0]) > 1


def _numbered(
    path: object, lines: Sequence[str], first: int, before: int, delimiter: str, rows: Sequence[Sequence[str]]
) -> Layout:
    """A table without a header, its first row in line `first`; InputError where that may be anything else."""
    shown = f"{' '.join(lines[first].split())[:60]!r} in line {first + 1}"
    if not all(_may_be_number(cell) or _CLOCK.fullmatch(cell) for cell in rows[0]):
        raise InputError(path, "a header row with column names, and values between commas below it", shown)
    width = max(k for row in rows for k, cell in enumerate(row, start=1) if cell.strip())
    comma = delimiter == "," and width == 2 and all(map(_COMMA.fullmatch, map(",".join, rows)))
    if comma or len(rows) < limits.ROWS_OF_A_TABLE or _may_be_names(rows):
        raise InputError(
            path,
            "a header row with column names",
            f"{shown}, which may be {'one number with a decimal comma' if comma else 'names or values'}:"
            f" write a line of {width} names above it",
        )
    note = "no header: columns are numbered from 1; name them in the file or map column_1 ... in [columns]"
    return Layout(tuple(f"column_{k + 1}" for k in range(width)), delimiter, before, notes=(note,))


def _may_be_names(rows: Sequence[Sequence[str]]) -> bool:
    """Whether the first row may be names: different whole numbers that count up, or stand above decimals."""
    names = [cell.strip() for cell in rows[0] if cell.strip()]
    if not all(name.isdecimal() for name in names) or len(set(names)) < len(names):
        return False
    counts = [int(name) for name in names]
    below = [any(re.search(r"[.,eE]", row[k]) for row in rows[1:]) for k in range(len(rows[0]))]
    return counts in (list(range(len(names))), list(range(1, len(names) + 1))) or all(below)


def _rises(cells: Sequence[str]) -> bool:
    """Whether the numbers of a column do not fall and are not all one, as a time does."""
    values = [number_of(cell.replace(",", ".")) for cell in cells if cell.strip()]
    steps = [a is not None and b is not None and b >= a for a, b in itertools.pairwise(values)]
    return bool(steps) and all(steps) and values[-1] != values[0]


def _body(lines: Sequence[str]) -> tuple[str, int, list[list[str]]] | None:
    """Delimiter, the number of lines above the first row, and some rows: of the widest table of numbers."""
    best: tuple[int, str, int, list[list[str]]] | None = None
    for delimiter in _SEEN:
        split = [next(rows_of([line], delimiter), (0, []))[1] for line in lines]
        for width, rows in _by_width(split).items():
            if width == 1 and delimiter != ",":
                continue  # a delimiter that no line has
            numeric = [all(_may_be_number(row[k]) for row in rows) for k in range(width)]
            filled = [any(is_number(row[k]) for row in rows) for k in range(width)]
            places = [k for k in range(width) if numeric[k] and filled[k]]
            clocks = [
                k for k in range(width) if k not in places and all(_CLOCK.fullmatch(row[k]) for row in rows)
            ]
            first = _first(split, width, places, clocks) if places else None
            size = len(places) + len(clocks)
            if first is not None and (best is None or size > best[0]):
                found = [row for row in split[first:] if len(row) == width]
                best = size, delimiter, first, found[: limits.SAMPLE_LINES]
    return None if best is None else best[1:]


def _by_width(split: Sequence[list[str]]) -> dict[int, list[list[str]]]:
    """The last rows of each width that many have, or the last line: the groups of a scope end one by one.

    The first half may be lines of settings of that width.
    """
    rows = [row for row in split if row]
    counts = Counter(map(len, rows))
    usual = [
        width for width, count in counts.most_common(4) if count >= min(limits.FEWEST_LINES, len(rows) // 4)
    ]
    last = [len(rows[-1])] if rows else []
    return {
        width: [row for row in rows if len(row) == width][-min(limits.SAMPLE_LINES, counts[width] // 2 + 1) :]
        for width in dict.fromkeys((*usual, *last))
    }


def _first(
    split: Sequence[Sequence[str]], width: int, places: Sequence[int], clocks: Sequence[int]
) -> int | None:
    """The first line from which three in a row, or all that there are, are rows of the table."""

    def is_row(row: Sequence[str]) -> bool:
        return (
            len(row) == width
            and all(_may_be_number(row[k]) for k in places)
            and any(is_number(row[k]) for k in places)
            and all(_CLOCK.fullmatch(row[k]) for k in clocks)
        )

    there = [(k, is_row(row)) for k, row in enumerate(split) if row]
    for at, (k, _) in enumerate(there):
        if all(row for _, row in there[at : at + limits.ROWS_OF_A_TABLE]):
            return k
    return None


_Found = tuple[int, list[str], dict[str, str], tuple[int, ...]]


def _labelled(above: Sequence[tuple[int, list[str]]], width: int) -> _Found | None:
    """A header with a label in its first cell, as "Name" or "Channel name", above one of units.

    The columns with a label are the time of those after them.
    """
    rows = [(k, cells) for k, cells in above if len(cells) == width]
    names = next((one for one in reversed(rows) if one[1][0].lower() in _NAMES), None)
    units = next((one for one in reversed(rows) if one[1][0].lower() in _UNITS), None)
    if names is None or units is None or width < 2:
        return None
    line, header = names
    label = header[0]
    clocks = tuple(k for k, cell in enumerate(header) if cell == label)
    steps = next(
        (cells[0] for _, cells in rows if cells[0].lower().startswith(("sampletime", "interval"))), ""
    )
    step_unit = _unit(steps)
    called = ["time" if k in clocks else cell or f"column {k + 1}" for k, cell in enumerate(header)]
    found = {name: unit for name, cell in zip(called, units[1], strict=True) if (unit := _unit(cell))}
    found.pop("time", None)
    return line, called, found | ({"time": step_unit} if step_unit else {}), clocks


def _header(above: Sequence[tuple[int, list[str]]], rows: Sequence[Sequence[str]]) -> _Found | None:
    """The last line of text above the rows that names every column, with the units in the lines below it."""
    width = len(rows[0])
    empty = [not any(row[k].strip() for row in rows) for k in range(width)]
    block: list[tuple[int, list[str]]] = []
    for k, cells in reversed(above[-limits.PREAMBLE_LINES :]):
        full = _full(cells, width, empty)
        if full is None or any(map(is_number, full)) or not any(full):
            break
        block.insert(0, (k, full))
    if not block:
        return None
    # A row of units names a column more than once, or all of its cells are units.
    once = [place for place, (_, cells) in enumerate(block) if not _repeats(cells)]
    place = once[-1] if once else 0
    if place and all(_is_unit(cell) or cell in ("", "-") for cell in block[place][1]):
        place -= 1
    line, cells = block[place]
    # A delimiter at the end of every row makes no column.
    ends = next((k for k in range(width, 0, -1) if cells[k - 1] or not empty[k - 1]), 0)
    names = [cell or f"column {k + 1}" for k, cell in enumerate(cells[:ends])]
    units: dict[str, str] = {}
    for _, below in block[place + 1 :]:
        # Beside units some loggers say there what a column is: "Analog 1" of "Servo motor speed".
        units |= {
            name: unit for name, cell in zip(names, below, strict=False) if (unit := _unit(cell) or cell)
        }
    clocks = tuple(k for k, name in enumerate(names) if name == names[0])
    is_pairs = len(clocks) > 1 and all(_rises([row[k] for row in rows]) for k in clocks)
    return line, names, units, clocks if is_pairs else ()


def _full(cells: list[str], width: int, empty: Sequence[bool]) -> list[str] | None:
    """The cells of a line, one for each column; None if it has none for one that has values."""
    if len(cells) > width and not any(cells[width:]):
        cells = cells[:width]
    if len(cells) < width and all(empty[len(cells) :]):
        cells = [*cells, *[""] * (width - len(cells))]
    return cells if len(cells) == width else None


def _repeats(cells: Sequence[str]) -> bool:
    given = [cell for cell in cells if cell]
    return len(set(given)) < len(given)


def _is_unit(cell: str) -> bool:
    """Whether a cell is a unit and nothing else: "Angle (deg)" is a name."""
    return bool(_unit(cell)) and _unit(cell) == cell.strip("[]() ")


def _unit(cell: str) -> str:
    """The unit that a cell names, alone or in brackets; "" for none."""
    inside = _IN_BRACKETS.search(cell)
    for text in (cell.strip("[]() "), inside[1] if inside else ""):
        # "counts" needs a number of counts per turn to be converted, none to be one.
        try:
            parse_unit(text, "", 1.0)
        except InputError:
            continue
        return text
    return ""
