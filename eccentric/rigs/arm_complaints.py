"""Everything that is wrong with the rig of an arm: what the first error names is left out, and so on.

The entries of an arm's rig belong together (drives by the number of joints, a motion and a drive among the
columns), so that none can be read by itself, as `complaints` reads those of a single drive.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from eccentric.core import InputError
from eccentric.rigs.arm_rig import ArmRig, arm_content, arm_rig_of

Place = tuple[str, str]
_TABLES = ("columns", "drives", "joints")


def arm_rig_complaints(
    source: str | os.PathLike[str] | Mapping[str, Any],
) -> tuple[list[InputError], ArmRig | None]:
    """Return what is wrong with the rig of an arm, an error each, and the rig without it, if that is one.

    Raises:
        InputError: the file cannot be read at all.
    """
    content, where, name, folder = arm_content(source)
    found: list[InputError] = []
    while True:
        error = _error(content, where, name, folder)
        if error is None:
            return found, arm_rig_of(content, where, name, folder)
        guilty = _named(content, error, where, name, folder)
        if guilty is None:
            # Once something is left out, what is then missing is no complaint of its own.
            return found or [error], None
        found.append(error)
        content = _without(content, guilty)


def _error(content: Mapping[str, Any], where: str, name: str, folder: Path) -> InputError | None:
    try:
        arm_rig_of(content, where, name, folder)
    except InputError as error:
        return error
    return None


def _named(
    content: Mapping[str, Any], error: InputError, where: str, name: str, folder: Path
) -> Place | None:
    """The entry that an error is about, and without which there is another one or none."""
    at = error.inside(where).place.translate(_BRACKETS).split()
    named = [*at, *error.keys]
    places = [place for place in _entries(content) if place[1] != "arm" and place[1] in named]
    places.sort(key=lambda place: (not place[0], named.index(place[1])))
    for place in places:
        other = _error(_without(content, place), where, name, folder)
        if other is None or other.fields != error.fields:
            return place
    return None


_BRACKETS = str.maketrans("[]", "  ")


def _entries(content: Mapping[str, Any]) -> Iterator[Place]:
    """The place of every entry; a table that is none counts as one."""
    for key, value in content.items():
        if key in _TABLES and isinstance(value, Mapping):
            yield from ((key, inner) for inner in value)
        else:
            yield "", key


def _without(content: Mapping[str, Any], place: Place) -> dict[str, Any]:
    table, key = place
    if not table:
        return {name: value for name, value in content.items() if name != key}
    own = {name: value for name, value in content[table].items() if name != key}
    return {**content, table: own}
