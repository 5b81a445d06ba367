"""Means as windowed integrals, for logs too coarse to differentiate: integrate by parts instead.

A window carries the smooth weight psi(s) ~ (1 - s^2)^4 with s from -1 to 1, of integral one, which vanishes
with three derivatives at both ends.  So

    mean(x)              = integral of psi x dt
    mean second rate(x)  = integral of psi d2x/dt2 dt   =  integral of psi'' x dt

and a balance becomes one row per window, in its own unit, with the angle as it was logged.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from eccentric.core import InputError
from eccentric.signals.filters import rows_of_each
from eccentric.signals.limits import LEAST_WINDOW_ROWS, MOST_WINDOWS, WINDOW_GAP
from eccentric.signals.rows import Rows, blocks_of

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

_POWER = 4


def windows_by_parts(t: Array, segment: Integers, run: Integers, window_s: float) -> Rows:
    """Return a row for each window of `window_s`, centres half a window apart, none across a gap.

    t [s] (n,) may be uneven; weights are corrected so that constants, slopes and parabolas are exact. All
    rows belong to the training part.

    Raises InputError if a window holds fewer than 7 rows, or no window fits into the log.
    """
    if not window_s > 0.0:
        raise InputError("windows", "a length above 0 s", f"{window_s:g}")
    half = window_s / 2.0
    centres: list[Array] = []
    bounds: list[Integers] = []
    for rows in rows_of_each(segment):
        stretch = t[rows]
        count = int(np.floor((stretch[-1] - stretch[0] - window_s) / half + 1e-9)) + 1
        centre = stretch[0] + half + half * np.arange(max(count, 0))
        # The tolerance keeps rows that are on the edge up to rounding; their weight is negligible.
        ends = [np.searchsorted(stretch, centre + side * (half + 1e-9)) for side in (-1.0, 1.0)]
        centres.append(centre)
        bounds.append(rows[0] + np.stack(ends))
    middle = np.concatenate(centres)
    first, stop = np.concatenate(bounds, axis=1)
    sizes = stop - first
    if not len(middle):
        raise InputError("windows", f"a stretch of {window_s:g} s without a gap", "none")
    if sizes.min() < LEAST_WINDOW_ROWS:
        raise InputError("windows", f"{LEAST_WINDOW_ROWS} rows in {window_s:g} s", sizes.min(), plural=True)
    pointer = np.concatenate([[0], np.cumsum(sizes)])
    columns = np.empty(pointer[-1], dtype=np.int64)
    values = np.empty((2, pointer[-1]))
    for size in np.unique(sizes):
        same = np.flatnonzero(sizes == size)
        entries = pointer[same, None] + np.arange(size)
        columns[entries] = first[same, None] + np.arange(size)
        values[:, entries] = weights_by_parts(t[columns[entries]] - middle[same, None], half)
    shape = (len(middle), len(t))
    mean, second = (csr_array((row, columns, pointer), shape=shape) for row in values)
    every = np.ones(len(middle), dtype=bool)
    return Rows(
        t=middle,
        run=run[first],
        block=blocks_of(middle, segment[first], t),
        train=every,
        score=~every,
        weights=np.ones(len(middle)),
        description=f"windows of {window_s:.3g} s",
        operator=mean,
        rate_operator=second,
    )


def weights_by_parts(t: Array, half: float, rates: Sequence[int] = (0, 2), degree: int = 2) -> Array:
    """Return weights (rates, m, n) that make means over windows, and mean rates, of samples at times t.

    t (m, n) counts from the centres and may be uneven, half is half of the length. The mean is by psi, the
    first and the second rate by -psi' and psi''. They are exact for polynomials up to a degree: the sum over
    few samples is not the integral.
    """
    s = t / half
    bump = np.clip(1.0 - s * s, 0.0, None)
    p = _POWER
    every = (
        bump**p,
        2.0 * p * s * bump ** (p - 1) / half,
        2.0 * p * bump ** (p - 2) * ((2.0 * p - 1.0) * s * s - 1.0) / half**2,
    )
    curves = np.stack([every[rate] for rate in rates])
    area = np.gradient(t, axis=-1)
    curves *= area / np.sum(bump**p * area, axis=-1, keepdims=True)
    # Uncorrected, the quadrature error of psi'' would multiply the large constant part of an angle.
    powers = np.stack([s**k / math.factorial(k) for k in range(degree + 1)])
    moments = np.einsum("cmn,pmn->mcp", curves, powers)
    exact = np.zeros_like(moments)
    for place, rate in enumerate(rates):
        # A rate of s^k/k! is s^(k - rate)/(k - rate)!, of which the weight itself makes a mean.
        exact[:, place, rate] = 1.0 / half**rate
        if rate + 2 <= degree:
            exact[:, place, rate + 2] = moments[:, 0, 2] / half**rate
    gram = np.einsum("pmn,qmn,mn->mpq", powers, powers, bump**p)
    change = np.linalg.solve(gram, np.swapaxes(exact - moments, 1, 2))
    return curves + np.einsum("mpc,pmn,mn->cmn", change, powers, bump**p)


# Means with a Hann window, for logs that are sampled finely enough to be filtered and differentiated.
#
# A balance is integrated against a smooth window in the sense of the weak form.  Target and columns pass the
# same window, so its low pass cancels out, except that noise and quantisation above its band are removed.
# Windows are spaced by a quarter of their length.


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
