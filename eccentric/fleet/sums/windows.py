"""Even samples -> means over smooth windows, with the mean first and second rate of the angle.

A window carries the weight psi(s) ~ (1 - s^2)^4, s from -1 to 1, of integral one. By parts,

    mean of x' = - integral of psi' x dt,    mean of x'' = integral of psi'' x dt

so that a balance J x'' + ... = tau is averaged as a whole, and the angle is differentiated inside its own low
pass. Windows are spaced by a quarter of their length, so that each sample is multiplied 4 times by a kernel:
the samples are cut into quarters, one matrix product takes them all, and four shifted sums make the windows.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from eccentric.fleet.limits import LEAST_SHARE, SHARES, WINDOW_PERIODS

__all__ = ["any_in", "means", "rates", "share_of"]

Array = NDArray[np.float64]
_POWER = 4


def share_of(low_pass_hz: float, step_s: float) -> int:
    """Samples between two windows: a quarter of the length that suits a cut-off [Hz] at a step [s]."""
    return max(LEAST_SHARE, round(WINDOW_PERIODS / low_pass_hz / SHARES / step_s))


def means(x: Array, share: int) -> Array:
    """Means (m,) of samples (n,), m = n // share - 3."""
    return _windows(x, share, _kernels(share)[:, :1])[:, 0]


def rates(x: Array, share: int, step_s: float) -> tuple[Array, Array, Array]:
    """Means of samples (n,), of their first rate [1/s] and of their second rate [1/s^2], each (m,)."""
    # Of a large angle only the differences count: the kernels of rates sum to zero up to rounding.
    start = x[0]
    found = _windows(x - start, share, _kernels(share))
    return found[:, 0] + start, found[:, 1] / step_s, found[:, 2] / step_s**2


def any_in(flag: NDArray[np.bool_], share: int) -> NDArray[np.bool_]:
    """Whether a flag (n,) is set anywhere in each window (m,)."""
    count = len(flag) // share
    part = np.any(flag[: count * share].reshape(count, share), axis=1)
    return np.any([part[k : count - SHARES + 1 + k] for k in range(SHARES)], axis=0)


def _windows(x: Array, share: int, kernels: Array) -> Array:
    """Sums (m, c) of samples (n,) with kernels (SHARES * share, c)."""
    count, width = len(x) // share, kernels.shape[1]
    apart = kernels.reshape(SHARES, share, width).transpose(1, 0, 2).reshape(share, SHARES * width)
    parts = (x[: count * share].reshape(count, share) @ apart).reshape(count, SHARES, width)
    return np.sum([parts[k : count - SHARES + 1 + k, k] for k in range(SHARES)], axis=0)


@lru_cache(maxsize=64)
def _kernels(share: int) -> Array:
    """Weights (SHARES * share, 3) of the mean, the first and the second rate, for samples 1 s apart.

    Corrected so that they are exact for polynomials up to the cubic: the sum over few samples is not the
    integral.
    """
    count = SHARES * share
    half = count / 2.0
    s = (np.arange(count) + 0.5 - half) / half
    bump = 1.0 - s * s
    p = _POWER
    curves = np.stack(
        [
            bump**p,
            2.0 * p * s * bump ** (p - 1) / half,
            2.0 * p * bump ** (p - 2) * ((2.0 * p - 1.0) * s * s - 1.0) / half**2,
        ]
    )
    curves /= np.sum(bump**p)
    powers = np.stack([np.ones_like(s), s, s**2, s**3])
    moments = curves @ powers.T
    exact = np.zeros((3, 4))
    # Of 1 the mean is 1, of s the rate is 1/half, of s^2 the second rate is 2/half^2; the weight itself makes
    # a mean of s^2, and the first rate of s^3 that goes with it.
    exact[0, 0], exact[0, 2] = 1.0, moments[0, 2]
    exact[1, 1], exact[1, 3] = 1.0 / half, 3.0 * moments[0, 2] / half
    exact[2, 2] = 2.0 / half**2
    gram = (powers * bump**p) @ powers.T
    return (curves + np.linalg.solve(gram, (exact - moments).T).T @ powers * bump**p).T
