"""Friction in few operations: terms that share a factor, or differ only in direction, become one."""

from __future__ import annotations

from functools import cache

import sympy as sp

from eccentric.model import Backward, ByDirection, Forward, Gated, Sgn
from eccentric.model import vocabulary as v


@cache
def grouped(fixed: frozenset[sp.Symbol], slopes: frozenset[sp.Symbol], expression: sp.Expr) -> sp.Expr:
    """Friction as (... F_N + ...) omega_m + (... F_N + ...) sgn: fewest operations per call, (18)-(20).

    Args:
        fixed: symbols that depend on parameters only.
        slopes: derivatives of earlier values, which enter proportionally by the chain rule.
        expression: the friction torque, or a derivative of it.
    """
    if not isinstance(expression, sp.Add):
        return expression
    if inner := sorted(expression.free_symbols & slopes, key=str):
        parts = sp.collect(sp.expand_mul(expression), inner, evaluate=False)
        return sp.Add(*(slope * grouped(fixed, slopes, factor) for slope, factor in parts.items()))
    expression = _by_direction(fixed, sp.expand_mul(expression))
    factors: list[sp.Expr] = [v.omega_m.symbol] if expression.has(v.omega_m.symbol) else []
    factors += sorted(expression.atoms(Sgn), key=str)
    if any(isinstance(term, sp.Mul) and term.has(*factors) for term in expression.args if factors):
        return _collected(expression, factors)
    return expression


def _collected(expression: sp.Expr, factors: list[sp.Expr]) -> sp.Expr:
    """The sum with each of the factors written once, in front of its terms."""
    parts: dict[sp.Expr, list[sp.Expr]] = {}
    for term in expression.args:
        own = sp.Mul.make_args(term)
        shared = next((factor for factor in factors if factor in own), sp.Integer(1))
        parts.setdefault(shared, []).append(term / shared)
    return sp.Add(*(shared * sp.Add(*rest) for shared, rest in parts.items()))


def _by_direction(parameters: frozenset[sp.Symbol], expression: sp.Expr) -> sp.Expr:
    """Addends that differ only in gate and parameters become one, with a coefficient chosen by direction."""
    pairs: dict[tuple[sp.Expr, sp.Expr], dict[type, sp.Expr]] = {}
    rest = []
    for term in sp.Add.make_args(expression):
        gated = [factor for factor in sp.Mul.make_args(term) if isinstance(factor, Gated)]
        if len(gated) == 1 and isinstance(gated[0].args[1], Forward | Backward):
            basis, gate = gated[0].args
            fixed = [a for a in sp.Mul.make_args(basis) if a.free_symbols <= parameters]
            moving = sp.Mul(*(a for a in sp.Mul.make_args(basis) if a not in fixed))
            sides = pairs.setdefault(
                (moving, gate.args[0]), {Forward: sp.Integer(0), Backward: sp.Integer(0)}
            )
            sides[type(gate)] += term / gated[0] * sp.Mul(*fixed)
        else:
            rest.append(term)
    chosen = [basis * ByDirection(x, *sides.values()) for (basis, x), sides in pairs.items()]
    return sp.Add(*rest, *chosen)
