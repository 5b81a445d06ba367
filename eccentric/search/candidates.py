"""What the selection knows of an effect: columns of torque with a few shape parameters.

Method and physics are kept apart here: a candidate computes columns [N m, motor side] from channels, the
selection decides about columns.  `eccentric.effects` turns its symbolic records into candidates.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from eccentric.effects import Words

__all__ = ["Candidate", "Shape", "shape_grid"]

Array = np.ndarray
Shape = dict[str, float]


@dataclass(frozen=True)
class Candidate:
    """One way in which an effect may enter a balance.

    id: name in the report, as `link_harmonic_friction[n=3]`; several candidates share a `family`.
    balance: 'mechanical' or 'electrical'; columns are in N m on the motor side in both.
    depends_on: variables of the diagnosis ('velocity', 'link_angle', ...), the leading one first.
    shape: nonlinear parameters, name -> (low, high, 'linear' | 'log', number of grid points).
    columns: (channels, shape) -> (samples, k); hidden states run from the start of the log.
    lower: least coefficient of each column, 0 or -inf.
    needs: channels without which the candidate is left out ('temperature', 'voltage', 'current').
    replaces: (channels, shape, base (samples, p)) -> (what is known to be missing (samples,) or None, new
        base): an effect that changes a quantity inside the base (an angle, a factor on friction). Its
        parameters are all in `shape`; `columns` then only serve the first look, as the derivative at small
        shapes.
    special_of: families of which this one is a special case; it wins a tie against them.
    repeats: whether another candidate of the family may join it (harmonics of other orders).
    ridge: penalty on the coefficients, relative to their scaled diagonal (smooth terms only).
    words: what a person reads of it.
    also: (channels, shape) -> what an electrical effect adds to the mechanical target, columns (samples, k)
        for its coefficients, or (samples,) if its parameters are all in `shape` (a current sensor's bias and
        delay).
    """

    id: str
    family: str
    balance: str
    depends_on: tuple[str, ...]
    columns: Callable[[Any, Shape], Array]
    shape: Mapping[str, tuple[float, float, str, int]] = field(default_factory=dict)
    lower: tuple[float, ...] = (-np.inf,)
    needs: tuple[str, ...] = ()
    special_of: tuple[str, ...] = ()
    repeats: bool = False
    ridge: float = 0.0
    words: Words = field(default_factory=Words)
    also: Callable[[Any, Shape], Array] | None = None
    replaces: Callable[[Any, Shape, Array], tuple[Array | None, Array]] | None = None


def shape_grid(candidate: Candidate) -> list[Shape]:
    """All grid points of a candidate's shape; one empty shape if it has none."""
    axes = []
    for low, high, scale, count in candidate.shape.values():
        axes.append(np.geomspace(low, high, count) if scale == "log" else np.linspace(low, high, count))
    return [dict(zip(candidate.shape, map(float, point), strict=True)) for point in itertools.product(*axes)]
