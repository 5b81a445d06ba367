"""The effect that comes closest where none is adopted, and what it takes out of the held-out error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from eccentric.diagnosis.limits import FITTED
from eccentric.diagnosis.models import Models
from eccentric.diagnosis.score import BelowLowPass, below_low_pass
from eccentric.effects import Effect
from eccentric.estimation import improvement, rms
from eccentric.fitting import refit
from eccentric.search import Attribution

__all__ = ["Closest", "closest_effect"]


@dataclass(frozen=True)
class Closest:
    """The best single effect of the search whose fit settles, and what it gains on the held-out part.

    effect: it; balance: the one that shows it; before, after: held-out RMSE of the paper's model and of the
    model with this effect, in the unit of the balance; percent: 100 (1 - after/before), with its 95 %
    `interval`; below: the same below the low pass, as in `Score`.
    """

    effect: Effect
    balance: str
    before: float
    after: float
    percent: float
    interval: tuple[float, float]
    below: BelowLowPass | None


def closest_effect(found: Attribution, offered: Sequence[Effect], models: Models) -> Closest | None:
    """The best effect of the search's first step, fitted; None if effects were adopted or none was found.

    The errors of different balances are not comparable: the effect that takes out the largest part of its
    balance's error is the best. One whose fit does not settle is passed over: what the rig leaves open may
    take its part without end.
    """
    firsts = [search for search in found.searches.values() if search.ranked]
    if models.adopted or not firsts or not models.fits_the_rig:
        return None
    best = min(firsts, key=lambda search: search.ranked[0].score / search.base.score)
    paper, by_id = models.paper, {effect.id: effect for effect in offered}
    tried = ((by_id[f.last.id], dict(f.variants[-1].values)) for f in best.ranked[:FITTED])
    fits = ((effect, refit(models.base, ((effect, values),), paper.data)) for effect, values in tried)
    effect, with_it = next(((effect, fit) for effect, fit in fits if fit.settled), (None, paper))
    if effect is None:
        return None
    rows, balance = paper.data.rows.score, best.screen.balance.name
    before, after = paper.residual_like(with_it, balance)[rows], with_it.residuals[balance][rows]
    return Closest(
        effect,
        balance,
        rms(before),
        rms(after),
        *improvement(before, after),
        below_low_pass(paper, with_it, balance),
    )
