"""A set of files in the place of another: all or none, also if the process is killed in the middle.

A file system moves one file at a time. So a journal says first what will be moved; then the old files leave
for the folder `old` of the workshop, and only when all are gone the new ones come in: at no time do files of
two runs lie side by side. Removing the journal is what makes the new set final. If it is still there, because
the process was killed or a move failed, `undo` puts the old set back; it may itself be killed and repeated.
"""

from __future__ import annotations

import json
import os
import re
import secrets
import shutil
from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from eccentric.core.errors import InputError
from eccentric.core.locks import NoLocksError, held, lock, locked

MARKER = ".eccentric"
NEW, OLD, JOURNAL = "new", "old", "journal"
"""In a workshop: the new files, the old ones, and which of them are being moved."""


def swap(target: Path, own: Path, gone: Collection[str] = ()) -> None:
    """Move the files of a workshop's `new` to the target, and out of it what they replace and what is `gone`.

    The marker is replaced by the new one, if there is one, without a moment without it: it says whose folder
    this is. Folders that are then empty are removed. Signals wait until the end.

    Raises:
        OSError: a file cannot be moved; the target is unchanged.
    """
    new, old = own / NEW, own / OLD
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
    (own / "plan").write_text(json.dumps(plan), encoding="utf-8")
    with held():
        try:
            (own / "plan").replace(own / JOURNAL)
            if marked:
                (new / MARKER).replace(target / MARKER)
            for name in leaving:
                (target / name).replace(old / name)
            for folder in made:
                (target / folder).mkdir()
            for name in names:
                (new / name).replace(target / name)
        except BaseException:
            undo(target, own)
            raise
        (own / JOURNAL).unlink()
        emptied = {folder for name in gone for folder in Path(name).parents} - {Path()}
        for folder in sorted(emptied, reverse=True):
            with suppress(OSError):  # not empty
                (target / folder).rmdir()


def undo(target: Path, own: Path) -> None:
    """Put back what was in the target before a workshop's files were moved there; nothing without a journal.

    Raises:
        OSError: a file cannot be moved; the journal stays, for the next attempt.
    """
    new, old, journal = own / NEW, own / OLD, own / JOURNAL
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
    """Names of all files below `folder`, relative to it; the marker excluded."""
    paths = (path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir())
    return {path.relative_to(folder).as_posix() for path in paths} - {MARKER}


def stands(path: Path) -> bool:
    """Whether there is anything with this name, including a dangling link."""
    return os.path.lexists(path)


def is_folder(path: Path) -> bool:
    """Whether it is a folder itself: a link leads outside our folder."""
    return path.is_dir() and not path.is_symlink()


# A temporary folder beside the target, and what becomes of those that killed runs left.


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
                    place, problem=f"expected a place that can be written ({error.strerror})"
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
