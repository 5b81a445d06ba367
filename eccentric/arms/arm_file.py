"""An arm file: joints from the base outwards, each with its drive and its body, and a payload."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from eccentric.arms.bodies import read_body, read_symbolic, with_letters
from eccentric.arms.complaints import complaints_of
from eccentric.arms.masses import require_mass
from eccentric.arms.placing import PLACING, after, placed, read_placements
from eccentric.arms.quantities import FileQuantity
from eccentric.entries import read_table, refuse_unknown
from eccentric.errors import InputError
from eccentric.model import Body, Chain, Joint, Placement, Quantity

GRAVITY = FileQuantity("gravity", "m/s^2", "m_s2")
AXIS, BEARING, ROTOR = (
    FileQuantity("axis", "1"),
    FileQuantity("bearing", "m", "m"),
    FileQuantity("J_m", "kg m^2", "kgm2"),
)
GEAR = {"revolute": FileQuantity("mu", "1"), "prismatic": FileQuantity("mu", "m/rad", "m_per_rad")}
KEYS_OF_ARMS = ("name", *GRAVITY.keys, "symbolic", "joint", "payload")
"""Keys at the top level of an arm file."""
KEYS_OF_JOINTS = ("name", "kind", *AXIS.keys, *PLACING, "mu", *ROTOR.keys, *BEARING.keys, "body")
"""Keys of each of its joints; a prismatic one has mu_m_per_rad as well."""


@dataclass(frozen=True)
class _Read:
    """A joint, its body with numbers in the frame of the file, and that frame in the one of the joint."""

    joint: Joint
    body: Body
    frame: Placement


def arm_of(content: Mapping[str, Any], where: str, stem: str) -> Chain:
    """The chain that the content of an arm file describes.

    Args:
        content: as TOML or JSON have it.
        where: the file, in messages.
        stem: its name without folder and suffix: that of the arm if the file gives none.

    Raises InputError, one line with file, joint and key, what is required and what was received.
    """
    refuse_unknown(content, KEYS_OF_ARMS, where)
    tables = content.get("joint", [])
    if not isinstance(tables, list) or not tables:
        raise InputError(f"{where}: joints are required, each as [[joint]], received {tables or 'none'!r}")
    read: list[_Read] = []
    for number, table in enumerate(tables, 1):
        before = read[-1].frame if read else Placement()
        read.append(_joint(read_table(table, f"{where}: joint {number}"), number, before, where))
    names = [one.joint.name for one in read]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise InputError(f"{where}: joints of different names are required, received {twice!r} twice")
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
    name = content.get("name", stem)
    if not isinstance(name, str):
        raise InputError(f"{where}: name: a text is required, received {name!r}")
    with complaints_of(where):
        chain = Chain(name, [one.joint for one in read], bodies, gravity, payload, letters)
        require_mass(chain)
    return chain


def _joint(table: Mapping[str, Any], number: int, before: Placement, where: str) -> _Read:
    name = table.get("name")
    here = f"{where}: joint {number}"
    if not isinstance(name, str) or not name or not name.isprintable() or name == "payload":
        raise InputError(f"{here}: a name on one line, not 'payload', is required, received {name!r}")
    here = f"{where}: {name}"
    kind = table.get("kind", "revolute")
    gear = GEAR[kind] if isinstance(kind, str) and kind in GEAR else GEAR["revolute"]
    refuse_unknown(table, dict.fromkeys((*KEYS_OF_JOINTS, *gear.keys)), here)
    if "body" not in table:
        raise InputError(f'{here}: a body is required, such as body = {{ mass = "2 kg" }}, received none')
    place, frame = read_placements(table, here)
    axis = AXIS.vector(table, here, (0, 0, 1))
    mu, J_m, bearing = gear.scalar(table, here, 1.0), ROTOR.scalar(table, here), BEARING.scalar(table, here)
    with complaints_of(where):
        joint = Joint(kind, axis, after(before, place), mu, J_m, bearing, name)
    return _Read(joint, read_body(table["body"], here), frame)
