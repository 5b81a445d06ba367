"""The variables of `templates/compiled/`: C that makes the functions of a program callable from Python."""

from __future__ import annotations

from typing import Any

from eccentric.emission import Program, Routine


def view(program: Program) -> dict[str, Any]:
    """All variables of the template."""
    functions = [_function(routine) for routine in program.routines]
    return {
        "name": program.name,
        "functions": functions,
        "most_inputs": max(len(f["inputs"]) for f in functions),
    }


def length_of(r: Routine) -> int:
    """The number of entries of every input, 0 where they are numbers."""
    return next((x.length or 0 for x in r.inputs), 0)


def _function(r: Routine) -> dict[str, Any]:
    return {
        "name": r.name,
        "inputs": [x.quantity.name for x in r.inputs],
        "width": len(r.labels),
        "length": length_of(r),
        "inertia": int(bool(r.requires)),
        "optional": int(r.last_is_optional),
        "plain": bool(r.inputs) and not r.labels and not r.requires and not length_of(r),
    }
