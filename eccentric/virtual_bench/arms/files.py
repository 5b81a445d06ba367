"""ArmRun -> LOG.csv.gz, LOG.toml (the rig), LOG.arm.toml and LOG.truth.json (sealed)."""

from __future__ import annotations

import gzip
import io
import json
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.virtual_bench.arms.log import ArmRun
from eccentric.virtual_bench.written import LOG, new_paths, write_new

_BESIDE = (".toml", ".arm.toml", ".truth.json")


def write_arm(run: ArmRun, path: str | Path) -> tuple[Path, Path, Path, Path]:
    """Write the log to `path`, NAME.csv.gz, beside it NAME.toml, NAME.arm.toml and NAME.truth.json.

    Returns the four paths. The same run gives the same bytes; nothing is left behind if writing fails. Raises
    InputError if the path does not end in .csv.gz, one of the files exists, or they cannot be written.
    """
    log, rig, arm, truth = free_arm_paths(path)
    stem = log.name.removesuffix(LOG)
    write_new(
        {
            log: gzip.compress(_csv(run), 9, mtime=0),
            rig: _toml({**run.rig, "arm": arm.name}).encode("ascii"),
            arm: _toml(run.arm).encode("ascii"),
            truth: (json.dumps({**run.truth, "name": stem}, indent=1) + "\n").encode("ascii"),
        }
    )
    return log, rig, arm, truth


def free_arm_paths(path: str | Path) -> tuple[Path, Path, Path, Path]:
    """Return the paths of log, rig, arm and truth, none of which exists; InputError as for `write_arm`."""
    log, rig, arm, truth = new_paths(path, _BESIDE)
    return log, rig, arm, truth


def _csv(run: ArmRun) -> bytes:
    text, names = io.StringIO(), list(run.columns)
    formats = {"run": "%d", "t_s": "%.4f", "q": "%.7f"}
    shown = [formats.get(name, formats.get(name.partition("_")[0], "%.5f")) for name in names]
    np.savetxt(
        text,
        np.column_stack([run.columns[name] for name in names]),
        fmt=",".join(shown),
        header=",".join(names),
        comments="",
        newline="\n",
    )
    return text.getvalue().encode("ascii")


def _toml(content: dict[str, Any]) -> str:
    """Text of a table: its values first, then its tables, then its lists of tables, in any depth."""
    return "\n".join(_lines(content, "")).strip() + "\n"


def _lines(table: dict[str, Any], place: str) -> list[str]:
    lines = [f"{key} = {json.dumps(value)}" for key, value in table.items() if not _is_table(value)]
    for key, value in table.items():
        if _is_table(value):
            name = f"{place}{key}"
            for inner in value if isinstance(value, list) else [value]:
                bracket = f"[[{name}]]" if isinstance(value, list) else f"[{name}]"
                lines += ["", bracket, *_lines(inner, f"{name}.")]
    return lines


def _is_table(value: object) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, list) and bool(value) and all(isinstance(x, dict) for x in value)
    )
