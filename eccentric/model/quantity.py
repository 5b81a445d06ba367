"""Quantities: a SymPy symbol with the paper's letter, its name in code, unit, meaning and equation number."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from eccentric.model.reserved import require_free

_ASSUMPTIONS = {
    "positive": {"positive": True},
    "nonnegative": {"nonnegative": True},
    "real": {"real": True},
    "tilt": {"nonnegative": True},  # 0 to a right angle
}


@dataclass(frozen=True)
class Quantity:
    """One letter of the vocabulary.

    Attributes:
        symbol: the SymPy symbol; its name is the name in NumPy and C.
        unit: SI unit, e.g. "N m s/rad"; "1" for a pure number.
        meaning: what it is, in a few words.
        equation: the paper's equation number, "" where the paper has none.
        domain: of valid values: "positive", "nonnegative", "real" or "tilt" (0 to a right angle).
        default: the paper's value as a decimal, or an expression in other parameters; None if there is none.
        letter: its form in a formula, if different from its name: "eta_2", "B_m^+", "Delta t", "i^'".
        part_of: the declared quantity that it is a fraction of; with an added mass it applies to the declared
            part alone. None for all others.
    """

    symbol: sp.Symbol
    unit: str
    meaning: str
    equation: str = ""
    domain: str = "real"
    default: sp.Expr | None = None
    letter: str = ""
    part_of: sp.Symbol | None = None

    @property
    def name(self) -> str:
        """The name in code."""
        return self.symbol.name


def quantity(
    name: str,
    unit: str,
    meaning: str,
    equation: str = "",
    domain: str = "real",
    default: str | sp.Expr | None = None,
    letter: str = "",
    part_of: Quantity | None = None,
) -> Quantity:
    """Make a quantity; a decimal default such as "0.25" is kept exact (1/4).

    Raises:
        InputError: the name is not an identifier, or one that C, C++ or Python has taken.
        ValueError: the domain is unknown.
    """
    require_free(name)
    if domain not in _ASSUMPTIONS:
        raise ValueError(f"{name}: domain: one of {', '.join(_ASSUMPTIONS)} is required, received {domain!r}")
    value = sp.Rational(default) if isinstance(default, str) else default
    symbol, whole = sp.Symbol(name, **_ASSUMPTIONS[domain]), None if part_of is None else part_of.symbol
    return Quantity(symbol, unit, meaning, equation, domain, value, letter, whole)


def symbols(*quantities: Quantity) -> tuple[sp.Symbol, ...]:
    """The symbols of several quantities, for the first lines of a derivation."""
    return tuple(quantity.symbol for quantity in quantities)
