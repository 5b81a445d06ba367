"""Orders of the motor that stand out in a residual: its spectrum over the motor angle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import median_filter

from eccentric.effects import HIGHEST_ORDER
from eccentric.search.limits import (
    AROUND_A_PEAK,
    BINS_PER_TURN,
    FEW_TURNS,
    MOST_PEAKS,
    MOST_TURNS,
    PADDED,
    STANDS_OUT,
)

__all__ = ["standing_orders"]

Array = np.ndarray


def standing_orders(
    theta_m: Array, omega_m: Array, residual: Array, harmonics: Sequence[float], gravity: Sequence[float]
) -> tuple[float, tuple[float, ...]]:
    """The range of the motor angle in turns, and the orders of friction that stand out, the strongest first.

    Harmonics of motor and link are taken out, since on a short log they spread over the spectrum. That leaves
    nothing within a cycle of each, which over a few turns is everywhere. So the strongest order of all comes
    first, a harmonic or not: only the first orders of the link, which gravity leaves, are taken out for it.
    Over a few turns peaks are so wide that what is taken out shifts them, and each order is fitted beside it.

    Args:
        theta_m, omega_m: motor angle [rad], from one zero, and velocity [rad/s] (samples,).
        residual: what the model does not explain (samples,) [N m].
        harmonics: orders of motor and link.
        gravity: those of them that gravity leaves where its load is not quite the model's; friction at them
            is taken out as well.
    """
    if not len(theta_m):
        return 0.0, ()
    turns = _turns(theta_m)
    if not 1.0 < turns < MOST_TURNS:
        return turns, ()
    if turns < FEW_TURNS:
        strongest = _best_fit(theta_m, omega_m, residual, gravity)
    else:
        orders, power = _spectrum(theta_m, omega_m, residual, gravity)
        strongest = _peaks(orders, power, turns, np.ones(len(orders), bool))[:1]
    orders, power = _spectrum(theta_m, omega_m, residual, harmonics)
    # Within a cycle of a harmonic there is nothing left, not even noise, and it would lower the floor.
    beside = np.min(np.abs(orders[:, None] - np.asarray(harmonics)), axis=1) > 1.0 / turns
    others = _peaks(orders, power, turns, beside)
    return turns, (*strongest, *others)


def _turns(theta_m: Array) -> float:
    return float(np.ptp(theta_m)) / (2.0 * np.pi)


def _spectrum(
    theta_m: Array, omega_m: Array, residual: Array, without: Sequence[float]
) -> tuple[Array, Array]:
    """Orders, and the power of friction at each over that of white noise.

    Friction at an order nu is c cos(nu theta_m) + s sin(nu theta_m) against the motion, whatever the time:
    the residual times the direction is put into bins of the angle, and their sums have one spectrum. A peak
    is as narrow as the range of the angle is long, so that neighbouring orders stay apart.
    """
    angle = (theta_m - np.min(theta_m)) / (2.0 * np.pi)
    known = _known(theta_m, omega_m, without)
    against = np.sign(omega_m) * (residual - known @ np.linalg.lstsq(known, residual, rcond=None)[0])
    bins = np.bincount((angle * BINS_PER_TURN).astype(int), against)
    power = np.abs(np.fft.rfft(bins, PADDED * len(bins))) ** 2
    return np.arange(len(power)) * BINS_PER_TURN / (PADDED * len(bins)), power / np.sum(against**2)


def _best_fit(theta_m: Array, omega_m: Array, residual: Array, without: Sequence[float]) -> list[float]:
    """The order whose friction takes out most beside what is taken out, if it stands out of what is left.

    It has a cycle or more over the log. The residual is averaged in bins of the angle, either way by itself:
    at a sampled time the motion may always be at the same few angles.
    """
    turns, way = _turns(theta_m), np.sign(omega_m)
    place = ((theta_m - np.min(theta_m)) / (2.0 * np.pi) * BINS_PER_TURN).astype(int) * 2 + (way > 0.0)
    number = np.bincount(place)
    there = number > 0
    angle, speed, mean = (np.bincount(place, x)[there] / number[there] for x in (theta_m, omega_m, residual))
    weight, way = np.sqrt(number[there])[:, None], np.where(np.flatnonzero(there) % 2, 1.0, -1.0)[:, None]
    orders = np.arange(PADDED, HIGHEST_ORDER * PADDED * turns) / (PADDED * turns)
    waves = [weight * way * np.column_stack([np.cos(nu * angle), np.sin(nu * angle)]) for nu in orders]
    known, target = weight * _known(angle, speed, without), weight[:, 0] * mean
    gains, _ = _gains(waves, known, target)
    best = int(np.argmax(gains))
    # A wide peak has no floor beside it: that of the spectrum without it is taken.
    rest, noise = _gains(waves, np.hstack([known, waves[best]]), target)
    around = rest[np.abs(orders - orders[best]) <= 0.5 * AROUND_A_PEAK]
    return [float(orders[best])] if gains[best] > STANDS_OUT * max(np.median(around), 2.0 * noise) else []


def _gains(waves: Sequence[Array], known: Array, target: Array) -> tuple[Array, float]:
    """The square sum that each pair of waves takes out of a target (n,) beside what is known (n, k).

    And the mean square of what that leaves, which is white noise if nothing else is there.
    """
    basis = np.linalg.qr(known)[0]
    left = target - basis @ (basis.T @ target)
    found = np.zeros(len(waves))
    for k, pair in enumerate(waves):
        own = pair - basis @ (basis.T @ pair)
        found[k] = left @ own @ np.linalg.lstsq(own, left, rcond=None)[0]
    return found, float(left @ left) / max(len(left) - known.shape[1], 1)


def _known(theta_m: Array, omega_m: Array, without: Sequence[float]) -> Array:
    """Offset, Coulomb and viscous friction, and friction and torque at some orders (samples, k)."""
    way = np.sign(omega_m)
    waves = [wave(order * theta_m) for order in without for wave in (np.cos, np.sin)]
    return np.column_stack([way, omega_m, np.ones_like(way), *waves, *(wave * way for wave in waves)])


def _peaks(orders: Array, power: Array, turns: float, where: Array) -> list[float]:
    """The orders that stand out of those around them, and of white noise; the strongest first."""
    one = round(1.0 / orders[1])
    orders, power = orders[where], power[where]
    around = median_filter(power, 2 * round(0.5 * AROUND_A_PEAK * one) + 1, mode="nearest")
    found: list[float] = []
    rest = np.where(power > STANDS_OUT * np.maximum(around, 1.0), power, 0.0)
    while len(found) < MOST_PEAKS and np.any(rest):
        k = int(np.argmax(rest))
        found.append(float(orders[k]))
        rest[np.abs(orders - orders[k]) < 2.0 / turns] = 0.0
    return found
