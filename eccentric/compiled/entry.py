"""What the cache stores for a model: its shared library, and all that is needed to call it from Python.

A library is named after its content, so that processes which build one at the same time store the same.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from eccentric.output import (
    OURS_ALONE,
    cache_folder,
    digest,
    own_bytes,
    own_cache,
    read_cached,
    workshop,
    write_cached,
)


@dataclass(frozen=True)
class Signature:
    """A function as called from Python.

    Attributes:
        name: in the module.
        inputs: their names.
        width: numbers per sample; 0 for a single number that is not a row.
        requires: parameters without a default that are needed where the last input is not zero.
        length: entries of every input along its last axis; 0 where inputs are numbers.
    """

    name: str
    inputs: tuple[str, ...]
    width: int
    requires: tuple[str, ...]
    length: int


@dataclass(frozen=True)
class CacheEntry:
    """A model that has been built.

    Attributes:
        name: of the model.
        module: text of its emitted NumPy module.
        functions: in the order of the library.
        single, double: names of the coefficients in each precision, in the order of the C struct.
        library: file name of the library, which contains the digest of its content.
    """

    name: str
    module: str
    functions: tuple[Signature, ...]
    single: tuple[str, ...]
    double: tuple[str, ...]
    library: str


def read_entry(name: str, key: str) -> CacheEntry | None:
    """The entry of a model for that key, its library verified; None if there is none, or it is damaged."""
    found = read_record(f"{name}_{key}")
    if found is None:
        return None
    called = [
        Signature(f["name"], tuple(f["inputs"]), f["width"], tuple(f["requires"]), f["length"])
        for f in found["functions"]
    ]
    coefficients = tuple(found["single"]), tuple(found["double"])
    entry = CacheEntry(found["name"], found["module"], tuple(called), *coefficients, found["library"])
    held = own_bytes(cache_folder() / entry.library)
    return entry if held is not None and entry.library == _library_name(name, held) else None


def write_entry(key: str, entry: CacheEntry) -> None:
    """Store an entry for that key; its library is already in the cache."""
    write_record(f"{entry.name}_{key}", asdict(entry))


def keep_library(name: str, build: Callable[[Path], Path]) -> str:
    """Move the library that `build` makes in a folder into the cache; return its file name there.

    Raises:
        InputError: the cache cannot be written, or what `build` raises.
    """
    with workshop(own_cache()) as place:
        made = build(place)
        file = _library_name(name, made.read_bytes())
        made.chmod(OURS_ALONE)
        made.replace(cache_folder() / file)
    return file


def read_record(name: str) -> dict[str, Any] | None:
    """The content of the cache for a name; None if there is none, or it is damaged."""
    found = read_cached(f"{name}.json")
    return None if found is None else json.loads(found)


def write_record(name: str, content: dict[str, Any]) -> None:
    """Store a JSON document for a name.

    Raises:
        InputError: the cache cannot be written.
    """
    write_cached(f"{name}.json", json.dumps(content).encode())


def _library_name(name: str, held: bytes) -> str:
    return f"{name}_{digest([held])}.so"
