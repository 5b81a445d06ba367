"""The white noise of a sensor, from the signal itself, without model or filter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["white_noise"]

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def white_noise(signal: Array, segment: NDArray[np.int64] | None = None) -> float:
    """Return the RMS of the white noise in a sampled signal (n,), in its unit.

    The fourth difference of a smooth signal vanishes; that of white noise has 70 times the variance. NaN
    marks samples to ignore; differences across the ends of a `segment` (n,) are omitted.
    """
    difference = np.diff(signal, 4)
    seen = np.isfinite(difference)
    if segment is not None:
        seen &= np.diff(segment, 4) == 0
    difference = difference[seen]
    return 1.4826 * float(np.median(np.abs(difference - np.median(difference)))) / np.sqrt(70.0)
