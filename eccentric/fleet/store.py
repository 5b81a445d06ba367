"""Sums on disk: one Parquet file for each joint and period, a row for each log file that went into it.

A row holds what tells its log file again (name, size, time of the last change) and a digest of how its sums
were made: the rig's values, the rows' filters, this module's version. Where all of it agrees, the file is not
read again.
"""

from __future__ import annotations

import hashlib
import importlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from eccentric.errors import InputError
from eccentric.fleet.limits import BLOCKS, SLOW, WINDOW_PERIODS
from eccentric.fleet.sums import Coverage, FileSums, Heading
from eccentric.rigs import Rig

__all__ = ["Key", "Stored", "arrow_of", "keys", "place_of", "read", "recipe_of", "write"]

_VERSION = 2
_HEADINGS = b"eccentric.columns"


@dataclass(frozen=True)
class Key:
    """What tells whether sums are those of a log as it is now: its name, size, last change; the recipe."""

    name: str
    size: int
    changed: int
    recipe: str


@dataclass(frozen=True)
class Stored(Key):
    """The sums of one log file; `headings` are their columns."""

    headings: tuple[Heading, ...]
    sums: FileSums


def recipe_of(rig: Rig) -> str:
    """A digest of all that the sums depend on besides the log."""
    made = (
        *(_VERSION, BLOCKS, SLOW, WINDOW_PERIODS, rig.model, rig.case, sorted(rig.known.items())),
        *(sorted(rig.unknown.items()), rig.log, rig.sampling, rig.alignment),
    )
    return hashlib.sha256(repr(made).encode()).hexdigest()[:16]


def place_of(out: Path, joint: str, period: str) -> Path:
    """The file of a joint and period below the folder of a fleet."""
    return out / "sums" / f"joint={quote(joint, safe=' ')}" / f"period={quote(period, safe=' ')}.parquet"


def write(path: Path, rows: Sequence[Stored], place: Path) -> None:
    """Write the sums of the files of one joint and period, all of one rig; the old file stays until then.

    The new one is made in the folder `place` on the same file system, and moved.
    """
    arrow, parquet = arrow_of()
    table: dict[str, list[Any]] = {
        "name": [row.name for row in rows],
        "size": [row.size for row in rows],
        "changed": [row.changed for row in rows],
        "recipe": [row.recipe for row in rows],
        "windows": [row.sums.windows.tolist() for row in rows],
        "triangles": [row.sums.triangles.ravel() for row in rows],
    }
    for field in fields(Coverage):
        table[field.name] = [getattr(row.sums.coverage, field.name) for row in rows]
    headings = json.dumps([asdict(heading) for heading in rows[0].headings]).encode()
    made = arrow.table(table).replace_schema_metadata({_HEADINGS: headings})
    new = place / path.name
    parquet.write_table(made, new, compression="none", use_dictionary=False, write_statistics=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    new.replace(path)


def read(path: Path) -> list[Stored]:
    """The rows of a file in the order of their names, none if there is no such file or it cannot be read.

    What cannot be read is made again: the logs are what counts.
    """
    arrow, parquet = arrow_of()
    try:
        with parquet.ParquetFile(path) as file:
            table = file.read(use_threads=False)
        headings = tuple(Heading(**entry) for entry in json.loads(table.schema.metadata[_HEADINGS]))
        return sorted((_stored(row, headings) for row in _rows(table)), key=lambda row: row.name)
    except (arrow.ArrowException, OSError, KeyError, TypeError, ValueError):
        return []


def keys(path: Path) -> list[Key]:
    """The keys of the rows of a file, none as for `read`."""
    arrow, parquet = arrow_of()
    names = [field.name for field in fields(Key)]
    try:
        with parquet.ParquetFile(path) as file:
            return [Key(**row) for row in file.read(names, use_threads=False).to_pylist()]
    except (arrow.ArrowException, OSError, TypeError):
        return []


def _rows(table: Any) -> Iterable[dict[str, Any]]:
    plain = {name: table[name].to_pylist() for name in table.column_names if name != "triangles"}
    lists = table["triangles"].combine_chunks()
    for k in range(table.num_rows):
        yield {name: values[k] for name, values in plain.items()} | {"triangles": lists[k].values.to_numpy()}


def _stored(row: dict[str, Any], headings: tuple[Heading, ...]) -> Stored:
    width = len(headings) + 1
    sums = FileSums(
        np.array(row["triangles"]).reshape(BLOCKS, width, width),
        np.array(row["windows"]),
        Coverage(**{field.name: row[field.name] for field in fields(Coverage)}),
    )
    return Stored(row["name"], row["size"], row["changed"], row["recipe"], headings, sums)


def arrow_of() -> tuple[Any, Any]:
    """The modules pyarrow and pyarrow.parquet; InputError if they are not installed."""
    try:
        return importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    except ImportError:
        raise InputError('fleet: pyarrow is required: pip install "eccentric[fleet]"') from None
