"""Equations: the numbered steps of a derivation, each with unit, origin and identities to be proved."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy as sp
from sympy.printing.pretty.pretty import PrettyPrinter
from sympy.printing.pretty.pretty_symbology import greek_unicode
from sympy.printing.pretty.stringpict import prettyForm

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
