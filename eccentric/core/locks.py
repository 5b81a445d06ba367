"""Locks of files that end with their process, and signals that end a run."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from io import FileIO
from pathlib import Path
from typing import Any

# Signals that end a run: exceptions, so that it cleans up, and held back while files are moved.


# SIGINT last: `held` gives the handlers back in this order, and that of SIGINT is the one that raises most.
_SIGNALS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGINT") if hasattr(signal, name))


class Ended(KeyboardInterrupt):
    """A signal asks the run to end. It is an interrupt, so that nothing mistakes it for an error.

    Attributes:
        number: of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.number = number


@contextmanager
def ended_by_signals(*, to_the_end: bool = False) -> Iterator[None]:
    """Let SIGTERM and SIGHUP raise `Ended` in the main thread, in this block.

    One that is ignored (nohup) or handled by somebody else stays so. Does nothing in other threads.

    Args:
        to_the_end: the process ends with the block, and what it has imported may still have to clean up:
            after a signal, Ctrl-C is ignored from then on.
    """
    quiet = [n for n in _SIGNALS if signal.getsignal(n) is signal.SIG_DFL and n != signal.SIGINT]
    before = [(number, signal.SIG_DFL) for number in quiet] if _is_main() else []
    try:
        for number, _ in before:
            signal.signal(number, _end)
        yield
    except KeyboardInterrupt:
        if to_the_end and _is_main():
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        raise
    finally:
        _give_back(before)


@contextmanager
def held() -> Iterator[None]:
    """Let signals that would raise in this thread wait until the end of the block.

    Handlers are replaced instead of masking the signals: another thread may receive them, and its handler
    runs in the main thread all the same.
    """
    came: list[int] = []

    def wait(number: int, _: object) -> None:
        came.append(number)

    handlers = [(number, signal.getsignal(number)) for number in _SIGNALS] if _is_main() else []
    before = [(number, handler) for number, handler in handlers if callable(handler)]
    try:
        for number, _ in before:
            signal.signal(number, wait)
        yield
    finally:
        _give_back(before)
        for number in dict.fromkeys(came):
            signal.raise_signal(number)


def _end(number: int, _: object) -> None:
    raise Ended(number)


def _is_main() -> bool:
    return threading.current_thread() is threading.main_thread()


def _give_back(before: Sequence[tuple[int, Callable[..., Any] | int]]) -> None:
    """Restore the handlers, all of them even if one that is restored raises at once."""
    if before:
        (number, handler), *rest = before
        try:
            signal.signal(number, handler)
        finally:
            _give_back(rest)


try:
    import fcntl
except ImportError:  # Windows
    fcntl = None


# Locks.


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
