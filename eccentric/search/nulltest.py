"""Is anything missing, and on what does the residual depend?

- `inflation`: by how much correlated rows overstate their number (a HAC sum of the autocorrelation).
- `flipped_null`: the largest gain that any column of the library reaches by chance, from residuals whose
  blocks have their signs flipped at random: correlation within blocks, heteroscedasticity and the search are
  kept.
- `smooth_terms`: splines and Fourier sums in each variable of the diagnosis.  They compete with the physical
  candidates in the same cross-validation: what they still take out of a residual, no physical effect
  explains.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.interpolate import BSpline

from eccentric.search.candidates import Candidate
from eccentric.search.selection import Fitted, Screen

__all__ = ["correlated", "flipped_null", "inflation", "null_quantile", "smooth_terms"]

Array = np.ndarray

MOST_LAGS = 60
"""Rows over which a residual is correlated with itself, at most."""
DRAWS = 200
LEVEL = 0.99
"""What chance reaches in one log of a hundred."""


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
    design = np.hstack([screen.balance.base, *[screen.columns(term) for term in fitted.terms]])
    library = screen.library
    if design.shape[1]:
        q, _ = np.linalg.qr(design)
        library = library - q @ (q.T @ library)
    length = np.linalg.norm(library, axis=0)
    kept = length > 1e-4 * np.linalg.norm(screen.library, axis=0)
    if not np.any(kept):
        return 0.0
    gain = flipped_null(residual, library[:, kept] / length[kept], screen.block)
    return float(np.quantile(gain, LEVEL)) / correlated(screen, residual)


def correlated(screen: Screen, residual: Array) -> float:
    """How many rows count as one: at least two, since windows overlap by half; one where they are runs."""
    return 1.0 if screen.balance.rows.independent else max(2.0, inflation(residual, screen.block))


def _spline(x: Array, pieces: int, valid: Array) -> Array:
    """Cubic B-splines of x, (samples, pieces + 2): the constant is left out.

    Knots lie half by quantiles, half evenly within the 0.2 to 99.8 % range of the valid samples: a log dwells
    at few speeds, and what happens between them counts too.
    """
    low, high = np.quantile(x[valid], [0.002, 0.998])
    share = np.linspace(0.0, 1.0, pieces + 1)
    knots = 0.5 * (np.clip(np.quantile(x[valid], share), low, high) + low + (high - low) * share)
    if high - low <= 1e-9 * max(1.0, abs(low), abs(high)):
        return np.empty((len(x), 0))
    full = np.r_[[knots[0]] * 3, knots, [knots[-1]] * 3]
    return BSpline.design_matrix(np.clip(x, knots[0], knots[-1]), full, 3).toarray()[:, 1:]


def _fourier(angle: Array, orders: Sequence[int]) -> Array:
    return np.column_stack([f(n * angle) for n in orders for f in (np.cos, np.sin)])


def smooth_terms(channels: Any, balance: str, mu: float, gravity: Array, valid: Array) -> list[Candidate]:
    """Empirical terms, one family 'smooth:<variable>' each.

    channels: as in `Candidate.columns`, with smooth signals; mu: gear ratio; gravity (samples,): torque of
    gravity on the motor side [N m]; valid (samples,): those that any window uses.  Even and odd parts are
    both there: a term times sgn w is one of friction.
    """
    omega = channels.omega_m
    sign = np.sign(omega)[:, None]

    def both(columns: Array) -> Array:
        return np.hstack([columns, columns * sign])

    elapsed = channels.t - channels.t[0]
    terms: dict[str, Array] = {
        "velocity": _spline(np.abs(omega), 14, valid) * sign,
        "direction": np.hstack([np.ones_like(sign), _spline(np.abs(omega), 8, valid)]),
    }
    # The mean of a whole run has no time, and its acceleration is that of the ends.
    if not channels.steady:
        slope = _spline(elapsed, 5, valid) * omega[:, None]
        terms["acceleration"] = _spline(channels.alpha_m, 8, valid)
        terms["time"] = np.hstack([both(_spline(elapsed, 12, valid)), slope])
    # Angles of several runs that were integrated from the speed have no common zero: then there are none.
    if channels.theta_m is not None:
        terms["motor_angle"] = _fourier(channels.theta_m, range(1, 9))
    if balance == "mechanical":
        if channels.theta_m is not None:
            terms["link_angle"] = both(_fourier(mu * channels.theta_m, range(1, 13)))
        if np.any(gravity):
            terms["gravity_load"] = both(_spline(gravity, 8, valid))
    if channels.current is not None:
        terms["current"] = _spline(channels.current, 12, valid)
    if channels.voltage is not None and balance == "electrical":
        terms["voltage"] = _spline(channels.voltage, 12, valid)
    if channels.temperature is not None:
        warm = _spline(channels.temperature, 5, valid)
        terms["temperature"] = np.hstack([warm, warm * sign, warm * omega[:, None]])
    return [
        Candidate(
            id=f"smooth:{name}",
            family=f"smooth:{name}",
            balance=balance,
            depends_on=(name,),
            columns=lambda c, s, columns=columns: columns,
            ridge=1e-2,
        )
        for name, columns in terms.items()
        if columns.shape[1]
    ]
