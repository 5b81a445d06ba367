"""The Program: ordered named assignments, split into parameter-only and per-sample work.

It is what emission prints. It knows nothing about friction, and inputs may be vectors.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import count

import sympy as sp

from eccentric.model import TURNING, Assignment, AxisKind, Input, OpaqueStep, Quantity, needed


# Primitive operations: the elements of lowered expressions, printed one to one by every back end.
#
# They keep their arguments unchanged; SymPy neither reorders nor simplifies them. So NumPy and C compute the
# same bits.
class Plus(OpaqueStep):
    """a + b."""


class Minus(OpaqueStep):
    """a - b."""


class Times(OpaqueStep):
    """a b."""


class Over(OpaqueStep):
    """a / b."""


class Root(OpaqueStep):
    """Square root."""


class Size(OpaqueStep):
    """Absolute value."""


class Rounded(OpaqueStep):
    """A parameter-only number in the working precision (prepare only)."""


class Low(OpaqueStep):
    """The digits of a parameter-only number beyond those of its double; 0 in exact arithmetic."""


class TurnLeft(OpaqueStep):
    """2 pi - a b, without losing digits if a b is close to 2 pi (prepare only)."""


class AtMost(OpaqueStep):
    """AtMost(a, b): the smaller of both; NaN stays."""


class Within(OpaqueStep):
    """Within(a, b): a limited to -b and b, for positive b; NaN stays."""


class InSingle(OpaqueStep):
    """InSingle(a, b): a in single precision, b in double; on a sample, b is a symbol."""


class Call(OpaqueStep):
    """A private function of the emitted code, by its name."""


class Pick(OpaqueStep):
    """Pick(a, relation, b, x, y): x where `a relation b` holds, else y; a relation is >, <, <= or ==."""


# 3/2 times the number above which all floats are integers: x + ROUNDER - ROUNDER is x, rounded to an integer.
ROUNDER = sp.Symbol("rounder")
SINE_RATIO, COSINE = sp.Symbol("sine_ratio"), sp.Symbol("cosine")
HALF = sp.Rational(1, 2)
ABOVE, BELOW, AT_MOST, EQUAL = sp.symbols("> < <= ==")  # relations of Pick


def exact(value: sp.Expr) -> sp.Expr:
    """The parameter-only value with SymPy's operations for the primitive ones; rounding is unchanged."""
    plain = {
        Low: lambda _: sp.Integer(0),
        TurnLeft: lambda a, b: 2 * sp.pi - a * b,
        Plus: lambda a, b: a + b,
        Minus: lambda a, b: a - b,
    }
    for operation, meant in plain.items():
        value = value.replace(operation, meant)
    return value


ABSENT = -(2.0**127)
"""Stands for a parameter that is not given where NaN cannot: exact in both precisions."""


@dataclass(frozen=True)
class Routine:
    """One emitted function."""

    name: str  # in NumPy and, behind the model's prefix, in C
    inputs: tuple[Input, ...]  # in order
    assignments: tuple[Assignment, ...]  # the hot path, in order of evaluation
    results: tuple[sp.Symbol, ...]  # what is returned
    labels: tuple[str, ...]  # one name per result for a vector result, () for a scalar one
    unit: str  # of the result
    meaning: str  # one line for the docstring
    # parameters without a default that are needed where the last input is not zero
    requires: tuple[str, ...] = ()
    formerly: str = ""  # the name of what it took the place of

    @property
    def last_is_optional(self) -> bool:
        """Whether the last input is 0 if it is left out: an acceleration that takes an inertia."""
        return bool(self.requires) and self.inputs[-1].quantity.unit.endswith("/s^2")


@dataclass(frozen=True)
class Helper:
    """A function of one number that routines call; its result is the last target.

    It is private to the emitted file, so that the code of the angle appears there once.
    """

    name: str
    argument: sp.Symbol
    assignments: tuple[Assignment, ...]
    meaning: str


@dataclass(frozen=True)
class Condition:
    """A parameter is valid while `loss` is less than `inertia`, expressions in parameters [kg m^2]."""

    parameter: sp.Symbol
    loss: sp.Expr
    inertia: sp.Expr


@dataclass(frozen=True)
class Program:
    """All routines of a model and the parameter-only work they share."""

    name: str  # prefix in C, module name in Python
    title: str  # one line
    parameters: tuple[Quantity, ...]  # in the order of the struct
    prepare: tuple[Assignment, ...]  # assignments in parameters only, in double precision, run once
    coefficients: tuple[sp.Symbol, ...]  # the targets of `prepare` that the routines use
    routines: tuple[Routine, ...]  # the emitted functions
    # names that the module carries, such as the columns of its regressor
    constants: tuple[tuple[str, tuple[str, ...]], ...] = ()
    # description of each coefficient: meaning and unit, or its formula
    notes: tuple[tuple[str, str], ...] = ()
    states: tuple[tuple[Quantity, sp.Expr], ...] = ()
    defaults: str = "those of the derivation"  # origin of the default parameters, in words
    cautions: tuple[str, ...] = ()  # what to know before the code is used
    helpers: tuple[Helper, ...] = ()  # private functions that the routines call
    promises: tuple[str, ...] = ()  # bounds of the rounding error, one line each
    first: str = "mechanical_friction_torque"  # the routine to begin with
    chosen: bool = False  # whether functions were chosen, and others of the model left out
    arrays: str = "with"  # where C has its array functions: "with" the others, "beside" them, or "none"
    fixed: bool = False  # whether C has the default parameters only
    axis: AxisKind = TURNING  # what moves
    # parameter -> the function of the model that it is needed for, where it has no default
    needed_for: Mapping[str, str] = field(default_factory=dict)
    # parameters without a default that nothing depends on without acceleration
    inertia: frozenset[str] = frozenset()
    conditions: tuple[Condition, ...] = ()  # what parameters have to satisfy beside the sign of each
    # names of the routines that have no single result where a condition fails
    conditioned: frozenset[str] = frozenset()

    def hot(self) -> tuple[Assignment, ...]:
        """Every assignment that is evaluated for each sample."""
        return tuple(a for part in (*self.helpers, *self.routines) for a in part.assignments)

    def held(self, *, single: bool) -> tuple[sp.Symbol, ...]:
        """The coefficients of one precision in the order of C: those for single precision only come last."""
        shared = tuple(s for s in self.coefficients if s not in self.single_only)
        return shared + tuple(s for s in self.coefficients if single and s in self.single_only)

    @cached_property
    def ungiven(self) -> frozenset[sp.Symbol]:
        """Parameters without a default, and what `prepare` makes of them."""
        found = {q.symbol for q in self.parameters if q.default is None}
        for a in self.prepare:
            if found & a.value.free_symbols:
                found.add(a.target)
        return frozenset(found)

    @cached_property
    def single_only(self) -> frozenset[sp.Symbol]:
        """Coefficients that are prepared for single precision only."""

        def prepared(choice: int) -> set[sp.Symbol]:
            def chosen(a: Assignment) -> Assignment:
                return replace(a, value=a.value.args[choice]) if isinstance(a.value, InSingle) else a

            return {
                a.target for a in needed(map(chosen, self.prepare), [chosen(a).value for a in self.hot()])
            }

        return frozenset(prepared(0) - prepared(1))


# Long assignments split into parts, so that every emitted line is readable (and formatters keep it).
_WIDTH = 86  # characters of `target = value` as SymPy spells it, each symbol a little longer in C


def shortened(assignments: Iterable[Assignment]) -> tuple[Assignment, ...]:
    """The assignments; an argument that makes a sum or product too long becomes an assignment before it."""
    out: list[Assignment] = []
    numbers = count(1)

    def add(assignment: Assignment) -> None:
        value = assignment.value
        while _length(assignment.target, value) > _WIDTH and (part := _longest_part(value)) is not None:
            symbol = sp.Symbol(f"part_{next(numbers)}", real=True)
            add(Assignment(symbol, part))
            value = value.xreplace({part: symbol})
        out.append(replace(assignment, value=value))

    for assignment in assignments:
        add(assignment)
    return tuple(out)


def without_copies(assignments: Iterable[Assignment], results: Iterable[sp.Symbol]) -> tuple[Assignment, ...]:
    """The assignments, with each value computed once and under one name; results are kept.

    Of two names the one with a note is kept.
    """
    kept: list[Assignment] = []
    names: dict[sp.Expr, sp.Symbol] = {}
    named: set[sp.Expr] = set()
    renamed: dict[sp.Expr, sp.Expr] = {}
    results = set(results)
    for a in assignments:
        value = a.value.xreplace(renamed)
        first = value if value in named else names.get(value)
        if a.target in results or first is None or (value.is_Atom and value not in named):
            kept.append(replace(a, value=value))
            if a.target not in results:
                named.add(names.setdefault(value, a.target))
        elif a.note:
            kept = [replace(k, target=a.target, note=a.note) if k.target == first else k for k in kept]
            kept = [replace(k, value=k.value.xreplace({first: a.target})) for k in kept]
            names = {v.xreplace({first: a.target}): a.target if s == first else s for v, s in names.items()}
            named = named - {first} | {a.target}
            renamed = {old: a.target if new == first else new for old, new in renamed.items()}
            renamed[first] = a.target
        else:
            renamed[a.target] = first
    return tuple(kept)


def _length(target: sp.Symbol, value: sp.Expr) -> int:
    symbols = sum(1 for e in sp.preorder_traversal(value) if e.is_Symbol)
    return len(f"{target} = {_spelled(value)}") + 3 * symbols


@cache
def _spelled(value: sp.Expr) -> str:
    """As SymPy spells it, cached: two functions of a model differ little."""
    return str(value)


def _longest_part(value: sp.Expr) -> sp.Expr | None:
    """The longest argument worth a name of its own; None if all are symbols and numbers."""
    parts = [
        a for a in value.args if not a.is_Atom and (value.is_Add or value.is_Mul or a.is_Add or a.is_Mul)
    ]
    parts = [
        a
        for a in parts
        if not (a.is_Mul and a.args[0].is_Number and len(a.args) == 2 and a.args[1].is_Symbol)
    ]
    return max(parts, key=lambda a: (len(_spelled(a)), _spelled(a)), default=None)


# Parameters beyond double precision: which prepared values are computed as pairs of doubles, and how.
#
# A pair is an unevaluated sum, high + low, with some 104 bits. Values with a low part (the critical
# velocity, the period of the motor angle) are computed this way from the parameters on: near the zero of
# F_N the leading digits of speed and angle cancel against them, and the rest depends on the digits that
# follow.
def paired(program: Program) -> frozenset[sp.Symbol]:
    """The prepared values computed as pairs.

    Those whose low part is used, what they follow from, and where F_N uses one, what it is multiplied
    by: each rounding of a product of five parameters would show in the last place of every normal force.
    """
    values = {a.target: a.value for a in program.prepare}
    waiting = {e.args[0] for value in values.values() for e in value.atoms(Low)}
    of_force = _of_normal_force(program) & set(values)
    if any(values[s].has(Low) for s in of_force):
        waiting |= {s for s in of_force if _is_product(values[s])}
    found: set[sp.Symbol] = set()
    while waiting:
        symbol = waiting.pop()
        found.add(symbol)
        exact = {s for e in values[symbol].atoms(TurnLeft) for s in e.free_symbols}
        waiting |= (values[symbol].free_symbols & set(values)) - found - exact
    return frozenset(found)


def _of_normal_force(program: Program) -> set[sp.Symbol]:
    steady = {"theta_m", "omega_m"}  # with an acceleration F_N vanishes along a curve: its bound is absolute
    routines = [
        r
        for r in program.routines
        if r.name == "normal_force" and {x.quantity.name for x in r.inputs} <= steady
    ]
    return set().union(*(a.value.free_symbols for r in routines for a in r.assignments))


def _is_product(value: sp.Expr) -> bool:
    branches = [e for e, _ in value.args] if isinstance(value, sp.Piecewise) else [value]
    return any(e.is_Mul and e.free_symbols for e in branches) and not value.has(sp.sin, sp.cos, sp.exp)
