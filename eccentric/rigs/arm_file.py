"""An arm file: joints with their drives and bodies, or a URDF with drives; a payload; what stays symbolic."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eccentric.core import InputError, given_path, read_document, refuse_unknown, shown
from eccentric.model import Chain, Quantity
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
from eccentric.rigs.urdf import joints_of_urdf, without_tip


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
                f"a result ({content['format']}): emit the model.py beside a diagnosis.json, or"
                " a model with --parameters FIT.json"
            ),
        )
    return arm_of(content, path, where)
