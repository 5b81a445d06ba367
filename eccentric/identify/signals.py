"""What expressions are evaluated on, and how: smooth signals of one log, and an expression compiled for them.

Definitions are expanded, careful steps replaced by what they mean, known parameters put in, and what is left
is compiled to NumPy.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from eccentric.model import Column, Model, regressor
from eccentric.model.steps import meaning

__all__ = ["Signals", "base_columns", "compiled", "lambdified"]

Array = np.ndarray


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


def compiled(
    model: Model, expression: sp.Expr, signals: Signals, names: tuple[str, ...] = ()
) -> Callable[[Mapping[str, float], Mapping[str, Array]], Array]:
    """An expression as a function of shape values and state series, over all samples."""
    function, arguments = lambdified(model, expression, signals, names)

    def evaluate(shape: Mapping[str, float], series: Mapping[str, Array]) -> Array:
        given = {**signals.values, "dt": signals.dt, **series, **shape}
        with np.errstate(all="ignore"):
            return np.broadcast_to(
                np.asarray(function(*(given[a] for a in arguments)), float), (signals.size,)
            )

    return evaluate


def lambdified(
    model: Model, expression: sp.Expr, signals: Signals, names: tuple[str, ...], modules: str = "numpy"
) -> tuple[Callable[..., Any], list[str]]:
    """An expression as a function, and the names of its arguments.

    `names` are those of shapes, which stay free; `modules` is what sympy.lambdify computes with.
    """
    plain = meaning(model.expand(expression))
    numbers = {
        s: sp.Float(signals.known[s.name], 17)
        for s in plain.free_symbols
        if s.name in signals.known and s.name not in names
    }
    plain = plain.xreplace(numbers)
    symbols = sorted(plain.free_symbols, key=str)
    return sp.lambdify(symbols, plain, modules=modules, cse=True), [s.name for s in symbols]
