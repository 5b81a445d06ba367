"""Files of named variables of any shape: JSON, NumPy archives, HDF5.

The columns are the variables of the commonest length, see `assemble`.
"""

from __future__ import annotations

import json
import sys
import zipfile
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.core import InputError, few
from eccentric.logs import limits
from eccentric.logs.assemble import LeftOut, Read, assemble
from eccentric.logs.foreign import library, reading, require_room_for_numbers, require_room_for_text, text_of


def read_json(path: Path) -> Read:
    """Read a JSON log, or one with an object in each line: columns by the entries' keys.

    A missing key is NaN, true and false are 1 and 0.

    Numbers and text beside the rows become columns that repeat them in every row, so that arithmetic in the
    rig can use them.
    """
    text = text_of(path)
    require_room_for_text(
        path, text, _rows(text), 1 + text.count(","), parts=text.count("{") + text.count("[")
    )
    try:
        content = json.loads(text)
    except json.JSONDecodeError as error:
        if (records := _records(text, path)) is not None:
            return assemble({"": records})
        rest = text[error.pos :].split(maxsplit=1)
        raise InputError(
            f"{path}: line {error.lineno}, column {error.colno}",
            "valid JSON",
            repr(rest[0][:20]) if rest else "the end of the file",
        ) from None
    except ValueError:
        digits = sys.get_int_max_str_digits()
        raise InputError(path, f"numbers of at most {digits:,} digits", "a longer one") from None
    except RecursionError:
        raise InputError(path, "a JSON log with a list of entries", "lists nested too deep") from None
    if isinstance(content, list):
        content = {"": content}
    if not isinstance(content, dict):
        raise InputError(path, "a JSON object with a list of entries", f"{content!r:.40}")
    _require_table(content, path)
    read = assemble(content)
    if not read.columns:
        keys = ", ".join(map(repr, list(content)[:8]))
        raise InputError(path, "a JSON log with a list of entries", f"keys {keys or 'none'}")
    return read


def _records(text: str, path: Path) -> list[dict[str, Any]] | None:
    """The objects of a text with one in each line; None for another text, InputError for a damaged line."""
    # Not `splitlines`, which also splits at separators that JSON allows inside a text.
    lines = [(k, line) for k, line in enumerate(text.split("\n"), start=1) if line.strip()]
    found: list[Any] = []
    for k, line in lines:
        try:
            found.append(json.loads(line))
        except json.JSONDecodeError as error:
            if len(found) < 2 or not all(isinstance(one, dict) for one in found):
                return None
            rest = line[error.pos :].strip()[:20]
            raise InputError(
                f"{path}: line {k}, column {error.colno}",
                "valid JSON, an object in each line",
                repr(rest) if rest else "the end of the line" + " (cut off?)" * (k == lines[-1][0]),
            ) from None
        except (ValueError, RecursionError):
            return None
    return found if all(isinstance(one, dict) for one in found) else None


def _require_table(content: object, path: Path, name: str = "") -> None:
    """Raise InputError for objects with lists of several lengths: they are recordings, no rows of a table."""
    if isinstance(content, dict):
        for key, inner in content.items():
            _require_table(inner, path, f"{name}.{key}" if name else key)
    if not isinstance(content, list) or not all(isinstance(item, dict) for item in content):
        return
    keys = dict.fromkeys(key for item in content for key in item)
    lists = {key: {len(item[key]) for item in content if isinstance(item.get(key), list)} for key in keys}
    uneven = [key for key, lengths in lists.items() if len(lengths) > 1]
    if uneven:
        lengths = sorted(lists[uneven[0]])
        raise InputError(
            path,
            "one table",
            f"{len(content)} objects in {name or 'a list'!r}, each with lists ({few(uneven, 3)}) of a length"
            f" of its own, {lengths[0]} to {lengths[-1]}: write a row for each sample, with a column for the"
            " run",
        )


def _rows(text: str) -> int:
    """Number of rows, before anything is read: of entries, or of the numbers of the longest column."""
    records = text.count("{") - text[:100].lstrip().startswith("{")
    return max(records, max(islice(_lengths(text), limits.MOST_LISTS), default=0))


def _lengths(text: str) -> Iterator[int]:
    """The length of each list that holds neither lists nor objects."""
    start = text.find("[")
    while start >= 0:
        end = text.find("]", start)
        end = len(text) if end < 0 else end
        inner = max(text.rfind("[", start + 1, end), text.find("{", start, end))
        if inner < 0:
            yield 1 + text.count(",", start, end)
        start = text.find("[", end if inner < 0 else inner)


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
                content[name] = _array(archive, name)
        return assemble(content)


def _array(archive: Any, name: str) -> Any:
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
    if depth > limits.DEEPEST_STRUCTURE:
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
