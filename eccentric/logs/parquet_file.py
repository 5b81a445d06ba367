"""Parquet logs, by pyarrow."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.errors import InputError, few
from eccentric.logs.assemble import Column, Read, column_of

_PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}


def read_parquet(path: Path) -> Read:
    """Read a Parquet table: numbers, texts, and stamps and durations in seconds (from 1970, UTC)."""
    try:
        parquet = importlib.import_module("pyarrow.parquet")
        arrow = importlib.import_module("pyarrow")
    except ImportError:
        raise InputError(
            f'{path}: pyarrow is required for .parquet: pip install "eccentric[parquet]"'
        ) from None
    try:
        # Not `read_table`, which takes folders named like run=3 above the file for columns.
        with parquet.ParquetFile(path) as file:
            table = file.read()
    except (arrow.ArrowException, OSError) as error:
        if isinstance(error, PermissionError):
            raise
        raise InputError(f"{path}: no Parquet file ({str(error).splitlines()[0]})") from None
    names: list[str] = table.column_names
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{path}: column names must differ, {twice!r} comes {names.count(twice)} times")
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
        # Through integers: NumPy's stamps have no NaN.
        return _floats(chunks.cast(arrow.int64()), arrow) / _PER_SECOND[kind.unit]
    if kinds.is_boolean(kind) or kinds.is_integer(kind) or kinds.is_floating(kind) or kinds.is_decimal(kind):
        return _floats(chunks, arrow)
    if kinds.is_string(kind) or kinds.is_large_string(kind) or kinds.is_null(kind):
        return column_of(chunks.to_pylist())
    return None


def _floats(chunks: Any, arrow: Any) -> Column:
    # Unchecked: an integer beyond 2^53 loses digits, as it does in every other format.
    return np.asarray(chunks.cast(arrow.float64(), safe=False).to_numpy(), dtype=float)
