"""Arrow tables, from a Parquet file or from memory, as columns of numbers and text."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from eccentric.errors import InputError, few
from eccentric.logs.assemble import Column, Read, column_of

__all__ = ["arrow_columns"]

_PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}


def arrow_columns(table: Any, where: str) -> Read:
    """Return the columns of a pyarrow Table: numbers, text, dates and durations in seconds (from 1970, UTC).

    Other columns are left out with a note. Raises InputError, which begins with `where`, for a repeated
    column name.
    """
    arrow = importlib.import_module("pyarrow")
    names: list[str] = table.column_names
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(
            f"{where}: unique column names are required, received {twice!r} {names.count(twice)}x"
        )
    columns: dict[str, Column] = {}
    left_out: list[str] = []
    for name in names:
        column = _column(table[name], arrow)
        if column is None:
            left_out.append(f"{name} ({table[name].type})")
        else:
            columns[name] = column
    notes = [f"left out, since they are neither numbers nor text: {few(left_out)}"] if left_out else []
    return Read(columns, notes=tuple(notes))


def _column(chunks: Any, arrow: Any) -> Column | None:
    kinds = arrow.types
    if kinds.is_dictionary(chunks.type):
        chunks = chunks.cast(chunks.type.value_type)
    kind = chunks.type
    if kinds.is_timestamp(kind) or kinds.is_duration(kind):
        # Through integers: NumPy's time stamps have no NaN.
        return _floats(chunks.cast(arrow.int64()), arrow) / _PER_SECOND[kind.unit]
    if kinds.is_boolean(kind) or kinds.is_integer(kind) or kinds.is_floating(kind) or kinds.is_decimal(kind):
        return _floats(chunks, arrow)
    texts = (kinds.is_string, kinds.is_large_string, kinds.is_string_view, kinds.is_null)
    if any(is_text(kind) for is_text in texts):
        return column_of(chunks.to_pylist())
    return None


def _floats(chunks: Any, arrow: Any) -> Column:
    # Unchecked: an integer beyond 2^53 loses digits, as it does in every other format.
    return np.asarray(chunks.cast(arrow.float64(), safe=False).to_numpy(), dtype=float)
