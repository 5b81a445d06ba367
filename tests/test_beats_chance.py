"""A gain counts if it beats what the noise of the log itself makes, correlated and unequal as it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eccentric.diagnosis.search import stability
from eccentric.diagnosis.search.candidate import Candidate, Variant
from eccentric.diagnosis.search.limits import EXTRAPOLATED, MOST_GROUPS
from eccentric.diagnosis.search.screen import Fitted, Screen
from eccentric.diagnosis.search.stability import _Drawn, beats_chance
from eccentric.effects import Evidence
from eccentric.identification import balance_design
from eccentric.signals.rows import Rows
from tests.searched import candidate, search

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
    assert not any(beats_chance(*drawn(seed, late=late)) for seed in range(60))


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
        assert len(numbers) > MOST_GROUPS
        residual = screen.residual(before)
        predicted = screen.balance.target - residual
        of_one_block = np.cumsum(np.diff(screen.block, prepend=-1) != 0) - 1
        found = _Drawn.of(screen, after, predicted, residual, of_one_block)

        losses, without = found.losses(np.ones((len(numbers), 1)))[:, 0], before.cross[numbers]
        # A block in which the curves extrapolate counts for nothing.
        losses = np.where(losses > EXTRAPOLATED * without, without, losses)
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
        monkeypatch.setattr(stability, "COLUMNS_AT_ONCE", at_once)
        levels.append(stability.null_quantile(found.screen, found.base))

    assert levels[0] > 0.0
    assert levels == pytest.approx([levels[2]] * 3, rel=1e-9)
