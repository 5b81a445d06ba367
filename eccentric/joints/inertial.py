"""The inertial parameters of a chain as numbers, and of a body as one matrix; `letters_of` names them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eccentric.model import Chain

__all__ = ["COUNT", "matrix_of", "moments_of", "parameters_of"]

Array = NDArray[np.float64]

_UPPER = [(a, b) for a in range(3) for b in range(a, 3)]
COUNT = 10
"""Inertial parameters of a body: mass, three first moments, six second moments."""


def moments_of(chain: Chain) -> Array:
    """The inertial parameters of a chain of numbers, payload included, shape (joints, 10)."""
    found = []
    for place, body in enumerate(chain.bodies):
        moments = body.moments
        if chain.payload is not None and place == len(chain.bodies) - 1:
            moments = moments + chain.payload.moments
        second = moments.second
        entries = [second[a, b] for a, b in _UPPER]
        found.append([float(x) for x in (moments.mass, *moments.first, *entries)])
    return np.array(found)


def matrix_of(parameters: Array) -> Array:
    """The moments of mass of a body as one matrix (4, 4): [[Sigma, h], [h, m]], positive for any mass there.

    Args:
        parameters: (..., 10).
    """
    p = np.asarray(parameters, float)
    full = np.empty((*p.shape[:-1], 4, 4))
    full[..., 3, 3] = p[..., 0]
    full[..., :3, 3] = full[..., 3, :3] = p[..., 1:4]
    for k, (row, column) in enumerate(_UPPER):
        full[..., row, column] = full[..., column, row] = p[..., 4 + k]
    return full


def parameters_of(matrix: Array) -> Array:
    """The reverse of `matrix_of`: (..., 4, 4) to (..., 10)."""
    first = (matrix[..., a, 3] for a in range(3))
    return np.stack([matrix[..., 3, 3], *first, *(matrix[..., a, b] for a, b in _UPPER)], axis=-1)
