"""The variables that the templates of modules in Python have in common: lines of Python, nothing symbolic."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from eccentric.emission.backends.python.dialect import Dialect, printed
from eccentric.emission.backends.python.functions import functions, quoted
from eccentric.emission.program import Program, Routine, paired, polynomial
from eccentric.model import Assignment, Quantity


def prepare(program: Program, dialect: Dialect) -> list[str]:
    """The lines; a coefficient is an attribute of c, a parameter one of p, anything else a local name."""
    coefficients = {s.name for s in program.coefficients}
    prepared = {a.target.name for a in program.prepare}
    optional = [q for q in program.parameters if q.default is None or q.default.free_symbols]
    names = {q.name for q in optional}
    pairs = paired(program)
    doubled = {s.name for s in pairs}

    def held(name: str) -> str:
        if name in prepared:
            return f"c.{name}" if name in coefficients else name
        return name if name in names else f"p.{name}"

    def value_of(name: str) -> str:
        return f"{held(name)}.high" if name in doubled else held(name)

    plain = dialect.language(dialect.prepare, value_of, held)

    def line(a: Assignment) -> list[str]:
        is_pair = a.target in pairs
        value = dialect.pair(a.value, pairs, plain, held) if is_pair else printed(a.value, plain)
        return dialect.broken(f"{held(a.target.name)} = {value}")

    late = program.single_only if dialect.single else frozenset()
    single = [part for a in program.prepare if a.target in late for part in line(a)]
    return [
        *(part for q in optional for part in dialect.broken(_default(q, dialect))),
        *(f"c.{q.name} = {held(q.name)}" for q in program.parameters if q.name in coefficients),
        *(part for a in program.prepare if a.target not in late for part in line(a)),
        *(["if c.single:", *(f"    {part}" for part in single)] if single else []),
    ]


def losses(program: Program, dialect: Dialect) -> dict[str, Any]:
    """The lines of `_losses`, where a parameter without a value fails no condition; {} without conditions."""
    if not program.conditions:
        return {}
    used = {s for c in program.conditions for s in c.loss.free_symbols | c.inertia.free_symbols}
    optional = [
        q for q in program.parameters if q.symbol in used and (q.default is None or q.default.free_symbols)
    ]
    names = {q.name for q in optional}
    plain = dialect.language(dialect.prepare, lambda name: name if name in names else f"p.{name}")
    given = [part for q in optional for part in dialect.broken(_default(q, dialect, 'float("nan")'))]
    return {
        "given": given,
        "inertia": printed(program.conditions[0].inertia, plain),
        "unit": program.axis.unit("kg m^2"),
        "rows": [(c.parameter.name, printed(c.loss, plain)) for c in program.conditions],
    }


def _default(q: Quantity, dialect: Dialect, absent: str = "") -> str:
    plain = dialect.language(dialect.prepare, lambda name: f"p.{name}")
    missing = absent or (dialect.divisor if q.domain == "positive" else dialect.missing)
    value = missing if q.default is None else printed(q.default, plain)
    return f"{q.name} = {value} if p.{q.name} is None else p.{q.name}"


_POLYNOMIALS = {"sine_ratio": ("sin(h)/h - 1", ""), "cosine": ("cos(h)", " + 1.0")}


def banner(lines: Sequence[str]) -> str:
    """The lines as comments."""
    return "".join(f"# {line}\n" for line in lines)


def module(program: Program, dialect: Dialect) -> dict[str, Any]:
    """The common variables: names, parameters, the lines of `_prepare` and of the functions."""
    own = [r.name for r in program.routines]
    return {
        "title": program.title,
        "said": program.axis.text,
        "public": [
            *sorted([name for name, _ in program.constants] + ["STATES"] * bool(program.states)),
            "Parameters",
            *sorted(own + ["follow_states"] * bool(program.states)),
        ],
        "constants": [(name, quoted(values, f"{name} = ")) for name, values in program.constants],
        "defaults": program.defaults,
        "parameters": [_parameter(q, program) for q in program.parameters],
        "inputs": _inputs(program.routines),
        "prepare": prepare(program, dialect),
        "losses": losses(program, dialect),
        "states": quoted([q.name for q, _ in program.states]) if program.states else "",
        "decorator": dialect.decorator,
        **functions(program, dialect),
    }


def _parameter(q: Quantity, program: Program) -> dict[str, Any]:
    symbolic = q.default is not None and q.default.free_symbols
    note = f", {q.default} if None" if symbolic else _needed(q, program) if q.default is None else ""
    equation = f", eq. {q.equation}" if q.equation else ""
    optional = q.default is None or symbolic
    return {
        "name": q.name,
        "type": "float | None" if optional else "float",
        "domain": q.domain,
        "default": "None" if optional else repr(float(sp.Rational(q.default))),
        "unit": q.unit,
        "doc": f"{q.meaning} [{q.unit}]{equation}{note}",
    }


def _needed(q: Quantity, program: Program) -> str:
    """What a parameter without a value is needed for; "" where no function of the program takes it."""
    said = program.axis.text
    if q.name in program.needed_for:
        return f", needed for {program.needed_for[q.name]}"
    moving = any(q.name in routine.requires for routine in program.routines)
    return said(", needed with alpha_m") if moving else ""


def _inputs(routines: Sequence[Routine]) -> dict[str, str]:
    """Name -> meaning and unit of every input."""
    return {x.quantity.name: f"{x.quantity.meaning} [{x.quantity.unit}]" for r in routines for x in r.inputs}


def stepped(program: Program) -> list[str]:
    """The inputs of `next_state`, in order; none for a model without hidden states."""
    return [x.quantity.name for r in program.routines if r.name == "next_state" for x in r.inputs]


def series(name: str) -> dict[str, Any]:
    """A polynomial of the runtime, for both precisions."""
    single, double = polynomial(name, True), polynomial(name, False)
    function, rest = _POLYNOMIALS[name]
    return {
        "name": name,
        "rest": rest,
        "single": ", ".join(single.coefficients),
        "double": double.coefficients,
        "doc": f"{function}, |h| within a quarter turn, by a minimax polynomial in h^2:"
        f" errors {single.error} and {double.error}.",
    }
