"""What another filter would change is part of the uncertainty: solutions that move by a known amount."""

from __future__ import annotations

import numpy as np
import pytest

from eccentric.identification import Coefficient, Design

N = 4000
MOVED = np.array([0.3, -0.02])


def design(target: np.ndarray, columns: np.ndarray, lower: float = -np.inf) -> Design:
    """Two coefficients, the second one with a lower bound; every second row is fitted."""
    coefficients = Coefficient("a", "friction", "N m"), Coefficient("b", "friction", "N m", lower)
    return Design(coefficients, target, columns, np.arange(N) % 2 == 0, np.full(N, 0.7))


@pytest.fixture(scope="module")
def log() -> tuple[np.ndarray, np.ndarray]:
    """Columns of unlike size, and a target with noise."""
    rng = np.random.default_rng(2)
    columns = rng.standard_normal((N, 2)) * [1.0, 50.0]
    return columns @ [2.0, 0.1] + rng.standard_normal(N), columns


def test_the_change_adds_to_the_covariance(log: tuple[np.ndarray, np.ndarray]) -> None:
    """A target that moves the solution by d adds d d' to its covariance."""
    target, columns = log
    solution = design(target, columns).solve()
    other = design(target + columns @ MOVED, columns)

    assert other.solve().values - solution.values == pytest.approx(MOVED, rel=1e-9)
    added = solution.spread(filtered=(solution.design, other)).matrix - solution.spread().matrix
    np.testing.assert_allclose(added, np.outer(MOVED, MOVED), rtol=1e-9, atol=1e-15)


def test_the_same_filter_adds_nothing(log: tuple[np.ndarray, np.ndarray]) -> None:
    """To rounding."""
    one = design(*log)
    solution = one.solve()

    np.testing.assert_allclose(
        solution.spread(filtered=(one, one)).matrix, solution.spread().matrix, rtol=1e-12
    )


def test_a_coefficient_at_its_bound_does_not_move(log: tuple[np.ndarray, np.ndarray]) -> None:
    """The others take the change that they have with it fixed."""
    target, columns = log
    solution = design(target, columns, lower=0.5).solve()
    other = design(target + columns @ MOVED, columns, lower=0.5)
    alone = columns[:, 0][design(*log).train]
    by_itself = alone @ (columns @ MOVED)[design(*log).train] / (alone @ alone)

    assert solution.active.tolist() == [0, -1]
    added = solution.spread(filtered=(solution.design, other)).matrix - solution.spread().matrix
    np.testing.assert_allclose(added, [[by_itself**2, 0.0], [0.0, 0.0]], rtol=1e-9, atol=1e-15)


def test_a_column_that_the_other_filter_leaves_nothing_of_does_not_move(
    log: tuple[np.ndarray, np.ndarray],
) -> None:
    """Of a column of zeros nothing can be said: its coefficient stays, whatever the rounding."""
    target, columns = log
    solution = design(target, columns).solve()
    other = design(target + columns @ MOVED, columns * [1.0, 0.0] + [0.0, 1e-210])
    added = solution.spread(filtered=(solution.design, other)).matrix - solution.spread().matrix

    assert np.all(np.isfinite(added))
    assert abs(added[1, 1]) < 1e-3
