"""A log file as logs of at most so many rows: what is in memory does not grow with the file."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path

from eccentric.errors import InputError
from eccentric.fleet.limits import BATCH_ROWS
from eccentric.logs import Log, arrow_columns, read_log
from eccentric.rigs import CHANNELS, Rig

__all__ = ["batches"]


def batches(path: Path, rig: Rig, rows: int = BATCH_ROWS) -> Iterator[tuple[Log, int]]:
    """Yield parts of a file in order, each with the number of rows of the whole.

    Parquet is read by groups of rows, and of it the columns that the rig needs; other formats are one part.
    Raises InputError for a file that cannot be read.
    """
    if path.name.lower().endswith(".parquet"):
        yield from _of_parquet(path, rig, rows)
    else:
        log = read_log(path)
        yield log, log.rows


def _of_parquet(path: Path, rig: Rig, rows: int) -> Iterator[tuple[Log, int]]:
    parquet, arrow = (importlib.import_module(name) for name in ("pyarrow.parquet", "pyarrow"))
    try:
        with parquet.ParquetFile(path) as file:
            total = file.metadata.num_rows
            if not total:
                raise InputError(f"{path}: a log with rows is required, received none")
            names = _needed(rig, file.schema_arrow.names)
            for batch in file.iter_batches(batch_size=rows, columns=names, use_threads=False):
                read = arrow_columns(arrow.Table.from_batches([batch]), str(path))
                yield Log(str(path), read.columns, batch.num_rows, notes=read.notes), total
    except (arrow.ArrowException, OSError) as error:
        said = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"{path}: not a valid Parquet file ({said})") from None


def _needed(rig: Rig, there: list[str]) -> list[str] | None:
    """The columns that the rig maps; None, all of them, where it maps arithmetic on columns."""
    if rig.log.columns is None:
        standard = {column for column, _ in CHANNELS.values()}
        return [name for name in there if name in standard]
    texts = {source.text for source in rig.log.columns.values()}
    # A column that is missing is left to the reader of channels, whose message names the channel.
    return [name for name in there if name in texts] if texts <= set(there) else None
