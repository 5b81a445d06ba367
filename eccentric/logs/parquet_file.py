"""Parquet logs, by pyarrow."""

from __future__ import annotations

import importlib
import itertools
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.core import InputError, few
from eccentric.logs.assemble import Column, InParts, Part, Read, column_of, overlaps
from eccentric.logs.foreign import require_room_for_numbers
from eccentric.logs.limits import BATCH_ROWS, MOST_PARTS

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
    if len(places) != 1 or not 0 < (width := places.pop()) <= MOST_PARTS:
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
                for batch in file.iter_batches(BATCH_ROWS, row_groups=groups, columns=list(names)):
                    table = arrow.Table.from_batches([batch])
                    for first, end in overlaps(at, at + len(table), spans):
                        found = arrow_columns(table.slice(first - at, end - first), str(path))
                        yield Part(first, found.columns)
                    at += len(table)

    return InParts(tuple(empty.columns), firsts[-1], parts, empty.notes)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """The file; InputError without pyarrow, or for what is not a valid file, wherever that shows."""
    try:
        parquet = importlib.import_module("pyarrow.parquet")
        arrow = importlib.import_module("pyarrow")
    except ImportError:
        raise InputError(
            f'{path}: pyarrow is required for .parquet: pip install "eccentric[parquet]"'
        ) from None
    try:
        # Not `read_table`, which makes columns of parent folders with names like run=3. No
        # pre-buffer: it keeps what it has read, so that a file read in batches ends up in memory whole.
        with parquet.ParquetFile(path, pre_buffer=False) as file:
            yield file
    except (arrow.ArrowException, OSError) as error:
        if isinstance(error, PermissionError):
            raise
        raise InputError(f"{path}: not a valid Parquet file ({str(error).splitlines()[0]})") from None
