"""The formats of logs: one line for each, and a file with its reader. Help and doctor list what is here."""

from __future__ import annotations

import gzip
import zlib
from contextlib import suppress
from pathlib import Path

from eccentric.core import InputError, readable
from eccentric.logs import (
    codesys_file,
    csv_file,
    hdf5_file,
    json_file,
    mat_file,
    mdf_file,
    npz_file,
    parquet_file,
    ros1_file,
    ros_file,
    tdms_file,
    ulog_file,
    wpilog_file,
    xlsx_file,
)
from eccentric.logs.assemble import Format

FORMATS: tuple[Format, ...] = (
    csv_file.FORMAT,
    codesys_file.FORMAT,
    json_file.FORMAT,
    npz_file.FORMAT,
    npz_file.SINGLE,
    xlsx_file.FORMAT,
    mat_file.FORMAT,
    parquet_file.FORMAT,
    hdf5_file.FORMAT,
    mdf_file.FORMAT,
    ros_file.BAG,
    ros_file.MCAP,
    ros1_file.FORMAT,
    ulog_file.FORMAT,
    wpilog_file.FORMAT,
    tdms_file.FORMAT,
)
SUFFIXES: tuple[str, ...] = tuple(suffix for one in FORMATS for suffix in one.endings)


def format_of(path: Path) -> Format:
    """Return the format of a log: by its suffix; by its content under a suffix of text or an unknown one.

    Raises:
        InputError: no regular file, or of no known format.
    """
    readable(path)
    name = path.name.lower()
    named = next((one for one in FORMATS if name.endswith(one.endings)), None)
    if named is not None and named is not csv_file.FORMAT:
        return named
    start = _start(path)
    # JSON and a trace are text as well: a CSV file is one by its name, unless a trace says what it is.
    said = (one for one in FORMATS if one.looks(start))
    found = next((one for one in said if not (one is json_file.FORMAT and ".csv" in name)), named)
    if found is None:
        raise InputError(path, f"a log of {', '.join(SUFFIXES)}", f"{path.suffix or 'no suffix'!r}")
    return found


def _start(path: Path) -> bytes:
    """The first bytes of a file, unpacked where it is compressed."""
    with path.open("rb") as file:
        start = file.read(4096)
    if start[:2] == b"\x1f\x8b":
        with suppress(OSError, EOFError, zlib.error), gzip.open(path) as unpacked:
            return unpacked.read(4096)
    return start
