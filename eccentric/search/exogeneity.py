"""Are the columns of a candidate free of the target's noise? Least squares against instrumental variables.

The measured current stands on one side of a balance and inside candidates on the other. Least squares then
takes the noise of the target for the effect; instruments do not. Where the columns are free of that noise, as
a ripple over the angle is, both estimate the same (the idea of the Durbin-Wu-Hausman test). Such a fit may
lie below the sensors' noise floor: a ripple faster than the sampling looked like noise to the floor.

Reference: J. A. Hausman, "Specification tests in econometrics", Econometrica 46(6), 1978.
"""

from __future__ import annotations

import numpy as np

from eccentric.search.limits import CLEARLY, KEPT_BY_INSTRUMENTS, ROWS_FOR_ONE

__all__ = ["exogenous"]

Array = np.ndarray


def exogenous(target: Array, base: Array, own: Array, instruments: Array) -> bool:
    """Whether instruments find what least squares finds.

    Args:
        target: (rows,) [N m].
        base: (rows, p), what is fitted beside the candidate.
        own: (rows, k), the candidate's columns, with the noise of their signals.
        instruments: (rows, k), the same without it.

    Of the torque that least squares gives the candidate, the instruments must find most, and more than three
    standard errors of it. False where the instruments do not determine the coefficients.
    """
    y, x, z = (_without(base, a) for a in (target[:, None], own, instruments))
    try:
        squares, found = np.linalg.lstsq(x, y, rcond=None)[0], np.linalg.solve(z.T @ x, z.T @ y)
        inverse = np.linalg.inv(z.T @ x)
    except np.linalg.LinAlgError:
        return False
    rest = y - x @ found
    variance = ROWS_FOR_ONE * float(rest[:, 0] @ rest[:, 0]) / len(rest)
    along = x.T @ (x @ squares)  # the estimate that is to be found again, weighted by the torque it makes
    whole = float((squares.T @ along).item())
    if whole <= 0.0:
        return False
    error = float(np.sqrt(variance * (along.T @ inverse @ (z.T @ z) @ inverse.T @ along).item()))
    again = float((found.T @ along).item())
    return again > KEPT_BY_INSTRUMENTS * whole and again > CLEARLY * error


def _without(base: Array, columns: Array) -> Array:
    """The columns without what the base explains of them."""
    return columns - base @ np.linalg.lstsq(base, columns, rcond=None)[0] if base.shape[1] else columns
