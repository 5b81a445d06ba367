"""Polynomials of emission's own for the half angle: no back end needs a sine from its library.

sin(x) = x S(x^2) and cos(x) = C(x^2) for |x| up to a quarter turn. S and C are Chebyshev fits made in mpmath
at 50 digits, near to minimax; the degree is the least that keeps the error below half a unit of the working
precision.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import mpmath

# The half angle lies within a quarter turn; a little more for its own rounding.
_EDGE = "1.001"


@dataclass(frozen=True)
class Polynomial:
    """Coefficients from the highest power of x^2 down, as decimals, and the greatest error of the fit."""

    coefficients: tuple[str, ...]
    error: str


def _sine(square: mpmath.mpf) -> mpmath.mpf:
    x = mpmath.sqrt(square)
    return mpmath.sin(x) / x if x else mpmath.mpf(1)


def _cosine(square: mpmath.mpf) -> mpmath.mpf:
    return mpmath.cos(mpmath.sqrt(square))


@cache
def polynomial(name: str, single: bool) -> Polynomial:
    """The polynomial `sine_series` or `cosine_series` for single or double precision."""
    function: Callable[[mpmath.mpf], mpmath.mpf] = {"sine_series": _sine, "cosine_series": _cosine}[name]
    digits, allowed = (9, "2e-8") if single else (17, "3e-17")
    with mpmath.workdps(50):
        edge = (mpmath.pi / 2 * mpmath.mpf(_EDGE)) ** 2
        for count in range(4, 16):
            coefficients, error = mpmath.chebyfit(function, [0, edge], count, error=True)
            if error < mpmath.mpf(allowed):
                decimals = tuple(mpmath.nstr(c, digits, min_fixed=0, max_fixed=0) for c in coefficients)
                return Polynomial(decimals, mpmath.nstr(error, 2))
    raise AssertionError(f"{name}: no degree below 16 reaches {allowed}")
