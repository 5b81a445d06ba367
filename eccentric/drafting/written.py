"""A draft as the TOML of a rig file: each line with its evidence, doubts marked, questions commented out."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Iterable, Iterator, Mapping

from eccentric.core import few
from eccentric.drafting.draft import Draft
from eccentric.drafting.proposal import Proposal, RigLine
from eccentric.model import AxisKind
from eccentric.rigs import channels_of

_WIDTH = 100


def toml_of(draft: Draft, name: str) -> str:
    """The text of a rig file; without the questions answered, it may be too little for a fit."""
    lines = [
        "# Drafted by eccentric from the log. # gives the evidence for the next line; #? marks what needs",
        "# attention: a doubt about the next line, or a line to uncomment with a value that no log shows.",
        *(f"# {_line(fact)}" for fact in draft.facts),
        "",
        f"name = {_quoted(name)}",
    ]
    drive = next(
        (
            kind
            for kind in ("current", "torque", "voltage")
            for p in draft.proposals
            if p.channel in (kind, f"{kind}_l")
        ),
        "",
    )
    if drive:
        lines.append(f'drive = "{draft.axis.named(drive)}"')
    lines += [line for entry in draft.entries if entry.table == "" for line in _entry(entry)]
    lines += ["", "[columns]"]
    for proposal in draft.proposals:
        lines += _channel(proposal, draft.axis)
    lines += [line for entry in draft.entries if entry.table == "columns" for line in _entry(entry)]
    for columns, why in folded(draft.left_out):
        lines.append(f"# {_line(f'{columns} left out: {why}')}")
    for table in ("known", "unknown", "added", "drives", "joints"):
        entries = [entry for entry in draft.entries if entry.table == table]
        if entries:
            lines += ["", f"[{table}]", *(line for entry in entries for line in _entry(entry))]
    return "\n".join(lines) + "\n"


def _channel(proposal: Proposal, axis: AxisKind) -> Iterator[str]:
    standard = channels_of(axis)[proposal.channel][1]
    column = _quoted(proposal.column)
    value = column
    if proposal.unit and proposal.unit not in (standard, standard.replace(" ", "")):
        value = f"{{ column = {column}, unit = {_quoted(proposal.unit)} }}"
    yield from _comments(proposal.evidence, proposal.doubt)
    yield f"{axis.named(proposal.channel)} = {value}"


def _entry(entry: RigLine) -> Iterator[str]:
    yield from _comments([entry.evidence], entry.doubt)
    yield f"{'#? ' if entry.asked else ''}{entry.key} = {entry.value}"


def _comments(evidence: Iterable[str], doubt: str) -> Iterator[str]:
    for mark, text in (("# ", "; ".join(evidence)), ("#? ", doubt)):
        if text:
            yield from textwrap.wrap(
                " ".join(_line(text).split()), _WIDTH, initial_indent=mark, subsequent_indent="#   "
            )


def _line(text: str) -> str:
    """A text as part of a comment, which takes neither line breaks nor other control characters."""
    return "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in text)


def _quoted(text: str) -> str:
    """A text as a TOML string: unlike JSON, it has no surrogates and no plain DEL."""
    known = text.encode("utf-8", "replace").decode()
    return json.dumps(known, ensure_ascii=False).replace("\x7f", "\\u007f")


_FOLDED = 4
"""Columns that are left out for one reason from which they share a line."""


def folded(left_out: Mapping[str, str]) -> list[tuple[str, str]]:
    """Columns and why they are no channels; those that share a reason but for its numbers together."""
    alike: dict[str, list[str]] = {}
    for column, why in sorted(left_out.items()):
        alike.setdefault(re.sub(r"\d+(\.\d+)?", "#", why), []).append(column)
    found: list[tuple[str, str, str]] = []
    for columns in alike.values():
        why = left_out[columns[0]]
        if len(columns) < _FOLDED:
            found += [(column, column, left_out[column]) for column in columns]
        elif all(left_out[column] == why for column in columns):
            found.append((columns[0], f"{len(columns)} columns ({few(columns)})", why))
        else:
            found.append((columns[0], f"{len(columns)} columns ({few(columns)})", f"{why}, or similar"))
    return [(columns, why) for _, columns, why in sorted(found)]
