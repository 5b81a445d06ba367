"""A routine in stages: the angle, what follows from it, the rest.

Every operation on a sample waits for the one before it, some 150 cycles in all, and a processor's look-ahead
is limited. In stages of a third of the length, on a block of samples, it processes several at once.
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
        rest: the remaining part.
        inputs: those that the rest uses.
    """

    angles: tuple[Assignment, ...]
    bent: tuple[Assignment, ...]
    rest: tuple[Assignment, ...]
    inputs: tuple[Input, ...]


def staged(routine: Routine) -> Staged:
    """The routine in stages; the first two are empty if it takes no angle directly from its inputs."""
    given = {s for x in routine.inputs if x.length is None for s in x.symbols}
    angles = tuple(a for a in routine.assignments if _calls(a, given))
    bent = tuple(a for a in routine.assignments if _calls(a, {a.target for a in angles}))
    rest = tuple(a for a in routine.assignments if a not in (*angles, *bent))
    used = set().union(*(a.value.free_symbols for a in rest))
    # A vector stays, whichever of its elements are used.
    inputs = (x for x in routine.inputs if x.length is not None or used & set(x.symbols))
    return Staged(angles, bent, rest, tuple(inputs))


def _calls(assignment: Assignment, arguments: set[sp.Symbol]) -> bool:
    return isinstance(assignment.value, Call) and assignment.value.args[1] in arguments
