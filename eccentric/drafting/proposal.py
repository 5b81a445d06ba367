"""What is proposed for a channel or a key of a rig: a value, its evidence in words, and any doubt."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, replace

from eccentric.model import DRIVE_PARTS

BY_SIZE = "unit only from its size"
"""The doubt of a unit that neither a name nor another column shows."""


@dataclass(frozen=True)
class Proposal:
    """A channel of the rig and its column.

    Attributes:
        channel: as in `eccentric.rigs.CHANNELS`.
        source: the name of a column, or arithmetic on columns.
        unit: in the spelling of rig files; empty where the channel has none.
        evidence: what speaks for it.
        confidence: probability, 0 to 1.
        doubt: what else it could be, empty if nothing is close.
        turned: whether its sign is.
        reads: names of the columns in arithmetic; of a plain name, nothing.
        constant: of a current, the torque constant by which a column was computed, and the evidence.
        by_gravity: what of the evidence follows from gravity.
    """

    channel: str
    source: str
    unit: str
    evidence: tuple[str, ...]
    confidence: float
    doubt: str = ""
    turned: bool = False
    reads: tuple[str, ...] = ()
    constant: tuple[str, str] = ("", "")
    by_gravity: tuple[str, ...] = ()

    def doubted(self, doubt: str) -> Proposal:
        """The same with one more doubt, if there is one."""
        return replace(self, doubt="; ".join(filter(None, (self.doubt, doubt))))

    @property
    def column(self) -> str:
        """As a rig file names it."""
        return f"-{quoted(self.source)}" if self.turned else self.source


def quoted(name: str) -> str:
    """A column name as arithmetic takes it."""
    return name if name.isidentifier() else f"`{name}`"


@dataclass(frozen=True)
class RigLine:
    """Another line of the rig: a table ("" for the top), key and value as TOML.

    With `asked` it is a question that the log cannot answer: written as a comment, with a typical value.
    A fit cannot do without those that are `needed`. A value that is `guessed` was read off the log, which
    hardly shows it.
    """

    table: str
    key: str
    value: str
    evidence: str
    doubt: str = ""
    asked: bool = False
    needed: bool = False
    guessed: bool = False


def known_asked(key: str, typical: str, evidence: str, *, needed: bool = False) -> RigLine:
    """A question about a value of [known], with a typical one."""
    return RigLine("known", key, f'"{typical}"', evidence, asked=True, needed=needed)


_USUAL = {"motor": "brushless", "bearing": "ball", "lubricant": "grease"}


def asked_parts(gear: str) -> list[RigLine]:
    """Questions about what the drive is made of, with this gear as a typical one: no log shows it."""
    usual = {"gear": gear, **_USUAL}
    return [
        RigLine("", kind, json.dumps(usual[kind]), f"{kind}: {', '.join(words)}", asked=True)
        for kind, words in DRIVE_PARTS.items()
    ]


def computed_by(drives: Iterable[Proposal], asked: RigLine) -> RigLine:
    """The line of a torque constant: that by which a column was computed from the current, else as asked."""
    for drive in drives:
        value, evidence = drive.constant
        if value:
            return RigLine(asked.table, asked.key, json.dumps(value), evidence, asked.evidence)
    return asked
