"""Hidden states of a model along a log: solved at once where the update is affine, else sample by sample."""

from __future__ import annotations

import sys
from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.linalg.lapack import dtbtrs

from eccentric.identification.expressions import Signals, lambdified
from eccentric.identification.limits import AT_ONCE, KEPT_STEPS, MOST_KEPT
from eccentric.model import Model, State

Array = np.ndarray


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
            step, parts = _step_of(signals.expanded(model, state.update, names), state.symbol)
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


@lru_cache(maxsize=KEPT_STEPS)
def _step_of(
    update: sp.Expr, state: sp.Symbol
) -> tuple[tuple[Callable[..., float], Callable[..., Array]] | None, tuple[sp.Expr, ...]]:
    """Gain and push of an affine update; else its step, for one sample and for arrays, and what it takes."""
    gain = sp.diff(update, state)
    if state not in gain.free_symbols:
        return None, (gain, sp.expand(update).subs(state, 0))
    rest, parts = _apart(update, state)
    # Python's own numbers are several times faster than NumPy's for one sample at a time.
    one, all_at_once = (
        sp.lambdify([state, tuple(parts)], rest, modules=modules, cse=True) for modules in ("math", "numpy")
    )
    return (one, all_at_once), tuple(parts.values())


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
