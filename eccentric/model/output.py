"""Outputs: the functions that a model declares, with their inputs, unit, meaning and expression.

An output is a few results and, before them, assignments in order. They are differentiated one by one, never
as one expanded expression, so that a chain of n joints needs no other code than one joint.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache

import sympy as sp

from eccentric.model.quantity import Quantity
from eccentric.model.steps import Sgn


@dataclass(frozen=True)
class Input:
    """An input of an output: one number, or a vector of `length` numbers.

    A vector's elements are the symbols name_0, name_1, ...; in NumPy they are the last axis, in C a pointer.
    """

    quantity: Quantity
    length: int | None = None

    @property
    def symbols(self) -> tuple[sp.Symbol, ...]:
        """The symbols that expressions use for it."""
        if self.length is None:
            return (self.quantity.symbol,)
        return tuple(sp.Symbol(f"{self.quantity.name}_{k}", real=True) for k in range(self.length))


@dataclass(frozen=True)
class Assignment:
    """`target = value`; `note` is a comment, if the name is not enough."""

    target: sp.Symbol
    value: sp.Expr
    note: str = ""


@dataclass(frozen=True)
class Expressions:
    """What an output computes.

    Attributes:
        results: label -> expression; the label is "" for a scalar.
        definitions: what the results are computed from, in order; it may contain more than they need.
        by: symbols by which the one entry of `results` is differentiated; the output is those slopes, after
            the entry itself if that has a label.
        factors: of these, and of signs, a sum is collected into few products; without any it stays as it is.
        constants: further constants of a module, by name, such as what the columns are the sums of.
    """

    results: tuple[tuple[str, sp.Expr], ...]
    definitions: tuple[Assignment, ...] = ()
    by: tuple[sp.Symbol, ...] = ()
    factors: tuple[sp.Symbol, ...] = ()
    constants: tuple[tuple[str, tuple[str, ...]], ...] = ()


@dataclass(frozen=True)
class Output:
    """A function of a model.

    Attributes:
        name: in NumPy and, behind the model's prefix, in C.
        unit: of the results.
        meaning: one line.
        inputs: those that it may depend on, in the order of its arguments.
        expressions: makes what it computes; called only if the output is wanted.
        taken: names of inputs that it has even where it does not depend on them.
        requires: parameters without a default that are needed where the last input is not zero.
        needs: parameters that nothing but electricity depends on: needed for this output, where they have no
            default.
        without_time: result -> its value where no time passes; the others hold for a time step of any size.
        advances: whether its results are hidden states one time step later: it is there with any other.
        on_request: whether it is there only if it is asked for by name.
        formerly: the name of what it took the place of: whoever calls that is told this one.
    """

    name: str
    unit: str
    meaning: str
    inputs: tuple[Input, ...]
    expressions: Callable[[], Expressions]
    taken: frozenset[str] = frozenset()
    requires: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    without_time: Mapping[str, sp.Expr] = field(default_factory=dict)
    advances: bool = False
    on_request: bool = False
    formerly: str = ""


@dataclass(frozen=True)
class Interface:
    """All outputs of a model, in the order of a module.

    Attributes:
        outputs: the functions.
        first: the one to begin with.
        constants: constant of a module -> the output whose labels it lists.
    """

    outputs: tuple[Output, ...]
    first: str
    constants: Mapping[str, str] = field(default_factory=dict)


def differentiate(
    assignments: Iterable[Assignment], by: Sequence[sp.Symbol]
) -> tuple[tuple[Assignment, ...], Mapping[tuple[sp.Symbol, sp.Symbol], sp.Symbol]]:
    """The assignments, each followed by its derivatives by the symbols in `by` where they are not zero.

    Returned with them: (target, x) -> the symbol of that derivative, named target_d_x. Each value is
    differentiated by the symbols it contains, and the chain rule is carried from one assignment to the next
    (forward mode).
    """
    known: dict[tuple[sp.Symbol, sp.Symbol], sp.Expr] = {(x, x): sp.Integer(1) for x in by}
    slopes: dict[tuple[sp.Symbol, sp.Symbol], sp.Symbol] = {}
    out: list[Assignment] = []
    for assignment in assignments:
        out.append(assignment)
        for x in by:
            inner = [s for s in sorted(assignment.value.free_symbols, key=str) if (s, x) in known]
            slope = sp.Add(*(_partial(assignment.value, s) * known[s, x] for s in inner))
            if slope != 0:
                target = sp.Symbol(f"{assignment.target.name}_d_{x.name}", real=True)
                out.append(Assignment(target, slope))
                known[assignment.target, x] = slopes[assignment.target, x] = target
    return tuple(out), slopes


def needed(assignments: Iterable[Assignment], results: Iterable[sp.Expr]) -> tuple[Assignment, ...]:
    """The assignments that the results depend on, in order."""
    wanted = set().union(*(expression.free_symbols for expression in results))
    kept: list[Assignment] = []
    for assignment in reversed(list(assignments)):
        if assignment.target in wanted:
            wanted |= assignment.value.free_symbols
            kept.append(assignment)
    return tuple(reversed(kept))


@cache
def _partial(value: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    return value.diff(symbol).replace(sp.sign, Sgn)
