"""A balance of a log as a linear design: target = base @ coefficients + missing part of the model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.signals.rows import Rows

__all__ = ["BalanceDesign", "balance_design"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BalanceDesign:
    """One scalar balance on the rows of the search.

    name: 'mechanical' or 'electrical'; target (m,) and base (m, p) in N m on the motor side;
    lower (p,): lower bounds of the base coefficients; scale: reference of shares (RMS of the friction or of
    the drive torque, N m); samples (n, p): the base before averaging, for effects that change it.
    """

    name: str
    rows: Rows
    target: Array
    base: Array
    base_names: tuple[str, ...]
    lower: Array
    scale: float
    samples: Array


def balance_design(
    name: str,
    rows: Rows,
    target: Array,
    base: Array,
    base_names: tuple[str, ...],
    lower: Array,
    share_of: Array,
) -> BalanceDesign:
    """Return the design of a target (n,) and base (n, p) of samples; shares are of `share_of`'s RMS."""
    scale = float(np.sqrt(np.mean(rows.mean(share_of) ** 2)))
    return BalanceDesign(
        name, rows, rows.mean(target), rows.mean(base), base_names, np.asarray(lower, float), scale, base
    )
