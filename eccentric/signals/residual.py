"""The two balances of a log as linear designs: target = base @ coefficients + what the model lacks.

Sample-wise columns become rows by one smooth window (Hann, in the sense of the weak form: both sides of the
balance are integrated against it), taken at a spacing of a quarter of its length.  Target and columns pass
the same window, so its low pass cancels out; what it does not see is noise and quantisation above its band.
A row is used where every sample of its window is: moving, clear of reversals, in the training part, in one
run.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from eccentric.errors import InputError
from eccentric.signals.stretches import rows_of_each

__all__ = ["BalanceDesign", "Windows", "make_balance_design", "make_windows"]

Array = np.ndarray

BLOCK_S = 1.0
"""Windows this far apart count as independent, s."""
MOST_ROWS = 8000
"""Windows of a long log are spaced wider, so that about so many remain."""


@dataclass(frozen=True)
class Windows:
    """Sparse row operator: (rows, samples) weights, with the block and the centre time of each row.

    `smooth`: a filter over the samples (samples, k) that comes first. `independent`: rows share neither
    samples nor what happens between them, as means of whole runs.
    """

    weights: csr_matrix
    block: Array
    time: Array
    independent: bool = False
    smooth: Callable[[Array], Array] | None = None

    def __call__(self, columns: Array) -> Array:
        """Columns (samples, k) or (samples,) to rows."""
        return self.weights @ (columns if self.smooth is None else self.smooth(columns))


@dataclass(frozen=True)
class BalanceDesign:
    """One scalar balance on the training rows.

    name: 'mechanical' or 'electrical'; target (rows,) and base (rows, p) in N m on the motor side;
    lower (p,): least values of the base coefficients; scale: what shares are taken of (RMS of the friction or
    of the drive torque, N m); samples (n, p): the base before its windows, for effects that change it.
    """

    name: str
    windows: Windows
    target: Array
    base: Array
    base_names: tuple[str, ...]
    lower: Array
    scale: float
    samples: Array


def make_windows(
    time: Array,
    valid: Array,
    segment: Array | None = None,
    length_s: float = 0.064,
    least: int = 50,
) -> Windows:
    """Hann windows whose samples are all valid; blocks are stretches of `BLOCK_S` of time within one run.

    time (n,) [s], valid (n,) bool, segment (n,) number of the stretch without gap; stretches may differ in
    their sampling, and windows are spaced by a quarter of their length. InputError if fewer than `least` rows
    remain.
    """
    label = np.zeros(len(time), int) if segment is None else np.unique(segment, return_inverse=True)[1]
    thinning = int(np.ceil(np.count_nonzero(valid) / MOST_ROWS))
    data, index, sizes = [np.empty(0)], [np.empty(0, int)], [np.empty(0, int)]
    for rows in rows_of_each(label):
        step = float(np.median(np.diff(time[rows]))) if len(rows) > 1 else length_s
        half = max(1, round(0.5 * length_s / step))
        kernel = np.hanning(2 * half + 1)[1:-1] if half > 1 else np.ones(1)
        reach = len(kernel) // 2
        centre = np.arange(reach, len(rows) - reach, max(1, half // 2, thinning))
        bad = np.r_[0, np.cumsum(~np.asarray(valid[rows], bool))]
        whole = bad[centre + reach + 1] == bad[centre - reach]
        whole &= time[rows[centre + reach]] - time[rows[centre - reach]] < 1.5 * 2 * reach * step + step
        centre = centre[whole]
        index.append((rows[centre, None] + np.arange(-reach, reach + 1)).ravel())
        data.append(np.tile(kernel / kernel.sum(), len(centre)))
        sizes.append(np.full(len(centre), len(kernel)))
    width = np.concatenate(sizes)
    if len(width) < least:
        raise InputError(
            f"moving training samples: at least {least} windows of {length_s:.3g} s required,"
            f" {len(width)} found"
        )
    pointer = np.r_[0, np.cumsum(width)]
    columns = np.concatenate(index)
    weights = csr_matrix((np.concatenate(data), columns, pointer), shape=(len(width), len(time)))
    centre = columns[pointer[:-1] + width // 2]
    key = label[centre] * (int((time.max() - time.min()) / BLOCK_S) + 2) + (
        (time[centre] - time.min()) / BLOCK_S
    ).astype(int)
    changes = np.r_[False, np.diff(key) != 0]
    return Windows(weights, np.cumsum(changes), time[centre])


def make_balance_design(
    name: str,
    windows: Windows,
    target: Array,
    base: Array,
    base_names: tuple[str, ...],
    lower: Array,
    share_of: Array,
) -> BalanceDesign:
    """Sample-wise target (n,) and base (n, p) to a design; shares are of the RMS of `share_of` (n,)."""
    scale = float(np.sqrt(np.mean(windows(share_of) ** 2)))
    return BalanceDesign(
        name, windows, windows(target), windows(base), base_names, np.asarray(lower, float), scale, base
    )
