"""A balance of a log as a linear design: target = columns @ coefficients + missing part of the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.estimation import Coefficient, Design, rms
from eccentric.signals.rows import Rows

__all__ = ["BalanceDesign", "balance_design"]

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class BalanceDesign(Design):
    """The design of one scalar balance on the rows of the search, in N m on the motor side.

    Its columns are the base, which every model has.
    name: 'mechanical' or 'electrical'; scale: reference of shares (RMS of the friction or of the drive
    torque, N m); samples (n, p): the base before averaging, for effects that change it.
    """

    name: str
    rows: Rows
    scale: float
    samples: Array


def balance_design(
    name: str, rows: Rows, coefficients: Sequence[Coefficient], target: Array, base: Array, share_of: Array
) -> BalanceDesign:
    """Return the design of a target (n,) and base (n, p) of samples; shares are of `share_of`'s RMS."""
    return BalanceDesign(
        tuple(coefficients),
        rows.mean(target),
        rows.mean(base),
        rows.train,
        rows.weights,
        name=name,
        rows=rows,
        scale=rms(rows.mean(share_of)),
        samples=base,
    )
