"""Balances: a scalar equation of the rig, a sum of terms that is zero; data is held against its residual."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

# The sign with which a kind of term enters its balance: what drives is positive, what is driven is negative.
KINDS = {
    "drive": 1,
    "inertial": -1,
    "gravity": -1,
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
        coefficient: a parameter, or 1 where the term has nothing to be identified.
        basis: what the coefficient multiplies, in inputs, parameters and defined quantities.
        reference: paper equation or other source.
        bounds: of the coefficient; None for a side that is open.
    """

    name: str
    kind: str
    coefficient: sp.Expr
    basis: sp.Expr
    reference: str
    bounds: tuple[float | None, float | None] = (0.0, None)

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"term {self.name}: kind must be one of {', '.join(KINDS)}, not {self.kind!r}")

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
