"""Replace one set of files by another, all or none, even if the process is killed halfway.

A file system moves one file at a time. So a journal first lists the moves; then the old files are moved to
the staging area's folder `old`, and only then the new ones into the target: files of two runs are never
mixed. Removing the journal commits the new set. If the journal remains, because the process was killed or a
move failed, `undo` restores the old set; it may itself be killed and repeated.
"""

from __future__ import annotations

import json
import os
import re
import secrets
import shutil
import signal
import threading
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from io import FileIO
from pathlib import Path
from typing import Any

from eccentric.core.errors import InputError

# File locks released when their process ends, and signals that terminate a run.


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


MARKER = ".eccentric"
NEW, OLD, JOURNAL = "new", "old", "journal"
"""In a staging area: the new files, the old ones, and the list of moves in progress."""


def swap(target: Path, staging: Path, gone: Collection[str] = ()) -> None:
    """Move the new files of a staging area to the target, and move out those replaced or `gone` (obsolete).

    A new marker replaces the old one atomically, since it identifies the folder. Folders that are then empty
    are removed. Signals are deferred until the end.

    Raises:
        OSError: a file cannot be moved; the target is unchanged.
    """
    new, old = staging / NEW, staging / OLD
    names = sorted(files(new))
    leaving = [name for name in (*names, *sorted(gone)) if stands(target / name)]
    folders = {folder for name in names for folder in Path(name).parents}
    made = [str(folder) for folder in sorted(folders) if not stands(target / folder)]
    marked = stands(new / MARKER)
    fresh = marked and not stands(target / MARKER)
    plan = {"names": names, "leaving": leaving, "made": made, "fresh": fresh}
    for name in leaving:
        (old / name).parent.mkdir(parents=True, exist_ok=True)
    if marked and not fresh:
        old.mkdir(exist_ok=True)
        shutil.copy2(target / MARKER, old / MARKER)
    (staging / "plan").write_text(json.dumps(plan), encoding="utf-8")
    with held():
        try:
            (staging / "plan").replace(staging / JOURNAL)
            if marked:
                (new / MARKER).replace(target / MARKER)
            for name in leaving:
                (target / name).replace(old / name)
            for folder in made:
                (target / folder).mkdir()
            for name in names:
                (new / name).replace(target / name)
        except BaseException:
            undo(target, staging)
            raise
        (staging / JOURNAL).unlink()
        emptied = {folder for name in gone for folder in Path(name).parents} - {Path()}
        for folder in sorted(emptied, reverse=True):
            with suppress(OSError):  # not empty
                (target / folder).rmdir()


def undo(target: Path, staging: Path) -> None:
    """Restore the target to its state before `swap`; no effect without a journal.

    Raises:
        OSError: a file cannot be moved; the journal stays, for the next attempt.
    """
    new, old, journal = staging / NEW, staging / OLD, staging / JOURNAL
    if not journal.exists():
        return
    with held():
        plan = json.loads(journal.read_text(encoding="utf-8"))
        for name in plan["names"]:
            if not stands(new / name) and stands(target / name):
                (target / name).replace(new / name)
        for folder in reversed(plan["made"]):
            with suppress(OSError):  # somebody has put a file there
                (target / folder).rmdir()
        for name in plan["leaving"]:
            if stands(old / name):
                (target / name).parent.mkdir(parents=True, exist_ok=True)
                (old / name).replace(target / name)
        if stands(old / MARKER):
            (old / MARKER).replace(target / MARKER)
        elif plan["fresh"]:
            (target / MARKER).unlink(missing_ok=True)
        journal.unlink()


def files(folder: Path) -> set[str]:
    """Names of all files below `folder`, relative to it, without the marker."""
    paths = (path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir())
    return {path.relative_to(folder).as_posix() for path in paths} - {MARKER}


def stands(path: Path) -> bool:
    """Whether the path exists, including a dangling link."""
    return os.path.lexists(path)


def is_folder(path: Path) -> bool:
    """Whether it is a folder and not a link to one, which leads outside ours."""
    return path.is_dir() and not path.is_symlink()


# Staging areas: temporary folders next to the target, and recovery of those left by killed runs.


_NAME = re.compile(rf"{re.escape(MARKER)}-[0-9a-f]{{16}}")
_LOCK = "lock"
_ABANDONED_S = 3600.0
"""Without locks: age at which a staging area counts as abandoned. Writing takes seconds."""


@contextmanager
def workshop(place: Path) -> Iterator[Path]:
    """Yield an empty folder, inside a temporary one in `place` that is removed afterwards.

    `place` is created if necessary. Staging areas of killed runs are removed, after restoring the files
    that were being moved.

    Raises:
        InputError: the folder cannot be created or written.
    """
    # The name is chosen before the folder is created, so that an interrupt in between can still remove it.
    staging = _free(place)
    with ExitStack() as holding:
        try:
            try:
                place.mkdir(parents=True, exist_ok=True)
                staging.mkdir(mode=0o700)
                while not _hold(staging, holding):
                    # Another run saw the folder before it was locked, and removes it.
                    staging = _free(place)
                    staging.mkdir(mode=0o700)
                (staging / NEW).mkdir()
                if any(other != staging for other in _staging_areas(place)):
                    with alone(place):
                        tidy(place, staging)
            except OSError as error:
                raise InputError(
                    place, problem=f"expected a place that can be written ({error.strerror})"
                ) from error
            yield staging / NEW
        finally:
            with held():
                _remove(staging)


@contextmanager
def alone(place: Path) -> Iterator[None]:
    """Wait for and hold the right to move sets of files into this folder."""
    with locked(place / f"{MARKER}-{_LOCK}"):
        yield


def tidy(place: Path, staging: Path) -> bool:
    """Remove all abandoned staging areas but our own, and undo their unfinished moves.

    The caller must hold `alone`. Returns whether another run is moving files here nevertheless, which only
    happens without locks.
    """
    busy = False
    for other in _staging_areas(place):
        if other != staging:
            with ExitStack() as holding:
                if _is_abandoned(other, staging, holding):
                    undo(place, other)
                    _remove(other)
                with suppress(PermissionError):  # another user's files are not ours to move
                    busy |= (other / JOURNAL).exists()
    return busy


def _is_abandoned(other: Path, staging: Path, holding: ExitStack) -> bool:
    """Whether a staging area is abandoned; if so, lock it where locks exist."""
    try:
        file = lock(other / _LOCK)
    except NoLocksError:
        return _age(staging, other) > _ABANDONED_S
    except OSError:  # it belongs to another user, or is just being removed
        return False
    return file is not None and bool(holding.enter_context(file))


def _free(place: Path) -> Path:
    return place / f"{MARKER}-{secrets.token_hex(8)}"


def _hold(staging: Path, holding: ExitStack) -> bool:
    """Lock our staging area where locks exist; False if it is already being removed."""
    try:
        file = lock(staging / _LOCK)
    except NoLocksError:
        return True
    except FileNotFoundError:
        return False
    return file is not None and bool(holding.enter_context(file))


def _staging_areas(place: Path) -> list[Path]:
    names = (entry.name for entry in os.scandir(place) if entry.is_dir(follow_symlinks=False))
    return [place / name for name in sorted(names) if _NAME.fullmatch(name)]


def _age(staging: Path, other: Path) -> float:
    """Age of a folder relative to ours [s], by the clock of the file system."""
    with suppress(OSError):
        times = [path.stat().st_mtime for path in (other, *other.rglob("*"))]
        return staging.stat().st_mtime - max(times)
    return 0.0


def _remove(folder: Path) -> None:
    """Remove a staging area, unless it contains files to restore."""
    if not (folder / JOURNAL).exists():
        shutil.rmtree(folder, ignore_errors=True)
