"""Every block predicted from the others, beside SciPy's bounded least squares on the rows themselves."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from eccentric.diagnosis.search.crossval import (
    Gram,
    bounded_solve,
    bounded_solve_each,
    cross_validate,
    cross_validate_each,
)

BLOCK = np.repeat(np.arange(12), 7)


def rows(coefficients: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Columns (84, 3) and a target (84,) that follows them but for noise."""
    rng = np.random.default_rng(3)
    columns = rng.normal(size=(len(BLOCK), 3))
    return columns, columns @ coefficients + rng.normal(size=len(BLOCK))


def expected(columns: np.ndarray, target: np.ndarray, lower: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Loss of every block (12,), and the coefficients (12, 3) that were fitted without it."""
    loss, fitted = [], []
    for number in range(12):
        mine = BLOCK == number
        found = lsq_linear(columns[~mine], target[~mine], (lower, np.inf), method="bvls", tol=1e-14).x
        loss.append(np.sum((target[mine] - columns[mine] @ found) ** 2))
        fitted.append(found)
    return np.array(loss), np.array(fitted)


@pytest.mark.parametrize("last", [2.0, -0.8])
@pytest.mark.parametrize("bounded", [False, True])
def test_loss_of_a_block_under_the_fit_to_all_others(last: float, bounded: bool) -> None:
    """Free, within its range, or at its bound whichever block is left out."""
    columns, target = rows([1.0, -0.5, last])
    lower = np.array([-np.inf, -np.inf, 0.0 if bounded else -np.inf])
    loss, fitted = expected(columns, target, lower)

    assert np.all(fitted[:, 2] == 0.0) if bounded and last < 0.0 else np.all(fitted[:, 2] != 0.0)
    assert cross_validate(Gram.of(columns, target, BLOCK), lower) == pytest.approx(loss, rel=1e-7)


def test_a_coefficient_that_reaches_its_bound_without_a_block_stays_there() -> None:
    """Only the first block shows it; without that block the least squares are at the bound."""
    columns, target = rows([1.0, -0.5, -0.6])
    columns[:, 2] = np.abs(columns[:, 2])
    target[BLOCK == 0] += 15.0 * columns[BLOCK == 0, 2]
    lower = np.array([-np.inf, -np.inf, 0.0])
    loss, fitted = expected(columns, target, lower)

    assert fitted[0, 2] == 0.0 < np.min(fitted[1:, 2])
    assert cross_validate(Gram.of(columns, target, BLOCK), lower) == pytest.approx(loss, rel=1e-7)


def test_a_ridge_is_a_row_of_its_own_in_every_fit() -> None:
    """In units of the sum of squares of what is fitted: a third of it halves no column, but draws it to 0."""
    columns, target = rows([1.0, -0.5, 2.0])
    ridge, loss = np.array([0.0, 0.0, 1.0 / 3.0]), []
    for number in range(12):
        mine = BLOCK == number
        held = np.sqrt(ridge * np.sum(columns[~mine] ** 2, axis=0))
        fitted = np.linalg.lstsq(np.vstack([columns[~mine], np.diag(held)]), np.r_[target[~mine], 0, 0, 0])[0]
        loss.append(np.sum((target[mine] - columns[mine] @ fitted) ** 2))
    found = cross_validate(Gram.of(columns, target, BLOCK), np.full(3, -np.inf), ridge)

    assert found == pytest.approx(np.array(loss), rel=1e-7)


def test_a_block_without_rows_loses_nothing() -> None:
    """And changes nothing for the others: means of two rows may leave none."""
    columns, target = rows([1.0, -0.5, 2.0])
    lower = np.full(3, -np.inf)
    some = cross_validate(Gram.of(columns, target, BLOCK, 13), lower)

    assert some[:12] == pytest.approx(cross_validate(Gram.of(columns, target, BLOCK), lower), rel=1e-12)
    assert some[12] == 0.0


def test_neighbours_of_a_long_log_are_left_out_together() -> None:
    """Of 96 blocks two and one in turn, in 64 groups, each predicted from all others."""
    rng = np.random.default_rng(4)
    columns, block = rng.normal(size=(480, 2)), np.repeat(np.arange(96), 5)
    target = columns @ [1.0, 2.0] + rng.normal(size=480)
    found = cross_validate(Gram.of(columns, target, block), np.full(2, -np.inf))

    group = np.array([3 * (k // 3) + (k % 3 > 1) for k in range(96)])
    for number in range(96):
        outside = group[block] != group[number]
        fitted = np.linalg.lstsq(columns[outside], target[outside], rcond=None)[0]
        rest = target[block == number] - columns[block == number] @ fitted
        assert found[number] == pytest.approx(rest @ rest, rel=1e-7)


@pytest.mark.parametrize("singular", [False, True])
def test_several_logs_at_once_are_each_as_alone(singular: bool) -> None:
    """With a coefficient that is free in one log, at its bound in another; and beside a log of zeros."""
    lower = np.array([-np.inf, -np.inf, 0.0])
    grams = [
        Gram.of(columns, target, BLOCK)
        for columns, target in (rows([1.0, -0.5, last]) for last in (2.0, -0.8, 0.02))
    ]
    if singular:
        grams.append(Gram.of(np.zeros((84, 3)), np.ones(84), BLOCK))
    together = Gram(*(np.stack([getattr(g, name) for g in grams]) for name in ("matrix", "vector", "square")))
    losses, whole = cross_validate_each(together, lower)

    for gram, loss, coefficients in zip(grams, losses, whole, strict=True):
        alone = bounded_solve(gram.matrix.sum(axis=0), gram.vector.sum(axis=0), lower)
        assert loss == pytest.approx(cross_validate(gram, lower), rel=1e-10)
        assert coefficients == pytest.approx(alone, rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_bounded_least_squares_from_normal_equations_are_scipys(seed: int) -> None:
    """Any number of free and bounded columns, in any order, several of them at their bound."""
    rng = np.random.default_rng(seed)
    count = 2 + seed
    columns, lower = rng.normal(size=(60, count)), np.where(rng.random(count) < 0.6, 0.0, -np.inf)
    target = columns @ rng.normal(size=count) + rng.normal(size=60)
    matrix, vector = columns.T @ columns, columns.T @ target

    expected = lsq_linear(columns, target, (lower, np.inf), method="bvls", tol=1e-14).x
    assert bounded_solve(matrix, vector, lower) == pytest.approx(expected, rel=1e-7, abs=1e-8)
    assert bounded_solve_each(matrix[None], vector[None], lower)[0] == pytest.approx(
        expected, rel=1e-7, abs=1e-8
    )
