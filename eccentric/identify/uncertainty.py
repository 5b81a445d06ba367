"""Standard errors and intervals where neighbouring rows share their noise.

Filters, quantisation and whatever a model leaves unexplained make the residual of a log sampled at hundreds of
rows per second strongly correlated; the textbook standard error would be several times too small.  Here

    cov = (X'X)^-1 Omega (X'X)^-1,  Omega = sum over lags of (1 - |lag|/S) sum of (x e)_t (x e)_(t+lag)',

the estimate of Newey and West (Econometrica 55, 1987), which asks for no model of the noise and also allows its
size to vary.  Its usual weakness is the choice of S: short ones are too optimistic by an amount nobody sees.  So S
is a tenth of all rows, much longer than any filter and comparable to a stretch of constant speed, and the quantiles
are those of Kiefer and Vogelsang (Econometric Theory 21, 2005), which hold for S in proportion to the rows: 2.26
standard errors take the place of 1.96.  (Clusters of blocks were the alternative: they want every block to look
alike, which blocks of a log of constant speeds do not.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FRACTION = 0.1
"""S over the number of rows."""
TWO_SIDED = 1.9600 + 2.9694 * FRACTION + 0.4160 * FRACTION**2 - 0.5324 * FRACTION**3
"""Standard errors to either end of a 95 % interval: Kiefer and Vogelsang's 97.5 % quantile."""
ONE_SIDED = 1.6449 + 2.1859 * FRACTION + 0.3142 * FRACTION**2 - 0.3427 * FRACTION**3
"""Standard errors to the one end of a one-sided 95 % interval: their 95 % quantile."""
DRAWS = 2000


@dataclass(frozen=True)
class Estimate:
    """Value, standard error and 95 % interval in `unit`; which bound is active, if one is.

    An interval ends where the bounds do.  With an active bound it is one-sided: from the bound to as far as a
    value could lie beside it, 95 % sure.
    """

    value: float
    std_error: float
    interval: tuple[float, float]
    unit: str
    bound_active: str | None = None


def estimate(
    value: float, std_error: float, unit: str, lower: float, upper: float, active: int = 0
) -> Estimate:
    """Return the estimate with its interval; `active` is -1 for the lower bound, 1 for the upper, 0 for none."""
    side = {-1: "lower", 0: None, 1: "upper"}[active]
    low = value - (TWO_SIDED if not active else ONE_SIDED) * std_error
    high = value + (TWO_SIDED if not active else ONE_SIDED) * std_error
    # At a bound the free optimum lies beyond it; counting from the bound keeps the interval from being empty.
    interval = (max(low, lower), min(high, upper))
    return Estimate(value, std_error, interval, unit, side)


def covariance(design: Array, residual: Array) -> Array:
    """Return the covariance (k, k) of least-squares coefficients; design (m, k), residual (m,) in row order.

    Both carry the square root of the weights. Rows follow each other in time; what lies between two of them
    (a held-out stretch, the end of a run) is short against S.
    """
    rows, count = design.shape
    size = np.linalg.norm(design, axis=0)
    scaled = design / size
    scores = scaled * residual[:, None]
    span = max(1, round(FRACTION * rows))
    # Sums over every window of `span` rows, the overhanging ones included, have exactly Bartlett's weights.
    padding = np.zeros((span, count))
    totals = np.cumsum(np.concatenate([padding, scores, padding]), axis=0)
    sums = totals[span:] - totals[:-span]
    omega = sums.T @ sums / span * rows / (rows - count)
    bread = np.linalg.inv(scaled.T @ scaled)
    return bread @ omega @ bread / np.outer(size, size)


def improvement(worse: Array, better: Array) -> tuple[float, tuple[float, float]]:
    """Return 100 (1 - RMS(better)/RMS(worse)) and its 95 % interval, for residuals (m,) of the same rows.

    Circular block bootstrap (Politis and Romano, 1992) in blocks of a twentieth of the rows: both residuals are
    drawn together, since what is hard to predict is so for both.
    """
    rows = len(worse)
    squares = np.column_stack([worse**2, better**2])
    percent = 100.0 * (1.0 - np.sqrt(squares[:, 1].sum() / squares[:, 0].sum()))
    length = max(1, rows // 20)
    blocks = -(-rows // length)
    totals = np.concatenate([np.zeros((1, 2)), np.cumsum(np.concatenate([squares, squares]), axis=0)])
    starts = np.random.default_rng(1).integers(0, rows, (DRAWS, blocks))
    drawn = (totals[starts + length] - totals[starts]).sum(axis=1)
    low, high = np.quantile(100.0 * (1.0 - np.sqrt(drawn[:, 1] / drawn[:, 0])), [0.025, 0.975])
    return float(percent), (float(low), float(high))
