"""How stable a search is: which effects it would have found had an engineer chosen otherwise.

A hundred variants of the log. In each, every model that came close is fitted and cross-validated. They differ
in

- the blocks: four fifths of them, as if others had been held out, or half of them, drawn at random;
- the rows: as they are, or means of two neighbours (a lower bandwidth);
- the declared values: as they are, or estimated, with the standard deviation that their usual tolerance
  leaves (R, k_i, k_e: 2 %, J: 5 %).

Every part of the log has the weight of the whole.

The best model of a variant is the one with the best score. A family is stable if it is part of the best
model of nearly every variant, whatever is beside it.

After N. Meinshausen, P. Buehlmann, "Stability selection", J. Royal Statistical Society B 72(4), 2010 (who
take halves), and J. H. Huggins, J. W. Miller, "Reproducible model selection using bagged posteriors",
Bayesian Analysis 18(1), 2023 (who draw with replacement, and take the mean of the posterior over the draws);
JCGM 100:2008 (GUM), 4.3.7 (the standard deviation of a value of which only a tolerance is known).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field

import numpy as np

from eccentric.diagnosis.search import limits
from eccentric.diagnosis.search.candidate import Candidate, Variant
from eccentric.diagnosis.search.crossval import (
    Gram,
    cross_validate_each,
    groups_of,
    inverses,
    spans,
    sum_of_each,
)
from eccentric.diagnosis.search.screen import Fitted, Screen
from eccentric.signals import blocks_of

Array = np.ndarray


@dataclass(frozen=True)
class Stability:
    """What the variants of a log found; nothing where it has too few blocks."""

    # of each variant: families of its best model and of declared values off
    best: tuple[frozenset[str], ...] = ()
    # such a set -> its mean posterior weight
    weights: Mapping[frozenset[str], float] = field(default_factory=dict)

    @property
    def variants(self) -> int:
        """The number of variants."""
        return len(self.best)

    def found(self, *families: str) -> int:
        """In how many variants one of the families is part of the best model."""
        return sum(not own.isdisjoint(families) for own in self.best)

    def nearly_all(self, *families: str) -> bool:
        """Whether nearly every variant finds one of the families, or there are none to say otherwise."""
        return self.found(*families) >= limits.STABLE * self.variants

    def instead(
        self, family: str, beside: AbstractSet[str], declared: AbstractSet[str], most: int
    ) -> dict[str, int]:
        """What the best model has where it lacks a family: the families that are not `beside` it.

        First the `declared` values, then the effect that most of the remaining variants have, then that
        of what it leaves, up to `most`: what only accompanies one of them is no alternative. Each with the
        number of variants that it adds; of equals, the first by name.
        """
        missing = [families - beside for families in self.best if family not in families]
        found: dict[str, int] = {}
        for pool, number in ((declared, len(declared)), (None, most)):
            for _ in range(number):
                counts = Counter(f for families in missing for f in families if pool is None or f in pool)
                if not counts:
                    break
                other = min(counts, key=lambda name: (-counts[name], name))
                found[other] = counts[other]
                missing = [families for families in missing if other not in families]
        return found

    def weight(self, family: str, lacking: AbstractSet[str] = frozenset()) -> float:
        """The mean weight of the models that have a family, or that have it and lack all of some others."""
        return sum(w for own, w in self.weights.items() if family in own and own.isdisjoint(lacking))

    def chances(self, family: str, others: Iterable[str]) -> dict[str, float]:
        """The weight of a family, and of others in its place, most first; of equals, the first by name.

        One that only accompanies a likely other has what weight is left without that one.
        """
        found = {family: self.probability(family)}
        for other in sorted(others, key=lambda other: (-self.weight(other, {family}), other)):
            likely = {taken for taken, chance in found.items() if chance > limits.POSSIBLE}
            found[other] = self.weight(other, {family} | likely)
        return found

    @property
    def most(self) -> float:
        """The probability of a family that every variant finds, by the rule of succession."""
        return (self.variants + 1.0) / (self.variants + 2.0)

    def probability(self, family: str) -> float:
        """The weight of a family by the rule of succession: no number of variants proves a certainty."""
        return (self.variants * self.weight(family) + 1.0) / (self.variants + 2.0)


def stability_of(screen: Screen, models: Sequence[Fitted]) -> Stability:
    """The best of some models in every variant of a log.

    models: those that came close, each with its own effects, the adopted one first. A declared value that it
    corrects is not free in any of them.
    """
    first, count = models[0], int(screen.block[-1]) + 1
    # Where two predict alike, the one with fewer effects is the better.
    models = sorted(models, key=lambda fitted: len(fitted.variants))
    if count < limits.LEAST_BLOCKS:
        return Stability()
    adopted = {variant.candidate.id for variant in first.variants}
    free = [c for c in screen.candidates if c.tolerance and c.id not in adopted and not _open(screen, c)]
    effective = screen.effective(first)
    given = free, first.score / effective, effective, _draws(count)
    found = [_evidence(screen, fitted, *given) for fitted in models]
    log = np.stack([evidence for evidence, _ in found], axis=1)
    log += np.array([_bonus(fitted, models, len(adopted)) for fitted in models])
    weight = np.exp(log - log.max(axis=1, keepdims=True))
    weight /= weight.sum(axis=1, keepdims=True)
    # Model, then variant.
    families = [[m.families | moved for moved in every] for m, (_, every) in zip(models, found, strict=True)]
    weights: dict[frozenset[str], float] = {}
    for own, shares in zip(families, weight.T, strict=True):
        for one, share in zip(own, shares, strict=True):
            weights[one] = weights.get(one, 0.0) + float(share) / len(shares)
    best = tuple(families[int(k)][variant] for variant, k in enumerate(np.argmax(log, axis=1)))
    return Stability(best, weights)


def _open(screen: Screen, candidate: Candidate) -> bool:
    """Whether the base has the column of a declared value already: the rig file leaves it to be estimated."""
    _, base, _ = screen.design([])
    return spans(base, screen.columns(Variant(candidate, {})))


def _bonus(fitted: Fitted, models: Sequence[Fitted], adopted: int) -> float:
    """Log-odds of a model before its fit counts.

    Special cases of what another model has speak for it, shapes and effects against it, and how many orders
    there are of which an effect is one. An effect more than were adopted has to gain what adoption requires.
    """
    every = frozenset().union(*(model.families for model in models))
    own = [variant.candidate.evidence.special_of for variant in fitted.variants]
    special = sum(bool(every & set(general)) for general in own)
    orders = sum(float(np.log(variant.candidate.evidence.one_of)) for variant in fitted.variants)
    shapes = sum(len(variant.values) for variant in fitted.variants)
    further = max(len(own) - adopted, 0)
    cost = limits.CONFIRMED * (len(own) - further) + limits.LEAST_DEVIANCE * further
    return limits.IN_A_DRAW * (limits.SPECIAL * special - orders) - 0.5 * (shapes + cost)


def _draws(count: int) -> list[Array]:
    """The blocks of each variant, by number, in ascending order."""
    rng = np.random.default_rng(limits.ORDER_OF_DRAWS)
    # Four of each size in turn: rows and declared values come in up to four combinations, in turn as well.
    sizes = [round(limits.PARTS[k // 4 % 2] * count) for k in range(limits.VARIANTS)]
    return [np.sort(rng.permutation(count)[:size]) for size in sizes]


def _evidence(
    screen: Screen,
    fitted: Fitted,
    free: Sequence[Candidate],
    noise: float,
    effective: float,
    draws: Sequence[Array],
) -> tuple[Array, list[frozenset[str]]]:
    """Log-likelihood of a model in every variant (variants,), but for what all models have in common.

    Also, for each variant, the families of declared values that it had to be off by more than `limits.WRONG`.

    free: declared values that every second variant leaves free; noise: variance of one of the `effective`
    number of independent rows, which weighs a log against a declared value and its deviation.
    """
    target, design, lower = screen.design(fitted.variants)
    extra = [screen.columns(Variant(c, {}), fitted.variants) for c in free]
    stacked, p = np.column_stack([target, design, *extra]), design.shape[1]
    bands = [(stacked, screen.block)]
    # Blocks of one row each, as a short coast-down has, leave no two to average.
    if not screen.balance.rows.independent and len((halved := _means_of_two(stacked, screen.block))[1]):
        bands.append(halved)
    deviation = np.array([candidate.deviation for candidate in free])
    count = int(screen.block[-1]) + 1
    settings = [(_others(rows[:, : 1 + p], block, count), lower, np.zeros(p)) for rows, block in bands] + [
        (
            _others(rows, block, count),
            np.r_[lower, np.full(len(free), -np.inf)],
            np.r_[np.zeros(p), _held(rows[:, 1 + p :], noise, deviation)],
        )
        for rows, block in bands
        if len(free)
    ]
    # A log without noise leaves rounding.
    least = np.finfo(float).eps * float(screen.balance.target @ screen.balance.target)
    found, moved = np.empty(len(draws)), [frozenset[str]()] * len(draws)
    together: dict[tuple[int, int], list[int]] = {}
    for number, chosen in enumerate(draws):
        together.setdefault((number % len(settings), len(chosen)), []).append(number)
    for (setting, _), numbers in together.items():
        gram, bounds, prior = settings[setting]
        drawn = gram.of_blocks(np.array([draws[number] for number in numbers]))
        losses, whole = cross_validate_each(drawn, bounds, prior)
        # There are none where the declared values are not free.
        off = whole[:, p:] / deviation[: whole.shape[1] - p]
        score = np.maximum(losses.sum(axis=1), least)
        found[numbers] = -0.5 * (effective * np.log(score) + np.sum(off**2, axis=1))
        for number, own in zip(numbers, np.abs(off) > limits.WRONG, strict=True):
            moved[number] = frozenset(c.family for c, wrong in zip(free, own, strict=False) if wrong)
    return found, moved


def _held(columns: Array, noise: float, deviation: Array) -> Array:
    """Penalties (k,) on the coefficients of columns (rows, k), in units of the scaled diagonal."""
    return noise / (deviation**2 * np.maximum(np.sum(columns**2, axis=0), np.finfo(float).tiny))


def _others(rows: Array, block: Array, count: int) -> Gram:
    """The normal equations of the first column by the others, for each block; a block may have no rows."""
    return Gram.of(rows[:, 1:], rows[:, 0], block, count)


def _means_of_two(rows: Array, block: Array) -> tuple[Array, Array]:
    """Means of neighbouring rows of one block, with their blocks."""
    same = block[1:] == block[:-1]
    return 0.5 * (rows[1:] + rows[:-1])[same], block[1:][same]


# Is anything missing? What noise and chance leave in a residual.
#
# - `flipped_null`: the largest gain that any column of the library reaches by chance, from residuals with the
# signs of their blocks flipped at random: this preserves correlation within blocks, heteroscedasticity and
# the search.
# - `beats_chance`: whether one fit predicts better than another by more than draws of such signs do. Noise
# of a drive is correlated and larger at some speeds and voltages than at others: a deviance alone takes what
# it leaves there for structure. Signs last a second; what differs from run to run is not drawn.
#
# Reference: R. Davidson, E. Flachaire, "The wild bootstrap, tamed at last", Journal of Econometrics 146(1),
# 2008 (signs at random, on the residuals of the smaller model).
def flipped_null(residual: Array, columns: Array, block: Array) -> Array:
    """Largest single-column gain, in units of the residual's variance, under random signs per block (DRAWS,).

    columns (rows, m) must be orthogonal to the base and of unit length. The signs are the same at every call:
    of several sets of columns, the largest gain of a draw is the larger one.
    """
    rng = np.random.default_rng(5)
    starts = np.flatnonzero(np.r_[True, block[1:] != block[:-1]])
    per_block = np.add.reduceat(columns * residual[:, None], starts, axis=0)
    signs = rng.choice([-1.0, 1.0], size=(limits.DRAWS, len(starts)))
    return np.max((signs @ per_block) ** 2, axis=1) / float(np.mean(residual**2))


def null_quantile(screen: Screen, fitted: Fitted) -> float:
    """Quantile of the deviance that the best single column of a screen reaches by chance beside a fit."""
    residual = screen.residual(fitted)
    _, design, _ = screen.design(fitted.variants)
    q, _ = np.linalg.qr(design)
    gain = np.zeros(limits.DRAWS)
    # A few columns at a time: copies of the library would be most of the memory of a long log.
    for start in range(0, screen.library.shape[1], limits.COLUMNS_AT_ONCE):
        some = screen.library[:, start : start + limits.COLUMNS_AT_ONCE]
        left = some - q @ (q.T @ some)
        length = np.linalg.norm(left, axis=0)
        kept = length > limits.TINY_COLUMN * np.linalg.norm(some, axis=0)
        if np.any(kept):
            own = flipped_null(residual, left[:, kept] / length[kept], screen.block)
            gain = np.maximum(gain, own)
    return float(np.quantile(gain, limits.LEVEL)) * screen.effective(fitted) / screen.rows


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
    if count < limits.LEAST_BLOCKS:
        return True
    residual = screen.residual(before)
    predicted = screen.balance.target - residual
    small, large = (_Drawn.of(screen, fitted, predicted, residual, second) for fitted in (before, after))
    gain, rng, drawn = np.log(before.score / after.score), np.random.default_rng(5), []
    for _ in range(limits.SIGNS // limits.AT_ONCE):
        signs = rng.choice([-1.0, 1.0], size=(count, limits.AT_ONCE))
        first, then = small.losses(signs), large.losses(signs)
        if after.last.ridge:
            then = np.where(then > limits.EXTRAPOLATED * first, first, then)
        drawn.append(np.log(first.sum(axis=0) / then.sum(axis=0)))
        if np.any(drawn[-1] >= gain):
            return False
    every = np.concatenate(drawn)
    if after.last.variable not in limits.WITH_NOISE:
        return True
    high = np.quantile(every, 1.0 - limits.TAIL)
    return bool(gain > high + np.mean(every[every > high] - high) * np.log(limits.TAIL / limits.CHANCE))


@dataclass(frozen=True)
class _Drawn:
    """The normal equations of a model on draws: of what is predicted, by block, and of a second's noise."""

    fixed: Gram  # of the prediction, blocks with rows only, as everywhere here
    noise: Array  # (seconds, p): the residual times the columns
    squares: Array  # (seconds,): the residual times itself
    mixed: Array  # (seconds,): times the prediction
    starts: Array  # (blocks,): the first second of each
    group: Array  # (blocks,): what the cross-validation leaves out together, as in `Screen.fit`
    inverse: Array  # (groups, p, p): of the normal equations without the blocks of a group

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
