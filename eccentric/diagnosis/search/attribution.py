"""Residual attribution on a balance: which effects, in which order, with what probability.

1. forward: the candidate with the best cross-validated score is adopted as long as it gains enough;
2. each step also tries the best partners of the first search's runners-up and every swap of one variant for
   another (the best single effect need not be in the best pair); what has become superfluous is removed;
3. each adopted variant is compared with its alternatives, the others kept: their scores give probabilities;
4. smooth terms are fitted to what is left. If they explain part of the structure, no candidate explains it.

Scores are n_eff/2 log(cross-validated sum of squares), n_eff from the autocorrelation of the best residual: a
residual that still has structure counts as few samples and carries little weight.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.special import expit

from eccentric.diagnosis.search import limits
from eccentric.diagnosis.search.candidate import Candidate, Variant, instrument_of
from eccentric.diagnosis.search.screen import Fitted, Screen
from eccentric.diagnosis.search.stability import Stability, beats_chance, stability_of
from eccentric.identification import BalanceDesign


class RuledOut(NamedTuple):
    """Models with a candidate that is not possible, last in each."""

    better: list[Fitted]  # explain more than the best model, or no less with fewer effects
    as_well: list[tuple[str, Fitted]]  # as well, with the family of the adopted effect in whose place it is


@dataclass
class Search:
    """The search on one balance."""

    screen: Screen
    smooth: Screen
    base: Fitted  # the paper's model alone
    best: Fitted  # with the adopted variants
    ranked: list[Fitted] = field(default_factory=list)  # the first step's candidates
    smoothed: list[Fitted] = field(default_factory=list)  # smooth terms beside the adopted ones
    # per adopted variant: family -> (probability, fit)
    alternatives: list[dict[str, tuple[float, Fitted]]] = field(default_factory=list)
    steps: list[Fitted] = field(default_factory=list)  # the best model after each step
    tried: list[Fitted] = field(default_factory=list)  # other models that were compared with it
    required: float = limits.LEAST_DEVIANCE  # deviance that an addition has to gain
    stability: Stability = field(default_factory=Stability)  # of the adopted effects
    # of effects that this balance alone leaves open: family -> deviance by which the other one, or both
    # together, prefer it
    by_both: dict[str, float] = field(default_factory=dict)
    ruled_out: Screen | None = None  # candidates that the drive cannot have

    def run(self) -> None:
        """Adopt, compare, then fit the smooth terms to what is left."""
        while len(self.best.variants) < limits.MOST_EFFECTS:
            if self.best.variants and self.best.score < limits.AT_FLOOR * self.screen.floor:
                break
            ranked = self.screen.rank(self.best.variants)
            self.ranked = self.ranked or ranked
            leaders = self._leaders(ranked)
            tried = [self.swapped(self.screen.refine(fitted)) for fitted in leaders]
            if len(self.best.variants) == 1:
                tried += self.pairs()
            tried = [f for f in tried if self.confirmed(f)]
            # No variant may have lost to those beside it what names it.
            tried = [f for f in tried if all(self.screen.itself(f, k) for k in range(len(f.variants)))]
            tried = [f for f in tried if not self._is_remainder(self.best, f)]
            self.tried += tried
            tried = [f for f in tried if self.worth_it(self.best, f) and self.clears(self.best, f)]
            if not tried:
                break
            self.best = self.pruned(min(tried, key=lambda f: f.score))
            self.steps.append(self.best)
        self._compare()
        self._examine(self.steps)
        self._share_names()
        self.smoothed = self.smooth.rank(self.best.variants)

    def models_ruled_out(self) -> RuledOut:
        """What explains the log at least as well as the best model, on a drive with other parts.

        It stands alone, beside the adopted effects, or in the place of one of them: several of those may
        imitate what it does. As well as an adopted effect is what would be among its alternatives.
        """
        screen, found = self.ruled_out, RuledOut([], [])
        if screen is None or not screen.candidates:
            return found
        effective = self.screen.effective(self.best)
        beside: list[tuple[int | None, list[Variant]]] = [(None, list(self.best.variants))]
        beside += [(k, _without(self.best, k)) for k in range(len(self.best.variants))]
        beside += [(None, [])] if len(self.best.variants) > 1 else []
        for place, others in beside:
            for fitted in screen.rank(others, leaders=limits.LEADERS_OF_A_SWAP):
                candidate = fitted.variants[-1]
                fewer = len(fitted.variants) < len(self.best.variants) and fitted.score <= self.best.score
                if fewer or self.worth_it(self.best, fitted, screen):
                    if self._gained(others, candidate, fitted, screen):
                        found.better.append(fitted)
                elif place is not None:
                    own = self.best.variants[place]
                    ahead = _log_evidence(candidate, fitted, effective)
                    ahead -= _log_evidence(own, self.best, effective)
                    if expit(ahead) > limits.POSSIBLE and self._gained(others, candidate, fitted, screen):
                        found.as_well.append((own.candidate.family, fitted))
        return found

    def release(self) -> None:
        """Forget all columns, as `Screen.release` does."""
        for screen in filter(None, (self.screen, self.smooth, self.ruled_out)):
            screen.release()

    def deviance(self, before: Fitted, after: Fitted, screen: Screen | None = None) -> float:
        """Twice the gain in log-likelihood from one fit to another, of the cross-validated scores."""
        return (screen or self.screen).deviance(before, after)

    def worth_it(self, before: Fitted, after: Fitted, screen: Screen | None = None) -> bool:
        """Whether a fit improves on another beyond chance and beyond the errors of filters and sampling."""
        gain = before.score - after.score
        return (
            gain > limits.LEAST_PART * (self.base.score - after.score)
            and not self._is_remainder(before, after)
            and gain > self.screen.rows * (limits.LEAST_SHARE * self.screen.balance.scale) ** 2
            and self.deviance(before, after, screen) > self.required
        )

    def _is_remainder(self, before: Fitted, after: Fitted) -> bool:
        """Whether what is added may be what the record of an effect beside it leaves out."""
        added = after.families - before.families
        alike = any(added & set(v.candidate.evidence.second_order) for v in after.variants)
        least = limits.LEAST_PART_OF_SECOND_ORDER * (self.base.score - after.score)
        return alike and before.score - after.score <= least

    def confirmed(self, fitted: Fitted) -> bool:
        """Whether every variant gains a good part on its instrument too, or is the same torque there."""
        return all(
            self._gained(_without(fitted, place), variant, fitted, self.screen)
            for place, variant in enumerate(fitted.variants)
        )

    def explains(self, before: Fitted, after: Fitted) -> bool:
        """Whether a smooth term takes something out that is there without the noise of its signals too.

        There is nothing to take out where the sensors' noise is as large as all that is left. What is far
        beyond that noise needs no draws, be it what is taken out or what is left, if most of that follows the
        variable: a short stretch of a log has too few signs to beat them all.
        """
        far = limits.BEYOND_NOISE * self.screen.floor
        return (
            before.score > self.screen.floor
            and self.worth_it(before, after, self.smooth)
            and self._gained(list(before.variants), after.variants[-1], after, self.smooth)
            and (
                before.score - after.score > far > 0.0
                or (before.score > far > 0.0 and self._takes_out(before, after))
                or beats_chance(self.smooth, before, after)
            )
        )

    def _gained(self, others: list[Variant], variant: Variant, fitted: Fitted, screen: Screen) -> bool:
        twin = instrument_of(variant)
        if twin is None:
            return True
        without = screen.fit(others)
        gain = without.score - fitted.score
        if gain > limits.BEYOND_NOISE * self.screen.floor > 0.0:
            return True
        there = screen.fit([*others, twin])
        # An instrument may place an event a sample early and gain nothing; it still finds the same torque.
        jumps = any(shape.jumps for shape in variant.candidate.shapes)
        if not jumps and self.deviance(without, there, screen) <= limits.CONFIRMED:
            return False
        # An instrument that blurs the signal takes out little; it finds the same coefficients all the same.
        part = without.score - there.score > limits.CONFIRMED_PART * gain
        return part or screen.exogenous(others, variant)

    def _leaders(self, ranked: Sequence[Fitted]) -> list[Fitted]:
        """The candidates to try: the first that gain by more than the noise of their own signals."""
        found: list[Fitted] = []
        for fitted in ranked:
            gains = self.worth_it(self.best, fitted)
            others = _without(fitted, len(fitted.variants) - 1)
            if not gains or self._gained(others, fitted.variants[-1], fitted, self.screen):
                found.append(fitted)
            if len(found) == limits.TRIED:
                break
        return found

    def clears(self, before: Fitted, after: Fitted) -> bool:
        """Whether a further effect explains enough of what the first ones leave above the noise floor."""
        return not before.variants or self._takes_out(before, after)

    def _takes_out(self, before: Fitted, after: Fitted) -> bool:
        """Whether one fit takes out most of what the other leaves above the noise floor."""
        floor = min(self.screen.floor, after.score)
        return before.score - after.score > limits.CLEARS * (before.score - floor)

    def pairs(self) -> list[Fitted]:
        """Best partner of the leading other families of the first step.

        Partners of the best effect's own family are ranked beside it anyway, where its form is swapped too.
        """
        own = self.best.variants[0].candidate.family
        seen, found = {own}, []
        for fitted in self.ranked:
            family = fitted.last.family
            if family in seen or len(seen) > limits.PARTNERS or not self.worth_it(self.base, fitted):
                continue
            seen.add(family)
            partners = self.screen.rank(fitted.variants, leaders=limits.LEADERS_OF_A_PARTNER)[:1]
            near = [
                pair
                for pair in partners
                if pair.last.family != own and pair.score < limits.NEAR * self.best.score
            ]
            found += [self.swapped(self.screen.refine(pair)) for pair in near]
        return found

    def swapped(self, fitted: Fitted) -> Fitted:
        """Each variant against all others in its place, in two passes, or until a pass changes nothing."""
        count = len(fitted.variants)
        if count == 1:
            return fitted
        kept = 0
        for place in [*range(count)] * 2:
            found = self.screen.rank(_without(fitted, place), leaders=limits.LEADERS_OF_A_SWAP)
            kept += 1
            if found and found[0].score < limits.SWAPPED * fitted.score:
                fitted, kept = self.screen.refine(found[0]), 0
            if kept == count:
                break
        return fitted

    def pruned(self, fitted: Fitted) -> Fitted:
        """Without the variants that the others have made superfluous."""
        for place in range(len(fitted.variants)):
            without = self.screen.fit(_without(fitted, place))
            if len(fitted.variants) > 1 and not self.worth_it(without, fitted):
                return self.pruned(self.screen.refine(without))
        return fitted

    def chances(self, place: int) -> dict[str, float]:
        """Probabilities of an adopted effect's family and of those in its place, over variants of the log.

        What its name covers counts with it; a family whose name covers it is no alternative.
        """
        family, found = self.best.variants[place].candidate.family, self._chances(place)
        found[family] += sum(found.get(other, 0.0) for other in self.best.variants[place].covers)
        # Without variants, the blocks are what a probability rests on: no number of them proves a certainty.
        blocks = int(self.screen.block[-1]) + 1
        most = 1.0 if self.stability.variants else (blocks + 1.0) / (blocks + 2.0)
        agreeing = self._agreeing(place)
        return {other: min(chance, most) for other, chance in found.items() if other not in agreeing}

    def _agreeing(self, place: int) -> tuple[str, ...]:
        """Families whose names an adopted effect covers, or that cover its own: both are right, or none."""
        variant, options = self.best.variants[place], self.alternatives[place].items()
        own = variant.candidate.family
        return (*variant.covers, *(f for f, (_, fitted) in options if own in fitted.last.evidence.covers))

    def _chances(self, place: int) -> dict[str, float]:
        family, options = self.best.variants[place].candidate.family, self.alternatives[place]
        # A family beside it, found once more in its place, is no alternative to it.
        beside = self.best.families - {family}
        open_to = {other: chance for other, (chance, _) in options.items() if other not in beside}
        if family in self.by_both:
            most = self.stability.most if self.stability.variants else 1.0
            return {family: min(most, float(expit(0.5 * self.by_both[family])))}
        if self.stability.variants:
            found = self.stability.chances(family, [other for other in open_to if other != family])
        else:
            found = {other: chance / sum(open_to.values()) for other, chance in open_to.items()}
        if same := self.same(place):
            found |= dict.fromkeys((family, *same), sum(found[f] for f in (family, *same)) / (1 + len(same)))
        return found

    def same(self, place: int) -> tuple[str, ...]:
        """Families that fit and predict every block as an adopted effect does, with as many parameters.

        No row of this log speaks for one of them, and how many orders a family has decides nothing: cogging
        once per turn of a motor without a gear is the torque of a tilted plane. Not those that its record
        names as aliases, which are given beside its name.
        """
        variant = self.best.variants[place]
        return tuple(
            other
            for other, (_, fitted) in self.alternatives[place].items()
            if other not in self.best.families
            and other not in self._agreeing(place)
            and not aliased(variant.candidate, fitted.last)
            and self._alike(fitted, variant)
        )

    def _alike(self, fitted: Fitted, variant: Variant) -> bool:
        """Whether a model with another effect in the place of an adopted one fits and predicts as well."""
        return (
            len(fitted.coefficients) == len(self.best.coefficients)
            and len(fitted.last.shapes) == len(variant.candidate.shapes)
            and np.allclose(fitted.cross, self.best.cross, rtol=limits.SAME, atol=0.0)
        )

    def clear(self, place: int) -> bool:
        """Whether an adopted effect is clearly ahead of what could be in its place."""
        family = self.best.variants[place].candidate.family
        if family in self.by_both:
            return True
        names, chances = (family, *self._agreeing(place)), self._chances(place)
        sure = sum(chances.get(name, 0.0) for name in names) >= limits.SURE
        return sure and self.stability.nearly_all(*names)

    def instead(self, family: str) -> dict[str, int]:
        """Families that variants of the log find in the place of an adopted one: in how many, most first.

        A declared value counts on top of the few effects that may be tied: one measurement settles it.
        """
        beside = self.best.families | {
            other for v in self.best.variants if v.candidate.family == family for other in v.covers
        }
        declared = {c.family for c in self.screen.candidates if c.tolerance}
        least = limits.POSSIBLE * self.stability.variants
        found = self.stability.instead(family, beside, declared, limits.IN_PLACE)
        return {other: times for other, times in found.items() if times >= least}

    def _examine(self, steps: Sequence[Fitted]) -> None:
        """Drop the effects that too few variants of the log find, even with what takes their place.

        Those that stay keep their alternatives: what is dropped is still missing, and would confuse them. But
        what was right only beside it gives way to an earlier step without it that explained clearly more,
        which is compared and examined as if the search had ended there. Each of the steps is gone back to
        once: what is compared with it may bring back what was dropped.
        """
        if not self.best.variants:
            return
        self.stability = stability_of(self.screen, self._models())
        families = [v.candidate.family for v in self.best.variants]
        kept = [
            k
            for k, variant in enumerate(self.best.variants)
            if self.stability.nearly_all(families[k], *variant.covers, *self.instead(families[k]))
        ]
        if len(kept) < len(families):
            left = self.screen.refine(self.screen.fit([self.best.variants[k] for k in kept]))
            dropped = {family for k, family in enumerate(families) if k not in kept}
            earlier = [
                step
                for step in steps
                if dropped.isdisjoint(step.families) and step.score < limits.SWAPPED * left.score
            ]
            if earlier:
                self.tried.append(self.best)
                self.best = again = min(earlier, key=lambda f: f.score)
                self._compare()
                self._examine([step for step in steps if step is not again])
            else:
                self.best, self.alternatives = left, [self.alternatives[k] for k in kept]

    def _share_names(self) -> None:
        """A family that covers an adopted one takes its place, unless the whole log is sure of that one.

        Variants of the log guard against a wrong name, and of these two none is wrong.
        """
        while general := self._covering():
            self.best = self.screen.refine(general)
            self._compare(0)

    def _covering(self) -> Fitted | None:
        """The best model with a family that covers an adopted one."""
        for variant, options in zip(self.best.variants, self.alternatives, strict=True):
            own = variant.candidate.family
            for chance, fitted in options.values():
                if own in fitted.last.evidence.covers and options[own][0] < limits.SURE * (
                    options[own][0] + chance
                ):
                    return fitted
        return None

    def _models(self) -> list[Fitted]:
        """The best model first, then those that came close, each set of effects once."""
        places = range(len(self.best.variants))
        reduced = [self.screen.fit(_without(self.best, place)) for place in places]
        rivals = [fitted for options in self.alternatives for _, fitted in options.values()]
        close = sorted([*reduced, *rivals, *self.tried], key=lambda f: f.score)[: limits.CLOSE]
        models: dict[frozenset[str], Fitted] = {}
        for fitted in [self.best, *close]:
            models.setdefault(frozenset(v.candidate.id for v in fitted.variants), fitted)
        return list(models.values())

    def _compare(self, changes: int = limits.CHANGES) -> None:
        """Probabilities of the families in the place of each adopted variant, the others kept.

        A special case that explains the log as well as the family that contains it takes the place. An order
        has its part of the family's probability before the log counts.
        """
        effective = self.screen.effective(self.best)
        self.alternatives = []
        for place, variant in enumerate(self.best.variants):
            rivals = {variant.candidate.family: (variant, self.best)}
            for fitted in self.screen.rank(_without(self.best, place)):
                family = fitted.last.family
                better = family not in rivals or fitted.score < rivals[family][1].score
                if better and (fitted.score > self.best.score or self.confirmed(fitted)):
                    rivals[family] = (fitted.variants[-1], fitted)
            log = {
                family: _log_evidence(own, fitted, effective)
                + limits.SPECIAL * any(general in rivals for general in own.candidate.evidence.special_of)
                for family, (own, fitted) in rivals.items()
            }
            first = max(log, key=lambda family: log[family])
            if (again := self._of_one_cause(place, rivals)) is not None:
                log[again], first = log[first], again
            if rivals[first][1] is not self.best and changes:
                self.best = self.screen.refine(rivals[first][1])
                self._compare(changes - 1)
                return
            weight = {family: float(np.exp(value - log[first])) for family, value in log.items()}
            total = sum(weight.values())
            self.alternatives.append({f: (weight[f] / total, fitted) for f, (_, fitted) in rivals.items()})

    def _of_one_cause(self, place: int, rivals: dict[str, tuple[Variant, Fitted]]) -> str | None:
        """The family beside an adopted effect of which another order does nearly what that effect does.

        A motor that hardly turns back shows its cogging at several orders. Friction that varies with the
        angle may fit one of them a little better, by the few rows near standstill that no model describes:
        two causes are not likelier for that than one, and both remain open.
        """
        others, own = self.screen.fit(_without(self.best, place)), self.best.variants[place]
        gain = {family: others.score - fitted.score for family, (_, fitted) in rivals.items()}
        most, period = limits.ONE_CAUSE * max(gain.values()), own.candidate.periods
        return next(
            (
                family
                for family, (rival, fitted) in rivals.items()
                if family in others.families
                and gain[family] > most
                and rival.candidate.periods == period < math.inf
                and (fitted is self.best or self.confirmed(fitted))
            ),
            None,
        )


def aliased(one: Candidate, other: Candidate) -> bool:
    """Whether the record of one of them names the other as the same within the base model."""
    named = (*one.evidence.aliases, *other.evidence.aliases)
    return not {one.id, one.family, other.id, other.family}.isdisjoint(named)


def _log_evidence(own: Variant, fitted: Fitted, effective: float) -> float:
    """The log of how likely a variant is, by its model's score, up to a constant of the log."""
    fit = -0.5 * effective * float(np.log(fitted.score))
    return fit - 0.5 * len(own.values) - float(np.log(own.candidate.evidence.one_of))


def _without(fitted: Fitted, place: int) -> list[Variant]:
    return [variant for k, variant in enumerate(fitted.variants) if k != place]


@dataclass(frozen=True)
class LoadSearch:
    """What was found."""

    adopted: tuple[str, ...]  # families, in order of adoption
    alike: tuple[str, ...]  # others that explain the balance as well as one of them
    deviance: float  # gain of the best single candidate, cross-validated
    required: float  # what an addition has to gain


def required_over(joints: int) -> float:
    """The deviance that an addition must gain if it may be found in any of several joints.

    A chance gain of d is exp(-d/2) times as likely as one of 0: n joints have n times as many chances.
    """
    return limits.LEAST_DEVIANCE + 2.0 * math.log(joints)


def searched_loads(
    balance: BalanceDesign, candidates: Sequence[Candidate], noise: float, joints: int
) -> LoadSearch:
    """Adopt candidates as a diagnosis adopts effects.

    Args:
        balance: without any of them.
        candidates: of each family, what names it in the first column.
        noise: RMS of a window that the sensors' white noise explains.
        joints: number of joints that are searched like this.
    """
    screen = Screen(balance, candidates, noise)
    base = screen.fit([])
    search = Search(screen, Screen(balance, ()), base, base, required=required_over(joints))
    search.run()
    best = search.ranked[0] if search.ranked else base
    alike = dict.fromkeys(
        family
        for options in search.alternatives
        for family, (chance, _) in options.items()
        if chance > limits.POSSIBLE
    )
    adopted = tuple(dict.fromkeys(variant.candidate.family for variant in search.best.variants))
    others = tuple(family for family in alike if family not in adopted)
    return LoadSearch(adopted, others, search.deviance(base, best) if search.ranked else 0.0, search.required)
