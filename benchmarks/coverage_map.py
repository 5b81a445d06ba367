"""Which tests execute which lines of Python files and templates, and how long each takes.

Taken once, one process for each file of tests, and kept until the sources or that file change.  Python processes that
a test starts count too, if they end in peace.  A result that a test leaves in memory (a model, a rendered module) is
used by later tests of the same process without executing the lines again: those are the other tests of that file.
"""

from __future__ import annotations

import functools
import hashlib
import json
import operator
import os
import shutil
import sqlite3
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import coverage
import jinja2
import pytest
from coverage.numbits import numbits_to_nums

from benchmarks.processes import Run, Steps, run_pytest

SOURCES = ("eccentric", "derivations", "templates")
_LIMIT_S = 1800.0
_SETTINGS = """\
[run]
source =
    {copy}/eccentric
    {copy}/derivations
    {copy}/templates
parallel = true
data_file = {raw}/data
context = ${{ECCENTRIC_TEST-}}
disable_warnings = no-data-collected, module-not-imported, module-not-measured, module-not-python, couldnt-parse
"""


@dataclass
class Map:
    """Tests by the lines that they execute.

    Attributes:
        seconds: test -> how long it takes; tests that pass only.
        lines: file -> test -> bit per line. What is executed while a file of tests is collected counts for all in it.
    """

    seconds: dict[str, float] = field(default_factory=dict)
    lines: dict[str, dict[str, int]] = field(default_factory=dict)

    @cached_property
    def of_file(self) -> dict[str, list[str]]:
        """The tests of each file."""
        found: dict[str, list[str]] = {}
        for test in self.seconds:
            found.setdefault(test.partition("::")[0], []).append(test)
        return found

    @cached_property
    def breadth(self) -> dict[str, int]:
        """How many lines each test executes, or the collection of a file of tests."""
        found: dict[str, int] = {}
        for tests in self.lines.values():
            for test, bits in tests.items():
                found[test] = found.get(test, 0) + bits.bit_count()
        return found

    def reaching(
        self, file: str, span: tuple[int, int], *, local: bool = True, uses: Mapping[str, int] | None = None
    ) -> tuple[list[str], list[str]]:
        """The tests that execute one of the lines, and the other tests in their files; each the closest first.

        Lines outside functions are executed on import: there it is the tests that execute anything in the file, or
        one of the lines (file -> bit per line) that use the constant. A derivation is executed once, by whoever asks
        for its model first: there it is all tests of that file, and so it is for what is executed in collecting it.
        The order is that of the time over the share of a test's lines that are in this source file.
        """
        first, last = span
        tests = self.lines.get(file, {})
        if file.endswith(".jinja"):  # text of several lines is executed as its first one
            every = functools.reduce(operator.or_, tests.values(), 0)
            first = last = max((every & ((1 << last + 1) - 1)).bit_length() - 1, 0)
        bits = (1 << last + 1) - (1 << first) if local else -1
        hit = {test for test, mask in tests.items() if mask & bits}
        for name, used in (uses or {}).items():
            hit |= {test for test, mask in self.lines.get(name, {}).items() if mask & used}
        files: dict[str, list[str]] = {}
        for test in hit & self.seconds.keys():
            files.setdefault(test.partition("::")[0], []).append(test)
        for name in hit - self.seconds.keys():
            if name in self.of_file:
                files[name] = self.of_file[name] if local else files.get(name, [])
        if file.startswith("derivations/"):
            files = {name: self.of_file[name] for name in files}

        def distance(test: str) -> float:
            name = test.partition("::")[0]
            share = max(tests[t].bit_count() / self.breadth[t] if t in tests else 1e-9 for t in (test, name))
            return (0.05 + self.seconds[test]) / share

        reached = sorted((test for own in files.values() for test in own), key=distance)
        order = dict.fromkeys([*(test.partition("::")[0] for test in reached), *files])
        return reached, [t for name in order for t in self.of_file[name] if t not in files[name]]


def taken(root: Path, out: Path) -> tuple[list[Callable[[Path], Steps]], Callable[[], Map]]:
    """What is left to do for the map, and what reads it afterwards."""
    out.mkdir(parents=True, exist_ok=True)
    files = sorted((root / "tests").glob("test_*.py"))
    shared = [
        p
        for name in (*SOURCES, "generated")
        for p in (root / name).rglob("*")
        if p.suffix in {".py", ".jinja"}
    ]
    shared += [p for p in (root / "tests").glob("*.py") if p not in files]
    base = digest(root, shared)
    keys = {file.stem: f"{base} {digest(root, [file])}" for file in files}
    missing = [stem for stem, key in keys.items() if _kept(out / f"{stem}.json").get("key") != key]

    def read() -> Map:
        found = Map()
        for stem in keys:
            part = _kept(out / f"{stem}.json")
            found.seconds |= part["seconds"]
            for name, tests in part["lines"].items():
                found.lines.setdefault(name, {}).update({test: int(bits, 16) for test, bits in tests.items()})
        return found

    return [_task(stem, keys[stem], out) for stem in missing], read


def digest(root: Path, files: list[Path]) -> str:
    """The digest of files and their names."""
    found = hashlib.sha256()
    for path in sorted(files):
        found.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes() + b"\0")
    return found.hexdigest()[:16]


def _kept(path: Path) -> dict[str, Any]:
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


def _task(stem: str, key: str, out: Path) -> Callable[[Path], Steps]:
    def steps(copy: Path) -> Steps:
        file = f"tests/{stem}.py"
        raw = copy.with_name(f"{copy.name}-raw")
        shutil.rmtree(raw, ignore_errors=True)
        raw.mkdir()
        log, seen = out / f"{stem}.log", raw / "seen.json"
        log.unlink(missing_ok=True)
        yield Run(lambda: _measured(file, copy, raw, seen), _LIMIT_S, log)
        outcomes = _kept(seen)
        failed = [test for test, (_, passed) in outcomes.items() if passed is False]
        if failed:  # those that look at processes or modules are disturbed by what measures
            yield Run(lambda: run_pytest([file], _Outcomes(seen, failed)), _LIMIT_S, log)
            outcomes |= _kept(seen)
        part = {
            "key": key,
            "seconds": {test: round(seconds, 4) for test, (seconds, passed) in outcomes.items() if passed},
            "failed": [test for test, (_, passed) in outcomes.items() if passed is False],
            "lines": dict(_lines(raw, copy, file)),
        }
        new = out / f"{stem}.new"
        new.write_text(json.dumps(part), encoding="utf-8")
        new.replace(out / f"{stem}.json")

    return steps


class _Outcomes:
    """Notes for each test the seconds, and whether it passed; None if it was skipped."""

    def __init__(
        self, out: Path, chosen: list[str] | None = None, cov: coverage.Coverage | None = None
    ) -> None:
        self.out, self.chosen, self.cov = out, chosen, cov
        self.seen: dict[str, tuple[float, bool | None]] = {}

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        if self.chosen is not None:
            items[:] = [item for item in items if item.nodeid in self.chosen]

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        if self.cov is None:
            return (yield)
        os.environ["ECCENTRIC_TEST"] = item.nodeid
        self.cov.switch_context(item.nodeid)
        try:
            return (yield)
        finally:
            self.cov.switch_context("")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        seconds, passed = self.seen.get(report.nodeid, (0.0, True))
        if report.failed:
            passed = False
        elif report.skipped and passed:
            passed = None
        self.seen[report.nodeid] = seconds + report.duration, passed

    def pytest_sessionfinish(self) -> None:
        self.out.write_text(json.dumps(self.seen), encoding="utf-8")


def _measured(file: str, copy: Path, raw: Path, seen: Path) -> int:
    settings = raw / "coveragerc"
    settings.write_text(_SETTINGS.format(copy=copy, raw=raw), encoding="utf-8")
    os.environ["COVERAGE_PROCESS_START"] = str(settings)
    os.environ["ECCENTRIC_TEST"] = file
    cov = coverage.Coverage(config_file=str(settings), context=None)
    cov.set_option("run:context", None)
    cov.start()
    status = run_pytest([file], _Outcomes(seen, cov=cov))
    cov.stop()
    cov.save()
    return status


def _lines(raw: Path, copy: Path, tests: str) -> Iterator[tuple[str, dict[str, str]]]:
    """For each source file the lines that each test executes, as bits in hexadecimal digits."""
    found: dict[str, dict[str, set[int]]] = {}
    for path in raw.glob("data.*"):
        try:
            with sqlite3.connect(path) as data:
                rows = data.execute(
                    "select path, context, numbits from line_bits"
                    " join file on file.id = file_id join context on context.id = context_id"
                ).fetchall()
        except sqlite3.DatabaseError:  # of a process that was killed
            continue
        for name, context, numbits in rows:
            test = found.setdefault(str(Path(name).relative_to(copy)), {}).setdefault(context or tests, set())
            test |= set(numbits_to_nums(numbits))
    for name, each in found.items():
        original = _template_lines(copy, name) if name.endswith(".jinja") else lambda line: line
        yield (
            name,
            {test: f"{sum(1 << n for n in {*map(original, lines)}):x}" for test, lines in each.items()},
        )


def _template_lines(copy: Path, name: str) -> Callable[[int], int]:
    """The line of a template from the line of the Python code that Jinja makes of it."""
    own = name.removeprefix("templates/")
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(copy / "templates"),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=own.startswith("report/"),  # as the package sets it, for the same code
    )
    return environment.get_template(own).get_corresponding_lineno
