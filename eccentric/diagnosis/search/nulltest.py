"""Is anything missing? What noise and chance leave in a residual.

- `flipped_null`: the largest gain that any column of the library reaches by chance, from residuals with the
  signs of their blocks flipped at random: this preserves correlation within blocks, heteroscedasticity and
  the search.
- `beats_chance`: whether one fit predicts better than another by more than draws of such signs do. Noise
  of a drive is correlated and larger at some speeds and voltages than at others: a deviance alone takes what
  it leaves there for structure. Signs last a second; what differs from run to run is not drawn.

Reference: R. Davidson, E. Flachaire, "The wild bootstrap, tamed at last", Journal of Econometrics 146(1),
2008 (signs at random, on the residuals of the smaller model).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eccentric.diagnosis.search.crossval import Gram, groups_of, inverses, sum_of_each
from eccentric.diagnosis.search.limits import (
    AT_ONCE,
    CHANCE,
    COLUMNS_AT_ONCE,
    DRAWS,
    EXTRAPOLATED,
    LEAST_BLOCKS,
    LEVEL,
    SIGNS,
    TAIL,
    TINY_COLUMN,
    WITH_NOISE,
)
from eccentric.diagnosis.search.screen import Fitted, Screen
from eccentric.signals import blocks_of

Array = np.ndarray


def flipped_null(residual: Array, columns: Array, block: Array) -> Array:
    """Largest single-column gain, in units of the residual's variance, under random signs per block (DRAWS,).

    columns (rows, m) must be orthogonal to the base and of unit length. The signs are the same at every call:
    of several sets of columns, the largest gain of a draw is the larger one.
    """
    rng = np.random.default_rng(5)
    starts = np.flatnonzero(np.r_[True, block[1:] != block[:-1]])
    per_block = np.add.reduceat(columns * residual[:, None], starts, axis=0)
    signs = rng.choice([-1.0, 1.0], size=(DRAWS, len(starts)))
    return np.max((signs @ per_block) ** 2, axis=1) / float(np.mean(residual**2))


def null_quantile(screen: Screen, fitted: Fitted) -> float:
    """Quantile of the deviance that the best single column of a screen reaches by chance beside a fit."""
    residual = screen.residual(fitted)
    _, design, _ = screen.design(fitted.variants)
    q, _ = np.linalg.qr(design)
    gain = np.zeros(DRAWS)
    # A few columns at a time: copies of the library would be most of the memory of a long log.
    for start in range(0, screen.library.shape[1], COLUMNS_AT_ONCE):
        some = screen.library[:, start : start + COLUMNS_AT_ONCE]
        left = some - q @ (q.T @ some)
        length = np.linalg.norm(left, axis=0)
        kept = length > TINY_COLUMN * np.linalg.norm(some, axis=0)
        if np.any(kept):
            own = flipped_null(residual, left[:, kept] / length[kept], screen.block)
            gain = np.maximum(gain, own)
    return float(np.quantile(gain, LEVEL)) * screen.effective(fitted) / screen.rows


def beats_chance(screen: Screen, before: Fitted, after: Fitted) -> bool:
    """Whether `after` gains more over `before` than chance on a log where `before` is the truth.

    It has to beat every draw. A term of a signal with the target's noise, which the draws hold fixed, has to
    beat the level that one draw in ten thousand reaches, too: beyond a high level, gains are exponentially
    distributed (J. Pickands, Annals of Statistics 3(1), 1975). A draw is what `before`
    predicts plus its residual, the sign of every second of it at random; both models are cross-validated on
    it, a coefficient at its bound kept there. True for a log of too few seconds to draw from.
    """
    rows, block = screen.balance.rows, screen.block
    # From the first row of each block: its seconds begin with it.
    since = rows.t - rows.t[np.searchsorted(block, block)]
    second = np.arange(screen.rows) if rows.independent else blocks_of(since, block, since)
    count = int(second[-1]) + 1
    if count < LEAST_BLOCKS:
        return True
    residual = screen.residual(before)
    predicted = screen.balance.target - residual
    small, large = (_Drawn.of(screen, fitted, predicted, residual, second) for fitted in (before, after))
    gain, rng, drawn = np.log(before.score / after.score), np.random.default_rng(5), []
    for _ in range(SIGNS // AT_ONCE):
        signs = rng.choice([-1.0, 1.0], size=(count, AT_ONCE))
        first, then = small.losses(signs), large.losses(signs)
        if after.last.ridge:
            then = np.where(then > EXTRAPOLATED * first, first, then)
        drawn.append(np.log(first.sum(axis=0) / then.sum(axis=0)))
        if np.any(drawn[-1] >= gain):
            return False
    every = np.concatenate(drawn)
    if after.last.variable not in WITH_NOISE:
        return True
    high = np.quantile(every, 1.0 - TAIL)
    return bool(gain > high + np.mean(every[every > high] - high) * np.log(TAIL / CHANCE))


@dataclass(frozen=True)
class _Drawn:
    """The normal equations of a model on draws: of what is predicted, by block, and of a second's noise.

    fixed: of the prediction, blocks with rows only, as everywhere here; noise (seconds, p), squares, mixed
    (seconds,): the residual times the columns, itself and the prediction; starts (blocks,): the first second
    of each; group (blocks,): what the cross-validation leaves out together, as in `Screen.fit`; inverse
    (groups, p, p): of the normal equations without the blocks of a group.
    """

    fixed: Gram
    noise: Array
    squares: Array
    mixed: Array
    starts: Array
    group: Array
    inverse: Array

    @classmethod
    def of(cls, screen: Screen, fitted: Fitted, predicted: Array, residual: Array, second: Array) -> _Drawn:
        """Sums for a model; predicted, residual, second (rows,) are those of the smaller one."""
        target, design, lower = screen.design(fitted.variants)
        fixed = predicted - (screen.balance.target - target)
        # A coefficient at its bound stays there.
        free = ~(np.isfinite(lower) & (fitted.coefficients <= 0.0))
        design = design[:, free]
        numbers, block = np.unique(screen.block, return_inverse=True)
        group = np.unique(groups_of(int(numbers[-1]) + 1)[numbers], return_inverse=True)[1]
        first = np.flatnonzero(np.diff(second, prepend=-1))
        gram = Gram.of(design, fixed, block)
        others = gram.matrix.sum(axis=0) - sum_of_each(group, gram.matrix)
        return cls(
            gram,
            np.add.reduceat(design * residual[:, None], first, axis=0),
            np.bincount(second, residual**2),
            np.bincount(second, fixed * residual),
            np.flatnonzero(np.diff(block[first], prepend=-1)),
            group,
            inverses(others, screen.ridge(fitted.variants)[free]),
        )

    def losses(self, signs: Array) -> Array:
        """Cross-validated loss of every block and draw (blocks, draws); signs (seconds, draws)."""
        noise = self.noise[:, :, None] * signs[:, None, :]
        vector = self.fixed.vector[:, :, None] + np.add.reduceat(noise, self.starts, axis=0)
        square = self.squares[:, None] + 2.0 * self.mixed[:, None] * signs
        loss = self.fixed.square[:, None] + np.add.reduceat(square, self.starts, axis=0)
        others = vector.sum(axis=0) - sum_of_each(self.group, vector)
        c = (self.inverse @ others)[self.group]
        curved = np.einsum("bid,bid->bd", c, self.fixed.matrix @ c)
        loss += curved - 2.0 * np.einsum("bid,bid->bd", c, vector)
        return np.abs(loss)
