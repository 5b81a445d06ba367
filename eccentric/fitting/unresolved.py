"""Rows where a torque repeats faster than a log can show.

The balance of a drive holds at every instant, but a log has its acceleration from sampled angles, which have
nothing above half of the log's rate. A torque that repeats faster, and the current that goes with it, alias
to slow ones that the acceleration never had: such rows neither show the torque nor contradict it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.fitting.expressions import evaluated
from eccentric.model import Term

__all__ = ["unresolved"]


def unresolved(
    terms: Sequence[Term], values: Mapping[str, float], omega_m: NDArray[np.float64], step_s: float
) -> list[tuple[tuple[str, ...], NDArray[np.bool_]]]:
    """The coefficients of terms that repeat faster than half of the log's rate, with the samples where.

    The fastest come first. Where a slower one is too fast, they are as well: each entry has the coefficients
    of those before it, and its samples (n,) are among theirs. A term without such a sample has none.

    values: of the parameters in `Term.per_turn`; omega_m: (n,) [rad/s]; step_s: of the log [s].
    """
    own: dict[float, list[str]] = {}
    for term in terms:
        if term.per_turn != 0:
            often = float(evaluated(sp.sympify(term.per_turn), values))
            own.setdefault(often, []).append(str(term.coefficient))
    found, names = [], []
    for often in sorted(own, reverse=True):
        names = [*names, *own[often]]
        mask = np.abs(omega_m) * often * step_s > np.pi
        if np.any(mask):
            found.append((tuple(names), mask))
    return found
