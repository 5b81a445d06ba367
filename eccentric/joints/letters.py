"""A chain whose bodies are letters: ten for each, linear in the torques; and the numbers of a given chain."""

from __future__ import annotations

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.model import Chain, Moments, Quantity, quantity

__all__ = ["COUNT", "letters_of", "matrix_of", "moments_of", "parameters_of", "with_letters"]

Array = NDArray[np.float64]

_AXES = "xyz"
_PAIRS = ("xx", "xy", "xz", "yy", "yz", "zz")
_UPPER = [(a, b) for a in range(3) for b in range(a, 3)]
COUNT = 10
"""Inertial parameters of a body: mass, three first moments, six second moments."""


def letters_of(j: int) -> tuple[Quantity, ...]:
    """The inertial parameters of body j about the origin of its joint's frame: mass, h, Sigma.

    The names and the order are those of the emitted `inertial_regressor`.
    """
    body = f"of body {j}"
    return (
        quantity(f"mass_{j}", "kg", f"mass {body}", "", "real", "0", letter=f"m_{j}"),
        *(quantity(f"h_{j}_{a}", "kg m", f"first moment {body}, {a}", "", "real", "0") for a in _AXES),
        *(
            quantity(f"Sigma_{j}_{p}", "kg m^2", f"second moment {body}, {p}", "", "real", "0")
            for p in _PAIRS
        ),
    )


def with_letters(chain: Chain) -> Chain:
    """The same chain with a letter for every inertial parameter; the payload is part of the last body."""
    every = [tuple(_renamed(q) for q in letters_of(j)) for j in range(len(chain.joints))]
    bodies = [_moments([q.symbol for q in own]) for own in every]
    parameters = [q for own in every for q in own]
    return Chain(f"{chain.name}_letters", chain.joints, bodies, chain.gravity, None, parameters)


def _renamed(q: Quantity) -> Quantity:
    """A parameter beside the recursion's own quantity of that name."""
    return quantity(f"{q.name}_given", q.unit, q.meaning, "", "real", "0")


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


def _moments(x: list[sp.Symbol]) -> Moments:
    second = sp.ImmutableMatrix([[x[4], x[5], x[6]], [x[5], x[7], x[8]], [x[6], x[8], x[9]]])
    return Moments(x[0], sp.ImmutableMatrix(x[1:4]), second)
