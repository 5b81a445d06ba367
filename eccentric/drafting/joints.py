"""Which columns belong to which of several joints: names that differ by a number or a word."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from eccentric.core import few
from eccentric.drafting import limits
from eccentric.drafting.balance import balance_of, motion_from
from eccentric.drafting.columns import Grid, LoggedColumn
from eccentric.drafting.words import read_name

_SLOW = ("temperature",)
_MOTIONS, _DRIVES = ("angle", "speed"), ("current", "torque", "voltage", "duty")
_SIDES = re.compile(
    r"(?<![a-z])(left|right|front|rear|shoulder|elbow|wrist|hip|knee|ankle|pan|tilt|yaw|pitch|roll|x|y|z|l|r|a|b)(?![a-z])",
    re.IGNORECASE,
)


OF_NONE = "of no joint"


@dataclass(frozen=True)
class JointColumns:
    """The joint that is drafted.

    Attributes:
        key: what names it among the others, such as "3" or "left"; "" where the log has one joint only.
        others: column -> joint that it belongs to, of all others.
        own: the columns of this joint.
        doubt: which others move as well, "" if none does.
    """

    key: str = ""
    others: Mapping[str, str] = field(default_factory=dict)
    own: frozenset[str] = frozenset()
    doubt: str = ""

    def of_its_own(self, rest: Sequence[LoggedColumn]) -> tuple[list[LoggedColumn], dict[str, str]]:
        """The columns without drives of no joint, where this one has its own, and why not those."""
        own = [c for c in rest if c.text in self.own and c.name.quantity in _DRIVES and np.any(c.values)]
        if not own:
            return list(rest), {}
        left = [c for c in rest if c.name.quantity in _DRIVES and c.name.signal and c.text not in self.own]
        why = f"{OF_NONE}; {own[0].text} is of {joint_called(self.key)}"
        return [c for c in rest if c not in left], {c.text: why for c in left}


def joint_called(key: str) -> str:
    """What messages call a joint: "joint 3" and "joint left", and as its key says where that is "motor 3"."""
    return key if re.match(r"[^\W\d_]+ \d", key) else f"joint {key}"


def joint_of(columns: Mapping[str, LoggedColumn], grid: Grid) -> JointColumns:
    """The joint that moves: of several that do, one whose own drive varies, then the one that goes furthest.

    Where one drive has no joint, the joint whose motion explains it best.
    """
    families = _families(columns)
    of = {name: key for members in families for key, name in members.items()}
    moved: dict[str, dict[str, float]] = {kind: {} for kind in _MOTIONS}
    by: dict[str, dict[str, LoggedColumn]] = {}
    driven: set[str] = set()
    for members in families:
        kind = columns[next(iter(members.values()))].name.quantity
        largest = max(columns[name].range for name in members.values())
        for key, name in members.items():
            if kind in _DRIVES and columns[name].varies > limits.HARDLY:
                driven.add(key)
            if kind in _MOTIONS and largest > 0.0:
                moved[kind][key] = max(moved[kind].get(key, 0.0), columns[name].range / largest)
                by.setdefault(key, {}).setdefault(kind, columns[name])
    travel = moved["angle"] or moved["speed"]
    if not travel:
        return JointColumns()
    move = [key for key, much in travel.items() if much > limits.MOVES]
    best = max(travel, key=lambda key: (key in move and key in driven, travel[key]))
    if len(move) > 1 and best not in driven:
        common = [c for n, c in columns.items() if n not in of and _could_drive(c)]
        best = max(move, key=lambda key: _explained(grid, by[key], common))
    also = [key for key in move if key != best]
    doubt = (
        f"{joint_called(best)} is drafted, {few(also)} move{'s' if len(also) == 1 else ''} as well:"
        " a rig has one; --arm reads all joints of an arm"
    )
    others = {name: key for name, key in of.items() if key != best}
    own = frozenset(name for name, key in of.items() if key == best)
    return JointColumns(best, others, own, doubt if also else "")


def _could_drive(column: LoggedColumn) -> bool:
    name = column.name
    return name.signal and name.quantity in ("", *_DRIVES) and column.varies > limits.HARDLY


def _explained(grid: Grid, motion: Mapping[str, LoggedColumn], drives: Sequence[LoggedColumn]) -> float:
    """How much of one of the drives a motion explains at most."""
    moved = motion_from(grid, motion.get("angle"), motion.get("speed"))
    balances = (balance_of(moved, grid.smooth(one), periodic=False) for one in drives[: limits.TRIED])
    return max((one.r2 for one in balances if one is not None), default=0.0)


def _families(columns: Mapping[str, LoggedColumn]) -> list[dict[str, str]]:
    """Columns of one quantity for several joints: joint -> column; the kind of key that most columns have."""
    best: list[dict[str, str]] = []
    for patterns in (_by_path, _by_word, _by_number):
        seen: dict[tuple[str, str], dict[str, str]] = {}
        for name, column in columns.items():
            if column.name.quantity in (*_MOTIONS, *_DRIVES, *_SLOW) and column.name.signal:
                for pattern, key in patterns(name):
                    seen.setdefault((pattern, column.name.quantity), {})[key] = name
        found = [members for members in seen.values() if len(members) > 1]
        kinds = {columns[name].name.quantity for members in found for name in members.values()}
        # Three currents and voltages beside one motion are phases, no joints.
        if kinds & set(_MOTIONS) and _count(found) > _count(best):
            best = found
    return best


def _count(families: Sequence[Mapping[str, str]]) -> int:
    return len({name for members in families for name in members.values()})


def _by_number(name: str) -> Iterator[tuple[str, str]]:
    for place in re.finditer(r"\d+", name):
        yield f"{name[: place.start()]}{{}}{name[place.end() :]}", place[0]


def _by_word(name: str) -> Iterator[tuple[str, str]]:
    for place in _SIDES.finditer(name.replace("_", " ")):
        yield f"{name[: place.start()]}{{}}{name[place.end() :]}", place[0].lower()


def _by_path(name: str) -> Iterator[tuple[str, str]]:
    parts = name.split("/")
    for k, part in enumerate(parts[:-1]):
        said = read_name(part)
        # The topics of a state and of a command are no joints.
        if part and not said.quantity and not said.role and not part.isdigit():
            yield "/".join([*parts[:k], "{}", *parts[k + 1 :]]), part
