"""Scores of candidates on one balance: whole grids at once, then the leaders refined and cross-validated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eccentric.diagnosis.search import limits
from eccentric.diagnosis.search.candidate import Candidate, Variant, bounds_of, grid, instrument_of, refined
from eccentric.diagnosis.search.crossval import (
    Gram,
    bounded_solve,
    bounded_solve_each,
    correlated,
    cross_validate,
    exogenous,
)
from eccentric.identification import BalanceDesign
from eccentric.model import Role

Array = np.ndarray


@dataclass(frozen=True)
class Fitted:
    """Base and variants fitted: coefficients of both, loss per block in sample and cross-validated."""

    variants: tuple[Variant, ...]
    coefficients: Array
    loss: Array
    cross: Array

    @property
    def score(self) -> float:
        """Cross-validated sum of squares."""
        return float(self.cross.sum())

    @property
    def families(self) -> frozenset[str]:
        """The families of the variants."""
        return frozenset(variant.candidate.family for variant in self.variants)

    @property
    def last(self) -> Candidate:
        """The candidate that was added last."""
        return self.variants[-1].candidate


class Screen:
    """One balance and the candidates for it, with their windowed columns kept.

    noise: RMS of a window that the sensors' white noise explains. A fit clearly below it is rejected, see
    `limits.BELOW_NOISE`.
    The columns of all grids form one matrix (rows, total), so that one product scores them all.
    """

    def __init__(self, balance: BalanceDesign, candidates: Sequence[Candidate], noise: float = 0.0) -> None:
        self.balance = balance
        self.candidates = candidates
        self.block = balance.rows.block
        self.rows = len(balance.target)
        self.floor = self.rows * noise**2
        self._kept: dict[tuple[object, ...], Array] = {}
        self._changed: dict[tuple[object, ...], tuple[Array | float, Array]] = {}
        self.points: list[Variant] = []
        self.where: list[slice] = []
        every = [grid(candidate) for candidate in candidates]
        first = [self._mean_columns(points[0]) for points in every]
        widths = [z.shape[1] * len(points) for z, points in zip(first, every, strict=True)]
        # In place: on a long log a copy of it would be most of the memory.
        library, at = np.empty((self.rows, sum(widths)), order="F"), 0
        for points, known in zip(every, first, strict=True):
            for variant in points:
                z = known if variant is points[0] else self._mean_columns(variant)
                if not np.all(np.isfinite(z)) or np.any(np.sum(z**2, axis=0) < limits.NOTHING**2 * self.rows):
                    continue
                self.points.append(variant)
                self.where.append(slice(at, at + z.shape[1]))
                library[:, self.where[-1]] = z
                at += z.shape[1]
        self._library: Array | None = library[:, :at]
        self.inner = [library[:, w].T @ library[:, w] for w in self.where]
        self._general = {family for c in candidates for family in c.evidence.special_of}
        self._index = {variant.key: number for number, variant in enumerate(self.points)}

    def release(self) -> None:
        """Forget all columns, most of the memory: those still asked for are computed again."""
        self._library = None
        self._kept.clear()
        self._changed.clear()

    @property
    def library(self) -> Array:
        """The columns of all grid points (rows, total)."""
        if self._library is None:
            self._library = np.empty((self.rows, max((w.stop for w in self.where), default=0)), order="F")
            for variant, where in zip(self.points, self.where, strict=True):
                self._library[:, where] = self._mean_columns(variant)
        return self._library

    def _mean_columns(self, variant: Variant) -> Array:
        return self.balance.rows.mean(variant.candidate.columns(variant.values))

    def columns(self, variant: Variant, beside: Sequence[Variant] = ()) -> Array:
        """Windowed columns (rows, k) of a variant, scaled by those beside it; none if it changes the base."""
        candidate = variant.candidate
        if candidate.changes is not None:
            return np.empty((self.rows, 0))
        scaling = [v for v in beside if v.candidate.scales is not None and set(candidate.roles) - {Role.NONE}]
        key = (*variant.key, *(v.key for v in scaling))
        if key in self._index and self._library is not None:
            return self._library[:, self.where[self._index[key]]]
        if key not in self._kept:
            if len(self._kept) > limits.MOST_KEPT:
                self._kept.clear()
            samples = candidate.columns(variant.values)
            for other in scaling:
                if other.candidate.scales is not None:
                    samples = samples * other.candidate.scales(other.values).on(candidate.roles)
            self._kept[key] = self.balance.rows.mean(samples)
        return self._kept[key]

    def design(self, variants: Sequence[Variant]) -> tuple[Array, Array, Array]:
        """Target (rows,), base and columns (rows, q), and the lower bounds of their coefficients (q,)."""
        known, base = self._base(variants)
        parts = [self.columns(variant, variants) for variant in variants]
        lower = [bounds_of(v.candidate, part.shape[1]) for v, part in zip(variants, parts, strict=True)]
        return (
            self.balance.target - known,
            np.hstack([base, *parts]),
            np.concatenate([self.balance.lower, *lower]),
        )

    def _base(self, variants: Sequence[Variant]) -> tuple[Array | float, Array]:
        """The known contribution of the variants that change the base, and the base with their changes."""
        changing = [v for v in variants if v.candidate.changes is not None]
        if not changing:
            return 0.0, self.balance.columns
        key = tuple(variant.key for variant in changing)
        if key not in self._changed:
            if len(self._changed) > limits.MOST_KEPT:
                self._changed.clear()
            replacing = [v for v in changing if v.candidate.scales is None]
            known, samples = self._replaced(replacing)
            for variant in changing:
                if variant.candidate.scales is not None:
                    samples = samples * variant.candidate.scales(variant.values).base
            mean = self.balance.rows.mean
            # Columns that stay as they are have passed the low pass, some of them before they were averaged.
            changed = np.any(samples != self.balance.samples, axis=0)
            base = self.balance.columns.copy()
            base[:, changed] = mean(samples[:, changed])
            self._changed[key] = (mean(known) if replacing else 0.0, base)
        return self._changed[key]

    def _replaced(self, replacing: Sequence[Variant]) -> tuple[Array, Array]:
        """What is known to be missing (samples,), and the base's columns with what these variants replace."""
        known, samples = np.zeros(len(self.balance.samples)), self.balance.samples
        for variant in replacing:
            if variant.candidate.changes is not None:
                more, changed = variant.candidate.changes(variant.values)
                known = known + more
                # To first order changes add up, whatever the order of adoption.
                samples = changed if variant is replacing[0] else samples + changed - self.balance.samples
        return known, samples

    def fit(self, variants: Sequence[Variant]) -> Fitted:
        """Bounded fit of base and variants, with its blocked cross-validation."""
        target, design, lower = self.design(variants)
        gram = Gram.of(design, target, self.block)
        ridge = self.ridge(variants)
        coefficients = bounded_solve(gram.matrix.sum(axis=0), gram.vector.sum(axis=0), lower, ridge)
        cross = cross_validate(gram, lower, ridge)
        if np.any(ridge):
            without = self.fit([v for v in variants if not v.candidate.ridge]).cross
            cross = np.where(cross > limits.EXTRAPOLATED * without, without, cross)
        return Fitted(tuple(variants), coefficients, gram.loss(coefficients), cross)

    def ridge(self, variants: Sequence[Variant]) -> Array:
        """The penalty on every coefficient (q,) of a design."""
        own = [np.full(self.columns(v).shape[1], v.candidate.ridge) for v in variants]
        return np.concatenate([np.zeros(self.balance.columns.shape[1]), *own])

    def residual(self, fitted: Fitted) -> Array:
        """Target minus base and variants, (rows,)."""
        target, design, _ = self.design(fitted.variants)
        return target - design @ fitted.coefficients

    def own(self, fitted: Fitted) -> list[Array]:
        """The coefficients of each variant's columns, none for one whose parameters are all shapes."""
        widths = [self.columns(variant).shape[1] for variant in fitted.variants]
        ends = self.balance.columns.shape[1] + np.cumsum(widths)
        return [fitted.coefficients[end - width : end] for end, width in zip(ends, widths, strict=True)]

    def first_look(self, variants: Sequence[Variant]) -> list[tuple[float, int]]:
        """(in-sample loss of the bounded fit, number) of every candidate's best grid point beside `variants`.

        Best first. All points share one matrix product. What changes the base is fitted at each of its
        points, or takes the loss of its derivative if that is better: its grid may be coarse.
        """
        target, design, lower = self.design(variants)
        taken = {v.candidate.id for v in variants}
        closed = {v.candidate.family for v in variants if not v.candidate.evidence.repeats}
        inner, right, total = design.T @ design, design.T @ target, float(target @ target)
        mixed, cross = design.T @ self.library, self.library.T @ target
        best: dict[str, tuple[float, int]] = {}
        slope: dict[str, float] = {}
        numbers = [
            number
            for number, variant in enumerate(self.points)
            if variant.candidate.id not in taken and variant.candidate.family not in closed
        ]
        losses = self._losses(numbers, (inner, right, total), (mixed, cross), lower)
        for number, linear in zip(numbers, losses.tolist(), strict=True):
            variant, loss = self.points[number], linear
            candidate = variant.candidate
            if candidate.changes is not None:
                slope[candidate.id] = min(linear, slope.get(candidate.id, np.inf))
                loss = float(np.sum(self._left([*variants, variant]) ** 2))
            if candidate.id not in best or loss < best[candidate.id][0]:
                best[candidate.id] = (loss, number)
        return sorted((min(loss, slope.get(name, loss)), number) for name, (loss, number) in best.items())

    def _losses(
        self,
        numbers: Sequence[int],
        base: tuple[Array, Array, float],
        library: tuple[Array, Array],
        lower: Array,
    ) -> Array:
        """The losses (n,) of points by number, each beside a base.

        base: its products with itself (q, q) and with the target (q,), and the target's square; library:
        products of all columns of the points with the base (q, total) and with the target (total,).
        """
        (inner, right, total), (mixed, cross), q = base, library, len(lower)
        losses = np.empty(len(numbers))
        widths = np.array([len(self.inner[number]) for number in numbers], int)
        for width in np.unique(widths).tolist():
            places = np.flatnonzero(widths == width)
            own = [numbers[place] for place in places.tolist()]
            columns = np.array([np.arange(self.where[n].start, self.where[n].stop) for n in own])
            matrix = np.empty((len(own), q + width, q + width))
            matrix[:, :q, :q], matrix[:, q:, q:] = inner, np.array([self.inner[n] for n in own])
            matrix[:, :q, q:] = np.moveaxis(mixed[:, columns], 0, 1)
            matrix[:, q:, :q] = np.swapaxes(matrix[:, :q, q:], 1, 2)
            vector = np.hstack([np.broadcast_to(right, (len(own), q)), cross[columns]])
            bounds = np.array([np.r_[lower, bounds_of(self.points[n].candidate, width)] for n in own])
            c = bounded_solve_each(matrix, vector, bounds)
            with np.errstate(over="ignore", invalid="ignore"):
                losses[places] = total + np.sum(c * ((matrix @ c[..., None])[..., 0] - 2.0 * vector), axis=1)
        return losses

    def rank(self, variants: Sequence[Variant], leaders: int = limits.LEADERS) -> list[Fitted]:
        """Every candidate added to `variants`, best cross-validated score first.

        The leaders' shapes are refined, those of the best few together with the shapes of `variants`; what
        changes the base takes a few steps before it is compared.
        """
        look = self.first_look(variants)[: 4 * leaders]
        fitted = [self.fit([*variants, self.points[number]]) for _, number in look]
        fitted = [f if f.last.changes is None else self.refine(f, True, limits.FIRST_STEPS) for f in fitted]
        fitted.sort(key=lambda f: f.score)
        head = sorted((self.refine(f, only_last=True) for f in fitted[:leaders]), key=lambda f: f.score)
        if any(variant.candidate.shapes for variant in variants):
            # A smooth term would bend the effects beside it to itself.
            few = [f if f.last.ridge else self.refine(f) for f in head[: limits.TOGETHER]]
            head = [*few, *head[limits.TOGETHER :]]
        honest = [
            f
            for f in [*head, *fitted[leaders:]]
            if self.itself(f) and self.possible(f) and self._of_the_drive(f)
        ]
        return sorted(honest, key=lambda f: f.score)

    def effective(self, fitted: Fitted) -> float:
        """How many independent rows the residual of a fit counts as."""
        residual, independent = self.residual(fitted), self.balance.rows.independent
        return self.rows / correlated(residual, self.block, independent)

    def deviance(self, before: Fitted, after: Fitted) -> float:
        """Twice the gain in log-likelihood from one fit to another, of the cross-validated scores."""
        return self.effective(after) * float(np.log(before.score / after.score))

    def possible(self, fitted: Fitted) -> bool:
        """Whether a fit with all coefficients in their ranges is as good.

        Without ranges, a torque constant and an inertia that both go to 0 leave a balance of zeros. Noise may
        move a value from an end of its range to either side.
        """
        low, high = self._ranges(fitted)
        beyond = (fitted.coefficients < low) | (fitted.coefficients > high)
        if not np.any(beyond):
            return True
        target, design, lower = self.design(fitted.variants)
        held = fitted.coefficients
        while np.any((held < low) | (held > high)):
            beyond |= (held < low) | (held > high)
            held = np.clip(held, low, high)
            rest, free = target - design[:, beyond] @ held[beyond], design[:, ~beyond]
            held[~beyond] = bounded_solve(free.T @ free, free.T @ rest, lower[~beyond])
        left = target - design @ held
        return bool(self.effective(fitted) * np.log(left @ left / fitted.loss.sum()) < limits.CONFIRMED)

    def _ranges(self, fitted: Fitted) -> tuple[Array, Array]:
        """Lowest and highest value of each coefficient of a fit, base first (q,)."""
        open_ = (-np.inf, np.inf)
        every = [open_] * self.balance.columns.shape[1]
        for variant, own in zip(fitted.variants, self.own(fitted), strict=True):
            every += variant.candidate.ranges or [open_] * len(own)
        low, high = np.reshape(every, (-1, 2)).T
        return low, high

    def _of_the_drive(self, fitted: Fitted) -> bool:
        """Whether what the last variant explains is not the noise of its own signals.

        A fit far below the sensors' noise must have that noise on both sides, or be free of it for certain.
        """
        if fitted.loss.sum() > limits.BELOW_NOISE * self.floor:
            return True
        return self.exogenous(fitted.variants[:-1], fitted.variants[-1])

    def exogenous(self, others: Sequence[Variant], variant: Variant) -> bool:
        """Whether instruments find what least squares finds for a variant beside others."""
        twin = instrument_of(variant)
        if twin is None or variant.candidate.changes is not None:
            return False
        target, base, _ = self.design(others)
        return exogenous(target, base, self.columns(variant, [*others, variant]), self.columns(twin))

    def itself(self, fitted: Fitted, place: int = -1) -> bool:
        """Whether a variant, by default the last, keeps the term that names its effect, its first one.

        Without it the rest is another family: a bristle model without bristle stiffness is a Stribeck curve,
        a cable without stiffness a constant torque. Where the library has that family, the term has to be
        worth what an effect is.
        """
        own, variant = self.own(fitted)[place], fitted.variants[place]
        whole = variant.candidate
        if len(own) < 2 or not np.isfinite(bounds_of(whole, len(own))[0]):
            return True
        if own[0] <= 0.0 or whole.family not in self._general:
            return bool(own[0] > 0.0)
        rest = replace(
            whole,
            id=f"{whole.id} (without its name)",
            columns=lambda values: whole.columns(values)[:, 1:],
            lower=tuple(bounds_of(whole, len(own))[1:]),
            ranges=whole.ranges[1:],
            roles=whole.roles[1:],
        )
        others = [v for v in fitted.variants if v is not variant]
        without = self.fit([*others, Variant(rest, variant.values)])
        return self.deviance(without, fitted) > limits.LEAST_DEVIANCE

    def refine(self, fitted: Fitted, only_last: bool = False, steps: int = limits.STEPS) -> Fitted:
        """Shapes improved by nonlinear least squares: of all variants together, or of the last."""
        first = len(fitted.variants) - 1 if only_last else 0
        kept, turning = fitted.variants[:first], fitted.variants[first:]
        if not any(variant.candidate.shapes for variant in turning):
            return fitted
        found = refined(turning, lambda variants: self._left([*kept, *variants]), steps)
        better = self.fit([*kept, *found])
        return better if better.loss.sum() <= fitted.loss.sum() else fitted

    def _left(self, variants: Sequence[Variant]) -> Array:
        """What the bounded fit of base and variants leaves (rows,)."""
        target, design, lower = self.design(variants)
        return target - design @ bounded_solve(design.T @ design, design.T @ target, lower)


def fitted_variants(
    balances: Sequence[BalanceDesign], pools: Sequence[Sequence[Candidate]], noise: Mapping[str, float]
) -> list[tuple[Variant, tuple[float, ...]] | None]:
    """For each pool its best variant beside those of the other pools, with the coefficients of its columns.

    balances: of the training part; pools: the candidates that one name stands for, such as the members of a
    family; noise: RMS of a window, by balance. None for a pool of which no candidate fits.
    """
    found: dict[int, tuple[Variant, tuple[float, ...]]] = {}
    for balance in balances:
        own = {k: [c for c in pool if c.balance == balance.name] for k, pool in enumerate(pools)}
        adopted: list[Variant] = []
        order = []
        for k, candidates in own.items():
            ranked = Screen(balance, candidates, noise.get(balance.name, 0.0)).rank(adopted)
            if ranked:
                adopted = list(ranked[0].variants)
                order.append(k)
        screen = Screen(balance, [c for k in order for c in own[k]])
        last = screen.refine(screen.fit(adopted))
        for k, variant, coefficients in zip(order, last.variants, screen.own(last), strict=True):
            found[k] = (variant, tuple(map(float, coefficients)))
    return [found.get(k) for k in range(len(pools))]
