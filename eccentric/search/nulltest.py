"""Is anything missing? What noise and chance leave in a residual.

- `inflation`: the factor by which correlated rows overstate their number (HAC sum of the autocorrelation).
- `flipped_null`: the largest gain that any column of the library reaches by chance, from residuals with the
  signs of their blocks flipped at random: this preserves correlation within blocks, heteroscedasticity and
  the search.
"""

from __future__ import annotations

import numpy as np

from eccentric.search.limits import DRAWS, LEVEL, MOST_LAGS, ROWS_FOR_ONE, TINY_COLUMN
from eccentric.search.screen import Fitted, Screen

__all__ = ["correlated", "flipped_null", "inflation", "null_quantile"]

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


def flipped_null(residual: Array, columns: Array, block: Array) -> Array:
    """Largest single-column gain, in units of the residual's variance, under random signs per block (DRAWS,).

    columns (rows, m) must be orthogonal to the base and of unit length.
    """
    rng = np.random.default_rng(5)
    starts = np.flatnonzero(np.r_[True, block[1:] != block[:-1]])
    per_block = np.add.reduceat(columns * residual[:, None], starts, axis=0)
    signs = rng.choice([-1.0, 1.0], size=(DRAWS, len(starts)))
    return np.max((signs @ per_block) ** 2, axis=1) / float(np.mean(residual**2))


def null_quantile(screen: Screen, fitted: Fitted) -> float:
    """Quantile of the deviance that the best single column of a screen reaches by chance beside a fit."""
    residual = screen.residual(fitted)
    _, design, _ = screen.design(fitted.variants)
    library = screen.library
    if design.shape[1]:
        q, _ = np.linalg.qr(design)
        library = library - q @ (q.T @ library)
    length = np.linalg.norm(library, axis=0)
    kept = length > TINY_COLUMN * np.linalg.norm(screen.library, axis=0)
    if not np.any(kept):
        return 0.0
    gain = flipped_null(residual, library[:, kept] / length[kept], screen.block)
    return float(np.quantile(gain, LEVEL)) / correlated(screen, residual)


def correlated(screen: Screen, residual: Array) -> float:
    """How many rows count as one: at least two, since windows overlap by half; one if each row is a run."""
    independent = screen.balance.rows.independent
    return 1.0 if independent else max(ROWS_FOR_ONE, inflation(residual, screen.block))
