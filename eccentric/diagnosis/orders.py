"""Periods of the torque while the motor turns one way: its spectrum over the angle, run by run.

A harmonic of the motor or the link has one order per turn at every speed; something periodic in time has one
frequency, and its order changes from speed to speed.  Each stretch of several turns has its own spectrum
(Lomb-Scargle, over the angle instead of time), so that no common zero of the angle is needed, as it is
for an effect: an angle integrated from the speed of each run is enough.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter

from eccentric.diagnosis.limits import (
    ABOVE,
    ALIKE,
    ALONE,
    AROUND,
    HIGHEST_ORDER,
    LEAST_SHARE,
    LEAST_STRETCHES,
    LEAST_TURNS,
    LOWEST_ORDER,
    NEIGHBOURS,
    ORDER_STEP,
    ROWS_PER_CYCLE,
)
from eccentric.identification import FitData
from eccentric.signals import rows_of_each

Array = np.ndarray

TURN = 2.0 * np.pi
_GRID = np.arange(LOWEST_ORDER, HIGHEST_ORDER, ORDER_STEP)
"""Orders of the spectra."""


@dataclass(frozen=True)
class Order:
    """A periodic part of the torque.

    per_turn: cycles per turn of the motor; amplitude: RMS over the stretches of its amplitude [N m]; share:
    of the variance within the stretches, on average; seen: in how many of the `stretches` it is a peak,
    `ABOVE` times the median of their own spectrum.
    """

    per_turn: float
    amplitude: float
    share: float
    seen: int
    stretches: int


def orders_of(data: FitData, target: Array) -> tuple[Order, ...]:
    """The orders of the mechanical target (samples,) [N m], the largest share first.

    Empty with fewer than `LEAST_STRETCHES` stretches of usable rows in one direction of `LEAST_TURNS` turns.
    """
    channels = data.drive.channels
    # What turns with a carriage is its screw, if the rig knows the pitch.
    axis, known = channels.rig.axis, channels.rig.known
    if not axis.wraps and "pitch" not in known:
        return ()
    turning = channels.motion.theta_m * (1.0 if axis.wraps else known["mu"])
    spectra, variances = [], []
    for rows in _stretches(channels.selection.usable, channels.time.segment, channels.motion.omega_m):
        angle, y = turning[rows], target[rows]
        turns = abs(angle[-1] - angle[0]) / TURN
        if turns < LEAST_TURNS or len(rows) < ROWS_PER_CYCLE * HIGHEST_ORDER * turns:
            continue
        # What is smooth over the stretch or follows the speed is not a ripple.
        t = np.linspace(-1.0, 1.0, len(rows))
        slow = np.column_stack([np.ones_like(t), t, t**2, channels.motion.omega_m[rows]])
        rest = y - slow @ np.linalg.lstsq(slow, y, rcond=None)[0]
        if np.std(rest) <= 1e-12 * max(np.std(y), 1e-300):
            continue
        spectra.append(_spectrum(angle, rest))
        variances.append(float(np.var(rest)))
    if len(spectra) < LEAST_STRETCHES:
        return ()
    every = np.array(spectra)
    mean = every.mean(axis=0)
    around = median_filter(mean, AROUND, mode="nearest")
    local = median_filter(every, (1, AROUND), mode="nearest")
    found = []
    for k in _peaks(mean, np.maximum(LEAST_SHARE, ABOVE * around)):
        near = every[:, max(k - NEIGHBOURS, 0) : k + NEIGHBOURS + 1].max(axis=1)
        share = float(near.mean())
        # Leakage from one frequency in time is not a peak in the neighbouring orders.
        peak = near >= every[:, max(k - ALONE, 0) : k + ALONE + 1].max(axis=1)
        seen = int(np.count_nonzero(peak & (near > ABOVE * local[:, k])))
        amplitude = float(np.sqrt(np.mean(2.0 * near * np.array(variances))))
        found.append(Order(_centre(_GRID, mean, k), amplitude, share, seen, len(every)))
    return tuple(sorted((o for o in found if 2 * o.seen > o.stretches), key=lambda o: -o.share))


def _spectrum(angle: Array, y: Array) -> Array:
    """The share of y (n,) that cosine and sine of each order of `_GRID` over the angle [rad] (n,) explain.

    That is the normalised Lomb-Scargle periodogram. On an even grid e^(i nu theta) is a product of two
    factors, one for every 20th order and one for those between, so that sums over rows are matrix products.
    """
    fine = 20
    coarse = _GRID[::fine]
    one = np.exp(1j * np.outer(angle, coarse))
    other = np.exp(1j * np.outer(angle, ORDER_STEP * np.arange(fine)))
    along = ((one.T * y) @ other).ravel()[: len(_GRID)]
    twice = ((one.T**2) @ other**2).ravel()[: len(_GRID)]
    # Sums of y cos, y sin, cos^2, sin^2 and sin cos: the normal equations of each order.
    yc, ys = np.real(along), np.imag(along)
    cc, ss, cs = (0.5 * x for x in (len(y) + np.real(twice), len(y) - np.real(twice), np.imag(twice)))
    determinant, power = cc * ss - cs**2, yc**2 * ss - 2.0 * yc * ys * cs + ys**2 * cc
    # On an even grid of angles sine and cosine of an order may be one column, or nothing.
    alike = determinant < ALIKE * len(y) ** 2
    power = np.where(alike, (yc**2 + ys**2) / len(y), power / np.where(alike, 1.0, determinant))
    return power / (y @ y)


def _peaks(power: Array, least: Array) -> list[int]:
    """Local maxima above `least`, in order; of those closer than `ALONE` to each other the highest."""
    middle = power[1:-1]
    places = 1 + np.flatnonzero((middle > power[:-2]) & (middle >= power[2:]) & (middle >= least[1:-1]))
    found: list[int] = []
    for k in places[np.argsort(-power[places], kind="stable")].tolist():
        if all(abs(k - other) >= ALONE for other in found):
            found.append(k)
    return sorted(found)


def _centre(grid: Array, power: Array, k: int) -> float:
    """The peak between the orders, by a parabola through its neighbours."""
    if not 0 < k < len(grid) - 1:
        return float(grid[k])
    left, top, right = power[k - 1 : k + 2]
    shift = 0.5 * (left - right) / (left - 2.0 * top + right)
    return float(grid[k] + shift * (grid[1] - grid[0]))


def _stretches(usable: Array, segment: Array, omega: Array) -> list[Array]:
    """Rows of each stretch in one direction without an unused row in between."""
    key = np.where(usable, 2 * segment + (omega > 0.0), -1)
    return [rows for rows in rows_of_each(key) if key[rows[0]] >= 0]
