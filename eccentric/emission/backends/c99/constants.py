"""The coefficients of the default parameters, computed in mpmath, so that the target need not."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import mpmath
import sympy as sp

from eccentric.emission.backends.expression import UnprintableError
from eccentric.emission.program import (
    BITS,
    LEADING_BITS,
    InSingle,
    Low,
    Minus,
    Plus,
    Program,
    Rounded,
    TurnLeft,
)
from eccentric.errors import InputError
from eccentric.model import Leading

NOT_GIVEN = "ECCENTRIC_NOT_GIVEN"
"""What a parameter without a default is until it is set: no NaN, which checkers of C take for an error."""
LARGEST_SINGLE = mpmath.mpf(2) ** 128


def evaluate_prepare(program: Program, single: bool) -> dict[str, str]:
    """Every parameter and prepared value at the default parameters, as decimals of the working precision.

    Parameters count as exact decimals, as written. A value without a default is "NAN".

    Raises:
        UnprintableError: an operation that no back end computes.
        InputError: a coefficient is beyond single precision.
    """
    with mpmath.workdps(50):
        values = prepared_values(program, single)
        if single:
            _require_single(program, values)
        return {symbol.name: decimal(value, single) for symbol, value in values.items()}


def decimal(value: mpmath.mpf, single: bool) -> str:
    """A number as a decimal of the working precision; "NAN" if it is none."""
    return "NAN" if mpmath.isnan(value) else _decimal(value, 9 if single else 17)


def prepared_values(program: Program, single: bool) -> dict[sp.Symbol, mpmath.mpf]:
    """Every parameter and prepared value at the default parameters, to the digits of mpmath at this moment.

    Raises:
        UnprintableError: an operation that no back end computes.
    """
    values = {q.symbol: _default(q.default, program) for q in program.parameters}
    for a in program.prepare:
        values[a.target] = mpmath.mpf(_value(a.value, values, single))
    return values


def _require_single(program: Program, values: Mapping[sp.Symbol, mpmath.mpf]) -> None:
    """Raise InputError, with the parameter of the oddest size, for a coefficient beyond single precision."""
    far = next((s.name for s in program.coefficients if abs(values[s]) > LARGEST_SINGLE), None)
    if far is None:
        return
    given = {q.name: values[q.symbol] for q in program.parameters if abs(values[q.symbol]) > 0}
    odd = max(given, key=lambda name: abs(mpmath.log(given[name])))
    raise InputError(
        f"{program.name}: {far} within single precision is required, received {odd} = "
        f"{mpmath.nstr(given[odd], 6)}, with which it is beyond"
    )


_OPERATIONS: Mapping[type, Callable[..., mpmath.mpf]] = {
    sp.Add: lambda *terms: mpmath.fsum(terms),
    sp.Mul: lambda *factors: mpmath.fprod(factors),
    sp.Pow: mpmath.power,
    sp.Abs: abs,
    sp.sin: mpmath.sin,
    sp.cos: mpmath.cos,
    sp.exp: mpmath.exp,
    Plus: lambda a, b: a + b,
    Minus: lambda a, b: a - b,
    TurnLeft: lambda a, b: 2 * mpmath.pi - a * b,
}


def _value(e: sp.Expr, values: Mapping[sp.Symbol, mpmath.mpf], single: bool) -> mpmath.mpf:
    """The expression, evaluated operation by operation.

    Raises:
        UnprintableError: an operation that no back end computes either.
    """
    if e.is_Symbol:
        return values[e]
    if e.is_Rational:
        return mpmath.mpf(e.p) / e.q
    if e.is_number and not e.args:
        return mpmath.mpf(e.evalf(mpmath.mp.dps))
    if isinstance(e, sp.Piecewise):
        return next(_value(x, values, single) for x, condition in e.args if _holds(condition, values, single))
    if isinstance(e, Low):  # nothing is rounded here
        return mpmath.mpf(0)
    if isinstance(e, InSingle):
        return _value(e.args[0 if single else 1], values, single)
    arguments = [_value(a, values, single) for a in e.args]
    precision = "single" if single else "double"
    if isinstance(e, Leading):
        return _round(arguments[0], LEADING_BITS[precision])
    if isinstance(e, Rounded):
        return _round(arguments[0], BITS[precision])
    if type(e) not in _OPERATIONS:
        raise UnprintableError(e)
    return _OPERATIONS[type(e)](*arguments)


def _holds(condition: sp.Basic, values: Mapping[sp.Symbol, mpmath.mpf], single: bool) -> bool:
    if condition == sp.true:
        return True
    if not isinstance(condition, sp.Eq):
        raise UnprintableError(condition)
    left, right = (_value(side, values, single) for side in condition.args)
    return left == right


def _default(default: sp.Expr | None, program: Program) -> mpmath.mpf:
    if default is None:
        return mpmath.mpf("nan")
    known = {q.symbol: q.default for q in program.parameters if q.default is not None}
    exact = sp.Rational(default.xreplace(known))
    return mpmath.mpf(exact.p) / mpmath.mpf(exact.q)


def _round(value: mpmath.mpf, bits: int) -> mpmath.mpf:
    with mpmath.workprec(bits):
        return +value


def _decimal(value: mpmath.mpf, digits: int) -> str:
    text = mpmath.nstr(value, digits, min_fixed=-4, max_fixed=6)
    return text if any(mark in text for mark in ".en") else f"{text}.0"
