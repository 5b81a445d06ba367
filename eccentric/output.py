"""Output is atomic: it is written to a temporary place on the same file system and moved on success.

Printed output may be read in part: a reader that closes the pipe is not an error.
"""

import io
import os
import secrets
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from eccentric.errors import InputError
from eccentric.places import given_path

__all__ = [
    "MARKER",
    "UNREAD",
    "escape_unprintable",
    "folder_to_write",
    "nobody_reads",
    "own_folder",
    "show",
    "whole_file",
    "whole_folder",
    "workshop",
]

MARKER = ".eccentric"
UNREAD = 141
"""Exit status of a program whose reader has closed the pipe, as if ended by SIGPIPE: 128 + 13."""
_NOTICE = "Written by eccentric. The command beside a file replaces it on its next run; other files stay."


def escape_unprintable() -> None:
    """Let stdout print characters that its encoding lacks as escapes, as stderr does: an ASCII terminal."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def show(what: object) -> None:
    """Print; if the reader of a pipe has closed it, exit quietly with status 141."""
    escape_unprintable()
    try:
        print(what, flush=True)
    except BrokenPipeError:
        nobody_reads()
        sys.exit(UNREAD)


def nobody_reads() -> None:
    """Discard stdout: the interpreter flushes it again at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def folder_to_write(path: str | os.PathLike[str]) -> Path:
    """Return the absolute path of a folder that exists or can be created.

    Raises:
        InputError: it is a file, or is below one, or its parent cannot be written.
    """
    target = given_path(path, "output").resolve()
    if target.exists() and not target.is_dir():
        raise InputError(f"{Path(path)}: a folder to write is required, received a file")
    there = next(place for place in (target, *target.parents) if place.exists())
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        what = "is protected" if there.is_dir() else "is a file"
        raise InputError(f"{Path(path)}: a place that can be written is required, {there} {what}")
    return target


def own_folder(path: str | os.PathLike[str]) -> Path:
    """Return the absolute path of a folder that `whole_folder` may write: a check before a long run.

    Raises:
        InputError: as `folder_to_write`; or it holds files and no `.eccentric`, or one that cannot be read;
            or it is the working directory, or holds that.
    """
    target = folder_to_write(path)
    if Path.cwd().is_relative_to(target):
        what = "the working directory" if Path.cwd() == target else "one with the working directory in it"
        raise InputError(
            f"{Path(path)}: a folder of its own for the output is required, such as build/out,"
            f" received {what}"
        )
    # Leftovers of a killed run are harmless.
    there = target.is_dir() and any(not f.name.startswith(f"{MARKER}-") for f in target.iterdir())
    if there and not (target / MARKER).is_file():
        raise InputError(
            f"{Path(path)}: a new or empty folder, or one that eccentric wrote (it holds {MARKER}), is"
            " required, received a folder with other files"
        )
    _listed(target)
    return target


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a path to write to; the file replaces `path` when the block ends without an exception.

    The temporary file has the target's own name, so that its suffix (`.csv.gz`, `.svg`) takes effect.
    Missing parent folders are created. After any exception, including an interrupt, `path` is unchanged.

    Raises:
        InputError: `path` exists and is not a regular file, or its folder cannot be written.
    """
    target = given_path(path, "output").resolve()
    if target.exists() and not target.is_file():
        raise InputError(f"{path}: a file to write is required, received one that is not a regular file")
    with workshop(target.parent) as place:
        new = place / target.name
        yield new
        new.replace(target)


@contextmanager
def whole_folder(path: str | os.PathLike[str], command: str) -> Iterator[Path]:
    """Yield an empty folder to write to; its files appear in `path` when the block ends without an exception.

    A hidden file `.eccentric` lists there which command wrote what. When the same command writes again, its
    new files replace everything it wrote before; anything else there is not touched. After any exception,
    including an interrupt, `path` is unchanged.

    Raises:
        InputError: `own_folder` refuses the path; or a file of another command, or one that eccentric did not
            write, is in the place of a new file or its folder; or it cannot be written.
    """
    target = own_folder(path)
    if not target.exists():
        with workshop(target.parent) as place:
            new = place / target.name
            new.mkdir()
            yield new
            _mark(new, dict.fromkeys(_files(new), command))
            new.rename(target)
        return
    # In the folder itself: the same file system, and writable even if its parent is not.
    with workshop(target) as place:
        new, old = place / "new", place / "old"
        new.mkdir()
        yield new
        names, there, listed = _files(new), _files(target), _listed(target)
        for name in sorted(names):
            _require_free(Path(path), name, listed, command)
        owned = {name: owner for name, owner in listed.items() if name in there}
        gone = {name for name, owner in owned.items() if owner == command} - names
        kept = {name: owner for name, owner in owned.items() if owner != command}
        _mark(new, kept | dict.fromkeys(names, command))
        _replace(target, new, old, sorted(gone))


def _require_free(folder: Path, name: str, listed: dict[str, str], command: str) -> None:
    """Raise InputError if writing a file with this name would destroy another one."""
    *above, _ = Path(name).parents
    blocked = next((f for f in reversed(above) if _stands(folder / f) and not _is_folder(folder / f)), None)
    place = Path(name) if blocked is None else blocked
    taken = folder / place
    if _stands(taken) and (blocked or _is_folder(taken) or listed.get(name) != command):
        wrote = listed.get(place.as_posix())
        owner = f"`eccentric {wrote}` wrote" if wrote else "eccentric did not write"
        what = "a folder" if _is_folder(taken) else f"a file that {owner}"
        raise InputError(f"{folder}: a free name {place.as_posix()} is required, received {what}")


def _replace(target: Path, new: Path, old: Path, gone: list[str]) -> None:
    """Move the files of `new` to `target`, remove those that are `gone`; if that fails, undo it.

    What they replace is copied to `old` first. The marker is moved first: if the process is killed between
    two files, each of them is complete, and those that this run writes are listed.
    """
    names = [MARKER, *sorted(_files(new))]
    folders = {folder for name in names for folder in Path(name).parents}
    made = [folder for folder in sorted(folders) if not _stands(target / folder)]
    for name in (*names, *gone):
        if _stands(target / name):
            (old / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(target / name, old / name, follow_symlinks=False)
    try:
        for folder in made:
            (target / folder).mkdir()
        for name in names:
            (new / name).replace(target / name)
        for name in gone:
            (target / name).unlink()
        for folder in sorted({folder for name in gone for folder in Path(name).parents}, reverse=True)[:-1]:
            if not any((target / folder).iterdir()):
                (target / folder).rmdir()
    except BaseException:
        for name in (*names, *gone):
            if _stands(old / name):
                (target / name).parent.mkdir(parents=True, exist_ok=True)
                (old / name).replace(target / name)
            elif not _stands(new / name):
                (target / name).unlink()
        for folder in reversed(made):
            if _stands(target / folder):
                (target / folder).rmdir()
        raise


@contextmanager
def workshop(place: Path) -> Iterator[Path]:
    """Yield a temporary folder in a folder, which is created if necessary, and remove it afterwards.

    Its name is known before it is created, so that even an interrupt in between can remove it.

    Raises:
        InputError: the folder cannot be created or written.
    """
    own = place / f"{MARKER}-{secrets.token_hex(8)}"
    try:
        try:
            place.mkdir(parents=True, exist_ok=True)
            own.mkdir(mode=0o700)
        except OSError as error:
            raise InputError(
                f"{place}: a place that can be written is required ({error.strerror})"
            ) from error
        yield own
    finally:
        shutil.rmtree(own, ignore_errors=True)


def _files(folder: Path) -> set[str]:
    """Names of all files below `folder`, relative to it, the marker excluded."""
    paths = (path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir())
    return {path.relative_to(folder).as_posix() for path in paths} - {MARKER}


def _stands(path: Path) -> bool:
    """Whether there is anything with this name, including a dangling link."""
    return os.path.lexists(path)


def _is_folder(path: Path) -> bool:
    """Whether it is a folder itself: a link leads outside our folder."""
    return path.is_dir() and not path.is_symlink()


def _mark(folder: Path, written: dict[str, str]) -> None:
    """Write the marker of a folder: name -> command that wrote it."""
    lines = [_NOTICE, *(f"{command}: {name}" for name, command in sorted(written.items()))]
    (folder / MARKER).write_text("\n".join(lines) + "\n", encoding="utf-8")


def _listed(folder: Path) -> dict[str, str]:
    """What the marker lists, name -> command that wrote it; nothing without a marker.

    Raises:
        InputError: it is not UTF-8 text, or cannot be read.
    """
    marker = folder / MARKER
    try:
        lines = marker.read_text(encoding="utf-8").splitlines()[1:] if marker.is_file() else []
    except UnicodeDecodeError as error:
        place = f"byte {error.start} is not"
        raise InputError(f"{marker}: UTF-8 text as eccentric wrote it is required, {place}") from None
    except OSError as error:
        raise InputError(f"{marker}: a file that can be read is required ({error.strerror})") from None
    return {name: command for command, _, name in (line.partition(": ") for line in lines)}
