"""What the user asks of the estimator."""

from __future__ import annotations

import math
from dataclasses import dataclass

from eccentric.errors import InputError

MOST_SETTLE = 100_000
LEAST_FORGETTING, LEAST_FALSE_ALARMS, MOST_FALSE_ALARMS = 0.9, 100.0, 1e10


@dataclass(frozen=True)
class Adaptation:
    """What is asked of the estimator.

    Attributes:
        forgetting: of a direction of the coefficients, per row that excites it, below 1: the friction in such
            a row is known as well as by averaging 1/(1 - forgetting) rows like it.
        false_alarms: mean number of samples between two false alarms.
        settle: samples left out after a reversal or a start: as long as friction, and any filter of the
            signals, takes to be that of steady motion.
    """

    forgetting: float = 0.999
    false_alarms: float = 1e7
    settle: int = 20

    def __post_init__(self) -> None:
        forgetting, asked = self.forgetting, self.false_alarms
        if not _number(forgetting) or not LEAST_FORGETTING <= forgetting <= 1 - 1e-6:
            raise InputError(
                f"forgetting: a number from {LEAST_FORGETTING} to 0.999999 is required,"
                f" received {forgetting!r}"
            )
        if not _number(asked) or not LEAST_FALSE_ALARMS <= asked <= MOST_FALSE_ALARMS:
            raise InputError(
                f"false_alarms: a number of samples from {LEAST_FALSE_ALARMS:.0f} to {MOST_FALSE_ALARMS:.0e}"
                f" is required, received {asked!r}"
            )
        if (
            isinstance(self.settle, bool)
            or not isinstance(self.settle, int)
            or not 0 <= self.settle <= MOST_SETTLE
        ):
            raise InputError(
                f"settle: a number of samples from 0 to {MOST_SETTLE} is required, received {self.settle!r}"
            )


def _number(x: object) -> bool:
    return isinstance(x, int | float) and not isinstance(x, bool) and math.isfinite(x)
