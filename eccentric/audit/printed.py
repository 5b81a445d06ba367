"""Table 1: its printed coefficients next to those of the derivation, and its values."""

from __future__ import annotations

import math
from collections.abc import Mapping

import sympy as sp

from eccentric.model import Quantity, load_model
from eccentric.model import vocabulary as v

__all__ = ["PRINTED", "agrees", "at_table", "listed", "polynomial", "table_1", "values"]

# Printed in Table 1, digit by digit: compared with the derivation; nothing is computed from it.
PRINTED = {
    sp.Rational(1, 5): ("8.0000e-7", "8.0000e-5", "4.7139e-3", "3.9392e-2"),
    sp.Rational(1, 30): ("6.1728e-10", "3.7037e-7", "4.4087e-3", "1.3232e-2"),
}
_NAMES = ("F_3", "F_2", "F_1", "F_0")


def polynomial(mu: sp.Rational, **changed: sp.Expr) -> tuple[sp.Expr, ...]:
    """F_3, F_2, F_1, F_0 for omega_m > 0 from the derivation of C1, at Table 1's values, exactly.

    Args:
        mu: gear ratio.
        changed: parameters that differ from Table 1, by their letters.
    """
    model = load_model("c1_perpendicular")
    column = [*model.equation("polynomial_high").right, *model.equation("polynomial_low").right]
    return tuple(sp.nsimplify(at_table(entry, mu, changed)) for entry in column)


def values(name: str, **changed: sp.Expr) -> dict[sp.Symbol, sp.Expr]:
    """Table 1 for a model, symbol -> value; `changed`: parameters that differ from it, by their letters."""
    given = {q: changed.get(q.name, q.default) for q in load_model(name).parameters}
    return {q.symbol: value for q, value in given.items() if value is not None}


def at_table(expression: sp.Expr, mu: sp.Rational, changed: Mapping[str, sp.Expr]) -> sp.Expr:
    """An expression of C1 at Table 1's values for omega_m > 0; `changed` as in `polynomial`."""
    model = load_model("c1_perpendicular")
    table = {q.symbol: q.default for q in model.parameters if q.default is not None}
    table |= {v.mu.symbol: mu} | {q.symbol: changed[q.name] for q in model.parameters if q.name in changed}
    transversal = {
        v.beta_T.symbol: v.B_lT.symbol * v.F_T.symbol,
        v.gamma_T.symbol: v.C_lT.symbol * v.F_T.symbol,
    }
    forward = {sp.sign(v.omega_m.symbol): 1}
    return expression.subs(forward).subs(transversal).subs(v.F_T.symbol, table[v.F_T.symbol]).subs(table)


def listed(quantity: Quantity) -> sp.Expr:
    """The quantity's value in Table 1; ValueError if the table has none."""
    if quantity.default is None:
        raise ValueError(f"{quantity.name}: Table 1 lists no value")
    return quantity.default


def agrees(printed: str, value: sp.Expr) -> bool:
    """Whether a printed decimal is the value rounded to that many digits."""
    digits = len(printed.split("e", maxsplit=1)[0].replace(".", ""))
    return math.isclose(float(f"{float(value):.{digits - 1}e}"), float(printed), rel_tol=1e-12)


def table_1() -> str:
    """Table 1's coefficients for both gear ratios next to the derivation's, as text."""
    lines = [
        (
            "Table 1, coefficients of (11) for omega_m > 0:"
            " printed, derived, and whether all printed digits agree"
        ),
        "",
    ]
    for mu, printed in PRINTED.items():
        for name, text, value in zip(_NAMES, printed, polynomial(mu), strict=True):
            verdict = "agrees" if agrees(text, value) else "DIFFERS"
            lines.append(f"  mu = {mu!s:<5} {name}  {text:>10}  {float(value):.8e}  {verdict}")
    return "\n".join(lines)
