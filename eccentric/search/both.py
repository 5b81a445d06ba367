"""The search on both balances: what one of them shows is taken out of the other.

The electrical balance comes first, so that what a current sensor's bias or delay adds to the mechanical
balance can be subtracted there. An angle that is read wrongly shows in both: its velocity is wrong, and the
back-EMF varies over a turn as with a ripple of the flux, whose torque would then be subtracted in vain. Where
such an angle fits the mechanical balance as it is better than what was found, both are searched again with
the angle first, and that stands if neither is worse for it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eccentric.search.attribution import Search
from eccentric.search.candidate import Candidate, Variant
from eccentric.search.joint import BothBalances
from eccentric.search.limits import CONFIRMED, LEAST_DEVIANCE, TINY_COLUMN
from eccentric.search.screen import Screen
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

    by_name = {balance.name: balance for balance in balances}
    mechanical, circuit = by_name["mechanical"], by_name.get("electrical")
    if circuit is None:
        return {"mechanical": searched(mechanical)}
    electrical = searched(circuit)
    found = searched(_corrected(mechanical, electrical), also=_of_the_flux(electrical))
    misread = _in_the_circuit(found, circuit)
    as_found = {"electrical": electrical, "mechanical": found}
    if misread is None and not _rather_misread(found, mechanical):
        return as_found
    # Nothing is taken out, since all of it may be due to the angle.
    first = _in_the_circuit(searched(mechanical), circuit) or misread
    if first is None:
        return as_found
    clean = searched(replace(circuit, target=circuit.target - first.columns @ first.coefficients))
    # Beside what else was found there: a large effect would hide the difference.
    screen = electrical.screen
    others = [v for v in electrical.best.variants if not _spans(first.columns, screen.columns(v))]
    if electrical.deviance(clean.screen.fit(others), screen.fit(others)) < CONFIRMED:
        with_it = searched(_corrected(mechanical, clean), also=_of_the_flux(clean))
        # What has the angle already may lose by it: a ripple of the flux that is none.
        no_worse = misread is not None or found.deviance(with_it.best, found.best) < CONFIRMED
        if no_worse and _in_the_circuit(with_it, circuit) is not None:
            return {"electrical": clean, "mechanical": with_it}
    if misread is None:
        return as_found
    # The voltage does not have what such an angle would add.
    found = searched(_corrected(mechanical, electrical), misread.family, _of_the_flux(electrical))
    return {"electrical": electrical, "mechanical": found}


def _of_the_flux(electrical: Search) -> list[Candidate]:
    """Effects on the flux as torques, for the mechanical search.

    Those that the electrical balance shows too faintly to adopt: what is small beside the armature's voltage
    may be most of what the mechanical balance lacks. And those adopted there, with their shapes: beside
    other effects the torque determines their coefficients better than the first estimate from both did.
    """
    adopted = [variant for variant in electrical.best.variants if variant.candidate.joint]
    families = {variant.candidate.family for variant in electrical.best.variants}
    faint = [
        fitted.last.in_the("mechanical")
        for fitted in electrical.ranked
        if fitted.last.joint
        and fitted.last.also is not None
        and fitted.last.family not in families
        and electrical.deviance(electrical.base, fitted) > CONFIRMED
    ]
    return [*(v.candidate.in_the("mechanical", v.values) for v in adopted if v.candidate.also), *faint]


@dataclass(frozen=True)
class _Misread:
    """The family of a mechanical effect, and what it adds to the electrical target: columns (rows, k)."""

    family: str
    columns: Array
    coefficients: Array


def _in_the_circuit(mechanical: Search, circuit: BalanceDesign) -> _Misread | None:
    """The mechanical effect found that adds to the electrical target; None if none does."""
    best = mechanical.best
    for variant, own in zip(best.variants, mechanical.screen.own(best), strict=True):
        candidate = variant.candidate
        if candidate.also is not None:
            return _Misread(candidate.family, circuit.rows.mean(candidate.also(variant.values)), own)
    return None


def _rather_misread(found: Search, mechanical: BalanceDesign) -> bool:
    """Whether an angle read wrongly fits the balance as it is better than what was found, the corrected one.

    It takes the place of every ripple of the flux, and of one other effect or of none.
    """
    screen, best = Screen(mechanical, ()), found.best
    angles = [Variant(c, {}) for c in found.screen.candidates if c.also is not None and not c.shapes]
    others = [v for v in best.variants if not v.candidate.joint]
    options = [[v for v in others if v is not out] for out in (None, *others)]
    return any(screen.fit([*kept, angle]).score < best.score for angle in angles for kept in options)


def _spans(columns: Array, others: Array) -> bool:
    """Whether the other columns are combinations of these."""
    left = others - columns @ np.linalg.lstsq(columns, others, rcond=None)[0]
    return bool(np.linalg.norm(left) < TINY_COLUMN * np.linalg.norm(others))


def _corrected(balance: BalanceDesign, electrical: Search) -> BalanceDesign:
    """The mechanical target without what effects found in the electrical balance add to it.

    An effect that both balances measure is estimated from both.
    """
    target, best = balance.target, electrical.best
    found = electrical.screen.own(best)
    if any(variant.candidate.joint for variant in best.variants):
        joint = BothBalances(electrical.screen, best, balance)
        found = joint.run()
        electrical.best = best = electrical.screen.fit(joint.variants)
    for variant, own in zip(best.variants, found, strict=True):
        if variant.candidate.also is not None:
            target = target - balance.rows.mean(variant.candidate.also(variant.values)) @ own
    return replace(balance, target=target)
