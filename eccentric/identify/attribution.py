"""Residual attribution: which effects, in which order, and how sure.

On each balance, the electrical one first (a current bias found there also enters the mechanical one):

1. forward: the candidate with the best cross-validated score is adopted while it is `worth_it`;
2. after each adoption all shapes are refined and every adopted term is tried against all others in its place
   (what looked best alone need not be part of the best pair), and terms that no longer earn their place leave;
3. each adopted term is then compared with its alternatives, the others kept: their scores give probabilities;
4. smooth terms try what is left. If they still take out a part of the structure, the library does not explain it.

Scores are n_eff/2 log(cross-validated sum of squares), with n_eff from the autocorrelation of the best residual:
a residual that still has structure counts as few samples and decides nothing by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from eccentric.identify.candidates import Candidate
from eccentric.identify.nulltest import inflation, null_quantile, smooth_terms
from eccentric.identify.residual import Balance
from eccentric.identify.selection import Fitted, Screen, Term

__all__ = ["Attribution", "Ranked", "Rules", "attribute"]

Array = np.ndarray


@dataclass(frozen=True)
class Rules:
    """Limits of the decision; calibrated on the development seeds of the virtual bench, see docs/method.md.

    least_deviance: 2 log-likelihood gain below which an addition may be chance or numerical error.
    least_share: RMS that an addition must take out of the residual, as a fraction of the balance's scale.
    least_part: the same squared, as a fraction of all the structure found so far.
    sure: probability from which an effect is named.
    unexplained_part: part of the structure that smooth terms may take out beyond the named effects.
    most_effects: adopted at most per balance.
    special: log-odds that a special case has over the family that contains it.
    clears: part of what is left above the sensors' floor that a second or third effect must take out.
    """

    least_deviance: float = 20.0
    least_share: float = 0.002
    least_part: float = 0.0003
    sure: float = 0.75
    unexplained_part: float = 0.04
    most_effects: int = 3
    clears: float = 0.5
    special: float = 2.0


@dataclass(frozen=True)
class Ranked:
    """A candidate as it stands in the list: id, family, balance, cross-validated RMSE [N m], probability."""

    id: str
    family: str
    balance: str
    rmse: float
    probability: float


@dataclass(frozen=True)
class Attribution:
    """What was decided.

    verdict as in the diagnosis; terms: adopted, by balance, in order of what they take out; tied: families that
    explain the log alike; candidates: best first; depends_on: variables of the residual (of the paper's model),
    strongest first; deviance: what the best addition gained on each balance, against its null quantile.
    """

    verdict: str
    terms: tuple[tuple[str, Term, float], ...]
    tied: tuple[str, ...]
    candidates: tuple[Ranked, ...]
    depends_on: tuple[str, ...]
    fits: dict[str, tuple[Fitted, Fitted]]
    deviance: dict[str, tuple[float, float]] = field(default_factory=dict)


@dataclass
class _Side:
    """The state of the search on one balance."""

    screen: Screen
    smooth: Screen
    rules: Rules
    base: Fitted
    best: Fitted
    ranked: list[Fitted] = field(default_factory=list)
    smoothed: list[Fitted] = field(default_factory=list)
    alternatives: list[dict[str, tuple[float, Fitted]]] = field(default_factory=list)

    def effective(self, fitted: Fitted, screen: Screen | None = None) -> float:
        residual = (screen or self.screen).residual(fitted)
        return self.screen.rows / max(2.0, inflation(residual, self.screen.block))

    def deviance(self, before: Fitted, after: Fitted, screen: Screen | None = None) -> float:
        return self.effective(after, screen) * float(np.log(before.score / after.score))

    def worth_it(self, before: Fitted, after: Fitted, screen: Screen | None = None) -> bool:
        gain = before.score - after.score
        rows, scale = self.screen.rows, self.screen.balance.scale
        return (
            gain > self.rules.least_part * (self.base.score - after.score)
            and gain > rows * (self.rules.least_share * scale) ** 2
            and self.deviance(before, after, screen) > self.rules.least_deviance
        )

    def search(self) -> None:
        while len(self.best.terms) < self.rules.most_effects:
            ranked = self.screen.rank(self.best.terms)
            if not self.ranked:
                self.ranked = ranked
            tried = [self.swap(self.screen.refine(f)) for f in ranked[:2]]
            if len(self.best.terms) == 1:
                tried += self.pairs()
            tried = [f for f in tried if self.worth_it(self.best, f) and self.clears(self.best, f)]
            if not tried:
                return
            self.best = self.prune(min(tried, key=lambda f: f.score))

    def pairs(self) -> list[Fitted]:
        """Best partner of each runner-up of the first search: the best single effect need not be in the best pair."""
        first = self.best.terms[0].candidate.family
        families = {first}
        found = []
        for fitted in self.ranked:
            family = fitted.terms[-1].candidate.family
            if family in families or len(families) > 3 or not self.worth_it(self.base, fitted):
                continue
            families.add(family)
            partners = self.screen.rank(fitted.terms, leaders=3)
            if partners:
                found.append(self.swap(self.screen.refine(partners[0])))
        return found

    def clears(self, before: Fitted, after: Fitted) -> bool:
        """A further effect must take out most of what the ones before left above the floor, or it is a patch."""
        if not before.terms:
            return True
        floor = min(self.screen.floor, after.score)
        return before.score - after.score > self.rules.clears * (before.score - floor)

    def swap(self, fitted: Fitted) -> Fitted:
        """Each term against all others in its place, until none is better."""
        for _ in range(2):
            start = fitted
            for place in range(len(fitted.terms)):
                if len(fitted.terms) == 1:
                    return fitted
                others = [term for k, term in enumerate(fitted.terms) if k != place]
                found = self.screen.rank(others, leaders=4)
                if found and found[0].score < 0.995 * fitted.score:
                    fitted = self.screen.refine(found[0])
                    break
            if fitted is start:
                break
        return fitted

    def prune(self, fitted: Fitted) -> Fitted:
        """Without the terms that do not earn their place beside the others."""
        for place in range(len(fitted.terms)):
            without = self.screen.fit([term for k, term in enumerate(fitted.terms) if k != place])
            if len(fitted.terms) > 1 and not self.worth_it(without, fitted):
                return self.prune(self.screen.refine(without))
        return fitted

    def compare(self, turns: int = 3) -> None:
        """Probability of each family in the place of each adopted term, the others kept.

        Where a special case explains the log as well as the family that contains it, it takes the place.
        """
        effective = self.effective(self.best)
        self.alternatives = []
        for place, term in enumerate(self.best.terms):
            others = [t for k, t in enumerate(self.best.terms) if k != place]
            rivals = {term.candidate.family: self.best}
            for fitted in self.screen.rank(others):
                family = fitted.terms[-1].candidate.family
                if family not in rivals or fitted.score < rivals[family].score:
                    rivals[family] = fitted
            log = {}
            for family, fitted in rivals.items():
                own = term if fitted is self.best else fitted.terms[-1]
                log[family] = -0.5 * effective * float(np.log(fitted.score)) - 0.5 * len(own.shape)
                if any(general in rivals for general in own.candidate.special_of):
                    log[family] += self.rules.special
            first = max(log, key=lambda family: log[family])
            if rivals[first] is not self.best and turns:
                self.best = self.screen.refine(rivals[first])
                return self.compare(turns - 1)
            weight = {family: float(np.exp(value - log[first])) for family, value in log.items()}
            total = sum(weight.values())
            self.alternatives.append({family: (weight[family] / total, rivals[family]) for family in rivals})
        return None


def attribute(
    balances: Sequence[Balance], channels: Any, candidates: Sequence[Candidate], mu: float, gravity: Array,
    noise: Mapping[str, float] | None = None, rules: Rules | None = None, progress: Callable[[str], None] | None = None,
) -> Attribution:
    """Attribute the residuals of one log (training part only) to candidates.

    balances: mechanical, electrical or both; channels: smooth signals as the candidates take them; mu: gear ratio;
    gravity (samples,): torque of gravity on the motor side [N m]; noise: RMS of a window that the sensors' white
    noise explains, per balance (`nulltest.sensor_noise`).
    """
    rules, tell = rules or Rules(), progress or (lambda text: None)
    sides: dict[str, _Side] = {}
    for balance in sorted(balances, key=lambda b: b.name):
        own = [c for c in candidates if c.balance == balance.name]
        tell(f"{balance.name} balance: {len(own)} candidates on {len(balance.target)} windows")
        if balance.name == "mechanical" and "electrical" in sides:
            balance = _with_electrical(balance, channels, sides["electrical"].best, sides["electrical"].screen)
        screen = Screen(balance, channels, own, (noise or {}).get(balance.name, 0.0))
        base = screen.fit([])
        side = _Side(screen, Screen(balance, channels, smooth_terms(channels, balance.name, mu, gravity)), rules, base, base)
        side.search()
        side.smoothed = side.smooth.rank(side.best.terms)
        side.compare()
        tell(f"{balance.name} balance: " + (", ".join(t.candidate.id for t in side.best.terms) or "nothing adopted"))
        sides[balance.name] = side
    return _verdict(sides, rules)


def _with_electrical(balance: Balance, channels: Any, found: Fitted, screen: Screen) -> Balance:
    """The mechanical target without what the effects found in the electrical balance add to it."""
    target, at = balance.target, screen.balance.base.shape[1]
    for term in found.terms:
        width = screen.columns(term).shape[1]
        if term.candidate.also is not None:
            added = balance.windows(term.candidate.also(channels, term.shape))
            target = target - (added if added.ndim == 1 else added @ found.coefficients[at : at + width])
        at += width
    return replace(balance, target=target)


def _dependence(side: _Side) -> list[tuple[float, str]]:
    """Variables of the base residual: share of its structure that a smooth term in each takes out, best first."""
    floor = min([side.best.score, *[f.score for f in side.smoothed]])
    structure = max(side.base.score - floor, 1e-300)
    found = []
    for fitted in side.smooth.rank([]):
        if side.worth_it(side.base, fitted, side.smooth):
            found.append(((side.base.score - fitted.score) / structure, fitted.terms[-1].candidate.depends_on[0]))
    return sorted(found, reverse=True)


def _verdict(sides: dict[str, _Side], rules: Rules) -> Attribution:
    terms: list[tuple[str, Term, float]] = []
    tied: list[str] = []
    ranked: list[Ranked] = []
    left: list[tuple[float, str]] = []
    depends: list[tuple[float, str]] = []
    deviance: dict[str, tuple[float, float]] = {}
    for name, side in sides.items():
        rows = side.screen.rows
        for place, term in enumerate(side.best.terms):
            others = side.screen.fit([t for k, t in enumerate(side.best.terms) if k != place])
            taken = np.sqrt(max(others.score - side.best.score, 0.0) / rows) / side.screen.balance.scale
            probability = side.alternatives[place][term.candidate.family][0]
            terms.append((name, term, float(taken)))
            ranked.append(Ranked(term.candidate.id, term.candidate.family, name, float(np.sqrt(side.best.score / rows)), probability))
            if probability < rules.sure:
                order = sorted(side.alternatives[place].items(), key=lambda item: -item[1][0])
                tied += [family for family, (p, _) in order if p > 0.05]
        for fitted in side.smoothed:
            if side.worth_it(side.best, fitted, side.smooth):
                part = (side.best.score - fitted.score) / max(side.base.score - fitted.score, 1e-300)
                if part > rules.unexplained_part:
                    left.append((part, fitted.terms[-1].candidate.depends_on[0]))
        depends += _dependence(side)
        if side.ranked:
            best = side.ranked[0]
            deviance[name] = (side.deviance(side.base, best), null_quantile(side.screen, side.best))
    runners: dict[str, Ranked] = {}
    for name, side in sides.items():
        for options in side.alternatives:
            for family, (probability, fitted) in options.items():
                entry = Ranked(_differing(fitted, side.best), family, name, float(np.sqrt(fitted.score / side.screen.rows)), probability)
                if family not in runners or runners[family].probability < probability:
                    runners[family] = entry
        for fitted in side.ranked:
            c = fitted.terms[-1].candidate
            runners.setdefault(c.family, Ranked(c.id, c.family, name, float(np.sqrt(fitted.score / side.screen.rows)), 0.0))
    order = np.argsort([-share for _, _, share in terms], kind="stable")
    terms, ranked = [terms[k] for k in order], [ranked[k] for k in order]
    named = {r.family for r in ranked}
    ranked += sorted((r for r in runners.values() if r.family not in named), key=lambda r: (-r.probability, r.rmse))
    left.sort(reverse=True)
    if left:
        verdict = "unexplained"
    elif not terms:
        verdict = "nothing_missing"
    else:
        verdict = "not_identifiable" if tied else "named"
    # what the paper's residual depends on, and last what only shows after the adopted effects
    variables = [v for _, v in sorted(depends, reverse=True)] + [v for _, v in left]
    return Attribution(
        verdict, tuple(terms), tuple(dict.fromkeys(tied)), tuple(ranked), tuple(dict.fromkeys(variables)),
        {name: (side.base, side.best) for name, side in sides.items()}, deviance,
    )


def _differing(fitted: Fitted, best: Fitted) -> str:
    return best.terms[0].candidate.id if fitted is best else fitted.terms[-1].candidate.id
