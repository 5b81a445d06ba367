"""MATLAB logs: versions 5 and 7 by SciPy, version 7.3, which is HDF5, by h5py."""

from __future__ import annotations

import importlib
import io
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.errors import InputError
from eccentric.logs.assemble import Column, InParts, LeftOut, Part, Read, assemble
from eccentric.logs.hdf5_own import entries, own
from eccentric.logs.limits import BATCH_ROWS, DEEPEST_REFERENCE
from eccentric.logs.mat_check import check
from eccentric.logs.room import require_room_for_numbers

_OBJECT = LeftOut(
    "since only MATLAB reads its tables, strings and objects: save table2struct(T, 'ToScalar', true), "
    "char or numbers instead"
)


def read_mat(path: Path) -> Read:
    """Read the vectors of a MAT file, at the top, in structures, or as columns of a matrix."""
    if _is_7_3(path):
        with _opened_7_3(path) as (file, h5py):
            shapes: list[tuple[int, ...]] = []
            file.visititems(lambda _, item: shapes.append(getattr(item, "shape", None) or ()))
            _require_room(path, shapes)
            content = {name: _value(item, h5py, 0, _stored) for name, item in _variables(file, h5py)}
        return _contiguous(assemble(content))
    from scipy.io import loadmat

    data = path.read_bytes()

    try:
        _require_room(path, check(data))
        # SciPy warns of a repeated variable; here it becomes a note.
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            content = loadmat(io.BytesIO(data), simplify_cells=True)
    except InputError:
        raise
    except Exception as error:  # noqa: BLE001 - SciPy raises whatever a damaged file leads it into
        raise InputError(f"{path}: not a valid MAT file ({_line(error)})") from None
    kept = dict(_plain(name, value) for name, value in content.items() if not name.startswith("__"))
    read = _contiguous(assemble(kept))
    return Read(read.columns, notes=(*read.notes, *dict.fromkeys(_line(one.message) for one in said)))


def _plain(name: str, value: Any) -> tuple[str, Any]:
    """Mark a MATLAB object, which SciPy returns as a record that holds the variable's own name."""
    if isinstance(value, np.ndarray) and value.dtype.names is not None:
        if "s0" in value.dtype.names:
            name = np.ravel(value)[0]["s0"].decode(errors="replace")
        return name, _OBJECT
    return name, value


def mat_source(path: Path) -> InParts | None:
    """Return a file of version 7.3 as slices of its arrays; None for other versions, which are read whole."""
    if not _is_7_3(path):
        return None
    stored: list[_Slices] = []

    def stand_in(item: Any) -> Any:
        """An array of the same shape without memory, whose values number the columns that it stands for."""
        axes = [axis for axis, size in enumerate(item.shape) if size > 1][::-1]
        if not axes or len(axes) > 2:
            return _stored(item)
        axes.sort(key=lambda axis: -item.shape[axis])
        rows, others = item.shape[axes[0]], axes[1] if len(axes) == 2 else None
        count = 1 if others is None else item.shape[others]
        found = np.broadcast_to(np.arange(len(stored), len(stored) + count, dtype=float), (rows, count))
        stored.extend(_Slices(item.name, axes[0], others, k) for k in range(count))
        if others is None:
            return found[:, 0]
        return found if axes[0] > axes[1] else found.T

    with _opened_7_3(path) as (file, h5py):
        read = assemble({name: _value(item, h5py, 0, stand_in) for name, item in _variables(file, h5py)})
    rows = len(next(iter(read.columns.values()), ()))

    def parts(names: Sequence[str], spans: Sequence[tuple[int, int]]) -> Iterator[Part]:
        with _opened_7_3(path) as (file, _):
            for first, end in (
                (k, min(k + BATCH_ROWS, b)) for a, b in spans for k in range(a, b, BATCH_ROWS)
            ):
                columns: dict[str, Column] = {}
                for name in names:
                    column = read.columns[name]
                    # Only a stand-in has no step in memory from row to row.
                    is_stored = column.strides == (0,) and column.dtype.kind == "f" and rows > 1
                    own = stored[int(column[0])](file, first, end) if is_stored else column[first:end]
                    columns[name] = own
                yield Part(first, columns)

    return InParts(tuple(read.columns), rows, parts, read.notes)


@dataclass(frozen=True)
class _Slices:
    """A column that is stored in an array of the file, along one of its axes."""

    name: str
    axis: int
    other: int | None
    place: int

    def __call__(self, file: Any, first: int, end: int) -> Column:
        """Return the rows [first, end) of the column."""
        item = file[self.name]
        index: list[Any] = [0] * len(item.shape)
        index[self.axis] = slice(first, end)
        if self.other is not None:
            index[self.other] = self.place
        return np.asarray(item[tuple(index)], dtype=float)


def _is_7_3(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(128)[124:128] in (b"\x00\x02IM", b"\x02\x00MI")


@contextmanager
def _opened_7_3(path: Path) -> Iterator[tuple[Any, Any]]:
    """The file, and h5py; InputError without it, or for what is not a valid file, wherever that shows."""
    try:
        h5py = importlib.import_module("h5py")
    except ImportError:
        raise InputError(
            f'{path}: h5py is required for MAT 7.3: pip install "eccentric[mat73]", or save with -v7'
        ) from None
    try:
        with h5py.File(path) as file:
            yield file, h5py
    except InputError:
        raise
    except Exception as error:  # noqa: BLE001 - HDF5 raises whatever a damaged file leads it into
        raise InputError(f"{path}: not a valid MAT file of version 7.3 ({_line(error)})") from None


def _variables(file: Any, h5py: Any) -> list[tuple[str, Any]]:
    return [(name, item) for name, item in entries(file, h5py) if not name.startswith("#")]


def _stored(item: Any) -> Any:
    """The numbers of an array of the file, which is stored transposed."""
    return np.squeeze(item[()].T)


def _contiguous(read: Read) -> Read:
    """Columns of a matrix as arrays of their own."""
    return replace(read, columns={name: np.ascontiguousarray(x) for name, x in read.columns.items()})


def _value(item: Any, h5py: Any, depth: int, numbers: Callable[[Any], Any]) -> Any:
    """Return a variable of an HDF5 file as SciPy would: cells are references, arrays of `numbers`."""
    if isinstance(item, LeftOut):
        return item
    kind = item.attrs.get("MATLAB_class", b"")
    kind = kind.decode() if isinstance(kind, bytes) else str(kind)
    if (
        depth > DEEPEST_REFERENCE
        or "MATLAB_object_decode" in item.attrs
        or kind in ("table", "timetable", "string")
    ):
        return _OBJECT
    if isinstance(item, h5py.Group):
        return _records(
            {name: _value(inner, h5py, depth + 1, numbers) for name, inner in entries(item, h5py)}
        )
    if "MATLAB_empty" in item.attrs:
        return []
    if item.dtype == h5py.ref_dtype:
        cells = np.ravel(item[()])
        return [_value(own(item.file[reference], h5py), h5py, depth + 1, numbers) for reference in cells]
    if item.dtype.kind not in "biuf":
        return LeftOut("since it is neither numbers nor text")
    if kind == "char":
        texts = ["".join(map(chr, row)) for row in np.atleast_2d(item[()].T)]
        return texts[0] if len(texts) == 1 else texts
    content = numbers(item)
    return content if content.ndim else content.item()


def _records(fields: dict[str, Any]) -> Any:
    """Return a structure; if every field is a list of one length, a structure array: a list of structures."""
    lengths = {len(field) if isinstance(field, list) else 0 for field in fields.values()}
    if len(lengths) == 1 and (count := lengths.pop()) > 1:
        return [{name: field[k] for name, field in fields.items()} for k in range(count)]
    return fields


def _require_room(path: Path, shapes: Iterable[tuple[int, ...]]) -> None:
    """Raise InputError if arrays of these shapes take more memory than there is."""
    held = [(max(shape), prod(shape)) for shape in shapes if shape]
    if held:
        longest, counts = zip(*held, strict=True)
        require_room_for_numbers(path, max(longest), sum(counts))


def _line(error: object) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__
