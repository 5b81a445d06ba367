"""The search on both balances: what one of them shows is taken out of the other.

The electrical balance comes first, so that what a current sensor's bias or delay adds to the mechanical
balance can be subtracted there. An effect that both show is estimated from both, beside the largest of what
else the mechanical balance shows. An angle that is read wrongly shows in both: its velocity is wrong, and the
back-EMF varies over a turn as with a ripple of the flux. In the electrical balance both have the same
columns, so the mechanical balance decides; the search then begins again without what the misread angle adds.
It decides too where the circuit cannot tell an effect that has a torque from one that has another, or none.
Effects on the flux may show in the torque alone (`flux`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eccentric.estimation import Coefficient
from eccentric.search.attribution import Search
from eccentric.search.candidate import Candidate, Variant, bounds_of
from eccentric.search.flux import as_torques, contradicted, weigh_with_the_circuit
from eccentric.search.joint import Beside, BothBalances
from eccentric.search.limits import CONFIRMED, LEAST_DEVIANCE, MOST_BESIDE, POSSIBLE, TINY_COLUMN
from eccentric.search.screen import Fitted, Screen
from eccentric.search.smooth import Variables, smooth_terms
from eccentric.signals import BalanceDesign

__all__ = ["search_all"]

Array = np.ndarray


def search_all(
    balances: Sequence[BalanceDesign],
    candidates: Sequence[Candidate],
    variables: Variables,
    noise: Mapping[str, float],
    progress: Callable[[str], None],
    required: float = LEAST_DEVIANCE,
) -> dict[str, Search]:
    """Run the search on every balance, by name; arguments as in `verdict.attribute`."""

    def searched(balance: BalanceDesign, but: str = "", also: Sequence[Candidate] = ()) -> Search:
        own = [c for c in [*candidates, *also] if c.balance == balance.name and c.family != but]
        progress(f"{balance.name} balance: {len(own)} candidates on {len(balance.target)} windows")
        screen = Screen(balance, own, noise.get(balance.name, 0.0))
        smooth = Screen(balance, smooth_terms(variables, balance.name, balance.rows.used_samples()))
        base = screen.fit([])
        search = Search(screen, smooth, base, base, required=required)
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
        for count in range(1, MOST_BESIDE + 1):
            beside = _beside(found, electrical)[:count]
            if _in_the_circuit(found, circuit) is not None or not beside:
                break
            trial = replace(electrical)  # taken over only with the search that goes with it
            again = _corrected(mechanical, trial, beside)
            if not _differs(again, corrected, found):
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
                if least > LEAST_DEVIANCE:
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
    if electrical.deviance(Screen(read_right, ()).fit(others), screen.fit(others)) < CONFIRMED:
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
    likely = {f for f, chance in electrical.chances(place).items() if chance > POSSIBLE and f in options}
    likely |= set(electrical.instead(family)) & set(options)
    likely = likely or set([*sorted(options, key=lambda f: options[f].score)][:1])
    with_torque = [f for f in likely if options[f].last.also is not None]
    without = sorted(likely - set(with_torque))[:1]
    fits = [options[f] for f in [*sorted(with_torque), *without]]
    return [replace(electrical, best=fitted) for fitted in fits]


@dataclass(frozen=True)
class _Misread:
    """The family of a mechanical effect, and what it adds to the electrical target.

    samples (n, k) and their averages, columns (rows, k); coefficients: (k,), as the torque has them.
    """

    family: str
    samples: Array
    columns: Array
    coefficients: Array


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
    linear = [c for c in candidates if c.balance == mechanical.name and not c.shapes]
    for variant in best.variants:
        torque = variant.candidate.also
        for candidate in linear:
            if torque is None or candidate.also is None:
                continue
            samples = candidate.also({})
            added = rows.mean(samples)
            if not _spans(added, electrical.columns(variant)):
                continue
            other = screen.fit([Variant(replace(variant.candidate, columns=torque), variant.values)])
            own = screen.fit([Variant(candidate, {})])
            if screen.deviance(other, own) > CONFIRMED:
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
    return [v for v in electrical.best.variants if not _spans(misread.columns, screen.columns(v))]


def _spans(columns: Array, others: Array) -> bool:
    """Whether the other columns are combinations of these."""
    left = others - columns @ np.linalg.lstsq(columns, others, rcond=None)[0]
    return bool(np.linalg.norm(left) < TINY_COLUMN * np.linalg.norm(others))


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


def _differs(new: BalanceDesign, old: BalanceDesign, found: Search) -> bool:
    """Whether two corrected targets differ by more than the noise explains."""
    change = new.target - old.target
    variance = found.best.score / found.screen.effective(found.best)
    return bool(change @ change > CONFIRMED * variance)


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
