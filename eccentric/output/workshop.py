"""A temporary folder beside the target, and what becomes of those that killed runs left."""

from __future__ import annotations

import os
import re
import secrets
import shutil
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from eccentric.errors import InputError
from eccentric.output.interrupts import held
from eccentric.output.locks import NoLocksError, lock, locked
from eccentric.output.swap import JOURNAL, MARKER, NEW, undo

_NAME = re.compile(rf"{re.escape(MARKER)}-[0-9a-f]{{16}}")
_LOCK = "lock"
_ABANDONED_S = 3600.0
"""Where there are no locks: age of a temporary folder that nobody holds. Writing takes seconds."""


@contextmanager
def workshop(place: Path) -> Iterator[Path]:
    """Yield an empty folder, inside a temporary one in `place` that is removed afterwards.

    `place` is created if necessary. What killed runs left there is removed, or put back if they were moving
    files.

    Raises:
        InputError: the folder cannot be created or written.
    """
    # The name is known before there is a folder, so that even an interrupt in between can remove it.
    own = _free(place)
    with ExitStack() as holding:
        try:
            try:
                place.mkdir(parents=True, exist_ok=True)
                own.mkdir(mode=0o700)
                while not _hold(own, holding):
                    # Another run has found the folder before it was locked, and removes it.
                    own = _free(place)
                    own.mkdir(mode=0o700)
                (own / NEW).mkdir()
                if any(other != own for other in _left(place)):
                    with alone(place):
                        tidy(place, own)
            except OSError as error:
                raise InputError(
                    f"{place}: a place that can be written is required ({error.strerror})"
                ) from error
            yield own / NEW
        finally:
            with held():
                _remove(own)


@contextmanager
def alone(place: Path) -> Iterator[None]:
    """Be the only run that moves sets of files into this folder; wait for others."""
    with locked(place / f"{MARKER}-{_LOCK}"):
        yield


def tidy(place: Path, own: Path) -> bool:
    """Remove temporary folders that nobody holds, all but our own, and undo what those runs had half done.

    The caller must be `alone` there. Returns whether another run is moving files here nevertheless, which
    only happens without locks.
    """
    busy = False
    for other in _left(place):
        if other != own:
            with ExitStack() as holding:
                if _is_abandoned(other, own, holding):
                    undo(place, other)
                    _remove(other)
                with suppress(PermissionError):  # another user's, whose files are not ours to move
                    busy |= (other / JOURNAL).exists()
    return busy


def _is_abandoned(other: Path, own: Path, holding: ExitStack) -> bool:
    """Whether nobody holds a temporary folder; then we hold it, if there are locks."""
    try:
        file = lock(other / _LOCK)
    except NoLocksError:
        return _age(own, other) > _ABANDONED_S
    except OSError:  # it belongs to another user, or is just being removed
        return False
    return file is not None and bool(holding.enter_context(file))


def _free(place: Path) -> Path:
    return place / f"{MARKER}-{secrets.token_hex(8)}"


def _hold(own: Path, holding: ExitStack) -> bool:
    """Lock our folder, if there are locks; False if it is already being removed."""
    try:
        file = lock(own / _LOCK)
    except NoLocksError:
        return True
    except FileNotFoundError:
        return False
    return file is not None and bool(holding.enter_context(file))


def _left(place: Path) -> list[Path]:
    names = (entry.name for entry in os.scandir(place) if entry.is_dir(follow_symlinks=False))
    return [place / name for name in sorted(names) if _NAME.fullmatch(name)]


def _age(own: Path, other: Path) -> float:
    """How much older a folder is than our own, s: both by the clock of their file system."""
    with suppress(OSError):
        times = [path.stat().st_mtime for path in (other, *other.rglob("*"))]
        return own.stat().st_mtime - max(times)
    return 0.0


def _remove(folder: Path) -> None:
    """Remove a temporary folder, unless it holds files that are to be put back."""
    if not (folder / JOURNAL).exists():
        shutil.rmtree(folder, ignore_errors=True)
