"""Logs as strangers published them, and small inputs that once failed: what a draft makes of each.

    python benchmarks/strangers.py [--show] [--data DATA] [PATTERN ...]

A log is judged by the `about.toml` beside it alone: which columns are right for a channel, in which unit, on which
side, and which columns must never be drafted. A fault is judged by the words and values that its answer must hold.
"""

from __future__ import annotations

import argparse
import collections
import fnmatch
import math
import re
import sys
import tomllib
import traceback
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks.record import Measured, Part, progress
from benchmarks.strangers_faults import Answer, answers
from eccentric.api.drafted import RigDraft, draft_rig
from eccentric.api.fitted import fit
from eccentric.core import InputError
from eccentric.drafting import Proposal
from eccentric.logs import parse_unit

DATA = Path(__file__).resolve().parents[2] / "shared" / "data" / "field"
_DRIVES = ("current", "voltage", "torque", "force")
_BESIDE = ("temperature", "motor_off", "use")
RIGHT, ASKED, WRONG, REFUSED, LEFT, BROKEN = "right", "asked", "wrong", "refused", "no draft", "traceback"


@dataclass(frozen=True)
class Verdict:
    """What became of a log: one of the words above, and the reasons, one line each."""

    name: str
    verdict: str
    reasons: tuple[str, ...] = ()
    fitted: str = ""


def judged_log(folder: Path, about: Mapping[str, Any]) -> Verdict:
    """The draft of one log against what is known of it."""
    name = f"{folder.name}/{about['file']}"
    try:
        draft = draft_rig(folder / about["file"])
    except InputError as error:
        wanted = about.get("refused")
        if wanted is None:
            return Verdict(name, LEFT, (_said(error, folder),))
        return Verdict(
            name, REFUSED, (_said(error, folder), f"because: {wanted['because']}", f"mend: {wanted['mend']}")
        )
    except Exception as error:  # noqa: BLE001 - a traceback is what is looked for
        return Verdict(name, BROKEN, (traceback.format_exception_only(error)[-1].strip(),))
    if "draft" not in about:
        return Verdict(name, WRONG, (f"drafted, though {about['refused']['because']}",))
    faults = [
        *_channels(draft, about["draft"]),
        *_lines(draft, about["draft"]),
        *_never(draft, about["draft"]),
    ]
    silent = [said for said, doubted in faults if not doubted]
    verdict = WRONG if silent else ASKED if faults else RIGHT
    return Verdict(name, verdict, tuple(said for said, _ in faults))


def _said(error: InputError, folder: Path) -> str:
    """A message without the place of the data."""
    return str(error).replace(f"{folder}/", "")


def _kind(channel: str) -> str:
    return channel.removesuffix("_m").removesuffix("_l")


def _channels(draft: RigDraft, known: Mapping[str, Any]) -> Iterator[tuple[str, bool]]:
    """What is wrong with the channels, and whether it is doubted."""
    expected = {
        key: value
        for key, value in known.items()
        if isinstance(value, Mapping) and key != "never" and "columns" in value
    }
    open_ends = [set(one) for one in known.get("either", ())]
    for p in draft.proposals:
        key = next((k for k in (p.channel, _kind(p.channel)) if k in expected), "")
        if not key:
            key = next((k for k, v in expected.items() if p.channel in v.get("other_channels", ())), "")
        if not key:
            other = any(p.channel in one for one in open_ends) or p.channel in _BESIDE
            if not other:
                yield f"{p.channel} = {p.column}: not of this log", bool(p.doubt)
            continue
        of = expected[key]
        read = p.reads or (p.source,)
        if not any(column in of["columns"] for column in read) and "'" not in of["columns"][0]:
            yield f"{p.channel} = {p.column}: {' or '.join(of['columns'])} is right", bool(p.doubt)
        elif not _same_unit(p, of):
            yield f"{p.channel} = {p.column} [{p.unit}]: {of['unit']} is right", bool(p.doubt)
        side = p.channel[len(_kind(p.channel)) + 1 :]
        if "side" in of and side and side not in of["side"]:
            yield f"{p.channel}: side {' or '.join(of['side'])} is right", bool(p.doubt)
    for key, of in expected.items():
        kinds = {key, *of.get("other_channels", ())}
        if not of.get("optional") and not any({p.channel, _kind(p.channel)} & kinds for p in draft.proposals):
            yield f"{key}: missing ({' or '.join(of['columns'])})", True
    for one in known.get("either", ()):
        if any(key in one for key in ("current", "torque")) and _fits(draft, one):
            break
    else:
        if "either" in known:
            yield "motion and drive of different machines", False


def _fits(draft: RigDraft, one: Mapping[str, str]) -> bool:
    """Whether motion and drive are of one actuator: its first word names it."""
    motion = [p.source.split()[0] for p in draft.proposals if _kind(p.channel) in ("theta", "omega")]
    drive = [(p.channel, p.source) for p in draft.proposals if p.channel in _DRIVES]
    key = "current" if "current" in one else "torque"
    return all(word in one["motion"].split() for word in motion) and drive == [(key, one[key])]


def _same_unit(p: Proposal, of: Mapping[str, Any]) -> bool:
    """Whether a unit is the known one, or one of those named beside it; a unit in words is for reading."""
    allowed = [of.get("unit", ""), *of.get("other_units", ())]
    if "," in allowed[0]:  # "rad, or rev for c1"
        allowed = ["rad", "rev", "rad/s", "rev/s", "Hz"]
    if p.unit in allowed or not allowed[0]:
        return True
    try:
        own = parse_unit(p.unit, "", 1.0)
        return any(
            own.dimension == (there := parse_unit(unit, "", 1.0)).dimension
            and math.isclose(own.factor, there.factor, rel_tol=1e-6)
            for unit in allowed
        )
    except InputError:
        return bool(p.doubt)


def _lines(draft: RigDraft, known: Mapping[str, Any]) -> Iterator[tuple[str, bool]]:
    """Case, gear, kind and drive against those that are right."""
    content = tomllib.loads(draft.text)
    table = content.get("known", {})
    doubts = {doubt.split(":")[0] for doubt in draft.doubts}
    if "case" in known and table.get("case") not in (None, *known["case"]):
        yield f"case = {table['case']}", "case" in doubts
    if "mu" in known and "mu" in table:
        over, _, under = str(table["mu"]).partition("/")
        if float(over) / float(under or 1) not in known["mu"]:
            yield f"mu = {table['mu']}", "mu" in doubts
    if "drive" in known and content.get("drive") not in known["drive"]:
        yield f"drive = {content.get('drive')}", False
    if "kind" in known and content.get("kind") not in known["kind"]:
        yield f"kind = {content.get('kind', 'rotary')}", any("kind" in d for d in draft.doubts)


def _never(draft: RigDraft, known: Mapping[str, Any]) -> Iterator[tuple[str, bool]]:
    """What must not be drafted, doubted or not."""
    never = known.get("never", {})
    for p in draft.proposals:
        columns = {name.split("(:,")[0] for name in (p.reads or (p.source,))} | {p.source}
        for kind in ("any", "drive" if p.channel in (*_DRIVES, "torque_l") else "", _kind(p.channel)):
            if hit := columns & set(never.get(kind, ())):
                yield f"{p.channel} = {hit.pop()}: never", False
    for key in never.get("keys", ()):
        if any(line.startswith(key) for line in draft.text.splitlines()):
            yield f"{key}: never", False


def fitted_log(folder: Path, file: str, published: Sequence[Mapping[str, Any]]) -> str:
    """The fit with the rig file that a user ends with, where there is one: values beside published ones."""
    rig = folder / f"rig-{Path(file).stem}.toml"
    if not rig.exists():
        return ""
    try:
        found = fit(folder / file, rig)
    except InputError as error:
        return f"no fit: {_said(error, folder)}"
    except Exception as error:  # noqa: BLE001 - a traceback is what is looked for
        return f"TRACEBACK: {error}"
    said = []
    for name, one in found.estimates.items():
        low, high = one.interval
        beside = next((p for p in published if str(p["quantity"]).split()[0] == name), None)
        text = f"{name} {one.value:.3g} ({low:.3g} to {high:.3g}) {one.unit}"
        said.append(f"{text}, published {beside['value']:.3g}" if beside else text)
    return "; ".join(said)


def logs_of(data: Path, patterns: Sequence[str] = ()) -> Iterator[tuple[Path, dict[str, Any], list[Any]]]:
    """Folder, entry and published values of every log."""
    for about in sorted((data / "logs").glob("*/about.toml")):
        content = tomllib.loads(about.read_text(encoding="utf-8"))
        for entry in content["logs"]:
            name = f"{about.parent.name}/{entry['file']}"
            if not patterns or any(fnmatch.fnmatch(name, f"*{one}*") for one in patterns):
                yield about.parent, entry, content.get("published", [])


def measure(data: Path, patterns: Sequence[str] = (), *, fits: bool = True) -> list[Verdict]:
    """The verdict of every log."""
    found = []
    for folder, entry, published in logs_of(data, patterns):
        progress(f"strangers: {folder.name}/{entry['file']}")
        one = judged_log(folder, entry)
        fitted = fitted_log(folder, entry["file"], published) if fits else ""
        found.append(Verdict(one.name, one.verdict, one.reasons, fitted))
    return found


def part(logs: Sequence[Verdict], faults: Sequence[Answer]) -> Part:
    """The figures and tables of the page."""
    count = collections.Counter(one.verdict for one in logs)
    good = count[RIGHT] + count[ASKED] + count[REFUSED]
    told = sum(one.as_wanted for one in faults)
    lines = [
        f"{len(logs)} logs as their authors published them; {count[RIGHT]} drafted right,"
        f" {count[ASKED]} with questions or doubts, {count[REFUSED]} refused where a refusal is right,"
        f" {count[WRONG]} wrong without a doubt, {count[LEFT]} refused though they have a draft,"
        f" {count[BROKEN]} with a traceback.",
        "",
        "| log | draft | what differs | fit with the source's rig |",
        "|---|---|---|---|",
        *(_row(one) for one in logs),
        "",
        f"Small inputs that once failed: {told} of {len(faults)} give the expected answer.",
        "",
        "| input | as wanted | what differs |",
        "|---|---|---|",
        *(f"| {one.name} | {'yes' if one.as_wanted else 'no'} | {_cell([one.why])} |" for one in faults),
    ]
    return Part(
        {
            "strangers": Measured(100.0 * good / max(len(logs), 1), f"{good} of {len(logs)}"),
            "strangers wrong": Measured(count[WRONG] + count[BROKEN], f"{count[WRONG] + count[BROKEN]}"),
            "strangers faults": Measured(100.0 * told / max(len(faults), 1), f"{told} of {len(faults)}"),
        },
        lines,
    )


def _row(one: Verdict) -> str:
    """Of a refusal what it says, without the values that it shows in brackets."""
    reasons = one.reasons[:3]
    if one.verdict in (REFUSED, LEFT):
        reasons = (re.sub(r" ?\([^()]*\)", "", one.reasons[0].split(": ", 1)[-1]),)
    return f"| {one.name} | {one.verdict} | {_cell(reasons)} | {_cell([one.fitted])} |"


def _cell(texts: Sequence[str]) -> str:
    said = "; ".join(" ".join(text.split()) for text in texts if text).replace("|", "\\|")
    return f"{said[:297]}..." if len(said) > 300 else said


def measured(quick: bool) -> Part:
    """All logs and inputs; the drafts alone if quick."""
    if not DATA.is_dir():
        return Part({}, ["Not measured: the logs are not bundled."])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return part(measure(DATA, fits=not quick), [] if quick else answers(DATA / "faults"))


def main() -> None:
    """Measure, print the verdicts with all their reasons, and the table."""
    parser = argparse.ArgumentParser(description="Logs that strangers published, and small inputs.")
    parser.add_argument("patterns", nargs="*", help="parts of names of logs or inputs; all by default")
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--show", action="store_true", help="whole messages and answers, to be read")
    parser.add_argument("--no-fits", action="store_true")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    logs = measure(given.data, given.patterns, fits=not given.no_fits)
    faults = answers(given.data / "faults", given.patterns)
    if given.show:
        for one in logs:
            print(
                "\n  ".join(
                    [f"{one.verdict:9} {one.name}", *one.reasons, *([one.fitted] if one.fitted else [])]
                )
            )
        for answer in faults:
            print(
                f"{'as wanted' if answer.as_wanted else 'OTHERWISE'} {answer.name}: {answer.why}\n{answer.said}"
            )
    else:
        print("\n".join(part(logs, faults).details))


if __name__ == "__main__":
    main()
