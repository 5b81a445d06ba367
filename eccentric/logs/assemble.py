"""What readers return, whole or in parts; the content of a file as columns of one length.

Formats that hold variables of any shape instead of one table share the latter.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import few
from eccentric.logs import limits

Column = NDArray[Any]

MISSING = frozenset({"", "na", "n/a", "#n/a", "null", "none", "-"})
EITHER = " or "
"""Between the two numbers that a text may be."""


@dataclass(frozen=True)
class Read:
    """What a reader returns: columns, the line of each row in a text file, what was left out and why.

    `units` are those that the file itself states, by column, as they stand there; `read_as` says how the file
    was understood, where that is not to be seen from its columns and nothing was left out.
    """

    columns: Mapping[str, Column]
    lines: NDArray[np.int64] | None = None
    notes: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    read_as: tuple[str, ...] = ()


@dataclass(frozen=True)
class Part:
    """Rows of a file that follow each other: the number of the first, counted from 0, columns, and lines."""

    first: int
    columns: Mapping[str, Column]
    lines: NDArray[np.int64] | None = None


@dataclass(frozen=True)
class InParts:
    """A file that is read in parts.

    names: its columns; rows: how many there are, at most; parts: of these columns and of these spans
    [first, end) of rows, sorted and disjoint; notes: what is left out, and why.
    """

    names: tuple[str, ...]
    rows: int
    parts: Callable[[Sequence[str], Sequence[tuple[int, int]]], Iterator[Part]]
    notes: tuple[str, ...] = ()


def overlaps(first: int, end: int, spans: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """The parts of the rows [first, end) that are in the spans."""
    cut = ((max(first, a), min(end, b)) for a, b in spans)
    return [(a, b) for a, b in cut if a < b]


class LeftOut(str):
    """The reason why a variable has no columns, in place of them."""

    __slots__ = ()


def number_of(text: str) -> float | None:
    """Return the number in a text, NaN if the text marks a missing value, None for any other text."""
    try:
        return float(text)
    except ValueError:
        return float("nan") if text.strip().lower() in MISSING else None


def column_of(values: Sequence[Any]) -> Column:
    """Return text, numbers, booleans and None as float64 (n,) if all are numbers, else as str (n,)."""
    try:
        return np.array(list(map(float, values)))
    except (ValueError, TypeError, OverflowError):
        numbers = [_scalar(value) for value in values]
    if None in numbers:
        return np.array(["" if value is None else str(value) for value in values], dtype=str)
    return np.array(numbers, dtype=float)


def assemble(content: Mapping[str, Any]) -> Read:
    """Return the columns of nested variables: mappings, sequences, arrays, numbers, text, `LeftOut`.

    A variable is called by the last part of its name if that is unique, else by its full name, as in
    `out.signals(2).values`. The number of rows is the commonest length among the vectors (of equally common
    ones, the largest); others are left out with a note. A single number or text is repeated in every row.
    """
    found = dict(_flat(content, "", 0))
    vectors = {name: value for name, value in found.items() if isinstance(value, np.ndarray)}
    lengths = Counter(len(vector) for vector in vectors.values())
    rows = max(lengths, key=lambda n: (n >= limits.SHORTEST_VECTOR, lengths[n], n), default=0)
    endings = Counter(map(_last, found))
    columns: dict[str, Column] = {}
    others: list[str] = []
    notes: dict[str, list[str]] = {}
    for full, value in found.items():
        name = _last(full) if endings[_last(full)] == 1 else full
        if isinstance(value, LeftOut):
            notes.setdefault(str(value), []).append(name)
        elif not isinstance(value, np.ndarray):
            columns[name] = np.full(rows, value)
        elif len(value) == rows:
            columns[name] = value
        else:
            others.append(f"{name} ({len(value)})")
    said = [f"left out, {reason}: {few(names, 5)}" for reason, names in notes.items()]
    if others:
        said.append(f"left out, since most variables have {rows} rows: {few(others, 5)}")
    return Read(columns if rows else {}, notes=tuple(said))


def _scalar(value: Any) -> float | None:
    if value is None:
        return float("nan")
    if isinstance(value, str):
        return number_of(value)
    try:
        return float(value)
    except OverflowError:  # an integer of hundreds of digits
        return float("inf")


def _is_scalar(value: Any) -> bool:
    return value is None or isinstance(value, str | bool | int | float | np.integer | np.floating | np.bool_)


def _flat(value: Any, name: str, depth: int) -> Iterator[tuple[str, Any]]:
    """Yield full names with a column, a number, a text or a `LeftOut`."""
    if isinstance(value, dict) and depth < limits.DEEPEST_STRUCTURE:
        for key, inner in value.items():
            yield from _flat(inner, f"{name}.{key}" if name else str(key), depth + 1)
    elif isinstance(value, LeftOut | str):
        yield name, value
    elif _is_scalar(value):
        if value is not None:
            yield name, _scalar(value)
    elif isinstance(value, np.ndarray) and value.dtype.kind in "biufU" and value.ndim in (1, 2):
        yield from _of_array(value, name)
    elif isinstance(value, list) or (isinstance(value, np.ndarray) and value.ndim):
        items = list(value)
        if items and all(isinstance(item, dict) for item in items):
            yield from _of_records(items, name, depth)
        elif items and all(map(_is_scalar, items)):
            yield name, column_of(items)
        elif items:
            yield name, LeftOut("since it is neither numbers nor text")
    else:
        yield name, LeftOut("since it is neither numbers nor text")


def _of_array(value: Column, name: str) -> Iterator[tuple[str, Any]]:
    """Name the columns of a matrix as MATLAB does; time runs along the longer side."""
    if value.ndim == 1:
        yield name, value if value.dtype.kind == "f" else column_of(value.tolist())
        return
    parts, pattern = (value.T, "{}(:,{})") if len(value) >= len(value.T) else (value, "{}({},:)")
    if len(parts) > limits.MOST_PARTS:
        yield name, LeftOut(f"since it has more than {limits.MOST_PARTS} columns")
        return
    for k, part in enumerate(parts, start=1):
        yield from _of_array(part, pattern.format(name, k))


def _of_records(items: Sequence[Mapping[str, Any]], name: str, depth: int) -> Iterator[tuple[str, Any]]:
    """Yield a column for each key of the records, or one for each record if they hold more than scalars."""
    if (signals := _named_signals(items)) is not None:
        yield from signals.items()
        return
    for key in dict.fromkeys(key for item in items for key in item):
        values = [item.get(key) for item in items]
        full = f"{name}.{key}" if name else key
        nested = [value for value in values if isinstance(value, dict)]
        if all(map(_is_scalar, values)):
            yield full, column_of(values)
        elif len(nested) == len(items) >= limits.SHORTEST_VECTOR and depth < limits.DEEPEST_STRUCTURE:
            yield from _of_records(nested, full, depth + 1)
        elif len(items) >= limits.SHORTEST_VECTOR and (matrix := _matrix(values)) is not None:
            yield from _of_array(matrix, full)
        elif len(items) > limits.MOST_PARTS:
            yield f"{name}.{key}", LeftOut("since it is neither numbers nor text")
        else:
            for k, inner in enumerate(values, start=1):
                yield from _flat(inner, f"{name}({k}).{key}", depth + 1)


def _matrix(rows: Sequence[Any]) -> Column | None:
    """A row of numbers for each record, of one length and shorter than there are records; None for others."""
    width = len(rows[0]) if isinstance(rows[0], list) else 0
    if not 0 < width <= len(rows) or not all(
        isinstance(row, list) and len(row) == width and all(map(_is_scalar, row)) for row in rows
    ):
        return None
    try:
        return np.array(rows, dtype=float)
    except (ValueError, TypeError):
        return None


def _named_signals(items: Sequence[Mapping[str, Any]]) -> dict[str, Column] | None:
    """Signals that hold their own name, as the Y of dSPACE and the scopes of Simulink; None for others.

    Records that each hold a few values are no signals: those are longer than there are of them.
    """
    for name, data, unit in (("Name", "Data", "Unit"), ("label", "values", "")):
        named = [str(item.get(name, "")).replace('"', "") for item in items]
        found = [item.get(data, 0.0) for item in items]
        values = [
            np.asarray(0.0 if isinstance(v, list) and not all(map(_is_scalar, v)) else v) for v in found
        ]
        if (
            all(named)
            and len(set(named)) == len(named)
            and all(v.ndim == 1 and v.dtype.kind in "biuf" and len(v) > len(items) for v in values)
        ):
            units = [str(item.get(unit, "")) if unit else "" for item in items]
            called = [f"{n} [{u}]" if u and "[" not in n else n for n, u in zip(named, units, strict=True)]
            return {n: v.astype(float) for n, v in zip(called, values, strict=True)}
    return None


def _last(name: str) -> str:
    return name.rsplit(".", 1)[-1]
