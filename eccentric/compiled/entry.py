"""What the cache stores for a model: its shared library, and all that is needed to call it from Python.

A file is moved into the cache atomically, under a name derived from its sources or from its content. So
processes that write at the same time write the same, and a damaged file is built again.

What the cache holds is run. So its folder is the user's alone (mode 700), and a file is used only if it
belongs to the user, nobody else may write it, and its digest is right; otherwise it is built again. Where
there are no owners and modes (Windows), the digest alone decides.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from eccentric.errors import InputError
from eccentric.output import folder_to_write, workshop

_OURS_ALONE = 0o700
"""Mode of what is in the cache, and of its folder."""


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


def digest(parts: Iterable[str | bytes]) -> str:
    """The digest of texts, which depends on where each of them ends."""
    code = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        code.update(f"{len(data)} ".encode() + data)
    return code.hexdigest()[:32]


def cache_folder() -> Path:
    """Our folder in the user's cache; it need not exist."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "eccentric"


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
    held = _own_bytes(cache_folder() / entry.library)
    return entry if held is not None and entry.library == _library_name(name, held) else None


def write_entry(key: str, entry: CacheEntry) -> None:
    """Store an entry for that key; its library is already in the cache."""
    write_record(f"{entry.name}_{key}", asdict(entry))


def keep_library(name: str, build: Callable[[Path], Path]) -> str:
    """Move the library that `build` makes in a folder into the cache; return its file name there.

    Raises:
        InputError: the cache cannot be written, or what `build` raises.
    """
    with workshop(_own_folder()) as place:
        made = build(place)
        file = _library_name(name, made.read_bytes())
        made.chmod(_OURS_ALONE)
        made.replace(cache_folder() / file)
    return file


def read_record(name: str) -> dict[str, Any] | None:
    """The content of the cache for a name; None if there is none, or it is damaged."""
    held = _own_bytes(cache_folder() / f"{name}.json")
    if held is None:
        return None
    code, _, text = held.partition(b"\n")
    return json.loads(text) if code == digest([text]).encode() else None


def write_record(name: str, content: dict[str, Any]) -> None:
    """Store a JSON document for a name.

    Raises:
        InputError: the cache cannot be written.
    """
    text = json.dumps(content)
    with workshop(_own_folder()) as place:
        made = place / "record"
        made.write_text(f"{digest([text])}\n{text}", encoding="utf-8")
        made.chmod(_OURS_ALONE)
        made.replace(cache_folder() / f"{name}.json")


def _own_folder() -> Path:
    """Our folder in the cache, created if necessary, which nobody else may enter.

    Raises:
        InputError: it cannot be written, or belongs to another user, who could replace what is run.
    """
    folder = folder_to_write(cache_folder())
    folder.mkdir(mode=_OURS_ALONE, parents=True, exist_ok=True)
    if not _is_ours(folder.stat()):
        raise InputError(
            f"compile: a cache of your own is required, {folder} belongs to another user: set XDG_CACHE_HOME"
        )
    if folder.stat().st_mode & 0o077:
        with suppress(OSError):  # a disk without modes: what is read there is not used
            folder.chmod(_OURS_ALONE)
    return folder


def _own_bytes(path: Path) -> bytes | None:
    """The content of a file; None if there is none, or somebody else may have written it."""
    try:
        with path.open("rb") as file:
            folder, found = path.parent.stat(), os.fstat(file.fileno())
            for one in (folder, found):
                if not _is_ours(one) or (os.name == "posix" and one.st_mode & 0o022):
                    return None
            return file.read()
    except OSError:
        return None


def _is_ours(found: os.stat_result) -> bool:
    return os.name != "posix" or found.st_uid == os.geteuid()


def _library_name(name: str, held: bytes) -> str:
    return f"{name}_{digest([held])}.so"
