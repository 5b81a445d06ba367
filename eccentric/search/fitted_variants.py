"""Effects that a person names, fitted without a search: the best variant of each on the training part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eccentric.search.candidate import Candidate, Variant
from eccentric.search.screen import Screen
from eccentric.signals import BalanceDesign

__all__ = ["fitted_variants"]


def fitted_variants(
    balances: Sequence[BalanceDesign],
    pools: Sequence[Sequence[Candidate]],
    noise: Mapping[str, float],
) -> list[tuple[Variant, tuple[float, ...]] | None]:
    """For each pool its best variant beside those of the other pools, with the coefficients of its columns.

    balances: of the training part; pools: the candidates that one name stands for, such as the members of a
    family; noise: RMS of a window, by balance. None for a pool of which no candidate fits.
    """
    found: dict[int, tuple[Variant, tuple[float, ...]]] = {}
    for balance in balances:
        own = {k: [c for c in pool if c.balance == balance.name] for k, pool in enumerate(pools)}
        adopted: list[Variant] = []
        order = []
        for k, candidates in own.items():
            ranked = Screen(balance, candidates, noise.get(balance.name, 0.0)).rank(adopted)
            if ranked:
                adopted = list(ranked[0].variants)
                order.append(k)
        screen = Screen(balance, [c for k in order for c in own[k]])
        last = screen.refine(screen.fit(adopted))
        for k, variant, coefficients in zip(order, last.variants, screen.own(last), strict=True):
            found[k] = (variant, tuple(map(float, coefficients)))
    return [found.get(k) for k in range(len(pools))]
