"""Work spread over a Dask cluster: results as they come, whatever becomes of workers and scheduler.

A task whose worker dies is tried again elsewhere, by Dask; what kills workers is told apart from what waited
beside it, so that it is named and all else is done. Results come back to the caller, who alone
writes: workers need to see the logs, nothing else.
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
    """The scheduler or all of its workers went away; what was done until then has been yielded."""


class Failed(Exception):
    """Why an item has no result, in a line."""


@contextmanager
def connected(scheduler: str | None, workers: int) -> Iterator[Any]:
    """Yield a client of the scheduler at an address, or of a cluster of this many processes on this machine.

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
        # Ticks tell how long a loop was busy, which nobody asks here: fifty a second are work.
        "distributed.admin.tick.limit": "1h",
        "distributed.admin.tick.interval": "10s",
        "distributed.scheduler.allowed-failures": DEATHS,
        # A worker that pauses at 80 % of its memory waits for results to be taken, and goes on where memory
        # falls. Here it is the allocator's, and would never fall: the task would wait for ever.
        "distributed.worker.memory.pause": False,
        "distributed.worker.memory.target": False,
        "distributed.worker.memory.spill": False,
        # With Dask's own, 64 kB, each array goes back to the system, and the next is mapped and zeroed.
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
            except RuntimeError:  # as multiprocessing says it, in each process that reads the script again
                raise InputError(
                    "fleet",
                    problem='expected a call below `if __name__ == "__main__":`, since workers read the'
                    " script again: none could be started",
                ) from None
            # Ctrl-C in a callback of the garbage collector would be printed and lost.
            distributed.gc.disable_gc_diagnosis(force=True)
            closing = ExitStack()
            try:
                yield closing.enter_context(distributed.Client(closing.enter_context(local)))
            finally:
                with held():  # Dask does not close a second time what was interrupted
                    closing.close()
            return
        for name in ("distributed.client", "distributed.core"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            client = distributed.Client(scheduler, timeout=CONNECT)
        except (OSError, ValueError) as error:
            said = str(error).splitlines()[0]
            raise InputError(
                f"--scheduler {scheduler}", problem=f"expected a Dask scheduler there ({said})"
            ) from None
        try:
            yield client
        finally:
            client.close(timeout=2)


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """What is started here never receives Ctrl-C, which a terminal sends to all processes of a command.

    This process stops its workers itself. Blocked signals are inherited by threads and processes; one that
    comes meanwhile arrives at the end.
    """
    if not hasattr(signal, "pthread_sigmask"):  # as on Windows
        yield
        return
    # Python starts its tracker with the first process, and then lets Ctrl-C through to that one.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def threads_of(client: Any) -> int:
    """The threads of all workers, at least 1: some schedulers start workers on demand.

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
    """Yield each item of each task with its result, in the order in which they are done.

    Dask blames every task that waited on a worker for its death. So a task that is blamed is cut into its
    items, and an item that is blamed waits until all else is done and is tried once more, by itself.

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
                    future.release()  # its worker keeps a diagnosis, which is large, as long as this is held
                    yield from zip(task, results, strict=True)
    except (OSError, TimeoutError, distributed.CancelledError) as error:
        raise SchedulerLost(str(error).splitlines()[0] if str(error) else type(error).__name__) from None


class _LostError(Exception):
    """A result was there, and is no longer."""


def _done(client: Any, running: list[Any]) -> Collection[Any]:
    """The futures that have come to an end, at least one. Raises SchedulerLost."""
    distributed = importlib.import_module("distributed")
    worked = time.monotonic()
    while True:
        try:
            return distributed.wait(running, timeout=ALIVE_S, return_when="FIRST_COMPLETED").done
        except TimeoutError:
            # Futures of a scheduler that was killed wait for ever; the client knows that it has lost it.
            if client.status != "running":
                raise SchedulerLost("no connection") from None
            # A scheduler that starts workers on demand has none until tasks wait.
            if client.nthreads():
                worked = time.monotonic()
            elif time.monotonic() - worked > WORKERLESS_S:
                raise SchedulerLost(f"no worker for {WORKERLESS_S:g} s") from None


def _results(future: Any) -> Sequence[Any]:
    """The results of a task that has ended. Raises Failed, _LostError, SchedulerLost."""
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
        said = "every worker that took it died: out of memory?" if died else f"{name}: {error}"
        raise Failed(said.splitlines()[0]) from None
