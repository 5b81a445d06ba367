"""Every required figure beside what is measured and its peers: benchmarks/results.md and its figure.

Run: python benchmarks/page.py [--quick] [PART ...]     (with parts named, theirs alone are printed and renewed)
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import subprocess
import sys
import traceback
from collections.abc import Callable, Mapping
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks import (
    accuracy,
    arms,
    arms_diagnosis,
    calls,
    checks,
    commands,
    derivation,
    diagnosis,
    drafted,
    empirical,
    field,
    figure,
    fleet,
    fuzz,
    host,
    intervals,
    long,
    loops,
    planned,
    protection,
    rest,
    simulated,
    simulators,
    speed,
    strangers,
    target,
)
from benchmarks.asked import CODE, DIAGNOSIS
from benchmarks.record import Part, progress, table

HERE = Path(__file__).resolve().parent
PARTS: dict[str, tuple[str, Callable[[bool], Part]]] = {
    "derivation": ("Derivation", derivation.measured),
    "commands": ("Commands", commands.measured),
    "protection": ("Protection", protection.measured),
    "speed": ("NumPy and compiled C", speed.measured),
    "host": ("C on the host, arrays", host.measured),
    "calls": ("C on the host, single calls", calls.measured),
    "target": ("C on a Cortex-M4F", target.measured),
    "rest": ("Friction at rest", rest.measured),
    "simulated": ("Simulated motion", simulated.measured),
    "simulators": ("Simulators", simulators.measured),
    "arms": ("Arms", arms.measured),
    "accuracy": ("Accuracy", accuracy.measured),
    "checks": ("Checks", checks.measured),
    "field": ("In the field", field.measured),
    "loops": ("In a loop", loops.measured),
    "long": ("Long logs", long.measured),
    "cost": ("The cost of fleets", fleet.cost),
    "fleet": ("Fleets", fleet.found),
    "readers": ("Fuzzed readers", fuzz.measured),
    "intervals": ("Intervals", intervals.measured),
    "drafted": ("Drafted rigs", drafted.measured),
    "strangers": ("Strangers' files", strangers.measured),
    "plan": ("The next measurement", planned.measured),
    "diagnosis": ("Diagnosis", diagnosis.measured),
    "joints": ("Diagnosis of arms", arms_diagnosis.measured),
    "empirical": ("A term without a cause", empirical.measured),
}
"""What is timed comes first, each by itself."""
PICTURE = "![speed against array size, error against distance from the zero of F_N](results.svg)"


def main() -> int:
    """Measure, write the page, print its tables; status 1 if a part could not be measured."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="fewer rounds, states, inputs and logs")
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"one of {', '.join(PARTS)}")
    wanted = parser.parse_args()
    if unknown := set(wanted.parts) - set(PARTS):
        parser.error(f"no part of the benchmark: {', '.join(sorted(unknown))}")
    found, failed = {}, False
    for name in wanted.parts or PARTS:
        try:
            found[name] = PARTS[name][1](wanted.quick)
        except Exception as error:  # noqa: BLE001 - one failed part must not lose an hour of other figures
            traceback.print_exc()
            failed, reason = True, (str(error).strip().splitlines() or [""])[-1]
            found[name] = Part({}, [f"Not measured: {type(error).__name__}: {reason}"])
        progress("")
    if wanted.parts:
        print("\n".join([*details(found), *summary(found, whole=False)]))
        if not (failed or wanted.quick):
            path = HERE / "results.md"
            path.write_text(renewed(path.read_text(encoding="utf-8"), found), encoding="utf-8")
    else:
        if curves := found["speed"].curves:
            figure.draw(curves, HERE / "results.svg")
        (HERE / "results.md").write_text(page(found, wanted.quick), encoding="utf-8")
        print("\n".join(summary(found)))
    return int(failed)


def page(found: Mapping[str, Part], quick: bool) -> str:
    """The page as Markdown."""
    return "\n".join(
        [
            "# Benchmarks",
            "",
            f"`make bench` writes this page{', here in its quick form (`--quick`)' if quick else ''}."
            f" {platform.machine()}, {os.cpu_count()} shared cores, Linux, {_compiler()},"
            f" Python {platform.python_version()}.",
            "Times are medians of paired rounds on one core; the emitted code is that of case C2 with the parameters of"
            " Table 1 unless stated otherwise.",
            "Tests check that results have the same bits for every array shape, that memory is bounded by the block, and"
            " that sanitizers and compilers report nothing.",
            "",
            *summary(found),
            PICTURE,
            "",
            *details(found),
        ]
    )


def summary(found: Mapping[str, Part], whole: bool = True) -> list[str]:
    """The tables of what is required, measured or not; if not whole, only what was measured."""
    figures = {key: one for part in found.values() for key, one in part.figures.items()}
    lines = []
    for title, asked in (("The emitted code", CODE), ("The diagnosis", DIAGNOSIS)):
        rows = {key: one for key, one in asked.items() if whole or key in figures}
        if rows:
            lines += [f"## {title}", "", *table(rows, figures), ""]
    return lines


def renewed(text: str, found: Mapping[str, Part]) -> str:
    """The page with the rows and sections of some parts as they are now, and all others as they were."""
    said = {line.split(" | ")[0]: line for line in text.splitlines() if line.startswith("| ")}
    now = {line.split(" | ")[0]: line for line in summary(found, whole=False) if line.startswith("| ")}
    tables = [now.get(line.split(" | ")[0], said.get(line.split(" | ")[0], line)) for line in summary({})]
    titles = [title for title, _ in PARTS.values()]
    kept = {
        section.splitlines()[0].removeprefix("## "): section.rstrip()
        for section in re.split(r"(?m)^(?=## )", text)[1:]
    }
    fresh = {PARTS[name][0]: "\n".join(details({name: part})).rstrip() for name, part in found.items()}
    sections = [fresh.get(title) or kept.get(title, "") for title in titles]
    head = text[: text.index("## ")]
    return "\n".join([head.rstrip(), "", *tables, PICTURE, "", *(f"{one}\n" for one in sections if one)])


def details(found: Mapping[str, Part]) -> list[str]:
    """What each part reports beyond the required figures."""
    return [
        line
        for name, part in found.items()
        if part.details
        for line in (f"## {PARTS[name][0]}", "", *part.details, "")
    ]


def _compiler() -> str:
    said = subprocess.run(["gcc", "-dumpfullversion"], capture_output=True, text=True, check=False)
    return f"gcc {said.stdout.strip()}"


if __name__ == "__main__":
    sys.exit(main())
