"""A program under the names of its axis: what is printed of a carriage has positions, masses and forces."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

import sympy as sp

from eccentric.emission.program.program import Assignment, Helper, Input, Program, Routine
from eccentric.model import TURNING, AxisKind, spoken_quantity, spoken_symbol

__all__ = ["spoken_program"]


def spoken_program(program: Program, axis: AxisKind) -> Program:
    """The same operations in the same order, with the letters, units and words of an axis."""
    if axis is TURNING:
        return program

    longest = sorted(axis.letters, key=len, reverse=True)
    letters = re.compile(rf"(?<![A-Za-z0-9])({'|'.join(longest)})(?![A-Za-z0-9])")

    def local(symbol: sp.Symbol) -> sp.Symbol:
        """A letter of the model, or a name made of some, such as C_m_per_k_i."""
        if symbol.name in axis.letters:
            return spoken_symbol(axis, symbol)
        name = letters.sub(lambda found: axis.letters[found[0]], symbol.name)
        return sp.Symbol(name, **symbol.assumptions0)

    def put(value: sp.Expr) -> sp.Expr:
        return value.xreplace({s: local(s) for s in value.free_symbols})

    def steps(assignments: Iterable[Assignment]) -> tuple[Assignment, ...]:
        return tuple(Assignment(local(a.target), put(a.value), axis.said(a.note)) for a in assignments)

    def routine(r: Routine) -> Routine:
        return replace(
            r,
            inputs=tuple(Input(spoken_quantity(axis, x.quantity), x.length) for x in r.inputs),
            assignments=steps(r.assignments),
            results=tuple(map(local, r.results)),
            labels=tuple(map(axis.said, r.labels)),
            requires=tuple(map(axis.said, r.requires)),
        )

    def helper(h: Helper) -> Helper:
        return replace(
            h, argument=local(h.argument), assignments=steps(h.assignments), meaning=axis.said(h.meaning)
        )

    return replace(
        program,
        title=axis.said(program.title),
        parameters=tuple(spoken_quantity(axis, q) for q in program.parameters),
        prepare=steps(program.prepare),
        coefficients=tuple(map(local, program.coefficients)),
        routines=tuple(map(routine, program.routines)),
        constants=tuple((name, tuple(map(axis.said, labels))) for name, labels in program.constants),
        notes=axis.told(program.notes),
        states=tuple((spoken_quantity(axis, q), put(initial)) for q, initial in program.states),
        defaults=axis.said(program.defaults),
        helpers=tuple(map(helper, program.helpers)),
        promises=tuple(map(axis.said, program.promises)),
        axis=axis,
    )
