"""Readers of other projects' formats by their libraries: whatever those raise or print becomes one line.

A damaged file can lead a library anywhere. None of the readers that use this runs what a file contains:
pickles, attachments and formulas in it are left out, with a note.
"""

from __future__ import annotations

import contextlib
import errno
import gc
import gzip
import importlib
import io
import logging
import os
import re
import sys
import traceback
import warnings
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from eccentric.core import InputError
from eccentric.logs import limits

_NO_TEXT = re.compile(rb"[\x00-\x08\x0e-\x1f]")


_NOT_READ = frozenset(
    {errno.EACCES, errno.EPERM, errno.EISDIR, errno.ENOENT, errno.EIO, errno.EMFILE, errno.ENOSPC}
)
"""What the system says where a file is not read at all: it says nothing of the content."""


class DamagedError(ValueError):
    """The content of a file contradicts itself; its text says where."""


def library(name: str, extra: str, path: Path, kind: str = "", instead: str = "") -> Any:
    """Import the library of a format; InputError, which names the extra, if it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        package, kind = name.partition(".")[0], kind or path.suffix
        install = f'pip install "eccentric[{extra}]"{instead}'
        raise InputError(f"{path}: {package} is required for {kind}: {install}") from None


@contextlib.contextmanager
def errors_of(path: Path, what: str, *, collect: bool = False) -> Iterator[None]:
    """Make one line of whatever a library raises on a damaged file; collect what it had half built."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        if isinstance(error, OSError) and error.errno in _NOT_READ:
            raise
        refused = _refused(path, f"a valid {what}", error)
        if collect:
            _cleared(error)
        raise refused from None


def _refused(path: Path, valid: str, error: Exception) -> InputError:
    """What is wrong with a file that a library could not read."""
    with path.open("rb") as file:
        start = file.read(limits.FIRST_BYTES)
    if not start:
        return InputError(path, valid, "an empty file")
    if start.isascii() and not _NO_TEXT.search(start):
        return InputError(path, valid, f"a text that begins with {start[:20].decode()!r}")
    if isinstance(error, DamagedError):
        return InputError(path, valid, f"a damaged one: {error}")
    if isinstance(error, MemoryError):
        return InputError(path, valid, "one that claims more values than fit in memory")
    kind = type(error).__name__
    return InputError(path, valid, f"one that is damaged, cut off or of an unsupported kind ({kind})")


def _cleared(error: BaseException) -> None:
    """Let go of what a library had half built: some of it complains when it is cleared away later."""
    before, sys.unraisablehook = sys.unraisablehook, lambda _: None
    try:
        traceback.clear_frames(error.__traceback__)
        gc.collect()
    finally:
        sys.unraisablehook = before


@contextlib.contextmanager
def reading(path: Path, what: str) -> Iterator[None]:
    """Silence a library, and make one line of whatever it raises."""
    before = logging.root.manager.disable
    # What was there before is not looked at when the remains of a failure are collected.
    frozen = gc.get_freeze_count() == 0
    if frozen:
        gc.freeze()
    try:
        logging.disable(logging.CRITICAL)
        with (
            errors_of(path, what, collect=True),
            warnings.catch_warnings(),
            contextlib.redirect_stdout(io.StringIO()),
            contextlib.redirect_stderr(io.StringIO()),
        ):
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(before)
        if frozen:
            gc.unfreeze()


def opened_text(path: Path, encoding: str = "utf-8-sig") -> IO[str]:
    """Open a text file, unpacked if its name ends in .gz; its line ends are kept."""
    opened = gzip.open if path.name.lower().endswith(".gz") else open
    return opened(path, "rt", encoding=encoding, newline="")


def text_of(path: Path, encoding: str = "utf-8-sig") -> str:
    """Return the text of a file, unpacked if its name ends in .gz; InputError above a gigabyte."""
    with opened_text(path, encoding) as file:
        text = file.read(limits.MOST_CHARACTERS + 1)
    if len(text) > limits.MOST_CHARACTERS:
        raise InputError(path, f"at most {limits.MOST_CHARACTERS:,} characters", "more")
    return text


# Whether what a file holds fits into memory: known from its size, before it is read value by value.
#
# A small compressed file can hold more rows than any memory does. Without this, reading would take minutes
# before the system ends it.


try:
    import resource
except ImportError:  # Windows
    resource = None


def require_room_for_text(path: Path, text: str, rows: int, values: int, *, parts: int | None = None) -> None:
    """Raise InputError if a text of so many rows and values takes more memory than there is.

    `parts` is the number of lists and objects that it is read into, if that is not one for each row.
    """
    need = (
        limits.BYTES_PER_ROW * (rows if parts is None else parts)
        + limits.BYTES_PER_VALUE * values
        + limits.BYTES_PER_CHARACTER * len(text)
    )
    _require(path, need, rows, values)


def require_room_for_numbers(path: Path, rows: int, values: int) -> None:
    """Raise InputError if so many values of a binary file take more memory than there is."""
    _require(path, limits.BYTES_PER_NUMBER * values, rows, values)


def _require(path: Path, need: int, rows: int, values: int) -> None:
    free = free_memory()
    if need > free:
        raise InputError(
            path,
            f"at most {rows * free // need:,} rows of this kind",
            f"{rows:,} rows with {values:,} values, for about {need / 1000000000.0:.3g} GB",
            why=f", for which the {free / 1000000000.0:.3g} GB of free memory suffice",
        )


def free_memory(root: Path = Path("/")) -> int:
    """Memory that this process may still take, bytes: of the machine, its control group and its own limit.

    Args:
        root: where the system's files are.
    """
    return max(0, min((*_of_machine(root), *_of_group(root), *_of_process(root))))


def _of_machine(root: Path) -> Iterator[int]:
    with suppress(OSError, StopIteration, ValueError):
        lines = (root / "proc/meminfo").read_text().splitlines()
        yield 1024 * int(next(line for line in lines if line.startswith("MemAvailable:")).split()[1])
        return
    try:
        yield os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, OSError, ValueError):
        yield limits.MEMORY_IF_UNKNOWN


def _of_group(root: Path) -> Iterator[int]:
    """What each control group that the process is in leaves, as containers and batch systems use them."""
    groups = root / "sys/fs/cgroup"
    with suppress(OSError, ValueError):
        names = (root / "proc/self/cgroup").read_text().splitlines()
        own = next((name.removeprefix("0::/") for name in names if name.startswith("0::/")), "")
        for place in (groups / own, *(groups / own).parents):
            if place.is_relative_to(groups):
                yield from _left_in(place, "memory.max", "memory.current")
    yield from _left_in(groups / "memory", "memory.limit_in_bytes", "memory.usage_in_bytes")


def _left_in(group: Path, limit: str, used: str) -> Iterator[int]:
    with suppress(OSError, ValueError):  # none, or "max"
        most, taken = int((group / limit).read_text()), int((group / used).read_text())
        # Pages of files count as used, and make room when they are needed.
        lines = (group / "memory.stat").read_text().splitlines()
        counted = {name: int(number) for name, number in (line.split() for line in lines)}
        # Version 1 counts the groups below separately; its totals contain them.
        prefix = "total_" if "total_active_file" in counted else ""
        cached = (counted.get(f"{prefix}{name}_file", 0) for name in ("active", "inactive"))
        yield most - taken + sum(cached) + counted.get("slab_reclaimable", 0)


def _of_process(root: Path) -> Iterator[int]:
    """What `ulimit -v` leaves."""
    if resource is not None:
        most = resource.getrlimit(resource.RLIMIT_AS)[0]
        if most != resource.RLIM_INFINITY:
            with suppress(OSError, ValueError):
                pages = int((root / "proc/self/statm").read_text().split()[0])
                yield most - pages * resource.getpagesize()
