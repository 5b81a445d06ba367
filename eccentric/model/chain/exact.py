"""Numbers and letters of a chain: exact in SymPy, so that zeros and ones fold away."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from eccentric.errors import InputError

Value = float | str | sp.Expr
"""A number (a decimal is kept exact: 0.1, "0.1" and "1/10" are the same), or an expression in parameters."""


def exact(value: Any, what: str) -> sp.Expr:
    """The value as an exact number or as the expression that it is.

    Raises:
        InputError: it is neither a finite number nor an expression; `what` names it.
    """
    if isinstance(value, sp.Expr) and not value.is_Float:
        if value.is_number and not value.is_finite:
            raise InputError(f"{what}: a finite number is required, received {value}")
        return value
    try:
        number = Fraction(value) if isinstance(value, str) else float(value)
    except (TypeError, ValueError, ZeroDivisionError):
        raise InputError(f"{what}: a number is required, received {value!r}") from None
    if not math.isfinite(number):
        raise InputError(f"{what}: a finite number is required, received {value!r}")
    return sp.Rational(number if isinstance(number, Fraction) else repr(number))


def vector(values: Iterable[Any], what: str) -> sp.ImmutableMatrix:
    """Three exact values, as a column.

    Raises:
        InputError: there are not three, or one of them is no number.
    """
    entries = list(values) if isinstance(values, Sequence | sp.MatrixBase) else None
    if entries is None and hasattr(values, "tolist"):
        entries = list(values)
    if entries is None or len(entries) != 3:
        raise InputError(f"{what}: three numbers are required, received {values!r}")
    return sp.ImmutableMatrix([exact(value, what) for value in entries])


def matrix(values: Any, what: str) -> sp.ImmutableMatrix:
    """Three rows of three exact values.

    Raises:
        InputError: there are not, or one of them is no number.
    """
    rows = values.tolist() if hasattr(values, "tolist") else values
    if not isinstance(rows, Sequence) or len(rows) != 3:
        raise InputError(f"{what}: three rows of three numbers are required, received {values!r}")
    return sp.ImmutableMatrix([list(vector(row, what)) for row in rows])


def skew(w: sp.MatrixBase) -> sp.ImmutableMatrix:
    """The matrix S(w) of the cross product: S(w) v is w x v."""
    return sp.ImmutableMatrix([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def is_zero(value: sp.Expr) -> bool:
    """Whether it is the number 0."""
    return value.is_zero is True
