"""Sums of a design as triangles: R of the QR decomposition of its rows [X y].

R'R are the normal equations, but R keeps the digits that these lose: its condition is that of X, not its
square. Triangles of parts stack, and the R of the stack is that of the whole, in any order up to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.fleet.limits import LEAST_PART, MEMBER_PART

__all__ = ["Solved", "dependent", "merged", "solve", "triangles"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def triangles(rows: Array, block: Integers, count: int) -> Array:
    """Triangles (count, k, k) of rows (m, k), those of one block together; blocks (m,) do not decrease."""
    starts = np.searchsorted(block, np.arange(count + 1))
    longest = int(np.max(np.diff(starts), initial=0))
    width = rows.shape[1]
    padded = np.zeros((count, max(longest, width), width))
    padded[block, np.arange(len(rows)) - starts[block]] = rows
    return _upright(np.asarray(np.linalg.qr(padded, mode="r")))


def merged(stack: Array) -> Array:
    """The triangle (k, k) of several (..., k, k)."""
    return _upright(np.asarray(np.linalg.qr(stack.reshape(-1, stack.shape[-1]), mode="r")))


def _upright(triangle: Array) -> Array:
    """The same with a diagonal that is not negative: then it is unique, whatever the order of its rows."""
    sign = np.where(np.diagonal(triangle, axis1=-2, axis2=-1) < 0.0, -1.0, 1.0)
    return triangle * sign[..., None]


def dependent(triangle: Array) -> list[int]:
    """Columns of X that the rest makes up, or that are zero; empty if all can be told apart."""
    x = triangle[:, :-1]
    size = np.linalg.norm(x, axis=0)
    if len(zero := np.flatnonzero(size <= LEAST_PART * np.max(size, initial=0.0) * 1e-6)):
        return zero.tolist()
    found = np.linalg.svd(x / size, full_matrices=False)
    weak = found.Vh[found.S < LEAST_PART * found.S[0]]
    if not len(weak):
        return []
    return np.flatnonzero(np.max(np.abs(weak), axis=0) > MEMBER_PART).tolist()


@dataclass(frozen=True)
class Solved:
    """Values (k,), their covariance (k, k) and its degrees of freedom."""

    values: Array
    covariance: Array
    freedom: int


def solve(stack: Array) -> Solved:
    """Least squares over triangles (b, k + 1, k + 1), with the covariance from how the blocks differ.

    Rows within a block may depend on each other in any way (a sandwich over blocks; Liang and Zeger, 1986).
    """
    whole = merged(stack)
    k = whole.shape[0] - 1
    values = np.linalg.solve(whole[:k, :k], whole[:k, k])
    x, y = stack[:, :, :-1], stack[:, :, -1]
    score = np.einsum("bij,bi->bj", x, y - x @ values)
    held = int(np.count_nonzero(np.any(x != 0.0, axis=(1, 2))))
    freedom = max(held - k, 1)
    # R^-1 R^-T is the inverse of X'X.
    half = np.linalg.solve(whole[:k, :k].T, score.T)
    spread = np.linalg.solve(whole[:k, :k], half)
    return Solved(np.asarray(values, float), spread @ spread.T * (held / freedom), freedom)
