"""File locks released when their process ends, and signals that terminate a run."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from io import FileIO
from pathlib import Path
from typing import Any

# Terminating signals raise exceptions, so that the run cleans up; they are deferred while files are moved.


# SIGINT last: `held` restores the handlers in this order, and that of SIGINT is the likeliest to raise.
_SIGNALS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGINT") if hasattr(signal, name))


class Ended(KeyboardInterrupt):
    """A terminating signal arrived. A KeyboardInterrupt, so that no handler of errors catches it.

    Attributes:
        number: the signal number.
    """

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.number = number


@contextmanager
def ended_by_signals(*, to_the_end: bool = False) -> Iterator[None]:
    """Within this block SIGTERM and SIGHUP raise `Ended` in the main thread.

    A signal that is ignored (nohup) or already handled keeps its handler. Does nothing in other threads.

    Args:
        to_the_end: the process ends with the block: after a signal, Ctrl-C is ignored, so that imported
            modules can clean up.
    """
    default = [n for n in _SIGNALS if signal.getsignal(n) is signal.SIG_DFL and n != signal.SIGINT]
    before = [(number, signal.SIG_DFL) for number in default] if _is_main() else []
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
    """Defer signals that would raise in this thread until the block ends.

    Handlers are replaced rather than signals masked: another thread may receive a signal, but its handler
    always runs in the main thread.
    """
    pending: list[int] = []

    def wait(number: int, _: object) -> None:
        pending.append(number)

    handlers = [(number, signal.getsignal(number)) for number in _SIGNALS] if _is_main() else []
    before = [(number, handler) for number, handler in handlers if callable(handler)]
    try:
        for number, _ in before:
            signal.signal(number, wait)
        yield
    finally:
        _give_back(before)
        for number in dict.fromkeys(pending):
            signal.raise_signal(number)


def _end(number: int, _: object) -> None:
    raise Ended(number)


def _is_main() -> bool:
    return threading.current_thread() is threading.main_thread()


def _give_back(before: Sequence[tuple[int, Callable[..., Any] | int]]) -> None:
    """Restore all handlers, even if a restored one raises at once."""
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
    """The operating system or file system does not support locks."""


def lock(path: Path, *, wait: bool = False) -> FileIO | None:
    """Lock a file, created if necessary; closing the returned file releases the lock.

    Returns None if it is already locked and `wait` is false. Excludes both processes and threads.

    Raises:
        NoLocksError: locks are not supported here.
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
        # The previous holder may have removed the file: the lock would then protect nothing.
        if _is_at(path, file.fileno()):
            return file
        file.close()


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Wait for and hold the lock of a file, which is removed afterwards. No effect without locks."""
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
    no_links = getattr(os, "O_NOFOLLOW", 0)
    try:
        # For writing: NFS implements an exclusive lock as a byte-range lock, which requires it.
        return os.open(path, os.O_RDWR | os.O_CREAT | no_links, 0o644)
    except PermissionError:  # left by a killed run of another user
        return os.open(path, os.O_RDONLY | no_links)


def _is_at(path: Path, file: int) -> bool:
    try:
        return os.path.samestat(path.lstat(), os.fstat(file))
    except FileNotFoundError:
        return False
