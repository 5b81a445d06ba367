"""Weighted linear least squares with bounds, and the rank of its design."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from eccentric.errors import InputError
from eccentric.estimation.limits import BLOCK_ROWS, LEAST_PART, MEMBER_PART, ROUNDING

if TYPE_CHECKING:
    from collections.abc import Sequence

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Linear:
    """Coefficients (k,), and for each whether its lower (-1), upper (1) or no (0) bound is active."""

    coefficients: Array
    active: NDArray[np.int64]


def bounded(design: Array, target: Array, lower: Array, upper: Array) -> Linear:
    """Minimise |design @ x - target| over lower <= x <= upper; design (m, k), others (m,) and (k,).

    The bounded-variable algorithm of Stark and Parker (1995) is exact: a bound is active or it is not.
    """
    size = np.linalg.norm(design, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    triangle = _triangle(np.column_stack([design / size, target]))
    free = bool(np.all(np.isinf(lower)) and np.all(np.isinf(upper)))
    if free:
        scaled = np.linalg.lstsq(triangle[:, :-1], triangle[:, -1], rcond=None)[0]
        return Linear(scaled / size, np.zeros(len(scaled), dtype=np.int64))
    found = lsq_linear(
        triangle[:, :-1], triangle[:, -1], (lower * size, upper * size), method="bvls", tol=ROUNDING
    )
    return Linear(found.x / size, np.asarray(found.active_mask, dtype=np.int64))


def _triangle(rows: Array) -> Array:
    """Return R (k, k) of the QR decomposition of rows (m, k): it has the same least squares as all of them.

    By blocks, then once more for the blocks' triangles: a single tall decomposition uses threads that cost
    more than they gain, and a search needs hundreds.
    """
    count = rows.shape[1]
    blocks = -(-len(rows) // BLOCK_ROWS)
    padded = np.zeros((blocks * BLOCK_ROWS, count))
    padded[: len(rows)] = rows
    stack = np.asarray(np.linalg.qr(padded.reshape(blocks, BLOCK_ROWS, count), mode="r"))
    return np.asarray(np.linalg.qr(stack.reshape(-1, count), mode="r"))


def require_rank(design: Array, names: Sequence[str], where: str) -> None:
    """Raise InputError, naming the coefficients that cannot be separated, if columns are dependent.

    `where` opens the message: the log.
    """
    zero = [name for name, column in zip(names, design.T, strict=True) if not np.any(column)]
    if zero:
        raise InputError(
            f"{where}: {', '.join(zero)} cannot be identified: nothing in the log depends on it"
            " (no unbalance, or no rows in one direction)"
        )
    sizes = np.linalg.svd(design / np.linalg.norm(design, axis=0), full_matrices=False)
    weak = sizes.Vh[sizes.S < LEAST_PART * sizes.S[0]]
    if len(weak):
        members = [
            n for n, part in zip(names, np.max(np.abs(weak), axis=0), strict=True) if part > MEMBER_PART
        ]
        raise InputError(
            f"{where}: {', '.join(members)} cannot be separated on this log: more different speeds"
            " (or angles, in both directions) are required"
        )
