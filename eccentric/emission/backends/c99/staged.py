"""A routine in stages: the angle, what follows from it, the rest.

Every operation on a sample waits for the one before it, some 150 cycles in all, and a processor looks ahead
only so far. In stages of a third of the length, a block of samples at a time, it works on several at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from eccentric.emission.program import Assignment, Call, Input, Routine


@dataclass(frozen=True)
class Staged:
    """The parts of a routine.

    Attributes:
        angles: calls of helpers with an input.
        bent: calls of helpers with one of `angles`.
        rest: what is left.
        inputs: those that the rest takes.
    """

    angles: tuple[Assignment, ...]
    bent: tuple[Assignment, ...]
    rest: tuple[Assignment, ...]
    inputs: tuple[Input, ...]


def staged(routine: Routine) -> Staged:
    """The routine in stages; the first two are empty where it takes no angle straight from its inputs."""
    given = {s for x in routine.inputs if x.length is None for s in x.symbols}
    angles = tuple(a for a in routine.assignments if _calls(a, given))
    bent = tuple(a for a in routine.assignments if _calls(a, {a.target for a in angles}))
    rest = tuple(a for a in routine.assignments if a not in (*angles, *bent))
    used = set().union(*(a.value.free_symbols for a in rest))
    return Staged(angles, bent, rest, tuple(x for x in routine.inputs if used & set(x.symbols)))


def _calls(assignment: Assignment, arguments: set[sp.Symbol]) -> bool:
    return isinstance(assignment.value, Call) and assignment.value.args[1] in arguments
