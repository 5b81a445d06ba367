"""RIGS -> the rig of each joint: one rig file for all, or a table that maps joints to files and own values.

    rigs.csv      joint,rig,M_kg,k_i_Nm_per_A     further columns are keys of [known], empty for the file's
    rigs.toml     [joints.J7]  rig = "arm.toml"  known = { M = "1.2 kg" }

Paths of rig files are relative to the table.
"""

from __future__ import annotations

import csv
import dataclasses
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eccentric.entries import read_document, read_table, read_utf8, refuse_unknown
from eccentric.errors import InputError, few
from eccentric.model import AXES, TURNING, AxisKind
from eccentric.places import given_path, readable
from eccentric.rigs import Rig, knowns_of, read_rig

__all__ = ["Assigned"]


class Assigned:
    """The rigs of a fleet, read when a joint asks for its own."""

    def __init__(self, rigs: str) -> None:
        """Read a table or a rig file; InputError if it is neither."""
        self._path = path = given_path(rigs, "rigs")
        self._files: dict[Path, Mapping[str, Any]] = {}
        self._table: dict[str, tuple[str, Mapping[str, Any]]] | None
        readable(path)
        if path.suffix.lower() == ".csv":
            self._table = _of_csv(path)
            return
        content = read_document(path, "a rig file, or a table of rigs")
        self._table = _of_toml(content["joints"], path) if "joints" in content else None
        if self._table is None:
            self.rig("")

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints of the table; none where one rig holds for all."""
        return tuple(self._table or ())

    def rig(self, joint: str) -> Rig:
        """The rig of a joint. InputError for one that the table lacks, or whose rig cannot be read."""
        content = self.content(joint)
        if content is None:
            return _of_one_mass(read_rig(self._path))
        where = f"{self._path} (joint {joint})"
        try:
            rig = dataclasses.replace(read_rig(content), path=where)
        except InputError as error:
            raise InputError(f"{where}: {str(error).removeprefix('rig: ')}") from None
        return _of_one_mass(rig)

    def content(self, joint: str) -> Mapping[str, Any] | None:
        """The rig file of a joint with its own values; None where one file holds for all. Raises as `rig`."""
        if self._table is None:
            return None
        if joint not in self._table:
            raise InputError(f"{self._path}: a rig of joint {joint} is required, received none")
        name, own = self._table[joint]
        path = self._path.parent / name
        if path not in self._files:
            self._files[path] = read_document(path, "a rig file")
        content = dict(self._files[path])
        axis = AXES.get(str(content.get("kind")), TURNING)
        content["known"] = _with_own(read_table(content.get("known", {}), f"{path}: known"), own, axis)
        content["name"] = joint
        return content


def _of_one_mass(rig: Rig) -> Rig:
    """The rig. InputError for one with masses that some runs carry: the sums of a fleet are of one link."""
    if rig.added:
        raise InputError(f"{rig.path}: [added]: logs of one mass are required in a fleet")
    return rig


def _with_own(known: Mapping[str, Any], own: Mapping[str, Any], axis: AxisKind) -> dict[str, Any]:
    """The values of a rig file with those of a joint in their place, whichever of its keys either uses."""
    letters = {_letter(key, axis) for key in own}
    return {key: value for key, value in known.items() if _letter(key, axis) not in letters} | dict(own)


def _letter(key: str, axis: AxisKind) -> str:
    """The letter of a key such as M_kg; a key that is none is left to the reader of rigs."""
    names = ((known.name, {known.key, known.name, axis.said(known.name)}) for known in knowns_of(axis))
    return next((name for name, keys in names if key in keys), key)


def _of_csv(path: Path) -> dict[str, tuple[str, Mapping[str, Any]]]:
    reader = csv.DictReader(io.StringIO(read_utf8(path), newline=""))
    found: dict[str, tuple[str, Mapping[str, Any]]] = {}
    try:
        names = list(reader.fieldnames or [])
        if not {"joint", "rig"} <= set(names):
            raise InputError(f"{path}: columns joint and rig are required, received {few(names) or 'none'}")
        if again := next((name for name in names if names.count(name) > 1), None):
            raise InputError(f"{path}: each column is required only once, received {again!r} twice")
        for line, row in enumerate(reader, start=2):
            where = f"{path}: line {line}"
            if None in row or None in row.values():
                raise InputError(f"{where}: {len(names)} entries are required, received more or fewer")
            joint, rig = row.pop("joint"), row.pop("rig")
            _require_new(joint, found, where)
            found[joint] = rig, {key: _value(text) for key, text in row.items() if text.strip()}
    except csv.Error as error:
        raise InputError(f"{path}: after line {reader.line_num}: not a table with commas ({error})") from None
    return found


def _value(text: str) -> float | str:
    """A number, or a text with a unit."""
    try:
        return float(text)
    except ValueError:
        return text


def _of_toml(joints: object, path: Path) -> dict[str, tuple[str, Mapping[str, Any]]]:
    found: dict[str, tuple[str, Mapping[str, Any]]] = {}
    for joint, entry in read_table(joints, f"{path}: [joints]").items():
        where = f"{path}: [joints.{joint}]"
        table = read_table(entry, where)
        refuse_unknown(table, ("rig", "known"), where)
        if not isinstance(table.get("rig"), str):
            raise InputError(
                f"{where}: rig: the path of a rig file is required, received {table.get('rig')!r}"
            )
        found[joint] = table["rig"], read_table(table.get("known", {}), f"{where}: known")
    return found


def _require_new(joint: str, found: Mapping[str, object], where: str) -> None:
    if joint in found:
        raise InputError(f"{where}: each joint is required only once, received {joint!r} twice")
