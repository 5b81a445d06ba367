"""Parquet logs, by pyarrow."""

from __future__ import annotations

import importlib
from pathlib import Path

from eccentric.errors import InputError
from eccentric.logs.arrow import arrow_columns
from eccentric.logs.assemble import Read
from eccentric.logs.room import require_room_for_numbers


def read_parquet(path: Path) -> Read:
    """Read a Parquet table: numbers, text, time stamps and durations in seconds (from 1970, UTC)."""
    try:
        parquet = importlib.import_module("pyarrow.parquet")
        arrow = importlib.import_module("pyarrow")
    except ImportError:
        raise InputError(
            f'{path}: pyarrow is required for .parquet: pip install "eccentric[parquet]"'
        ) from None
    try:
        # Not `read_table`, which makes columns of parent folders with names like run=3.
        with parquet.ParquetFile(path) as file:
            held = file.metadata
            require_room_for_numbers(path, held.num_rows, held.num_rows * held.num_columns)
            table = file.read()
    except (arrow.ArrowException, OSError) as error:
        if isinstance(error, PermissionError):
            raise
        raise InputError(f"{path}: not a valid Parquet file ({str(error).splitlines()[0]})") from None
    return arrow_columns(table, str(path))
