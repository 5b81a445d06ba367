"""Effects on the flux of the motor: torque and voltage both show them, and either may be too noisy to.

The mechanical search is offered all of them as torques. What it finds is held against the circuit, with the
coefficients that the torque gives it: an effect whose voltage is missing there is not offered again. Where
the torque cannot tell one from friction, which has no voltage, what the circuit says is added.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eccentric.search.attribution import Search
from eccentric.search.candidate import Candidate, Variant
from eccentric.search.limits import HINTED, LEAST_DEVIANCE, POSSIBLE
from eccentric.search.screen import Fitted

__all__ = ["as_torques", "contradicted", "weigh_with_the_circuit"]

Array = np.ndarray


def as_torques(electrical: Search) -> list[Candidate]:
    """Effects on the flux for the mechanical search.

    Those adopted in the circuit, with their shapes: beside other effects the torque determines their
    coefficients better than the first estimate from both did. And those of all other families, however faint
    there: what is small beside the armature's voltage may be most of what the mechanical balance lacks.
    """
    adopted = [variant for variant in electrical.best.variants if variant.candidate.joint]
    families = _families(electrical.best)
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
    return least if least is not None and gains[least] < -HINTED else None


def weigh_with_the_circuit(mechanical: Search, electrical: Search) -> None:
    """Add to what the torque says of effects on the flux what the circuit says, too faint to adopt there.

    Only where what could be in their place is friction, of which the circuit would show nothing.
    """
    for place, variant in enumerate(mechanical.best.variants):
        family, options = variant.candidate.family, mechanical.alternatives[place]
        circuit = _deviance_in_the_circuit(mechanical, mechanical.best, place, electrical)
        if circuit <= HINTED or mechanical.clear(place):
            continue
        rivals = _likely(mechanical, place, family)
        if not rivals or not rivals <= set(options) or any(options[r][1].last.joint for r in rivals):
            continue
        if not mechanical.stability.nearly_all(family, *rivals):
            continue
        torque = min(mechanical.deviance(options[r][1], mechanical.best) for r in rivals)
        if circuit + torque > LEAST_DEVIANCE:
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
    adopted = _families(electrical.best)
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
    likely = {other for other, chance in mechanical.chances(place).items() if chance > POSSIBLE}
    return (likely | set(mechanical.instead(family))) - {family}


def _families(fitted: Fitted) -> set[str]:
    return {variant.candidate.family for variant in fitted.variants}
