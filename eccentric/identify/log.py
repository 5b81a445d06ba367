"""A measured log as it was recorded: named columns, nothing converted, nothing dropped.

`read_log` knows the formats; a further format is one function in `READERS`.
"""

from __future__ import annotations

import csv
import gzip
import importlib
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eccentric.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

Column = NDArray[Any]
Read = tuple[dict[str, Column], NDArray[np.int64] | None]
"""Columns, and the lines of their rows in a text file."""

_MISSING = frozenset({"", "na", "n/a", "#n/a", "null", "none", "-"})
_POINT = "; decimals are required with a point, as in 1.5"


@dataclass(frozen=True)
class Log:
    """Columns of one log, all of one length: float64 with NaN for a missing value, or str where text came.

    `lines` (rows,) are the numbers of the rows' lines in a text file, from 1; None for other formats.
    """

    path: str
    columns: Mapping[str, Column]
    rows: int
    lines: NDArray[np.int64] | None = None

    def place(self, row: int) -> str:
        """Return where the row (counted from 0) stands: its line as an editor shows it, else its number."""
        return f"row {row + 1}" if self.lines is None else f"line {self.lines[row]}"

    def numbers(self, name: str) -> NDArray[np.float64]:
        """Return the column `name` as float64 (rows,).

        Raises InputError where the log has no such column (naming those that it has), or where it holds text
        (naming its first line).
        """
        values = self.text(name)
        if values.dtype.kind == "f":
            return values
        for row, entry in enumerate(values):
            if _number(entry) is None:
                hint = _POINT if _number(entry.replace(",", ".")) is not None else ""
                raise InputError(
                    f"{self.path}: {self.place(row)}, column {name!r}: a number is required, "
                    f"received {str(entry)!r}{hint}"
                )
        raise AssertionError(f"column {name} was kept as text without reason")

    def text(self, name: str) -> Column:
        """Return the column `name` as it came, float64 or str; InputError where there is none."""
        if name not in self.columns:
            raise InputError(
                f"{self.path}: column {name!r} is required, the log has {', '.join(self.columns)}"
            )
        return self.columns[name]


def read_log(path: str | Path) -> Log:
    """Read a log: `.csv`, `.csv.gz`, `.mat` (to version 7), or `.parquet` (extra `parquet`).

    A CSV file has one header row; the delimiter is a comma, a semicolon or a tab. Lines at its head that are
    empty or begin with `#` are skipped, except that the last of those is the header if none follows.
    Raises InputError, one line with file, line and column, for whatever cannot be read.
    """
    path = Path(path)
    suffix = next((s for s in READERS if path.name.lower().endswith(s)), None)
    if path.is_dir():
        raise InputError(f"{path}: a log file is required, received a directory")
    if not path.exists():
        raise InputError(f"{path}: no such file")
    if suffix is None:
        raise InputError(
            f"{path}: a log of {', '.join(READERS)} is required, received {path.suffix or 'no suffix'!r}"
        )
    try:
        columns, lines = READERS[suffix](path)
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: UTF-8 text is required, byte {error.start} is not") from None
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise InputError(f"{path}: the compressed file is damaged or cut off ({error})") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    rows = len(next(iter(columns.values()))) if columns else 0
    if rows == 0:
        raise InputError(f"{path}: a log with rows is required, received none")
    return Log(str(path), columns, rows, lines)


def _read_csv(path: Path) -> Read:
    opened = gzip.open if path.name.lower().endswith(".gz") else open
    with opened(path, "rt", encoding="utf-8-sig", newline="") as file:
        text = file.readlines()
    skipped = next((k for k, line in enumerate(text) if _is_content(line)), len(text))
    if skipped == len(text):
        raise InputError(f"{path}: a header row with column names is required, the file is empty")
    # numpy.savetxt writes the column names as a comment.
    comment = text[skipped - 1].lstrip("# \t") if skipped else ""
    delimiter = max(",;\t", key=text[skipped].count)
    if comment.strip() and _only_numbers(first := _cells(text[skipped], delimiter)):
        names = _cells(comment, delimiter)
        if len(names) != len(first):
            names = comment.split()
        if len(names) == len(first):
            text[skipped - 1], skipped = delimiter.join(names) + "\n", skipped - 1
    header = _header(_cells(text[skipped], delimiter), path)
    reader = csv.reader(text[skipped + 1 :], delimiter=delimiter)
    try:
        found = [(skipped + 1 + reader.line_num, row) for row in reader if row]
    except csv.Error as error:
        raise InputError(f"{path}: no CSV file ({error})") from None
    for line, row in found:
        if len(row) != len(header):
            hint = _POINT if delimiter == "," and len(row) == 2 * len(header) else ""
            raise InputError(
                f"{path}: line {line}: {len(header)} values are required, received {len(row)}{hint}"
            )
    values = zip(*(row for _, row in found), strict=True)
    lines = np.array([line for line, _ in found], dtype=np.int64)
    return {name: _column(column) for name, column in zip(header, values, strict=False)}, lines


def _is_content(line: str) -> bool:
    return bool(line.strip()) and not line.startswith("#")


def _cells(line: str, delimiter: str) -> list[str]:
    return next(csv.reader([line], delimiter=delimiter))


def _only_numbers(cells: list[str]) -> bool:
    return all(_number(cell) is not None for cell in cells)


def _header(cells: list[str], path: Path) -> list[str]:
    # A table exported with its index has no name above the first column.
    names = [cell.strip() or f"column {number}" for number, cell in enumerate(cells, start=1)]
    if _only_numbers(names):
        raise InputError(f"{path}: a header row with column names is required, received numbers")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{path}: column names must differ, {twice!r} comes {names.count(twice)} times")
    return names


def _column(values: tuple[str, ...]) -> Column:
    try:
        return np.array(list(map(float, values)))
    except ValueError:
        numbers = [_number(value) for value in values]
    if None in numbers:
        return np.array(values, dtype=str)
    return np.array(numbers, dtype=float)


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return float("nan") if text.strip().lower() in _MISSING else None


def _read_parquet(path: Path) -> Read:
    try:
        parquet = importlib.import_module("pyarrow.parquet")
        arrow = importlib.import_module("pyarrow")
    except ImportError:
        raise InputError(f"{path}: pyarrow is required for .parquet: pip install pyarrow") from None
    try:
        table = parquet.read_table(path)
    except arrow.ArrowException as error:
        raise InputError(f"{path}: no Parquet file ({str(error).splitlines()[0]})") from None
    columns = {name: table[name].to_numpy() for name in table.column_names}
    return {
        name: values.astype(float if values.dtype.kind in "biuf" else str) for name, values in columns.items()
    }, None


def _read_mat(path: Path) -> Read:
    """Return the vectors of a MAT file, at the top or in a structure, of the most frequent length."""
    from scipy.io import loadmat

    try:
        content = loadmat(path, simplify_cells=True)
    except NotImplementedError:
        content = _mat_7_3(path)
    except (ValueError, TypeError, zlib.error) as error:
        raise InputError(f"{path}: no MAT file ({str(error).splitlines()[0]})") from None
    found: dict[str, Any] = {}
    for name, value in content.items():
        if not name.startswith("__"):
            found |= value if isinstance(value, dict) else {name: value}
    vectors = {
        n: np.asarray(v) for n, v in found.items() if np.ndim(v) == 1 and np.asarray(v).dtype.kind in "biufU"
    }
    lengths = [len(vector) for vector in vectors.values()]
    usual = max(lengths, key=lengths.count, default=0)
    return {
        name: vector if vector.dtype.kind == "U" else vector.astype(float)
        for name, vector in vectors.items()
        if len(vector) == usual
    }, None


def _mat_7_3(path: Path) -> dict[str, Any]:
    """Return the numeric variables of a MAT file of version 7.3, which is an HDF5 file."""
    try:
        h5py = importlib.import_module("h5py")
    except ImportError:
        raise InputError(
            f"{path}: h5py is required for MAT 7.3: pip install h5py, or save with -v7"
        ) from None
    content: dict[str, Any] = {}

    def keep(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "biuf":
            content[name.rsplit("/", 1)[-1]] = np.squeeze(item[()])

    with h5py.File(path) as file:
        file.visititems(keep)
    return content


READERS: dict[str, Callable[[Path], Read]] = {
    ".csv": _read_csv,
    ".csv.gz": _read_csv,
    ".mat": _read_mat,
    ".parquet": _read_parquet,
}
