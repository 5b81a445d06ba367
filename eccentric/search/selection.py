"""Scores of candidates on one balance: whole grids at once, then the leaders refined and cross-validated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize

from eccentric.search.candidates import Candidate, Shape, shape_grid
from eccentric.search.crossval import Gram, bounded_solve, cross_validate, fold_of_block
from eccentric.signals import BalanceDesign

__all__ = ["Fitted", "Screen", "Term"]

Array = np.ndarray

_MOST_KEPT = 400


@dataclass(frozen=True)
class Term:
    """A candidate at one shape."""

    candidate: Candidate
    shape: Shape

    @property
    def key(self) -> tuple[object, ...]:
        """What tells it from other terms."""
        return (self.candidate.id, *self.shape.values())


@dataclass(frozen=True)
class Fitted:
    """Base and terms fitted: coefficients of both, loss per block in sample and cross-validated."""

    terms: tuple[Term, ...]
    coefficients: Array
    loss: Array
    cross: Array

    @property
    def score(self) -> float:
        """Cross-validated sum of squares."""
        return float(self.cross.sum())


class Screen:
    """One balance, its channels and the candidates for it, with their windowed columns kept.

    noise: RMS of a window that the sensors' white noise explains.  A fit clearly below it has noise on both
    sides of its equation (the measured current as a regressor of itself) and is dropped.
    Columns of all shape grids lie side by side (rows, total), so that one matrix product scores them all.
    """

    def __init__(
        self,
        balance: BalanceDesign,
        channels: Any,
        candidates: Sequence[Candidate],
        noise: float = 0.0,
        folds: int = 8,
    ) -> None:
        self.balance, self.channels = balance, channels
        self.block = balance.rows.block
        self.rows = len(balance.target)
        self.floor = self.rows * noise**2
        self.fold = fold_of_block(int(self.block[-1]) + 1, folds)
        self._kept: dict[tuple[object, ...], Array] = {}
        self._replaced: dict[tuple[object, ...], tuple[Array, Array]] = {}
        self.points: list[Term] = []
        self.where: list[slice] = []
        columns, at = [], 0
        for candidate in candidates:
            for shape in shape_grid(candidate):
                z = balance.rows.mean(candidate.columns(channels, shape))
                if not np.all(np.isfinite(z)) or np.any(np.sum(z**2, axis=0) < 1e-24 * self.rows):
                    continue
                self.points.append(Term(candidate, shape))
                columns.append(z)
                self.where.append(slice(at, at + z.shape[1]))
                at += z.shape[1]
        self.library = np.hstack(columns) if columns else np.empty((self.rows, 0))
        self.inner = [self.library[:, w].T @ self.library[:, w] for w in self.where]
        self._index = {term.key: number for number, term in enumerate(self.points)}

    def columns(self, term: Term) -> Array:
        """Windowed columns (rows, k) of a term; none if it acts by replacing."""
        if term.candidate.replaces is not None:
            return np.empty((self.rows, 0))
        key = term.key
        if key in self._index:
            return self.library[:, self.where[self._index[key]]]
        if key not in self._kept:
            if len(self._kept) > _MOST_KEPT:
                self._kept.clear()
            self._kept[key] = self.balance.rows.mean(term.candidate.columns(self.channels, term.shape))
        return self._kept[key]

    def design(self, terms: Sequence[Term]) -> tuple[Array, Array, Array]:
        """Target (rows,), base and columns (rows, q), and their least coefficients (q,)."""
        target, base = self.balance.target, self.balance.base
        samples, lower = self.balance.samples, [self.balance.lower]
        replacing = [term for term in terms if term.candidate.replaces is not None]
        if replacing:
            key = tuple(term.key for term in replacing)
            if key not in self._replaced:
                if len(self._replaced) > _MOST_KEPT:
                    self._replaced.clear()
                known = np.zeros(len(samples))
                for term in replacing:
                    if term.candidate.replaces is not None:
                        more, samples = term.candidate.replaces(self.channels, term.shape, samples)
                        known = known if more is None else known + more
                self._replaced[key] = (self.balance.rows.mean(known), self.balance.rows.mean(samples))
            known, base = self._replaced[key]
            target = target - known
        parts = [self.columns(term) for term in terms]
        for term, part in zip(terms, parts, strict=True):
            lower.append(_bounds(term.candidate, part.shape[1]))
        return target, np.hstack([base, *parts]), np.concatenate(lower)

    def fit(self, terms: Sequence[Term]) -> Fitted:
        """Bounded fit of base and terms, with its blocked cross-validation."""
        target, design, lower = self.design(terms)
        gram = Gram.of(design, target, self.block)
        ridge = np.zeros(design.shape[1])
        for term, end in zip(terms, np.cumsum([self.columns(term).shape[1] for term in terms]), strict=True):
            width = self.columns(term).shape[1]
            at = self.balance.base.shape[1] + end
            ridge[at - width : at] = term.candidate.ridge
        coefficients = bounded_solve(gram.matrix.sum(axis=0), gram.vector.sum(axis=0), lower, ridge)
        cross = cross_validate(gram, lower, self.fold, ridge)
        if np.any(ridge):
            # where a smooth term has to extrapolate it says nothing
            without = self.fit([term for term in terms if not term.candidate.ridge]).cross
            cross = np.where(cross > 4.0 * without, without, cross)
        return Fitted(tuple(terms), coefficients, gram.loss(coefficients), cross)

    def residual(self, fitted: Fitted) -> Array:
        """Target minus base and terms, (rows,)."""
        target, design, _ = self.design(fitted.terms)
        return target - design @ fitted.coefficients

    def first_look(self, terms: Sequence[Term]) -> list[tuple[float, int]]:
        """(in-sample loss of the bounded fit, number) of every candidate's best grid point beside `terms`.

        Best first. All points share one matrix product. What changes the base is fitted anew at each of its
        points, and stands where its derivative would stand if that is better: its grid may be coarse.
        """
        target, design, lower = self.design(terms)
        taken = {term.candidate.id for term in terms}
        closed = {term.candidate.family for term in terms if not term.candidate.repeats}
        inner, right, total = design.T @ design, design.T @ target, float(target @ target)
        mixed, cross = design.T @ self.library, self.library.T @ target
        best: dict[str, tuple[float, int]] = {}
        slope: dict[str, float] = {}
        for number, term in enumerate(self.points):
            candidate, where = term.candidate, self.where[number]
            if candidate.id in taken or candidate.family in closed:
                continue
            matrix = np.block([[inner, mixed[:, where]], [mixed[:, where].T, self.inner[number]]])
            vector = np.r_[right, cross[where]]
            c = bounded_solve(matrix, vector, np.r_[lower, _bounds(candidate, len(vector) - len(right))])
            loss = total + float(c @ matrix @ c - 2.0 * c @ vector)
            if candidate.replaces is not None:
                slope[candidate.id] = min(loss, slope.get(candidate.id, np.inf))
                loss = self._loss([*terms, term])
            if candidate.id not in best or loss < best[candidate.id][0]:
                best[candidate.id] = (loss, number)
        return sorted((min(loss, slope.get(name, loss)), number) for name, (loss, number) in best.items())

    def rank(self, terms: Sequence[Term], leaders: int = 8) -> list[Fitted]:
        """Every candidate added to `terms`, best cross-validated score first.

        The leaders' shapes are refined; what changes the base takes a few steps before it is compared.
        """
        look = self.first_look(terms)[: 4 * leaders]
        fitted = [self.fit([*terms, self.points[number]]) for _, number in look]
        fitted = [f if f.terms[-1].candidate.replaces is None else self.refine(f, True, 10) for f in fitted]
        fitted.sort(key=lambda f: f.score)
        head = [self.refine(f, only_last=True) for f in fitted[:leaders]]
        honest = [f for f in [*head, *fitted[leaders:]] if f.loss.sum() > 0.8 * self.floor and self.itself(f)]
        return sorted(honest, key=lambda f: f.score)

    def itself(self, fitted: Fitted) -> bool:
        """Whether the last term holds what its effect is named for: its first coefficient is not at 0.

        Without it the rest stands for another family: a bristle model whose bristles do nothing is a Stribeck
        curve.
        """
        term = fitted.terms[-1]
        width = self.columns(term).shape[1]
        if width < 2 or not np.isfinite(_bounds(term.candidate, width)[0]):
            return True
        return bool(fitted.coefficients[-width] > 0.0)

    def _loss(self, terms: Sequence[Term]) -> float:
        target, design, lower = self.design(terms)
        matrix, vector = design.T @ design, design.T @ target
        c = bounded_solve(matrix, vector, lower)
        return float(target @ target + c @ matrix @ c - 2.0 * c @ vector)

    def refine(self, fitted: Fitted, only_last: bool = False, evaluations: int = 30) -> Fitted:
        """Shapes improved by simplex search of the bounded fit: of every term in turn, or the last."""
        terms = list(fitted.terms)
        for turn in [len(terms) - 1] if only_last else range(len(terms)):
            if terms[turn].candidate.shape:
                terms[turn] = self._refined(terms, turn, evaluations)
        if all(new is old for new, old in zip(terms, fitted.terms, strict=True)):
            return fitted
        better = self.fit(terms)
        return better if better.loss.sum() <= fitted.loss.sum() else fitted

    def _refined(self, terms: list[Term], turn: int, evaluations: int) -> Term:
        candidate = terms[turn].candidate
        scaled = {
            name: (low, high, scale == "log") for name, (low, high, scale, _) in candidate.shape.items()
        }

        def shape_of(point: Array) -> Shape:
            values = zip(scaled.items(), np.clip(point, 0.0, 1.0), strict=True)
            return {
                name: float(low * (high / low) ** x if log else low + (high - low) * x)
                for (name, (low, high, log)), x in values
            }

        def loss(point: Array) -> float:
            return self._loss([*terms[:turn], Term(candidate, shape_of(point)), *terms[turn + 1 :]])

        start = np.array(
            [
                np.log(terms[turn].shape[name] / low) / np.log(high / low)
                if log
                else (terms[turn].shape[name] - low) / (high - low)
                for name, (low, high, log) in scaled.items()
            ]
        )
        steps = np.array([0.6 / max(count - 1, 2) for _, _, _, count in candidate.shape.values()])
        simplex = np.vstack([start, start + np.diag(np.where(start + steps <= 1.0, steps, -steps))])
        found = minimize(
            loss,
            start,
            method="Nelder-Mead",
            options={
                "initial_simplex": simplex,
                "maxfev": evaluations * len(steps),
                "xatol": 1e-3,
                "fatol": 1e-12,
            },
        )
        return Term(candidate, shape_of(found.x))


def _bounds(candidate: Candidate, width: int) -> Array:
    """Least coefficients of a candidate's columns; a single one given for many columns holds for all."""
    own = np.asarray(candidate.lower, float)
    return own if len(own) == width else np.full(width, own[0])
