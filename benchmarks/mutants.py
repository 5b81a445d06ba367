"""How many small changes to the sources the tests notice.

    python benchmarks/mutants.py [--number 200] [--seed 1] [--rooms diagnosis,identification] [--jobs N] [--seconds 150]

Draws changes (benchmarks/mutations.py), and for each runs the tests that execute its line (benchmarks/coverage_map.py),
the closest first, until one fails.  A change is killed if a test fails, hangs or cannot be collected.  Everything is kept
in build/mutants: run it again to go on after an interruption, or with a larger number.  Survivors are listed; those that
no test can notice are argued in benchmarks/equivalent_mutants.toml and not counted.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
import tempfile
import time
import tomllib
import zlib
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))

from benchmarks.coverage_map import Map, digest, taken  # noqa: E402 - found by the line above
from benchmarks.mutations import Mutant, drawn, rooms  # noqa: E402
from benchmarks.processes import Run, Steps, copied, run_all, run_pytest, warm  # noqa: E402

_FIRST_S = 6.0
"""Most changes are noticed by the first tests: those are collected on their own, which takes less time."""


@dataclass(frozen=True)
class Result:
    """What became of a mutant; `by` is the test that failed, or what else ended it."""

    room: str
    file: str
    line: int
    kind: str
    before: str
    after: str
    outcome: str
    by: str = ""
    tests: int = 0
    seconds: float = 0.0
    cut: bool = False
    version: str = ""

    @property
    def key(self) -> tuple[str, int, str, str]:
        """What distinguishes it from others."""
        return self.file, self.line, self.before, self.after

    @property
    def argued(self) -> tuple[str, str]:
        """What an argument for its equivalence names: the line may move, and its file may be merged."""
        return self.before, self.after


def main(arguments: list[str] | None = None) -> int:
    """Draw, run and print."""
    parser = argparse.ArgumentParser(description="How many small changes to the sources the tests notice.")
    parser.add_argument("--number", type=int, default=200, help="mutants, default 200")
    parser.add_argument("--seed", type=int, default=1, help="of the draw, default 1")
    parser.add_argument("--rooms", help="only those of the draw that are in these, comma between")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, help="processes, default one per processor"
    )
    parser.add_argument(
        "--seconds", type=float, default=150.0, help="of tests for a mutant at most, default 150"
    )
    parser.add_argument(
        "--again", choices=["survived", "all"], help="run these again, whatever was found before"
    )
    parser.add_argument("--root", type=Path, default=ROOT, help=argparse.SUPPRESS)
    args = parser.parse_args(arguments)
    root, out = args.root.resolve(), args.root.resolve() / "build" / "mutants"
    if root == ROOT:
        warm()
    rooms = set(args.rooms.split(",")) if args.rooms else None
    mutants = drawn(root, args.number, args.seed, rooms)
    tasks, read = taken(root, out / "map")
    with tempfile.TemporaryDirectory(prefix="copies-") as folder:
        copies = [copied(root, Path(folder).resolve() / f"copy-{k}") for k in range(max(args.jobs, 1))]
        if tasks:
            print(f"coverage map: {len(tasks)} files of tests", flush=True)
        run_all([_counted(task, f"map {k} of {len(tasks)}") for k, task in enumerate(tasks, 1)], copies)
        results = _run(
            root, out / f"seed-{args.seed}.jsonl", mutants, read(), copies, args.seconds, args.again
        )
    print("\n".join(table(results, equivalent(root))))
    return 0


def _counted(task: Callable[[Path], Steps], text: str) -> Callable[[Path], Steps]:
    def steps(copy: Path) -> Steps:
        if sys.stderr.isatty():
            print(f"\r{text}", end="", file=sys.stderr, flush=True)
        return task(copy)

    return steps


def _run(
    root: Path,
    path: Path,
    mutants: list[tuple[str, Mutant]],
    reach: Map,
    copies: list[Path],
    most_s: float,
    again: str | None,
) -> list[Result]:
    """The results of the mutants: those of before, and those that are not there yet."""
    version = digest(root, [*(root / "tests").glob("*.py")])
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    known = {r.key: r for r in (Result(**json.loads(line)) for line in lines)}
    known = {
        key: r for key, r in known.items() if again is None or (again == "survived" and r.outcome == "killed")
    }
    waiting, asked = [], []
    for room, mutant in mutants:
        before, after = mutant.shown((root / mutant.file).read_bytes())
        blank = Result(room, mutant.file, mutant.line, mutant.kind, before, after, "", version=version)
        asked.append(blank.key)
        if blank.key not in known:
            waiting.append((mutant, blank))
    sound: dict[str, bool] = {}

    def note(result: Result) -> None:
        known[result.key] = result
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(result)) + "\n")
        at = f"{result.file}:{result.line}"
        print(f"{result.outcome:9} {result.kind:9} {at}  {result.by}  {result.seconds:.0f} s", flush=True)

    run_all(
        [partial(_tested, *each, reach, most_s, sound, note, path.with_suffix(".log")) for each in waiting],
        copies,
    )
    return [known[key] for key in asked]


def _tested(
    mutant: Mutant,
    blank: Result,
    reach: Map,
    most_s: float,
    sound: dict[str, bool],
    note: Callable[[Result], None],
    log: Path,
    copy: Path,
) -> Steps:
    """Run the tests on one mutant; a test that fails without it as well is left out from then on."""
    start, path, seen = time.monotonic(), copy / mutant.file, copy.with_name(f"{copy.name}-failed")
    source = path.read_bytes()
    stat = path.stat()
    uses = {} if mutant.local else used(copy, mutant.name)
    reached = reach.reaching(mutant.file, mutant.span, local=mutant.local, uses=uses)
    batches, cut = chosen(*reached, reach.seconds, most_s)
    outcome, by, count = "survived" if batches else "unreached", "", 0
    for batch in batches:
        while outcome != "killed" and (tests := [t for t in batch if sound.get(t, True)]):
            limit = 60.0 + 5.0 * sum(reach.seconds[t] for t in tests)
            changed = mutant.applied(source)
            path.write_bytes(changed)
            stamp = zlib.crc32(changed)  # compiled files are told apart by size and time
            os.utime(path, (stamp, stamp))
            try:
                status = yield _pytest(tests, seen, limit, log)
            finally:
                path.write_bytes(source)
                os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
            count += len(tests)
            if status in {0, 5}:  # 5: the tests are no longer there
                break
            failed = seen.read_text(encoding="utf-8") if seen.is_file() else ""
            if failed in tests and failed not in sound:
                sound[failed] = (yield _pytest([failed], seen, limit, log)) == 0
                if not sound[failed]:
                    continue
            other = "no end" if status is None else f"signal {-status}" if status < 0 else "not collected"
            outcome, by = "killed", failed or other
    spent = round(time.monotonic() - start, 1)
    note(replace(blank, outcome=outcome, by=by, tests=count, seconds=spent, cut=cut))


def used(root: Path, name: str) -> dict[str, int]:
    """The lines of Python files with a name: file -> bit per line."""
    found = dict[str, int]()
    word = re.compile(rf"\b{re.escape(name)}\b")
    for files in rooms(root).values() if name else ():
        for file in files:
            text = (root / file).read_text(encoding="utf-8") if file.endswith(".py") else ""
            if name in text:
                found[file] = sum(1 << k for k, line in enumerate(text.splitlines(), 1) if word.search(line))
    return found


def _pytest(tests: list[str], seen: Path, limit: float, log: Path) -> Run:
    files = list(dict.fromkeys(test.partition("::")[0] for test in tests))
    seen.unlink(missing_ok=True)

    return Run(lambda: run_pytest(files, _Chosen(tests, seen), "-x"), limit, log)


class _Chosen:
    """Runs the chosen tests in their order, and notes which one fails."""

    def __init__(self, tests: list[str], seen: Path) -> None:
        self.tests, self.seen = tests, seen

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        named = {item.nodeid: item for item in items}
        items[:] = [named[test] for test in self.tests if test in named]

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed and not self.seen.exists():
            self.seen.write_text(report.nodeid, encoding="utf-8")


def chosen(
    reaching: list[str], others: list[str], seconds: Mapping[str, float], most_s: float
) -> tuple[list[list[str]], bool]:
    """The tests to run in two batches, and whether some that execute the line are left out.

    A quarter of the time is for tests in the same files that do not execute the line, for what an earlier test has left
    in memory. Tests of one file are run together.
    """
    spent, found = 0.0, list[str]()
    for tests, limit in ((reaching, most_s), (others, most_s / 4)):
        end = min(most_s, spent + limit)
        for test in tests:
            if not found or spent + seconds[test] <= end:
                spent += seconds[test]
                found.append(test)
    late = set(reaching) - set(found)
    place = {name: k for k, name in enumerate(dict.fromkeys(test.partition("::")[0] for test in found))}
    found.sort(key=lambda test: place[test.partition("::")[0]])
    total, count = 0.0, 0
    while count < len(found) and (count == 0 or total + seconds[found[count]] <= _FIRST_S):
        total += seconds[found[count]]
        count += 1
    return [batch for batch in (found[:count], found[count:]) if batch], bool(late)


def equivalent(root: Path) -> dict[tuple[str, str], str]:
    """Mutants that no test can notice, and why."""
    path = root / "benchmarks" / "equivalent_mutants.toml"
    if not path.is_file():
        return {}
    entries = tomllib.loads(path.read_text(encoding="utf-8"))["mutant"]
    return {(e["before"], e["after"]): e["why"] for e in entries}


def table(results: list[Result], argued: Mapping[tuple[str, str], str]) -> list[str]:
    """One row per room, and the survivors."""
    lines = [
        "",
        "| room | mutants | equivalent | killed | survived | killed, of what can be |",
        "|---" * 6 + "|",
    ]
    open_ = [r for r in results if r.outcome != "killed" and r.argued not in argued]
    for room in [*sorted({r.room for r in results}), "all"]:
        own = [r for r in results if room in {r.room, "all"}]
        killed, left = sum(r.outcome == "killed" for r in own), sum(r in open_ for r in own)
        share = f"{100.0 * killed / (killed + left):.0f} %" if killed + left else ""
        lines.append(f"| {room} | {len(own)} | {len(own) - killed - left} | {killed} | {left} | {share} |")
    for r in open_:
        tests = f"{r.tests} tests" + (" of more" if r.cut else "")
        lines += ["", f"{r.file}:{r.line}: {r.outcome}, {r.kind}, {tests}"]
        lines += [f"  - {line}" for line in r.before.splitlines()] + [
            f"  + {line}" for line in r.after.splitlines()
        ]
    return lines


if __name__ == "__main__":
    sys.exit(main())
