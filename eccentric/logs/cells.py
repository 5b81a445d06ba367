"""Cells of a text log that are no plain numbers: decimal commas, dates, times of day, counters, units."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np

from eccentric.logs import limits
from eccentric.logs.assemble import MISSING, Column, column_of, number_of

POINT = "; expected a decimal point, as in 1.5"
_COMMA = re.compile(r"\s*[-+]?(?:\d+(?:,\d*)?|,\d+)(?:[eE][-+]?\d+)?\s*")
_DATE = re.compile(r"\s*\d{4}-\d\d-\d\d[T ]\d\d:\d\d")
_UNIT = re.compile(r"[\[(]?\s*[A-Za-zµμΩ°%/^·* \d.²³-]{0,12}\s*[\])]?")
_CLOCK = re.compile(
    r"\s*(?:(?:\d{1,4}[-./]\d{1,2}[-./]\d{1,4}|[A-Za-z]{3,9},?)[T ,]+)*"
    r"(?P<hour>[01]?\d|2[0-3]):(?P<minute>[0-5]\d)(?::(?P<second>[0-5]\d)(?P<fraction>[.,:]\d+)?)?"
    r"\s*(?:(?P<half>[AaPp])[Mm])?\s*"
)
EXACT = 2**53
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
    if given and all(map(_CLOCK.fullmatch, given)):
        return _times_of_day(name, cells)
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
    found = [_CLOCK.fullmatch(cell) for cell in cells]
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
    return (found is not None and found == found) or bool(cell.strip() and _COMMA.fullmatch(cell))  # noqa: PLR0124 - NaN
