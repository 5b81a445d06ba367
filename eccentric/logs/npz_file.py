"""NumPy archives, without pickle: an array of Python objects is left out, since reading it would run it."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.logs.assemble import LeftOut, Read, assemble
from eccentric.logs.foreign import reading, require_room_for_numbers

_OBJECTS = LeftOut("since they hold Python objects, which only running them would read")


def read_npz(path: Path) -> Read:
    """Read the arrays of a NumPy archive: vectors, columns of matrices, fields of structured arrays."""
    with reading(path, "NumPy archive"):
        with zipfile.ZipFile(path) as file:
            values = sum(item.file_size for item in file.infolist()) // 8
        require_room_for_numbers(path, values, values)
        content: dict[str, Any] = {}
        with np.load(path, allow_pickle=False) as archive:
            for name in archive.files:
                content[name] = _value(archive, name)
        return assemble(content)


def _value(archive: Any, name: str) -> Any:
    try:
        value = archive[name]
    except ValueError as error:
        if "pickle" in str(error) or "Object arrays" in str(error):
            return _OBJECTS
        raise
    if isinstance(value, bytes):
        return LeftOut("since it is no array")
    if value.dtype.names is not None:
        return {field: value[field] for field in value.dtype.names}
    return value if value.ndim else value.item()


def read_npy(path: Path) -> Read:
    """Read a single array: its columns, or the fields of a structured array."""
    with reading(path, "NumPy array"):
        require_room_for_numbers(path, path.stat().st_size // 8, path.stat().st_size // 8)
        value = np.load(path, allow_pickle=False)
        content = {field: value[field] for field in value.dtype.names} if value.dtype.names else value
        return assemble(content if isinstance(content, dict) else {"array": content})
