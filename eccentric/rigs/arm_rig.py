"""The test bench of an arm: a chain, and for each of its joints the rig of one joint.

A rig file that names an arm has the keys of any rig, and columns by pattern: `theta_l = "q_rad_{j}"`.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eccentric.core import (
    InputError,
    counted,
    given_path,
    read_document,
    read_number,
    read_table,
    refuse_unknown,
    shown,
)
from eccentric.model import DRIVE_PARTS, Chain, Quantity, with_numbers
from eccentric.rigs.arm_parts import (
    FileQuantity,
    ReadJoint,
    complaints_of,
    identifier,
    placed,
    read_body,
    read_joints,
    read_symbolic,
    with_drives,
    with_letters,
)
from eccentric.rigs.entries import plain_entries, read_names
from eccentric.rigs.known import KNOWNS
from eccentric.rigs.rig import KEYS, Rig, rig_of
from eccentric.rigs.urdf import joints_of_urdf, without_tip

# An arm file: joints with their drives and bodies, or a URDF with drives; a payload; what stays symbolic.


def require_mass(chain: Chain) -> None:
    """Raise InputError unless every joint moves a mass or a rotor.

    A body without mass between others is right: wrists of two or three joints in one point have them. The
    last joint must have some, or any torque would accelerate it without limit; then all others move it too.
    """
    last = chain.links[-1]
    if last.moments.mass == 0 and not any(last.moments.second) and last.joint.J_m == 0:
        raise InputError(last.joint.name, "a mass on the body of the last joint, or a rotor", "none")


GRAVITY = FileQuantity("gravity", "m/s^2", "m_s2")
KEYS_OF_ARMS = ("name", *GRAVITY.keys, "symbolic", "urdf", "joint", "payload")
"""Keys at the top level of an arm file."""


def arm_of(content: Mapping[str, Any], path: Path, where: str) -> Chain:
    """The chain that the content of an arm file describes.

    Args:
        content: as TOML or JSON have it.
        path: of the file: a URDF is beside it, and its name is that of the arm if the file gives none.
        where: the file, in messages.

    Raises InputError, one line with file, joint and key, what is required and what was received.
    """
    if {"arm", "columns"} <= set(content):
        what = "expected an arm file, got the rig of an arm, whose key `arm` names the arm file"
        raise InputError(where, problem=f"{what}")
    refuse_unknown(content, KEYS_OF_ARMS, where)
    name = content.get("name", identifier(path.stem))
    if not isinstance(name, str):
        raise InputError(f"{where}: name", "a text", f"{name!r}")
    tables = content.get("joint", [])
    read = _on_urdf(content["urdf"], tables, path, where) if "urdf" in content else read_joints(tables, where)
    names = [one.joint.name for one in read]
    symbolic = read_symbolic(content.get("symbolic", []), names, f"{where}: symbolic")
    bodies, letters = [], list[Quantity]()
    for number, one in enumerate(read):
        parts = symbolic.get(one.joint.name, set())
        body, found = with_letters(one.body, f"body_{number}", f"body {number}", parts)
        bodies.append(placed(body, one.frame))
        letters += found
    payload = None
    if "payload" in content or "payload" in symbolic:
        given = read_body(content.get("payload", {"mass_kg": 0}), f"{where}: payload")
        given, found = with_letters(given, "payload", "the payload", symbolic.get("payload", set()))
        payload, letters = placed(given, read[-1].frame), letters + found
    gravity = GRAVITY.vector(content, where, (0, 0, "-9.81"))
    with complaints_of(where):
        chain = Chain(name, [one.joint for one in read], bodies, gravity, payload, letters)
        require_mass(chain)
    return chain


def _on_urdf(value: object, tables: Any, path: Path, where: str) -> list[ReadJoint]:
    """Joints and bodies of the URDF that a file names, with the drives of the file."""
    urdf, tip = without_tip(path.parent / given_path(value, f"{where}: urdf"))
    if urdf.suffix.lower() != ".urdf":
        raise InputError(f"{where}: urdf", "a file .urdf", f"{value!r}")
    return with_drives(joints_of_urdf(urdf, shown(urdf), tip)[1], tables, where)


# The door for arms: a file by its suffix.


def read_arm(source: str | os.PathLike[str], tip: str | None = None) -> Chain:
    """Read an arm.

    Args:
        source: path of an arm file, `.toml` or `.json`, or of a URDF, `.urdf`. The last link of the arm in a
            URDF can follow behind `#`, as in "panda.urdf#panda_hand".
        tip: this last link; the joints on the way to it move, all others are locked at 0.

    Returns:
        The chain, in SI. Its joints have the names of the file; its parameters are what the file keeps
        symbolic, with the numbers of the file as defaults.

    Raises:
        InputError: one line with file, joint and quantity, what is required and what was received.
    """
    path = given_path(source, "arm")
    if tip is None:
        path, tip = without_tip(path)
    where = shown(path)
    if path.suffix.lower() == ".urdf":
        name, read = joints_of_urdf(path, where, tip)
        with complaints_of(where):
            chain = Chain(name, [one.joint for one in read], [one.body for one in read])
            require_mass(chain)
        return chain
    if tip is not None:
        raise InputError(where, "a .urdf", f"{tip!r}", why="for a tip")
    content = read_document(path, "an arm file, .urdf,")
    if str(content.get("format", "")).startswith("eccentric-"):
        raise InputError(
            where,
            "an arm file",
            (
                f"a result ({content['format']}): emit the model.py next to a diagnosis.json, or"
                " a model with --parameters FIT.json"
            ),
        )
    return arm_of(content, path, where)


NUMBER = "{j}"
"""What stands for the number of a joint in a pattern."""
INERTIAL = ("mass", "centre", "inertia")
"""What may be known of the bodies where the rest is open."""
_OF_ONE_JOINT = {
    *("known", "unknown", "added", "log_type"),
    *("theta_zero_rad", "input_delay_s", "voltage_offset_V"),
}
_KEYS = ("arm", "joints", "drives", *(key for key in KEYS if key not in _OF_ONE_JOINT))
_MOTION = ("theta_m", "theta_l", "omega_m", "omega_l")
_DRIVE = ("torque", "torque_l", "current", "voltage")
_OF_DRIVES = ("k_i", "R", "k_e")


@dataclass(frozen=True)
class ArmRig:
    """An arm on its bench.

    Attributes:
        path: of the rig file, for messages.
        name: of the rig.
        chain: the arm, numbers only.
        declared: the same with the letters that its file keeps, such as those of a payload.
        joints: the rig of each joint as if it were alone, from the base outwards: its columns, gear, drive.
        first: the number of the first joint in the columns.
        patterns: the sources of motion and drive as the rig has them, with {j} for the number, by channel.
        known: what is known of the bodies: all of `INERTIAL`, or a part, whose rest the log has to determine.
    """

    path: str
    name: str
    chain: Chain
    declared: Chain
    joints: tuple[Rig, ...]
    first: int
    patterns: Mapping[str, str]
    known: frozenset[str]

    def __repr__(self) -> str:
        return f"<ArmRig {self.name}: {counted(len(self.joints), 'joint')} of {self.chain.name}>"

    @property
    def open(self) -> bool:
        """Whether inertial parameters are open."""
        return self.known != frozenset(INERTIAL)

    def number(self, j: int) -> int:
        """The number of a joint in the columns, from its place in the chain."""
        return self.first + j

    def column(self, channel: str, j: int) -> str:
        """The source of a channel for a joint, from its place in the chain."""
        return self.patterns[channel].replace(NUMBER, str(self.number(j)))


def names_arm(source: object) -> bool:
    """Whether a rig is that of an arm: a file or a mapping with the key `arm`, or an ArmRig.

    Raises:
        InputError: as `read_rig` does for a file that cannot be read.
    """
    if isinstance(source, str | os.PathLike):
        return "arm" in read_document(given_path(source, "rig"), "a rig file")
    return isinstance(source, ArmRig) or (isinstance(source, Mapping) and "arm" in source)


def read_arm_rig(source: str | os.PathLike[str] | Mapping[str, Any] | ArmRig) -> ArmRig:
    """Read the rig of an arm: a file `.toml` or `.json`, or a mapping with the keys of such a file.

    In a mapping `arm` may be a Chain. Paths are relative to the rig file.

    Raises:
        InputError: one line with file, key, what was expected and what came.
    """
    if isinstance(source, ArmRig):
        return source
    return arm_rig_of(*arm_content(source))


def arm_content(
    source: str | os.PathLike[str] | Mapping[str, Any],
) -> tuple[Mapping[str, Any], str, str, Path]:
    """The content of a rig file or mapping, the names of file and rig in messages, the folder of its paths.

    Raises:
        InputError: the file cannot be read.
    """
    if isinstance(source, str | os.PathLike):
        path = given_path(source, "rig")
        return read_document(path, "a rig file"), shown(path), Path(shown(path)).stem, path.parent
    given = dict(source)
    chain = given.pop("arm", None)
    return {**plain_entries(given, "rig"), "arm": chain}, "rig", "rig", Path()


def arm_rig_of(content: Mapping[str, Any], where: str, name: str, folder: Path) -> ArmRig:
    """The rig of this content; `where` and `name` are those of the file, paths are relative to the folder.

    Raises:
        InputError: as `read_arm_rig`.
    """
    if also := [key for key in ("known", "unknown") if key in content]:
        required = "bodies and gear ratios in the arm file, k_i, R and k_e in [drives]"
        raise InputError(f"{where}: [{also[0]}]", required, "a table", why="in the rig of an arm")
    refuse_unknown(content, _KEYS, where)
    declared = _chain(content["arm"], where, folder)
    chain = with_numbers(declared)
    table = read_table(content.get("joints", {}), f"{where}: [joints]")
    refuse_unknown(table, ("first", "inertial"), f"{where}: [joints]")
    first = _first(table.get("first", 1), f"{where}: [joints] first")
    columns = read_table(content.get("columns"), f"{where}: [columns]")
    _require_patterns(columns, f"{where}: [columns]")
    _require_motion_and_drive(columns, content.get("drive"), f"{where}: [columns]")
    common = {key: x for key, x in content.items() if key not in {"arm", "joints", "drives", "columns"}}
    count, name = len(chain.joints), str(content.get("name", name))
    drives = _drives(content.get("drives", {}), count, f"{where}: [drives]")
    joints = []
    for j, (joint, known) in enumerate(zip(chain.joints, drives, strict=True)):
        mu = float(joint.mu)
        own = {
            **common,
            "name": f"{name}, joint {first + j}",
            "columns": {channel: _source(source, first + j) for channel, source in columns.items()},
            "known": {"case": "C2", "mu": mu, **{k: x for k, x in known.items() if k not in DRIVE_PARTS}},
            **{kind: known[kind] for kind in DRIVE_PARTS if kind in known},
        }
        if "moving_threshold_rad_s" in own:
            threshold = read_number(own["moving_threshold_rad_s"], f"{where}: moving_threshold_rad_s", 0.0)
            own["moving_threshold_rad_s"] = threshold / mu
        joints.append(rig_of(own, where, "drives"))
    patterns = {c: _text(x) for c, x in columns.items() if c in (*_MOTION, *_DRIVE)}
    inertial = _known(table.get("inertial", "known"), where)
    return ArmRig(where, name, chain, declared, tuple(joints), first, patterns, inertial)


def _chain(given: object, where: str, folder: Path) -> Chain:
    if isinstance(given, Chain):
        return given
    if not isinstance(given, str) or not given.strip():
        raise InputError(f"{where}: arm", "the path of an arm, .toml or .urdf", f"{given!r}")
    with complaints_of(f"{where}: arm"):
        return read_arm(folder / given)


def _first(value: object, where: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise InputError(where, "a whole number of 0 or above", f"{value!r}")
    return value


def _known(value: object, where: str) -> frozenset[str]:
    at = f"{where}: [joints] inertial"
    if value in {"known", "open"} if isinstance(value, str) else False:
        return frozenset(INERTIAL if value == "known" else ())
    if isinstance(value, str):
        raise InputError(at, f'"known", "open" or a list of {", ".join(INERTIAL)}', f"{value!r}")
    names = read_names(value, at)
    refuse_unknown(names, INERTIAL, at)
    known = frozenset(names)
    # A first moment needs the mass, a second one both: what cannot be used is not taken as if it were.
    if known != frozenset(INERTIAL[: len(known)]):
        required = f"expected {' before '.join(INERTIAL)}"
        raise InputError(at, problem=f"{required}, got {', '.join(names)} without what comes before")
    return known


def _require_patterns(columns: Mapping[str, Any], where: str) -> None:
    """Motion and drive of a joint are its own: one column for all joints is an error."""
    for channel in (*_MOTION, *_DRIVE):
        text = _text(columns.get(channel, NUMBER))
        if NUMBER not in text:
            raise InputError(
                f"{where} {channel}", f"a pattern with {NUMBER}, the number of the joint", f"{text!r}"
            )
    for channel in ("time", "run"):
        if NUMBER in _text(columns.get(channel, "")):
            raise InputError(f"{where} {channel}", "one column for all joints", f"a pattern with {NUMBER}")


def _require_motion_and_drive(columns: Mapping[str, Any], drive: object, where: str) -> None:
    """The loads of a joint depend on all angles; what measures its drive is compared with them."""
    if not {"theta_m", "theta_l"} & set(columns):
        raise InputError(where, "the angle of every joint", "none", why=f', as in theta_l = "q_rad_{NUMBER}"')
    of = {"torque": ("torque", "torque_l")}.get(str(drive), (drive,) if drive in _DRIVE else _DRIVE)
    if not set(of) & set(columns):
        name = of[-1] if drive in _DRIVE else "current"
        raise InputError(
            where,
            "what measures the drive of every joint",
            "none",
            why=f', such as {name} = "{name}_{NUMBER}"',
        )


def _text(source: object) -> str:
    text = source.get("column") if isinstance(source, Mapping) else source
    return text if isinstance(text, str) else ""


def _source(source: object, number: int) -> object:
    """A source of a channel with the number of a joint in its pattern."""
    if isinstance(source, Mapping):
        return {key: _source(x, number) if key == "column" else x for key, x in source.items()}
    return source.replace(NUMBER, str(number)) if isinstance(source, str) else source


def _drives(value: object, count: int, where: str) -> list[dict[str, Any]]:
    """What is known of the drive of each joint: a value for all of them, or a list of one for each."""
    if isinstance(value, list):
        if len(value) != count:
            raise InputError(where, f"one table for each of {counted(count, 'joint')}", len(value))
        return [_entries(read_table(own, where), where) for own in value]
    table = _entries(read_table(value, where), where)
    found: list[dict[str, Any]] = [{} for _ in range(count)]
    for key, given in table.items():
        values = given if isinstance(given, list) else [given] * count
        if len(values) != count:
            raise InputError(
                f"{where} {key}", f"one value, or one for each of {counted(count, 'joint')}", len(values)
            )
        for own, one in zip(found, values, strict=True):
            own[key] = one
    return found


def _entries(table: Mapping[str, Any], where: str) -> dict[str, Any]:
    keys = [key for known in KNOWNS if known.name in _OF_DRIVES for key in (known.name, known.key)]
    refuse_unknown(table, (*keys, *DRIVE_PARTS), where)
    return dict(table)
