"""Advisory locks of files: they end with the process that holds them, however that ends."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import FileIO
from pathlib import Path

from eccentric.output.interrupts import held

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None


class NoLocksError(OSError):
    """This system, or this file system, has no locks."""


def lock(path: Path, *, wait: bool = False) -> FileIO | None:
    """Lock a file, which is created if necessary; closing what is returned ends the lock.

    None if somebody else holds it and we do not wait. Processes and threads exclude each other.

    Raises:
        NoLocksError: there are no locks here.
        OSError: the file cannot be created or opened.
    """
    if fcntl is None:
        raise NoLocksError
    while True:
        file = FileIO(path, "rb", opener=_opened)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            file.close()
            return None
        except OSError as error:
            file.close()
            raise NoLocksError(error.errno, error.strerror) from error
        # Whoever held it may have removed it meanwhile: then this would be a lock of nothing.
        if _is_at(path, file.fileno()):
            return file
        file.close()


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock of a file, which is removed afterwards; wait for others. Without locks: nothing."""
    try:
        file = lock(path, wait=True)
    except NoLocksError:
        file = None
    if file is None:
        yield
        return
    with file:
        try:
            yield
        finally:
            with held(), suppress(OSError):  # another user's, in a folder where only they may remove it
                path.unlink(missing_ok=True)


def _opened(path: str, _: int) -> int:
    plain = getattr(os, "O_NOFOLLOW", 0)
    try:
        # For writing: NFS turns an exclusive lock into one of bytes, which requires that.
        return os.open(path, os.O_RDWR | os.O_CREAT | plain, 0o644)
    except PermissionError:  # left by a killed run of another user
        return os.open(path, os.O_RDONLY | plain)


def _is_at(path: Path, file: int) -> bool:
    try:
        return os.path.samestat(path.lstat(), os.fstat(file))
    except FileNotFoundError:
        return False
