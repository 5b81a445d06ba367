"""Long assignments split into parts, so that every emitted line is readable (and formatters keep it)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from itertools import count

import sympy as sp

from eccentric.emission.program.program import Assignment

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
