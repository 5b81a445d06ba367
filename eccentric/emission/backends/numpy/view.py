"""The variables of the templates of module and runtime: the Program as lines of Python, nothing symbolic."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eccentric.emission.backends.numpy.prepare import prepare
from eccentric.emission.backends.numpy.printer import KERNEL, language
from eccentric.emission.backends.python import functions, quoted
from eccentric.emission.backends.text import default_text
from eccentric.emission.program import BITS, COSINE, LEADING_BITS, SINE_RATIO, Program, polynomial
from eccentric.model import Quantity


def view(program: Program, _: str) -> dict[str, Any]:
    """All variables of the templates of the NumPy module; it contains no digest."""
    lines = prepare(program)
    return {
        "title": program.title,
        "public": [
            *sorted(name for name, _ in program.constants),
            "Parameters",
            *sorted(r.name for r in program.routines),
        ],
        "constants": [(name, quoted(values, f"{name} = ")) for name, values in program.constants],
        "defaults": program.defaults,
        "parameters": [_parameter(q) for q in program.parameters],
        "prepare": lines,
        "needs_math": any("math." in line for line in lines),
        **functions(program, KERNEL, language),
        "states": quoted([q.name for q, _ in program.states]) if program.states else "",
        "follow": _follow(program),
        "polynomials": [_polynomial(s.name) for s in (SINE_RATIO, COSINE)],
        # Veltkamp's split, in double even if the working precision is single.
        "leading": {name: f"{2 ** (BITS['double'] - bits) + 1}.0" for name, bits in LEADING_BITS.items()},
    }


def _parameter(q: Quantity) -> dict[str, str]:
    symbolic = q.default is not None and q.default.free_symbols
    note = f", {q.default} if None" if symbolic else ", needed with alpha_m" if q.default is None else ""
    equation = f", eq. {q.equation}" if q.equation else ""
    optional = q.default is None or symbolic
    return {
        "name": q.name,
        "type": "float | None" if optional else "float",
        "domain": q.domain,
        "default": "None" if optional else default_text(q),
        "unit": q.unit,
        "doc": f"{q.meaning} [{q.unit}]{equation}{note}",
    }


def _follow(program: Program) -> dict[str, Any]:
    """The pass of the hidden states along a log; nothing for a model without states."""
    if not program.states:
        return {}
    stepped = next(r for r in program.routines if r.name == "next_state")
    initial = {q.name: repr(float(value)) for q, value in program.states}
    inputs = [x.quantity.name for x in stepped.inputs if x.quantity.name not in initial]
    return {
        "inputs": inputs,
        "initial": _mapping(initial),
        "given": _mapping(dict(zip(inputs, inputs, strict=True))),
        "width": len(initial),
    }


def _mapping(items: Mapping[str, str]) -> str:
    return "{" + ", ".join(f'"{name}": {text}' for name, text in items.items()) + "}"


def _polynomial(name: str) -> dict[str, Any]:
    single, double = polynomial(name, True), polynomial(name, False)
    function = {"sine_ratio": "sin(h)/h - 1", "cosine": "cos(h)"}[name]
    return {
        "name": name,
        "rest": " + 1.0" if name == "cosine" else "",
        "single": ", ".join(single.coefficients),
        "double": double.coefficients,
        "doc": f"{function}, |h| within a quarter turn, by a minimax polynomial in h^2:"
        f" errors {single.error} and {double.error}.",
    }
