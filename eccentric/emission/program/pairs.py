"""Parameters beyond double precision: which prepared values are computed as pairs of doubles, and how.

A pair is an unevaluated sum, high + low, with some 104 bits. Values with a low part (the critical velocity,
the period of the motor angle) are computed this way from the parameters on: near the zero of F_N the leading
digits of speed and angle cancel against them, and the rest depends on the digits that follow.
"""

from __future__ import annotations

import sympy as sp

from eccentric.emission.program.primitive import Low, TurnLeft
from eccentric.emission.program.program import Program


def paired(program: Program) -> frozenset[sp.Symbol]:
    """The prepared values computed as pairs.

    Those whose low part is used, what they follow from, and where F_N uses one, what it is multiplied
    by: each rounding of a product of five parameters would show in the last place of every normal force.
    """
    values = {a.target: a.value for a in program.prepare}
    waiting = {e.args[0] for value in values.values() for e in value.atoms(Low)}
    of_force = _of_normal_force(program) & set(values)
    if any(values[s].has(Low) for s in of_force):
        waiting |= {s for s in of_force if _is_product(values[s])}
    found: set[sp.Symbol] = set()
    while waiting:
        symbol = waiting.pop()
        found.add(symbol)
        exact = {s for e in values[symbol].atoms(TurnLeft) for s in e.free_symbols}
        waiting |= (values[symbol].free_symbols & set(values)) - found - exact
    return frozenset(found)


def _of_normal_force(program: Program) -> set[sp.Symbol]:
    steady = {"theta_m", "omega_m"}  # with an acceleration F_N vanishes along a curve: its bound is absolute
    routines = [
        r
        for r in program.routines
        if r.name == "normal_force" and {x.quantity.name for x in r.inputs} <= steady
    ]
    return set().union(*(a.value.free_symbols for r in routines for a in r.assignments))


def _is_product(value: sp.Expr) -> bool:
    branches = [e for e, _ in value.args] if isinstance(value, sp.Piecewise) else [value]
    return any(e.is_Mul and e.free_symbols for e in branches) and not value.has(sp.sin, sp.cos, sp.exp)
