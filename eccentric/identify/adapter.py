"""From symbolic effects to numerical candidates: the only bridge between physics and selection.

Everything a candidate computes comes from the Effect's expressions and the Model it extends: definitions are
expanded, careful steps replaced by what they mean, known parameters put in, and what is left is compiled to
NumPy.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp
from scipy.linalg import solve_banded

from eccentric.effects.effect import Effect
from eccentric.identify.candidates import Candidate, Shape
from eccentric.model import Column, Model, regressor
from eccentric.model import vocabulary as v
from eccentric.model.model import State
from eccentric.model.steps import meaning

__all__ = ["Signals", "base_columns", "candidate", "compiled", "state_series"]

Array = np.ndarray
# Shapes whose states are kept: a search comes back to the points of its grid.
_MOST_KEPT = 40


@dataclass(frozen=True)
class Signals:
    """What expressions are evaluated on: smooth signals of one log, all of shape (samples,), in SI units.

    Attributes:
        values: input name -> signal: theta_m, omega_m, alpha_m, t, and where there is one i, u, temperature.
        dt: step to the next sample [s].
        starts: index of the first sample of each run; hidden states start anew there.
        known: value of every parameter that is no friction coefficient.
        open: what the rig leaves open, name -> column of torque [N m]; part of every base.
        friction: positions of the columns of the regressor that are not zero throughout.
    """

    values: Mapping[str, Array]
    dt: Array
    starts: tuple[int, ...]
    known: Mapping[str, float]
    open: Mapping[str, Array] = field(default_factory=dict)
    friction: tuple[int, ...] | None = None

    def columns(self, model: Model) -> tuple[Column, ...]:
        """The friction columns of a model that the log can show."""
        every = regressor(model)
        return every if self.friction is None else tuple(every[k] for k in self.friction)

    @property
    def size(self) -> int:
        """Number of samples."""
        return len(self.dt)


def base_columns(model: Model, signals: Signals) -> Array:
    """The regressor of the model on the signals and what the rig leaves open, (samples, columns)."""
    columns = [compiled(model, column.basis, signals, ()) for column in signals.columns(model)]
    return np.column_stack([*(column({}, {}) for column in columns), *signals.open.values()])


def candidate(
    effect: Effect, model: Model, signals: Signals, friction: Array, balance: str | None = None
) -> Candidate:
    """The effect as columns of torque.

    Args:
        effect: the record.
        model: the base model.
        signals: smooth signals.
        friction: (columns,) coefficients of a first fit of the base model, for the first look at effects that
            scale or replace something.
        balance: the one that shows it, if not the effect's own: a rig driven by voltage alone shows what
            the armature does in the mechanical balance.
    """
    extended = effect.extend(model)
    names = tuple(shape.quantity.name for shape in effect.shapes)
    states = _States(extended, effect.states, signals, names)
    load = {
        "mechanical": sp.Integer(1),
        "electrical": v.k_i.symbol / v.R.symbol,
    }
    own = {
        balance: [
            compiled(extended, load[balance] * _collected(terms, q.symbol), signals, names)
            for q in effect.coefficients
        ]
        for balance, terms in effect.terms.items()
    }
    ranges = {s.quantity.name: (s.low, s.high, s.scale, s.points) for s in effect.shapes}
    lower = tuple(-np.inf if low is None else low for low, _ in effect.bounds) or (-np.inf,)
    changes = _changes(effect, model, extended, signals, names, states)

    def columns_of(balance: str) -> Callable[[Any, Shape], Array]:
        def columns(_: Any, shape: Shape) -> Array:
            series = states(shape)
            return np.column_stack([column(shape, series) for column in own[balance]])

        return columns

    # Compiled for those few that need it.
    plain = np.empty(0) if changes is None else base_columns(model, signals) @ friction

    def first_look(_: Any, shape: Shape) -> Array:
        """The change at this shape, friction as first fitted: a direction for the search."""
        if changes is None:
            raise ValueError(f"effect {effect.id} changes nothing of the base model")
        known, base = changes(shape)
        return (known + base @ friction - plain)[:, None]

    other = "mechanical" if effect.balance == "electrical" and balance is None else None
    return Candidate(
        id=effect.id,
        family=effect.family,
        balance=balance or effect.balance,
        depends_on=effect.depends_on,
        columns=columns_of(effect.balance) if changes is None else first_look,
        shape=ranges,
        lower=lower if changes is None else (0.0,),
        needs=effect.needs,
        special_of=effect.special_of,
        repeats=effect.repeats,
        also=None if other is None or other not in own else columns_of(other),
        replaces=None if changes is None else (lambda _, shape, __: changes(shape)),
    )


def state_series(model: Model, signals: Signals, shape: Mapping[str, float]) -> dict[str, Array]:
    """Hidden states of a model along the log, from its start: name -> (samples,).

    `shape` gives the values of the parameters of the effects that brought the states along.
    """
    return _States(model, model.states, signals, tuple(shape))(dict(shape))


def _collected(terms: Sequence[Any], coefficient: sp.Symbol) -> sp.Expr:
    """What the coefficient multiplies in the terms of one balance."""
    return sp.Add(*(sp.expand(term.value).coeff(coefficient) for term in terms))


def _changes(
    effect: Effect, model: Model, extended: Model, signals: Signals, names: tuple[str, ...], states: _States
) -> Callable[[Shape], tuple[Array, Array]] | None:
    """For an effect that scales or replaces: shape -> (what is known to be missing, new base columns)."""
    if not effect.replaces and not effect.scales:
        return None
    swap = dict(effect.replaces)
    columns = []
    for column in signals.columns(model):
        kind = "viscous" if column.name.startswith("B") else "coulomb"
        factors = [factor for which, factor in effect.scales.items() if which in {"friction", kind}]
        basis = sp.Mul(column.basis.xreplace(swap), *factors)
        columns.append(compiled(extended, basis, signals, names))
    loads = [
        compiled(
            which, which.balance("mechanical").sum_of("inertial", "gravity", "conservative"), signals, names
        )
        for which in (extended, model)
    ]

    def changed(shape: Shape) -> tuple[Array, Array]:
        series = states(shape)
        known = loads[0](shape, series) - loads[1](shape, series)
        return known, np.column_stack(
            [*(column(shape, series) for column in columns), *signals.open.values()]
        )

    return changed


def compiled(
    model: Model, expression: sp.Expr, signals: Signals, names: tuple[str, ...] = ()
) -> Callable[[Mapping[str, float], Mapping[str, Array]], Array]:
    """An expression as a function of shape values and state series, over all samples."""
    function, arguments = _lambdified(model, expression, signals, names)

    def evaluate(shape: Mapping[str, float], series: Mapping[str, Array]) -> Array:
        given = {**signals.values, "dt": signals.dt, **series, **shape}
        with np.errstate(all="ignore"):
            return np.broadcast_to(
                np.asarray(function(*(given[a] for a in arguments)), float), (signals.size,)
            )

    return evaluate


def _lambdified(
    model: Model, expression: sp.Expr, signals: Signals, names: tuple[str, ...], modules: str = "numpy"
) -> tuple[Callable[..., Any], list[str]]:
    plain = meaning(model.expand(expression))
    numbers = {
        s: sp.Float(signals.known[s.name], 17)
        for s in plain.free_symbols
        if s.name in signals.known and s.name not in names
    }
    plain = plain.xreplace(numbers)
    symbols = sorted(plain.free_symbols, key=str)
    return sp.lambdify(symbols, plain, modules=modules, cse=True), [s.name for s in symbols]


class _States:
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
            update = meaning(model.expand(state.update))
            gain = sp.diff(update, state.symbol)
            affine = state.symbol not in gain.free_symbols
            parts = (gain, sp.expand(update).subs(state.symbol, 0)) if affine else (update,)
            # Python's own numbers are several times faster than NumPy's where samples go one by one.
            modules = "numpy" if affine else "math"
            functions = [_lambdified(model, part, signals, names, modules) for part in parts]
            self._steps.append((state, affine, functions))
        self._kept: dict[tuple[Any, ...], dict[str, Array]] = {}

    def __call__(self, shape: Mapping[str, float]) -> dict[str, Array]:
        key = tuple(sorted(shape.items()))
        if key in self._kept:
            return self._kept[key]
        series: dict[str, Array] = {}
        for state, affine, compiled in self._steps:
            given = {**self._signals.values, "dt": self._signals.dt, **series, **shape}
            solve = self._affine if affine else self._loop
            series[state.quantity.name] = solve(state, compiled, given)
        if len(self._kept) >= _MOST_KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[key] = series
        return series

    def _affine(self, state: State, compiled: list, given: Mapping[str, Any]) -> Array:
        """x[k + 1] = gain[k] x[k] + input[k]: a bidiagonal system."""
        n = self._signals.size
        gain, push = (
            np.array(np.broadcast_to(np.asarray(f(*(given[a] for a in names)), float), (n,)))
            for f, names in compiled
        )
        right = np.r_[0.0, push[:-1]]
        below = -gain[:-1].copy()
        for start in self._signals.starts:
            right[start] = float(state.initial)
            if start > 0:
                below[start - 1] = 0.0
        return solve_banded((1, 0), np.vstack([np.ones(n), np.r_[below, 0.0]]), right)

    def _loop(self, state: State, compiled: list, given: Mapping[str, Any]) -> Array:
        (function, names), n = compiled[0], self._signals.size
        at = names.index(state.quantity.name)
        columns = [np.broadcast_to(np.asarray(given.get(a, 0.0), float), (n,)).tolist() for a in names]
        out, value, starts = np.empty(n), float(state.initial), set(self._signals.starts)
        for k, arguments in enumerate(zip(*columns, strict=True)):
            if k in starts:
                value = float(state.initial)
            out[k] = value
            value = float(function(*arguments[:at], value, *arguments[at + 1 :]))
        return out
