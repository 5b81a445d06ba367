"""Evaluation of expressions: smooth signals of one log, and expressions compiled for them.

Definitions of the base model are signals as well, computed once. Other definitions are expanded, numerically
stable steps are replaced by their plain formulas, and the rest is compiled to NumPy.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from importlib import import_module
from typing import Any

import numpy as np
import sympy as sp
from sympy.printing.numpy import NumPyPrinter

from eccentric.estimation import Coefficient
from eccentric.fitting.limits import MOST_SHARED_BYTES
from eccentric.model import Column, Model, meaning, regressor
from eccentric.model import vocabulary as v

__all__ = [
    "Signals",
    "base_coefficients",
    "base_columns",
    "compiled",
    "evaluated",
    "lambdified",
    "load_torque",
    "seen_columns",
]

Array = np.ndarray
_part_symbols: dict[sp.Basic, sp.Symbol] = {}


@dataclass(frozen=True)
class Signals:
    """The smooth signals of one log that expressions are evaluated on, all of shape (samples,), in SI units.

    Attributes:
        values: input name -> signal: theta_m, omega_m, alpha_m, t, and if available i, u, temperature.
        dt: step to the next sample [s].
        starts: index of the first sample of each run; hidden states restart there.
        known: value of every parameter that is not a friction coefficient.
        open: what the rig leaves open, coefficient -> column of torque [N m]; part of every base.
        friction: positions of the columns of the regressor that are not identically zero.
        base: the model whose definitions are signals.
        by_row: parameters that differ along the log, where runs carry more mass: name -> (samples,), in place
            of those in `known`.
        bridged: of the starts, those of a window of a long log, with the steps since the sample before; what
            warms up goes on from there.
    """

    values: Mapping[str, Array]
    dt: Array
    starts: tuple[int, ...]
    known: Mapping[str, float]
    open: Mapping[Coefficient, Array] = field(default_factory=dict)
    friction: tuple[int, ...] | None = None
    base: Model | None = None
    bridged: Mapping[int, int] = field(default_factory=dict)
    by_row: Mapping[str, Array] = field(default_factory=dict)

    def columns(self, model: Model) -> tuple[Column, ...]:
        """The friction columns of a model that the log can show."""
        every = regressor(model)
        return every if self.friction is None else tuple(every[k] for k in self.friction)

    @property
    def size(self) -> int:
        """Number of samples."""
        return len(self.dt)

    @cached_property
    def defined(self) -> dict[sp.Symbol, tuple[sp.Expr, Array]]:
        """The definitions of the base model that the log determines: symbol -> (its formula, its values).

        A definition with the name of something else that expressions use is omitted, and so expanded.
        """
        found: dict[sp.Symbol, tuple[sp.Expr, Array]] = {}
        given = {**self.known, **self.by_row, **self.values}
        others = {*given, "dt"}
        for definition in () if self.base is None else self.base.definitions:
            function, arguments = _function_of(meaning(definition.value))
            if definition.quantity.name not in others and given.keys() >= set(arguments):
                with np.errstate(all="ignore"):
                    values = np.asarray(function(*(given[a] for a in arguments)), float)
                found[definition.symbol] = definition.value, values
                given[definition.quantity.name] = values
        return found

    @cached_property
    def _kept(self) -> dict[sp.Basic, Array]:
        return {}

    @cached_property
    def _own(self) -> dict[str, Any]:
        defined = {symbol.name: values for symbol, (_, values) in self.defined.items()}
        return {**self.known, **self.by_row, **defined, **self.values, "dt": self.dt}

    def part(self, whole: sp.Symbol | None) -> Array | float:
        """The declared part of a quantity along the log (samples,): the rest is what some runs carry.

        1 where there is nothing to have a part of.
        """
        if whole is None or not self.by_row or self.base is None:
            return 1.0
        value = self.base.expand(whole)
        own = np.full(self.size, float(evaluated(value, self.known)))
        all_of_it = np.broadcast_to(evaluated(value, {**self.known, **self.by_row}), (self.size,))
        return np.divide(own, all_of_it, out=np.ones(self.size), where=all_of_it != 0.0)

    def given(self, shape: Mapping[str, Array | float], series: Mapping[str, Array]) -> dict[str, Any]:
        """Everything that an expression may use, by name."""
        return {**self._own, **series, **shape}

    def shared_parts(self, expression: sp.Expr, names: Collection[str]) -> set[sp.Basic]:
        """The largest functions in an expression, such as a cosine, that need neither shapes nor states."""
        fixed = self._own.keys() - names
        found: set[sp.Basic] = set()
        left: list[sp.Basic] = [expression]
        while left:
            part = left.pop()
            if isinstance(part, sp.Function) and fixed >= {s.name for s in part.free_symbols}:
                found.add(part)
            else:
                left += part.args
        return found

    def values_of(self, part: sp.Basic) -> Array:
        """A part that several expressions share (samples,), computed once as long as memory is small."""
        if part not in self._kept:
            function, arguments = _function_of(part)
            values = np.asarray(function(*(self._own[a] for a in arguments)), float)
            if len(self._kept) * values.nbytes > MOST_SHARED_BYTES:
                return values
            self._kept[part] = values
        return self._kept[part]

    def expanded(self, model: Model, expression: sp.Expr, names: Collection[str]) -> sp.Expr:
        """The expression in signals, states and shapes of these names, with plain formulas for steps."""
        put_in: dict[sp.Symbol, sp.Expr] = {}
        for definition in model.definitions:
            symbol, value = definition.symbol, definition.value
            used = value.free_symbols
            own = not used.isdisjoint(put_in) or any(s.name in names for s in used)
            if own or symbol not in self.defined or self.defined[symbol][0] != value:
                put_in[symbol] = value
        return _in_full(expression, tuple(put_in.items()))


def base_coefficients(model: Model, signals: Signals) -> tuple[Coefficient, ...]:
    """The coefficients of `base_columns`, with their bounds; friction by the parameters of the model."""
    friction = (
        Coefficient.within(c.parameter.name, "friction", c.parameter.unit, c.bounds)
        for c in signals.columns(model)
    )
    return (*friction, *signals.open)


def base_columns(model: Model, signals: Signals) -> Array:
    """The regressor of the model and the columns that the rig leaves open, (samples, columns)."""
    columns = [compiled(model, column.basis, signals, ()) for column in signals.columns(model)]
    return np.column_stack([*(column({}, {}) for column in columns), *signals.open.values()])


def load_torque(model: Model, signals: Signals) -> Array:
    """What the model requires of the drive besides friction, at the motor (samples,) [N m]."""
    load = model.balance("mechanical").sum_of("inertial", "bodies", "gravity", "conservative")
    return compiled(model, load, signals)({}, {})


def compiled(
    model: Model, expression: sp.Expr, signals: Signals, names: tuple[str, ...] = ()
) -> Callable[[Mapping[str, float], Mapping[str, Array]], Array]:
    """An expression as a function of shape values and state series, over all samples."""
    plain = signals.expanded(model, expression, names)
    shared = {part: _part_symbol(part) for part in signals.shared_parts(plain, names)}
    function, arguments = _function_of(plain.xreplace(shared))
    waves = {symbol.name: part for part, symbol in shared.items()}
    parts = {q.name: signals.part(q.part_of) for q in model.parameters if q.name in names and signals.by_row}

    def evaluate(shape: Mapping[str, float], series: Mapping[str, Array]) -> Array:
        given = signals.given({name: x * parts.get(name, 1.0) for name, x in shape.items()}, series)
        with np.errstate(all="ignore"):
            values = (signals.values_of(waves[a]) if a in waves else given[a] for a in arguments)
            return np.broadcast_to(np.asarray(function(*values), float), (signals.size,))

    return evaluate


def lambdified(
    model: Model, expression: sp.Expr, signals: Signals, names: tuple[str, ...]
) -> tuple[Callable[..., Any], tuple[str, ...]]:
    """An expression as a NumPy function, and the names of its arguments; `names` are those of shapes."""
    return _function_of(signals.expanded(model, expression, names))


def evaluated(expression: sp.Expr, given: Mapping[str, Any]) -> Any:
    """An expression at values or arrays (n,) of its inputs and parameters, by name.

    Raises KeyError if one is missing.
    """
    function, arguments = _function_of(meaning(expression))
    return function(*(given[name] for name in arguments))


def seen_columns(model: Model, known: Mapping[str, float]) -> tuple[int, ...]:
    """Columns of the regressor that are not identically zero: in C1 without a mass, those of F_N are."""
    absent = {symbol: 0 for symbol in (v.M.symbol, v.L.symbol) if known.get(symbol.name) == 0.0}
    return tuple(
        k
        for k, column in enumerate(regressor(model))
        if not absent or meaning(model.expand(column.basis)).subs(absent) != 0
    )


def alike(columns: Sequence[Column]) -> list[tuple[int, ...]]:
    """The columns of the linear model, grouped: those of one role and joint are one for each direction."""
    groups: dict[tuple[object, int], list[int]] = {}
    for k, column in enumerate(columns):
        if column.linear:
            groups.setdefault((column.role, column.joint), []).append(k)
    return [tuple(group) for group in groups.values()]


# Both caches hold as many as all effects of the library have on a few models.
@lru_cache(maxsize=2000)
def _in_full(expression: sp.Expr, definitions: tuple[tuple[sp.Symbol, sp.Expr], ...]) -> sp.Expr:
    """An expression with these definitions put in, each in those after it, and plain formulas for steps."""
    values, needed, left = dict(definitions), set[sp.Basic](), [expression]
    while left:
        new = left.pop().free_symbols & values.keys() - needed
        needed |= new
        left += [values[symbol] for symbol in new]
    put_in: dict[sp.Symbol, sp.Expr] = {}
    for symbol, value in definitions:
        if symbol in needed:
            put_in[symbol] = value.xreplace(put_in)
    return meaning(expression.xreplace(put_in))


@lru_cache(maxsize=2000)
def _function_of(expression: sp.Expr) -> tuple[Callable[..., Any], tuple[str, ...]]:
    """An expression as a function of its symbols, and their names; compiled once per process."""
    names = tuple(sorted(s.name for s in expression.free_symbols))
    printer = _SharedPartsPrinter(expression)
    source = printer.function("evaluate", names)
    namespace: dict[str, Any] = {module: import_module(module) for module in printer.module_imports}
    exec(source, namespace)  # noqa: S102
    return namespace["evaluate"], names


def _part_symbol(part: sp.Basic) -> sp.Symbol:
    """The symbol that stands for a shared part; the same for the same part, so that code is compiled once."""
    return _part_symbols.setdefault(part, sp.Symbol(f"part_{len(_part_symbols)}"))


class _SharedPartsPrinter(NumPyPrinter):
    """Prints an expression as NumPy code that evaluates what occurs more than once only once.

    `sp.lambdify` does the same, and spends most of its time on documentation and on sums that share a part.
    """

    def __init__(self, expression: sp.Expr) -> None:
        super().__init__({"inline": True, "allow_unknown_functions": True})
        self._expression = expression
        self._repeated: set[sp.Basic] = set()
        self._variables: dict[sp.Basic, str] = {}
        self._lines: list[str] = []
        seen: set[sp.Basic] = set()
        left: list[sp.Basic] = [expression]
        while left:
            part = left.pop()
            if part in seen:
                self._repeated.add(part)
            elif part.args:
                seen.add(part)
                left += part.args

    def function(self, name: str, arguments: Sequence[str]) -> str:
        """The text of a function of these arguments."""
        result = self.doprint(self._expression)
        body = "".join(f"    {line}\n" for line in [*self._lines, f"return {result}"])
        return f"def {name}({', '.join(arguments)}):\n{body}"

    def _print(self, expr: Any, **kwargs: Any) -> str:
        if expr not in self._repeated:
            return super()._print(expr, **kwargs)
        if expr not in self._variables:
            text = super()._print(expr, **kwargs)
            self._variables[expr] = f"_{len(self._variables)}"
            self._lines.append(f"{self._variables[expr]} = {text}")
        return self._variables[expr]
