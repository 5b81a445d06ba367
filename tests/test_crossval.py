"""Every block predicted from the others, beside SciPy's bounded least squares on the rows themselves."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from eccentric.diagnosis.search import limits, stability
from eccentric.diagnosis.search.candidate import Candidate, Variant
from eccentric.diagnosis.search.crossval import (
    Gram,
    bounded_solve,
    bounded_solve_each,
    cross_validate,
    cross_validate_each,
)
from eccentric.diagnosis.search.screen import Fitted, Screen
from eccentric.diagnosis.search.stability import _Drawn, beats_chance
from eccentric.effects import Evidence
from eccentric.identification import balance_design
from eccentric.signals.rows import Rows
from tests.searched import candidate, search

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


# A gain counts if it beats what the noise of the log itself makes, correlated and unequal as it is.


SECONDS, RATE = 64, 16
N = SECONDS * RATE
T = np.arange(N) / RATE
SECOND = np.repeat(np.arange(SECONDS), RATE)
SPEED = np.sin(2.0 * np.pi * 0.09 * SECOND)
"""A speed that is held for a second."""
CURVES = np.column_stack([SPEED**k for k in range(1, 7)])


def drawn(
    seed: int, amplitude: float = 0.0, runs: int = SECONDS, late: int = 0, gaps: bool = False
) -> tuple[Screen, Fitted, Fitted]:
    """A log whose noise lasts a second and is six times as large at high speed; with and without the curves.

    amplitude: of the square of the speed, which is planted; late: rows of the first second that are missing;
    gaps: whether blocks 0 and 7 have no rows.
    """
    noise = np.random.default_rng(seed).standard_normal(SECONDS)[SECOND] * np.where(SPEED > 0.8, 6.0, 1.0)
    every, block = np.ones(N, bool), np.arange(N) * runs // N
    rows = Rows(T, np.zeros(N, int), block, every, ~every, np.ones(N), "rows")
    target = noise + amplitude * SPEED**2
    kept = (np.arange(N) >= late) & ~(gaps & np.isin(block, (0, 7)))
    target, nothing = target[kept], np.empty((int(kept.sum()), 0))
    rows = rows.chosen(np.flatnonzero(kept))
    balance = replace(balance_design("mechanical", rows, (), target, nothing, target), scale=1.0)
    curves = Candidate(
        "curves", "curves", "mechanical", Evidence(("velocity",)), lambda _: CURVES[kept], ridge=1e-2
    )
    screen = Screen(balance, [curves])
    return screen, screen.fit([]), screen.fit([Variant(curves, {})])


def test_noise_of_the_log_itself_is_no_structure() -> None:
    """Of sixty logs of noise alone none beats it, though some gain by 24 if every row counts for itself."""
    every = [drawn(seed) for seed in range(60)]
    by_rows = [N * np.log(before.score / after.score) > 24.0 for _, before, after in every]

    assert sum(by_rows) >= 3
    assert not any(beats_chance(*one) for one in every)


@pytest.mark.parametrize("runs", [SECONDS, 8])
def test_structure_beats_it(runs: int) -> None:
    """What is planted beats it in every log, whether blocks are seconds or runs."""
    assert all(beats_chance(*drawn(seed, amplitude=12.0, runs=runs)) for seed in range(10))


@pytest.mark.parametrize("late", [4, 8, 12])
def test_a_log_may_begin_within_a_second(late: int) -> None:
    """Seconds are those of the blocks: noise that lasts one keeps its sign for it."""
    assert not any(beats_chance(*drawn(seed, late=late)) for seed in range(20))


@pytest.mark.parametrize("amplitude", [0.0, 12.0])
def test_blocks_may_have_no_rows(amplitude: float) -> None:
    """Standstill takes all rows of some seconds: what is planted still beats chance, and noise does not."""
    every = [beats_chance(*drawn(seed, amplitude, gaps=True)) for seed in range(10)]

    assert [amplitude > 0.0] * 10 == every


def test_a_draw_with_the_signs_of_the_log_is_the_log() -> None:
    """Its cross-validated losses are those of the fit: the same blocks are left out together, gaps or not."""
    for gaps in (False, True):
        screen, before, after = drawn(3, amplitude=5.0, gaps=gaps, runs=4 * SECONDS)
        numbers = np.unique(screen.block)
        assert len(numbers) > limits.MOST_GROUPS
        residual = screen.residual(before)
        predicted = screen.balance.target - residual
        of_one_block = np.cumsum(np.diff(screen.block, prepend=-1) != 0) - 1
        found = _Drawn.of(screen, after, predicted, residual, of_one_block)

        losses, without = found.losses(np.ones((len(numbers), 1)))[:, 0], before.cross[numbers]
        # A block in which the curves extrapolate counts for nothing.
        losses = np.where(losses > limits.EXTRAPOLATED * without, without, losses)
        assert losses == pytest.approx(after.cross[numbers], rel=1e-9)


def test_a_signal_with_the_noise_of_the_target_has_to_gain_more() -> None:
    """The same columns under the name of a current pass less often, and never alone."""

    def passes(seed: int, variable: str) -> bool:
        screen, before, after = drawn(seed, amplitude=5.0)
        renamed = replace(after.last, evidence=Evidence((variable,)))
        return beats_chance(screen, before, replace(after, variants=(Variant(renamed, {}),)))

    found = [(passes(seed, "velocity"), passes(seed, "current")) for seed in range(40)]

    assert not any(strict and not plain for plain, strict in found)
    assert 0 < sum(strict for _, strict in found) < sum(plain for plain, _ in found) < 40


def test_few_seconds_say_nothing() -> None:
    """A log of fewer than 32 seconds is left to the other tests: a few signs soon repeat what was seen."""
    screen, before, after = drawn(0)
    short = replace(screen.balance.rows, t=T / 4.0, block=np.arange(N) // (N // 4))
    few = Screen(replace(screen.balance, rows=short), screen.candidates)

    assert beats_chance(few, few.fit([]), few.fit(after.variants))
    assert not beats_chance(screen, before, after)


def test_the_level_of_chance_is_that_of_all_columns_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """However many columns are taken at a time, every draw has the same signs for all of them."""
    found = search({2: 3.0}, *(candidate(f"c{k}", {k: 1.0, k + 1: 0.3}) for k in range(2, 12)))
    levels = []
    for at_once in (1, 3, 256):
        monkeypatch.setattr(limits, "COLUMNS_AT_ONCE", at_once)
        levels.append(stability.null_quantile(found.screen, found.base))

    assert levels[0] > 0.0
    assert levels == pytest.approx([levels[2]] * 3, rel=1e-9)
