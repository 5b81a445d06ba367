"""The parts of an arm file: quantities, bodies, frames and joints."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from eccentric.core import InputError, few, meant, read_number, read_table, refuse_unknown
from eccentric.logs import parse_value
from eccentric.model import Body, Joint, Placement, Quantity, quantity
from eccentric.rigs.limits import LARGEST_ANGLE, LARGEST_OF_ARM

# Names of arms in code.


def identifier(name: str) -> str:
    """The name of a robot or a file as one in code: letters, digits and underscores, a letter first."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:40]
    try:
        quantity(plain, "1", "")
    except InputError:  # a digit first, or a word of C or Python
        return f"arm_{plain}".rstrip("_")
    return plain


@contextmanager
def complaints_of(where: str) -> Iterator[None]:
    """Put the file before the place of an InputError: joints and chains only name themselves."""
    try:
        yield
    except InputError as error:
        raise error.within(where) from None


INERTIA = ("xx", "xy", "xz", "yy", "yz", "zz")
"""The entries of a symmetric tensor by name."""

_PER_ANGLE = re.compile(r"[a-z]\s*/")
_RATIO = re.compile(r"\d+/\d+")
"""Kept as it is: 1/9 is exact."""


@dataclass(frozen=True)
class FileQuantity:
    """A quantity of an arm file.

    Attributes:
        key: for texts with a unit, `mass = "2 kg"`.
        unit: SI unit; "1" for a pure number, which is written as such or as a ratio, "1/50".
        suffix: of the key for plain numbers, `mass_kg = 2`; "" if they have no other key.
    """

    key: str
    unit: str
    suffix: str = ""

    @property
    def plain_key(self) -> str:
        """The key for plain numbers in SI."""
        return f"{self.key}_{self.suffix}" if self.suffix else self.key

    @property
    def keys(self) -> tuple[str, ...]:
        """Both keys, one if they are the same."""
        return tuple(dict.fromkeys((self.key, self.plain_key)))

    def scalar(self, table: Mapping[str, Any], where: str, default: float | None = 0.0) -> Any:
        """Return a number in SI; a ratio such as "1/9" as the text that it is, to be kept exact.

        Raises InputError: there is none and no default, it is no number, or it has another unit.
        """
        return self._read(table, where, self._number, default)

    def vector(self, table: Mapping[str, Any], where: str, default: Any = (0.0, 0.0, 0.0)) -> Any:
        """Return three numbers in SI, from a list of three; InputError as for a scalar."""
        return self._read(table, where, self._three, default)

    def rows(self, table: Mapping[str, Any], where: str, default: Any) -> Any:
        """Return a matrix in SI, from three rows of three; InputError as for a scalar."""
        return self._read(table, where, self._rows, default)

    def tensor(self, table: Mapping[str, Any], where: str) -> Any:
        """Return a symmetric matrix in SI, from a table by `INERTIA` or rows; InputError as for a scalar."""
        return self._read(table, where, self._tensor, [[0.0] * 3] * 3)

    def _read(
        self, table: Mapping[str, Any], where: str, read: Callable[[Any, str, str], Any], default: Any
    ) -> Any:
        given = [key for key in self.keys if key in table]
        if len(given) == 2:
            raise InputError(where, self.key, " and ".join(given), why="only once")
        if not given:
            if default is None:
                raise InputError(where, self.key, "none")
            return default
        return read(table[given[0]], given[0], f"{where}: {given[0]}")

    def _number(self, value: Any, key: str, where: str) -> Any:
        if isinstance(value, str):
            if key != self.key:
                raise InputError(where, f"a number in {self.unit}", f"{value!r}")
            if self.unit == "m/rad" and not _PER_ANGLE.search(value):
                raise InputError(where, "a unit", f"{value!r}", why="(m/rad, mm/rev)")
            number = parse_value(value, self.unit, where)
            if (
                self.unit != "rad"
            ):  # 0.6 g is 0.0006 kg, not 0.0006000000000000001; right angles keep all digits
                number = float(f"{number:.15g}")
        elif key == self.plain_key or (value == 0 and not isinstance(value, bool)):  # 0 is 0 in every unit
            number = read_number(value, where)
            if self.unit == "rad" and abs(number) > LARGEST_ANGLE:
                hint = f'did you mean "{value:g} deg" under {self.key}?'
                raise InputError(where, "an angle in rad, at most a turn", f"{value!r}; {hint}")
        else:
            raise InputError(where, "a text with a unit", f"{value!r}", why=f', as in "0.1 {self.unit}"')
        if not abs(number) <= LARGEST_OF_ARM:
            raise InputError(where, f"a size of at most {LARGEST_OF_ARM:g}", f"{value!r}")
        return value if isinstance(value, str) and _RATIO.fullmatch(value) else number

    def _three(self, value: Any, key: str, where: str) -> Any:
        if not isinstance(value, list) or len(value) != 3:
            raise InputError(where, "a list of three, [x, y, z]", f"{value!r}")
        return [self._number(entry, key, where) for entry in value]

    def _rows(self, value: Any, key: str, where: str) -> Any:
        if not isinstance(value, list) or len(value) != 3:
            raise InputError(where, "three rows of three numbers", f"{value!r}")
        return [self._three(row, key, where) for row in value]

    def _tensor(self, value: Any, key: str, where: str) -> Any:
        if isinstance(value, list):
            return self._rows(value, key, where)
        table = read_table(value, where)
        refuse_unknown(table, INERTIA, where)
        entry = {
            name: self._number(table[name], key, f"{where}: {name}") if name in table else 0.0
            for name in INERTIA
        }
        return [[entry["".join(sorted(row + column))] for column in "xyz"] for row in "xyz"]


# Bodies of an arm file, and what of them stays symbolic.


MASS, CENTRE, TENSOR = (
    FileQuantity("mass", "kg", "kg"),
    FileQuantity("centre", "m", "m"),
    FileQuantity("inertia", "kg m^2", "kgm2"),
)
KEYS_OF_BODIES = (*MASS.keys, *CENTRE.keys, *TENSOR.keys)
"""Keys of a body."""
PARTS = ("mass", "centre", "inertia")
"""What of a body can stay symbolic."""


def read_body(value: object, where: str) -> Body:
    """A body from its table: mass, centre of mass, inertia about it.

    Raises InputError for an unknown key, what is no quantity, and a body that cannot exist.
    """
    table = read_table(value, where)
    refuse_unknown(table, KEYS_OF_BODIES, where)
    return Body(
        MASS.scalar(table, where, None), CENTRE.vector(table, where), TENSOR.tensor(table, where), where
    )


def read_symbolic(value: object, names: Sequence[str], where: str) -> dict[str, set[str]]:
    """What stays symbolic: of the payload or of the body of a joint, all or one of its `PARTS`.

    Args:
        value: a list such as ["payload", "elbow.mass"].
        names: of the joints.
        where: opens the message.

    Raises InputError for what is not among these.
    """
    if not isinstance(value, Sequence) or isinstance(value, str):
        raise InputError(where, 'a list such as ["payload"]', f"{value!r}")
    bodies = ("payload", *names)
    known = {body: (body, PARTS) for body in bodies}
    known |= {f"{body}.{part}": (body, (part,)) for body in bodies for part in PARTS}
    found: dict[str, set[str]] = {}
    for entry in value:
        if not isinstance(entry, str) or entry not in known:
            hint = meant(entry, known) or f"; known are {few(bodies)}, and of each .mass, .centre, .inertia"
            raise InputError(where, "a body of this arm", f"{entry!r}{hint}")
        body, parts = known[entry]
        found.setdefault(body, set()).update(parts)
    return found


def with_letters(body: Body, prefix: str, whose: str, parts: set[str]) -> tuple[Body, list[Quantity]]:
    """The body with letters for some of its parts, and these letters with the numbers as defaults.

    Args:
        body: with numbers.
        prefix: of the letters: "payload" for payload_mass, payload_centre_x, payload_inertia_xy.
        whose: in their meaning: "the payload".
        parts: of `PARTS`.
    """
    letters: list[Quantity] = []

    def letter(name: str, unit: str, meaning: str, domain: str, default: sp.Expr) -> sp.Symbol:
        letters.append(quantity(f"{prefix}_{name}", unit, f"{meaning} of {whose}", "", domain, default))
        return letters[-1].symbol

    mass, centre, inertia = body.mass, list(body.centre), sp.Matrix(body.inertia)
    if "mass" in parts:
        mass = letter("mass", "kg", "mass", "nonnegative", mass)
    if "centre" in parts:
        centre = [
            letter(f"centre_{axis}", "m", f"centre of mass, {axis},", "real", value)
            for axis, value in zip("xyz", centre, strict=True)
        ]
    if "inertia" in parts:
        for name in INERTIA:
            i, k = ("xyz".index(axis) for axis in name)
            domain, meaning = (
                "nonnegative" if i == k else "real",
                f"inertia about the centre of mass, {name},",
            )
            inertia[i, k] = letter(f"inertia_{name}", "kg m^2", meaning, domain, inertia[i, k])
            inertia[k, i] = inertia[i, k]
    return Body(mass, centre, inertia, body.name), letters


def joined(bodies: Sequence[Body], name: str) -> Body:
    """Bodies in one frame as one rigid body; with numbers."""
    heavy = [body for body in bodies if body.mass != 0 or any(body.inertia)]
    if len(heavy) < 2:
        return heavy[0] if heavy else Body(0, name=name)
    mass = sum(body.mass for body in heavy)
    first = sp.zeros(3, 1)
    for body in heavy:
        first += body.mass * body.centre
    centre = first / mass if mass != 0 else first
    inertia = sp.zeros(3)
    for body in heavy:
        apart = body.centre - centre
        inertia += body.inertia + body.mass * (apart.dot(apart) * sp.eye(3) - apart * apart.T)
    # Sums of fractions have long ones: as decimals of 17 digits again.
    rows = [[float(inertia[i, k]) for k in range(3)] for i in range(3)]
    return Body(float(mass), [float(x) for x in centre], rows, name)


# Frames of an arm: by position and rotation or by Denavit and Hartenberg, and one after another.


POSITION, RPY, ROTATION = (
    FileQuantity("position", "m", "m"),
    FileQuantity("rpy", "rad", "rad"),
    FileQuantity("rotation", "1"),
)
A, D, ALPHA, THETA = (
    FileQuantity("a", "m", "m"),
    FileQuantity("d", "m", "m"),
    FileQuantity("alpha", "rad", "rad"),
    FileQuantity("theta", "rad", "rad"),
)
PLACING = (*POSITION.keys, *RPY.keys, *ROTATION.keys, "dh")
"""Keys of a joint that say where it is."""
UNMOVED = [[float(i == k) for k in range(3)] for i in range(3)]


def read_placements(table: Mapping[str, Any], where: str) -> tuple[Placement, Placement]:
    """Where a joint moves, in the frame before it; and the frame of its body, in what the joint moves.

    By position and rotation the body has the frame of the joint. By Denavit and Hartenberg (standard, as in
    Siciliano et al., Robotics, 2.8.2) the joint moves along or about z of the frame before it, turned by
    theta; its body has the frame at the other end of the link, behind d along z, a and alpha along x.

    Raises InputError for both in one joint, an unknown key, and what is no quantity.
    """
    if "dh" not in table:
        given = [entry.key for entry in (RPY, ROTATION) if set(entry.keys) & set(table)]
        if len(given) == 2:
            raise InputError(where, "only one of rpy and rotation", "both")
        position = POSITION.vector(table, where)
        if "rpy" in given:
            return Placement.turned(position, *RPY.vector(table, where), name=where), Placement()
        return Placement(position, ROTATION.rows(table, where, UNMOVED), where), Placement()
    if also := sorted(set(table) & {*PLACING, "axis"} - {"dh"}):
        raise InputError(where, f"only one of dh and {also[0]}", "both")
    inside = f"{where}: dh"
    entries = read_table(table["dh"], inside)
    refuse_unknown(entries, [key for entry in (A, D, ALPHA, THETA) for key in entry.keys], inside)
    a, d, alpha, theta = (entry.scalar(entries, inside) for entry in (A, D, ALPHA, THETA))
    return Placement.turned((0, 0, 0), 0.0, 0.0, theta), Placement.turned((a, 0, d), alpha, 0.0, 0.0)


def after(first: Placement, second: Placement) -> Placement:
    """Where the second is in the frame that the first is in."""
    position = first.position + first.rotation * second.position
    return Placement(_rounded(position), _rounded(first.rotation * second.rotation))


def placed(body: Body, place: Placement) -> Body:
    """A body in the frame that its own one has this place in."""
    turn = place.rotation
    centre = place.position + turn * body.centre
    return Body(body.mass, _rounded(centre), _rounded(turn * body.inertia * turn.T), body.name)


def _rounded(matrix: sp.MatrixBase) -> sp.ImmutableMatrix:
    """Products of decimals as decimals of 17 digits; letters as they are."""
    return sp.ImmutableMatrix(
        matrix.applyfunc(lambda x: sp.Rational(repr(float(x))) if x.is_number else sp.expand(x))
    )


# The joints of an arm file: each with its drive and its body, or with its drive alone on a URDF.


AXIS, BEARING = FileQuantity("axis", "1"), FileQuantity("bearing", "m", "m")
ROTOR = FileQuantity("J_m", "kg m^2", "kgm2")
GEAR = {"revolute": FileQuantity("mu", "1"), "prismatic": FileQuantity("mu", "m/rad", "m_per_rad")}
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
            required = f"expected one of {', '.join(GEAR)}, got {kind!r}"
            raise InputError(f"{here}: kind", problem=f"{required}{meant(kind, GEAR)}")
        gear = GEAR[kind]
        refuse_unknown(table, dict.fromkeys((*KEYS_OF_JOINTS, *gear.keys)), here)
        if "body" not in table:
            raise InputError(here, "a body", "none", why=', such as body = { mass = "2 kg" }')
        place, frame = read_placements(table, here)
        axis = AXIS.vector(table, here, (0, 0, 1))
        before = found[-1].frame if found else Placement()
        drive = _drive(table, gear, here)
        with complaints_of(where):
            joint = Joint(kind, axis, after(before, place), *drive, name)
        found.append(ReadJoint(joint, read_body(table["body"], here), frame))
    if not found:
        raise InputError(where, "joints", "none", why=", each as [[joint]]")
    return found


def with_drives(read: Sequence[ReadJoint], tables: Any, where: str) -> list[ReadJoint]:
    """The joints of a URDF with drives and bearings from tables of their names; without a table mu = 1.

    Raises InputError as `read_joints`, and for a name that is not in the URDF.
    """
    given = {name: (here, table) for here, name, table in _named(tables, where)}
    names = [one.joint.name for one in read]
    if unknown := next((name for name in given if name not in names), None):
        hint = meant(unknown, names) or f"; known are {few(names)}"
        raise InputError(where, "a joint of the arm in the URDF", f"{unknown!r}{hint}")
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
        raise InputError(where, "joints", f"{tables!r}", why=", each as [[joint]]")
    seen = set[str]()
    for number, entry in enumerate(tables, 1):
        here = f"{where}: joint {number}"
        table = read_table(entry, here)
        name = table.get("name")
        if not isinstance(name, str) or not name or not name.isprintable() or name == "payload":
            raise InputError(here, "a name on one line, not 'payload'", f"{name!r}")
        if name in seen:
            raise InputError(where, "joints of different names", f"{name!r} twice")
        seen.add(name)
        yield f"{where}: {name}", name, table


def _drive(table: Mapping[str, Any], gear: FileQuantity, here: str) -> tuple[Any, Any, Any]:
    return gear.scalar(table, here, 1.0), ROTOR.scalar(table, here), BEARING.scalar(table, here)
