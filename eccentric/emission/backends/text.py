"""Spellings that back ends share: numbers, defaults, series, assignments; and programs with plain text."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable
from dataclasses import replace

import sympy as sp

from eccentric.emission.free_text import plain
from eccentric.emission.program import (
    BITS,
    COSINE,
    LEADING_BITS,
    SINE_RATIO,
    Assignment,
    Input,
    Program,
)
from eccentric.model import Leading, Quantity


def with_plain_text(program: Program) -> Program:
    """The program, with all free text as returned by `plain`."""

    def of(q: Quantity) -> Quantity:
        return replace(q, unit=plain(q.unit), meaning=plain(q.meaning), equation=plain(q.equation))

    routines = [
        replace(
            r,
            unit=plain(r.unit),
            meaning=plain(r.meaning),
            inputs=tuple(Input(of(x.quantity), x.length) for x in r.inputs),
            assignments=tuple(replace(a, note=plain(a.note)) for a in r.assignments),
        )
        for r in program.routines
    ]
    return replace(
        program,
        title=plain(program.title),
        parameters=tuple(map(of, program.parameters)),
        routines=tuple(routines),
        notes=tuple((name, plain(note)) for name, note in program.notes),
        defaults=plain(program.defaults),
        states=tuple((of(q), initial) for q, initial in program.states),
    )


def number(decimal: str) -> str:
    """A decimal with a point or an exponent, so that no language takes it for an integer."""
    return decimal if any(mark in decimal for mark in ".en") else f"{decimal}.0"


def default_text(q: Quantity) -> str:
    """The default of a parameter as the shortest decimal."""
    return repr(float(sp.Rational(q.default)))


SPLITTING = {name: f"{2 ** (BITS['double'] - bits) + 1}.0" for name, bits in LEADING_BITS.items()}
"""Veltkamp's factors of the split into leading digits, in double even if the working precision is single."""


def splitting(program: Program) -> dict[str, str] | None:
    """These factors, or None if no angle is reduced."""
    return SPLITTING if any(a.value.has(Leading) for a in program.prepare) else None


def used_series(program: Program) -> list[str]:
    """The names of the polynomials that the routines evaluate."""
    used = set().union(*(a.value.free_symbols for a in program.hot()))
    return [s.name for s in (SINE_RATIO, COSINE) if s in used]


def assigned(
    assignments: Iterable[Assignment], line: Callable[[str, sp.Expr], str], comment: Callable[[str], str]
) -> list[str]:
    """One line per assignment, its note before it."""
    lines: list[str] = []
    for a in assignments:
        lines += [*map(comment, textwrap.wrap(a.note, 100)), line(a.target.name, a.value)]
    return lines
