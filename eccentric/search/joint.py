"""An effect that both balances show, estimated from both: one may leave open what the other determines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eccentric.search.candidate import Variant
from eccentric.search.crossval import bounded_solve
from eccentric.search.limits import STEPS
from eccentric.search.refinement import refined
from eccentric.search.screen import Fitted, Screen
from eccentric.signals import BalanceDesign

__all__ = ["Beside", "BothBalances"]

Array = np.ndarray
Beside = tuple[Array, Array]
"""Columns of a mechanical effect (rows, k), and the lower bounds of their coefficients (k,)."""


class BothBalances:
    """The variants of the electrical balance on both balances, each weighted by what a fit leaves in it.

    The mechanical base is free, and so are the effects `beside` it; what all of these lack counts as noise.
    """

    def __init__(
        self, screen: Screen, found: Fitted, mechanical: BalanceDesign, beside: Sequence[Beside]
    ) -> None:
        self._screen, self._mechanical = screen, mechanical
        self._base = np.hstack([mechanical.columns, *(columns for columns, _ in beside)])
        self._lower = np.concatenate([mechanical.lower, *(lower for _, lower in beside)])
        self.variants = list(found.variants)
        # Coefficients of its own in each balance: the weights do not depend on how well the shapes agree.
        design, target = np.hstack([self._also(self.variants), self._base]), mechanical.target
        rest = target - design @ np.linalg.lstsq(design, target, rcond=None)[0]
        self._weights = screen.rows / found.loss.sum(), len(rest) / float(rest @ rest)

    def run(self) -> list[Array]:
        """Refine the shapes; return the coefficients of each variant."""
        shown = [k for k, v in enumerate(self.variants) if v.candidate.joint and v.candidate.shapes]

        def placed(variants: Sequence[Variant]) -> list[Variant]:
            new = dict(zip(shown, variants, strict=True))
            return [new.get(k, variant) for k, variant in enumerate(self.variants)]

        if shown:
            own = [self.variants[k] for k in shown]
            self.variants = placed(refined(own, lambda v: self._solved(placed(v))[0], STEPS))
        widths = [self._screen.columns(variant).shape[1] for variant in self.variants]
        ends = self._screen.balance.columns.shape[1] + np.cumsum([0, *widths])
        return np.split(self._solved(self.variants)[1], ends)[1:-1]

    def _solved(self, variants: Sequence[Variant]) -> tuple[Array, Array]:
        """Weighted residual and coefficients: of the circuit's base, the variants, the mechanical base."""
        target, own, lower = self._screen.design(variants)
        here = np.hstack([own, np.zeros((len(target), self._base.shape[1]))])
        rows, free = len(self._mechanical.target), self._screen.balance.columns.shape[1]
        there = np.hstack([np.zeros((rows, free)), self._also(variants), self._base])
        one, other = np.sqrt(self._weights)
        x, y = np.vstack([one * here, other * there]), np.r_[one * target, other * self._mechanical.target]
        c = bounded_solve(x.T @ x, x.T @ y, np.r_[lower, self._lower])
        return y - x @ c, c

    def _also(self, variants: Sequence[Variant]) -> Array:
        """What the variants add to the mechanical target, (rows, k)."""
        rows = self._mechanical.rows
        return np.hstack(
            [
                np.zeros((len(self._mechanical.target), self._screen.columns(variant).shape[1]))
                if variant.candidate.also is None
                else rows.mean(variant.candidate.also(variant.values))
                for variant in variants
            ]
        )
