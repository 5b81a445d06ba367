"""Cells of a text log that are no plain numbers: decimal commas, dates, times of day, counters, units."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Sequence
from contextlib import suppress
from datetime import UTC, datetime

import numpy as np

from eccentric.core import InputError
from eccentric.logs import limits
from eccentric.logs.assemble import MISSING, Column, column_of, number_of
from eccentric.logs.units import parse_unit

_THOUSANDS = re.compile(r"\s*[-+]?[1-9]\d{0,2}(?:,\d{3})+(?P<rest>\.\d*)?\s*")
_POINTS = re.compile(r"\s*[-+]?[1-9]\d{0,2}(?:\.\d{3})+(?P<rest>,\d*)?\s*")
"""Numbers with a comma, or a point, between groups of three digits."""
_WITH_UNIT = re.compile(
    r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([A-Za-z°µμΩ%][\w°µμΩ%/^·* ]*?)\s*"
)
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


def cells_to_column(
    name: str, cells: Sequence[str], *, decimal_comma: bool, points: bool = False
) -> tuple[Column, str, str]:
    """Return a column of text as numbers where it can be, its unit if the cells say it, and a note.

    Args:
        decimal_comma: whether a comma does not separate the cells.
        points: whether the decimal sign of the table is a comma, so that a point separates thousands.
    """
    given = _given(cells)
    if (of := _separator(given, points=points)) is not None:
        clean = [c.replace(of, "").replace(",", ".") for c in cells]
        return column_of(clean), "", f"{name}: {of!r} separates thousands"
    column = plain_column(cells, decimal_comma=decimal_comma)
    if column.dtype.kind == "f":
        return _counter(name, cells, column)
    if len(units := {one[2] if (one := _WITH_UNIT.fullmatch(c)) else "" for c in given}) == 1 and (
        unit := _as_unit(units.pop())
    ):
        found = [_WITH_UNIT.fullmatch(cell) for cell in cells]
        return column_of([one[1] if one else "" for one in found]), unit, ""
    if given and all(map(_DATE.match, given)):
        return _dates(name, cells, column)
    if given and all(map(_CLOCK.fullmatch, given)):
        return _times_of_day(name, cells)
    return column, "", ""


def plain_column(cells: Sequence[str], *, decimal_comma: bool, points: bool = False) -> Column:
    """Return cells as numbers, with decimal commas where most are such, or as text.

    Where a comma separates the cells, those in quotation marks can have one: a decimal comma, unless all of
    them may be thousands. `points` as for `cells_to_column`.
    """
    if points and _separator(_given(cells), points=True) == ".":
        return column_of([cell.replace(".", "").replace(",", ".") for cell in cells])
    column = column_of(cells)
    if column.dtype.kind == "f":
        return column
    given = _given(cells)
    if not decimal_comma and all(_THOUSANDS.fullmatch(c) for c in given if "," in c):
        return column
    # A cell that is no number stays as it is: whoever asks for numbers is told its line.
    if given and 2 * sum(map(bool, map(_COMMA.fullmatch, given))) > len(given):
        return column_of([c.replace(",", ".") if _COMMA.fullmatch(c) else c for c in cells])
    return column


def has_decimal_commas(cells: Sequence[str]) -> bool:
    """Whether most cells of a column are numbers with a decimal comma."""
    given = _given(cells)
    commas = [cell for cell in given if "," in cell and _COMMA.fullmatch(cell)]
    return 2 * len(commas) > len(given) and not all(map(_THOUSANDS.fullmatch, commas))


def _separator(given: Sequence[str], *, points: bool) -> str | None:
    """What separates the thousands of numbers: a comma or a point, and None where it may be decimal."""
    for of, form in ((",", _THOUSANDS), (".", _POINTS)):
        grouped = [cell for cell in given if of in cell]
        found = [form.fullmatch(cell) for cell in grouped]
        # What has no separator is a number below 1000, with the other sign as the decimal one.
        rest = [cell.replace(",", ".") if of == "." else cell for cell in given if of not in cell]
        numbers = [number_of(cell) for cell in rest]
        if not grouped or not all(found) or None in numbers:
            continue
        twice = any(
            cell.count(of) > 1 or (one and one["rest"]) for cell, one in zip(grouped, found, strict=True)
        )
        small = [abs(x) < 1000.0 for x in numbers if x is not None]
        if twice or (of == "." and points) or (of == "," and not points and small and all(small)):
            return of
    return None


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
