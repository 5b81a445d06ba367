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
from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from eccentric.core.errors import InputError
from eccentric.core.locks import NoLocksError, held, lock, locked

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
