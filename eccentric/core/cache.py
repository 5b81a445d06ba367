"""The user's cache: what was derived or built once, in files that only the user may write.

A file is moved into the cache atomically. Its first line is the digest of the rest, so that a damaged file is
made again, as is one that somebody else could have written: what the cache contains is run. Its folder is the
user's alone (mode 700). Where there are no owners and modes (Windows), the digest alone decides.

`Derived` keeps results that follow from the sources of the toolkit alone, such as the model of a bundled
derivation, all in one file. They are read when first asked for, and written when the process ends.
"""

from __future__ import annotations

import atexit
import hashlib
import marshal
import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

from eccentric import import_time
from eccentric.core.atomic import folder_to_write
from eccentric.core.errors import InputError
from eccentric.core.places import folder
from eccentric.core.transaction import workshop

OURS_ALONE = 0o700
"""Mode of what is in the cache, and of its folder."""
_LIBRARIES = ("sympy", "mpmath", "jinja2", "numpy")
_MOST_BYTES = 4 * 2**20
"""Size of the file of derived results beyond which it begins anew; those of one log take 0.3 MB."""


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


def read_cached(file: str) -> bytes | None:
    """The content of a file in the cache; None if there is none, it is damaged, or another's."""
    found = own_bytes(cache_folder() / file)
    if found is None:
        return None
    code, _, content = found.partition(b"\n")
    return content if code == digest([content]).encode() else None


def write_cached(file: str, content: bytes) -> None:
    """Store a file in the cache.

    Raises:
        InputError: the cache cannot be written, or belongs to another user.
    """
    with workshop(own_cache()) as place:
        made = place / "record"
        made.write_bytes(digest([content]).encode() + b"\n" + content)
        made.chmod(OURS_ALONE)
        made.replace(cache_folder() / file)


def own_cache() -> Path:
    """Our folder in the cache, created if necessary, which nobody else may enter.

    Raises:
        InputError: it cannot be written, or belongs to another user, who could replace what is run.
    """
    place = folder_to_write(cache_folder())
    place.mkdir(mode=OURS_ALONE, parents=True, exist_ok=True)
    if not _is_ours(place.stat()):
        raise InputError(
            "compile",
            problem=f"expected a cache of your own, but {place} belongs to another user: set XDG_CACHE_HOME",
        )
    if place.stat().st_mode & 0o077:
        with suppress(OSError):  # a disk without modes: what is read there is not used
            place.chmod(OURS_ALONE)
    return place


def own_bytes(path: Path) -> bytes | None:
    """The content of a file; None if there is none, or somebody else may have written it."""
    try:
        with path.open("rb") as file:
            place, found = path.parent.stat(), os.fstat(file.fileno())
            for one in (place, found):
                if not _is_ours(one) or (os.name == "posix" and one.st_mode & 0o022):
                    return None
            return file.read()
    except OSError:
        return None


def _is_ours(found: os.stat_result) -> bool:
    return os.name != "posix" or found.st_uid == os.geteuid()


class Derived:
    """Results by key, as marshalled values: what Python's own compiled files contain.

    Those of other sources, another Python or other libraries are in a file of another name. Nothing is kept
    if a source was changed while this process ran: it runs other code than the files contain.
    """

    def __init__(self) -> None:
        self._found: dict[str, bytes] | None = None
        self._new: dict[str, bytes] = {}
        self._file, self._size = "", 0

    def get(self, key: str) -> bytes | None:
        """The result for a key; None if there is none."""
        if self._found is None:
            try:
                self._file, is_steady = _file_of_sources()
                self._found = self._read()
            except (OSError, RuntimeError, ImportError):  # an odd installation, a user without a home
                self._found, is_steady = {}, False
            if is_steady:
                atexit.register(self._write)
        return self._new.get(key) or self._found.get(key)

    def put(self, key: str, content: bytes) -> None:
        """Keep a result, as long as there are not too many."""
        self._size += len(content)
        if self._size < _MOST_BYTES:
            self._new[key] = content

    def _read(self) -> dict[str, bytes]:
        content = read_cached(self._file)
        return {} if content is None else marshal.loads(content)  # noqa: S302 - ours

    def _write(self) -> None:
        """Add the new results to what other processes have stored meanwhile."""
        if not self._new:
            return
        with suppress(InputError, OSError, RuntimeError):
            own = self._read()
            if sum(map(len, own.values())) > _MOST_BYTES:  # those of expressions are of single logs
                own = {key: x for key, x in own.items() if not key.startswith("expression")}
            write_cached(self._file, marshal.dumps(own | self._new))
            others = (path for path in cache_folder().glob("*.derived") if path.name != self._file)
            for path in sorted(others, key=lambda path: path.stat().st_mtime)[:-2]:
                path.unlink(missing_ok=True)


derived = Derived()
"""Results that follow from the sources of the toolkit and the key alone."""


def _file_of_sources() -> tuple[str, bool]:
    """The file of results for these sources, Python and libraries; whether no source is newer than us."""
    found = [(str(path), path.stat()) for path in _sources()]
    libraries = [f"{name} {version(name)}" for name in _LIBRARIES]
    texts = (f"{path} {stat.st_mtime_ns} {stat.st_size}" for path, stat in found)
    # A file's time stamp comes from a clock that may lag by some milliseconds.
    is_steady = max(stat.st_ctime for _, stat in found) < import_time.imported_at - 0.05
    return f"{digest([sys.version, *libraries, *texts])}.derived", is_steady


def _sources() -> Iterator[Path]:
    yield from sorted(path for path in Path(__file__).parents[1].rglob("*.py") if path.name[0] != ".")
    yield from sorted(folder("derivations").glob("*.py"))
    yield from sorted(folder("templates").rglob("*.jinja"))
