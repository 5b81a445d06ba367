"""What the balances of an arm's joints say of the torque of their motors: friction, and what effects add."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from eccentric.model import Model, Recursion, Term

__all__ = ["besides", "columns", "frictions", "resultants", "words_of_motor_torque"]


def _terms(model: Model, j: int) -> list[Term]:
    return [term for term in model.balance(f"mechanical_{j}").terms if term.kind == "friction"]


def columns(model: Model, j: int) -> list[tuple[str, sp.Expr]]:
    """Coefficient and basis of the friction of a joint, each coefficient once."""
    columns: dict[str, sp.Expr] = {}
    for term in _terms(model, j):
        name = str(term.coefficient)
        columns[name] = columns.get(name, sp.Integer(0)) + term.basis
    return list(columns.items())


def frictions(model: Model, found: Recursion) -> list[tuple[str, sp.Expr]]:
    """Each load is multiplied once, by what follows it; effects may contain a load in other ways."""
    results = []
    for j, bearing in enumerate(found.bearings):
        loads = [load for load in bearing.loads.values() if load.is_Symbol]
        factors: dict[sp.Expr, list[sp.Expr]] = {}
        for term in _terms(model, j):
            rest, own = term.value.as_independent(*loads, as_Add=False)
            load, factor = (own, rest) if own in loads else (sp.Integer(1), term.value)
            factors.setdefault(load, []).append(factor)
        results.append((f"f_{j}", sp.Add(*(load * sp.Add(*parts) for load, parts in factors.items()))))
    return results


def besides(model: Model, j: int, torque: sp.Expr) -> sp.Expr:
    """What the effects of a joint ask of its motor besides friction, at this torque of all else.

    A term of the current is taken at the current without it, as for one joint: exact to first order in it.
    """
    mechanical = model.balance(f"mechanical_{j}")
    drive = next(term for term in mechanical.terms if term.kind == "drive")
    conservative = mechanical.sum_of("conservative")
    current = (torque + conservative) / drive.coefficient
    return conservative + mechanical.sum_of("actuator").subs(drive.basis, current)


def words_of_motor_torque(model: Model) -> str:
    """What `motor_torque` adds up."""
    kinds = {t.kind for b in model.balances if b.unit == "N m" for t in b.terms}
    parts = "inverse_dynamics and mechanical_friction_torque"
    if not kinds.isdisjoint({"conservative", "actuator"}):
        parts += ", and the effects that are no friction"
    return f"torque of every motor that the motion takes: {parts}"


def resultants(model: Model, friction: Sequence[tuple[str, sp.Expr]]) -> list[tuple[str, sp.Expr]]:
    """Eq (4): the back-EMF damps by k_i k_e/R omega_m."""
    results = []
    for j, (_, f) in enumerate(friction):
        electrical = model.balance(f"electrical_{j}")
        resistance = next(t.coefficient for t in electrical.terms if t.kind == "resistive")
        drive = next(t for t in model.balance(f"mechanical_{j}").terms if t.kind == "drive")
        results.append((f"F_{j}", f + drive.coefficient / resistance * electrical.sum_of("back_emf")))
    return results
