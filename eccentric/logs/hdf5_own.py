"""What an HDF5 file itself holds: links, external storage and virtual datasets would read other files."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from eccentric.logs.assemble import LeftOut

__all__ = ["entries", "own"]


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
