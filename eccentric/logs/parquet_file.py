"""Parquet logs, by pyarrow."""

from __future__ import annotations

import importlib
import itertools
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from eccentric.errors import InputError
from eccentric.logs.arrow import arrow_columns
from eccentric.logs.assemble import InParts, Part, Read, overlaps
from eccentric.logs.limits import BATCH_ROWS
from eccentric.logs.room import require_room_for_numbers


def read_parquet(path: Path) -> Read:
    """Read a Parquet table: numbers, text, time stamps and durations in seconds (from 1970, UTC)."""
    with _opened(path) as file:
        held = file.metadata
        require_room_for_numbers(path, held.num_rows, held.num_rows * held.num_columns)
        return arrow_columns(file.read(), str(path))


def parquet_source(path: Path) -> InParts:
    """Return a Parquet file as batches of rows; of row groups without a wanted row, nothing is read."""
    with _opened(path) as file:
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
