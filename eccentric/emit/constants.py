"""The coefficients of the default parameters, computed in mpmath: the target has nothing left to compute."""

from __future__ import annotations

import mpmath
import sympy as sp

from eccentric.emit.primitive import InSingle, Rounded, exact
from eccentric.emit.program import Program
from eccentric.emit.text import LEADING_BITS
from eccentric.model.steps import Leading

_BITS = {True: 24, False: 53}  # of the working precision


def evaluate_prepare(program: Program, single: bool) -> dict[str, str]:
    """Every parameter and prepared value at the default parameters, as decimals of the working precision.

    Parameters count as the exact decimals they are written as. Without a default a value is "NAN".
    """
    digits = 9 if single else 17
    with mpmath.workdps(50):
        values = {q.symbol: _default(q.default, program) for q in program.parameters}
        rounding = {
            "Leading": lambda x: _round(x, LEADING_BITS["single" if single else "double"]),
            "Rounded": lambda x: _round(x, _BITS[single]),
        }
        for a in program.prepare:
            value = a.value.replace(InSingle, lambda in_single, in_double: in_single if single else in_double)
            symbols = sorted(value.free_symbols, key=str)
            function = sp.lambdify(
                symbols,
                exact(value).replace(Leading, _Leading).replace(Rounded, _Rounded),
                modules=[rounding, "mpmath"],
            )
            values[a.target] = mpmath.mpf(function(*(values[s] for s in symbols)))
        return {
            symbol.name: "NAN" if mpmath.isnan(value) else _decimal(value, digits)
            for symbol, value in values.items()
        }


# lambdify evaluates an unknown function by its name in `modules`.
_Leading = sp.Function("Leading")
_Rounded = sp.Function("Rounded")


def _default(default: sp.Expr | None, program: Program) -> mpmath.mpf:
    if default is None:
        return mpmath.mpf("nan")
    known = {q.symbol: q.default for q in program.parameters if q.default is not None}
    exact = sp.Rational(sp.sympify(default).subs(known))
    return mpmath.mpf(exact.p) / mpmath.mpf(exact.q)


def _round(value: mpmath.mpf, bits: int) -> mpmath.mpf:
    with mpmath.workprec(bits):
        return +value


def _decimal(value: mpmath.mpf, digits: int) -> str:
    text = mpmath.nstr(value, digits, min_fixed=-4, max_fixed=6)
    return text if any(mark in text for mark in ".en") else f"{text}.0"
