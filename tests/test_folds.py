"""Folds of the cross-validation: neighbours apart, and what determines a coefficient spread over them."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from eccentric.search.crossval import fold_of_block
from eccentric.search.limits import FOLDS, ORDER_OF_FOLDS

SIZE = 10


def folds(levels: list[float]) -> np.ndarray:
    """The folds of a log whose blocks have a constant, and a column of this level each."""
    block = np.repeat(np.arange(len(levels)), SIZE)
    return fold_of_block(np.column_stack([np.ones(len(block)), np.asarray(levels)[block]]), block, FOLDS)


def test_every_run_of_neighbours_holds_each_fold_once() -> None:
    """A drift is seen by all folds, also at the end of the log, which has a part of a run."""
    fold = folds([0.0] * 20)

    for first in (0, FOLDS):
        assert sorted(fold[first : first + FOLDS]) == list(range(FOLDS))
    assert len(set(fold[2 * FOLDS :])) == 20 - 2 * FOLDS


def in_one_fold_by_chance() -> list[tuple[int, int]]:
    """Pairs of blocks that the first order drawn puts into one fold."""
    rng = np.random.default_rng(ORDER_OF_FOLDS)
    first = np.concatenate([rng.permutation(FOLDS) for _ in range(5)])
    return [(a, b) for a, b in itertools.combinations(range(5 * FOLDS), 2) if first[a] == first[b]][::20]


@pytest.mark.parametrize("pair", in_one_fold_by_chance())
def test_the_two_blocks_that_determine_a_coefficient_are_in_two_folds(pair: tuple[int, int]) -> None:
    """With both left out, nothing would be known of it."""
    levels = [1.0 if k in pair else 0.0 for k in range(40)]
    fold = folds(levels)

    assert fold[pair[0]] != fold[pair[1]]


def test_no_fold_holds_most_of_a_coefficient() -> None:
    """Six fast blocks of 64, each with a sixth of it: no two of them share a fold."""
    fast = (0, 9, 18, 27, 36, 45)
    fold = folds([1.0 if k in fast else 0.0 for k in range(64)])

    assert all(fold[a] != fold[b] for a, b in itertools.combinations(fast, 2))


def test_a_log_has_the_same_folds_again() -> None:
    """And a balance without base columns has some too."""
    levels = np.linspace(0.0, 1.0, 30).tolist()
    block = np.repeat(np.arange(30), SIZE)

    np.testing.assert_array_equal(folds(levels), folds(levels))
    assert set(fold_of_block(np.empty((len(block), 0)), block, FOLDS)) == set(range(FOLDS))
