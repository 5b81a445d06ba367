"""Hidden states of a model along a log: solved at once where the update is affine, else sample by sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import sympy as sp
from scipy.linalg import solve_banded

from eccentric.identify.signals import Signals, lambdified
from eccentric.model import Model
from eccentric.model.model import State
from eccentric.model.steps import meaning

__all__ = ["States", "state_series"]

Array = np.ndarray
# Shapes whose states are kept: a search comes back to the points of its grid.
_MOST_KEPT = 40


def state_series(model: Model, signals: Signals, shape: Mapping[str, float]) -> dict[str, Array]:
    """Hidden states of a model along the log, from its start: name -> (samples,).

    `shape` gives the values of the parameters of the effects that brought the states along.
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
            update = meaning(model.expand(state.update))
            gain = sp.diff(update, state.symbol)
            affine = state.symbol not in gain.free_symbols
            parts = (gain, sp.expand(update).subs(state.symbol, 0)) if affine else (update,)
            # Python's own numbers are several times faster than NumPy's where samples go one by one.
            modules = "numpy" if affine else "math"
            functions = [lambdified(model, part, signals, names, modules) for part in parts]
            self._steps.append((state, affine, functions))
        self._kept: dict[tuple[Any, ...], dict[str, Array]] = {}

    def __call__(self, shape: Mapping[str, float]) -> dict[str, Array]:
        """The states along the signals, name -> (samples,), for the values of the shapes."""
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
