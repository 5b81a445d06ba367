"""Which of a few candidates a balance needs, without smooth terms: the loads that friction may follow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from eccentric.diagnosis.search import limits
from eccentric.diagnosis.search.attribution import Search
from eccentric.diagnosis.search.candidate import Candidate
from eccentric.diagnosis.search.screen import Screen
from eccentric.identification import BalanceDesign


@dataclass(frozen=True)
class LoadSearch:
    """What was found.

    adopted: families, in order of adoption; alike: others that explain the balance as well as one of them;
    deviance: gain of the best single candidate, cross-validated; required: what an addition has to gain.
    """

    adopted: tuple[str, ...]
    alike: tuple[str, ...]
    deviance: float
    required: float


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
