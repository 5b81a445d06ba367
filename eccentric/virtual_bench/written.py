"""A set of new files named after a log: none is there before, all of them or none afterwards."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from eccentric.errors import InputError
from eccentric.output import whole_files, workshop

LOG = ".csv.gz"


def new_paths(path: str | Path, endings: Sequence[str]) -> tuple[Path, ...]:
    """Return the paths of the log and of the files beside it, none of which exists: one may be measured.

    Raises InputError if the path does not end in .csv.gz or one of the files exists.
    """
    log = Path(path)
    if not log.name.endswith(LOG) or log.name == LOG:
        raise InputError(f"{log}: a log name that ends in {LOG} is required")
    stem = log.name.removesuffix(LOG)
    paths = log, *(log.with_name(f"{stem}{ending}") for ending in endings)
    if any(map(os.path.lexists, paths)):
        # A killed run may have left one of them and not yet the others: then it is removed.
        with suppress(InputError), workshop(log.parent):
            pass
    for one in paths:
        if os.path.lexists(one):  # including a dangling link
            raise InputError(f"{one}: a new file to write is required, received one that exists")
    return paths


def write_new(contents: Mapping[Path, bytes]) -> None:
    """Write files of one folder as a set; what a killed run leaves is removed by the next that writes there.

    Raises InputError if they cannot be written.
    """
    folder = next(iter(contents)).parent
    try:
        with whole_files(folder) as new:
            for path, content in contents.items():
                (new / path.name).write_bytes(content)
    except OSError as error:
        raise InputError(
            f"{folder}: a folder that can be written is required ({error.strerror or error})"
        ) from error
