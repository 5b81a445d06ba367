"""HDF5 files by h5py: datasets at the top and in groups, with their units where an attribute states them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.logs.assemble import LeftOut, Read, assemble
from eccentric.logs.foreign import library, reading, require_room_for_numbers
from eccentric.logs.limits import DEEPEST_STRUCTURE

# What an HDF5 file itself holds: links, external storage and virtual datasets would read other files.


def entries(group: Any, h5py: Any) -> Iterator[tuple[str, Any]]:
    """Yield the names of a group with its groups and datasets, or with the reason why one is left out."""
    for key in group:
        if isinstance(group.get(key, getlink=True), h5py.HardLink):
            yield str(key), own(group[key], h5py)
        else:
            yield str(key), LeftOut("since it is a link")


def own(item: Any, h5py: Any) -> Any:
    """The item, or the reason why it is left out."""
    if isinstance(item, h5py.Dataset) and (item.external or item.is_virtual):
        return LeftOut("since its values are in other files")
    return item


_UNIT = ("unit", "units", "Unit", "Units")


def read_hdf5(path: Path) -> Read:
    """Read the datasets of numbers and text; links, and values in other files, are left out with a note."""
    h5py = library("h5py", "hdf5", path)
    with reading(path, "HDF5 file"), h5py.File(path, "r") as file:
        found: dict[str, Any] = {}
        _collect(file, "", found, h5py, 0)
        sizes = [item.shape for item in found.values() if not isinstance(item, LeftOut)]
        if sizes:
            longest, total = max(max(s, default=1) for s in sizes), sum(int(np.prod(s)) for s in sizes)
            require_room_for_numbers(path, longest, total)
        content: dict[str, Any] = {}
        units: dict[str, str] = {}
        for name, item in found.items():
            content[name] = item if isinstance(item, LeftOut) else _value(item)
            if not isinstance(item, LeftOut) and (unit := _unit(item)):
                units[name] = unit
        read = assemble(content)
        ends = {name.rsplit(".", 1)[-1]: unit for name, unit in units.items()}
        shown = {
            name: units.get(name) or ends[name] for name in read.columns if name in units or name in ends
        }
        return Read(read.columns, notes=read.notes, units=shown)


def _collect(group: Any, prefix: str, found: dict[str, Any], h5py: Any, depth: int) -> None:
    if depth > DEEPEST_STRUCTURE:
        return
    for key, item in entries(group, h5py):
        name = f"{prefix}.{key}" if prefix else key
        if isinstance(item, LeftOut):
            found[name] = item
        elif isinstance(item, h5py.Group):
            _collect(item, name, found, h5py, depth + 1)
        elif isinstance(item, h5py.Dataset):
            found[name] = item if item.shape is not None else LeftOut("since it is empty")


def _value(item: Any) -> Any:
    if item.dtype.names is not None:
        table = item[()]
        return {field: _plain(table[field]) for field in item.dtype.names}
    if item.dtype.kind in "OS":
        try:
            texts = item.asstr("utf-8", "replace")[()]
        except TypeError:
            return LeftOut("since it is neither numbers nor text")
        return texts if isinstance(texts, str) else np.asarray(texts).astype(str)
    return _plain(item[()])


def _plain(value: Any) -> Any:
    if np.asarray(value).dtype.kind == "S":
        return np.char.decode(value, "utf-8", "replace")
    return np.asarray(value) if np.ndim(value) else np.asarray(value).item()


def _unit(item: Any) -> str:
    for key in _UNIT:
        if key in item.attrs:
            value = item.attrs[key]
            return value.decode(errors="replace") if isinstance(value, bytes) else str(value)
    return ""
