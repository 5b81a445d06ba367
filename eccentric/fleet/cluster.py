"""Work spread over a Dask cluster: results as they come, whatever becomes of workers and scheduler.

A task whose worker dies is tried again elsewhere, by Dask; one that kills several workers is cut into its
single items, so that what kills is named and all else is done. Results come back to the caller, who alone
writes: workers need to see the logs, nothing else.
"""

from __future__ import annotations

import importlib
import logging
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from eccentric.errors import InputError
from eccentric.fleet.limits import AHEAD, ALIVE_S, CONNECT, DEATHS, WORKER_BYTES

__all__ = ["Failed", "SchedulerLost", "connected", "spread"]

Item = TypeVar("Item")
Result = TypeVar("Result")


class SchedulerLost(Exception):
    """The scheduler went away; what was done until then has been yielded."""


class Failed(Exception):
    """Why an item has no result, in a line."""


@contextmanager
def connected(scheduler: str | None, workers: int) -> Iterator[Any]:
    """Yield a client of the scheduler at an address, or of a cluster of this many processes on this machine.

    Raises InputError if Dask is not installed, or nothing answers at the address.
    """
    try:
        distributed, dask = (importlib.import_module(name) for name in ("distributed", "dask"))
    except ImportError:
        raise InputError('fleet: dask and distributed are required: pip install "eccentric[fleet]"') from None
    settings = {
        "distributed.comm.timeouts.connect": CONNECT,
        "distributed.admin.tick.limit": "1h",
        "distributed.scheduler.allowed-failures": DEATHS,
    }
    with dask.config.set(settings):
        if scheduler is None:
            with (
                distributed.LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=True,
                    memory_limit=WORKER_BYTES,
                    dashboard_address="127.0.0.1:0",
                    silence_logs=logging.CRITICAL,
                ) as cluster,
                distributed.Client(cluster) as client,
            ):
                yield client
            return
        for name in ("distributed.client", "distributed.core"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            client = distributed.Client(scheduler, timeout=CONNECT)
        except (OSError, ValueError) as error:
            said = str(error).splitlines()[0]
            raise InputError(
                f"--scheduler {scheduler}: a Dask scheduler is required there ({said})"
            ) from None
        try:
            yield client
        finally:
            client.close(timeout=2)


def spread(
    client: Any, work: Callable[[Sequence[Item]], Sequence[Result]], tasks: Iterable[Sequence[Item]]
) -> Iterator[tuple[Item, Result | Failed]]:
    """Yield each item of each task with its result, in the order in which they are done.

    Raises SchedulerLost.
    """
    distributed = importlib.import_module("distributed")
    waiting, running = deque(tasks), dict[Any, Sequence[Item]]()

    def submit() -> None:
        threads = sum(client.nthreads().values()) or 1
        while waiting and len(running) < AHEAD * threads:
            task = waiting.popleft()
            running[client.submit(work, task, pure=False)] = task

    try:
        submit()
        while running:
            for future in _done(client, list(running)):
                task = running.pop(future)
                yield from _results(future, task, waiting)
            submit()
    except (OSError, TimeoutError, distributed.CancelledError) as error:
        raise SchedulerLost(str(error).splitlines()[0] if str(error) else type(error).__name__) from None


def _done(client: Any, running: list[Any]) -> Collection[Any]:
    """The futures that have come to an end, at least one. Raises SchedulerLost."""
    distributed = importlib.import_module("distributed")
    while True:
        try:
            return distributed.wait(running, timeout=ALIVE_S, return_when="FIRST_COMPLETED").done
        except TimeoutError:
            # Futures of a scheduler that was killed wait for ever; the client knows that it has lost it.
            if client.status != "running":
                raise SchedulerLost("no connection") from None


def _results(future: Any, task: Sequence[Item], waiting: deque[Sequence[Item]]) -> Iterator[tuple[Item, Any]]:
    """The results of a task that has ended; the items of one that killed its workers wait on their own."""
    if future.status == "finished":
        yield from zip(task, future.result(), strict=True)
        return
    if future.status != "error":
        raise SchedulerLost(f"a task is {future.status}")
    error = future.exception()
    if len(task) > 1:
        waiting.extend([item] for item in task)
        return
    killed = type(error).__name__ == "KilledWorker"
    said = "every worker that took it died: out of memory?" if killed else f"{type(error).__name__}: {error}"
    yield task[0], Failed(said.splitlines()[0])
