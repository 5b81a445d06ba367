"""MATLAB logs: versions 5 and 7 by SciPy, version 7.3, which is HDF5, by h5py."""

from __future__ import annotations

import io
import struct
import warnings
import zlib
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.logs import limits
from eccentric.logs.assemble import Column, InParts, LeftOut, Part, Read, assemble
from eccentric.logs.foreign import DamagedError, errors_of, library, require_room_for_numbers
from eccentric.logs.named_arrays import entries, own

# Check that the elements of a MAT file of version 5 or 7 are consistent, before SciPy reads it.
#
# SciPy's reader trusts type codes and sizes: a single wrong byte can crash the process or exhaust the memory.
# So whatever it relies on is checked here first.


MATRIX, COMPRESSED = 14, 15
BYTES = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8}
"""Bytes per number, by type code."""
LETTERS = {1: 1, 2: 1, 4: 2, 16: 1, 17: 2, 18: 4}
"""The same for characters; in UTF-8 (16) they can take more."""
CELL, STRUCTURE, OBJECT, CHAR, SPARSE = 1, 2, 3, 4, 5
NUMBERS = range(6, 16)
FUNCTION, OPAQUE = 16, 17


@dataclass
class _Bytes:
    """A piece of the file that is read from its start; `order` is that of `struct`."""

    data: memoryview
    order: str

    def element(self, padded: bool = True) -> tuple[int, memoryview]:
        """Return type code and content of the next element, and advance past it."""
        if len(self.data) < 8:
            raise DamagedError("it breaks off")
        (first,) = struct.unpack(f"{self.order}I", self.data[:4])
        kind, size, start = first & 0xFFFF, first >> 16, 4
        if size == 0:
            kind, size, start = *struct.unpack(f"{self.order}II", self.data[:8]), 8
        elif size > 4:
            raise DamagedError("a small element has more than four bytes")
        if start + size > len(self.data):
            raise DamagedError("it breaks off")
        content = self.data[start : start + size]
        self.data = self.data[8 if start == 4 else start + (size + (-size % 8 if padded else 0)) :]
        return kind, content

    def numbers(self) -> tuple[int, ...]:
        """Return the 32-bit numbers of the next element, which must be of such a type."""
        kind, content = self.require((5, 6))
        if len(content) % 4:
            raise DamagedError("numbers are cut off")
        return struct.unpack(f"{self.order}{len(content) // 4}{'i' if kind == 5 else 'I'}", content)

    def require(self, kinds: Container[int]) -> tuple[int, memoryview]:
        """Return the next element, which must be of one of these types."""
        found, content = self.element()
        if found not in kinds:
            raise DamagedError(f"an element of type {found} is not allowed here")
        return found, content


def check(data: bytes) -> list[tuple[int, ...]]:
    """Go through a file of version 5 or 7, and return the shapes of its arrays of numbers and characters.

    Raises DamagedError with a reason if SciPy must not read it.
    """
    shapes: list[tuple[int, ...]] = []
    order = {b"IM": "<", b"MI": ">"}.get(data[126:128])
    if order is None:
        raise DamagedError("its header is not that of version 5 or later; save with -v7")
    rest = _Bytes(memoryview(data)[128:], order)
    while len(rest.data):
        kind, content = rest.element(padded=False)
        if kind == COMPRESSED:
            unpacker = zlib.decompressobj()
            content = memoryview(unpacker.decompress(content, limits.MOST_BYTES))
            if unpacker.unconsumed_tail:
                raise DamagedError(f"a variable has more than {limits.MOST_BYTES:,} bytes")
            if not unpacker.eof:
                raise DamagedError("it breaks off")
            kind, content = _Bytes(content, order).element()
        if kind != MATRIX:
            raise DamagedError(f"a variable of type {kind} is where a matrix")
        _matrix(_Bytes(content, order), 0, shapes)
    return shapes


def _matrix(rest: _Bytes, depth: int, shapes: list[tuple[int, ...]]) -> None:
    """Check the content of a matrix element, and note its shape; it may be empty below the top."""
    if depth > limits.DEEPEST_VARIABLE:
        raise DamagedError(f"it is nested deeper than {limits.DEEPEST_VARIABLE}")
    if not len(rest.data) and depth:
        return
    flags = rest.numbers()
    if len(flags) != 2:
        raise DamagedError("array flags are two numbers")
    kind, is_complex = flags[0] & 0xFF, bool(flags[0] >> 11 & 1)
    if kind == OPAQUE:
        for _ in ("name", "type system", "class"):
            _word(rest)
        _inner(rest, depth, shapes)
        return
    shape = rest.numbers()
    count = prod(shape)
    if not 2 <= len(shape) <= 32 or min(shape) < 0 or count > limits.MOST_BYTES:
        raise DamagedError("an array has an impossible size")
    _word(rest)
    if kind in NUMBERS or kind == CHAR:
        shapes.append(shape)
    if kind in NUMBERS:
        for _ in range(1 + is_complex):
            code, content = rest.require(BYTES)
            if len(content) != count * BYTES[code]:
                raise DamagedError("an array does not have its declared size")
    elif kind == CHAR:
        code, content = rest.require(LETTERS)
        if len(content) % LETTERS[code] or not (len(content) >= count * LETTERS[code] or not len(content)):
            raise DamagedError("a text does not have its declared length")
        if len(content) == 0 and count > 8 * limits.DEEPEST_VARIABLE:
            raise DamagedError("a long text is empty")
    elif kind == CELL:
        _inner(rest, depth, shapes, count)
    elif kind in (STRUCTURE, OBJECT):
        if kind == OBJECT:
            _word(rest)
        (length,) = rest.numbers() or (0,)
        names = _word(rest)
        if (
            length < 1
            or len(names) % length
            or any(0 not in names[k : k + length] for k in range(0, len(names), length))
        ):
            raise DamagedError("field names do not have their declared length")
        _inner(rest, depth, shapes, count * (len(names) // length))
    elif kind == FUNCTION:
        _inner(rest, depth, shapes)
    elif kind == SPARSE:
        raise DamagedError("a sparse array is not a signal; save with full(...)")
    else:
        raise DamagedError(f"an array of class {kind} is unknown")


def _inner(rest: _Bytes, depth: int, shapes: list[tuple[int, ...]], count: int = 1) -> None:
    """Check the matrices of a cell array or structure, as many as it has."""
    if count * 8 > len(rest.data):
        raise DamagedError("it breaks off")
    for _ in range(count):
        _, content = rest.require((MATRIX,))
        _matrix(_Bytes(content, rest.order), depth + 1, shapes)


def _word(rest: _Bytes) -> bytes:
    return bytes(rest.require((1, 16))[1])


_OBJECT = LeftOut(
    "since only MATLAB reads its tables, strings and objects: save table2struct(T, 'ToScalar', true), "
    "char or numbers instead"
)


# The file, once it is known to be sound.


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
    with errors_of(path, "MAT file"), warnings.catch_warnings(record=True) as said:
        _require_room(path, check(data))
        # SciPy warns of a repeated variable; here it becomes a note.
        warnings.simplefilter("always")
        content = loadmat(io.BytesIO(data), simplify_cells=True)
    kept = dict(_plain(name, value) for name, value in content.items() if not name.startswith("__"))
    read = _contiguous(assemble(kept))
    notes = dict.fromkeys(" ".join(str(one.message).split())[:200] for one in said)
    return Read(read.columns, notes=(*read.notes, *notes))


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
                (k, min(k + limits.BATCH_ROWS, b)) for a, b in spans for k in range(a, b, limits.BATCH_ROWS)
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
    h5py = library("h5py", "mat73", path, "MAT 7.3", ", or save with -v7")
    with errors_of(path, "MAT 7.3 file"), h5py.File(path) as file:
        yield file, h5py


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
        depth > limits.DEEPEST_REFERENCE
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
