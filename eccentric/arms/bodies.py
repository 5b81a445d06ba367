"""Bodies of an arm file, and what of them stays symbolic."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from eccentric.arms.quantities import INERTIA, FileQuantity
from eccentric.entries import read_table, refuse_unknown
from eccentric.errors import InputError, few, meant
from eccentric.model import Body, Quantity, quantity

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
        raise InputError(f'{where}: a list such as ["payload"] is required, received {value!r}')
    bodies = ("payload", *names)
    known = {body: (body, PARTS) for body in bodies}
    known |= {f"{body}.{part}": (body, (part,)) for body in bodies for part in PARTS}
    found: dict[str, set[str]] = {}
    for entry in value:
        if not isinstance(entry, str) or entry not in known:
            hint = meant(entry, known) or f"; known are {few(bodies)}, and of each .mass, .centre, .inertia"
            raise InputError(f"{where}: a body of this arm is required, received {entry!r}{hint}")
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
