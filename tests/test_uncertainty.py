"""Bounded least squares, standard errors and gains against closed forms."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import binom

from eccentric.identification import Coefficient, Design
from eccentric.identification.limits import FRACTION
from eccentric.identification.uncertainty import (
    TWO_SIDED,
    covariance,
    improvement,
    improvement_over_runs,
    spread,
)
from tests.planted import coloured

Ends = tuple[float, float]


def intervals(
    gain: Callable[[np.ndarray, np.ndarray], tuple[float, Ends]], worse: np.ndarray, better: np.ndarray
) -> list[Ends]:
    """The interval of each draw, for (draws, n)."""
    return [gain(one, other)[1] for one, other in zip(worse, better, strict=True)]


def test_covariance_is_newey_and_wests_sum() -> None:
    """The window sums equal the double sum over all pairs of rows with Bartlett's weights."""
    rng = np.random.default_rng(2)
    rows, columns = 40, 2
    x, e = rng.standard_normal((rows, columns)), rng.standard_normal(rows)
    span = round(FRACTION * rows)
    omega = np.zeros((columns, columns))
    for s in range(rows):
        for t in range(rows):
            omega += max(0.0, 1.0 - abs(s - t) / span) * np.outer(x[s], x[t]) * e[s] * e[t]
    bread = np.linalg.inv(x.T @ x)
    expected = bread @ omega @ bread * rows / (rows - columns)
    np.testing.assert_allclose(covariance(x, e), expected, rtol=1e-10)


def test_coefficients_of_columns_that_are_one_have_no_finite_variance() -> None:
    """Of a, b and a + b no coefficient is determined; that of a column beside them is as without the sum."""
    rng = np.random.default_rng(4)
    x, e = rng.standard_normal((60, 3)), rng.standard_normal(60)
    e -= x @ np.linalg.lstsq(x, e, rcond=None)[0]
    found = covariance(np.column_stack([x, x[:, 0] + 2.0 * x[:, 1]]), e)
    without = covariance(x, e)[2, 2] * (60 - 3) / (60 - 4)

    assert [math.inf, math.inf, math.inf] == [found[k, k] for k in (0, 1, 3)]
    assert found[2, 2] == pytest.approx(without, rel=1e-9)


def test_standard_error_of_a_mean_under_ar1_noise_has_the_closed_form() -> None:
    """AR(1) noise inflates the variance of a mean (1 + r)/(1 - r)-fold, and 95 % of the intervals hold it.

    The estimate has the mean 1 - b + b^2/3 of it that Kiefer and Vogelsang's limit has for b = 1/10.
    """
    rng, rows, memory, draws = np.random.default_rng(3), 2000, 0.5, 1000
    ones = np.ones((rows, 1))
    truth = (1.0 + memory) / (1.0 - memory) / rows
    found, hits = np.zeros(draws), 0
    for k in range(draws):
        y = coloured(rng, 1.0, memory, rows)
        found[k] = covariance(ones, y - y.mean())[0, 0]
        hits += abs(y.mean()) <= TWO_SIDED * math.sqrt(found[k])
    expected = (1.0 - FRACTION + FRACTION**2 / 3.0) * truth
    assert abs(found.mean() - expected) < 4.0 * found.std() / math.sqrt(draws)
    assert binom.ppf(0.001, draws, 0.95) <= hits <= binom.ppf(0.999, draws, 0.95)


def test_bounds_of_orthogonal_columns_clip() -> None:
    """For orthogonal columns the bounded least squares are the free ones, clipped one by one."""
    rng = np.random.default_rng(4)
    q = np.linalg.qr(rng.standard_normal((1000, 4)))[0] * np.array([1.0, 1e3, 1e-3, 5.0])
    y = rng.standard_normal(1000)
    free = q.T @ y / np.sum(q * q, axis=0)
    low = np.minimum(free, 0.0) * [1.0, 1.0, 0.5, 0.5] - [1.0, 1.0, 0.0, 0.0]
    named = tuple(Coefficient(f"x_{k}", "friction", "", end) for k, end in enumerate(low))
    found = Design(named, y, q, np.ones(1000, bool), np.ones(1000)).solve()
    expected = np.maximum(free, low)
    np.testing.assert_allclose(found.values, expected, rtol=1e-9)
    np.testing.assert_array_equal(found.active != 0, expected != free)


def test_an_active_bound_is_told_where_it_makes_the_interval() -> None:
    """A held value is its bound exactly; what correlates with it is marked, what does not is not."""
    rng = np.random.default_rng(5)
    q = np.linalg.qr(rng.standard_normal((4000, 3)))[0]
    design = np.column_stack([q[:, 0], q[:, 0] + q[:, 1], q[:, 2]])
    residual, zero, unit = 0.1 * rng.standard_normal(4000), np.zeros(3), np.eye(3)
    values = np.array([0.0, 5.0, 5.0])
    found = spread(design, residual, values, np.array([-1, 0, 0]), zero, np.full(3, math.inf))
    bounds = (0.0, math.inf)
    held = found.estimate(-1e-18, unit[0], "N m", bounds, -1)
    assert (held.value, held.widened, held.bound_active) == (0.0, True, "lower")
    assert [found.estimate(5.0, unit[k], "N m", bounds).widened for k in (1, 2)] == [True, False]


def test_what_the_log_does_not_see_goes_as_far_as_the_bounds() -> None:
    """Of a x + b x, a = 3 and b = 0, neither negative: any b up to 3 fits as well, and a then falls to 0.

    Without an upper bound for what another of either sign replaces, there is no end.
    """
    x = np.linspace(-1.0, 1.0, 500)
    residual = 0.01 * np.random.default_rng(3).standard_normal(500)
    values, active, unit = np.array([3.0, 0.0]), np.array([0, -1]), np.eye(2)
    high = np.full(2, math.inf)
    found = spread(np.column_stack([x, x]), residual, values, active, np.zeros(2), high)
    a = found.estimate(3.0, unit[0], "N m", (0.0, math.inf))
    b = found.estimate(0.0, unit[1], "N m", (0.0, math.inf), -1)

    assert (b.value, b.interval, b.widened, b.std_error) == (0.0, (0.0, pytest.approx(3.0)), True, math.inf)
    assert (a.interval[0], a.widened) == (0.0, True)
    assert a.interval[1] == pytest.approx(3.0, abs=0.01)
    both = found.estimate(3.0, unit[0] + unit[1], "N m")
    np.testing.assert_allclose(both.interval, 3.0, atol=0.01)

    found = spread(np.column_stack([x, x]), residual, values, active, np.array([-math.inf, 0.0]), high)
    assert found.estimate(0.0, unit[1], "N m", (0.0, math.inf), -1).interval == (0.0, math.inf)
    assert found.estimate(3.0, unit[0], "N m").interval[0] == -math.inf

    # Nor does a have room: no standard error describes b.
    found = spread(np.column_stack([x, x]), residual, np.zeros(2), active, np.zeros(2), high)
    assert found.estimate(0.0, unit[1], "N m", (0.0, math.inf), -1).widened


def test_equal_predictions_gain_nothing() -> None:
    """The same residual twice is a gain of 0 % with the interval [0, 0]; half of it is 50 %."""
    e = np.random.default_rng(1).standard_normal(500)
    assert improvement(e, e) == (0.0, (0.0, 0.0))
    assert improvement(e, 0.5 * e) == (50.0, (50.0, 50.0))


def test_a_perfect_prediction_gains_everything() -> None:
    """No residual at all is a gain of 100 %, over rows and over runs, and numpy warns of nothing.

    Nor where the other model is perfect in some runs as well.
    """
    e = np.random.default_rng(1).standard_normal(500)
    with np.errstate(all="raise"):
        assert improvement(e, 0.0 * e) == (100.0, (100.0, 100.0))
        assert improvement_over_runs(np.array([1.0, 0.0]), np.zeros(2)) == (100.0, (100.0, 100.0))


@pytest.mark.parametrize("runs", [5, 8, 15, 30])
@pytest.mark.parametrize("scatter", ["normal", "skewed"])
def test_intervals_over_few_runs_hold_the_truth(scatter: str, runs: int) -> None:
    """Of a gain over runs whose mean squares scatter, normal or skewed, 95 % of the intervals hold the truth.

    What is drawn is one part common to both models and one of each; the truth is the ratio of their means.
    """
    rng, draws, truth = np.random.default_rng(6), 400, 0.7
    common, first, second = (
        1.0 + 0.15 * rng.standard_normal((3, draws, runs))
        if scatter == "normal"
        else rng.gamma(3.0, 1.0 / 3.0, (3, draws, runs))
    )
    worse, better = 0.5 * (common + first), 0.5 * truth**2 * (common + second)
    hits = sum(low <= 30.0 <= high for low, high in intervals(improvement_over_runs, worse, better))
    assert binom.ppf(0.001, draws, 0.95) <= hits <= binom.ppf(0.999, draws, 0.95)


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_intervals_over_blocks_hold_the_truth(memory: float) -> None:
    """95 % of the intervals over blocks hold a gain of 30 %, with white noise and with AR(1) noise."""
    rng, draws, truth, rows = np.random.default_rng(7), 400, 0.7, 2000
    worse, better = np.array(
        [[size * coloured(rng, 1.0, memory, rows) for size in (1.0, truth)] for _ in range(draws)]
    ).swapaxes(0, 1)
    hits = sum(low <= 30.0 <= high for low, high in intervals(improvement, worse, better))
    assert binom.ppf(0.001, draws, 0.95) <= hits <= binom.ppf(0.999, draws, 0.95)
