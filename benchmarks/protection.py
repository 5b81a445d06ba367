"""How well the project is protected, and what that costs: mutants that the tests notice, and how long the tests take.

The mutants are those of `make mutants`, which keeps its results in build/mutants: they take an hour, so this prints
what is kept.  Those that no test can notice are argued in equivalent_mutants.toml; what became of others that a draw
left is in noticed_since.toml.
"""

from __future__ import annotations

import json
import re
import subprocess
import time
import tomllib
from pathlib import Path

from benchmarks.mutants import Result, equivalent, table
from benchmarks.record import Measured, Part

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "build" / "mutants"


def measured(quick: bool = False) -> Part:
    """The share of mutants that are killed, and the time of `make test`."""
    figures: dict[str, Measured] = {}
    details: list[str] = []
    argued, counted = equivalent(ROOT), list[Result]()
    for path in sorted(KEPT.glob("seed-*.jsonl")):
        results = [Result(**json.loads(line)) for line in path.read_text(encoding="utf-8").splitlines()]
        counted += [r for r in results if r.argued not in argued or r.outcome == "killed"]
        seed, _, commit = path.stem.removeprefix("seed-").partition("-")
        details += [f"Mutants of seed {seed}{f', at {commit}' if commit else ''}:", *table(results, argued)]
        details += [*_since([r for r in results if r.argued not in argued]), ""]
    if counted:
        killed = sum(r.outcome == "killed" for r in counted)
        share = killed / len(counted)
        figures["mutants"] = Measured(share, f"{share:.2f} ({killed} of {len(counted)})")
    if not quick:
        minutes, said = _tests()
        figures["tests"] = Measured(minutes, f"{minutes:.1f} min, {said}")
    return Part(figures, details)


def _since(results: list[Result]) -> list[str]:
    """What became of the mutants that a draw left."""
    entries = tomllib.loads((ROOT / "benchmarks" / "noticed_since.toml").read_text(encoding="utf-8"))[
        "mutant"
    ]
    since = {(e["file"], e["before"], e["after"]): e["since"] for e in entries}
    keys = [((r.file, *r.argued), r) for r in results if r.outcome != "killed"]
    left = [(r, since[key]) for key, r in keys if key in since]
    if not left:
        return []
    return [
        "",
        f"Of those that survived, {len(left)} have been dealt with since; a new draw measures that, this one does not.",
        *(f"- {r.file}:{r.line}: {what}" for r, what in left),
    ]


def _tests() -> tuple[float, str]:
    """The minutes that `make test` takes, and the last line of pytest without the time."""
    start = time.monotonic()
    done = subprocess.run(["make", "test"], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"make test: exit status {done.returncode}")
    return (time.monotonic() - start) / 60.0, re.findall(r"(\d+ passed.*) in [\d.]+s", done.stdout)[-1]
