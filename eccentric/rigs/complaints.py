"""Everything that is wrong with a rig file, not only the first of it.

`read_rig` stops at the first error, as every command does; this is for the person who mends the file. Each
entry of a single drive's rig is read by itself. Those of an arm's belong together (drives by the number of
joints, a motion and a drive among the columns): what the first error names is left out, and so on.
"""

from __future__ import annotations

import itertools
import os
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from eccentric.core import InputError, few, given_path, read_document, shown
from eccentric.model import AXES, TURNING, AxisKind
from eccentric.rigs.arm_rig import ArmRig, arm_content, arm_rig_of
from eccentric.rigs.entries import plain_entries
from eccentric.rigs.known import knowns_of
from eccentric.rigs.rig import keys_of, read_rig, rig_of
from eccentric.rigs.sources import channels_of

Place = tuple[str, str]
_TABLES = ("known", "unknown", "columns", "added")
_TABLES_OF_ARMS = ("columns", "drives", "joints")
_CASE = {"case": "C2"}


@dataclass(frozen=True)
class Complaint:
    """What is wrong with a rig, in one line, and the entry that it is about: table and key, "" for none."""

    text: str
    table: str = ""
    key: str = ""


def rig_complaints(
    source: str | os.PathLike[str] | Mapping[str, Any],
) -> tuple[list[Complaint], dict[str, Any]]:
    """Return what is wrong with the rig of a single drive, and the rig without it.

    Raises:
        InputError: the file cannot be read at all.
    """
    if isinstance(source, str | os.PathLike):
        path = given_path(source, "rig")
        content, where = dict(read_document(path, "a rig file")), shown(path)
    else:
        content, where = dict(plain_entries(source, "rig")), "rig"
    found: list[Complaint] = []
    kind = content.get("kind")
    axis = AXES.get(kind, TURNING) if isinstance(kind, str) else TURNING
    if other := _of_another(content, axis):
        axis, keys = other
        # Each of them is right then: the rest is read as the rig of that axis.
        content["kind"] = axis.name
        error = InputError(
            f"{where}: kind", f'"{axis.name}"', "none" if kind is None else f"{kind!r}", why=f"by {few(keys)}"
        )
        found.append(Complaint(str(error), "", "kind"))

    def complain(error: InputError, place: Place = ("", "")) -> None:
        said = str(error)
        if said not in (one.text for one in found):
            found.append(Complaint(said, *place))

    entries = list(_entries(content))
    good: list[Place] = []
    for place in entries:
        if home := _home(place, axis):
            table = f"[{place[0]}] " if place[0] else ""
            found.append(Complaint(f"{where}: {table}{place[1]}: this key belongs {home}", *place))
            continue
        try:
            rig_of(_alone(content, [place]), where)
        except InputError as error:
            complain(error, place)
        else:
            good.append(place)
    # Two entries can contradict each other: a case and a tilt, both sides of a gear, one letter twice.
    apart = list(good)
    for pair in itertools.combinations(good, 2):
        if {one[0] for one in pair} <= {*_TABLES} and set(pair) <= set(apart):
            try:
                rig_of(_alone(content, pair), where)
            except InputError as error:
                complain(error, pair[1])
                apart.remove(pair[1])
    rest = _only(content, apart)
    if "encoder_counts_per_rev" in content:
        rest.setdefault("encoder_counts_per_rev", 1)  # as in `_alone`
    try:
        rig_of(rest, where)
    except InputError as error:
        complain(error)
        if "kind" not in rest:
            rest["known"] = {**rest.get("known", {}), **_CASE}
    return found, rest


def _of_another(content: Mapping[str, Any], axis: AxisKind) -> tuple[AxisKind, list[str]] | None:
    """The axis that most keys of the tables belong to, and these keys; None where it is the rig's own."""
    given = [(table, key) for table, key in _entries(content) if table in ("known", "unknown", "columns")]
    only = {
        one: [key for table, key in given if key in _keys(one, table)]
        for one in (axis, *(other for other in AXES.values() if other is not axis))
    }
    own, *others = only
    best = max(others, key=lambda one: len(set(only[one]) - set(only[own])))
    theirs = [key for key in only[best] if key not in only[own]]
    ours = [key for key in only[own] if key not in only[best]]
    return (best, theirs) if len(theirs) > max(len(ours), 1) else None


def _keys(axis: AxisKind, table: str) -> set[str]:
    """The keys of a table of a rig with this axis."""
    if table == "columns":
        return {axis.named(channel) for channel in channels_of(axis)}
    letters = {name for known in knowns_of(axis) for name in (known.letter or known.name, known.key)}
    return letters | ({*_CASE} if axis is TURNING else set())


def _entries(content: Mapping[str, Any], tables: Collection[str] = _TABLES) -> Iterator[Place]:
    """The place of every entry; a table that is none counts as one entry."""
    for key, value in content.items():
        if key in tables and isinstance(value, Mapping):
            yield from ((key, inner) for inner in value)
        else:
            yield "", key


def _home(place: Place, axis: AxisKind) -> str:
    """Where a key of another table belongs; empty where it is right, or known nowhere on this axis."""
    table, key = place
    if table == "added":  # names of runs
        return ""
    homes = (
        ("under [known]", ("known", "unknown"), _keys(axis, "known")),
        ("under [columns]", ("columns",), _keys(axis, "columns")),
        ("at the top, above all tables", ("",), keys_of(axis)),
    )
    if any(table in tables and key in keys for _, tables, keys in homes):
        return ""
    return next((home for home, _, keys in homes if key in keys), "")


def _only(content: Mapping[str, Any], places: list[Place] | tuple[Place, ...]) -> dict[str, Any]:
    kept: dict[str, Any] = {}
    for table, key in places:
        if table:
            kept.setdefault(table, {})[key] = content[table][key]
        else:
            kept[key] = content[key]
    return kept


def _alone(content: Mapping[str, Any], places: list[Place] | tuple[Place, ...]) -> dict[str, Any]:
    """A rig with these entries and what they need to be read: a case, a mass, the counts that are a unit."""
    kept = _only(content, places)
    known, unknown = kept.get("known", {}), kept.get("unknown", {})
    kind = content.get("kind")
    if isinstance(kind, str) and kind in AXES and kind != TURNING.name:
        return {"kind": kind, **kept}
    if isinstance(known, dict) and not ({"case", "phi", "phi_rad"} & {*known, *unknown}):
        kept["known"] = {**known, **_CASE}
    if "added" in kept and isinstance(own := kept.get("known", {}), dict):
        # Whether the mass that it is added to is known shows in the whole.
        placed = {f"{letter}_{unit}": 1.0 for letter, unit in (("M", "kg"), ("L", "m"))}
        kept["known"] = {**own, **{k: x for k, x in placed.items() if not {k, k[0]} & {*own}}}
    if "columns" in kept and "encoder_counts_per_rev" in content:
        try:
            read_rig({"known": _CASE, "encoder_counts_per_rev": content["encoder_counts_per_rev"]})
        except InputError:
            # Its own complaint is enough: `counts` has a meaning, if not this one.
            kept["encoder_counts_per_rev"] = 1
        else:
            kept["encoder_counts_per_rev"] = content["encoder_counts_per_rev"]
    return kept


def arm_rig_complaints(
    source: str | os.PathLike[str] | Mapping[str, Any],
) -> tuple[list[InputError], ArmRig | None]:
    """Return what is wrong with the rig of an arm, an error each, and the rig without it, if that is one.

    Raises:
        InputError: the file cannot be read at all.
    """
    content, where, name, folder = arm_content(source)

    def read(content: Mapping[str, Any]) -> ArmRig | InputError:
        try:
            return arm_rig_of(content, where, name, folder)
        except InputError as error:
            return error

    found: list[InputError] = []
    while isinstance(error := read(content), InputError):
        at = error.inside(where).place.translate(_BRACKETS).split()
        named = [*at, *error.keys]
        places = [p for p in _entries(content, _TABLES_OF_ARMS) if p[1] != "arm" and p[1] in named]
        places.sort(key=lambda place: (not place[0], named.index(place[1])))
        # The entry that it is about is the one without which there is another error or none.
        rests = (_without(content, place) for place in places)
        rest = next((rest for rest in rests if not _same(read(rest), error)), None)
        if rest is None:
            # Once something is left out, what is then missing is no complaint of its own.
            return found or [error], None
        found.append(error)
        content = rest
    return found, error


_BRACKETS = str.maketrans("[]", "  ")


def _same(one: ArmRig | InputError, other: InputError) -> bool:
    return isinstance(one, InputError) and one.fields == other.fields


def _without(content: Mapping[str, Any], place: Place) -> dict[str, Any]:
    table, key = place
    if not table:
        return {name: value for name, value in content.items() if name != key}
    own = {name: value for name, value in content[table].items() if name != key}
    return {**content, table: own}
