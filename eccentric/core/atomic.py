"""Atomic output of one file, a set of files, or a command's output folder."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from eccentric.core.errors import InputError, given_path
from eccentric.core.transaction import MARKER, alone, files, is_folder, stands, swap, tidy, workshop

# Output folders. The hidden file `.eccentric` lists which command wrote which file.


_NOTICE = (
    "Written by eccentric. The command next to a file name replaces that file on its next run;"
    " other files are kept."
)


def folder_to_write(path: str | os.PathLike[str]) -> Path:
    """Return the absolute path of a folder that exists or can be created.

    Raises:
        InputError: it is a file or below one, or its parent is not writable.
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
    """Return the absolute path of a folder that `whole_folder` may write; for a check before a long run.

    Raises:
        InputError: as `folder_to_write`; or it contains files but no readable `.eccentric`; or it is, or
            contains, the working directory.
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
    """Raise InputError if writing a file with this name would overwrite another one."""
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
    """Write the marker file, from name -> command that wrote it."""
    lines = [_NOTICE, *(f"{command}: {name}" for name, command in sorted(written.items()))]
    (folder / MARKER).write_text("\n".join(lines) + "\n", encoding="utf-8")


def listed_in(folder: Path) -> dict[str, str]:
    """Read the marker file: name -> command that wrote it; empty without a marker.

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


# Printing. A reader may close the pipe early (`| head`): that is not an error.


UNREAD = 141
"""Exit status after the reader has closed the pipe, as if terminated by SIGPIPE: 128 + 13."""


def escape_unprintable() -> None:
    """Make stdout escape characters missing from its encoding (an ASCII terminal), as stderr does."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def show(what: object) -> None:
    """Print; exit quietly with status 141 if the reader has closed the pipe."""
    escape_unprintable()
    try:
        print(what, flush=True)
    except BrokenPipeError:
        nobody_reads()
        sys.exit(UNREAD)


def nobody_reads() -> None:
    """Discard stdout, since the interpreter flushes it again at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


# Atomic files and folders.


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a path to write to; the file replaces `path` when the block ends without an exception.

    The temporary file has the target's name, so that its suffix (`.csv.gz`, `.svg`) takes effect.
    Missing parent folders are created. After any exception, including an interrupt, `path` is unchanged.

    Raises:
        InputError: `path` exists and is not a regular file, or its folder is not writable.
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

    Same guarantees as `whole_folder`, but no marker is written and no other file removed. A file with
    unchanged content is not touched. A link in place of a file is replaced, not followed.

    Raises:
        InputError: the folder is not writable, or a folder has the name of a new file.
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

    The hidden file `.eccentric` in it lists which command wrote which file. When the same command runs again,
    its new files replace everything it wrote before; other files are not touched. After any exception in
    the block, including an interrupt, `path` is unchanged. Interrupts are deferred while files are moved.
    Of two simultaneous runs, the last to finish wins.

    Raises:
        InputError: `own_folder` refuses the path; or a file of another command, or one not written by
            eccentric, has the name of a new file or its folder; or it is not writable.
    """
    target = own_folder(path)
    if target.exists():
        # Stage inside the folder: same file system, and writable even if its parent is not.
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
    """Remove a command's files from a folder, and the folder if it is then empty.

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
    """Rename the new folder to the target; False if another run has created it meanwhile."""
    mark(new, dict.fromkeys(files(new), command))
    try:
        new.rename(target)
    except OSError:
        if not target.exists():
            raise
        return False
    return True


def _put(path: Path, target: Path, new: Path, command: str) -> None:
    """Replace a command's files in an existing folder; messages name it `path`."""
    with _moving(target, new):
        own_folder(target)
        names, there, listed = files(new), files(target), listed_in(target)
        for name in sorted(names):
            require_free(path, name, listed, command)
        owned = {name: owner for name, owner in listed.items() if name in there}
        obsolete = {name for name, owner in owned.items() if owner == command} - names
        retained = {name: owner for name, owner in owned.items() if owner != command}
        mark(new, retained | dict.fromkeys(names, command))
        swap(target, new.parent, obsolete)


@contextmanager
def _moving(target: Path, new: Path) -> Iterator[None]:
    """Lock a folder against moves by other runs, and recover what killed runs left in it."""
    with alone(target):
        if tidy(target, new.parent):
            raise InputError(
                target,
                problem="expected a folder that no other run is writing; if that run was killed, try"
                " again in an hour",
            )
        yield
