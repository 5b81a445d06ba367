"""How many rows a residual counts as: rows that follow each other repeat a part of what they say."""

from __future__ import annotations

import numpy as np

from eccentric.search.limits import MOST_LAGS, ROWS_FOR_ONE

__all__ = ["correlated", "inflation"]

Array = np.ndarray


def inflation(residual: Array, block: Array) -> float:
    """Variance inflation 1 + 2 sum of autocorrelation (Bartlett weights), at least 1.

    Pairs of rows more than one block apart are not counted.
    """
    r = residual - residual.mean()
    variance = float(np.mean(r**2))
    if variance <= 0.0:
        return 1.0
    total = 1.0
    for lag in range(1, min(MOST_LAGS, len(r) - 1) + 1):
        near = block[lag:] - block[:-lag] <= 1
        rho = float(np.sum(r[lag:] * r[:-lag] * near)) / (len(r) * variance)
        total += 2.0 * (1.0 - lag / (MOST_LAGS + 1)) * rho
    return max(1.0, total)


def correlated(residual: Array, block: Array, independent: bool) -> float:
    """How many rows count as one: at least two, since windows overlap by half; one if each row is a run."""
    return 1.0 if independent else max(ROWS_FOR_ONE, inflation(residual, block))
