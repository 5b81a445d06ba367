"""BenchRun -> LOG.csv.gz, LOG.json (the rig) and LOG.truth.json (sealed)."""

import gzip
import io
import json
from pathlib import Path

import numpy as np

from eccentric.virtual_bench.simulation import BenchRun
from eccentric.virtual_bench.written import LOG, new_paths, write_new

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
    """Write the log to `path`, NAME.csv.gz, beside it NAME.json and NAME.truth.json; return the three paths.

    NAME is written into rig and truth. The same run gives the same bytes: the archive stores no time and no
    name. Nothing is left behind if writing fails. Raises InputError if the path does not end in .csv.gz, one
    of the three files exists, or they cannot be written.
    """
    log, rig, truth = free_paths(path)
    stem = log.name.removesuffix(LOG)
    write_new(
        {
            log: gzip.compress(_csv(run), 9, mtime=0),
            rig: _json({**run.rig, "name": stem}),
            truth: _json({**run.truth, "name": stem}),
        }
    )
    return log, rig, truth


def free_paths(path: str | Path) -> tuple[Path, Path, Path]:
    """Return the paths of log, rig and truth, none of which exists; InputError as for `write`."""
    log, rig, truth = new_paths(path, _BESIDE)
    return log, rig, truth


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
