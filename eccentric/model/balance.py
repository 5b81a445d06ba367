"""Balances: scalar equations of the rig, sums of terms that are zero; residuals are compared with data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import sympy as sp

# Role and load of a friction term, declared with the term, not deduced from its name.
#
# Roles decide what applies to a term: lubricant temperature scales viscous friction, whatever the term is
# called; Coulomb and viscous friction without a load form the linear baseline of all comparisons.


class Role(StrEnum):
    """Physical role of a friction term; other terms have none."""

    NONE = "none"
    """Not friction: see the kind of the term."""
    VISCOUS = "viscous"
    """Shear of a lubricant film: proportional to its viscosity, whatever the load or direction."""
    COULOMB = "coulomb"
    """Sliding surfaces: opposes the motion, whatever the speed."""
    STRIBECK = "stribeck"
    """Increase of dry friction near rest, before a lubricant film carries the load."""
    PRESLIDING = "presliding"
    """Build-up of Coulomb friction over the travelled angle: its deficit after a reversal."""
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
    """The torque transmitted by the gear."""


CONTACT = frozenset({Role.VISCOUS, Role.COULOMB, Role.STRIBECK, Role.PRESLIDING})
"""Friction where surfaces meet, with or without a lubricant between them: bearings, seals, gears."""


# The sign of a kind of term in its balance: driving terms are positive, driven ones negative.
KINDS = {
    "drive": 1,
    "inertial": -1,
    "gravity": -1,
    # The torque of a chain's bodies: inertia, Coriolis and centrifugal forces and gravity in one recursion.
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
        bounds: of the coefficient; None for an open side.
        role: required for friction, and only for friction.
        load: the load that it is proportional to.
        joint: index from the base; a single link has joint 0.
        per_turn: periods of a ripple per motor turn, in parameters; 0 for terms that are no ripple, or a
            measuring error of the angle.
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
        for name, value, kind in (("role", self.role, Role), ("load", self.load, Load)):
            if not isinstance(value, kind):
                known = ", ".join(f"{kind.__name__}.{member.name}" for member in kind)
                raise TypeError(f"term {self.name}: {name}: expected one of {known}, got {value!r}")
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
        """Solve the balance for a symbol, such as the armature current.

        Raises:
            ValueError: the balance does not depend on the symbol, or not linearly.
        """
        residual = sp.expand(self.residual())
        slope = residual.coeff(symbol)
        rest = sp.expand(residual - slope * symbol)
        if slope == 0 or symbol in slope.free_symbols | rest.free_symbols:
            raise ValueError(f"balance {self.name}: expected a sum that is linear in {symbol}")
        return -rest / slope
