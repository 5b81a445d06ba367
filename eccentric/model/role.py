"""What a friction term does and which load it follows: declared where the term is made, not read off a name.

Roles decide what else belongs to a term: a temperature of the lubricant scales what is viscous, whatever the
term is called; Coulomb and viscous friction that follow no load are the linear model that every other is
compared with.
"""

from __future__ import annotations

from enum import StrEnum


class Role(StrEnum):
    """What a term of friction does; terms of any other kind have none."""

    NONE = "none"
    """No friction: the kind of the term says what it is."""
    VISCOUS = "viscous"
    """A lubricant film is sheared: in proportion to its viscosity, whatever the load or the direction."""
    COULOMB = "coulomb"
    """Surfaces slide on each other: opposes the motion, whatever its speed."""
    STRIBECK = "stribeck"
    """By how much dry friction is higher near rest, before a film of lubricant carries the load."""
    PRESLIDING = "presliding"
    """Coulomb friction that builds up with the travelled angle: what is missing of it after a reversal."""
    DRAG = "drag"
    """A fluid is displaced: air around a fan, churned oil; a power of the speed."""
    EDDY_CURRENT = "eddy_current"
    """Induced currents brake: no contact and no fluid."""


class Load(StrEnum):
    """The load that a term is in proportion to."""

    NONE = "none"
    """None, or one that does not change: a preload, a weight along the axis."""
    NORMAL = "F_N"
    """The normal force F_N: the bearing's load in the plane of motion, eq (8) and (16)."""
    TRANSVERSAL = "F_T"
    """The transversal force F_T: the bearing's load along its axis."""
    BENDING = "bending_moment"
    """The moment that tilts the bearing's axis."""
    TRANSMITTED = "transmitted_torque"
    """The torque that the gear passes on."""


CONTACT = frozenset({Role.VISCOUS, Role.COULOMB, Role.STRIBECK, Role.PRESLIDING})
"""Friction where surfaces meet, with or without a lubricant between them: bearings, seals, gears."""
