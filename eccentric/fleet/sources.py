"""LOGS -> the files of a fleet, each with its joint and period.

Both are read from folders such as `joint=J7/month=2025-03`, or from file names by a pattern such as
`{joint}_{period}`, with or without the extension. Several time folders form one period, in this order: year,
quarter, month, week, day, period. Periods are sorted as text, with numbers by value.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Mapping
from dataclasses import astuple, dataclass, fields
from glob import glob
from pathlib import Path

from eccentric.core import InputError, given_path, so_more

NOT_GROUPED = "not grouped"
"""Kind of problem: a file that belongs to no joint or period."""
NO_RIG = "no rig"
"""Kind of problem: a joint without a usable rig."""
OTHER_RIG = "another rig"
"""Kind of problem: a joint whose inertia and gravity do not match its rig."""
NOT_TESTED = "not tested"
"""Kind of problem: a joint with too few periods."""
SCHEDULER = "scheduler"
"""Kind of problem: the scheduler was lost."""
UNREAD = frozenset({"worker", "cannot be used"})
"""Kinds of problems that leave a file without sums."""


@dataclass(frozen=True, order=True)
class FleetProblem:
    """A problem of a joint, period or file ("" if unknown); `kind` is a short label, `text` one line."""

    joint: str
    period: str
    file: str
    kind: str
    text: str


def as_csv(problems: Iterable[FleetProblem]) -> str:
    """The content of problems.csv, in order."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(FleetProblem)])
    writer.writerows(astuple(problem) for problem in sorted(set(problems)))
    return text.getvalue()


SUFFIXES = (".parquet", ".csv", ".csv.gz", ".mat")
"""Formats of a fleet's logs: not JSON, since rigs and a bench's sealed answers are often next to them."""
_TIMES = ("year", "quarter", "month", "week", "day", "period")
_WIDTH = {"year": 4, "month": 2, "week": 2, "day": 2}


@dataclass(frozen=True, order=True)
class LogFile:
    """A log of a joint in a period."""

    joint: str
    period: str
    name: str  # its path below the root
    path: Path
    size: int  # [bytes], which identifies with `changed` the version that was read
    changed: int  # modification time [ns]


def find(logs: str, pattern: str | None = None) -> tuple[list[LogFile], list[FleetProblem]]:
    """The log files of a folder or glob, and problems for those that belong to no joint or period.

    Raises InputError if no log has a joint and a period, and for a pattern without {joint} and {period}.
    """
    match = None if pattern is None else _compiled(pattern)
    root, paths = _listed(logs)
    files: list[LogFile] = []
    problems: list[FleetProblem] = []
    for path in sorted(paths):
        name = path.relative_to(root).as_posix()
        at = _of_folders(path.relative_to(root).parts[:-1]) if match is None else match(path.name)
        if "joint" not in at or "period" not in at:
            problems.append(FleetProblem("", "", name, NOT_GROUPED, f"{_required(pattern)}, got {name}"))
            continue
        status = path.stat()
        files.append(LogFile(at["joint"], at["period"], name, path, status.st_size, status.st_mtime_ns))
    if not files:
        raise InputError(logs, problem=f"{problems[0].text}{so_more(len(problems) - 1)}")
    return sorted(files), problems


def _required(pattern: str | None) -> str:
    if pattern is not None:
        return f"expected a name like {pattern}"
    names = "a --pattern of names such as '{joint}_{period}'"
    return f"expected folders joint=... and month=... (or {', '.join(_TIMES)}), or {names}"


def without_suffix(name: str) -> str:
    """A log's name without the suffix of its format."""
    return next((name[: -len(end)] for end in SUFFIXES if name.lower().endswith(end)), name)


def in_order(periods: Iterable[str]) -> list[str]:
    """Periods in order of time: numbers compare by value, 2025-9 before 2025-10."""
    return sorted(set(periods), key=_sizes)


def _sizes(period: str) -> list[tuple[bool, int, str]]:
    parts = re.split(r"(\d+)", period)
    return [(part.isdecimal(), int(part) if part.isdecimal() else 0, part) for part in parts]


def _listed(logs: str) -> tuple[Path, list[Path]]:
    """The folder that names are relative to, and the logs below it."""
    place = given_path(logs, "logs")
    if place.is_dir():
        root, listed = place, list(place.rglob("*"))
    else:
        listed = [Path(name) for name in glob(str(place), recursive=True)]  # noqa: PTH207 - absolute or not
        # Folders such as joint=J7 count even in the fixed part of a glob.
        special = [k for k, part in enumerate(place.parts) if set(part) & set("*?[=")]
        fixed = next((k for k in special if k < len(place.parts) - 1), len(place.parts) - 1)
        root = Path(*place.parts[:fixed])
    paths = [p for p in listed if p.name.lower().endswith(SUFFIXES) and p.is_file()]
    paths = [p for p in paths if not any(part.startswith((".", "_")) for part in p.relative_to(root).parts)]
    if not paths:
        raise InputError(
            logs, problem=f"expected a folder or glob with logs ({', '.join(SUFFIXES)}), found none"
        )
    return root, paths


def _of_folders(parts: Iterable[str]) -> Mapping[str, str]:
    labels = dict(part.split("=", 1) for part in parts if "=" in part)
    times = [labels[key].zfill(_WIDTH.get(key, 0)) for key in _TIMES if key in labels]
    joint = {"joint": labels["joint"]} if labels.get("joint") else {}
    return joint | ({"period": "-".join(times)} if times else {})


def _compiled(pattern: str):  # noqa: ANN202 - a function from a name to its parts
    parts = re.split(r"\{(joint|period)\}", pattern)
    if sorted(parts[1::2]) != ["joint", "period"]:
        raise InputError("pattern", "{joint} and {period}, each once", f"{pattern!r}")
    text = "".join(f"(?P<{p}>.+?)" if k % 2 else re.escape(p) for k, p in enumerate(parts))
    form = re.compile(text)
    has_suffix = without_suffix(pattern) != pattern

    def match(name: str) -> Mapping[str, str]:
        matched = form.fullmatch(name if has_suffix else without_suffix(name))
        return {} if matched is None else matched.groupdict()

    return match
