"""What a friction term does and which load it follows: declared with the term, not deduced from a name.

Roles decide what applies to a term: the temperature of the lubricant scales viscous friction, whatever the
term is called; Coulomb and viscous friction without a load are the linear model that every other model is
compared with.
"""

from __future__ import annotations

from enum import StrEnum


class Role(StrEnum):
    """What a friction term does; terms of any other kind have no role."""

    NONE = "none"
    """Not friction: the kind of the term says what it is."""
    VISCOUS = "viscous"
    """Shear of a lubricant film: in proportion to its viscosity, whatever the load or the direction."""
    COULOMB = "coulomb"
    """Sliding surfaces: opposes the motion, whatever its speed."""
    STRIBECK = "stribeck"
    """Increase of dry friction near rest, before a film of lubricant carries the load."""
    PRESLIDING = "presliding"
    """Coulomb friction that builds up over the travelled angle: its deficit after a reversal."""
    DRAG = "drag"
    """Displacement of a fluid: air around a fan, churned oil; a power of the speed."""
    EDDY_CURRENT = "eddy_current"
    """Braking by induced currents, without contact or fluid."""


class Load(StrEnum):
    """The load that a term is proportional to."""

    NONE = "none"
    """No load, or a constant one: a preload, a weight along the axis."""
    NORMAL = "F_N"
    """The normal force F_N: the bearing's load in the plane of motion, eq (8) and (16)."""
    TRANSVERSAL = "F_T"
    """The transversal force F_T: the bearing's load along its axis."""
    BENDING = "bending_moment"
    """The bending moment on the bearing."""
    TRANSMITTED = "transmitted_torque"
    """The torque that the gear transmits."""


CONTACT = frozenset({Role.VISCOUS, Role.COULOMB, Role.STRIBECK, Role.PRESLIDING})
"""Friction where surfaces meet, with or without a lubricant between them: bearings, seals, gears."""
