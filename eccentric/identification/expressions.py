"""Evaluation of expressions: smooth signals of one log, and expressions compiled for them.

Definitions of the base model are signals as well, computed once. Other definitions are expanded, numerically
stable steps are replaced by their plain formulas, and the rest is compiled to NumPy.
"""

from __future__ import annotations

import sys
from bisect import bisect_left
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.linalg.lapack import dtbtrs

from eccentric.identification.drive import evaluated
from eccentric.identification.limits import AT_ONCE, KEPT_STEPS, MOST_KEPT
from eccentric.identification.regression import Coefficient
from eccentric.model import (
    Column,
    Model,
    PartValues,
    State,
    cached,
    fingerprint,
    function_of,
    meaning,
    printed,
    regressor,
)
from eccentric.model import vocabulary as v

Array = np.ndarray


@dataclass(frozen=True)
class Signals:
    """The smooth signals of one log that expressions are evaluated on, each (samples,), in SI units."""

    # input name -> signal: theta_m, omega_m, alpha_m, t, and if available i, u, temperature
    values: Mapping[str, Array]
    dt: Array  # step to the next sample [s]
    starts: tuple[int, ...]  # index of the first sample of each run; hidden states restart there
    known: Mapping[str, float]  # value of every parameter that is not a friction coefficient
    # what the rig leaves open, coefficient -> column of torque [N m]; part of every base
    open: Mapping[Coefficient, Array] = field(default_factory=dict)
    # positions of the columns of the regressor that are not identically zero
    friction: tuple[int, ...] | None = None
    base: Model | None = None  # the model whose definitions are signals
    # of the starts, those of a window of a long log, with the steps since the sample before; what
    # warms up goes on from there
    bridged: Mapping[int, int] = field(default_factory=dict)
    # parameters that differ along the log, where runs carry more mass: name -> (samples,), in place
    # of those in `known`
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
            function, arguments = function_of(meaning(definition.value))
            if definition.quantity.name not in others and given.keys() >= set(arguments):
                with np.errstate(all="ignore"):
                    values = np.asarray(function(*(given[a] for a in arguments)), float)
                found[definition.symbol] = definition.value, values
                given[definition.quantity.name] = values
        return found

    @cached_property
    def parts(self) -> PartValues:
        """The values of parts that several expressions share."""
        return PartValues(self._own)

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

    @cached_property
    def fixed(self) -> frozenset[str]:
        """Names of all that has one value on the log, before shapes and states."""
        return frozenset(self._own)

    @cached_property
    def varying(self) -> frozenset[str]:
        """Those of them that change along the log."""
        return frozenset(name for name, x in self._own.items() if np.ndim(x))

    @cached_property
    def key(self) -> str:
        """The digest of what decides how an expression is printed: names, and formulas of what is defined."""
        formulas = {symbol: formula for symbol, (formula, _) in self.defined.items()}
        return fingerprint((self.fixed, self.varying, formulas))

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
    evaluated_at = lambdified(model, expression, signals, names)
    parts = {q.name: signals.part(q.part_of) for q in model.parameters if q.name in names and signals.by_row}

    def evaluate(shape: Mapping[str, float], series: Mapping[str, Array]) -> Array:
        given = signals.given({name: x * parts.get(name, 1.0) for name, x in shape.items()}, series)
        with np.errstate(all="ignore"):
            return np.broadcast_to(np.asarray(evaluated_at(given), float), (signals.size,))

    return evaluate


def lambdified(
    model: Model, expression: sp.Expr, signals: Signals, names: tuple[str, ...]
) -> Callable[[Mapping[str, Any]], Any]:
    """An expression as a function of what `Signals.given` gives; `names` are those of shapes."""
    try:
        key = f"expression {fingerprint((expression, _formulas(model), sorted(names)))} {signals.key}"
    except TypeError:  # it has a class of a person's own
        key = ""
    function = printed(
        key,
        lambda: signals.expanded(model, expression, names),
        signals.fixed.difference(names),
        signals.varying,
    )

    def evaluate(given: Mapping[str, Any]) -> Any:
        parts = function.parts
        values = (signals.parts[parts[a]] if a in parts else given[a] for a in function.arguments)
        return function.call(*values)

    return evaluate


def _formulas(model: Model) -> list[tuple[sp.Symbol, sp.Expr]]:
    return [(definition.symbol, definition.value) for definition in model.definitions]


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


# As many as all effects of the library have on a few models.
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


def state_series(model: Model, signals: Signals, shape: Mapping[str, float]) -> dict[str, Array]:
    """Hidden states of a model along the log, from its start: name -> (samples,).

    `shape` gives the values of the parameters of the effects that introduced the states.
    """
    return States(model, model.states, signals, tuple(shape))(dict(shape))


class States:
    """The hidden states of a model along the signals, for given shape values."""

    def __init__(
        self, model: Model, states: Sequence[State], signals: Signals, names: tuple[str, ...]
    ) -> None:
        self._signals = signals
        self._steps = []
        symbols = {state.symbol for state in states}
        done: set[sp.Symbol] = set()
        waiting = list(states)
        while waiting:
            state = next((s for s in waiting if (s.update.free_symbols & symbols) - done <= {s.symbol}), None)
            if state is None:
                raise ValueError(f"states of {model.name} depend on each other in a circle")
            waiting.remove(state)
            done.add(state.symbol)
            step, parts = _step_of(model, state, signals, names)
            functions = [lambdified(model, part, signals, names) for part in parts]
            self._steps.append((state, step, functions))
        self._kept: dict[tuple[Any, ...], dict[str, Array]] = {}

    def __call__(self, shape: Mapping[str, float]) -> dict[str, Array]:
        """The states along the signals, name -> (samples,), for the values of the shapes."""
        key = tuple(sorted(shape.items()))
        if key in self._kept:
            return self._kept[key]
        series: dict[str, Array] = {}
        for state, step, functions in self._steps:
            given = self._signals.given(shape, series)
            n = self._signals.size
            parts = [
                np.array(np.broadcast_to(np.asarray(function(given), float), (n,))) for function in functions
            ]
            initial = float(state.initial)
            found = self._affine(initial, *parts) if step is None else self._loop(initial, step, parts)
            series[state.quantity.name] = found
        if len(self._kept) >= MOST_KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[key] = series
        return series

    def _affine(self, initial: float, gain: Array, push: Array) -> Array:
        """x[k + 1] = gain[k] x[k] + push[k]: a bidiagonal system.

        Between the windows of a long log, gain and push are the means of the two windows.
        """
        right = np.r_[0.0, push[:-1]]
        below = -gain[:-1].copy()
        starts = [*self._signals.starts, self._signals.size]
        for before, start, after in zip([0, *starts], starts[:-1], starts[1:], strict=False):
            right[start], passed = initial, 0.0
            if steps := self._signals.bridged.get(start):
                mean = float(np.clip(np.mean(gain[before:after]), -1.0, 1.0))
                passed = mean**steps
                times = steps if mean == 1.0 else (1.0 - passed) / (1.0 - mean)
                right[start] = float(np.mean(push[before:after])) * times
            if start > 0:
                below[start - 1] = -passed
        # The triangular solver: that for general bands takes several times as long, and for gains up to 1 to
        # the same bits.
        bands = np.vstack([np.ones(len(gain)), np.r_[below, 0.0]])
        if not (np.all(np.isfinite(bands)) and np.all(np.isfinite(right))):
            raise ValueError("what changes a hidden state is not finite")
        return np.asarray(dtbtrs(bands, right, uplo="L", diag="U")[0])

    def _loop(
        self, initial: float, step: tuple[Callable[..., float], Callable[..., Array]], parts: list[Array]
    ) -> Array:
        """x[k + 1] = step(x[k], parts[k]), `step` for one sample and for arrays.

        A state at its initial value stays there until a sample moves it; the samples in between are skipped.
        """
        one, all_at_once = step
        moving = np.flatnonzero(all_at_once(initial, parts) != initial).tolist()
        found = np.full(self._signals.size, initial)
        for start, end in zip(
            self._signals.starts, [*self._signals.starts[1:], self._signals.size], strict=True
        ):
            k = start
            while (k := _next(moving, k)) < end - 1:
                moved = list(_until(one, initial, parts, k, end - 1))
                found[k + 1 : k + 1 + len(moved)] = moved
                k += 1 + len(moved)
        return found


def _until(
    one: Callable[..., float], initial: float, parts: list[Array], k: int, end: int
) -> Iterator[float]:
    """The values from sample k + 1 on, up to the first that is the initial one again."""
    now = initial
    for at in range(k, end, AT_ONCE):
        some = slice(at, min(at + AT_ONCE, end))
        for row in zip(*(part[some].tolist() for part in parts), strict=True):
            now = one(now, row)
            if now == initial:
                return
            yield now


def _step_of(
    model: Model, state: State, signals: Signals, names: tuple[str, ...]
) -> tuple[tuple[Callable[..., float], Callable[..., Array]] | None, tuple[sp.Expr, ...]]:
    """Gain and push of an affine update; else its step, for one sample and for arrays, and what it takes."""
    record = state.update, state.symbol, _formulas(model), sorted(names), signals.key
    rest, letters, parts = cached(
        "step", record, lambda: _separated(signals.expanded(model, state.update, names), state.symbol)
    )
    return None if rest is None else _functions_of(rest, state.symbol, letters), parts


@lru_cache(maxsize=KEPT_STEPS)
def _separated(
    update: sp.Expr, state: sp.Symbol
) -> tuple[sp.Expr | None, tuple[sp.Symbol, ...], tuple[sp.Expr, ...]]:
    """The step of an update, in the state and symbols of its parts, and these; None if it is affine."""
    gain = sp.diff(update, state)
    if state not in gain.free_symbols:
        return None, (), (gain, sp.expand(update).subs(state, 0))
    rest, parts = _apart(update, state)
    return rest, tuple(parts), tuple(parts.values())


@lru_cache(maxsize=KEPT_STEPS)
def _functions_of(
    rest: sp.Expr, state: sp.Symbol, parts: tuple[sp.Symbol, ...]
) -> tuple[Callable[..., float], Callable[..., Array]]:
    # Python's own numbers are several times faster than NumPy's for one sample at a time.
    one, all_at_once = (
        sp.lambdify([state, parts], rest, modules=modules, cse=True) for modules in ("math", "numpy")
    )
    return one, all_at_once


def _next(moving: list[int], k: int) -> int:
    """The first of the sorted samples from k on; a number larger than all if there is none."""
    at = bisect_left(moving, k)
    return moving[at] if at < len(moving) else sys.maxsize


def _apart(update: sp.Expr, state: sp.Symbol) -> tuple[sp.Expr, dict[sp.Symbol, sp.Expr]]:
    """The update with a symbol for each of its largest parts without the state; symbol -> part."""
    parts: dict[sp.Symbol, sp.Expr] = {}

    def without(e: sp.Expr) -> sp.Expr:
        if e.is_number:
            return e
        found = next((symbol for symbol, part in parts.items() if part == e), None)
        found = found or sp.Dummy(f"part_{len(parts)}")
        parts[found] = e
        return found

    def walk(e: sp.Expr) -> sp.Expr:
        if e == state:
            return e
        if not e.has(state):
            return without(e)
        if isinstance(e, sp.Add | sp.Mul):
            free, own = e.as_independent(state, as_Add=isinstance(e, sp.Add))
            return e.func(without(free), *(walk(arg) for arg in e.func.make_args(own)))
        return e.func(*map(walk, e.args))

    return walk(update), parts
