"""Logs that are tables in memory: arrays by name, or any table that supports Arrow or has named columns.

pandas, polars, pyarrow and others export their columns through the Arrow PyCapsule interface or the
dataframe interchange protocol; pyarrow reads both, if installed. Without it, a table with access to its
columns by name, such as those of pandas and polars, is read column by column.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np

from eccentric.core import InputError, few
from eccentric.logs.assemble import Column, Read, column_of
from eccentric.logs.parquet_file import arrow_columns


@runtime_checkable
class ArrowStream(Protocol):
    """A table of the Arrow PyCapsule interface: pyarrow, polars, pandas from 2.2 on, DuckDB."""

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Export the table as a stream of record batches."""
        ...


@runtime_checkable
class Interchange(Protocol):
    """A table of the dataframe interchange protocol."""

    def __dataframe__(self, nan_as_null: bool = False, allow_copy: bool = True) -> Any:
        """Export the table as an interchange dataframe."""
        ...


TableLike: TypeAlias = Mapping[str, Any] | np.ndarray | ArrowStream | Interchange
"""Columns by name, all of one length: a mapping of arrays, a structured array, a table of another library."""


def read_memory(table: object, name: str) -> Read:
    """Return the columns of a table in memory: float64 with NaN for a missing value, or str.

    Dates and durations become seconds, as in a Parquet file. A single number or text is repeated in every
    row. Columns that are neither numbers nor text are left out with a note.

    Raises InputError, which begins with `name`, for anything but a table, and for columns of different
    lengths or of more than one dimension.
    """
    if isinstance(table, Mapping):
        return _by_name(table, name)
    if isinstance(table, np.ndarray) and table.dtype.names:
        return _by_name({field: table[field] for field in table.dtype.names}, name)
    exports = isinstance(table, ArrowStream | Interchange)
    read = _by_arrow(table, name) if exports else None
    if read is not None:
        return read
    if (named := _named(table)) is not None:
        return _by_name(named, name)
    kind = type(table).__name__
    if exports:
        raise InputError(
            f'{name}: pyarrow is required for a table of type {kind}: pip install "eccentric[parquet]"'
        )
    if isinstance(table, list | tuple) and table:
        kind += f" of {type(table[0]).__name__}"
    raise InputError(
        name, "a path or a table", kind, why="(a dict of arrays, or a table of pandas, polars or pyarrow)"
    )


def _by_arrow(table: ArrowStream | Interchange, name: str) -> Read | None:
    """The columns as pyarrow reads them; None if it is not installed, or cannot read them."""
    try:
        arrow = importlib.import_module("pyarrow")
        interchange = importlib.import_module("pyarrow.interchange")
    except ImportError:
        return None
    try:
        read = arrow.table if isinstance(table, ArrowStream) else interchange.from_dataframe
        return arrow_columns(read(table), name)
    except (arrow.ArrowException, TypeError, ImportError):
        # A column of Python objects, as pandas has them: the message appears only if the column is used.
        return None


def _named(table: Any) -> dict[Any, Any] | None:
    """The columns of a table that offers them by name, None for anything else."""
    try:
        return {column: table[column] for column in table.columns}
    except (AttributeError, TypeError, KeyError):
        return None


def _by_name(table: Mapping[Any, Any], name: str) -> Read:
    read = {column: _values(values, column, name) for column, values in table.items()}
    found = {column: values for column, values in read.items() if values is not None}
    lengths = {column: len(values) for column, values in found.items() if values.ndim}
    if found and not lengths:
        raise InputError(name, "columns", "single values", why=", each an array of numbers")
    first = next(iter(lengths), "")
    for column, length in lengths.items():
        if length != lengths[first]:
            raise InputError(f"{name}: column {column!r}", f"{lengths[first]} rows, as in {first!r}", length)
    full = {c: values if values.ndim else np.full(lengths[first], values) for c, values in found.items()}
    others = [column for column in read if column not in found]
    notes = [f"left out, since they are neither numbers nor text: {few(others)}"] if others else []
    return Read(full, notes=tuple(notes))


def _values(values: object, column: object, name: str) -> Column | None:
    """One column (n,) as float64 or str, or a single value (); None for other types."""
    if not isinstance(column, str):
        raise InputError(name, "column names of type str", f"{column!r}")
    where = f"{name}: column {column!r}"
    try:
        array = np.ma.asarray(values) if isinstance(values, np.ma.MaskedArray) else np.asarray(values)
    except (ValueError, TypeError, RuntimeError) as error:
        said = str(error).split(". ")[0]
        raise InputError(f"{where}: expected an array of numbers (n,) ({said})") from None
    if array.ndim > 1:
        raise InputError(where, "one dimension", f"shape {array.shape}")
    kind = array.dtype.kind
    if kind in "biuf":
        return np.ma.filled(array.astype(float), np.nan)
    if kind in "mM":
        return _seconds(array)
    if kind not in "OUT":
        return None
    entries = [None if _is_missing(entry) else entry for entry in np.atleast_1d(array).tolist()]
    if not all(entry is None or isinstance(entry, str) or hasattr(entry, "__float__") for entry in entries):
        return None
    return column_of(entries).reshape(array.shape)


def _seconds(array: np.ndarray) -> Column:
    """Dates [s from 1970] or durations [s]; NaN for none."""
    exact = array.astype(f"{'datetime64' if array.dtype.kind == 'M' else 'timedelta64'}[ns]")
    return np.where(np.isnat(exact), np.nan, exact.astype(np.int64) / 1e9)


def _is_missing(entry: object) -> bool:
    """Whether an entry is None or one of pandas' marks for a missing value; works without pandas."""
    return entry is None or type(entry).__name__ in {"NAType", "NaTType"}
