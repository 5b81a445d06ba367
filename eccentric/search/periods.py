"""Orders of the motor that stand out in a residual: its spectrum over the motor angle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import median_filter

from eccentric.search.limits import (
    AROUND_A_PEAK,
    BINS_PER_TURN,
    MOST_PEAKS,
    MOST_TURNS,
    PADDED,
    STANDS_OUT,
)

__all__ = ["standing_orders"]

Array = np.ndarray


def standing_orders(
    theta_m: Array, omega_m: Array, residual: Array, harmonics: Sequence[float]
) -> tuple[float, tuple[float, ...]]:
    """The range of the motor angle in turns, and the orders of friction that stand out, the strongest first.

    Friction at an order nu is c cos(nu theta_m) + s sin(nu theta_m) against the motion, whatever the time:
    the residual times the direction is put into bins of the angle, and their sums have one spectrum. A peak
    is as narrow as the range of the angle is long, so that neighbouring orders stay apart.

    Args:
        theta_m, omega_m: motor angle [rad], from one zero, and velocity [rad/s] (samples,).
        residual: what the model does not explain (samples,) [N m].
        harmonics: orders of motor and link, which are taken out first, with the motion and regardless of it:
            on a short log they spread over the spectrum.
    """
    if not len(theta_m):
        return 0.0, ()
    angle = (theta_m - np.min(theta_m)) / (2.0 * np.pi)
    turns = float(np.max(angle))
    if not 1.0 < turns < MOST_TURNS:
        return turns, ()
    way = np.sign(omega_m)
    waves = [wave(order * theta_m) for order in harmonics for wave in (np.cos, np.sin)]
    known = np.column_stack([way, omega_m, np.ones_like(way), *waves, *(wave * way for wave in waves)])
    against = way * (residual - known @ np.linalg.lstsq(known, residual, rcond=None)[0])
    bins = np.bincount((angle * BINS_PER_TURN).astype(int), against)
    power = np.abs(np.fft.rfft(bins, PADDED * len(bins))) ** 2
    one = PADDED * len(bins) / BINS_PER_TURN  # steps of the spectrum per order
    # Within a cycle of a harmonic there is nothing left, not even noise, and it would lower the floor, which
    # is at least that of white noise.
    orders = np.arange(len(power)) / one
    beside = np.min(np.abs(orders[:, None] - np.asarray(harmonics)), axis=1) > 1.0 / turns
    orders, power = orders[beside], power[beside]
    around = median_filter(power, 2 * round(0.5 * AROUND_A_PEAK * one) + 1, mode="nearest")
    floor = np.maximum(around, np.sum(against**2))
    found: list[float] = []
    rest = np.where(power > STANDS_OUT * floor, power, 0.0)
    while len(found) < MOST_PEAKS and np.any(rest):
        k = int(np.argmax(rest))
        found.append(float(orders[k]))
        rest[np.abs(orders - orders[k]) < 2.0 / turns] = 0.0
    return turns, tuple(found)
