"""Stretches between gaps and ends of runs: nothing is filtered, interpolated or integrated across them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eccentric.signals.limits import GAP_STEPS

if TYPE_CHECKING:
    from collections.abc import Callable

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def stretches(t: Array, run: Integers) -> Integers:
    """Return the number of the stretch of each row (n,): one starts with a run or after a gap in t [s]."""
    begins = np.ones(len(t), dtype=bool)
    begins[1:] = run[1:] != run[:-1]
    for rows in rows_of_each(run):
        steps = np.diff(t[rows])
        if len(steps):
            begins[rows[1:]] |= steps > GAP_STEPS * np.median(steps)
    return np.cumsum(begins) - 1


def rows_of_each(number: NDArray[Any]) -> list[Integers]:
    """Return the rows of each stretch, in order; `number` (n,) is that of the stretch (or run)."""
    return np.split(np.arange(len(number)), np.flatnonzero(np.diff(number)) + 1)


def joined(number: NDArray[Any], function: Callable[[Integers], NDArray[Any]]) -> NDArray[Any]:
    """Concatenate the results of a function for the rows of each stretch."""
    return np.concatenate([function(rows) for rows in rows_of_each(number)])
