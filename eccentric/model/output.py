"""Outputs: the functions that a model declares, with their inputs, unit, meaning and expressions.

An output is a sequence of assignments followed by results. They are differentiated one by one, never as one
expanded expression, so that the same code serves one joint and a chain of n joints.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Self

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
    """`target = value`; `note` is an optional comment."""

    target: sp.Symbol
    value: sp.Expr
    note: str = ""


@dataclass(frozen=True)
class Expressions:
    """The expressions of an output.

    Attributes:
        results: label -> expression; the label is "" for a scalar.
        definitions: intermediate assignments, in order; possibly more than the results need.
        by: symbols by which the single entry of `results` is differentiated; the output then consists of
            these derivatives, preceded by the entry itself if it has a label.
        factors: symbols, besides signs, by which sums are collected; none for no collection.
        constants: further constants of a module, by name, such as the sums that the columns represent.
    """

    results: tuple[tuple[str, sp.Expr], ...]
    definitions: tuple[Assignment, ...] = ()
    by: tuple[sp.Symbol, ...] = ()
    factors: tuple[sp.Symbol, ...] = ()
    constants: tuple[tuple[str, tuple[str, ...]], ...] = ()

    def __call__(self) -> Self:
        """Themselves, for an output whose expressions are there already."""
        return self


@dataclass(frozen=True)
class Output:
    """A function of a model.

    Attributes:
        name: in NumPy and, behind the model's prefix, in C.
        unit: of the results.
        meaning: one line.
        inputs: those that it may depend on, in the order of its arguments.
        expressions: creates its expressions; called only if the output is requested.
        taken: names of inputs that are arguments even if it does not depend on them.
        requires: parameters without a default that are needed if the last input is not zero.
        needs: purely electrical parameters that this output needs if they have no default.
        without_time: result -> its value at a time step of zero; other results do not depend on it.
        advances: whether its results are the hidden states one time step later; always emitted with others.
        on_request: whether it is emitted only if requested by name.
        formerly: the name of the function it replaced: callers of that are referred to this one.
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
        first: the one to start with.
        constants: constant of a module -> the output whose labels it lists.
    """

    outputs: tuple[Output, ...]
    first: str
    constants: Mapping[str, str] = field(default_factory=dict)


def differentiate(
    assignments: Iterable[Assignment], by: Sequence[sp.Symbol]
) -> tuple[tuple[Assignment, ...], Mapping[tuple[sp.Symbol, sp.Symbol], sp.Symbol]]:
    """The assignments, each followed by its nonzero derivatives by the symbols in `by`.

    Also returns (target, x) -> the symbol of that derivative, named target_d_x. Forward mode: each value is
    differentiated by the symbols it contains, and the chain rule applied from one assignment to the next.
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
    used: list[Assignment] = []
    for assignment in reversed(list(assignments)):
        if assignment.target in wanted:
            wanted |= assignment.value.free_symbols
            used.append(assignment)
    return tuple(reversed(used))


@cache
def _partial(value: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    return value.diff(symbol).replace(sp.sign, Sgn)
