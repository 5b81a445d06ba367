"""Output appears whole or not at all: it is written beside its target and moved there on success."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from eccentric.errors import InputError

__all__ = ["MARKER", "whole_file", "whole_folder"]

MARKER = ".eccentric"
_NOTICE = "Written by eccentric. The next run replaces the files listed here and keeps all others."


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a path to write to; the file replaces `path` when the block ends without an exception.

    The temporary file has the target's own name, so that a suffix (`.csv.gz`, `.svg`) means what it says.
    Missing parent folders are made. After any exception, an interrupt included, `path` is what it was.

    Raises:
        InputError: `path` is there and is not a regular file, or its folder cannot be written.
    """
    target = Path(path).resolve()
    if target.exists() and not target.is_file():
        raise InputError(f"{path}: required a file to write; received something that is not a regular file")
    with _workshop(target) as workshop:
        new = workshop / target.name
        yield new
        new.replace(target)


@contextmanager
def whole_folder(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield an empty folder to write to; it replaces `path` when the block ends without an exception.

    A hidden file `.eccentric` in the folder lists what was written. A later run replaces those files, also
    the ones it does not write again, and keeps files that someone else has added.
    After any exception, an interrupt included, `path` is what it was.

    Raises:
        InputError: `path` is a file; or a folder that holds files and no `.eccentric`; or holds an added file
            of the same name as a new one; or is the working directory or above it; or cannot be written.
    """
    target = Path(path).resolve()
    if target.exists() and not target.is_dir():
        raise InputError(f"{path}: required a folder to write; received a file")
    if Path.cwd().is_relative_to(target):
        raise InputError(f"{path}: required a folder that can be replaced; received the working directory")
    if target.is_dir() and any(target.iterdir()) and not (target / MARKER).is_file():
        raise InputError(
            f"{path}: required a new or empty folder, or one that eccentric wrote (it holds {MARKER});"
            " received a folder with other files"
        )
    with _workshop(target) as workshop:
        new = workshop / target.name
        new.mkdir()
        yield new
        written = _files(new)
        if target.is_dir():
            added = _files(target) - set(_listed(target))
            if clash := sorted(added & written):
                raise InputError(f"{path}: required to be free: {clash[0]}; received a file not written here")
            for name in added:
                (new / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(target / name, new / name, follow_symlinks=False)
        (new / MARKER).write_text("\n".join([_NOTICE, *sorted(written)]) + "\n", encoding="utf-8")
        _swap(new, target, workshop / "old")


def _swap(new: Path, target: Path, old: Path) -> None:
    """Put `new` in the place of `target`, which goes to `old`, and put it back if that fails."""
    if not target.is_dir():
        new.rename(target)
        return
    # Two renames, since no portable call exchanges folders; a power cut between them leaves both on disk.
    target.rename(old)
    try:
        new.rename(target)
    except BaseException:
        old.rename(target)
        raise


@contextmanager
def _workshop(target: Path) -> Iterator[Path]:
    """Yield a temporary folder beside `target`, hence on the same file system, and remove it afterwards."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        workshop = TemporaryDirectory(dir=target.parent, prefix=f".{target.name}-")
    except OSError as error:
        raise InputError(f"{target}: required a place that can be written; {error.strerror}") from error
    with workshop as name:
        yield Path(name)


def _files(folder: Path) -> set[str]:
    """Names of all files below `folder`, relative to it, the marker excluded."""
    paths = (path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir())
    return {path.relative_to(folder).as_posix() for path in paths} - {MARKER}


def _listed(folder: Path) -> list[str]:
    """Names that the marker of an earlier run lists; none without a marker."""
    marker = folder / MARKER
    return marker.read_text(encoding="utf-8").splitlines()[1:] if marker.is_file() else []
