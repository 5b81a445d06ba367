"""The best achievable result on a log: the true structure, fitted on the same rows by the same methods."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from eccentric.diagnosis import Diagnosis
from eccentric.effects import library
from eccentric.identification import Refit, refit

STRETCHES = 20


@dataclass(frozen=True)
class Oracle:
    """The result of a fit that knows the true families.

    balance: the one that shows the first of them; rmse: held out, with all of them [N m];
    over_paper, over_answer: by how many standard errors the truth predicts the held-out part better than the
    paper's model, and than the extended model of the diagnosis; over_less: the least, over the effects of a
    pair, of that over the truth without the effect, in the balance that shows it best.
    """

    balance: str
    rmse: float
    over_paper: float
    over_answer: float
    over_less: float


def oracle(found: Diagnosis, families: Collection[str]) -> Oracle | None:
    """The best result on a log with these effects.

    Of each family the member and the shapes that fit the training part best. Where even so the paper's model
    predicts better (a state that the low pass blurs), its error counts. None where the library has no such
    family for this log.
    """
    effects = {effect.id: effect for effect in library(found.setting)}
    wanted, adopted, shown = set(families), [], ""
    for balance, search in found.attribution.searches.items():
        screen, best = search.screen, search.base
        while options := [
            p for p in screen.points if p.candidate.family in wanted and p.candidate.id in effects
        ]:
            # A start from the best point of every member: grids are coarse.
            fits = [screen.fit([*best.variants, point]) for point in options]
            members = {f.last.id: f for f in sorted(fits, key=lambda f: -f.loss.sum())}
            best = min((screen.refine(f) for f in members.values()), key=lambda f: f.loss.sum())
            wanted.discard(best.last.family)
            shown = shown or balance
        adopted += [(effects[v.candidate.id], dict(v.values)) for v in best.variants]
    if wanted:
        return None
    balance, fitted = shown or "mechanical", refit(found.models.base, tuple(adopted), found.data)
    paper = found.models.paper
    less = [
        refit(found.models.base, tuple(one for k, one in enumerate(adopted) if k != left_out), found.data)
        for left_out in (range(len(adopted)) if len(adopted) > 1 else ())
    ]
    return Oracle(
        balance,
        min(fitted.held_out(balance), paper.held_out(balance)),
        _over(fitted, paper, balance),
        _over(fitted, found.models.extended, balance),
        min((max(_over(fitted, other, b) for b in fitted.residuals) for other in less), default=0.0),
    )


def _over(fitted: Refit, other: Refit, balance: str) -> float:
    """By how many standard errors the first predicts the held-out part of a balance better."""
    score = fitted.data.rows.score
    return _z((other.residuals[balance] ** 2 - fitted.residuals[balance] ** 2)[score])


def _z(gain: np.ndarray) -> float:
    """Mean over its standard error, from means of stretches: neighbouring rows are correlated."""
    means = np.array([part.mean() for part in np.array_split(gain, STRETCHES)])
    error = float(means.std(ddof=1) / np.sqrt(STRETCHES))
    return float(means.mean()) / error if error else 0.0
