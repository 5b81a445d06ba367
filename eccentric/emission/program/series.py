"""Minimax polynomials for the half angle: no back end needs a sine from its library.

sin(h)/h = 1 + x S(x) and cos(h) = 1 + x C(x), x = h^2, for |h| up to a quarter turn. S and C come from the
Remez exchange at 40 digits, with the least maximum error: relative for the sine, which determines the last
digits of the normal force, absolute for the cosine. The degree is the lowest with an error below a fifth of a
unit of the working precision. The stated error is that of the coefficients rounded to the working precision.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from decimal import ROUND_UP, Context, Decimal, localcontext
from functools import cache

import mpmath

from eccentric.emission.program.digits import BITS

_DIGITS = 40  # ten of which are lost in solving the equations
# The half angle is within a quarter turn, plus its own rounding, which in single precision is at most 2^-10
# of half a turn (tests/test_polynomials.py): the error is that up to the latter edge.
_FITTED, _EDGE = "1.001", "1.002"
_GRID = 160  # points for the search of the extrema of the error
_EXCHANGES = 4
# Between such points a polynomial of degree n is at most 1/cos(n pi/2 _GRID) times its maximum at them
# (Ehlich and Zeller, Mathematische Zeitschrift 86, 1964): 1 % more for degree 14, at which all relevant
# digits are reached.
_BETWEEN = Decimal("1.01")
# Rounding errors of the polynomials relative to exact evaluation with the same coefficients, in single and in
# double precision: proved by Gappa in tests/test_polynomials.py.
_ROUNDING = {"sine_ratio": ("6.2e-8", "1.2e-16"), "cosine": ("2.3e-7", "4.2e-16")}


@dataclass(frozen=True)
class Polynomial:
    """Coefficients of S or C from the highest power down, as decimals, and bounds of their errors.

    Attributes:
        coefficients: as they are printed.
        error: bound of the method's error, of 1 + x S(x) relative to sin(h)/h, of 1 + x C(x) absolute.
        rounding: bound of the rounding error of x S(x) or 1 + x C(x), absolute.
    """

    coefficients: tuple[str, ...]
    error: str
    rounding: str


@cache
def _samples(name: str, edge: str) -> tuple[list[Decimal], list[tuple[Decimal, Decimal]]]:
    """Points x = h^2 up to the edge, and there sin(h)/h or cos(h) with the weight of its error."""
    with mpmath.workdps(_DIGITS):
        last = (mpmath.pi / 2 * mpmath.mpf(edge)) ** 2
        grid = [last * (1 - mpmath.cos(mpmath.pi * k / _GRID)) / 2 for k in range(1, _GRID + 1)]
        angles = [mpmath.sqrt(x) for x in grid]
        if name == "cosine":
            exact = [(mpmath.cos(h), 1) for h in angles]
        else:
            exact = [(mpmath.sin(h) / h, h / mpmath.sin(h)) for h in angles]
        return [_decimal(x) for x in grid], [(_decimal(value), _decimal(weight)) for value, weight in exact]


def _decimal(x: mpmath.mpf | int) -> Decimal:
    # Python's decimals take a tenth of the time: the exchange consists of sums and products only.
    return Decimal(mpmath.nstr(mpmath.mpf(x), _DIGITS))


@cache
def polynomial(name: str, single: bool) -> Polynomial:
    """The polynomial `sine_ratio` or `cosine` for single or double precision."""
    digits, allowed = (9, Decimal("1.2e-8")) if single else (17, Decimal("2.2e-17"))
    grid, exact = _samples(name, _FITTED)
    with localcontext(prec=_DIGITS), mpmath.workdps(_DIGITS):
        for count in range(3, 16):
            coefficients, error = _remez(grid, exact, count, allowed)
            if error < allowed:
                decimals = tuple(
                    mpmath.nstr(mpmath.mpf(str(c)), digits, min_fixed=0, max_fixed=0) for c in coefficients
                )
                rounded = _rounded(decimals, BITS["single" if single else "double"])
                worst = max(map(abs, _errors(*_samples(name, _EDGE), rounded))) * _BETWEEN
                stated = Context(prec=2, rounding=ROUND_UP).create_decimal(worst)
                return Polynomial(decimals, f"{stated:.1e}", _ROUNDING[name][not single])
    raise AssertionError(f"{name}: no degree below 16 reaches {allowed}")


def _rounded(decimals: Iterable[str], bits: int) -> list[Decimal]:
    with mpmath.workprec(bits):
        return [Decimal(float(mpmath.mpf(c))) for c in decimals]


def _remez(
    grid: list[Decimal], exact: list[tuple[Decimal, Decimal]], count: int, allowed: Decimal
) -> tuple[list[Decimal], Decimal]:
    """The coefficients, highest first, with the least maximum weighted error, and that error.

    If so few coefficients cannot reach the allowed error, a lower bound of their error.
    """
    at = [(2 * k + 1) * _GRID // (2 * count + 2) for k in range(count + 1)]
    coefficients, error = [], Decimal(0)
    for _ in range(_EXCHANGES):
        # The weighted error is the same at all these points, with alternating sign.
        rows = [
            [*(grid[k] ** (j + 1) for j in range(count)), (-1) ** n / exact[k][1], exact[k][0] - 1]
            for n, k in enumerate(at)
        ]
        *solved, level = _solved(rows)
        if abs(level) > allowed:  # de la Vallée Poussin: no polynomial of this degree leaves less
            return [], abs(level)
        coefficients = solved[::-1]
        errors = _errors(grid, exact, coefficients)
        error = max(map(abs, errors))
        before, at = at, _extrema(errors)
        if len(at) != count + 1 or at == before:
            break
    return coefficients, error


def _solved(rows: list[list[Decimal]]) -> list[Decimal]:
    """The solution of linear equations, each given by coefficients and right side: Gauss-Jordan."""
    for k in range(len(rows)):
        pivot = max(range(k, len(rows)), key=lambda n: abs(rows[n][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        rows = [
            row if n == k else [x - row[k] * y for x, y in zip(row, rows[k], strict=True)]
            for n, row in enumerate(rows)
        ]
    return [row[-1] for row in rows]


def _errors(
    grid: list[Decimal], exact: list[tuple[Decimal, Decimal]], coefficients: Iterable[Decimal]
) -> list[Decimal]:
    """Weighted errors at the points of the grid."""
    coefficients, errors = list(coefficients), []
    for x, (value, weight) in zip(grid, exact, strict=True):
        series = Decimal(0)
        for c in coefficients:
            series = series * x + c
        errors.append((1 + x * series - value) * weight)
    return errors


def _extrema(errors: list[Decimal]) -> list[int]:
    """The points of largest error within each stretch of one sign."""
    found: list[int] = []
    for k, error in enumerate(errors):
        if found and error * errors[found[-1]] > 0:
            if abs(error) > abs(errors[found[-1]]):
                found[-1] = k
        else:
            found.append(k)
    return found
