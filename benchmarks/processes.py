"""pytest in processes of their own, a few at a time, each in a copy of the project.

They are forked from this one, which has imported what most tests need, but nothing of the project itself.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import shutil
import signal
import sys
import time
import traceback
import types
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

MEMORY = 6 << 30
"""Bytes beyond which a process is ended: a mutant that allocates without end."""
_APART = (".git", ".venv", "build", "dist", "__pycache__", ".*_cache", ".hypothesis", "*.egg-info")
_WARM = (
    "numpy",
    "scipy.optimize",
    "scipy.signal",
    "scipy.interpolate",
    "scipy.stats",
    "sympy",
    "mpmath",
    "jinja2",
)
_WARM = (*_WARM, "hypothesis", "anyio", "matplotlib.figure", "bokeh.embed", "asyncio", "unittest.mock")


@dataclass(frozen=True)
class Run:
    """One process: what it does, whose result is its exit status, and after how many seconds it is ended."""

    work: Callable[[], int]
    limit_s: float
    log: Path


Steps = Generator[Run, int | None, None]
"""Yields processes one after the other, and is sent the status of each; None if it was ended."""


def warm() -> None:
    """Import what most tests import."""
    os.environ["OMP_NUM_THREADS"] = "1"
    for name in _WARM:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)


def copied(root: Path, copy: Path) -> Path:
    """A copy of the project, without what git ignores."""
    shutil.copytree(root, copy, ignore=shutil.ignore_patterns(*_APART))
    for name, at in ((".venv", copy / ".venv"), ("../shared", copy.parent / "shared")):
        if (root / name).exists() and not at.exists():
            at.symlink_to((root / name).resolve())
    return copy


def run_all(tasks: Iterable[Callable[[Path], Steps]], copies: Sequence[Path]) -> None:
    """Run tasks, in each copy of the project one at a time."""
    waiting, free = iter(tasks), [*copies]
    running: dict[int, tuple[Steps, Path, float]] = {}

    def go_on(steps: Steps, copy: Path, status: int | None, first: bool = False) -> None:
        try:
            run = next(steps) if first else steps.send(status)
        except StopIteration:
            free.append(copy)
            return
        running[_forked(run, copy)] = steps, copy, time.monotonic() + run.limit_s

    try:
        while True:
            while free and (task := next(waiting, None)):
                copy = free.pop()
                go_on(task(copy), copy, None, first=True)
            if not running:
                return
            time.sleep(0.02)
            for pid, (steps, copy, end) in list(running.items()):
                done, status = os.waitpid(pid, os.WNOHANG)
                if not done and time.monotonic() < end and _memory(pid) < MEMORY:
                    continue
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(pid, signal.SIGKILL)  # also what it has started
                if not done:
                    os.waitpid(pid, 0)
                del running[pid]
                go_on(steps, copy, os.waitstatus_to_exitcode(status) if done else None)
    finally:
        for pid in running:
            os.killpg(pid, signal.SIGKILL)


def _memory(pid: int) -> int:
    try:
        return int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1]) * os.sysconf(
            "SC_PAGE_SIZE"
        )
    except (OSError, IndexError):
        return 0


def _forked(run: Run, copy: Path) -> int:
    sys.stdout.flush()
    pid = os.fork()
    if pid:
        with contextlib.suppress(OSError):
            os.setpgid(pid, pid)
        return pid
    status = 70
    try:
        os.setpgid(0, 0)
        log = os.open(run.log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        for stream, target in ((0, os.open(os.devnull, os.O_RDONLY)), (1, log), (2, log)):
            os.dup2(target, stream)
        _enter(copy)
        status = run.work()
    except BaseException:  # noqa: BLE001 - the process ends here, whatever happens
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def _enter(copy: Path) -> None:
    """Work in a copy of the project: none of this one's modules, caches or settings."""
    here = Path(__file__).resolve().parent
    sys.path[:] = [str(copy), *(p for p in sys.path if Path(p or ".").resolve() not in {here, here.parent})]
    for name in [n for n in sys.modules if n.partition(".")[0] in {"benchmarks", "eccentric", "tests"}]:
        del sys.modules[name]
    # What a test starts with multiprocessing would run this process's script again.
    sys.modules["__main__"] = types.ModuleType("__main__")
    os.chdir(copy)
    cache = copy.with_name(f"{copy.name}-cache")
    shutil.rmtree(cache, ignore_errors=True)
    sys.dont_write_bytecode = False
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    os.environ |= {"PYTHONPATH": str(copy), "XDG_CACHE_HOME": str(cache)}


def run_pytest(files: Iterable[str], plugin: object, *options: str) -> int:
    """Run pytest on files of tests, without the slow ones."""
    scratch = Path.cwd().with_name(f"{Path.cwd().name}-tmp")
    ignored = "ignore::pytest.PytestAssertRewriteWarning"  # of plugins that are imported already
    fixed = (
        "-q",
        "-p",
        "no:cacheprovider",
        "-m",
        "not slow",
        "-W",
        ignored,
        f"--basetemp={scratch}",
        "--tb=short",
    )
    return int(pytest.main([*files, *fixed, *options], plugins=[plugin]))
