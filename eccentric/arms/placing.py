"""Frames of an arm: by position and rotation or by Denavit and Hartenberg, and one after another."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from eccentric.arms.quantities import FileQuantity
from eccentric.entries import read_table, refuse_unknown
from eccentric.errors import InputError
from eccentric.model import Body, Placement

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
            raise InputError(f"{where}: only one of rpy and rotation is required, received both")
        position = POSITION.vector(table, where)
        if "rpy" in given:
            return Placement.turned(position, *RPY.vector(table, where), name=where), Placement()
        return Placement(position, ROTATION.rows(table, where, UNMOVED), where), Placement()
    if also := sorted(set(table) & {*PLACING, "axis"} - {"dh"}):
        raise InputError(f"{where}: only one of dh and {also[0]} is required, received both")
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
