"""Tables of results: for a terminal, a notebook, and any other library."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from eccentric.estimation import correlation
from eccentric.logs import Log

__all__ = ["Correlation", "ResultTable", "ranges_of"]


@dataclass(frozen=True)
class ResultTable:
    """A small table of results.

    `table["value"]` is a column, `table[0]` a row, `table[:3]` a table of the first three; iterating gives
    the rows as dictionaries, so that `list(table)` is plain data, and `pandas.DataFrame(list(table))` a data
    frame. None means unknown.

    Attributes:
        names: of the columns.
        rows: their values, one tuple for each row.
    """

    names: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return (dict(zip(self.names, row, strict=True)) for row in self.rows)

    @overload
    def __getitem__(self, name: str) -> list[Any]: ...
    @overload
    def __getitem__(self, name: int) -> dict[str, Any]: ...
    @overload
    def __getitem__(self, name: slice) -> ResultTable: ...
    def __getitem__(self, name: str | int | slice) -> list[Any] | dict[str, Any] | ResultTable:
        if isinstance(name, slice):
            return ResultTable(self.names, self.rows[name])
        if isinstance(name, int):
            return dict(zip(self.names, self.rows[name], strict=True))
        if name not in self.names:
            raise KeyError(f"{name!r}; the columns are {', '.join(self.names)}")
        place = self.names.index(name)
        return [row[place] for row in self.rows]

    def __str__(self) -> str:
        return _text(self.names, self._cells(), [self._is_number(k) for k in range(len(self.names))])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return _html(self.names, self._cells())

    def _cells(self) -> list[tuple[str, ...]]:
        return [tuple(map(_cell, row)) for row in self.rows]

    def _is_number(self, column: int) -> bool:
        return all(row[column] is None or isinstance(row[column], int | float) for row in self.rows)


@dataclass(frozen=True, eq=False)
class Correlation:
    """Correlation of the errors of estimates: `correlation["B_m", "C_m"]`, from -1 to 1.

    NaN if an estimate has no standard error: it is at a bound, or the log says nothing about it.

    Attributes:
        names: of the estimates, in the order of both axes.
        matrix: (n, n).
    """

    names: tuple[str, ...]
    matrix: NDArray[np.float64]

    @classmethod
    def of(cls, names: Sequence[str], covariance: NDArray[np.float64]) -> Correlation:
        """The correlation of estimates with this covariance (n, n)."""
        return cls(tuple(names), correlation(covariance))

    def __getitem__(self, pair: tuple[str, str]) -> float:
        for name in pair:
            if name not in self.names:
                raise KeyError(f"{name!r}; the estimates are {', '.join(self.names)}")
        row, column = (self.names.index(name) for name in pair)
        return float(self.matrix[row, column])

    def table(self) -> ResultTable:
        """The matrix, a row and a column for each estimate."""
        rows = (
            (name, *(None if math.isnan(x) else float(x) for x in row))
            for name, row in zip(self.names, self.matrix, strict=True)
        )
        return ResultTable(("", *self.names), tuple(rows))

    def __str__(self) -> str:
        return _text(("", *self.names), self._cells(), [False, *(True for _ in self.names)])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return _html(("", *self.names), self._cells())

    def _cells(self) -> list[tuple[str, ...]]:
        rows = zip(self.names, self.matrix, strict=True)
        return [(name, *("-" if math.isnan(x) else f"{x:.2f}" for x in row)) for name, row in rows]


def ranges_of(log: Log) -> ResultTable:
    """The columns of a log, each with its lowest and highest value."""
    columns = ((name, log.numbers(name)) for name in log.columns)
    return ResultTable(
        ("column", "lowest", "highest"),
        tuple((name, float(values.min()), float(values.max())) for name, values in columns),
    )


def _text(names: Sequence[str], rows: Sequence[Sequence[str]], right: Sequence[bool]) -> str:
    """The table for a terminal with aligned columns; those in `right` are right-aligned."""
    widths = [max(map(len, column)) for column in zip(names, *rows, strict=True)]
    lines = (
        "  ".join(x.rjust(w) if r else x.ljust(w) for x, w, r in zip(row, widths, right, strict=True))
        for row in (names, *rows)
    )
    return "\n".join(line.rstrip() for line in lines)


def _html(names: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """The table in HTML; names and cells are escaped here."""
    head = "".join(f"<th>{escape(name)}</th>" for name in names)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(value: object) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, float):
        return f"{value:.4g}"
    return str(value)
