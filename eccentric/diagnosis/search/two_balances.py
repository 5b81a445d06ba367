"""The search on both balances: what one of them shows is taken out of the other.

The electrical balance comes first, so that what a current sensor's bias or delay adds to the mechanical
balance can be subtracted there. An effect that both show is estimated from both, beside the largest of what
else the mechanical balance shows. An angle that is read wrongly shows in both: its velocity is wrong, and the
back-EMF varies over a turn as with a ripple of the flux. In the electrical balance both have the same
columns, so the mechanical balance decides; the search then begins again without what the misread angle adds.
It decides too where the circuit cannot tell an effect that has a torque from one that has another, or none.
Effects on the flux may show in the torque alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eccentric.diagnosis.search import limits
from eccentric.diagnosis.search.attribution import Search
from eccentric.diagnosis.search.candidate import (
    Candidate,
    Variables,
    Variant,
    bounds_of,
    refined,
    smooth_terms,
)
from eccentric.diagnosis.search.crossval import bounded_solve, spans, unexplained
from eccentric.diagnosis.search.screen import Fitted, Screen
from eccentric.identification import BalanceDesign, Coefficient

Array = np.ndarray
Beside = tuple[Array, Array]
"""Columns of a mechanical effect (rows, k), and the lower bounds of their coefficients (k,)."""


# An effect that both balances show, estimated from both: one may leave open what the other determines.
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
        rest = unexplained(design, target)
        self._weights = screen.rows / found.loss.sum(), len(rest) / float(rest @ rest)

    def run(self) -> list[Array]:
        """Refine the shapes; return the coefficients of each variant."""
        shown = [k for k, v in enumerate(self.variants) if v.candidate.joint and v.candidate.shapes]

        def placed(variants: Sequence[Variant]) -> list[Variant]:
            new = dict(zip(shown, variants, strict=True))
            return [new.get(k, variant) for k, variant in enumerate(self.variants)]

        if shown:
            own = [self.variants[k] for k in shown]
            self.variants = placed(refined(own, lambda v: self._solved(placed(v))[0], limits.STEPS))
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


# Effects on the flux of the motor: torque and voltage both show them, and either may be too noisy to.
#
# The mechanical search is offered all of them as torques. What it finds is held against the circuit, with the
# coefficients that the torque gives it: an effect whose voltage is missing there is not offered again. Where
# the torque cannot tell one from friction, which has no voltage, what the circuit says is added.
def as_torques(electrical: Search) -> list[Candidate]:
    """Effects on the flux for the mechanical search.

    Those adopted in the circuit, with their shapes: beside other effects the torque determines their
    coefficients better than the first estimate from both did. And those of all other families, however faint
    there: what is small beside the armature's voltage may be most of what the mechanical balance lacks.
    """
    adopted = [variant for variant in electrical.best.variants if variant.candidate.joint]
    families = electrical.best.families
    return [
        *(v.candidate.in_the("mechanical", v.values) for v in adopted if v.candidate.also is not None),
        *(own.in_the("mechanical") for own in _with_torque(electrical) if own.family not in families),
    ]


def contradicted(mechanical: Search, electrical: Search) -> str | None:
    """The id of the effect, found or in the place of one, that the circuit is most against; None if none."""
    gains: dict[str, float] = {}
    for place, variant in enumerate(mechanical.best.variants):
        rivals = _likely(mechanical, place, variant.candidate.family)
        options = mechanical.alternatives[place]
        judged = [(mechanical.best, place), *((options[f][1], -1) for f in rivals if f in options)]
        for fitted, where in judged:
            own = fitted.variants[where].candidate.id
            gains[own] = min(
                gains.get(own, 0.0), _deviance_in_the_circuit(mechanical, fitted, where, electrical)
            )
    least = min(gains, key=lambda own: gains[own], default=None)
    return least if least is not None and gains[least] < -limits.HINTED else None


def weigh_with_the_circuit(mechanical: Search, electrical: Search) -> None:
    """Add to what the torque says of effects on the flux what the circuit says, too faint to adopt there.

    Only where what could be in their place is friction, of which the circuit would show nothing.
    """
    for place, variant in enumerate(mechanical.best.variants):
        family, options = variant.candidate.family, mechanical.alternatives[place]
        circuit = _deviance_in_the_circuit(mechanical, mechanical.best, place, electrical)
        if circuit <= limits.HINTED or mechanical.clear(place):
            continue
        rivals = _likely(mechanical, place, family)
        if not rivals or not rivals <= set(options) or any(options[r][1].last.joint for r in rivals):
            continue
        if not mechanical.stability.nearly_all(family, *rivals):
            continue
        torque = min(mechanical.deviance(options[r][1], mechanical.best) for r in rivals)
        if circuit + torque > limits.LEAST_DEVIANCE:
            mechanical.by_both[family] = circuit + torque


def _deviance_in_the_circuit(mechanical: Search, fitted: Fitted, place: int, electrical: Search) -> float:
    """The deviance by which the circuit is for a variant of a mechanical fit, as the torque has it.

    A missing voltage speaks against it, and one of another sign or phase. The effects adopted in the circuit
    are fitted anew beside it; other effects on the flux are there in both cases. 0 for what has no voltage,
    and for the effects adopted in the circuit.
    """
    voltages = _voltages(mechanical, fitted, electrical)
    place %= len(fitted.variants)
    if place not in voltages:
        return 0.0
    target, design, _ = electrical.screen.design(electrical.best.variants)
    others = sum((v for k, v in voltages.items() if k != place), np.zeros(len(target)))
    q, _ = np.linalg.qr(design)
    losses = []
    for predicted in (others, others + voltages[place]):
        left = target - predicted
        losses.append(max(float(np.sum((left - q @ (q.T @ left)) ** 2)), np.finfo(float).tiny))
    without, beside = losses
    return electrical.screen.effective(electrical.best) * float(np.log(without / beside))


def _voltages(mechanical: Search, fitted: Fitted, electrical: Search) -> dict[int, Array]:
    """What the effects on the flux of a mechanical fit are in the circuit, by place: (rows,) [N m]."""
    known = {own.id: own for own in _with_torque(electrical)}
    adopted = electrical.best.families
    return {
        place: electrical.screen.columns(Variant(known[variant.candidate.id], variant.values)) @ own
        for place, (variant, own) in enumerate(
            zip(fitted.variants, mechanical.screen.own(fitted), strict=True)
        )
        if variant.candidate.id in known and variant.candidate.family not in adopted
    }


def _with_torque(electrical: Search) -> Sequence[Candidate]:
    return [own for own in electrical.screen.candidates if own.joint and own.also is not None]


def _likely(mechanical: Search, place: int, family: str) -> set[str]:
    """The families that may be in the place of an adopted one."""
    likely = {other for other, chance in mechanical.chances(place).items() if chance > limits.POSSIBLE}
    return (likely | set(mechanical.instead(family))) - {family}


def search_all(
    balances: Sequence[BalanceDesign],
    candidates: Sequence[Candidate],
    variables: Variables,
    noise: Mapping[str, float],
    progress: Callable[[str], None],
    required: float = limits.LEAST_DEVIANCE,
) -> dict[str, Search]:
    """Run the search on every balance, by name; arguments as in `verdict.attribute`."""

    def searched(balance: BalanceDesign, but: str = "", also: Sequence[Candidate] = ()) -> Search:
        shown = [c for c in [*candidates, *also] if c.balance == balance.name and c.family != but]
        own = [c for c in shown if c.possible]
        progress(f"{balance.name} balance: {len(own)} candidates on {len(balance.target)} windows")
        screen = Screen(balance, own, noise.get(balance.name, 0.0))
        smooth = Screen(balance, smooth_terms(variables, balance.name, balance.rows.used_samples()))
        base = screen.fit([])
        ruled_out = Screen(balance, [c for c in shown if not c.possible])
        search = Search(screen, smooth, base, base, required=required, ruled_out=ruled_out)
        search.run()
        names = ", ".join(v.candidate.id for v in search.best.variants)
        progress(f"{balance.name} balance: {names or 'nothing adopted'}")
        return search

    def with_flux(balance: BalanceDesign, electrical: Search, but: str = "") -> Search:
        """The mechanical search, which is offered what acts on the flux unless the circuit is against it."""
        flux = as_torques(electrical)
        found = searched(balance, but, flux)
        # Each pass leaves one out.
        while (against := contradicted(found, electrical)) in {candidate.id for candidate in flux}:
            flux = [candidate for candidate in flux if candidate.id != against]
            found = searched(balance, but, flux)
        return found

    by_name = {balance.name: balance for balance in balances}
    mechanical, circuit = by_name["mechanical"], by_name.get("electrical")
    if circuit is None:
        return {"mechanical": searched(mechanical)}
    electrical = searched(circuit)
    misread = _misread(electrical.screen, electrical.best, mechanical, candidates)
    if misread is None:
        corrected, held = _corrected(mechanical, electrical), ()
        found = with_flux(corrected, electrical)
        for count in range(1, limits.MOST_BESIDE + 1):
            beside = _beside(found, electrical)[:count]
            if _in_the_circuit(found, circuit) is not None or not beside:
                break
            trial = replace(electrical)  # taken over only with the search that goes with it
            again = _corrected(mechanical, trial, beside)
            # By more than the noise explains.
            change, variance = again.target - corrected.target, found.best.score
            if not change @ change > limits.CONFIRMED * variance / found.screen.effective(found.best):
                break
            corrected, held, electrical.best = again, beside, trial.best
            found = with_flux(again, electrical)
        misread = _in_the_circuit(found, circuit)
        if misread is None:
            for place, family in _doubtful(electrical):
                rivals = [
                    # What is on the flux beside it, and no other that could take on its torque.
                    searched(_corrected(mechanical, other, held), family, _found(found, other))
                    for other in _in_place(electrical, place)
                ]
                # Without a family that could be in its place, nothing is compared.
                least = min((found.deviance(rival.best, found.best) for rival in rivals), default=0.0)
                if least > limits.LEAST_DEVIANCE:
                    electrical.by_both[family] = least
            weigh_with_the_circuit(found, electrical)
            return {"electrical": electrical, "mechanical": found}
    # Beside what else the mechanical balance shows, and without the torque of the ripple for which the
    # circuit took it: alone, it would take on a part of a larger effect.
    without = _others(electrical, misread)
    if len(without) < len(electrical.best.variants):
        alone = replace(electrical, best=electrical.screen.fit(without))
        found = with_flux(_corrected(mechanical, alone), alone)
        misread = _in_the_circuit(found, circuit) or misread
    # Beside what else was found there: a large effect would hide the difference.
    screen, others = electrical.screen, _others(electrical, misread)
    read_right = replace(circuit, target=circuit.target - misread.columns @ misread.coefficients)
    if electrical.deviance(Screen(read_right, ()).fit(others), screen.fit(others)) < limits.CONFIRMED:
        clean = searched(read_right)
        found = with_flux(_corrected(mechanical, clean), clean)
        if len(_others(clean, misread)) < len(clean.best.variants):
            # A ripple of the flux in the same columns, or an error of what the torque says of the angle: a
            # ripple would have a torque too.
            free = searched(_free_to_err(read_right, misread))
            rival = with_flux(_corrected(mechanical, free), free)
            if rival.deviance(found.best, rival.best) > 0.0:
                clean, found = free, rival
        if _in_the_circuit(found, circuit) is not None:
            return {"electrical": clean, "mechanical": found}
    # The voltage does not have what such an angle would add.
    found = with_flux(_corrected(mechanical, electrical), electrical, misread.family)
    return {"electrical": electrical, "mechanical": found}


def _found(mechanical: Search, electrical: Search) -> list[Candidate]:
    """Of the effects on the flux those that were found, in either balance."""
    best = (*mechanical.best.variants, *electrical.best.variants)
    ids = {variant.candidate.id for variant in best}
    return [candidate for candidate in as_torques(electrical) if candidate.id in ids]


def _doubtful(electrical: Search) -> list[tuple[int, str]]:
    """Effects with a torque that the circuit shows, and cannot tell from another: place and family."""
    return [
        (place, variant.candidate.family)
        for place, variant in enumerate(electrical.best.variants)
        if variant.candidate.also is not None and not electrical.clear(place)
    ]


def _in_place(electrical: Search, place: int) -> list[Search]:
    """The same search with each family in the place of an effect that may be there, at least the next best.

    Of those without a torque one stands for all: to the mechanical balance they are the same.
    """
    family = electrical.best.variants[place].candidate.family
    options = {f: fitted for f, (_, fitted) in electrical.alternatives[place].items() if f != family}
    likely = {
        f for f, chance in electrical.chances(place).items() if chance > limits.POSSIBLE and f in options
    }
    likely |= set(electrical.instead(family)) & set(options)
    likely = likely or set([*sorted(options, key=lambda f: options[f].score)][:1])
    with_torque = [f for f in likely if options[f].last.also is not None]
    without = sorted(likely - set(with_torque))[:1]
    fits = [options[f] for f in [*sorted(with_torque), *without]]
    return [replace(electrical, best=fitted) for fitted in fits]


@dataclass(frozen=True)
class _Misread:
    """The family of a mechanical effect, and what it adds to the electrical target."""

    family: str
    samples: Array  # (n, k)
    columns: Array  # their averages (rows, k)
    coefficients: Array  # (k,), as the torque has them


def _in_the_circuit(mechanical: Search, circuit: BalanceDesign) -> _Misread | None:
    """The mechanical effect found that adds to the electrical target; None if none does."""
    best = mechanical.best
    for variant, own in zip(best.variants, mechanical.screen.own(best), strict=True):
        candidate = variant.candidate
        if candidate.also is not None:
            samples = candidate.also(variant.values)
            return _Misread(candidate.family, samples, circuit.rows.mean(samples), own)
    return None


def _misread(
    electrical: Screen, best: Fitted, mechanical: BalanceDesign, candidates: Sequence[Candidate]
) -> _Misread | None:
    """A mechanical effect in whose place an electrical one was found.

    None if nothing adopted there shows as a mechanical candidate does, or the mechanical balance does not
    prefer that.

    Args:
        electrical, best: the electrical balance, and what was found there.
        mechanical: the other balance.
        candidates: of both balances.
    """
    screen, rows = Screen(mechanical, ()), electrical.balance.rows
    linear = [c for c in candidates if c.balance == mechanical.name and not c.shapes and c.possible]
    for variant in best.variants:
        torque = variant.candidate.also
        for candidate in linear:
            if torque is None or candidate.also is None:
                continue
            samples = candidate.also({})
            added = rows.mean(samples)
            if not spans(added, electrical.columns(variant)):
                continue
            other = screen.fit([Variant(replace(variant.candidate, columns=torque), variant.values)])
            own = screen.fit([Variant(candidate, {})])
            if screen.deviance(other, own) > limits.CONFIRMED:
                return _Misread(candidate.family, samples, added, screen.own(own)[0])
    return None


def _free_to_err(circuit: BalanceDesign, misread: _Misread) -> BalanceDesign:
    """The balance with what a misread angle adds among its base, in case the torque got its size wrong."""
    free = tuple(Coefficient(f"misread_{k}", "effect", "N m") for k in range(misread.columns.shape[1]))
    return replace(
        circuit,
        coefficients=(*circuit.coefficients, *free),
        columns=np.hstack([circuit.columns, misread.columns]),
        samples=np.hstack([circuit.samples, misread.samples]),
    )


def _others(electrical: Search, misread: _Misread) -> list[Variant]:
    """What was found in the electrical balance but has other columns there than the misread angle."""
    screen = electrical.screen
    return [v for v in electrical.best.variants if not spans(misread.columns, screen.columns(v))]


def _beside(mechanical: Search, electrical: Search) -> list[Beside]:
    """The mechanical effects that an effect of both balances is estimated beside, the largest first.

    What the mechanical balance lacks counts as noise there, and what the torque says of that effect is wrong
    by a part of it. What is small may itself be a part of that torque, and go with a better estimate. There
    are none without an effect of both balances; effects on the flux, and those that change the base, are left
    out.
    """
    if not any(v.candidate.joint and v.candidate.also is not None for v in electrical.best.variants):
        return []
    ids = {variant.candidate.id for variant in electrical.best.variants}
    screen, best = mechanical.screen, mechanical.best
    own = [v for v in best.variants if v.candidate.id not in ids and not v.candidate.joint]
    own.sort(key=lambda v: -screen.fit([other for other in best.variants if other is not v]).score)
    made = [(v, screen.columns(v)) for v in own]
    return [(columns, bounds_of(v.candidate, columns.shape[1])) for v, columns in made if columns.size]


def _corrected(balance: BalanceDesign, electrical: Search, beside: Sequence[Beside] = ()) -> BalanceDesign:
    """The mechanical target without what effects found in the electrical balance add to it.

    An effect that both balances measure is estimated from both, `beside` effects of the mechanical one.
    """
    target, best = balance.target, electrical.best
    found = electrical.screen.own(best)
    if any(variant.candidate.joint for variant in best.variants):
        joint = BothBalances(electrical.screen, best, balance, beside)
        found = joint.run()
        electrical.best = best = electrical.screen.fit(joint.variants)
    for variant, own in zip(best.variants, found, strict=True):
        if variant.candidate.also is not None:
            target = target - balance.rows.mean(variant.candidate.also(variant.values)) @ own
    return replace(balance, target=target)
