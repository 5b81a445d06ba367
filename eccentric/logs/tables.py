"""Tables with named columns: Parquet files, and tables in memory.

pandas, polars, pyarrow and others export their columns through the Arrow PyCapsule interface or the
dataframe interchange protocol; pyarrow reads both, if installed. Without it, a table with access to its
columns by name, such as those of pandas and polars, is read column by column.
"""

from __future__ import annotations

import importlib
import itertools
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol, TypeAlias, runtime_checkable

import numpy as np

from eccentric.core import InputError, few
from eccentric.logs import limits
from eccentric.logs.assemble import Column, InParts, Part, Read, column_of, overlaps
from eccentric.logs.foreign import errors_of, library, require_room_for_numbers

# Arrow tables, from a Parquet file or from memory, as columns of numbers and text.


_PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}


def arrow_columns(table: Any, where: str) -> Read:
    """Return the columns of a pyarrow Table: numbers, text, dates and durations in seconds (from 1970, UTC).

    Lists of numbers, each with as many places, are columns `name(:,1)` and so on.

    Other columns are left out with a note. Raises InputError, which begins with `where`, for a repeated
    column name.
    """
    arrow = importlib.import_module("pyarrow")
    names: list[str] = table.column_names
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(where, "unique column names", f"{twice!r} {names.count(twice)}x")
    columns: dict[str, Column] = {}
    left_out: list[str] = []
    for name in names:
        if (lists := _lists(table[name], arrow)) is not None:
            columns |= {f"{name}(:,{k})": column for k, column in enumerate(lists.T, start=1)}
            continue
        column = _column(table[name], arrow)
        if column is None:
            left_out.append(f"{name} ({table[name].type})")
        else:
            columns[name] = column
    notes = [f"left out, since they are neither numbers nor text: {few(left_out)}"] if left_out else []
    return Read(columns, notes=tuple(notes))


def _lists(chunks: Any, arrow: Any) -> Column | None:
    """Lists of numbers (n, places), if all have as many places; NaN where there is no list."""
    if not _is_list(chunks.type, arrow):
        return None
    places = {len(row) for row in chunks.to_pylist() if row is not None} if len(chunks) else set[int]()
    if len(places) != 1 or not 0 < (width := places.pop()) <= limits.MOST_PARTS:
        return None
    found = np.full((len(chunks), width), np.nan)
    there = ~np.asarray(chunks.is_null().to_numpy(), dtype=bool)
    # Not `flatten` of a list of fixed size, which has places of missing lists as well.
    filled = chunks.drop_null().combine_chunks()
    found[there] = _floats(filled.flatten(), arrow).reshape(-1, width)
    return found


def _is_list(kind: Any, arrow: Any) -> bool:
    kinds = arrow.types
    if not (kinds.is_list(kind) or kinds.is_large_list(kind) or kinds.is_fixed_size_list(kind)):
        return False
    inner = kind.value_type
    return kinds.is_boolean(inner) or kinds.is_integer(inner) or kinds.is_floating(inner)


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


def read_parquet(path: Path) -> Read:
    """Read a Parquet table: numbers, text, time stamps and durations in seconds (from 1970, UTC)."""
    with _opened(path) as file:
        held = file.metadata
        groups = (held.row_group(k) for k in range(held.num_row_groups))
        values = sum(group.column(k).num_values for group in groups for k in range(held.num_columns))
        require_room_for_numbers(path, held.num_rows, values)
        return arrow_columns(file.read(), str(path))


def parquet_source(path: Path) -> InParts | None:
    """Return a Parquet file as batches of rows; of row groups without a wanted row, nothing is read.

    None for one with lists, whose rows say how many columns they are.
    """
    with _opened(path) as file:
        if any(_is_list(field.type, importlib.import_module("pyarrow")) for field in file.schema_arrow):
            return None
        empty = arrow_columns(file.schema_arrow.empty_table(), str(path))
        sizes = [file.metadata.row_group(k).num_rows for k in range(file.num_row_groups)]
    firsts = [0, *itertools.accumulate(sizes)]

    def parts(names: Sequence[str], spans: Sequence[tuple[int, int]]) -> Iterator[Part]:
        arrow: Any = importlib.import_module("pyarrow")
        wanted = [k for k in range(len(sizes)) if overlaps(firsts[k], firsts[k + 1], spans)]
        with _opened(path) as file:
            for _, together in itertools.groupby(enumerate(wanted), lambda pair: pair[1] - pair[0]):
                groups = [k for _, k in together]
                at = firsts[groups[0]]
                for batch in file.iter_batches(limits.BATCH_ROWS, row_groups=groups, columns=list(names)):
                    table = arrow.Table.from_batches([batch])
                    for first, end in overlaps(at, at + len(table), spans):
                        found = arrow_columns(table.slice(first - at, end - first), str(path))
                        yield Part(first, found.columns)
                    at += len(table)

    return InParts(tuple(empty.columns), firsts[-1], parts, empty.notes)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """The file; InputError without pyarrow, or for what is not a valid file, wherever that shows."""
    parquet = library("pyarrow.parquet", "parquet", path, ".parquet")
    # Not `read_table`, which makes columns of parent folders with names like run=3. No
    # pre-buffer: it keeps what it has read, so that a file read in batches ends up in memory whole.
    with errors_of(path, "Parquet file"), parquet.ParquetFile(path, pre_buffer=False) as file:
        yield file


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
    except (ValueError, TypeError, RuntimeError):
        kind = type(values).__name__
        raise InputError(where, "numbers (n,)", f"a {kind} that NumPy makes no array of") from None
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
