"""What is written: one file, a set of files, or a folder of a command's files. All of it, or nothing."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from eccentric.core.errors import InputError
from eccentric.core.places import given_path
from eccentric.core.transaction import MARKER, alone, files, is_folder, stands, swap, tidy, workshop

# Which folder may be written, and which command wrote what there: the hidden file `.eccentric` lists it.


_NOTICE = "Written by eccentric. The command beside a file replaces it on its next run; other files stay."


def folder_to_write(path: str | os.PathLike[str]) -> Path:
    """Return the absolute path of a folder that exists or can be created.

    Raises:
        InputError: it is a file, or is below one, or its parent cannot be written.
    """
    target = given_path(path, "output").resolve()
    if target.exists() and not target.is_dir():
        raise InputError(Path(path), "a folder to write", "a file")
    there = next(place for place in (target, *target.parents) if place.exists())
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        what = "is protected" if there.is_dir() else "is a file"
        raise InputError(Path(path), problem=f"expected a place that can be written, but {there} {what}")
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
        raise InputError(Path(path), "a folder of its own for the output", what, why=", such as build/out")
    # Leftovers of a killed run are harmless.
    there = target.is_dir() and any(not f.name.startswith(f"{MARKER}-") for f in target.iterdir())
    if there and not (target / MARKER).is_file():
        raise InputError(
            Path(path),
            f"a new or empty folder, or one that eccentric wrote (it holds {MARKER})",
            "a folder with other files",
        )
    listed_in(target)
    return target


def require_free(folder: Path, name: str, listed: dict[str, str], command: str) -> None:
    """Raise InputError if writing a file with this name would destroy another one."""
    *above, _ = Path(name).parents
    blocked = next((f for f in reversed(above) if stands(folder / f) and not is_folder(folder / f)), None)
    place = Path(name) if blocked is None else blocked
    taken = folder / place
    if stands(taken) and (blocked or is_folder(taken) or listed.get(name) != command):
        wrote = listed.get(place.as_posix())
        owner = f"`eccentric {wrote}` wrote" if wrote else "eccentric did not write"
        what = "a folder" if is_folder(taken) else f"a file that {owner}"
        hint = "choose another folder for the output, or remove what is there"
        raise InputError(folder, f"the name {place.as_posix()} to be free", what, hint=hint)


def mark(folder: Path, written: dict[str, str]) -> None:
    """Write the marker of a folder: name -> command that wrote it."""
    lines = [_NOTICE, *(f"{command}: {name}" for name, command in sorted(written.items()))]
    (folder / MARKER).write_text("\n".join(lines) + "\n", encoding="utf-8")


def listed_in(folder: Path) -> dict[str, str]:
    """What the marker lists, name -> command that wrote it; nothing without a marker.

    Raises:
        InputError: it is not UTF-8 text, or cannot be read.
    """
    marker = folder / MARKER
    try:
        lines = marker.read_text(encoding="utf-8").splitlines()[1:] if marker.is_file() else []
    except UnicodeDecodeError as error:
        place = f"byte {error.start} is not"
        raise InputError(marker, problem=f"expected UTF-8 text as eccentric wrote it, but {place}") from None
    except OSError as error:
        raise InputError(marker, problem=f"expected a file that can be read ({error.strerror})") from None
    return {name: command for command, _, name in (line.partition(": ") for line in lines)}


# Printed output. It may be read in part: a reader that closes the pipe is not an error.


UNREAD = 141
"""Exit status of a program whose reader has closed the pipe, as if ended by SIGPIPE: 128 + 13."""


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


# Files and folders that appear whole or not at all.


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
        raise InputError(path, "a file to write", "one that is not a regular file")
    with workshop(target.parent) as place:
        new = place / target.name
        yield new
        new.replace(target)


@contextmanager
def whole_files(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield an empty folder to write to; its files replace those in `path` when the block ends, as one set.

    That holds as for `whole_folder`. A file that is there with the same content is not touched. There is no
    marker, and nothing else is removed. A link in the place of a file is replaced, not followed.

    Raises:
        InputError: the folder cannot be written, or a folder has the name of a new file.
    """
    target = folder_to_write(path)
    with workshop(target) as new:
        yield new
        with _moving(target, new):
            for name in files(new):
                there = target / name
                if is_folder(there):
                    raise InputError(there, "a file to write", "a folder")
                if there.is_file() and there.read_bytes() == (new / name).read_bytes():
                    (new / name).unlink()
            swap(target, new.parent)


@contextmanager
def whole_folder(path: str | os.PathLike[str], command: str) -> Iterator[Path]:
    """Yield an empty folder to write to; its files appear in `path` when the block ends without an exception.

    A hidden file `.eccentric` lists there which command wrote what. When the same command writes again, its
    new files replace everything it wrote before; anything else there is not touched. After any exception in
    the block, including an interrupt, `path` is unchanged. An interrupt that comes while the files are moved
    waits until they are. Of two runs at the same time, the last one stays.

    Raises:
        InputError: `own_folder` refuses the path; or a file of another command, or one that eccentric did not
            write, is in the place of a new file or its folder; or it cannot be written.
    """
    target = own_folder(path)
    if target.exists():
        # In the folder itself: the same file system, and writable even if its parent is not.
        with workshop(target) as new:
            yield new
            _put(Path(path), target, new, command)
        return
    with workshop(target.parent) as new:
        yield new
        if not _appears(target, new, command):
            own_folder(path)
            with workshop(target) as again:
                for child in new.iterdir():
                    child.replace(again / child.name)
                _put(Path(path), target, again, command)


def remove_folder(path: str | os.PathLike[str], command: str) -> None:
    """Remove what a command wrote into a folder, and the folder if nothing else is in it.

    Raises:
        InputError: as `whole_folder`.
        OSError: a folder cannot be removed.
    """
    with whole_folder(path, command):
        pass
    target = own_folder(path)
    if not files(target):
        (target / MARKER).unlink(missing_ok=True)
        # Only empty folders: another run may have written here meanwhile.
        for folder, _, _ in os.walk(target, topdown=False):
            Path(folder).rmdir()


def _appears(target: Path, new: Path, command: str) -> bool:
    """Make the new folder the target; False if another run has made one meanwhile."""
    mark(new, dict.fromkeys(files(new), command))
    try:
        new.rename(target)
    except OSError:
        if not target.exists():
            raise
        return False
    return True


def _put(path: Path, target: Path, new: Path, command: str) -> None:
    """Replace what a command wrote into a folder that exists; messages call it `path`."""
    with _moving(target, new):
        own_folder(target)
        names, there, listed = files(new), files(target), listed_in(target)
        for name in sorted(names):
            require_free(path, name, listed, command)
        owned = {name: owner for name, owner in listed.items() if name in there}
        gone = {name for name, owner in owned.items() if owner == command} - names
        kept = {name: owner for name, owner in owned.items() if owner != command}
        mark(new, kept | dict.fromkeys(names, command))
        swap(target, new.parent, gone)


@contextmanager
def _moving(target: Path, new: Path) -> Iterator[None]:
    """Be the only run that moves files into a folder, after whatever killed runs left there is put right."""
    with alone(target):
        if tidy(target, new.parent):
            raise InputError(
                target,
                problem="expected a folder that no other run is writing; if that run was killed, try"
                " again in an hour",
            )
        yield
