"""A back end: a record of what it writes and how."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from eccentric.emission.program import BITS, COSINE, LEADING_BITS, SINE_RATIO, Program
from eccentric.emission.templates import plain
from eccentric.model import Assignment, Input, Quantity


@dataclass(frozen=True)
class Backend:
    """A target that programs are printed for.

    Attributes:
        files: template -> file, such as "numpy/module.py" -> "{name}.py" with the program's name. A file
            without it is the same for all programs.
        view: what the templates are filled with, from a program and the digest of the code as it is spelled
            until it is known. Keys are exactly the names that the templates use; values are strings, numbers,
            truths and collections of them, ready to print: a template computes nothing.
        banner: the lines at the top of every file as a comment of the target.
        single_file: the same, where the others shall carry what is the same for all programs; empty if there
            is no such file.
    """

    files: Mapping[str, str]
    view: Callable[[Program, str], dict[str, Any]]
    banner: Callable[[Sequence[str]], str]
    single_file: Mapping[str, str] = field(default_factory=dict)

    def written(self, name: str, *, single_file: bool = False) -> dict[str, str]:
        """Template -> file of a program of that name."""
        chosen = self.single_file if single_file and self.single_file else self.files
        return {template: file.format(name=name) for template, file in chosen.items()}


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


SPLITTING = {name: f"{2 ** (BITS['double'] - bits) + 1}.0" for name, bits in LEADING_BITS.items()}
"""Veltkamp's factors of the split into leading digits, in double even if the working precision is single."""


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
