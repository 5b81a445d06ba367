"""The white noise of a sensor, from the signal itself, without model or filter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eccentric.signals.limits import CLEARLY_LESS, LEAST_MEANS, MEANS

__all__ = ["white_noise"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def white_noise(signal: Array, segment: NDArray[np.int64] | None = None) -> float:
    """Return the RMS of the white noise in a sampled signal (n,), in its unit.

    The fourth difference of a smooth signal vanishes; that of white noise has 70 times the variance. NaN
    marks samples to ignore; differences across the ends of a `segment` (n,) are omitted.
    What quantisation makes of a speed loop is fast, and cancels in means: of white noise, means of 2, 4 or 8
    samples leave what they should; if clearly less is left, that counts.
    """
    parts = np.zeros(len(signal), np.int64) if segment is None else segment
    found = _of_difference(signal, parts)
    for length in MEANS:
        means, same = _means(signal, parts, length)
        if len(means) < LEAST_MEANS:
            break
        left = _of_difference(means, same) * np.sqrt(length)
        if left < CLEARLY_LESS * found:
            found = float(left)
    return found


def _of_difference(signal: Array, segment: NDArray[np.int64]) -> float:
    difference = np.diff(signal, 4)
    difference = difference[np.isfinite(difference) & (np.diff(segment, 4) == 0)]
    return 1.4826 * float(np.median(np.abs(difference - np.median(difference)))) / np.sqrt(70.0)


def _means(signal: Array, segment: NDArray[np.int64], length: int) -> tuple[Array, NDArray[np.int64]]:
    """Means of `length` samples after another, NaN across the end of a segment, and their segments."""
    whole = len(signal) // length * length
    parts = segment[:whole].reshape(-1, length)
    means = signal[:whole].reshape(-1, length).mean(axis=1)
    return np.where(parts[:, 0] == parts[:, -1], means, np.nan), parts[:, 0]
