"""Cells of a text log that are no plain numbers: decimal commas, dates, times of day, counters, units."""

from __future__ import annotations

import functools
import itertools
import math
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.logs import limits
from eccentric.logs.assemble import EITHER, MISSING, Column, column_of, number_of
from eccentric.logs.units import parse_unit

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
_DATE = re.compile(r"\s*\d{4}(-?)\d\d\1\d\d[T ]\d\d:?\d\d")
_UNIT = re.compile(r"[\[(]?\s*[A-Za-zµμΩ°%/^·* \d.²³-]{0,12}\s*[\])]?")
TIME_OF_DAY = re.compile(
    r"\s*(?:(?:\d{1,4}[-./]\d{1,2}[-./]\d{1,4}|[A-Za-z]{3,9},?)[T ,]+)*"
    r"(?P<hour>[01]?\d|2[0-3]):(?P<minute>[0-5]\d)(?::(?P<second>[0-5]\d)(?P<fraction>[.,:;]\d+)?)?"
    r"\s*(?:(?P<half>[AaPp])[Mm])?\s*"
)
_FORTRAN = re.compile(r"(?<=[\d.])[dD](?=[-+]\d{2,3}(?!\d))")
_SPELLED = {
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "hr": "h", "C": "degC",
    "volt": "V", "volts": "V", "ampere": "A", "amperes": "A", "amp": "A", "amps": "A",
}  # fmt: skip
_HEX = re.compile(r"\s*0[xX][0-9A-Fa-f]{1,8}\s*")
_THOUSANDS = re.compile(r"(?<=\d)[\u00a0\u2009\u202f](?=\d{3}(?!\d))")
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


def plainly(text: str) -> str:
    """A text whose numbers have no exponents of Fortran (1.2D+02), minus signs or blanks in thousands."""
    if any(sign in text for sign in ("D+", "D-", "d+", "d-")):
        text = _FORTRAN.sub("e", text)
    if "\u2212" in text:
        text = text.replace("\u2212", "-")
    return _THOUSANDS.sub("", text) if not text.isascii() else text


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
        unit := as_unit(units.pop())
    ):
        found = [_WITH_UNIT.fullmatch(cell) for cell in cells]
        return column_of([one[1] if one else "" for one in found]), unit, ""
    if given and all(map(_HEX.fullmatch, given)):
        return (
            column_of([int(cell, 16) if _HEX.fullmatch(cell) else cell for cell in cells]),
            "",
            f"{name}: hexadecimal, unsigned",
        )
    if given and all(map(_DATE.match, given)):
        return _dates(name, cells, column)
    if given and all(map(TIME_OF_DAY.fullmatch, given)):
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


@functools.lru_cache(maxsize=256)
def as_unit(text: str) -> str:
    """A unit as cells, scopes and MATLAB's durations spell it; "" for none."""
    with suppress(InputError):
        return parse_unit(_SPELLED.get(text, _SPELLED.get(text.lower(), text)), "", 1.0).text
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
    found = [TIME_OF_DAY.fullmatch(cell) for cell in cells]
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


_LIST = re.compile(r"\s*(?:array)?[(\[]+\s*([^\[\]()]*?)[,\s]*[)\]]+\s*")


def lists_of(cells: Sequence[str]) -> NDArray[np.float64] | None:
    """Cells that each hold as many numbers in brackets, as arrays print, (n, numbers); None for others.

    One number in parentheses may be a negative one, as in accounts.
    """
    first = _LIST.fullmatch(cells[0]) if cells else None
    if first is None:
        return None
    found = [_LIST.fullmatch(cell) for cell in cells]
    if any(
        cell.lstrip()[0] == "(" and "," not in cell[-2:] and one and (is_number(one[1]) or _groups(one[1]))
        for cell, one in zip(cells, found, strict=True)
    ):
        return None
    rows = [re.split(r"\s*,\s*|\s+", one[1]) if one else [] for one in found]
    width = len(rows[0])
    if not all(len(row) == width and all(number_of(cell) is not None for cell in row) for row in rows):
        return None
    return np.array([[number_of(cell) for cell in row] for row in rows], dtype=float)


def is_number(cell: str) -> bool:
    """Whether a cell is a number, with a decimal point or comma."""
    found = number_of(cell)
    return (found is not None and found == found) or bool(cell.strip() and _DECIMAL_COMMA.fullmatch(cell))  # noqa: PLR0124 - NaN
