"""Balances: a scalar equation of the rig, a sum of terms that is zero; its residual is compared with data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import sympy as sp

# What a friction term does and which load it follows: declared with the term, not deduced from a name.
#
# Roles decide what applies to a term: the temperature of the lubricant scales viscous friction, whatever the
# term is called; Coulomb and viscous friction without a load are the linear model that every other model is
# compared with.


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


# The sign of a kind of term in its balance: driving terms are positive, driven ones negative.
KINDS = {
    "drive": 1,
    "inertial": -1,
    "gravity": -1,
    # What moves the bodies of a chain: inertia, Coriolis and centrifugal forces and gravity in one recursion.
    "bodies": -1,
    "friction": -1,
    "conservative": -1,
    "back_emf": -1,
    "resistive": -1,
    "actuator": -1,
}


@dataclass(frozen=True)
class Term:
    """One addend of a balance: coefficient times basis.

    Attributes:
        name: in code, e.g. "link_viscous_normal".
        kind: one of KINDS.
        coefficient: a parameter, or 1 if the term has nothing to identify.
        basis: the factor of the coefficient, in inputs, parameters and defined quantities.
        reference: paper equation or other source.
        bounds: of the coefficient; None for a side that is open.
        role: what it does; required for friction, and only for friction.
        load: the load that it is proportional to.
        joint: the joint that it belongs to, counted from the base; a single link has joint 0.
        per_turn: how often a ripple over the motor's angle repeats per turn of it, in parameters; 0 for what
            is none, or is a misreading of that angle.
    """

    name: str
    kind: str
    coefficient: sp.Expr
    basis: sp.Expr
    reference: str
    bounds: tuple[float | None, float | None] = (0.0, None)
    role: Role = Role.NONE
    load: Load = Load.NONE
    joint: int = 0
    per_turn: sp.Expr | int = 0

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"term {self.name}: kind: expected one of {', '.join(KINDS)}, got {self.kind!r}")
        for name, given, words in (("role", self.role, Role), ("load", self.load, Load)):
            if not isinstance(given, words):
                known = ", ".join(f"{words.__name__}.{word.name}" for word in words)
                raise TypeError(f"term {self.name}: {name}: expected one of {known}, got {given!r}")
        if self.kind == "friction" and self.role is Role.NONE:
            roles = ", ".join(f"Role.{role.name}" for role in Role if role is not Role.NONE)
            raise ValueError(f"term {self.name}: expected a role of friction, one of {roles}, got none")
        if self.kind != "friction" and self.role is not Role.NONE:
            raise ValueError(
                f"term {self.name}: only friction has a role, got {self.role} of kind {self.kind}"
            )
        if self.joint < 0:
            raise ValueError(f"term {self.name}: joint: expected 0 or above, got {self.joint}")

    @property
    def value(self) -> sp.Expr:
        """Coefficient times basis, without the sign of its kind."""
        return self.coefficient * self.basis


@dataclass(frozen=True)
class Balance:
    """A sum of terms that is zero.

    Attributes:
        name: "mechanical" [N m, motor side] or "electrical" [V].
        unit: of every term.
        terms: the addends.
    """

    name: str
    unit: str
    terms: tuple[Term, ...]

    def sum_of(self, *kinds: str) -> sp.Expr:
        """Sum of the terms of these kinds, without the sign of the kind."""
        return sp.Add(*(term.value for term in self.terms if term.kind in kinds))

    def residual(self) -> sp.Expr:
        """The sum of all terms, each with the sign of its kind: zero if the balance holds."""
        return sp.Add(*(KINDS[term.kind] * term.value for term in self.terms))

    def solved_for(self, symbol: sp.Symbol) -> sp.Expr:
        """The value of a symbol that makes the residual zero, such as the current in the armature.

        Raises:
            ValueError: the balance does not depend on the symbol, or not linearly.
        """
        residual = sp.expand(self.residual())
        slope = residual.coeff(symbol)
        rest = sp.expand(residual - slope * symbol)
        if slope == 0 or symbol in slope.free_symbols | rest.free_symbols:
            raise ValueError(f"balance {self.name}: expected a sum that is linear in {symbol}")
        return -rest / slope
