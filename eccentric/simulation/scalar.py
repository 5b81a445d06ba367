"""NumPy's functions of one number, for a drive that is stepped in Python floats: faster than arrays of one.

Arithmetic and square roots are exact to the last bit either way. All other functions are NumPy's own, which
have the same value for a number and in an array; Python's may differ in the last bit.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from types import FunctionType, SimpleNamespace
from typing import Any

import numpy as np
import sympy as sp

from eccentric.model import function_of


def _select(conditions: Sequence[bool], values: Sequence[float], default: float = math.nan) -> float:
    return next((x for x, holds in zip(values, conditions, strict=True) if holds), default)


def _power(base: float, exponent: float) -> float:
    return float((np.array([base]) ** exponent)[0])


def _numpys(name: str) -> Callable[..., float]:
    function = getattr(np, name)
    return lambda *x: float(function(*x))


SCALAR = SimpleNamespace(
    **{
        name: _numpys(name)
        for name in ("sin", "cos", "tan", "tanh", "arctan", "arcsinh", "exp", "expm1", "log")
    },
    sqrt=math.sqrt,
    abs=abs,
    sign=lambda x: float((x > 0.0) - (x < 0.0)),
    maximum=max,
    minimum=min,
    where=lambda condition, x, y: x if condition else y,
    select=_select,
    less=lambda x, y: x < y,
    less_equal=lambda x, y: x <= y,
    greater=lambda x, y: x > y,
    greater_equal=lambda x, y: x >= y,
    pi=math.pi,
    nan=math.nan,
)
"""What `numpy` is in the functions of a law. A value that is not finite may differ from NumPy's."""
_POWERS = {"square": lambda x: x * x, "power": _power}
_ROOTS = (sp.Rational(1, 2), sp.Rational(-1, 2), sp.S.NegativeOne)


def scalar_function(expression: sp.Basic) -> tuple[Callable[..., Any], tuple[str, ...]]:
    """An expression as a function of numbers, and the names of its symbols.

    Raises NotImplementedError for one with a function that `SCALAR` does not have.
    """
    # Python's power of a number is not NumPy's square of an array.
    opaque = expression.replace(lambda e: isinstance(e, sp.Pow) and e.exp not in _ROOTS, _opaque)
    call, names = function_of(opaque)
    code = call.__code__
    if missing := set(code.co_names) - {"numpy", "functools", "reduce", *vars(SCALAR), *_POWERS}:
        raise NotImplementedError(", ".join(sorted(missing)))
    return FunctionType(code, {"numpy": SCALAR, "functools": functools, **_POWERS}), names


def _opaque(power: sp.Pow) -> sp.Expr:
    base, exponent = power.args
    positive = -exponent if exponent.is_number and exponent.is_negative else exponent
    made = sp.Function("square")(base) if positive == 2 else sp.Function("power")(base, positive)
    return made if positive == exponent else 1 / made
