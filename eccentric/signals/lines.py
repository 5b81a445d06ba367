"""Ripple of a high order: whole numbers of cycles per turn of the motor that stand out of a drive's spectrum.

Cogging repeats as often per turn as slots and poles have a common multiple: 12 slots and 14 poles make 84.
The drive as logged is summed in bins of the angle, without what follows the speed and the low orders; a line
is the power of an order over that of those around it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import median_filter

from eccentric.signals import limits

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

TURN = 2.0 * np.pi


def standing_lines(
    theta: Array, omega: Array, drive: Array, step_s: float, mu: float | None
) -> tuple[int, ...]:
    """The orders above `LOW_ORDERS` that stand out, the strongest first; none in less than a turn.

    Args:
        theta, omega: angle of the motor [rad] from one zero and its velocity [rad/s] on moving rows (n,).
        drive: what measures the torque, as logged (n,), in any unit.
        step_s: time between rows [s]; orders up to 0.4 of the rows of a turn at the median speed are seen.
        mu: speed of the link over that of the motor, None where it is unknown.
    """
    if not len(theta) or np.ptp(theta) < limits.LEAST_TURNS * TURN:
        return ()
    highest = min(
        limits.HIGHEST_LINE, int(limits.PER_TURN * TURN / (float(np.median(np.abs(omega))) * step_s))
    )
    if highest <= limits.LOW_ORDERS:
        return ()
    link = [n * mu for n in range(1, limits.LOW_ORDERS_OF_THE_LINK + 1)] if mu not in (None, 1.0) else []
    orders = [*range(1, limits.LOW_ORDERS + 1), *link]
    phases = np.outer(theta, orders)
    way = np.sign(omega)
    rise = np.gradient(omega)
    known = np.column_stack([np.ones_like(way), way, omega, rise, np.cos(phases), np.sin(phases)])
    rest = drive - known @ np.linalg.lstsq(known, drive, rcond=None)[0]
    count = limits.BINS_PER_CYCLE * limits.HIGHEST_LINE
    bins = np.bincount((theta / TURN % 1.0 * count).astype(int) % count, rest, count)
    # Of white noise, the power has the mean 1.
    power = np.abs(np.fft.rfft(bins)[: highest + 1]) ** 2 / max(float(rest @ rest), 1e-300)
    floor = np.maximum(median_filter(power, limits.AROUND_A_LINE, mode="nearest") / np.log(2.0), 1.0)
    share = 2.0 * power / len(rest)
    found = np.flatnonzero((power > limits.STANDS_OUT * floor) & (share > limits.LEAST_LINE_SHARE))
    found = found[found > limits.LOW_ORDERS]
    strongest = found[np.argsort(-power[found], kind="stable")][: limits.MOST_LINES]
    return tuple(int(n) for n in strongest if _keeps_phase(theta, rest, int(n)))


def _keeps_phase(theta: Array, rest: Array, order: int) -> bool:
    """Whether the parts of a log agree on the phase of a line, as what is fixed to the motor does.

    What the motion itself leaves in the drive has another phase in each part. Of eight parts without a line,
    the square of their sum is an eighth of eight times the sum of their squares.
    """
    waves = rest * np.exp(-1j * order * theta)
    parts = np.array([np.sum(part) for part in np.array_split(waves, limits.PARTS_OF_A_LOG)])
    together = float(abs(np.sum(parts)) ** 2)
    return together > limits.IN_PHASE * limits.PARTS_OF_A_LOG * float(np.sum(np.abs(parts) ** 2))
