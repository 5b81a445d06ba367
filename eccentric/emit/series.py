"""Minimax polynomials of emission's own for the half angle: no back end needs a sine from its library.

sin(h)/h = 1 + x S(x) and cos(h) = 1 + x C(x), x = h^2, for |h| up to a quarter turn. S and C come from Remez'
exchange at 30 digits, for the least greatest error: relative for the sine, which the normal force takes its
last digits from, absolute for the cosine. The degree is the least that keeps it below a fifth of a unit of
the working precision.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

import mpmath

# The half angle lies within a quarter turn; a little more for its own rounding.
_EDGE = "1.001"
_GRID = 160  # points among which the extrema of the error are looked for
_EXCHANGES = 4


@dataclass(frozen=True)
class Polynomial:
    """Coefficients of S or C from the highest power down, as decimals, and the greatest error of the fit."""

    coefficients: tuple[str, ...]
    error: str


def _sine_ratio(x: mpmath.mpf) -> tuple[mpmath.mpf, mpmath.mpf]:
    """sin(h)/h at x = h^2, and the weight of its error."""
    h = mpmath.sqrt(x)
    value = mpmath.sin(h) / h
    return value, 1 / value


def _cosine(x: mpmath.mpf) -> tuple[mpmath.mpf, mpmath.mpf]:
    """cos(h) at x = h^2, and the weight of its error."""
    return mpmath.cos(mpmath.sqrt(x)), mpmath.mpf(1)


@cache
def polynomial(name: str, single: bool) -> Polynomial:
    """The polynomial `sine_ratio` or `cosine` for single or double precision."""
    function = {"sine_ratio": _sine_ratio, "cosine": _cosine}[name]
    digits, allowed = (9, "1.2e-8") if single else (17, "2.2e-17")
    with mpmath.workdps(30):
        edge = (mpmath.pi / 2 * mpmath.mpf(_EDGE)) ** 2
        grid = [edge * (1 - mpmath.cos(mpmath.pi * k / _GRID)) / 2 for k in range(1, _GRID + 1)]
        exact = [function(x) for x in grid]
        for count in range(3, 16):
            coefficients, error = _remez(grid, exact, count, mpmath.mpf(allowed))
            if error < mpmath.mpf(allowed):
                decimals = tuple(mpmath.nstr(c, digits, min_fixed=0, max_fixed=0) for c in coefficients)
                return Polynomial(decimals, mpmath.nstr(_greatest(grid, exact, map(mpmath.mpf, decimals)), 2))
    raise AssertionError(f"{name}: no degree below 16 reaches {allowed}")


def _remez(
    grid: list[mpmath.mpf], exact: list[tuple[mpmath.mpf, mpmath.mpf]], count: int, allowed: mpmath.mpf
) -> tuple[list[mpmath.mpf], mpmath.mpf]:
    """The coefficients, highest first, whose greatest weighted error is least, and that error.

    Where so few coefficients cannot come down to the allowed error, what they leave at least.
    """
    at = [(2 * k + 1) * _GRID // (2 * count + 2) for k in range(count + 1)]
    coefficients, error = [], mpmath.mpf(0)
    for _ in range(_EXCHANGES):
        # The weighted error is the same at all these points, its sign in turn.
        rows = [
            [*(grid[k] ** (j + 1) for j in range(count)), (-1) ** n / exact[k][1]] for n, k in enumerate(at)
        ]
        solved = mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix([exact[k][0] - 1 for k in at]))
        if abs(solved[count]) > allowed:  # de la Vallée Poussin: no polynomial of this degree leaves less
            return [], abs(solved[count])
        coefficients = list(solved[:count])[::-1]
        errors = _errors(grid, exact, coefficients)
        error = max(map(abs, errors))
        at = _extrema(errors)
        if len(at) != count + 1:
            break
    return coefficients, error


def _errors(
    grid: list[mpmath.mpf], exact: list[tuple[mpmath.mpf, mpmath.mpf]], coefficients: list[mpmath.mpf]
) -> list[mpmath.mpf]:
    """Weighted errors at the points of the grid."""
    return [
        (1 + x * mpmath.polyval(coefficients, x) - value) * weight
        for x, (value, weight) in zip(grid, exact, strict=True)
    ]


def _greatest(
    grid: list[mpmath.mpf], exact: list[tuple[mpmath.mpf, mpmath.mpf]], coefficients: Iterable[mpmath.mpf]
) -> mpmath.mpf:
    """The greatest error of the coefficients as printed: rounding to decimals has its part in it."""
    return max(map(abs, _errors(grid, exact, list(coefficients))))


def _extrema(errors: list[mpmath.mpf]) -> list[int]:
    """Where the error is greatest within each stretch of one sign."""
    found: list[int] = []
    for k, error in enumerate(errors):
        if found and error * errors[found[-1]] > 0:
            if abs(error) > abs(errors[found[-1]]):
                found[-1] = k
        else:
            found.append(k)
    return found
