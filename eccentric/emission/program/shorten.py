"""Long assignments split into parts, so that every emitted line is readable (and formatters keep it)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from itertools import count

import sympy as sp

from eccentric.emission.program.program import Low, Program, TurnLeft
from eccentric.model import Assignment

_WIDTH = 86  # characters of `target = value` as SymPy spells it, each symbol a little longer in C


def shortened(assignments: Iterable[Assignment]) -> tuple[Assignment, ...]:
    """The assignments; an argument that makes a sum or product too long becomes an assignment before it."""
    out: list[Assignment] = []
    numbers = count(1)

    def add(assignment: Assignment) -> None:
        value = assignment.value
        while _length(assignment.target, value) > _WIDTH and (part := _longest_part(value)) is not None:
            symbol = sp.Symbol(f"part_{next(numbers)}", real=True)
            add(Assignment(symbol, part))
            value = value.xreplace({part: symbol})
        out.append(replace(assignment, value=value))

    for assignment in assignments:
        add(assignment)
    return tuple(out)


def without_copies(assignments: Iterable[Assignment], results: Iterable[sp.Symbol]) -> tuple[Assignment, ...]:
    """The assignments, with each value computed once and under one name; results are kept.

    Of two names the one with a note is kept.
    """
    kept: list[Assignment] = []
    names: dict[sp.Expr, sp.Symbol] = {}
    named: set[sp.Expr] = set()
    renamed: dict[sp.Expr, sp.Expr] = {}
    results = set(results)
    for a in assignments:
        value = a.value.xreplace(renamed)
        first = value if value in named else names.get(value)
        if a.target in results or first is None or (value.is_Atom and value not in named):
            kept.append(replace(a, value=value))
            if a.target not in results:
                named.add(names.setdefault(value, a.target))
        elif a.note:
            kept = [replace(k, target=a.target, note=a.note) if k.target == first else k for k in kept]
            kept = [replace(k, value=k.value.xreplace({first: a.target})) for k in kept]
            names = {v.xreplace({first: a.target}): a.target if s == first else s for v, s in names.items()}
            named = named - {first} | {a.target}
            renamed = {old: a.target if new == first else new for old, new in renamed.items()}
            renamed[first] = a.target
        else:
            renamed[a.target] = first
    return tuple(kept)


def _length(target: sp.Symbol, value: sp.Expr) -> int:
    symbols = sum(1 for e in sp.preorder_traversal(value) if e.is_Symbol)
    return len(f"{target} = {_spelled(value)}") + 3 * symbols


@cache
def _spelled(value: sp.Expr) -> str:
    """As SymPy spells it, cached: two functions of a model differ little."""
    return str(value)


def _longest_part(value: sp.Expr) -> sp.Expr | None:
    """The longest argument worth a name of its own; None if all are symbols and numbers."""
    parts = [
        a for a in value.args if not a.is_Atom and (value.is_Add or value.is_Mul or a.is_Add or a.is_Mul)
    ]
    parts = [
        a
        for a in parts
        if not (a.is_Mul and a.args[0].is_Number and len(a.args) == 2 and a.args[1].is_Symbol)
    ]
    return max(parts, key=lambda a: (len(_spelled(a)), _spelled(a)), default=None)


# Parameters beyond double precision: which prepared values are computed as pairs of doubles, and how.
#
# A pair is an unevaluated sum, high + low, with some 104 bits. Values with a low part (the critical
# velocity, the period of the motor angle) are computed this way from the parameters on: near the zero of
# F_N the leading digits of speed and angle cancel against them, and the rest depends on the digits that
# follow.


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
