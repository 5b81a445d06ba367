"""What `diagnose` and `fit` of the bundled log cost, beside an earlier commit and beside peers: processor time.

A command is a whole process, from its start to its end, with one thread. Commands of the two trees alternate, so
that a machine that changes its speed changes both. The peers get columns and residual that `diagnose` computes for
itself: PySINDy's sequentially thresholded least squares selects among the columns of the effects, SciPy's
`least_squares` fits the coefficients of the paper's model alone.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from benchmarks import environment, sparse_columns
from benchmarks.record import Measured, Part, progress

ROOT = Path(__file__).resolve().parent.parent
BEFORE = "ed669e28"
"""The commit that the times are compared with."""
LOG = ("examples/bench/bench.csv.gz", "--rig", "examples/bench/bench.json")
COMMANDS = ("diagnose", "fit")
PAIRS, WARM_UP = 7, 2
LEAST_SQUARES = """
import sys
import numpy as np
from scipy.optimize import least_squares
log = np.load(sys.argv[1])
columns, goal = log["mechanical_base"][log["train"]], log["mechanical_residual"][log["train"]]
scale = np.sqrt(np.mean(columns**2, axis=0))
found = least_squares(lambda x: columns @ (x / scale) - goal, np.zeros(columns.shape[1]), method="lm")
print(found.x / scale)
"""


def measured(quick: bool = False) -> Part:
    """Processor times of both commands, and of a first run."""
    pairs = 2 if quick else PAIRS
    with tempfile.TemporaryDirectory() as name, _worktree(BEFORE) as before:
        folder = Path(name)
        trees = {"now": ROOT} | ({"before": before} if before is not None else {})
        times = {command: _alternating(command, trees, folder, pairs) for command in COMMANDS}
        first = _first_run(folder)
        peers = _peers(folder, pairs)
    figures = {
        f"{command} seconds": Measured(float(np.median(times[command]["now"]))) for command in COMMANDS
    } | {"first seconds": Measured(first)}
    for command in COMMANDS:
        if before is not None:
            figures[f"{command} ratio"] = _ratio(times[command]["now"], times[command]["before"])
    return Part(figures, _details(times, first, peers))


def processor_s(command: Sequence[str | Path], **own: str) -> float:
    """Processor time of a command and all its processes [s], user and system together.

    Raises:
        RuntimeError: it fails.
    """
    # Warm: what Python compiled is kept, as it is for a user, whatever the environment of this process says.
    left_out = ("OPENBLAS_", "PYTHONDONTWRITEBYTECODE")
    given = {name: x for name, x in os.environ.items() if not name.startswith(left_out)}
    given |= {"OMP_NUM_THREADS": "1", "ECCENTRIC_PROGRESS": "off"} | own
    cwd = own.get("PYTHONPATH", ROOT)
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors, env=given, cwd=cwd)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        said = errors.read().decode(errors="replace").strip()
    if process.returncode:
        raise RuntimeError(said.splitlines()[-1] if said else f"exit status {process.returncode}")
    return used.ru_utime + used.ru_stime


def _alternating(
    command: str, trees: Mapping[str, Path], folder: Path, pairs: int
) -> Mapping[str, list[float]]:
    """The times of a command in each tree, taken in turn; the first ones fill caches and do not count."""
    found: dict[str, list[float]] = {name: [] for name in trees}
    for number in range(WARM_UP + pairs):
        for name, tree in trees.items():
            progress(f"{command}: run {number + 1} of {WARM_UP + pairs}, {name}")
            took = processor_s(
                _called(command, folder / f"{command}-{name}"),
                PYTHONPATH=str(tree),
                XDG_CACHE_HOME=str(folder / f"cache-{name}"),
            )
            if number >= WARM_UP:
                found[name].append(took)
    return found


def _first_run(folder: Path) -> float:
    """`diagnose` with neither compiled sources of ours nor results of an earlier run."""
    progress("diagnose: the first run")
    tree = folder / "first"
    for name in ("eccentric", "derivations", "templates", "examples"):
        shutil.copytree(ROOT / name, tree / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tree)
    out, cache = folder / "first-out", folder / "first-cache"
    return processor_s(_called("diagnose", out), PYTHONPATH=str(tree), XDG_CACHE_HOME=str(cache))


def _called(command: str, out: Path) -> list[str | Path]:
    return [sys.executable, "-m", "eccentric", command, *LOG, "--out", out]


def _ratio(now: Sequence[float], before: Sequence[float]) -> Measured:
    pairs = np.array(now) / np.array(before)
    text = f"{np.median(pairs):.2f} ({pairs.min():.2f} to {pairs.max():.2f})"
    return Measured(float(np.median(pairs)), text, f"{BEFORE}: {np.median(before):.2f} s")


@contextmanager
def _worktree(commit: str) -> Iterator[Path | None]:
    """A tree of the commit for the time of a block; None where the repository does not have it."""
    with tempfile.TemporaryDirectory() as name:
        tree = Path(name) / "tree"
        command = ["git", "-C", str(ROOT), "worktree"]
        added = subprocess.run([*command, "add", "--detach", tree, commit], capture_output=True, check=False)
        try:
            yield tree if added.returncode == 0 else None
        finally:
            subprocess.run([*command, "remove", "--force", tree], capture_output=True, check=False)


def _peers(folder: Path, runs: int) -> dict[str, float | str]:
    """Peer -> median processor time [s], or why it was left out."""
    from eccentric.diagnosis import diagnose

    found: dict[str, float | str] = {}
    place = folder / "columns"
    place.mkdir()
    sparse_columns.write(diagnose([ROOT / LOG[0]], ROOT / LOG[2]), place / "bench.npz")
    reasons = environment.absent("pysindy", "scipy")
    peers = {
        "PySINDy": ("pysindy", [environment.PYTHON, Path(__file__).with_name("sparse_peer.py"), place]),
        "scipy.optimize.least_squares": (
            "scipy",
            [environment.PYTHON, "-c", LEAST_SQUARES, place / "bench.npz"],
        ),
    }
    for name, (package, command) in peers.items():
        progress(f"peers: {name}")
        if package in reasons:
            found[name] = reasons[package]
            continue
        try:
            found[name] = float(np.median([processor_s(command) for _ in range(runs + 1)][1:]))
        except RuntimeError as error:
            found[name] = str(error)
    return found


def _details(
    times: Mapping[str, Mapping[str, Sequence[float]]], first: float, peers: Mapping[str, float | str]
) -> list[str]:
    """The table of all times."""
    lines = [
        "Processor time of whole processes, one thread, on the bundled one-minute log: median (range).",
        "",
        f"| | this commit | {BEFORE} |",
        "|---|---|---|",
    ]
    for command, by_tree in times.items():
        each = [
            f"{np.median(by_tree[name]):.2f} s ({min(by_tree[name]):.2f} to {max(by_tree[name]):.2f})"
            if name in by_tree
            else "not in this repository"
            for name in ("now", "before")
        ]
        lines.append(f"| `eccentric {command}` | {' | '.join(each)} |")
    lines += [f"| `eccentric diagnose`, first run | {first:.2f} s | |", ""]
    lines += [
        f"{name}: {x:.2f} s." if isinstance(x, float) else f"{name}: left out, {x}."
        for name, x in peers.items()
    ]
    lines += [
        "",
        "Both peers are given columns and residual: PySINDy selects among the columns of the effects that have no"
        " hidden state, `least_squares` fits the paper's coefficients. Neither reads a log, estimates a rig,"
        " resamples, writes a report or emits code.",
    ]
    return lines
