"""Base parameters: the combinations of inertial parameters that the torques of a log depend on.

Of a serial arm, many inertial parameters act only in sums, and some not at all. A QR decomposition with
pivoting of the regressor over the log takes the columns one by one, each time the one of which most is left;
the others are combinations of those taken.

Reference: M. Gautier, "Numerical calculation of the base inertial parameters of robots", J. Robotic Systems
8(4), 1991.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr, solve_triangular

from eccentric.joints.limits import LEAST_SHARE_IN_SUM, RANK
from eccentric.model import letters_of

__all__ = ["BaseParameters", "base_of", "names_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BaseParameters:
    """Which columns of a regressor span it.

    Attributes:
        chosen: places of the columns, in the order of the regressor (r,).
        sums: (r, p): base parameters = sums @ inertial parameters; the columns of `chosen` are unit vectors.
    """

    chosen: tuple[int, ...]
    sums: Array

    def words(self, names: Sequence[str]) -> list[str]:
        """Each base parameter as the sum that it is."""
        return [
            " ".join(
                _part(float(x), name, first=k == 0)
                for k, (x, name) in enumerate(
                    sorted(
                        ((x, n) for x, n in zip(row, names, strict=True) if abs(x) > LEAST_SHARE_IN_SUM),
                        key=lambda part: part[1] != names[place],
                    )
                )
            )
            for place, row in zip(self.chosen, self.sums, strict=True)
        ]


def base_of(regressor: Array) -> BaseParameters:
    """The base parameters of a regressor (rows, p); rows may be weighted.

    Columns count by their size, since units differ: each is divided by its length.
    """
    size = np.linalg.norm(regressor, axis=0)
    there = np.flatnonzero(size > RANK * size.max(initial=0.0) * np.finfo(float).eps ** 0.5)
    if not len(there):
        return BaseParameters((), np.zeros((0, regressor.shape[1])))
    triangle = np.linalg.qr(regressor[:, there] / size[there], mode="r")
    r, order = qr(triangle, mode="r", pivoting=True)
    diagonal = np.abs(np.diag(r))
    rank = int(np.count_nonzero(diagonal > RANK * diagonal[0]))
    # What is left of a column in terms of those taken, back in their own units.
    sums = np.zeros((rank, regressor.shape[1]))
    sums[np.arange(rank), there[order[:rank]]] = 1.0
    if rank < len(order):
        others = solve_triangular(r[:rank, :rank], r[:rank, rank:])
        scale = size[there[order[rank:]]][None, :] / size[there[order[:rank]]][:, None]
        sums[:, there[order[rank:]]] = others * scale
    taken = np.argsort(there[order[:rank]])
    return BaseParameters(tuple(int(k) for k in np.sort(there[order[:rank]])), sums[taken])


def names_of(joints: int) -> list[str]:
    """The names of all inertial parameters, in the order of the regressor."""
    return [q.name for j in range(joints) for q in letters_of(j)]


def _part(x: float, name: str, *, first: bool) -> str:
    sign = ("-" if x < 0.0 else "") if first else ("- " if x < 0.0 else "+ ")
    return f"{sign}{name}" if abs(abs(x) - 1.0) < LEAST_SHARE_IN_SUM else f"{sign}{abs(x):.4g} {name}"
