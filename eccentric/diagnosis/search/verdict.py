"""The searches on the balances become one verdict, a ranked list and the measurement that would decide.

named             adopted effects, each clearly ahead of its alternatives; which declared value is off beside
                  them may stay open
not_identifiable  adopted, but another family explains the log equally well
unexplained       a smooth term explains a part of the structure that no candidate does: no name is given
nothing_missing   no candidate and no smooth term gains enough
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from eccentric.diagnosis.search import limits
from eccentric.diagnosis.search.attribution import RuledOut, Search
from eccentric.diagnosis.search.candidate import Candidate, Variables, Variant
from eccentric.diagnosis.search.screen import Fitted
from eccentric.diagnosis.search.stability import null_quantile
from eccentric.diagnosis.search.two_balances import search_all
from eccentric.effects import Words
from eccentric.identification import BalanceDesign
from eccentric.signals import MANY_RUNS


@dataclass(frozen=True)
class NextMeasurement:
    """A measurement that would decide what is open; `presentation` has the words.

    Attributes:
        code: "correct", the rig file or the log, which do not fit each other; "vary", one variable with all
            others held; "separate", two families that explain the log equally well; "hold_others",
            accelerate a joint of an arm with the others held, then the other way round.
        variable: what is varied; a user's own effect may name any.
        between: the families, each with the words of its best member.
        constant_first: whether giving the torque constant, which is open, may decide without it.
        one_way: whether the log turns one way only, so that the other direction may decide without it.
        mends: lines of the rig file that would put right what contradicts the log.
    """

    code: str
    variable: str = ""
    between: tuple[tuple[str, Words], ...] = ()
    constant_first: bool = False
    one_way: bool = False
    mends: tuple[str, ...] = ()


def next_measurement(
    verdict: str, tied: Sequence[tuple[str, Words]], variables: Sequence[str]
) -> NextMeasurement | None:
    """The measurement that would decide; None where nothing is open.

    tied: families that explain the log equally well, each with the words of its best member.
    """
    if verdict == "unexplained":
        return NextMeasurement("vary", variables[0] if variables else "time")
    if verdict != "not_identifiable" or not tied:
        return None
    return NextMeasurement("separate", between=(tied[0], tied[1] if len(tied) > 1 else tied[0]))


@dataclass(frozen=True)
class Adopted:
    """An adopted variant with its balance."""

    balance: str
    variant: Variant
    coefficients: tuple[float, ...]  # of its columns, none if its parameters are all shapes
    share: float  # RMS that it removes beside the others, as a fraction of the balance's scale
    found: int = 0  # in how many of the `variants` of the log its family is part of the best model
    variants: int = 0
    instead: Mapping[str, int] = field(default_factory=dict)  # family -> in how many it takes the place
    # families that explain the log equally well, its own first; none if it is clearly ahead
    alike: tuple[str, ...] = ()
    # whether it is a declared value, and what is alike is an effect: beside the name of another the two
    # stay open
    undecided: bool = False
    by_both: bool = False  # whether too few variants find it, and both balances together decide
    covers: tuple[str, ...] = ()  # likely families that its name stands for as well


@dataclass(frozen=True)
class Ranked:
    """A candidate in the list."""

    id: str
    family: str
    balance: str
    rmse: float  # cross-validated [N m]
    probability: float
    words: Words = field(default_factory=Words)
    instead_of: str = ""  # the family of the adopted effect in whose place it is; "" for none


@dataclass(frozen=True)
class Attribution:
    """What was decided."""

    verdict: str  # as in the module's table
    # by share, the largest first; for `unexplained` the best approximation, not to be reported as a
    # name
    adopted: tuple[Adopted, ...]
    tied: tuple[str, ...]  # families that explain the log equally well
    # best first, those of the balance that the verdict is about before all others
    candidates: tuple[Ranked, ...]
    depends_on: tuple[str, ...]  # variables that the residual of the paper's model follows, strongest first
    next_measurement: NextMeasurement | None  # None if nothing is open
    searches: dict[str, Search]  # per balance
    # per balance, the gain of the best addition and the level that chance reaches (99 %)
    deviance: dict[str, tuple[float, float]]
    unconfirmed: tuple[str, ...] = ()  # adopted effects that did not predict the held-out part
    ruled_out: tuple[Ranked, ...] = ()  # would explain what is left, on a drive that has the parts they need
    excluded: tuple[Ranked, ...] = ()  # explain the log as well as an adopted effect, likewise

    @property
    def explained(self) -> float:
        """The part of the cross-validated mean square that the adopted effects explain; 0 without any.

        In the balance of the first of them.
        """
        if not self.adopted:
            return 0.0
        search = self.searches[self.adopted[0].balance]
        return 1.0 - search.best.score / search.base.score

    def adopted_as(self, effect_id: str) -> Adopted | None:
        """The adopted effect of this id."""
        return next((one for one in self.adopted if one.variant.candidate.id == effect_id), None)


def attribute(
    balances: Sequence[BalanceDesign],
    candidates: Sequence[Candidate],
    variables: Variables,
    noise: Mapping[str, float] | None = None,
    runs: int = 1,
    progress: Callable[[str], None] = lambda _: None,
    required: float = limits.LEAST_DEVIANCE,
) -> Attribution:
    """Attribute the residuals of a log's training part.

    balances: mechanical, electrical or both, training windows only; candidates: of all balances;
    variables: what a residual may depend on; noise: RMS of a window that the sensors' white noise explains,
    per balance (`balances.balances_of`); runs: number of those that were fitted; progress: called with one
    line before and after each balance; required: deviance that an addition must gain.
    """
    return decided(search_all(balances, candidates, variables, noise or {}, progress, required), runs)


def decided(searches: dict[str, Search], runs: int = 1) -> Attribution:
    """The verdict on searches that have run, by balance; `runs`: number of those that were fitted."""
    adopted, leading, tied = _adopted(searches)
    unexplained = limits.UNEXPLAINED if runs < MANY_RUNS else limits.UNEXPLAINED_OVER_RUNS
    impossible = {name: search.models_ruled_out() for name, search in searches.items()}
    unexplained_by = _left(searches, unexplained, impossible)
    left, depends = [(f.last.variable, name) for name, f in unexplained_by], _depends(searches)
    patched = _patched(adopted)
    if left or patched:
        verdict, tied = "unexplained", []
        depends = list(dict.fromkeys([*patched, *depends]))
    elif adopted:
        verdict = "not_identifiable" if tied else "named"
    else:
        verdict = "nothing_missing"
    about = [entry.balance for entry in leading] or [balance for _, balance in left] or ["mechanical"]
    listed = [*leading, *_runners_up(searches, {entry.family for entry in leading}, set(about))]
    follows = tuple(dict.fromkeys([*depends, *(variable for variable, _ in left)]))
    deviance = {
        name: (search.deviance(search.base, search.ranked[0]), null_quantile(search.screen, search.best))
        for name, search in searches.items()
        if search.ranked
    }
    words = {entry.family: entry.words for entry in listed}
    following = next_measurement(verdict, [(family, words[family]) for family in tied], follows)
    ruled_out = {
        f.last.family: _ranked(f.last, name, searches[name], f, 0.0)
        for name, f in reversed(unexplained_by)
        if not f.last.possible
    }
    excluded = {
        f.last.family: replace(_ranked(f.last, name, searches[name], f, 0.0), instead_of=family)
        for name, models in impossible.items()
        for family, f in reversed(models.as_well)
        if f.last.family not in ruled_out
    }
    return Attribution(
        verdict, tuple(adopted), tuple(tied), tuple(listed), follows, following, searches, deviance,
        ruled_out=tuple(reversed(ruled_out.values())), excluded=tuple(reversed(excluded.values())),
    )  # fmt: skip


def unconfirmed(found: Attribution) -> Attribution:
    """The same search with its names withdrawn: what fitted the training part did not predict the rest."""
    first = [a.variant.candidate.variable for a in found.adopted]
    follows = tuple(dict.fromkeys([*first, *found.depends_on]))
    return replace(
        found,
        verdict="unexplained",
        tied=(),
        depends_on=follows,
        next_measurement=next_measurement("unexplained", (), follows),
        unconfirmed=tuple(a.variant.candidate.id for a in found.adopted),
    )


def _patched(adopted: Sequence[Adopted]) -> list[str]:
    """The variables of families whose members are so many, or so near, that none of them is the effect."""
    candidates = [entry.variant.candidate for entry in adopted]
    members = Counter(candidate.family for candidate in candidates)
    near = {
        one.family
        for one, other in itertools.combinations(candidates, 2)
        if one.family == other.family and abs(one.periods - other.periods) < limits.LEAST_PERIODS
    }
    return [
        c.variable for c in candidates if c.family in near or members[c.family] >= limits.FORMS_OF_A_PATCH
    ]


def _adopted(searches: dict[str, Search]) -> tuple[list[Adopted], list[Ranked], list[str]]:
    """Adopted variants of all balances by share, their entries in the list, and families tied with them."""
    found: list[tuple[Adopted, Ranked]] = []
    declared = {c.family for search in searches.values() for c in search.screen.candidates if c.tolerance}
    seen: set[str] = set()
    for name, search in searches.items():
        screen, best = search.screen, search.best
        for place, (variant, own) in enumerate(zip(best.variants, screen.own(best), strict=True)):
            without = screen.fit([v for k, v in enumerate(best.variants) if k != place])
            share = np.sqrt(max(without.score - best.score, 0.0) / screen.rows) / screen.balance.scale
            candidate = variant.candidate
            family, stability = candidate.family, search.stability
            if candidate.id in seen:  # the mechanical balance only corrects what the electrical one found
                continue
            seen.add(candidate.id)
            chances, clear = search.chances(place), search.clear(place)
            entry = _ranked(candidate, name, search, best, chances[family])
            one = Adopted(
                name,
                variant,
                tuple(map(float, own)),
                float(share),
                stability.found(family, *variant.covers),
                stability.variants,
                search.instead(family),
                () if clear else _alike(family, chances),
                by_both=family in search.by_both and not stability.nearly_all(family, *variant.covers),
                covers=tuple(
                    other
                    for other in variant.covers
                    if other in (options := search.alternatives[place])
                    and _instead(search, place, other, options[other][0]) > limits.POSSIBLE
                ),
            )
            found.append((one, entry))
    found.sort(key=lambda pair: -pair[0].share)
    ties = [(entry.family, one.alike) for one, entry in found if one.alike]
    # Several drifts in one balance make up the course of one that none of them has.
    for name in searches:
        own = [e.family for a, e in found if a.balance == name and a.variant.candidate.variable == "time"]
        drifts = dict.fromkeys(own)
        if len(drifts) > 1:
            ties.append((next(iter(drifts)), tuple(drifts)))
            found = [
                (replace(one, alike=tuple(drifts)) if entry.family in drifts else one, entry)
                for one, entry in found
            ]
    # Which declared value is off, or whether one is, takes no name from an effect that is clear.
    effects = [one for one, entry in found if entry.family not in declared]
    if any(not one.alike for one in effects):
        ties = [(family, tie) for family, tie in ties if family not in declared]
        found = [
            (replace(one, undecided=entry.family in declared and not declared.issuperset(one.alike)), entry)
            for one, entry in found
        ]
    elif effects:
        ties = [(family, tie) for family, tie in ties if not declared.issuperset(tie)]
    tied = dict.fromkeys(other for _, tie in ties for other in tie)
    return [one for one, _ in found], [entry for _, entry in found], list(tied)


def _ranked(candidate: Candidate, balance: str, search: Search, fitted: Fitted, probability: float) -> Ranked:
    rmse = float(np.sqrt(fitted.score / search.screen.rows))
    return Ranked(candidate.id, candidate.family, balance, rmse, probability, candidate.words)


def _alike(own: str, chances: Mapping[str, float]) -> tuple[str, ...]:
    """The families that explain the log equally well, the adopted one first, then the likeliest."""
    others = sorted((family for family in chances if family != own), key=lambda family: -chances[family])
    return (own, *(f for k, f in enumerate(others) if chances[f] > limits.POSSIBLE or k == 0))


def _runners_up(searches: dict[str, Search], named: set[str], about: set[str]) -> list[Ranked]:
    """The best of every other family: alternatives of the adopted variants, then the first step's candidates.

    The probability of an alternative is that of its family without the one in whose place it is.
    Errors of different balances are not comparable: those that the verdict is about come first.
    """
    best: dict[str, Ranked] = {}
    for name, search in searches.items():
        own = [variant.candidate.family for variant in search.best.variants]
        pool = [
            (_instead(search, place, family, p), f, adopted)
            for place, (adopted, options) in enumerate(zip(own, search.alternatives, strict=True))
            for family, (p, f) in options.items()
            if f is not search.best
        ]
        for probability, fitted, adopted in [*pool, *((0.0, fitted, "") for fitted in search.ranked)]:
            candidate = fitted.last
            entry = replace(_ranked(candidate, name, search, fitted, probability), instead_of=adopted)
            old = best.get(candidate.family)
            if fitted.score > limits.DIVERGED**2 * search.base.score:
                continue
            if candidate.family not in named and (old is None or old.probability < probability):
                best[candidate.family] = entry
    return sorted(best.values(), key=lambda r: (r.balance not in about, -r.probability, r.rmse))


def _instead(search: Search, place: int, family: str, on_the_log: float) -> float:
    """The probability of an alternative to an adopted effect, which has `on_the_log` without variants."""
    if family in search.same(place):
        return search.chances(place)[family]
    adopted = search.best.variants[place].candidate.family
    return search.stability.weight(family, {adopted}) if search.stability.variants else on_the_log


def _left(
    searches: dict[str, Search], unexplained: float, impossible: Mapping[str, RuledOut]
) -> list[tuple[str, Fitted]]:
    """What explains a part of the structure that the adopted effects do not, each with its balance.

    Smooth terms, and models with an effect that the drive cannot have. The larger part comes first.
    """
    left: list[tuple[float, str, Fitted]] = []
    for name, search in searches.items():
        best = search.best
        for fitted in [*search.smoothed, *impossible[name].better]:
            part = (best.score - fitted.score) / max(search.base.score - fitted.score, 1e-300)
            if fitted.last.possible:
                enough = part > unexplained or _outlines(search, fitted)
                enough = enough and search.explains(best, fitted)
            else:
                # With no more effects than were adopted it is the better explanation; beside all of them, a
                # further one.
                enough = part > unexplained or len(fitted.variants) <= len(best.variants)
            if enough:
                left.append((part, name, fitted))
    left.sort(key=lambda one: (one[0], one[2].last.variable, one[1]), reverse=True)
    return [(name, fitted) for _, name, fitted in left]


def _depends(searches: dict[str, Search]) -> list[str]:
    """Variables that the residual of the base model depends on, the larger part of the structure first."""
    depends: list[tuple[float, str]] = []
    for search in searches.values():
        least = min([search.best.score, *(fitted.score for fitted in search.smoothed)])
        structure = max(search.base.score - least, 1e-300)
        for fitted in search.smooth.rank([]):
            if search.explains(search.base, fitted):
                share = (search.base.score - fitted.score) / structure
                depends.append((share, fitted.last.variable))
    return [variable for _, variable in sorted(depends, reverse=True)]


def _outlines(search: Search, smooth: Fitted) -> bool:
    """Whether effects of several families, of one variable, only outline what a smooth term of it follows.

    Two laws together can imitate a curve that contains neither: what they leave is small beside the
    structure, but not noise, and follows the same variable.
    """
    variable, best = smooth.last.variable, search.best
    own = [variant.candidate for variant in best.variants]
    return (
        len({candidate.family for candidate in own if candidate.variable == variable}) > 1
        and best.score > limits.HIDES * search.screen.floor
        and best.score - smooth.score > limits.CLEARS * (best.score - search.screen.floor)
    )
