"""Routines of a program as functions of Warp, in double precision: lines of Python, for the templates.

The coefficients are those that the emitted NumPy module prepares, in an array; a function takes it first.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import sympy as sp

from eccentric.emission import Call, InSingle, Language, build_program, printed
from eccentric.model import Assignment, Model, needed

_CALLS = {
    "sqrt": "wp.sqrt({0})",
    "fabs": "wp.abs({0})",
    "exp": "wp.exp({0})",
    "sgn": "_sign({0})",
    "forward": "_forward({0})",
    "backward": "_forward(-({0}))",
    "at_most": "wp.min({0}, {1})",
    "within": "wp.clamp({0}, -{1}, {1})",
    "in_single": "{1}",
    "sine_ratio": "_sine_ratio({0})",
    "cosine": "wp.cos({0})",
    "sin": "wp.sin({0})",
    "cos": "wp.cos({0})",
}
_ROUNDER = "real(6755399441055744.0)"
_WHERE = "wp.where({0}, {1}, {2})"


def functions(model: Model, name: str) -> dict[str, Any]:
    """Names of the coefficients, and the functions that one routine of the model takes, itself last.

    Raises:
        InputError: an operation that Warp lacks.
    """
    # The whole program: its coefficients are those of the whole NumPy module.
    program = build_program(model)
    routine = next(r for r in program.routines if r.name == name)
    by_name = {helper.name: helper for helper in program.helpers}
    used = _helpers(routine.assignments, by_name)
    helpers = [helper for helper in program.helpers if helper.name in used]
    parts = [_in_double(x.assignments, [x.assignments[-1].target]) for x in helpers]
    parts.append(_in_double(routine.assignments, routine.results))
    read = set[sp.Symbol]().union(*(a.value.free_symbols for part in parts for a in part))
    read |= set(routine.results)
    coefficients = [s.name for s in program.coefficients if s in read]
    places = {x: f"c[{k}]" for k, x in enumerate(coefficients)} | {"rounder": _ROUNDER}
    language = Language(
        symbol=lambda symbol: places.get(symbol, symbol),
        low=str,
        number=lambda decimal: f"real({decimal})",
        calls=_CALLS | {helper: f"_{helper}(c, {{0}})" for helper in used},
        pick=_WHERE,
        choice=_WHERE,
    )
    listed = [
        _function(f"_{x.name}", [x.argument.name], part, [str(x.assignments[-1].target)], language)
        for x, part in zip(helpers, parts, strict=False)
    ]
    results = [places.get(str(x), str(x)) for x in routine.results]
    listed.append(_function(name, [x.quantity.name for x in routine.inputs], parts[-1], results, language))
    inputs = [x.quantity.name for x in routine.inputs]
    return {"coefficients": coefficients, "functions": listed, "inputs": inputs}


def _function(
    name: str, inputs: list[str], assignments: Iterable[Assignment], results: list[str], language: Language
) -> dict[str, Any]:
    lines = [f"{a.target.name} = {printed(a.value, language)}" for a in assignments]
    return {
        "name": name,
        "arguments": ", ".join(f"{x}: real" for x in inputs),
        "lines": [*lines, f"return {', '.join(results)}"],
    }


def _in_double(assignments: Iterable[Assignment], results: Iterable[sp.Symbol]) -> tuple[Assignment, ...]:
    """The assignments without what is needed for single precision only."""
    double = [Assignment(a.target, a.value.replace(InSingle, lambda _, b: b), a.note) for a in assignments]
    return needed(double, results)


def _helpers(assignments: Iterable[Assignment], known: dict[str, Any]) -> set[str]:
    """The helpers that assignments call, also by way of others."""
    found = {str(call.args[0]) for a in assignments for call in a.value.atoms(Call)} & known.keys()
    return found.union(*(_helpers(known[x].assignments, known) for x in found))
