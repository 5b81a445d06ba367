"""Residual attribution: which effects, in which order, and how sure.

Balances one after the other, the electrical first (what a current sensor's bias or delay does to the
mechanical balance is taken out of it):

1. forward: the candidate with the best cross-validated score is adopted while it is worth it;
2. each step also tries the best partners of the first search's runners-up and every swap of one term for
   another (what looks best alone need not be in the best pair); terms that no longer earn their place leave;
3. each adopted term is compared with its alternatives, the others kept: their scores give probabilities;
4. smooth terms try what is left. If they still take out a part of the structure, no candidate explains it.

Scores are n_eff/2 log(cross-validated sum of squares), n_eff from the autocorrelation of the best residual: a
residual that still has structure counts as few samples and decides little.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from eccentric.search.candidates import Candidate
from eccentric.search.nulltest import correlated, null_quantile, smooth_terms
from eccentric.search.selection import Fitted, Screen
from eccentric.signals import BalanceDesign

__all__ = ["Rules", "Search", "search_all"]

Array = np.ndarray


@dataclass(frozen=True)
class Rules:
    """Limits of the decision, calibrated on the development seeds of the virtual bench.

    least_deviance: twice the log-likelihood that an addition must gain; below it may be chance. Controls stay
        below 16, see `nulltest.null_quantile` for a log's own level.
    least_share: RMS that an addition must take out of the residual, as a fraction of the balance's scale.
        Below it lie the errors of filters and of the sampling of voltage and current.
    least_part: the same squared, as a fraction of all the structure found so far.
    clears: part of what is left above the sensors' floor that a second or third effect must take out; less is
        a patch on the form of the first one.
    at_floor: sum of squares, in units of the sensors' floor, at which nothing further is looked for.
    sure: probability from which an effect is named. A special case tied with its general form has 0.88; a
        third family tied with both takes it below.
    special: log-odds that a special case has over the family that contains it.
    unexplained_part: part of the structure that a smooth term must take out beyond the effects to refuse a
        name.
    most_effects: adopted at most per balance.
    """

    least_deviance: float = 20.0
    least_share: float = 0.002
    least_part: float = 0.0003
    clears: float = 0.5
    sure: float = 0.8
    at_floor: float = 1.02
    special: float = 2.0
    unexplained_part: float = 0.04
    most_effects: int = 3


@dataclass
class Search:
    """The search on one balance.

    base: the paper's model alone; best: with the adopted terms; ranked: the first step's candidates;
    smoothed: smooth terms beside the adopted ones; alternatives: per adopted term, family -> (probability,
        fit).
    """

    screen: Screen
    smooth: Screen
    rules: Rules
    base: Fitted
    best: Fitted
    ranked: list[Fitted] = field(default_factory=list)
    smoothed: list[Fitted] = field(default_factory=list)
    alternatives: list[dict[str, tuple[float, Fitted]]] = field(default_factory=list)

    def run(self) -> None:
        """Adopt, compare, and let the smooth terms try."""
        while len(self.best.terms) < self.rules.most_effects:
            if self.best.terms and self.best.score < self.rules.at_floor * self.screen.floor:
                break
            ranked = self.screen.rank(self.best.terms)
            self.ranked = self.ranked or ranked
            tried = [self._swapped(self.screen.refine(fitted)) for fitted in ranked[:2]]
            if len(self.best.terms) == 1:
                tried += self._pairs()
            tried = [f for f in tried if self.worth_it(self.best, f) and self._clears(self.best, f)]
            if not tried:
                break
            self.best = self._pruned(min(tried, key=lambda f: f.score))
        self._compare()
        self.smoothed = self.smooth.rank(self.best.terms)

    def deviance(self, before: Fitted, after: Fitted, screen: Screen | None = None) -> float:
        """Twice the gain in log-likelihood from one fit to another, of the cross-validated scores."""
        return self._effective(after, screen or self.screen) * float(np.log(before.score / after.score))

    def worth_it(self, before: Fitted, after: Fitted, screen: Screen | None = None) -> bool:
        """Whether a fit improves on another beyond chance and beyond the errors of filters and sampling."""
        gain, rules = before.score - after.score, self.rules
        return (
            gain > rules.least_part * (self.base.score - after.score)
            and gain > self.screen.rows * (rules.least_share * self.screen.balance.scale) ** 2
            and self.deviance(before, after, screen) > rules.least_deviance
        )

    def null_level(self) -> float:
        """The deviance that the best of the library reaches by chance on this log, 99 % quantile."""
        return null_quantile(self.screen, self.best)

    def _effective(self, fitted: Fitted, screen: Screen) -> float:
        return screen.rows / correlated(screen, screen.residual(fitted))

    def _clears(self, before: Fitted, after: Fitted) -> bool:
        if not before.terms:
            return True
        floor = min(self.screen.floor, after.score)
        return before.score - after.score > self.rules.clears * (before.score - floor)

    def _pairs(self) -> list[Fitted]:
        """Best partner of the leading other families of the first step."""
        seen, found = {self.best.terms[0].candidate.family}, []
        for fitted in self.ranked:
            family = fitted.terms[-1].candidate.family
            if family in seen or len(seen) > 3 or not self.worth_it(self.base, fitted):
                continue
            seen.add(family)
            partners = self.screen.rank(fitted.terms, leaders=3)
            found += [self._swapped(self.screen.refine(partner)) for partner in partners[:1]]
        return found

    def _swapped(self, fitted: Fitted) -> Fitted:
        """Each term against all others in its place, until none is better by half a per cent."""
        if len(fitted.terms) == 1:
            return fitted
        for place in [*range(len(fitted.terms))] * 2:
            others = [term for k, term in enumerate(fitted.terms) if k != place]
            found = self.screen.rank(others, leaders=4)
            if found and found[0].score < 0.995 * fitted.score:
                fitted = self.screen.refine(found[0])
        return fitted

    def _pruned(self, fitted: Fitted) -> Fitted:
        for place in range(len(fitted.terms)):
            without = self.screen.fit([term for k, term in enumerate(fitted.terms) if k != place])
            if len(fitted.terms) > 1 and not self.worth_it(without, fitted):
                return self._pruned(self.screen.refine(without))
        return fitted

    def _compare(self, turns: int = 3) -> None:
        """Probabilities of the families in the place of each adopted term, the others kept.

        A special case that explains the log as well as the family that contains it takes the place.
        """
        effective = self._effective(self.best, self.screen)
        self.alternatives = []
        for place, term in enumerate(self.best.terms):
            rivals = {term.candidate.family: (term, self.best)}
            for fitted in self.screen.rank([t for k, t in enumerate(self.best.terms) if k != place]):
                family = fitted.terms[-1].candidate.family
                if family not in rivals or fitted.score < rivals[family][1].score:
                    rivals[family] = (fitted.terms[-1], fitted)
            log = {
                family: -0.5 * effective * float(np.log(fitted.score))
                - 0.5 * len(own.shape)
                + self.rules.special * any(general in rivals for general in own.candidate.special_of)
                for family, (own, fitted) in rivals.items()
            }
            first = max(log, key=lambda family: log[family])
            if rivals[first][1] is not self.best and turns:
                self.best = self.screen.refine(rivals[first][1])
                self._compare(turns - 1)
                return
            weight = {family: float(np.exp(value - log[first])) for family, value in log.items()}
            total = sum(weight.values())
            self.alternatives.append({f: (weight[f] / total, fitted) for f, (_, fitted) in rivals.items()})


def search_all(
    balances: Sequence[BalanceDesign],
    channels: Any,
    candidates: Sequence[Candidate],
    mu: float,
    gravity: Array,
    noise: Mapping[str, float] | None = None,
    rules: Rules | None = None,
    progress: Callable[[str], None] | None = None,
) -> dict[str, Search]:
    """Run the search on every balance, by name.

    balances: mechanical, electrical or both, training windows only; channels: smooth signals as the
    candidates take them; mu: gear ratio; gravity (samples,): torque of gravity on the motor side [N m];
    noise: RMS of a window that the sensors' white noise explains, per balance (`nulltest.sensor_noise`);
    progress: told one line before and after each balance.
    """
    rules, tell = rules or Rules(), progress or (lambda _: None)
    found: dict[str, Search] = {}
    for given in sorted(balances, key=lambda b: b.name):
        own = [c for c in candidates if c.balance == given.name]
        tell(f"{given.name} balance: {len(own)} candidates on {len(given.target)} windows")
        electrical = found.get("electrical")
        balance = given if electrical is None else _corrected(given, channels, electrical)
        screen = Screen(balance, channels, own, (noise or {}).get(balance.name, 0.0))
        valid = balance.rows.used_samples()
        smooth = Screen(balance, channels, smooth_terms(channels, balance.name, mu, gravity, valid))
        base = screen.fit([])
        found[balance.name] = Search(screen, smooth, rules, base, base)
        found[balance.name].run()
        names = ", ".join(t.candidate.id for t in found[balance.name].best.terms)
        tell(f"{balance.name} balance: {names or 'nothing adopted'}")
    return found


def _corrected(balance: BalanceDesign, channels: Any, electrical: Search) -> BalanceDesign:
    """The mechanical target without what effects found in the electrical balance add to it."""
    target, at = balance.target, electrical.screen.balance.base.shape[1]
    for term in electrical.best.terms:
        width = electrical.screen.columns(term).shape[1]
        if term.candidate.also is not None:
            added = balance.rows.mean(term.candidate.also(channels, term.shape))
            own = electrical.best.coefficients[at : at + width]
            target = target - (added if added.ndim == 1 else added @ own)
        at += width
    return replace(balance, target=target)
