"""One name, one value: what a routine computes on the way has no name of the model's own quantities."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from eccentric.emission.program.program import Assignment, Helper, Program, Routine
from eccentric.errors import InputError

# Arguments and local names of every emitted function in C, and modules that those in Python use.
_LOCAL = frozenset({"c", "count", "first", "k", "n", "next", "np", "out", "own", "parameters", "state"})
# Arguments and a local name of `prepare`, where parameters and what follows from them have names.
_OF_PREPARE = frozenset({"c", "invalid", "p"})
# What the object that holds the coefficients in Python has beside them.
OF_COEFFICIENTS = frozenset({"leading", "real", "rounded", "rounder", "single"})


def require_distinct(program: Program) -> None:
    """Raise InputError for a quantity that has the name of a value which the emitted code computes."""
    given = {q.name for q in (*program.parameters, *(q for q, _ in program.states))}
    inputs = {x.quantity.name for r in program.routines for x in r.inputs}
    inputs |= {q.name for q, _ in program.states}
    _require_free(program.name, (inputs & _LOCAL) | (given & OF_COEFFICIENTS))
    prepared = _targets(program.prepare)
    _require_free(program.name, {*given, *prepared} & _OF_PREPARE)
    known = given | {s.name for s in program.coefficients}
    _require_free(program.name, _repeated([*given, *prepared]))
    for part in (*program.helpers, *program.routines):
        arguments = (
            [part.argument.name] if isinstance(part, Helper) else [x.quantity.name for x in part.inputs]
        )
        results = part.results if isinstance(part, Routine) else ()
        inner = [a for a in part.assignments if a.target not in results]
        _require_free(program.name, _repeated([*arguments, *_targets(inner)]))
        _require_free(program.name, known.intersection(_targets(part.assignments)))


def _targets(assignments: Iterable[Assignment]) -> list[str]:
    return [a.target.name for a in assignments]


def _repeated(names: Iterable[str]) -> set[str]:
    return {name for name, count in Counter(names).items() if count > 1}


def _require_free(model: str, taken: set[str]) -> None:
    if taken:
        raise InputError(
            f"model {model}: a quantity with a name that the emitted code does not use for a value of its"
            f" own is required, received {min(taken)!r}: rename it"
        )
