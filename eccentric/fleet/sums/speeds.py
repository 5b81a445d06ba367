"""The threshold of motion of a file, from the speeds of all of its windows, in memory that does not grow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eccentric.fleet.limits import FAST_PART, QUANTA, SHARES, SLOW, SPEED_BIN

__all__ = ["Speeds"]

Array = NDArray[np.float64]

_EDGES = np.exp(np.arange(np.log(1e-9), np.log(1e9), np.log(SPEED_BIN)))


class Speeds:
    """The way covered at each speed, in bins, and the speed that the encoder resolves."""

    def __init__(self) -> None:
        self._way = np.zeros(len(_EDGES) + 1)
        self._resolved = 0.0

    def add(self, omega: Array, quantum: float, share_s: float) -> None:
        """Add windows with speeds [rad/s] (m,), spaced by `share_s` [s], of an encoder of steps [rad]."""
        speed = np.abs(omega)
        at = np.searchsorted(_EDGES, speed)
        self._way += np.bincount(at, speed * share_s, minlength=len(self._way))
        self._resolved = max(self._resolved, QUANTA * quantum / (SHARES * share_s))

    def threshold(self) -> float:
        """The speed [rad/s] above which a window moves; 0 for a file that never moves."""
        way = np.cumsum(self._way)
        if not way[-1]:
            return self._resolved
        fast = _EDGES[min(int(np.searchsorted(way, FAST_PART * way[-1])), len(_EDGES) - 1)]
        return max(self._resolved, SLOW * float(fast))
