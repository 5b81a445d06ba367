"""What a worker does: files in, their sums or problems out."""

from __future__ import annotations

import ctypes
import gc
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from eccentric.errors import InputError
from eccentric.fleet.limits import LAST_BYTES, TASK_BYTES, TASK_FILES, TASK_PART
from eccentric.fleet.problems import FleetProblem
from eccentric.fleet.sources import LogFile
from eccentric.fleet.store import Stored
from eccentric.fleet.sums import Columns, sums_of
from eccentric.rigs import Rig

__all__ = ["Job", "give_back", "problem_of", "tasks_of", "work"]


@dataclass(frozen=True)
class Job:
    """A log file, its joint's rig, and the digest of the two's sums."""

    log: LogFile
    rig: Rig
    recipe: str


def tasks_of(jobs: Sequence[Job], threads: int) -> Iterator[list[Job]]:
    """Jobs in their order, as many together as make a task: fewer at the end, for threads to end together."""
    task: list[Job] = []
    size, left = 0, sum(job.log.size for job in jobs)
    most = _most(left, threads)
    for job in jobs:
        if task and (size + job.log.size > most or len(task) == TASK_FILES):
            yield task
            task, left = [], left - size
            size, most = 0, _most(left, threads)
        task.append(job)
        size += job.log.size
    if task:
        yield task


def _most(left: int, threads: int) -> float:
    """The size of a task where so much is left."""
    return min(TASK_BYTES, max(left * TASK_PART / threads, LAST_BYTES))


def work(jobs: Sequence[Job]) -> list[Stored | FleetProblem]:
    """The sums of each file, or why there are none."""
    return [_one(job) for job in jobs]


def problem_of(job: Job, kind: str, text: str) -> FleetProblem:
    """A problem of a file."""
    return FleetProblem(job.log.joint, job.log.period, job.log.name, kind, text)


def give_back() -> None:
    """Give memory that was freed back to the system, where the C library can.

    The allocator keeps it in pieces that suit sums; a diagnosis needs others, and each would add to them.
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
        text = job.rig.axis.said(str(error), (*job.rig.own_names, str(job.log.path)))
        return problem_of(job, "cannot be used", text)
    except Exception as error:  # noqa: BLE001 - one file of thousands must not end the run
        return problem_of(job, "cannot be used", f"{job.log.path}: {type(error).__name__}: {error}")


def _columns_of(job: Job) -> Columns:
    """The columns of a rig, kept for the next file of the joint."""
    if job.recipe not in _columns:
        if len(_columns) > TASK_FILES:
            _columns.clear()
        _columns[job.recipe] = Columns(job.rig)
    return _columns[job.recipe]
