"""BenchRun -> LOG.csv.gz, LOG.json (the rig) and LOG.truth.json (sealed)."""

from __future__ import annotations

import gzip
import io
import json
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.core import InputError, whole_files, workshop
from eccentric.virtual_bench.simulation import BenchRun

LOG = ".csv.gz"


def new_paths(path: str | Path, endings: Sequence[str]) -> tuple[Path, ...]:
    """Return the paths of the log and its companion files, none of which may exist: it could be measured.

    Raises InputError if the path does not end in .csv.gz or one of the files exists.
    """
    log = Path(path)
    if not log.name.endswith(LOG) or log.name == LOG:
        raise InputError(log, problem=f"expected a log name that ends in {LOG}")
    stem = log.name.removesuffix(LOG)
    paths = log, *(log.with_name(f"{stem}{ending}") for ending in endings)
    if any(map(os.path.lexists, paths)):
        # Remove an incomplete set left by a killed run.
        with suppress(InputError), workshop(log.parent):
            pass
    for one in paths:
        if os.path.lexists(one):  # including a dangling link
            raise InputError(one, "a new file to write", "one that exists")
    return paths


def write_new(contents: Mapping[Path, bytes]) -> None:
    """Write files of one folder as a set; the next run cleans up after a killed one.

    Raises InputError if they cannot be written.
    """
    folder = next(iter(contents)).parent
    try:
        with whole_files(folder) as new:
            for path, content in contents.items():
                (new / path.name).write_bytes(content)
    except OSError as error:
        raise InputError(
            folder, problem=f"expected a folder that can be written ({error.strerror or error})"
        ) from error


_FORMATS = {
    "time_s": "%.3f",
    "theta_m_rad": "%.5f",
    "omega_m_rad_s": "%.4f",
    "voltage_V": "%.3f",
    "current_A": "%.4f",
    "temperature_C": "%.2f",
}
_BESIDE = (".json", ".truth.json")


def write(run: BenchRun, path: str | Path) -> tuple[Path, Path, Path]:
    """Write the log to `path`, NAME.csv.gz, with NAME.json and NAME.truth.json; return the three paths.

    NAME is written into rig and truth. The same run gives the same bytes: the archive stores no time and no
    name. Nothing is left behind if writing fails. Raises InputError if the path does not end in .csv.gz, one
    of the three files exists, or they cannot be written.
    """
    log, rig, truth = free_paths(path)
    stem = log.name.removesuffix(LOG)
    write_new(
        {
            log: csv_archive(run.columns, [_FORMATS[name] for name in run.columns]),
            rig: json_bytes({**run.rig, "name": stem}),
            truth: json_bytes({**run.truth, "name": stem}),
        }
    )
    return log, rig, truth


def free_paths(path: str | Path) -> tuple[Path, Path, Path]:
    """Return the paths of log, rig and truth, none of which exists; InputError as for `write`."""
    log, rig, truth = new_paths(path, _BESIDE)
    return log, rig, truth


def csv_archive(columns: Mapping[str, np.ndarray], formats: Sequence[str]) -> bytes:
    """Return the columns (rows,) as a gzipped CSV, each in its format."""
    text = io.StringIO()
    rows, header = np.column_stack(list(columns.values())), ",".join(columns)
    np.savetxt(text, rows, fmt=",".join(formats), header=header, comments="", newline="\n")
    return gzip.compress(text.getvalue().encode("ascii"), 9, mtime=0)


def json_bytes(content: Mapping[str, Any]) -> bytes:
    """Return the content as JSON."""
    return (json.dumps(content, indent=1) + "\n").encode("ascii")
