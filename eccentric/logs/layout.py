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
from dataclasses import dataclass, field

from eccentric.core import InputError
from eccentric.logs import limits
from eccentric.logs.assemble import number_of
from eccentric.logs.cells import as_unit, is_number

BLANKS = ""
"""The delimiter of values between blanks."""
_SEEN = ("\t", ";", ",", "|", BLANKS)
_NAMES = frozenset(
    {"name", "names", "channel", "channels", "channel name", "signal", "signal name", "trace_names"}
)
_UNITS = frozenset({"unit", "units", "unit name", "channel unit", "trace_units", "y_unit_label"})
_IN_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]+?)\s*[\])]")
_CLOCK = re.compile(r".*\d:\d\d(:\d\d)?([.,]\d+)?\s*([AaPp][Mm])?\s*Z?|\s*\d{4}-\d\d-\d\d.*")
_SETTING = re.compile(r"\s*[^\d\s,;=:][^,;=:]*[:=]\s*\S")
"""A line of settings, such as "Device: X"."""
_COMMENT = re.compile(r"#+|%+(?=\s(?!of\b|;))|//")
"""How a comment begins; "%time" is a name."""
_RULE = re.compile(r"[\s|+]*[-=_][-=_\s|+]*")
"""A line that is drawn below a header."""
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
    there is more than one; `notes` say which line was taken for the header. `every` is a time of which the
    lines above say no more than its start and step: its name, and both in seconds.
    """

    names: tuple[str, ...]
    delimiter: str
    before: int
    units: Mapping[str, str] = field(default_factory=dict)
    clocks: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()
    every: tuple[str, float, float] | None = None


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
        if not _RULE.fullmatch(line)
        and not (
            _COMMENT.match(line)
            and is_prose(line, at_blanks=delimiter == BLANKS and line.count(",") != width - 1)
        )
        for cells in _cells_above(uncommented(line), delimiter, width)
    ]
    above, every = _stated_time(above, rows)
    found = _beside_labels(above, width) or _labelled(above, width) or _header(above, rows)
    if found is None:
        others = [k for k, line in enumerate(lines[:first]) if is_content(line) and not _SETTING.match(line)]
        if others and any(not is_number(cell) for _, cells in above for cell in cells):
            return None
        # Lines of other numbers are rows that the logger did not write whole.
        return _numbered(path, lines, first, min((first, *others)), delimiter, rows)
    line, names, units, clocks = found
    below = line > 2 or (line > 1 and (clocks or is_content(lines[0])))
    notes = (f"the header is line {line}",) if below else ()
    return Layout(tuple(names), delimiter, first, units, clocks, notes, every)


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
    return bool(line.strip()) and not _COMMENT.match(line)


def uncommented(line: str) -> str:
    """A line without the sign that makes it a comment."""
    return _COMMENT.sub("", line, count=1).lstrip(" \t") if _COMMENT.match(line) else line


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
    if not all(_is_value(column, delimiter) for column in zip(*rows, strict=True)):
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


def _is_value(column: Sequence[str], delimiter: str) -> bool:
    """Whether the first cell of a column is no name: a number, a time, or a text that others show to be none.

    Such a text is the same in every row, or is a setting of a scope, below which the column is empty; a word
    between blanks may be anything.
    """
    first, last = column[0].strip(), column[-1].strip()
    same = (
        delimiter != BLANKS
        and len(column) >= limits.ROWS_OF_A_TABLE
        and (set(map(str.strip, column)) == {first} or not last)
    )
    return _may_be_number(first) or bool(_CLOCK.fullmatch(first)) or same


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


_Above = list[tuple[int, list[str]]]


def _stated_time(
    above: _Above, rows: Sequence[Sequence[str]]
) -> tuple[_Above, tuple[str, float, float] | None]:
    """The lines above, and the time that they state in place of a column: its name, start and step.

    LabVIEW has lines for both, and an empty column; Rigol two cells more in the header and below it, and
    counts the rows in its first column, if that is called X.
    """
    told = {cells[0]: cells[1:] for _, cells in above}
    steps = {cell for cell in told.get("Delta_X", []) if cell}
    if len(steps) == 1 and not any(row[0].strip() for row in rows):
        start = next((cell for cell in told.get("X0", []) if cell), "0")
        return above, _every("X_Value", start, steps.pop())
    for (line, names), (below, cells) in itertools.pairwise(above):
        at = len(names) - 1 - (not names[-1])
        if names[at - 1 : at + 1] != ["Start", "Increment"] or len(cells) <= at:
            continue
        stated = _every("X" if names[0] == "X" else "time", cells[at - 1], cells[at])
        if stated and not any("".join(row[at - 1 :]).strip() for row in rows):
            cut = {line: names[: at - 1], below: cells[: at - 1]}
            return [(k, cut.get(k, row)) for k, row in above], stated
    return above, None


def _every(name: str, start: str, step: str) -> tuple[str, float, float] | None:
    """A time by its start and step; None where these are no numbers, or the step is none."""
    first, every = (number_of(cell.replace(",", ".")) for cell in (start, step))
    return (name, first, every) if first is not None and every and math.isfinite(first + every) else None


_Found = tuple[int, list[str], dict[str, str], tuple[int, ...]]


def _beside_labels(above: Sequence[tuple[int, list[str]]], width: int) -> _Found | None:
    """A header whose line, as that of its units, has a label before its cells; None without one.

    LabVIEW labels the units alone, and its header ends with a column of comments that rows leave out.
    """
    found: tuple[int, list[str], list[str]] | None = None
    units: list[str] = []
    for line, (label, *cells) in above:
        if label.lower() in _NAMES and len(cells) == width:
            found = line, cells, cells
        elif label == "X_Value" and len(cells) >= width - 1:
            found = line, [label, *cells[: width - 1]], cells
        elif label.lower() in _UNITS:
            units = cells
    if found is None:
        return None
    line, names, of_units = found
    told = {name: unit for name, cell in zip(of_units, units, strict=False) if (unit := _unit(cell))}
    return line, names, told, ()


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
        if k == above[0][0] and full is not None and full[1:] == [str(n) for n in range(1, width)]:
            full = [full[0], *(f"channel {n}" for n in full[1:])]
        if full is None or any(map(is_number, full)) or not any(full):
            break
        block.insert(0, (k, full))
    if not block:
        return None
    # A row of units names a column more than once, or half of its cells are units, as of "ms;Grad;U/min;A".
    once = [place for place, (_, cells) in enumerate(block) if not _repeats(cells)]
    place = once[-1] if once else 0
    if place and 2 * _units_in(block[place][1]) >= width > 2 * _units_in(block[place - 1][1]):
        place -= 1
    line, cells = block[place]
    # A delimiter at the end of every row makes no column.
    ends = next((k for k in range(width, 0, -1) if cells[k - 1] or not empty[k - 1]), 0)
    names = [cell or f"column {k + 1}" for k, cell in enumerate(cells[:ends])]
    units: dict[str, str] = {}
    for _, below in block[place + 1 :]:
        # Beside units some loggers say there what a column is: "Analog 1" of "Servo motor speed".
        units |= {
            name: unit
            for name, cell in zip(names, below, strict=False)
            if (unit := _unit(cell) or cell.strip("[]() "))
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


def _units_in(cells: Sequence[str]) -> int:
    """How many cells are units, or say that there is none."""
    return sum(_is_unit(cell) or cell in ("", "-") for cell in cells)


def _is_unit(cell: str) -> bool:
    """Whether a cell is a unit and nothing else: "Angle (deg)" is a name."""
    return bool(as_unit(cell.strip("[]() ")))


def _unit(cell: str) -> str:
    """The unit that a cell names, alone or in brackets; "" for none."""
    inside = _IN_BRACKETS.search(cell)
    # "counts" needs a number of counts per turn to be converted, none to be one.
    return as_unit(cell.strip("[]() ")) or as_unit(inside[1] if inside else "")
