"""The formats of logs: a line for each, and a file with its reader. Help, doctor and docs list what is here.

A reader is imported when a log is read: a page of help needs none of them.
"""

from __future__ import annotations

import gzip
import zlib
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

from eccentric.core import InputError, readable
from eccentric.logs import limits

if TYPE_CHECKING:
    from pathlib import Path

    from eccentric.logs.assemble import InParts, Read


@dataclass(frozen=True)
class Format:
    """A kind of file that is a log.

    Attributes:
        suffixes: of its files, the usual one first; none for one that only its content shows.
        title: what it is.
        reader: the file of this room and its function that returns the columns.
        parts: the same for a file that can be read in parts.
        begins: the first bytes, one of these; white space before them does not count.
        holds: what the first 4 kB have somewhere, one of these, if any.
        gzipped: whether its files may be compressed as well.
        extra: of `pyproject.toml`, with its `packages`; for `extra_for` alone, if not every file needs it.
    """

    suffixes: tuple[str, ...]
    title: str
    reader: str
    begins: tuple[bytes, ...] = ()
    holds: tuple[bytes, ...] = ()
    parts: str = ""
    gzipped: bool = False
    extra: str = ""
    extra_for: str = ""

    @property
    def packages(self) -> tuple[str, ...]:
        """The packages that its extra brings."""
        return _PACKAGES.get(self.extra, ())

    @property
    def endings(self) -> tuple[str, ...]:
        """The ends of the names of its files, lower case."""
        return (*self.suffixes, *(f"{suffix}.gz" for suffix in self.suffixes if self.gzipped))

    def looks(self, start: bytes) -> bool:
        """Whether the first bytes of a file are those of this format."""
        there = start.removeprefix(b"\xef\xbb\xbf").lstrip()
        return there.startswith(self.begins) and (not self.holds or any(part in start for part in self.holds))

    def read(self, path: Path) -> Read:
        """Return the columns of a file; InputError if it is damaged."""
        return _function(self.reader)(path)

    def in_parts(self, path: Path) -> InParts | None:
        """Return a file in parts; None for one that must be read whole."""
        return _function(self.parts)(path) if self.parts else None


def _function(place: str) -> Any:
    file, name = place.split(".")
    return getattr(import_module(f"eccentric.logs.{file}"), name)


_PACKAGES = {
    "xlsx": ("openpyxl",), "mat73": ("h5py",), "parquet": ("pyarrow",), "hdf5": ("h5py",),
    "mdf": ("asammdf",), "rosbag": ("rosbags",), "mcap": ("mcap", "rosbags"), "ulog": ("pyulog",),
    "tdms": ("nptdms",),
}  # fmt: skip
"""Extra of `pyproject.toml` -> the packages that it brings."""
TEXT = Format(
    (".csv", ".txt", ".dat", ".tsv", ".log", ".asc"),
    "delimited text",
    "csv_file.read_csv",
    parts="csv_file.csv_source",
    gzipped=True,
)
_JSON = "JSON, as Rhoban BAM and pandas write it"
JSON = Format(
    (".json",), _JSON, "named_arrays.read_json", (b'{"', b"{\n", b"{\r", b"{ ", b"{\t", b"[{"), gzipped=True
)
_MAT = Format(
    (".mat",),
    "MATLAB",
    "mat_file.read_mat",
    (b"MATLAB",),
    parts="mat_file.mat_source",
    extra="mat73",
    extra_for="version 7.3",
)
_PARQUET = Format(
    (".parquet",),
    "Parquet",
    "tables.read_parquet",
    (b"PAR1",),
    parts="tables.parquet_source",
    extra="parquet",
)
_ZIP, _H5 = b"PK", b"\x89HDF\r\n\x1a\n"
_SHEETS = b"[Content_Types].xml", b"xl/"
_MCAP = "MCAP with messages of ROS 2 or in JSON"
FORMATS: tuple[Format, ...] = (
    TEXT,
    Format((), "trace of CODESYS", "recorders.read_codesys", (b"[key]; [value]",)),
    JSON,
    Format((".npz",), "NumPy archive", "named_arrays.read_npz", (_ZIP,), (b".npy",)),
    Format((".npy",), "NumPy array", "named_arrays.read_npy", (b"\x93NUMPY",)),
    Format((".xlsx",), "workbook; its longest sheet", "csv_file.read_xlsx", (_ZIP,), _SHEETS, extra="xlsx"),
    _MAT,
    _PARQUET,
    Format((".h5", ".hdf5"), "HDF5", "named_arrays.read_hdf5", (_H5,), extra="hdf5"),
    Format((".mf4", ".mdf"), "MDF 3 or 4", "recorders.read_mdf", (b"MDF ", b"UnFi"), extra="mdf"),
    Format((".db3",), "ROS 2 bag", "ros_file.read_bag", (b"SQLite format 3",), extra="rosbag"),
    Format((".mcap",), _MCAP, "ros_file.read_mcap", (b"\x89MCAP",), extra="mcap"),
    Format((".bag",), "ROS 1 bag", "ros_file.read_bag1", (b"#ROSBAG",), extra="rosbag"),
    Format((".ulg",), "ULog of PX4", "recorders.read_ulog", (b"ULog",), extra="ulog"),
    Format((".wpilog",), "data log of WPILib", "recorders.read_wpilog", (b"WPILOG",)),
    Format((".tdms",), "TDMS of LabVIEW", "recorders.read_tdms", (b"TDSm",), extra="tdms"),
)


def format_of(path: Path) -> Format:
    """Return the format of a log: by its suffix; by its content under a suffix of text or an unknown one.

    Raises:
        InputError: no regular file, or of no known format.
    """
    readable(path)
    name = path.name.lower()
    named = next((one for one in FORMATS if name.endswith(one.endings)), None)
    if named is not None and named is not TEXT:
        return named
    start = _start(path)
    # A table called .csv may begin with a brace.
    said = (one for one in FORMATS if one.begins and one.looks(start))
    found = next((one for one in said if not (one is JSON and ".csv" in name)), named)
    if found is None and _is_table(start):
        return TEXT
    if found is None:
        text, *others = (one.suffixes[0] for one in (TEXT, _MAT, _PARQUET))
        raise InputError(
            path,
            f"a log such as {text}, {' or '.join(others)}",
            f"{path.suffix or 'no suffix'!r}",
            why="(docs/rig-reference.md lists all formats)",
        )
    return found


def _is_table(start: bytes) -> bool:
    """Whether the first bytes of a file are text with rows of numbers."""
    from eccentric.logs.layout import has_rows

    try:
        text = start.decode("utf-8-sig", "ignore" if len(start) == limits.FIRST_BYTES else "strict")
    except UnicodeDecodeError:
        return False
    return "\0" not in text and has_rows(
        text.splitlines()[: -1 if len(start) == limits.FIRST_BYTES else None]
    )


def _start(path: Path) -> bytes:
    """The first bytes of a file, unpacked where it is compressed."""
    with path.open("rb") as file:
        start = file.read(limits.FIRST_BYTES)
    if start[:2] == b"\x1f\x8b":
        with suppress(OSError, EOFError, zlib.error), gzip.open(path) as unpacked:
            return unpacked.read(limits.FIRST_BYTES)
    return start
