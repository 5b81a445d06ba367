"""The variables of the templates of the JAX module: the Program as lines of Python, nothing symbolic."""

from __future__ import annotations

from typing import Any

from eccentric.emission.backends.expression import printed
from eccentric.emission.backends.jax.printer import KERNEL, PREPARE, differentiable, language, pair
from eccentric.emission.backends.python import functions, quoted
from eccentric.emission.backends.text import default_text, used_series
from eccentric.emission.program import COSINE, LEADING_BITS, SINE_RATIO, Program, paired, polynomial
from eccentric.model import Quantity

_WIDTH = 106


def view(program: Program, _: str) -> dict[str, Any]:
    """All variables of the templates of the JAX module."""
    return {
        "title": program.title,
        "public": [
            *sorted(name for name, _ in program.constants),
            *(["STATES"] if program.states else []),
            "Parameters",
            *sorted([r.name for r in program.routines] + ["follow_states"] * bool(program.states)),
        ],
        "constants": [(name, quoted(values, f"{name} = ")) for name, values in program.constants],
        "defaults": program.defaults,
        "parameters": [_parameter(q) for q in program.parameters],
        "prepare": _prepare(program),
        "leading": LEADING_BITS,
        # Each is in the derivative of the other.
        "polynomials": [_polynomial(s.name) for s in (SINE_RATIO, COSINE)] if used_series(program) else [],
        **functions(differentiable(program), KERNEL, language),
        **_states(program),
    }


def _parameter(q: Quantity) -> dict[str, str]:
    symbolic = q.default is not None and q.default.free_symbols
    note = f", {q.default} if None" if symbolic else ", needed with alpha_m" if q.default is None else ""
    equation = f", eq. {q.equation}" if q.equation else ""
    return {
        "name": q.name,
        "default": "None" if q.default is None or symbolic else default_text(q),
        "doc": f"{q.meaning} [{q.unit}]{equation}{note}",
    }


def _prepare(program: Program) -> list[str]:
    """The lines; a coefficient is an attribute of c, a parameter one of p, and all else a local name."""
    coefficients = {s.name for s in program.coefficients}
    prepared = {a.target.name for a in program.prepare}
    optional = [q for q in program.parameters if q.default is None or q.default.free_symbols]
    pairs = paired(program)

    def held(name: str) -> str:
        if name in prepared:
            return f"c.{name}" if name in coefficients else name
        return name if name in {q.name for q in optional} else f"p.{name}"

    def value_of(name: str) -> str:
        return f"{held(name)}.high" if name in {s.name for s in pairs} else held(name)

    plain, given = language(PREPARE, value_of, held), language(PREPARE, lambda name: f"p.{name}")
    lines = []
    for q in optional:
        default = "0.0" if q.default is None else printed(q.default, given)
        lines.append(f"{q.name} = {default} if p.{q.name} is None else p.{q.name}")
    lines += [f"c.{q.name} = {held(q.name)}" for q in program.parameters if q.name in coefficients]
    for a in program.prepare:
        value = pair(a.value, pairs, plain, held) if a.target in pairs else printed(a.value, plain)
        lines.append(f"{held(a.target.name)} = {value}")
    return [part for line in lines for part in _broken(line)]


def _broken(line: str) -> list[str]:
    """A choice that is too long takes a line for each of its arguments."""
    head, call, arguments = line.partition("_choose(")
    if len(line) <= _WIDTH or not call:
        return [line]
    parts, depth = [""], 0
    for c in arguments[:-1]:
        depth += (c == "(") - (c == ")")
        if c == "," and not depth:
            parts.append("")
        else:
            parts[-1] += c
    return [f"{head}{call}", *(f"    {part.strip()}," for part in parts), ")"]


def _polynomial(name: str) -> dict[str, Any]:
    single, double = polynomial(name, True), polynomial(name, False)
    return {"name": name, "single": ", ".join(single.coefficients), "double": double.coefficients}


def _states(program: Program) -> dict[str, Any]:
    """The hidden states and how they are passed to `next_state`; empty for a model without."""
    states = [q.name for q, _ in program.states]
    stepped = [x.quantity.name for r in program.routines if r.name == "next_state" for x in r.inputs]
    return {
        "states": quoted(states) if states else "",
        "initial": [repr(float(value)) for _, value in program.states],
        "stepped": [f"state[{states.index(name)}]" if name in states else name for name in stepped],
        "logged": [name for name in stepped if name not in states],
    }
