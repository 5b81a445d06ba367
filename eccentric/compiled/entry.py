"""What the cache keeps of a model: its shared library, and all that is needed to serve it from Python.

A file of the cache is moved there as a whole, under a name that follows from what it was made of or from
what it holds. So processes that write at the same time write the same, and what was damaged is made again.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from eccentric.output import folder_to_write, workshop


@dataclass(frozen=True)
class Called:
    """A function as Python calls it.

    Attributes:
        name: in the module.
        inputs: their names.
        width: numbers a sample, 0 where that is one number and no row.
        requires: parameters without a default that are needed where the last input is not zero.
    """

    name: str
    inputs: tuple[str, ...]
    width: int
    requires: tuple[str, ...]


@dataclass(frozen=True)
class Entry:
    """A model that is built.

    Attributes:
        name: of the model.
        module: text of its emitted NumPy module.
        functions: in the order of the library.
        single, double: names of the coefficients in each precision, in the order in which C holds them.
        library: file name of the library, which carries the digest of what it holds.
    """

    name: str
    module: str
    functions: tuple[Called, ...]
    single: tuple[str, ...]
    double: tuple[str, ...]
    library: str


def digest(parts: Iterable[str | bytes]) -> str:
    """The digest of texts, each of which counts where it ends."""
    code = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        code.update(f"{len(data)} ".encode() + data)
    return code.hexdigest()[:32]


def cache_folder() -> Path:
    """The folder of the user's cache that is ours; it need not be there."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "eccentric"


def read_entry(name: str, key: str) -> Entry | None:
    """The entry of a model under that key, its library checked; None if there is none, or a damaged one."""
    found = read_record(f"{name}_{key}")
    if found is None:
        return None
    called = [
        Called(f["name"], tuple(f["inputs"]), f["width"], tuple(f["requires"])) for f in found["functions"]
    ]
    coefficients = tuple(found["single"]), tuple(found["double"])
    entry = Entry(found["name"], found["module"], tuple(called), *coefficients, found["library"])
    try:
        held = (cache_folder() / entry.library).read_bytes()
    except OSError:
        return None
    return entry if entry.library == _library_name(name, held) else None


def write_entry(key: str, entry: Entry) -> None:
    """Keep an entry under that key; its library is in the cache already."""
    write_record(f"{entry.name}_{key}", asdict(entry))


def keep_library(name: str, build: Callable[[Path], Path]) -> str:
    """Put the library that `build` makes in a folder into the cache; its file name there.

    Raises:
        InputError: the cache cannot be written, or what `build` raises.
    """
    with workshop(folder_to_write(cache_folder())) as place:
        made = build(place)
        file = _library_name(name, made.read_bytes())
        made.replace(cache_folder() / file)
    return file


def read_record(name: str) -> dict[str, Any] | None:
    """What the cache holds under a name; None if that is nothing, or damaged."""
    try:
        code, _, text = (cache_folder() / f"{name}.json").read_text(encoding="utf-8").partition("\n")
    except (OSError, UnicodeDecodeError):
        return None
    return json.loads(text) if code == digest([text]) else None


def write_record(name: str, content: dict[str, Any]) -> None:
    """Keep what JSON can hold under a name.

    Raises:
        InputError: the cache cannot be written.
    """
    text = json.dumps(content)
    with workshop(folder_to_write(cache_folder())) as place:
        made = place / "record"
        made.write_text(f"{digest([text])}\n{text}", encoding="utf-8")
        made.replace(cache_folder() / f"{name}.json")


def _library_name(name: str, held: bytes) -> str:
    return f"{name}_{digest([held])}.so"
