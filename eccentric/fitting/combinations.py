"""Which letters of the paper a log identifies, and which it shows only in combination.

Every column of the problem has a coefficient that is an expression in the letters.  A letter is identifiable
if its direction is in the row space of the Jacobian of those expressions: then no change of the other letters
compensates for a change of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.fitting.columns import as_text
from eccentric.fitting.letters import following_letters

if TYPE_CHECKING:
    from eccentric.estimation import Estimate, Spread
    from eccentric.fitting.problem import Problem

Array = NDArray[np.float64]


def identified_letters(problem: Problem) -> tuple[list[str], list[str]]:
    """Return the letters among the unknown ones that are identified, and those that are not."""
    expressions = [c.meaning for c in problem.coefficients if c.role != "offset"]
    # What follows from others by default (F_T) counts as known: the other factor is a parameter by itself.
    searched = {s.name for s in problem.nonlinear}
    fixed = {*problem.drive.known, *searched, *following_letters(problem.model)}
    plain = [e.xreplace({x: sp.Symbol(x.name, positive=True) for x in e.free_symbols}) for e in expressions]
    letters = sorted({x for e in plain for x in e.free_symbols if x.name not in fixed}, key=str)
    # Distinct primes are a generic point: no accidental cancellation in these few products.
    everything = sorted({x for e in plain for x in e.free_symbols}, key=str)
    point = {x: sp.prime(k + 5) for k, x in enumerate(everything)}
    jacobian = sp.Matrix([[e.diff(x).subs(point) for x in letters] for e in plain])
    rank = jacobian.rank()
    told: list[str] = []
    for k, letter in enumerate(letters):
        own = sp.zeros(1, len(letters))
        own[k] = 1
        if jacobian.col_join(own).rank() == rank:
            told.append(letter.name)
    return told, [x.name for x in letters if x.name not in told]


def combinations(
    problem: Problem, values: Array, active: NDArray[np.int64], error: Spread
) -> dict[str, Estimate]:
    """Return combinations by name: coefficients of columns that are not a single letter.

    In newton metres if the scale is identified.
    `values` (k,) and `active` (k,) belong to the problem's coefficients, the spread to them and all that
    follow.
    """
    found: dict[str, Estimate] = {}
    where = next((k for k, c in enumerate(problem.coefficients) if c.role == "scale"), None)
    for k, c in enumerate(problem.coefficients):
        if c.role == "offset":
            continue
        slope = np.zeros(len(error.alone))
        slope[k] = 1.0
        if where is not None and k != where:
            s = values[where]
            slope[k], slope[where] = 1.0 / s, -values[k] / s**2
            name = as_text(sp.expand(c.expression / problem.coefficients[where].expression))
            bounds = (0.0 if c.lower == 0.0 else -np.inf, np.inf)
            found[name] = error.estimate(values[k] / s, slope, c.mechanical_unit, bounds, int(active[k]))
        elif not c.meaning.is_Symbol:
            found[c.name] = error.estimate(values[k], slope, c.unit, (c.lower, c.upper), int(active[k]))
    return found
