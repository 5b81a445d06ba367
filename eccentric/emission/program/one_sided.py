"""Friction on one side of zero velocity: its limit at standstill, and its polynomial in the velocity."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from eccentric.model import (
    Backward,
    Bounded,
    Forward,
    Gated,
    Magnitude,
    Model,
    OpaqueStep,
    Sgn,
    SquareDifference,
    symbols,
)
from eccentric.model import vocabulary as v

_DIRECTED = Sgn | Forward | Backward | Gated


def standstill(model: Model, friction: sp.Expr, direction: int) -> sp.Expr:
    """The limit of the friction torque as the velocity tends to 0 from above (1) or below (-1)."""
    omega_m = v.omega_m.symbol
    moved = _following(model, {v.omega_m.symbol})
    defined = {d.symbol: d.value for d in model.definitions if d.symbol in moved}
    for symbol in reversed(list(defined)):
        friction = friction.xreplace({symbol: defined[symbol]})
    friction = friction.xreplace(moving(omega_m, direction)).xreplace({omega_m: sp.Integer(0)})
    # At zero speed the steps reduce to plain numbers or to their other argument.
    friction = friction.replace(
        lambda e: isinstance(e, Gated) and e.args[1].is_number, lambda e: sp.Mul(*e.args)
    )
    friction = friction.replace(lambda e: isinstance(e, Bounded) and e.args[0] == 0, lambda e: sp.Integer(0))
    friction = friction.replace(
        lambda e: isinstance(e, SquareDifference) and e.args[0] == 0, lambda e: -(e.args[1] ** 2)
    )
    friction = friction.replace(
        lambda e: isinstance(e, Magnitude) and sp.S.Zero in e.args, lambda e: sp.Abs(sp.Add(*e.args))
    )
    # By their definitions, which are those of the stable form of F_N.
    scale_N, omega_star, weight = symbols(v.scale_N, v.omega_star, v.weight)
    friction = friction.subs(scale_N * omega_star**2, weight)
    # What depends on parameters only is prepared, in double precision: there the plain root serves.
    varying = _following(model, {q.symbol for q in model.inputs})
    return friction.replace(
        lambda e: isinstance(e, Magnitude) and not e.free_symbols & varying,
        lambda e: sp.sqrt(e.args[0] ** 2 + e.args[1] ** 2),
    )


def polynomials(
    model: Model, resultant: sp.Expr, values: Iterable[sp.Expr]
) -> dict[int, tuple[sp.Expr, ...]]:
    """F_3, F_2, F_1, F_0 by direction, 1 or -1, if friction is a polynomial in the velocity, else none.

    `values` are the resultant and the definitions that it needs. If friction is symmetric, -1 gives nothing
    new and is omitted.
    """
    omega_m = v.omega_m.symbol
    if _is_curved(model, values):
        return {}
    plain = model.expand(resultant).replace(Gated, sp.Mul)
    sides = {direction: sp.expand(plain.xreplace(moving(omega_m, direction))) for direction in (1, -1)}
    if not all(side.is_polynomial(omega_m) for side in sides.values()):
        return {}
    # Poly would take a common exp(-t/tau) out of a sum and leave exp(t/tau) in it, which overflows.
    return {
        direction: tuple(side.coeff(omega_m, k) for k in (3, 2, 1, 0))
        for direction, side in sides.items()
        if direction > 0 or resultant.has(Backward)
    }


def _following(model: Model, given: set[sp.Symbol]) -> set[sp.Symbol]:
    """Symbols, and what is defined by them, also by way of other definitions."""
    found = set(given)
    for definition in model.definitions:
        if definition.value.free_symbols & found:
            found.add(definition.symbol)
    return found


def _is_curved(model: Model, values: Iterable[sp.Expr]) -> bool:
    """Whether they contain a stable step of the velocity, other than those of its direction."""
    moved = _following(model, {v.omega_m.symbol})
    steps = {step for value in values for step in value.atoms(OpaqueStep)}
    return any(step.free_symbols & moved for step in steps if not isinstance(step, _DIRECTED))


def moving(omega_m: sp.Symbol, direction: int) -> dict[sp.Expr, sp.Expr]:
    """The values of the steps by direction for velocities above (1) or below (-1) zero."""
    return {
        Sgn(omega_m): sp.Integer(direction),
        Forward(omega_m): sp.Integer(direction > 0),
        Backward(omega_m): sp.Integer(direction < 0),
    }
