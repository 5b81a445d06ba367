"""The joints of an arm file: each with its drive and its body, or with its drive alone on a URDF."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eccentric.arms.bodies import read_body
from eccentric.arms.complaints import complaints_of
from eccentric.arms.placing import PLACING, after, read_placements
from eccentric.arms.quantities import FileQuantity
from eccentric.entries import read_table, refuse_unknown
from eccentric.errors import InputError, few, meant
from eccentric.model import Body, Joint, Placement

AXIS, BEARING = FileQuantity("axis", "1"), FileQuantity("bearing", "m", "m")
ROTOR = FileQuantity("J_m", "kg m^2", "kgm2")
GEAR = {
    "revolute": FileQuantity("mu", "1"),
    "prismatic": FileQuantity("mu", "m/rad", "m_per_rad"),
}
DRIVE = ("mu", *ROTOR.keys, *BEARING.keys)
KEYS_OF_JOINTS = ("name", "kind", *AXIS.keys, *PLACING, *DRIVE, "body")
"""Keys of a joint; a prismatic one has mu_m_per_rad as well."""


@dataclass(frozen=True)
class ReadJoint:
    """A joint, its body with numbers in the frame of the file, and that frame in the one of the joint."""

    joint: Joint
    body: Body
    frame: Placement


def read_joints(tables: Any, where: str) -> list[ReadJoint]:
    """Joints from the base outwards.

    Raises InputError, one line with file, joint and key, what is required and what was received.
    """
    found: list[ReadJoint] = []
    for here, name, table in _named(tables, where):
        kind = table.get("kind", "revolute")
        if not isinstance(kind, str) or kind not in GEAR:
            required = f"one of {', '.join(GEAR)} is required, received {kind!r}"
            raise InputError(f"{here}: kind: {required}{meant(kind, GEAR)}")
        gear = GEAR[kind]
        refuse_unknown(table, dict.fromkeys((*KEYS_OF_JOINTS, *gear.keys)), here)
        if "body" not in table:
            raise InputError(f'{here}: a body is required, such as body = {{ mass = "2 kg" }}, received none')
        place, frame = read_placements(table, here)
        axis = AXIS.vector(table, here, (0, 0, 1))
        before = found[-1].frame if found else Placement()
        drive = _drive(table, gear, here)
        with complaints_of(where):
            joint = Joint(kind, axis, after(before, place), *drive, name)
        found.append(ReadJoint(joint, read_body(table["body"], here), frame))
    if not found:
        raise InputError(f"{where}: joints are required, each as [[joint]], received none")
    return found


def with_drives(read: Sequence[ReadJoint], tables: Any, where: str) -> list[ReadJoint]:
    """The joints of a URDF with drives and bearings from tables of their names; without a table mu = 1.

    Raises InputError as `read_joints`, and for a name that is not in the URDF.
    """
    given = {name: (here, table) for here, name, table in _named(tables, where)}
    names = [one.joint.name for one in read]
    if unknown := next((name for name in given if name not in names), None):
        hint = meant(unknown, names) or f"; known are {few(names)}"
        raise InputError(f"{where}: a joint of the arm in the URDF is required, received {unknown!r}{hint}")
    found = []
    for one in read:
        joint = one.joint
        here, table = given.get(joint.name, (where, {}))
        gear = GEAR[joint.kind]
        refuse_unknown(table, dict.fromkeys(("name", *DRIVE, *gear.keys)), here)
        drive = _drive(table, gear, here)
        with complaints_of(where):
            driven = Joint(joint.kind, joint.axis, joint.placement, *drive, joint.name)
        found.append(replace(one, joint=driven))
    return found


def _named(tables: Any, where: str) -> Iterable[tuple[str, str, Mapping[str, Any]]]:
    """The place for messages, the name and the table of each joint; names are different."""
    if not isinstance(tables, list):
        raise InputError(f"{where}: joints are required, each as [[joint]], received {tables!r}")
    seen = set[str]()
    for number, entry in enumerate(tables, 1):
        here = f"{where}: joint {number}"
        table = read_table(entry, here)
        name = table.get("name")
        if not isinstance(name, str) or not name or not name.isprintable() or name == "payload":
            raise InputError(f"{here}: a name on one line, not 'payload', is required, received {name!r}")
        if name in seen:
            raise InputError(f"{where}: joints of different names are required, received {name!r} twice")
        seen.add(name)
        yield f"{where}: {name}", name, table


def _drive(table: Mapping[str, Any], gear: FileQuantity, here: str) -> tuple[Any, Any, Any]:
    return gear.scalar(table, here, 1.0), ROTOR.scalar(table, here), BEARING.scalar(table, here)
