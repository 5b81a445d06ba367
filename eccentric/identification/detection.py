"""What a log says of friction by F_N that it does not show: an upper bound, and what it could have shown.

A coefficient whose interval reaches 0 is not detected.  Its upper bound is the upper end of that interval.
Whether this is news depends on the value that one expects: z is that of the model (Table 1 of the paper, for
the bundled models) in standard errors of the coefficient, with all others free and no bounds.  At z = 5 the
log would have shown it nearly always, at z = 1 hardly ever.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from eccentric.identification.columns import own_letters
from eccentric.identification.problem import Problem
from eccentric.identification.regression import Solution
from eccentric.identification.uncertainty import TWO_SIDED, Estimate
from eccentric.model import Load


@dataclass(frozen=True)
class Undetected:
    """A coefficient of friction by F_N whose interval reaches 0.

    Attributes:
        upper: end of its 95 % interval, in `unit`.
        reference: the model's own value, None where the log has no newton metres to compare it in.
        z: the reference in standard errors of the coefficient when it is free.
    """

    upper: float
    unit: str
    reference: float | None
    z: float | None

    @property
    def power(self) -> float | None:
        """The probability that the interval of such a log excludes 0 if the reference is true."""
        return None if self.z is None else detection_power(self.z)


def detection_power(z: float) -> float:
    """The probability that a coefficient of z standard errors has an interval without 0."""
    return float(ndtr(z - TWO_SIDED))


def undetected(
    problem: Problem, unbounded: Solution, estimates: Mapping[str, Estimate]
) -> dict[str, Undetected]:
    """Coefficients of friction by F_N that a log does not show, by their letters.

    Args:
        problem: of the fit.
        unbounded: its solution without bounds.
        estimates: of the bounded fit, by letter, in newton metres where the log has a scale.
    """
    nonlinear = [one for one in problem.nonlinear if one.name in unbounded.at]
    error, own = unbounded.spread(nonlinear), own_letters(problem.model)
    roles = {c.role: float(x) for c, x in zip(unbounded.design.coefficients, unbounded.values, strict=True)}
    torque = problem.scale is None and problem.unit == "N m"
    per_newton = roles.get("scale", 1.0 if torque else 0.0)
    found: dict[str, Undetected] = {}
    for k, (columns, c) in enumerate(zip(problem.friction, problem.coefficients, strict=False)):
        if columns[0].load is not Load.NORMAL or c.letter not in estimates:
            continue
        shown = estimates[c.letter]
        if shown.interval[0] > 0.0:
            continue
        size = float(np.sqrt(error.matrix[k, k]))
        reference = own.get(c.letter) if per_newton > 0.0 else None
        z = None if not reference or not np.isfinite(size) or size <= 0.0 else reference * per_newton / size
        found[c.letter] = Undetected(shown.interval[1], shown.unit, reference, z)
    return found
