"""Means with a Hann window, for logs that are sampled finely enough to be filtered and differentiated.

A balance is integrated against a smooth window in the sense of the weak form.  Target and columns pass the
same window, so its low pass cancels out, except that noise and quantisation above its band are removed.
Windows are spaced by a quarter of their length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from eccentric.signals.limits import MOST_WINDOWS, WINDOW_GAP
from eccentric.signals.rows import Rows, blocks_of
from eccentric.signals.stretches import rows_of_each

__all__ = ["hann_windows"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


def hann_windows(time: Array, valid: Mask, segment: Integers, run: Integers, length_s: float) -> Rows:
    """Return a row for each Hann window whose samples are all valid, all of them for training.

    time (n,) [s], valid (n,), segment (n,) number of the stretch without gap, run (n,); stretches may differ
    in their sampling. Blocks do not extend across gaps.
    """
    label = np.unique(segment, return_inverse=True)[1]
    thinning = int(np.ceil(np.count_nonzero(valid) / MOST_WINDOWS))
    data, index, sizes = [np.empty(0)], [np.empty(0, int)], [np.empty(0, int)]
    for rows in rows_of_each(label):
        step = float(np.median(np.diff(time[rows]))) if len(rows) > 1 else length_s
        half = max(1, round(0.5 * length_s / step))
        kernel = np.hanning(2 * half + 1)[1:-1] if half > 1 else np.ones(1)
        reach = len(kernel) // 2
        centre = np.arange(reach, len(rows) - reach, max(1, half // 2, thinning))
        bad = np.r_[0, np.cumsum(~np.asarray(valid[rows], bool))]
        whole = bad[centre + reach + 1] == bad[centre - reach]
        lasts = time[rows[centre + reach]] - time[rows[centre - reach]]
        whole &= lasts < WINDOW_GAP * 2 * reach * step + step
        centre = centre[whole]
        index.append((rows[centre, None] + np.arange(-reach, reach + 1)).ravel())
        data.append(np.tile(kernel / kernel.sum(), len(centre)))
        sizes.append(np.full(len(centre), len(kernel)))
    width = np.concatenate(sizes)
    pointer = np.r_[0, np.cumsum(width)]
    columns = np.concatenate(index)
    centre = columns[pointer[:-1] + width // 2]
    every = np.ones(len(width), dtype=bool)
    return Rows(
        t=time[centre],
        run=run[centre],
        block=blocks_of(time[centre], label[centre], time),
        train=every,
        score=~every,
        weights=np.ones(len(width)),
        description=f"windows of {length_s:.3g} s",
        operator=csr_array((np.concatenate(data), columns, pointer), shape=(len(width), len(time))),
    )
