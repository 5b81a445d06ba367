"""What is written: one file, a set of files, or a folder of a command's files. All of it, or nothing."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from eccentric.errors import InputError
from eccentric.output.folders import folder_to_write, listed_in, mark, own_folder, require_free
from eccentric.output.swap import MARKER, files, is_folder, swap
from eccentric.output.workshop import alone, tidy, workshop
from eccentric.places import given_path


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
                    raise InputError(f"{there}: a file to write is required, received a folder")
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
                f"{target}: a folder that no other run is writing is required; if that run was killed, try"
                " again in an hour"
            )
        yield
