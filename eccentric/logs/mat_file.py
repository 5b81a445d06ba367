"""MATLAB logs: versions 5 and 7 by SciPy, version 7.3, which is HDF5, by h5py."""

from __future__ import annotations

import importlib
import io
import warnings
from collections.abc import Iterable
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.errors import InputError
from eccentric.logs.assemble import LeftOut, Read, assemble
from eccentric.logs.limits import DEEPEST_REFERENCE
from eccentric.logs.mat_check import check
from eccentric.logs.room import require_room_for_numbers

_OBJECT = LeftOut(
    "since only MATLAB reads its tables, strings and objects: save table2struct(T, 'ToScalar', true), "
    "char or numbers instead"
)


def read_mat(path: Path) -> Read:
    """Read the vectors of a MAT file, at the top, in structures, or as columns of a matrix."""
    data = path.read_bytes()
    if data[124:128] in (b"\x00\x02IM", b"\x02\x00MI"):
        return assemble(_read_7_3(path))
    from scipy.io import loadmat

    try:
        _require_room(path, check(data))
        # SciPy warns of a repeated variable; here it becomes a note.
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            content: dict[str, Any] = loadmat(io.BytesIO(data), simplify_cells=True)
    except InputError:
        raise
    except Exception as error:  # noqa: BLE001 - SciPy raises whatever a damaged file leads it into
        raise InputError(f"{path}: not a valid MAT file ({_line(error)})") from None
    read = assemble(dict(_plain(name, value) for name, value in content.items() if not name.startswith("__")))
    return Read(read.columns, notes=(*read.notes, *dict.fromkeys(_line(one.message) for one in said)))


def _plain(name: str, value: Any) -> tuple[str, Any]:
    """Mark a MATLAB object, which SciPy returns as a record that holds the variable's own name."""
    if isinstance(value, np.ndarray) and value.dtype.names is not None:
        if "s0" in value.dtype.names:
            name = np.ravel(value)[0]["s0"].decode(errors="replace")
        return name, _OBJECT
    return name, value


def _read_7_3(path: Path) -> dict[str, Any]:
    try:
        h5py = importlib.import_module("h5py")
    except ImportError:
        raise InputError(
            f'{path}: h5py is required for MAT 7.3: pip install "eccentric[mat73]", or save with -v7'
        ) from None
    try:
        with h5py.File(path) as file:
            shapes: list[tuple[int, ...]] = []
            file.visititems(lambda _, item: shapes.append(getattr(item, "shape", None) or ()))
            _require_room(path, shapes)
            return {name: _value(item, h5py, 0) for name, item in file.items() if not name.startswith("#")}
    except InputError:
        raise
    except Exception as error:  # noqa: BLE001 - HDF5 raises whatever a damaged file leads it into
        raise InputError(f"{path}: not a valid MAT file of version 7.3 ({_line(error)})") from None


def _value(item: Any, h5py: Any, depth: int) -> Any:
    """Return a variable of an HDF5 file as SciPy would: arrays are stored transposed, cells as references."""
    kind = item.attrs.get("MATLAB_class", b"")
    kind = kind.decode() if isinstance(kind, bytes) else str(kind)
    if (
        depth > DEEPEST_REFERENCE
        or "MATLAB_object_decode" in item.attrs
        or kind in ("table", "timetable", "string")
    ):
        return _OBJECT
    if isinstance(item, h5py.Group):
        return _records({name: _value(inner, h5py, depth + 1) for name, inner in item.items()})
    if "MATLAB_empty" in item.attrs:
        return []
    content = item[()]
    if item.dtype == h5py.ref_dtype:
        return [_value(item.file[reference], h5py, depth + 1) for reference in np.ravel(content)]
    if item.dtype.kind not in "biuf":
        return LeftOut("since it is neither numbers nor text")
    if kind == "char":
        texts = ["".join(map(chr, row)) for row in np.atleast_2d(content.T)]
        return texts[0] if len(texts) == 1 else texts
    content = np.squeeze(content.T)
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
