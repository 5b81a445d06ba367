"""The probability that a diagnosis of log and motion together decides, from how far apart the rivals are.

For a true rival the log-likelihood ratio over another is normal, with mean D/2 and variance D, where D is
what `separation` computes. A verdict needs the odds `ODDS`, and the same answer in nine variants of the log
in ten, each a part f of its blocks: the ratio then varies once more, by sqrt(1/f - 1) of that spread.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.stats import norm

from eccentric.planning.limits import ODDS, VARIANTS_AGREE

__all__ = ["decided", "expected"]

Pairs = Mapping[tuple[str, str], float]
"""(true family, other family) -> D."""


def decided(apart: float) -> float:
    """The probability that a true rival is named over another, D apart."""
    spread = np.sqrt(max(apart, 1e-12))
    return float(norm.cdf((0.5 * apart - max(np.log(ODDS), VARIANTS_AGREE * spread)) / spread))


def expected(pairs: Pairs, chances: Mapping[str, float]) -> float:
    """The probability that the true rival is named over all others, whichever it is."""
    return sum(
        chance * min((decided(d) for (truth, _), d in pairs.items() if truth == family), default=1.0)
        for family, chance in chances.items()
    )
