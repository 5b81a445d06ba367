"""Blocked cross-validation and block statistics for correlated samples.

Everything a selection needs is in the normal equations summed per block: each block, or on a long log each
group of neighbours, is judged by a fit to the sum of all others, so no row is visited twice.  Rows of one
block are correlated (they share filter, motion and drift); blocks are taken as exchangeable, and standard
errors and intervals come from them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear, nnls

from eccentric.diagnosis.search import limits

Array = np.ndarray


@dataclass(frozen=True)
class Gram:
    """Normal equations per block: matrix (..., b, p, p), vector (..., b, p), square (..., b).

    Leading axes are several logs with the same number of blocks.
    """

    matrix: Array
    vector: Array
    square: Array

    @classmethod
    def of(cls, design: Array, target: Array, block: Array, blocks: int | None = None) -> Gram:
        """Sums over the rows of each block; design (n, p), target (n,), block (n,) sorted integers 0..b-1.

        blocks: their number, if the last ones may be without rows.
        """
        starts = np.flatnonzero(np.r_[True, block[1:] != block[:-1]])
        count = blocks or int(block[-1]) + 1
        p = design.shape[1]
        matrix, vector, square = np.zeros((count, p, p)), np.zeros((count, p)), np.zeros(count)
        for start, stop in zip(starts, np.r_[starts[1:], len(block)], strict=True):
            x, y, b = design[start:stop], target[start:stop], block[start]
            matrix[b], vector[b], square[b] = x.T @ x, x.T @ y, y @ y
        return cls(matrix, vector, square)

    def of_blocks(self, chosen: Array) -> Gram:
        """Some of the blocks, by number; of an array of numbers (v, b) one log for each row."""
        return Gram(self.matrix[chosen], self.vector[chosen], self.square[chosen])

    def loss(self, coefficients: Array) -> Array:
        """Sum of squared residuals of each block; coefficients (p,) or one set per block (..., b, p)."""
        c = np.broadcast_to(coefficients, self.vector.shape)
        # Coefficients that extrapolate wildly leave the rounding of huge numbers, of either sign, or NaN.
        with np.errstate(over="ignore", invalid="ignore"):
            product = (self.matrix @ c[..., None])[..., 0]
            return np.abs(self.square + np.sum(c * (product - 2.0 * self.vector), axis=-1))


def bounded_solve(matrix: Array, vector: Array, lower: Array, ridge: Array | float = 0.0) -> Array:
    """Least squares from normal equations with coefficients that are free (lower -inf) or nonnegative (0).

    A small relative ridge keeps exact aliases solvable and picks the shortest of the equivalent solutions.
    `ridge` is a further penalty in units of the scaled diagonal (smooth terms).
    """
    scaled, scale = _scaled(matrix, ridge)
    right = vector / scale
    bounded = np.isfinite(lower)
    try:
        solution = np.linalg.solve(scaled, right)
        if np.all(solution[bounded] >= 0.0):
            return solution / scale
        # With the free coefficients first, the rest of a Cholesky factor is that of the bounded ones alone.
        order = np.argsort(bounded, kind="stable")
        factor = np.linalg.cholesky(scaled[order][:, order])
    except np.linalg.LinAlgError:
        return np.zeros(len(vector))
    target = solve_triangular(factor, right[order], lower=True, check_finite=False)
    first = slice(len(vector) - np.count_nonzero(bounded))
    last = slice(first.stop, None)
    try:
        found, _ = nnls(factor[last, last].T, target[last])
    except RuntimeError:
        # Columns that are nearly dependent make it go in circles; this one is slower and does not.
        found = lsq_linear(factor[last, last].T, target[last], (0.0, np.inf), method="bvls").x
    solution[order[last]] = found
    rest = target[first] - factor[last, first].T @ found
    solution[order[first]] = solve_triangular(
        factor[first, first], rest, trans=1, lower=True, check_finite=False
    )
    return solution / scale


def bounded_solve_each(matrix: Array, vector: Array, lower: Array, ridge: Array | float = 0.0) -> Array:
    """`bounded_solve` of several normal equations (v, p, p), (v, p); bounds for all (p,) or each (v, p)."""
    scaled, scale = _scaled(matrix, ridge)
    bounded = np.broadcast_to(np.isfinite(lower), vector.shape)
    try:
        solution = np.linalg.solve(scaled, (vector / scale)[..., None])[..., 0]
        beyond = np.any(bounded & ~(solution >= 0.0), axis=1)
        found = solution / scale
    except np.linalg.LinAlgError:
        beyond, found = np.ones(len(vector), dtype=bool), np.empty(vector.shape)
    bounds = np.broadcast_to(lower, vector.shape)
    for k in np.flatnonzero(beyond):
        found[k] = bounded_solve(matrix[k], vector[k], bounds[k], ridge)
    return found


def _scaled(matrix: Array, ridge: Array | float) -> tuple[Array, Array]:
    """Matrices (..., p, p) with ones and the ridge on the diagonal, and scales (..., p) of coefficients."""
    # A column of zeros: its entry in an inverse, 1/ALIASED of the square, has to be a number.
    scale = np.sqrt(np.maximum(np.diagonal(matrix, axis1=-2, axis2=-1), 1e-200))
    scaled = matrix / (scale[..., :, None] * scale[..., None, :])
    diagonal = np.arange(matrix.shape[-1])
    scaled[..., diagonal, diagonal] += limits.ALIASED + ridge
    return scaled, scale


def groups_of(blocks: int) -> Array:
    """What is left out together (blocks,): each block by itself, or neighbours where there are many."""
    return np.arange(blocks) * min(blocks, limits.MOST_GROUPS) // blocks


def sum_of_each(group: Array, values: Array, axis: int = 0) -> Array:
    """Sums (groups, ...) of values (blocks, ...) over the blocks of each group (blocks,), in their order."""
    return np.add.reduceat(values, np.flatnonzero(np.diff(group, prepend=-1)), axis=axis)


def cross_validate(gram: Gram, lower: Array, ridge: Array | float = 0.0) -> Array:
    """Loss of every block (b,) under the coefficients fitted without its group.

    Coefficients that the fit of all blocks holds at their bound are held there: one group would let them off
    it by little. Where others leave their range, the bounded fit is made anew.
    """
    one = Gram(gram.matrix[None], gram.vector[None], gram.square[None])
    return cross_validate_each(one, lower, ridge)[0][0]


def cross_validate_each(gram: Gram, lower: Array, ridge: Array | float = 0.0) -> tuple[Array, Array]:
    """`cross_validate` of several logs at once: losses (v, b), and the coefficients of all blocks (v, p)."""
    total_matrix, total_vector = gram.matrix.sum(axis=1), gram.vector.sum(axis=1)
    group = groups_of(gram.square.shape[1])
    matrix = total_matrix[:, None] - sum_of_each(group, gram.matrix, axis=1)
    vector = total_vector[:, None] - sum_of_each(group, gram.vector, axis=1)
    bounded = np.isfinite(lower)
    whole = bounded_solve_each(total_matrix, total_vector, lower, ridge)
    coefficients = _free_solutions(matrix, vector, ~bounded | (whole > 0.0), ridge)
    beyond = ~np.all(np.isfinite(coefficients), axis=2) | np.any(coefficients[..., bounded] < 0.0, axis=2)
    for place in zip(*np.nonzero(beyond), strict=True):
        coefficients[place] = bounded_solve(matrix[place], vector[place], lower, ridge)
    return gram.loss(coefficients[:, group]), whole


def _free_solutions(matrix: Array, vector: Array, free: Array, ridge: Array | float) -> Array:
    """Solutions (v, g, p) of normal equations, 0 where not free (v, p); NaN for a log with a singular one."""
    scaled, scale = _scaled(matrix, ridge)
    fixed = ~np.broadcast_to(free[:, None], vector.shape)
    scaled[fixed[..., :, None] | fixed[..., None, :]] = 0.0
    scaled[fixed[..., None] & np.eye(fixed.shape[-1], dtype=bool)] = 1.0
    right = np.where(fixed, 0.0, vector / scale)
    try:
        return np.linalg.solve(scaled, right[..., None])[..., 0] / scale
    except np.linalg.LinAlgError:
        if len(matrix) == 1:
            return np.full(vector.shape, np.nan)
        each = zip(matrix, vector, free, strict=True)
        return np.concatenate([_free_solutions(m[None], x[None], f[None], ridge) for m, x, f in each])


def inverses(matrices: Array, ridge: Array | float = 0.0) -> Array:
    """Inverses (b, p, p) of several matrices of normal equations, with the ridge of `bounded_solve`."""
    scaled, scale = _scaled(matrices, ridge)
    return np.linalg.inv(scaled) / (scale[:, :, None] * scale[:, None, :])


# Are the columns of a candidate free of the target's noise? Least squares against instrumental variables.
#
# The measured current stands on one side of a balance and inside candidates on the other. Least squares
# then takes the noise of the target for the effect; instruments do not. Where the columns are free of that
# noise, as a ripple over the angle is, both estimate the same (the idea of the Durbin-Wu-Hausman test).
# Such a fit may lie below the sensors' noise floor: a ripple faster than the sampling looked like noise to
# the floor.
#
# Reference: J. A. Hausman, "Specification tests in econometrics", Econometrica 46(6), 1978.
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
    y, x, z = (unexplained(base, a) for a in (target[:, None], own, instruments))
    try:
        squares, found = np.linalg.lstsq(x, y, rcond=None)[0], np.linalg.solve(z.T @ x, z.T @ y)
        inverse = np.linalg.inv(z.T @ x)
    except np.linalg.LinAlgError:
        return False
    rest = y - x @ found
    variance = limits.ROWS_FOR_ONE * float(rest[:, 0] @ rest[:, 0]) / len(rest)
    along = x.T @ (x @ squares)  # the estimate that is to be found again, weighted by the torque it makes
    whole = float((squares.T @ along).item())
    if whole <= 0.0:
        return False
    error = float(np.sqrt(variance * (along.T @ inverse @ (z.T @ z) @ inverse.T @ along).item()))
    again = float((found.T @ along).item())
    return again > limits.KEPT_BY_INSTRUMENTS * whole and again > limits.CLEARLY * error


def unexplained(base: Array, columns: Array) -> Array:
    """Columns (rows, k), or one (rows,), without what least squares on a base (rows, p) explains of them."""
    return columns - base @ np.linalg.lstsq(base, columns, rcond=None)[0] if base.shape[1] else columns


def spans(base: Array, columns: Array) -> bool:
    """Whether columns are combinations of those of a base."""
    return bool(np.linalg.norm(unexplained(base, columns)) < limits.TINY_COLUMN * np.linalg.norm(columns))


# How many rows a residual counts as: rows that follow each other repeat a part of what they say.
def inflation(residual: Array, block: Array) -> float:
    """Variance inflation 1 + 2 sum of autocorrelation (Bartlett weights), at least 1.

    Pairs of rows more than one block apart are not counted.
    """
    r = residual - residual.mean()
    variance = float(np.mean(r**2))
    if variance <= 0.0:
        return 1.0
    total = 1.0
    for lag in range(1, min(limits.MOST_LAGS, len(r) - 1) + 1):
        near = block[lag:] - block[:-lag] <= 1
        rho = float(np.sum(r[lag:] * r[:-lag] * near)) / (len(r) * variance)
        total += 2.0 * (1.0 - lag / (limits.MOST_LAGS + 1)) * rho
    return max(1.0, total)


def correlated(residual: Array, block: Array, independent: bool) -> float:
    """How many rows count as one: at least two, since windows overlap by half; one if each row is a run."""
    return 1.0 if independent else max(limits.ROWS_FOR_ONE, inflation(residual, block))
