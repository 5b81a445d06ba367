"""The white noise of a sensor, from the signal itself, without model or filter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eccentric.signals.limits import CLEARLY_LESS, LEAST_OF_MEANS, MEANS

__all__ = ["white_noise"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def white_noise(signal: Array, segment: NDArray[np.int64] | None = None) -> float:
    """Return the RMS of the white noise in a sampled signal (n,), in its unit.

    The fourth difference of a smooth signal vanishes; that of white noise has 70 times the variance. NaN
    marks samples to ignore; differences across the ends of a `segment` (n,) are omitted.
    What a speed loop makes of the steps of its encoder is fast, and cancels in means. Means of 2, 4 and 8
    samples show white noise of the same size: the least size is returned where it is clearly smaller.
    """
    parts = np.zeros(len(signal), np.int64) if segment is None else segment
    found = _of(_differences(signal, parts))
    for length in MEANS:
        left = _differences(*_means(signal, parts, length))
        if len(left) < LEAST_OF_MEANS:
            break
        size = _of(left) * float(np.sqrt(length))
        if size < CLEARLY_LESS * found:
            found = size
    return found


def _differences(signal: Array, segment: NDArray[np.int64]) -> Array:
    """The fourth differences within a segment that have a value."""
    difference = np.diff(signal, 4)
    return difference[np.isfinite(difference) & (segment[4:] == segment[:-4])]


def _of(difference: Array) -> float:
    """The RMS of the white noise that has these fourth differences."""
    return 1.4826 * float(np.median(np.abs(difference - np.median(difference)))) / float(np.sqrt(70.0))


def _means(signal: Array, segment: NDArray[np.int64], length: int) -> tuple[Array, NDArray[np.int64]]:
    """Means of successive groups of `length` samples, NaN across the end of a segment, and their segments."""
    whole = len(signal) // length * length
    parts = segment[:whole].reshape(-1, length)
    means = signal[:whole].reshape(-1, length).mean(axis=1)
    return np.where(parts[:, 0] == parts[:, -1], means, np.nan), parts[:, 0]
