"""The first table of docs/measured-rigs.md: a line for each drive and joint that others measured.

    python benchmarks/measured_lines.py FIELD [NAME ...]

FIELD has one folder for each stranger's log, with its rig files; NAME is one of docs/measured/remarks.toml, by
default every log of FIELD. Each is diagnosed with its rig file and the parts of its drive that the remarks add.
`measured_rigs.py` and `measured_arms.py` remember the lines of theirs. Writes docs/measured/lines.json and the
table of the page; the objections are a person's, in remarks.toml.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tomllib
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from eccentric.core import InputError
from eccentric.diagnosis import Diagnosis, diagnose
from eccentric.model import ANGLE, NO_PART

ROOT = Path(__file__).resolve().parent.parent
PAGE, MEASURED = ROOT / "docs" / "measured-rigs.md", ROOT / "docs" / "measured"
LINES, REMARKS = MEASURED / "lines.json", MEASURED / "remarks.toml"
MARK = re.compile(r"(<!-- lines -->\n).*?(<!-- end -->)", re.DOTALL)
HEAD = ("drive", "parts", "cause named", "estimates and ranges", "result", "a specialist's comment")
Line = dict[str, str]


def main() -> None:
    """Diagnose the strangers' logs, write their lines and the table; lines of logs not named stay."""
    parser = argparse.ArgumentParser(description="The first table of docs/measured-rigs.md.")
    parser.add_argument("field", type=Path, help="folder of the strangers' logs")
    parser.add_argument("names", nargs="*", help="folder/file of a log")
    args = parser.parse_args()
    every = {one["name"]: one.get("parts", {}) for one in remarks() if "/" in one["name"]}
    if unknown := set(args.names) - set(every):
        parser.error(f"{min(unknown)}: required one of {', '.join(every)}")
    for name in args.names or every:
        remember({name: _of_a_stranger(args.field / name, every[name])})
        print(name, json.loads(LINES.read_text(encoding="utf-8"))[name])
    write()


def remarks() -> list[dict[str, Any]]:
    """The entries of remarks.toml, in the order of the table."""
    return tomllib.loads(REMARKS.read_text(encoding="utf-8"))["line"]


def remember(lines: dict[str, Line]) -> None:
    """Add lines to those that are kept, in the place of older ones."""
    kept = json.loads(LINES.read_text(encoding="utf-8")) if LINES.is_file() else {}
    text = json.dumps(dict(sorted((kept | lines).items())), indent=1, ensure_ascii=False)
    LINES.write_text(text + "\n", encoding="utf-8")


def _of_a_stranger(log: Path, parts: dict[str, str]) -> Line:
    rig = tomllib.loads((log.parent / f"rig-{log.stem}.toml").read_text(encoding="utf-8"))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return line_of(diagnose([log], rig | parts))
    except InputError as error:
        # The first clause: what else may help is for the person who has the log.
        why = str(error.inside("rig")).replace(f"{log.parent}/", "").replace(log.name, "the log")
        why = re.split(r"[;:] | \(first", why.removeprefix("the log: "))[0]
        made_of = {kind: (word,) for kind, word in parts.items()}
        return {"made of": _made_of(made_of), "cause": "-", "ranges": "-", "says": f"refused: {why}"}


def line_of(found: Diagnosis) -> Line:
    """What a diagnosis says, in the cells of its line."""
    a, score, axis = found.attribution, found.score, found.rig.axis
    named = [effect.id for effect, _ in (*found.effects, *found.undecided, *found.clear)]
    low, high = score.interval
    gain = f"{score.percent:.0f} % lower held-out error ({low:.0f} to {high:.0f})"
    depends = ", ".join(axis.named(v).replace("_", " ") for v in a.depends_on[:3])
    lacking = {effect.id for effect in found.offered if effect.lacks(found.rig.parts)}
    ruled_out = "".join(
        f"; {c.id} is excluded by the parts of the drive"
        if c.id in lacking
        else f"; the log covers too small an angle to prove {c.id}"
        for c in a.ruled_out
    )
    says = {
        "named": gain,
        "not_identifiable": f"not distinguished: {', '.join(a.tied)}; {gain}",
        "unexplained": f"unexplained; depends on {depends}{ruled_out}",
        "nothing_missing": "nothing more can be proved",
    }[a.verdict]
    if a.unconfirmed:
        says = f"unexplained: {', '.join(a.unconfirmed)} did not predict the held-out part"
    if found.models.misfit:
        says = f"does not fit the rig: {found.models.misfit}"
    ranges = [
        f"{check.known.name.removeprefix('the ')}: {check.value:.3g} {check.known.unit},"
        f" **{check.outside}** {check.known.low:.3g} to {check.known.high:.3g}"
        if check.outside
        else f"{check.known.name.removeprefix('the ')}: {check.value:.3g} {check.known.unit},"
        f" {'within' if check.known.low <= check.value <= check.known.high else 'too uncertain to compare with'}"
        f" {check.known.low:.3g} to {check.known.high:.3g}"
        for check in found.ranges
    ]
    return {
        "made of": _made_of(found.rig.parts),
        "cause": ", ".join(f"`{name}`" for name in named) or "-",
        "ranges": "; ".join(ranges) or "-",
        "says": says,
    }


def _made_of(parts: Mapping[str, Sequence[str]]) -> str:
    words = (
        f"no {kind}" if NO_PART in own else " + ".join(own) for kind, own in parts.items() if kind != ANGLE
    )
    return ", ".join(words) or "not declared"


def write() -> None:
    """Put the table into the page. SystemExit where the page has no place for it."""
    kept = json.loads(LINES.read_text(encoding="utf-8"))
    rows = [HEAD, ("---",) * len(HEAD)]
    for one in remarks():
        line = kept.get(one["name"], dict.fromkeys(("made of", "cause", "ranges", "says"), "not run"))
        cells = (one["drive"], line["made of"], line["cause"], line["ranges"], line["says"], one["objection"])
        rows.append(tuple(cell.replace("|", "&#124;") or "-" for cell in cells))
    table = "".join(f"| {' | '.join(row)} |\n" for row in rows)
    page = PAGE.read_text(encoding="utf-8")
    if len(MARK.findall(page)) != 1:
        raise SystemExit(f"{PAGE}: expected one place for the table, <!-- lines --> ... <!-- end -->")
    PAGE.write_text(MARK.sub(lambda m: m[1] + table + m[2], page), encoding="utf-8")


if __name__ == "__main__":
    main()
