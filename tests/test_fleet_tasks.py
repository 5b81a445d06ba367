"""Jobs as tasks: all of them once, in their order, large ones first and small ones last."""

from __future__ import annotations

import sys
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from eccentric.fleet.cluster import connected
from eccentric.fleet.limits import LAST_BYTES, TASK_BYTES, TASK_FILES
from eccentric.fleet.sources import LogFile
from eccentric.fleet.work import Job, tasks_of


def _jobs(count: int, size: int) -> list[Job]:
    logs = [LogFile("J", f"{k:05d}", f"{k:05d}.parquet", Path("x"), size, 0) for k in range(count)]
    return [Job(log, cast("Any", None), "r") for log in logs]


@pytest.mark.parametrize("threads", [1, 2, 16])
def test_every_job_is_in_one_task_and_the_last_ones_are_short(threads: int) -> None:
    """No thread waits at the end for more than one small task of another."""
    jobs = _jobs(1000, 2_000_000)
    tasks = list(tasks_of(jobs, threads))
    sizes = [sum(job.log.size for job in task) for task in tasks]

    assert [job for task in tasks for job in task] == jobs
    assert max(sizes) <= TASK_BYTES
    assert sizes[:-1] == sorted(sizes[:-1], reverse=True)
    assert max(sizes[-threads:]) <= LAST_BYTES


def test_a_file_larger_than_a_task_is_one_and_small_files_are_not_too_many() -> None:
    """A task has at least one file and at most so many."""
    assert [1, 1] == [len(task) for task in tasks_of(_jobs(2, 2 * TASK_BYTES), 2)]
    assert max(len(task) for task in tasks_of(_jobs(1000, 10), 2)) == TASK_FILES


def test_nothing_to_do_is_no_task() -> None:
    """An empty list."""
    assert [] == list(tasks_of([], 2))


@pytest.mark.parametrize("workers", [1, 3])
def test_a_worker_of_this_machine_does_one_task_at_a_time(
    workers: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process each, with a thread each: the memory of a worker is that of its task alone."""
    asked: dict[str, Any] = {}

    def cluster(**given: Any) -> Any:
        asked.update(given)
        return nullcontext(given)

    collector = SimpleNamespace(disable_gc_diagnosis=lambda *, force: None)
    distributed = SimpleNamespace(LocalCluster=cluster, Client=nullcontext, gc=collector)
    dask = SimpleNamespace(config=SimpleNamespace(set=nullcontext))
    monkeypatch.setitem(sys.modules, "distributed", cast("Any", distributed))
    monkeypatch.setitem(sys.modules, "dask", cast("Any", dask))
    with connected(None, workers) as client:
        assert asked == client

    assert (workers, 1, True) == (asked["n_workers"], asked["threads_per_worker"], asked["processes"])
