"""Which folder may be written, and which command wrote what there: the hidden file `.eccentric` lists it."""

from __future__ import annotations

import os
from pathlib import Path

from eccentric.errors import InputError
from eccentric.output.swap import MARKER, is_folder, stands
from eccentric.places import given_path

_NOTICE = "Written by eccentric. The command beside a file replaces it on its next run; other files stay."


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
        raise InputError(f"{folder}: a free name {place.as_posix()} is required, received {what}")


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
        raise InputError(f"{marker}: UTF-8 text as eccentric wrote it is required, {place}") from None
    except OSError as error:
        raise InputError(f"{marker}: a file that can be read is required ({error.strerror})") from None
    return {name: command for command, _, name in (line.partition(": ") for line in lines)}
