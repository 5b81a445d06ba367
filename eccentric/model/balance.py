"""Balances: scalar equations of the rig, sums of terms that are zero; residuals are compared with data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

import sympy as sp
from sympy.printing.pretty.pretty import PrettyPrinter
from sympy.printing.pretty.pretty_symbology import greek_unicode
from sympy.printing.pretty.stringpict import prettyForm


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


# Column of number and unit; after a wider formula they are on a separate line.
_COLUMN = 84


class _Letters(PrettyPrinter):
    """Symbols as in code (omega_m, B_lN), with Greek letters; SymPy mixes subscript styles."""

    def _print_Symbol(self, e: sp.Symbol) -> prettyForm:
        head, *tail = e.name.split("_")
        return prettyForm("_".join([greek_unicode.get(head, head), *tail]))

    def _print_Mul(self, e: sp.Mul) -> prettyForm:
        # SymPy's printer imports its physical units for this, which takes longer than all equations.
        above, below = [], []
        for factor in e.as_ordered_factors():
            if factor.is_Rational:
                above += [sp.Integer(factor.p)] if factor.p != 1 else []
                below += [sp.Integer(factor.q)] if factor.q != 1 else []
            else:
                is_divisor = factor.is_Pow and factor.exp.is_Rational and factor.exp.is_negative
                (below if is_divisor else above).append(1 / factor if is_divisor else factor)
        top, bottom = (self._product(factors) for factors in (above, below))
        return top / bottom if below else top

    def _product(self, factors: list[sp.Expr]) -> prettyForm:
        parts = [self._print(factor) for factor in factors or [sp.Integer(1)]]
        return prettyForm.__mul__(*parts)


@dataclass(frozen=True)
class Identity:
    """A fact about an equation: a statement, and an expression that is zero if the statement is true."""

    statement: str
    zero: sp.Expr


@dataclass(frozen=True)
class Equation:
    """One step of a derivation.

    Attributes:
        name: lookup key for other scripts, e.g. "normal_force".
        number: the paper's equation number, "" if the paper has none.
        left, right: both sides; a matrix on the right is a vector in the frame of the derivation.
        unit: SI unit of both sides; for a vector of different quantities one unit per row.
        origin: its derivation in one sentence.
        identities: facts proved in the tests, since a proof takes seconds.
    """

    name: str
    number: str
    left: sp.Basic
    right: sp.Basic
    unit: str | tuple[str, ...]
    origin: str
    identities: tuple[Identity, ...] = ()

    def units(self) -> tuple[str, ...]:
        """The unit of each row if they differ, else the common unit."""
        return (self.unit,) if isinstance(self.unit, str) else self.unit

    def text(self) -> str:
        """The equation for a terminal: its origin, then the formula with number and unit on the right."""
        formula = _Letters({"use_unicode": True, "wrap_line": False})
        lines = formula.doprint(sp.Eq(self.left, self.right, evaluate=False)).split("\n")
        middle = len(lines) // 2
        tag = f"{self.number or '   '}  [{', '.join(self.units())}]"
        if len(lines[middle]) < _COLUMN:
            lines[middle] = f"{lines[middle]:<{_COLUMN}}{tag}"
        else:
            lines.append(f"{'':<{_COLUMN}}{tag}")
        facts = [f"    Check: {fact.statement}." for fact in self.identities]
        return "\n".join(
            [f"{self.origin}", "", *(f"    {line}".rstrip() for line in lines), "", *facts]
        ).rstrip()

    def latex(self) -> str:
        """The equation in LaTeX, with its number as tag."""
        tag = rf" \tag{{{self.number.strip('()')}}}" if self.number else ""
        facts = "".join(f"\nCheck: {fact.statement}.\n" for fact in self.identities)
        return f"{self.origin}\n\\[ {sp.latex(self.left)} = {sp.latex(self.right)}{tag} \\]{facts}"


def equation_named(equations: Iterable[Equation], name: str) -> Equation:
    """The equation of that name; KeyError, listing the existing names, if there is none."""
    known = {equation.name: equation for equation in equations}
    if name not in known:
        raise KeyError(f"no equation {name!r}; there are {', '.join(known)}")
    return known[name]
