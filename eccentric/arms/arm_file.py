"""An arm file: joints with their drives and bodies, or a URDF with drives; a payload; what stays symbolic."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eccentric.arms.bodies import read_body, read_symbolic, with_letters
from eccentric.arms.complaints import complaints_of
from eccentric.arms.joints import ReadJoint, read_joints, with_drives
from eccentric.arms.masses import require_mass
from eccentric.arms.naming import identifier
from eccentric.arms.placing import placed
from eccentric.arms.quantities import FileQuantity
from eccentric.arms.urdf import joints_of_urdf, without_tip
from eccentric.entries import refuse_unknown
from eccentric.errors import InputError
from eccentric.model import Chain, Quantity
from eccentric.places import given_path, shown

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
        what = "an arm file is required, received the rig of an arm, whose key `arm` names the arm file"
        raise InputError(f"{where}: {what}")
    refuse_unknown(content, KEYS_OF_ARMS, where)
    name = content.get("name", identifier(path.stem))
    if not isinstance(name, str):
        raise InputError(f"{where}: name: a text is required, received {name!r}")
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
        raise InputError(f"{where}: urdf: a file .urdf is required, received {value!r}")
    return with_drives(joints_of_urdf(urdf, shown(urdf), tip)[1], tables, where)
