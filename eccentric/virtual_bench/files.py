"""BenchRun -> LOG.csv.gz, LOG.json (the rig) and LOG.truth.json (sealed)."""

import gzip
import io
import json
import os
import shutil
import tempfile
from pathlib import Path

import numpy as np

from eccentric.errors import InputError

from .simulation import BenchRun

_FORMATS = {
    "time_s": "%.3f",
    "theta_m_rad": "%.5f",
    "omega_m_rad_s": "%.4f",
    "voltage_V": "%.3f",
    "current_A": "%.4f",
    "temperature_C": "%.2f",
}
_ENDING = ".csv.gz"


def write(run: BenchRun, path: str | Path) -> tuple[Path, Path, Path]:
    """Write the log to `path`, NAME.csv.gz, beside it NAME.json and NAME.truth.json; return the three paths.

    NAME is written into rig and truth. The same run gives the same bytes: the archive stores no time and no
    name. Nothing is left behind if writing fails. Raises InputError if the path does not end in .csv.gz, one
    of the three files exists, or they cannot be written.
    """
    log, rig, truth = free_paths(path)
    stem = log.name.removesuffix(_ENDING)
    contents = {
        log: gzip.compress(_csv(run), 9, mtime=0),
        rig: _json({**run.rig, "name": stem}),
        truth: _json({**run.truth, "name": stem}),
    }
    try:
        log.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=log.parent) as folder:
            for target, content in contents.items():
                (Path(folder) / target.name).write_bytes(content)
            _move(Path(folder), list(contents))
    except OSError as error:
        raise InputError(
            f"{path}: a file that can be written is required ({error.strerror or error})"
        ) from error
    return log, rig, truth


def _move(folder: Path, targets: list[Path]) -> None:
    """Move the files of a folder to their places, none of which is taken; if one fails, remove the others."""
    moved: list[Path] = []
    try:
        for target in targets:
            moved.append(target)  # before it is there: an interrupt may come right after the move
            shutil.move(folder / target.name, target)
    except BaseException:
        for target in moved:
            target.unlink(missing_ok=True)
        raise


def free_paths(path: str | Path) -> tuple[Path, Path, Path]:
    """Return the paths of log, rig and truth, none of which exists: a measured log may have that name.

    Raises InputError if the path does not end in .csv.gz or one of the three files exists.
    """
    log = Path(path)
    if not log.name.endswith(_ENDING) or log.name == _ENDING:
        raise InputError(f"{log}: a log name that ends in {_ENDING} is required")
    stem = log.name.removesuffix(_ENDING)
    paths = log, log.with_name(f"{stem}.json"), log.with_name(f"{stem}.truth.json")
    for one in paths:
        if os.path.lexists(one):  # including a dangling link
            raise InputError(f"{one}: a new file to write is required, received one that exists")
    return paths


def _csv(run: BenchRun) -> bytes:
    text = io.StringIO()
    names = list(run.columns)
    rows = np.column_stack([run.columns[name] for name in names])
    np.savetxt(
        text,
        rows,
        fmt=",".join(_FORMATS[n] for n in names),
        header=",".join(names),
        comments="",
        newline="\n",
    )
    return text.getvalue().encode("ascii")


def _json(content: dict) -> bytes:
    return (json.dumps(content, indent=1) + "\n").encode("ascii")
