"""Tables of results: for a terminal, a notebook, and any other library."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from eccentric.identification import Estimate, correlation
from eccentric.logs import Log
from eccentric.presentation import aligned


@dataclass(frozen=True)
class ResultTable:
    """A small table of results.

    `table["value"]` is a column, `table[0]` a row, `table[:3]` a table of the first three; iterating gives
    the rows as dictionaries, so that `list(table)` is plain data, and `pandas.DataFrame(table)` a data frame.
    A numeric column has NaN where there is no number.

    Attributes:
        names: of the columns.
        rows: their values, one tuple for each row.
    """

    names: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]

    def __post_init__(self) -> None:
        numeric = [self._is_number(k) for k in range(len(self.names))]
        rows = (
            tuple(math.nan if x is None and n else x for x, n in zip(row, numeric, strict=True))
            for row in self.rows
        )
        object.__setattr__(self, "rows", tuple(rows))

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


class LabelledMatrix(dict[str, dict[str, float]]):
    """A square matrix with the names of its rows and columns, such as the covariance of estimates.

    `matrix["B_m", "C_m"]` is one number, `matrix["B_m"]` a row by name, and `pandas.DataFrame(matrix)` a data
    frame with the names on both axes.

    Attributes:
        names: of the estimates, in the order of both axes.
        matrix: (n, n).
    """

    format = ".3g"

    def __init__(self, names: Sequence[str], matrix: NDArray[np.float64]) -> None:
        self.names, self.matrix = tuple(names), np.asarray(matrix, float).reshape(len(names), len(names))
        super().__init__(
            {name: dict(zip(self.names, row.tolist(), strict=True)) for name, row in self._rows()}
        )

    @overload
    def __getitem__(self, name: str, /) -> dict[str, float]: ...
    @overload
    def __getitem__(self, name: tuple[str, str], /) -> float: ...
    def __getitem__(self, name: str | tuple[str, str], /) -> dict[str, float] | float:
        for one in (name,) if isinstance(name, str) else name:
            if one not in self.names:
                raise KeyError(f"{one!r}; the estimates are {', '.join(self.names)}")
        return super().__getitem__(name) if isinstance(name, str) else super().__getitem__(name[0])[name[1]]

    def table(self) -> ResultTable:
        """The matrix, a row and a column for each estimate."""
        return ResultTable(("", *self.names), tuple((name, *row.tolist()) for name, row in self._rows()))

    def _rows(self) -> Iterator[tuple[str, NDArray[np.float64]]]:
        return zip(self.names, self.matrix, strict=True)

    def __str__(self) -> str:
        return _text(("", *self.names), self._cells(), [False, *(True for _ in self.names)])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return _html(("", *self.names), self._cells())

    def _cells(self) -> list[tuple[str, ...]]:
        rows = self._rows()
        return [(name, *("-" if math.isnan(x) else f"{x:{self.format}}" for x in row)) for name, row in rows]

    def __reduce__(self) -> tuple[type, tuple[tuple[str, ...], NDArray[np.float64]]]:
        return type(self), (self.names, self.matrix)


class Correlation(LabelledMatrix):
    """Correlation of the errors of estimates: `correlation["B_m", "C_m"]`, from -1 to 1.

    NaN where an estimate has no variance: it is at a bound, or the log does not determine it.
    """

    format = ".2f"

    @classmethod
    def of(cls, names: Sequence[str], covariance: NDArray[np.float64]) -> Correlation:
        """The correlation of estimates with this covariance (n, n)."""
        return cls(names, correlation(covariance))


def estimate_table(estimates: Mapping[str, Estimate]) -> ResultTable:
    """Estimates by name: value, standard error, 95 % interval, unit, active bound; "" for none."""
    names = ("name", "value", "std_error", "lower", "upper", "unit", "bound")
    rows = (
        (name, e.value, e.std_error, *e.interval, e.unit, e.bound_active or "")
        for name, e in estimates.items()
    )
    return ResultTable(names, tuple(rows))


def with_unit(column: str, unit: str) -> str:
    """The name of a column with its unit in brackets, unless it ends with that already."""
    return column if not unit or column.endswith((f"[{unit}]", f"({unit})")) else f"{column} [{unit}]"


def ranges_of(log: Log) -> ResultTable:
    """The columns of a log, each with its lowest and highest value."""
    columns = ((name, log.numbers(name)) for name in log.columns)
    return ResultTable(
        ("column", "lowest", "highest"),
        tuple((name, float(values.min()), float(values.max())) for name, values in columns),
    )


def _text(names: Sequence[str], rows: Sequence[Sequence[str]], right: Sequence[bool]) -> str:
    """The table for a terminal with aligned columns; those in `right` are right-aligned."""
    left = [k for k, r in enumerate(right) if not r]
    return "\n".join(aligned([names, *rows], left))


def _html(names: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """The table in HTML; names and cells are escaped here."""
    head = "".join(f"<th>{escape(name)}</th>" for name in names)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(value: object) -> str:
    if value is None or value == "" or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, float):
        return f"{value:.4g}"
    return str(value)
