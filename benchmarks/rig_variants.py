"""Does one log have one answer? Verdicts under some ten rig files that an engineer might have written instead.

    python benchmarks/rig_variants.py DATA [NAME ...]

DATA holds the folders `measured` and `examples` of logs; NAME is a measured rig or an example, by default all.
Prints the lines of a table, and puts each into docs/measured-rigs.md.
"""

from __future__ import annotations

import argparse
import copy
import json
import re
import sys
import tomllib
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks.measured_logs import ROOT, SETS, measured_log
from benchmarks.record import progress
from eccentric.core import InputError
from eccentric.diagnosis import diagnose
from eccentric.logs import read_log
from eccentric.rigs import read_rig
from eccentric.signals import read_channels

PAGE = ROOT / "docs" / "measured-rigs.md"
SECTION = "## Other rig files\n"
EXAMPLES = ("example1", "example2", "example3", "example4")
LOW_PASS_HZ = 25.0
HEAD = ("| log | answer | same | changed value reported | other answers |", "|---|---|--:|--:|---|")
Rig = dict[str, Any]


def paths(data: Path, name: str) -> tuple[Path, Path]:
    """Log and rig file of a measured rig or an example."""
    if name in SETS:
        return measured_log(data / "measured", name)
    folder = data / "examples"
    return folder / f"{name}.csv.gz", folder / f"{name}.json"


def content(path: Path) -> Rig:
    """The keys of a rig file."""
    text = path.read_text(encoding="utf-8")
    return json.loads(text) if path.suffix == ".json" else tomllib.loads(text)


def variants(rig: Rig, runs: list[str]) -> Iterator[tuple[str, Rig]]:
    """Name and keys of the rig as it is, and with one choice made otherwise; `runs` are those of the log."""
    yield "as it is", rig
    for factor in (0.8, 1.25):
        yield f"bandwidth x {factor}", rig | {"low_pass_hz": factor * rig.get("low_pass_hz", LOW_PASS_HZ)}
    if threshold := rig.get("moving_threshold_rad_s"):
        for factor in (0.7, 1.5):
            yield f"threshold x {factor}", rig | {"moving_threshold_rad_s": factor * threshold}
    if isinstance(rig.get("average_over"), str) and rig["average_over"] != "run":
        for factor in (0.8, 1.25):
            yield f"averages x {factor}", rig | {"average_over": scaled(rig["average_over"], factor)}
    if intervals := rig.get("holdout_intervals_s"):
        later = [[start + 2.0, end + 2.0] for start, end in intervals]
        yield "held out 2 s later", rig | {"holdout_intervals_s": later}
    if held_out := rig.get("holdout_runs"):
        following = [runs[(runs.index(name) + 1) % len(runs)] for name in held_out if name in runs]
        yield "the next runs held out", rig | {"holdout_runs": following}
    for letters, part in ((("R",), 0.02), (("k_i", "k_e"), 0.02), (("J_m", "J_l"), 0.05)):
        names = [n for n in rig.get("known", {}) if any(n == x or n.startswith(f"{x}_") for x in letters)]
        for factor in (1.0 + part, 1.0 - part) if names else ():
            changed = copy.deepcopy(rig)
            changed["known"] |= {n: scaled(rig["known"][n], factor) for n in names}
            yield f"{', '.join(letters)} {100 * (factor - 1):+.0f} %", changed


def scaled(value: float | str, factor: float) -> float | str:
    """A number, or a text that begins with one, times a factor."""
    if not isinstance(value, str):
        return factor * value
    number, _, unit = value.partition(" ")
    return f"{factor * float(number):.9g} {unit}".strip()


@dataclass(frozen=True)
class Answer:
    """The verdict on a variant of a rig file, and the families behind it.

    values: families that only say that a declared value is off, each with its letter; changed: the letters of
    those that were changed.
    """

    label: str
    verdict: str
    families: tuple[str, ...]
    values: Mapping[str, str] = field(default_factory=dict)
    changed: frozenset[str] = frozenset()

    @property
    def leading(self) -> tuple[str, tuple[str, ...]]:
        """Verdict and leading family; a changed value that is told as such counts as told beside it."""
        beside = self.values if self.changed else {}
        effects = tuple(f for f in self.families if f not in beside)
        told_alone = self.verdict == "named" and not effects
        return ("nothing_missing" if told_alone else self.verdict), effects[:1]

    @property
    def told(self) -> bool:
        """Whether a value that was changed is named as such."""
        return any(self.values.get(family) in self.changed for family in self.families)

    def __str__(self) -> str:
        return f"{self.verdict} {', '.join(self.families)}".strip()


def letters_changed(plain: Rig, one: Rig) -> frozenset[str]:
    """Letters of the declared values that differ, J for any inertia: the balance shows only their sum."""
    known = plain.get("known", {})
    keys = {key for key, value in one.get("known", {}).items() if value != known.get(key)}
    letters = ("R", "k_i", "k_e", "J")
    return frozenset(x for x in letters for key in keys if key == x or key.startswith(f"{x}_"))


def answers(log: Path, rig: Path) -> list[Answer]:
    """The verdict and the families behind it, for every variant of a rig file."""
    plain, found = content(rig), []
    runs = list(read_channels([read_log(log)], read_rig(plain)).time.run_names)
    for label, one in variants(plain, runs):
        changed = letters_changed(plain, one)
        try:
            diagnosis = diagnose([log], one)
            a = diagnosis.attribution
            named = [entry.variant.candidate.family for entry in a.adopted]
            families = {"named": named, "not_identifiable": list(a.tied)}.get(a.verdict, [])
            values = {e.family: e.corrects.quantity.name for e in diagnosis.offered if e.corrects is not None}
            answer = Answer(label, a.verdict, tuple(families), values, changed)
        except InputError as error:
            answer = Answer(label, "refused", (str(error),), changed=changed)
        progress(f"{rig.stem}, {label}: {answer}")
        print(f"{rig.stem}, {label}: {answer}", flush=True)
        found.append(answer)
    return found


def row(name: str, found: list[Answer]) -> str:
    """A line of the table: the shipped answer, how many give the same, how many tell a changed value, the others."""
    shipped = found[0]
    others = Counter(str(a) for a in found if a.leading != shipped.leading)
    shown = "; ".join(f"{text} ({times})" for text, times in others.most_common()) or "-"
    same, told = len(found) - others.total(), [a.told for a in found if a.changed]
    return f"| {name} | {shipped} | {same} of {len(found)} | {sum(told)} of {len(told)} | {shown} |"


def write(name: str, line: str) -> None:
    """Put a line of the table into its section of the page, in place of the one that the log has there."""
    text = PAGE.read_text(encoding="utf-8")
    head, section, rest = text.partition(SECTION)
    if not section:
        raise SystemExit(f"{PAGE}: expected a section {SECTION.strip()}")
    there = re.search(r"(?:^\|.*\n)+", rest, flags=re.MULTILINE)
    old = there.group().splitlines()[2:] if there else []
    # Rows of an earlier form of the table go.
    lines = {row.split("|")[1].strip(): row for row in old if row.count("|") == HEAD[0].count("|")}
    lines[name] = line
    rows = [lines[one] for one in (*SETS, *EXAMPLES) if one in lines]
    table = "\n".join([*HEAD, *rows, ""])
    new = rest.replace(there.group(), table, 1) if there else f"\n{table}{rest}"
    PAGE.write_text(head + section + new, encoding="utf-8")


def main() -> None:
    """Diagnose every variant, print and write the lines of the table."""
    parser = argparse.ArgumentParser(description="Verdicts under other rig files.")
    parser.add_argument("data", type=Path, help="folder of the logs")
    parser.add_argument("names", nargs="*", default=[*SETS, *EXAMPLES], help="a measured rig or an example")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    for name in given.names:
        line = row(name, answers(*paths(given.data, name)))
        print(line, flush=True)
        write(name, line)


if __name__ == "__main__":
    main()
