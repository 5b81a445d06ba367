"""A worker's task: files -> their sums, or problems."""

from __future__ import annotations

import ctypes
import gc
import hashlib
import importlib
import json
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import quote, unquote

import numpy as np

from eccentric.core import InputError
from eccentric.fleet.limits import (
    BLOCKS,
    LAST_BYTES,
    MADE_WITH,
    MOST_PARTS,
    SAMPLE_ROWS,
    TASK_BYTES,
    TASK_FILES,
    TASK_PART,
)
from eccentric.fleet.sources import FleetProblem, LogFile
from eccentric.fleet.sums import Columns, Coverage, FileSums, Heading, sums_of
from eccentric.logs import Log, stream_log
from eccentric.rigs import Rig
from eccentric.signals import stream_columns

# Sums on disk: a folder for each joint with Parquet files numbered in the order of writing.
#
# A row contains the sums of one log file, the file's identity (period, name, size, modification time), and a
# digest of how the sums were computed: rig values, row filters, this module's version. If all agree, the log
# is not read again. A later row for a log replaces an earlier one; until then a row with another digest is
# retained, since its log may be archived and the rig values may be restored.
_VERSION = 4
_HEADINGS = b"eccentric.columns"
_Row = TypeVar("_Row", bound="Key")


@dataclass(frozen=True)
class Key:
    """Identity of a log version and its sums; `recipe` is a digest of how the sums are computed."""

    period: str
    name: str
    size: int
    changed: int
    recipe: str


@dataclass(frozen=True)
class Stored(Key):
    """The sums of one log file; `headings` are their columns."""

    headings: tuple[Heading, ...]
    sums: FileSums


def recipe_of(rig: Rig) -> str:
    """Digest of everything the sums depend on besides the log."""
    inputs = (
        *(_VERSION, MADE_WITH, rig.model, rig.case, sorted(rig.known.items())),
        *(sorted(rig.unknown.items()), rig.log, rig.sampling, rig.alignment),
    )
    return hashlib.sha256(repr(inputs).encode()).hexdigest()[:16]


def write(out: Path, joint: str, rows: Sequence[Stored], place: Path) -> None:
    """Add the sums of log files of one joint, all with one rig.

    New files are written to the folder `place` on the same file system, then moved; old ones are removed
    last. If rows are replaced, or the joint has many files, the files are merged, one per set of columns.
    """
    folder = _folder(out, joint)
    parts = _parts(folder)
    new = {(row.period, row.name): row for row in rows}
    merge = len(parts) >= MOST_PARTS or any((key.period, key.name) in new for key in keys(out, joint))
    retained = [row for row in read(out, joint) if (row.period, row.name) not in new] if merge else []
    by_columns: dict[tuple[Heading, ...], list[Stored]] = {}
    for row in [*retained, *rows]:
        by_columns.setdefault(row.headings, []).append(row)
    folder.mkdir(parents=True, exist_ok=True)
    last = max(map(_number, parts), default=0)
    for number, group in enumerate(by_columns.values(), start=last + 1):
        staged = place / f"{quote(joint, safe='')}-{number}.parquet"
        staged.write_bytes(_encoded(sorted(group, key=lambda row: (row.period, row.name))))
        staged.replace(folder / f"part-{number:06d}.parquet")
    for part in parts if merge else []:
        part.unlink()


def joints_of(out: Path) -> list[str]:
    """The joints that have sums."""
    names = (folder.name.removeprefix("joint=") for folder in (out / "sums").glob("joint=*"))
    return sorted(map(unquote, names))


def _folder(out: Path, joint: str) -> Path:
    return out / "sums" / f"joint={quote(joint, safe=' ')}"


def _parts(folder: Path) -> list[Path]:
    """The files of a joint in order of writing, without copies that a user made."""
    files = folder.glob("part-*.parquet")
    return sorted((p for p in files if p.stem.removeprefix("part-").isdecimal()), key=_number)


def _number(part: Path) -> int:
    return int(part.stem.removeprefix("part-"))


def _encoded(rows: Sequence[Stored]) -> Any:
    arrow, parquet = arrow_of()
    table: dict[str, list[Any]] = {
        "period": [row.period for row in rows],
        "name": [row.name for row in rows],
        "size": [row.size for row in rows],
        "changed": [row.changed for row in rows],
        "recipe": [row.recipe for row in rows],
        "windows": [row.sums.windows.tolist() for row in rows],
        "triangles": [row.sums.triangles.ravel() for row in rows],
    }
    for field in fields(Coverage):
        table[field.name] = [getattr(row.sums.coverage, field.name) for row in rows]
    made = arrow.table(table).replace_schema_metadata({_HEADINGS: _written(rows[0].headings)})
    # Via memory: for a few kilobytes, Arrow's file system calls cost more than everything else.
    with arrow.BufferOutputStream() as stream:
        parquet.write_table(made, stream, compression="none", use_dictionary=False, write_statistics=False)
        return stream.getvalue()


@cache
def _written(headings: tuple[Heading, ...]) -> bytes:
    return json.dumps([asdict(heading) for heading in headings]).encode()


def read(out: Path, joint: str) -> list[Stored]:
    """The rows of a joint, sorted by period and name.

    An unreadable file counts as absent: its logs are read again.
    """
    return _latest(row for part in _parts(_folder(out, joint)) for row in _read(part))


def keys(out: Path, joint: str) -> list[Key]:
    """The keys of a joint's rows, as in `read`."""
    return _latest(key for part in _parts(_folder(out, joint)) for key in _keys(part))


def _latest(rows: Iterable[_Row]) -> list[_Row]:
    latest = {(row.period, row.name): row for row in rows}
    return [latest[place] for place in sorted(latest)]


def _read(part: Path) -> list[Stored]:
    arrow, parquet = arrow_of()
    try:
        with parquet.ParquetFile(part) as file:
            table = file.read(use_threads=False)
        headings = tuple(Heading(**entry) for entry in json.loads(table.schema.metadata[_HEADINGS]))
        return [_stored(row, headings) for row in _rows(table)]
    except (arrow.ArrowException, OSError, KeyError, TypeError, ValueError):
        return []


def _keys(part: Path) -> list[Key]:
    arrow, parquet = arrow_of()
    names = [field.name for field in fields(Key)]
    try:
        with parquet.ParquetFile(part) as file:
            return [Key(**row) for row in file.read(names, use_threads=False).to_pylist()]
    except (arrow.ArrowException, OSError, TypeError):
        return []


def _rows(table: Any) -> Iterable[dict[str, Any]]:
    scalars = {name: table[name].to_pylist() for name in table.column_names if name != "triangles"}
    lists = table["triangles"].combine_chunks()
    for k in range(table.num_rows):
        yield {name: values[k] for name, values in scalars.items()} | {
            "triangles": lists[k].values.to_numpy()
        }


def _stored(row: dict[str, Any], headings: tuple[Heading, ...]) -> Stored:
    width = len(headings) + 1
    sums = FileSums(
        np.array(row["triangles"]).reshape(BLOCKS, width, width),
        np.array(row["windows"]),
        Coverage(**{field.name: row[field.name] for field in fields(Coverage)}),
    )
    key = {field.name: row[field.name] for field in fields(Key)}
    return Stored(**key, headings=headings, sums=sums)


def arrow_of() -> tuple[Any, Any]:
    """The modules pyarrow and pyarrow.parquet; InputError if they are not installed."""
    try:
        return importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    except ImportError:
        raise InputError("fleet", problem='pyarrow is required: pip install "eccentric[fleet]"') from None


@dataclass(frozen=True)
class Job:
    """A log file, its joint's rig, and the digest of their sums."""

    log: LogFile
    rig: Rig
    recipe: str


def tasks_of(jobs: Sequence[Job], threads: int) -> Iterator[list[Job]]:
    """Group jobs into tasks, in order; tasks get smaller at the end, so that threads finish together."""
    task: list[Job] = []
    size, remaining = 0, sum(job.log.size for job in jobs)
    limit = _size_limit(remaining, threads)
    for job in jobs:
        if task and (size + job.log.size > limit or len(task) == TASK_FILES):
            yield task
            task, remaining = [], remaining - size
            size, limit = 0, _size_limit(remaining, threads)
        task.append(job)
        size += job.log.size
    if task:
        yield task


def _size_limit(remaining: int, threads: int) -> float:
    """Size of a task [bytes] with this many bytes remaining."""
    return min(TASK_BYTES, max(remaining * TASK_PART / threads, LAST_BYTES))


def work(jobs: Sequence[Job]) -> list[Stored | FleetProblem]:
    """The sums of each file, or the problem."""
    return [_one(job) for job in jobs]


def problem_of(job: Job, kind: str, text: str) -> FleetProblem:
    """A problem of a file."""
    return FleetProblem(job.log.joint, job.log.period, job.log.name, kind, text)


def give_back() -> None:
    """Return freed memory to the operating system, where the C library can.

    The allocator retains it in pieces that fit sums; a diagnosis needs other sizes and would add to them.
    """
    gc.collect()
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # only glibc has it
        if trim is not None:
            trim(0)


_columns: dict[str, Columns] = {}


def _one(job: Job) -> Stored | FleetProblem:
    try:
        columns = _columns_of(job)
        sums = sums_of(job.log.path, columns)
        log = job.log
        return Stored(log.period, log.name, log.size, log.changed, job.recipe, columns.headings, sums)
    except InputError as error:
        return problem_of(job, "cannot be used", str(error))
    except Exception as error:  # noqa: BLE001 - one file of thousands must not end the run
        return problem_of(job, "cannot be used", f"{job.log.path}: {type(error).__name__}: {error}")


def _columns_of(job: Job) -> Columns:
    """The columns of a rig, cached for the next file of the joint."""
    if job.recipe not in _columns:
        if len(_columns) > TASK_FILES:
            _columns.clear()
        _columns[job.recipe] = Columns(job.rig)
    return _columns[job.recipe]


@dataclass(frozen=True)
class Sample:
    """At most SAMPLE_ROWS rows of a log file from row `first`; `name` names it in a report."""

    path: Path
    name: str
    first: int
    size: int
    changed: int

    def log(self, rig: Rig) -> Log:
        """The rows as a log. InputError if the file cannot be read."""
        stream = stream_log(self.path)
        spans = [(min(self.first, stream.rows), min(self.first + SAMPLE_ROWS, stream.rows))]
        read = stream.read(stream_columns(stream, rig), spans)
        return Log(self.name, read.columns, read.rows)


def sample_of(stored: Sequence[Stored], logs: Sequence[LogFile]) -> Sample | None:
    """The sample with the most motion in the files of a joint and period; None if no file is present."""
    there = {log.name: log for log in logs}
    best: tuple[int, Sample] | None = None
    for row in stored:
        log = there.get(row.name)
        if log is None:
            continue
        total = max(row.sums.coverage.rows, 1)
        span = max(1, min(BLOCKS, -(-SAMPLE_ROWS * BLOCKS // total)))
        moving = np.convolve(row.sums.windows, np.ones(span, dtype=np.int64), mode="valid")
        block = int(np.argmax(moving))
        sample = Sample(log.path, log.name, block * total // BLOCKS, log.size, log.changed)
        if best is None or int(moving[block]) > best[0]:
            best = int(moving[block]), sample
    return None if best is None else best[1]
