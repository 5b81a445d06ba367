"""Distribution of work over a Dask cluster that survives dying workers and a lost scheduler.

Dask retries a task whose worker dies. An item that kills its worker is distinguished from items that merely
shared the worker, so that it is reported and the others are completed. Only the caller writes results:
workers need read access to the logs, nothing else.
"""

from __future__ import annotations

import importlib
import logging
import signal
import time
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from multiprocessing import resource_tracker
from typing import Any, TypeVar

from eccentric.core import InputError, held
from eccentric.fleet.limits import AHEAD, ALIVE_S, CONNECT, DEATHS, KEPT_BYTES, WORKER_BYTES, WORKERLESS_S

Item = TypeVar("Item")
Result = TypeVar("Result")


class SchedulerLost(Exception):
    """The scheduler or all of its workers went away; results completed before have been yielded."""


class Failed(Exception):
    """An item has no result; the message gives the reason in one line."""


@contextmanager
def connected(scheduler: str | None, workers: int) -> Iterator[Any]:
    """Yield a client of the scheduler at an address, or of a local cluster of this many processes.

    Raises InputError if Dask is not installed, nothing answers at the address, or no worker can be started.
    """
    try:
        distributed, dask = (importlib.import_module(name) for name in ("distributed", "dask"))
    except ImportError:
        raise InputError(
            "fleet", problem='dask and distributed are required: pip install "eccentric[fleet]"'
        ) from None
    settings = {
        "distributed.comm.timeouts.connect": CONNECT,
        # Ticks measure how long a loop was busy, which is not used here: fifty a second cost time.
        "distributed.admin.tick.limit": "1h",
        "distributed.admin.tick.interval": "10s",
        "distributed.scheduler.allowed-failures": DEATHS,
        # A worker that pauses at 80 % of its memory resumes when results are collected and memory falls.
        # Here the allocator holds the memory, so it would never fall and the task would hang.
        "distributed.worker.memory.pause": False,
        "distributed.worker.memory.target": False,
        "distributed.worker.memory.spill": False,
        # With Dask's default, 64 kB, each freed array is unmapped, and the next one mapped and zeroed.
        "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": KEPT_BYTES,
        "distributed.nanny.pre-spawn-environ.MALLOC_MMAP_THRESHOLD_": KEPT_BYTES,
    }
    with dask.config.set(settings):
        if scheduler is None:
            try:
                with _without_interrupts():
                    local = distributed.LocalCluster(
                        n_workers=workers,
                        threads_per_worker=1,
                        processes=True,
                        memory_limit=WORKER_BYTES,
                        dashboard_address="127.0.0.1:0",
                        silence_logs=logging.CRITICAL,
                    )
            except RuntimeError:  # from multiprocessing, in each process that re-imports the script
                raise InputError(
                    "fleet",
                    problem='expected a call below `if __name__ == "__main__":`, since workers read the'
                    " script again: none could be started",
                ) from None
            # Ctrl-C in a garbage-collector callback would be printed and lost.
            distributed.gc.disable_gc_diagnosis(force=True)
            closing = ExitStack()
            try:
                yield closing.enter_context(distributed.Client(closing.enter_context(local)))
            finally:
                with held():  # Dask cannot resume an interrupted close
                    closing.close()
            return
        for name in ("distributed.client", "distributed.core"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            client = distributed.Client(scheduler, timeout=CONNECT)
        except (OSError, ValueError) as error:
            reason = str(error).splitlines()[0]
            raise InputError(
                f"--scheduler {scheduler}", problem=f"expected a Dask scheduler there ({reason})"
            ) from None
        try:
            yield client
        finally:
            client.close(timeout=2)


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Block Ctrl-C, which a terminal sends to all processes of a command, for processes started here.

    This process stops its workers itself. Threads and processes inherit blocked signals; a signal that
    arrives meanwhile is delivered at the end.
    """
    if not hasattr(signal, "pthread_sigmask"):  # as on Windows
        yield
        return
    # Python starts its resource tracker with the first process, and unblocks Ctrl-C for that one.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def threads_of(client: Any) -> int:
    """Number of threads of all workers, at least 1: some schedulers start workers on demand.

    Raises:
        SchedulerLost: the scheduler does not answer.
    """
    try:
        return sum(client.nthreads().values()) or 1
    except (OSError, TimeoutError) as error:
        raise SchedulerLost(str(error).splitlines()[0] if str(error) else type(error).__name__) from None


def spread(
    client: Any, work: Callable[[Sequence[Item]], Sequence[Result]], tasks: Iterable[Sequence[Item]]
) -> Iterator[tuple[Item, Result | Failed]]:
    """Yield each item of each task with its result, in order of completion.

    Dask blames every task assigned to a worker for its death. So a blamed task is split into its items, and
    a blamed item is retried once, by itself, after everything else is done.

    Raises SchedulerLost.
    """
    distributed = importlib.import_module("distributed")
    waiting, blamed = deque(tasks), deque[Sequence[Item]]()
    running = dict[Any, Sequence[Item]]()
    try:
        while waiting or running or blamed:
            alone = not waiting and not running
            most = AHEAD * threads_of(client)
            while waiting and len(running) < most:
                task = waiting.popleft()
                running[client.submit(work, task, pure=False)] = task
            if alone:
                task = blamed.popleft()
                running[client.submit(work, task, pure=False)] = task
            for future in _done(client, list(running)):
                task = running.pop(future)
                try:
                    results = _results(future)
                except _LostError:
                    waiting.append(task)  # its worker died with the result
                except Failed as failed:
                    if len(task) > 1:
                        waiting.extend([item] for item in task)
                    elif alone:
                        yield task[0], failed
                    else:
                        blamed.append(task)
                else:
                    future.release()  # until then the worker keeps its result, and a diagnosis is large
                    yield from zip(task, results, strict=True)
    except (OSError, TimeoutError, distributed.CancelledError) as error:
        raise SchedulerLost(str(error).splitlines()[0] if str(error) else type(error).__name__) from None


class _LostError(Exception):
    """A result was computed and then lost."""


def _done(client: Any, running: list[Any]) -> Collection[Any]:
    """The completed futures, at least one. Raises SchedulerLost."""
    distributed = importlib.import_module("distributed")
    last_worker = time.monotonic()
    while True:
        try:
            return distributed.wait(running, timeout=ALIVE_S, return_when="FIRST_COMPLETED").done
        except TimeoutError:
            # Futures of a killed scheduler never complete, but the client notices the lost connection.
            if client.status != "running":
                raise SchedulerLost("no connection") from None
            # A scheduler that starts workers on demand has none until tasks are queued.
            if client.nthreads():
                last_worker = time.monotonic()
            elif time.monotonic() - last_worker > WORKERLESS_S:
                raise SchedulerLost(f"no worker for {WORKERLESS_S:g} s") from None


def _results(future: Any) -> Sequence[Any]:
    """The results of a completed task. Raises Failed, _LostError, SchedulerLost."""
    distributed = importlib.import_module("distributed")
    if future.status not in {"finished", "error"}:
        if future.client.status == "running":
            raise _LostError
        raise SchedulerLost(f"a task is {future.status}")
    try:
        return future.result()
    except Exception as error:  # noqa: BLE001 - whatever a task raises is its result
        name = type(error).__name__
        cancelled = isinstance(error, distributed.CancelledError)
        if cancelled and future.client.status == "running":
            raise _LostError from None
        if cancelled or isinstance(error, OSError):
            raise SchedulerLost(name) from None
        died = isinstance(error, distributed.KilledWorker)
        reason = "every worker that took it died: out of memory?" if died else f"{name}: {error}"
        raise Failed(reason.splitlines()[0]) from None
