"""Output appears whole or not at all: it is written beside its target and moved there on success.

What is printed may be read in part: a reader that leaves is no error.
"""

import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from eccentric.errors import InputError

__all__ = [
    "MARKER",
    "UNREAD",
    "folder_to_write",
    "nobody_reads",
    "own_folder",
    "show",
    "whole_file",
    "whole_folder",
]

MARKER = ".eccentric"
UNREAD = 141
"""Exit status of a program whose reader has left: that of one that SIGPIPE ends, 128 + 13."""
_NOTICE = "Written by eccentric. The command beside a file replaces it when it runs again; all others stay."


def show(what: object) -> None:
    """Print; if the reader of a pipe has left, end the program quietly with status 141."""
    try:
        print(what, flush=True)
    except BrokenPipeError:
        nobody_reads()
        sys.exit(UNREAD)


def nobody_reads() -> None:
    """Let stdout go nowhere: the interpreter flushes it once more at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def folder_to_write(path: str | os.PathLike[str]) -> Path:
    """Return the absolute path of a folder that is there, or that can be made.

    Raises:
        InputError: it is a file, or lies below one, or its place cannot be written.
    """
    target = Path(path).resolve()
    if target.exists() and not target.is_dir():
        raise InputError(f"{Path(path)}: required a folder to write; received a file")
    there = next(place for place in (target, *target.parents) if place.exists())
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        what = "is protected" if there.is_dir() else "is a file"
        raise InputError(f"{Path(path)}: required a place that can be written; {there} {what}")
    return target


def own_folder(path: str | os.PathLike[str]) -> Path:
    """Return the absolute path of a folder that `whole_folder` may write: for asking before a long run.

    Raises:
        InputError: as `folder_to_write`; or it holds files and no `.eccentric`; or it is the working
            directory, or holds that.
    """
    target = folder_to_write(path)
    if Path.cwd().is_relative_to(target):
        what = "the working directory" if Path.cwd() == target else "one with the working directory in it"
        raise InputError(f"{Path(path)}: required a folder of its own for the output; received {what}")
    if target.is_dir() and any(target.iterdir()) and not (target / MARKER).is_file():
        raise InputError(
            f"{Path(path)}: required a new or empty folder, or one that eccentric wrote (it holds {MARKER});"
            " received a folder with other files"
        )
    return target


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
def whole_folder(path: str | os.PathLike[str], command: str) -> Iterator[Path]:
    """Yield an empty folder to write to; its files appear in `path` when the block ends without an exception.

    A hidden file `.eccentric` lists there what was written by which command. When the same command writes
    again, its new files take the place of all that it wrote before; files of other commands and of others
    stay. After any exception, an interrupt included, `path` is what it was.

    Raises:
        InputError: `own_folder` refuses the path; or a file of another command, or of someone else, has the
            name of a new one; or it cannot be written.
    """
    target = own_folder(path)
    with _workshop(target) as workshop:
        new = workshop / target.name
        new.mkdir()
        yield new
        written = dict.fromkeys(_files(new), command)
        if target.is_dir():
            listed = _listed(target)
            kept = {name for name in _files(target) if listed.get(name) != command}
            if clash := sorted(kept & written.keys()):
                wrote = listed.get(clash[0])
                owner = f"`eccentric {wrote}` wrote" if wrote else "eccentric did not write"
                raise InputError(f"{path}: required to be free: {clash[0]}; received a file that {owner}")
            for name in kept:
                (new / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(target / name, new / name, follow_symlinks=False)
            written |= {name: owner for name, owner in listed.items() if name in kept}
        lines = [f"{owner}: {name}" for name, owner in sorted(written.items())]
        (new / MARKER).write_text("\n".join([_NOTICE, *lines]) + "\n", encoding="utf-8")
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


def _listed(folder: Path) -> dict[str, str]:
    """What the marker lists, name -> command that wrote it; nothing without a marker."""
    marker = folder / MARKER
    lines = marker.read_text(encoding="utf-8").splitlines()[1:] if marker.is_file() else []
    return {name: command for command, _, name in (line.partition(": ") for line in lines)}
