"""The user's cache of derived and built results, in files that only the user may write.

Files are moved into the cache atomically. The first line is a digest of the rest, so a damaged file is
rebuilt. Cached code is executed, so a file that another user could have written is rebuilt too, and the
folder is private (mode 700). Where there are no owners and modes (Windows), the digest alone decides.

`Derived` stores results that depend only on the toolkit's sources, such as the model of a bundled
derivation, all in one file. It is read at the first lookup and written when the process ends.
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
from eccentric.core.errors import InputError, folder
from eccentric.core.transaction import workshop

OURS_ALONE = 0o700
"""Mode of the cache folder and the files in it."""
_LIBRARIES = ("sympy", "mpmath", "jinja2", "numpy")
_MOST_BYTES = 4 * 2**20
"""Most bytes of the derived results of a file; beyond, those of single logs, 0.5 MB each, are dropped."""


def digest(parts: Iterable[str | bytes]) -> str:
    """Digest of a sequence of texts; each is prefixed with its length, so boundaries matter."""
    code = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        code.update(f"{len(data)} ".encode() + data)
    return code.hexdigest()[:32]


def cache_folder() -> Path:
    """The toolkit's folder in the user's cache; it need not exist."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "eccentric"


def read_cached(file: str) -> bytes | None:
    """The content of a cached file; None if it is missing, damaged, or not the user's."""
    record = own_bytes(cache_folder() / file)
    if record is None:
        return None
    code, _, content = record.partition(b"\n")
    return content if code == digest([content]).encode() else None


def write_cached(file: str, content: bytes) -> None:
    """Store a file in the cache.

    Raises:
        InputError: the cache is not writable, or belongs to another user.
    """
    with workshop(own_cache()) as place:
        record = place / "record"
        record.write_bytes(digest([content]).encode() + b"\n" + content)
        record.chmod(OURS_ALONE)
        record.replace(cache_folder() / file)


def own_cache() -> Path:
    """The toolkit's private folder in the cache, created if necessary.

    Raises:
        InputError: it is not writable, or belongs to another user, who could replace executed code.
    """
    place = folder_to_write(cache_folder())
    place.mkdir(mode=OURS_ALONE, parents=True, exist_ok=True)
    if not _is_ours(place.stat()):
        raise InputError(
            "compile",
            problem=f"expected a cache of your own, but {place} belongs to another user: set XDG_CACHE_HOME",
        )
    if place.stat().st_mode & 0o077:
        with suppress(OSError):  # a disk without modes: files read from it are ignored
            place.chmod(OURS_ALONE)
    return place


def own_bytes(path: Path) -> bytes | None:
    """The content of a file; None if it is missing, or another user could have written it."""
    try:
        with path.open("rb") as file:
            for status in (path.parent.stat(), os.fstat(file.fileno())):
                if not _is_ours(status) or (os.name == "posix" and status.st_mode & 0o022):
                    return None
            return file.read()
    except OSError:
        return None


def _is_ours(status: os.stat_result) -> bool:
    return os.name != "posix" or status.st_uid == os.geteuid()


class Derived:
    """Results by key, as marshalled values, the format of Python's compiled files.

    The file name depends on the sources, the Python version and the libraries. Nothing is stored if a source
    file changed while this process ran: the running code is then not the code in the files.
    """

    def __init__(self) -> None:
        self._stored: dict[str, bytes] | None = None
        self._new: dict[str, bytes] = {}
        self._file, self._size = "", 0

    def get(self, key: str) -> bytes | None:
        """The result for a key; None if there is none."""
        if self._stored is None:
            try:
                self._file, is_steady = _file_of_sources()
                self._stored = self._read()
            except (OSError, RuntimeError, ImportError):  # an odd installation, a user without a home
                self._stored, is_steady = {}, False
            if is_steady:
                atexit.register(self._write)
        return self._new.get(key) or self._stored.get(key)

    def put(self, key: str, content: bytes) -> None:
        """Store a result; beyond the size limit, those before it are forgotten."""
        self._size += len(content)
        if self._size > _MOST_BYTES:
            self._new.clear()
            self._size = len(content)
        self._new[key] = content

    def _read(self) -> dict[str, bytes]:
        content = read_cached(self._file)
        return {} if content is None else marshal.loads(content)  # noqa: S302 - ours

    def _write(self) -> None:
        """Merge the new results with those stored by other processes meanwhile."""
        if not self._new:
            return
        with suppress(InputError, OSError, RuntimeError):
            stored = self._read()
            if sum(map(len, stored.values())) > _MOST_BYTES:  # all else belongs to single logs
                stored = {key: x for key, x in stored.items() if key.startswith(("model ", "template "))}
            write_cached(self._file, marshal.dumps(stored | self._new))
            others = (path for path in cache_folder().glob("*.derived") if path.name != self._file)
            for path in sorted(others, key=lambda path: path.stat().st_mtime)[:-2]:
                path.unlink(missing_ok=True)


derived = Derived()
"""Results that depend only on the toolkit's sources and the key."""


def _file_of_sources() -> tuple[str, bool]:
    """The results file for these sources, Python and libraries; whether none changed since our import."""
    stats = [(str(path), path.stat()) for path in _sources()]
    libraries = [f"{name} {version(name)}" for name in _LIBRARIES]
    texts = (f"{path} {stat.st_mtime_ns} {stat.st_size}" for path, stat in stats)
    # File time stamps come from a clock that may lag by some milliseconds.
    is_steady = max(stat.st_ctime for _, stat in stats) < import_time.imported_at - 0.05
    return f"{digest([sys.version, *libraries, *texts])}.derived", is_steady


def _sources() -> Iterator[Path]:
    yield from sorted(path for path in Path(__file__).parents[1].rglob("*.py") if path.name[0] != ".")
    yield from sorted(folder("derivations").glob("*.py"))
    yield from sorted(folder("templates").rglob("*.jinja"))
