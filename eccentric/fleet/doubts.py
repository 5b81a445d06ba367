"""Why a joint cannot be judged, or its answer is not to be believed: too few periods, or a rig of another."""

from __future__ import annotations

import numpy as np

from eccentric.fleet.drift import level_of
from eccentric.fleet.limits import LEAST_PERIODS, MOST_SCALE
from eccentric.fleet.periods import History
from eccentric.fleet.problems import NOT_TESTED, OTHER_RIG, FleetProblem
from eccentric.fleet.sums import SCALE

__all__ = ["doubts_of"]


def doubts_of(history: History) -> list[FleetProblem]:
    """What speaks against the history of a joint. Of one without any period, its logs have said why."""
    found: list[tuple[str, str]] = []
    count = len(history.periods)
    if 0 < count < LEAST_PERIODS:
        text = f"{LEAST_PERIODS} periods with an answer are required to tell a change, received {count}"
        found.append((NOT_TESTED, text))
    if (level := level_of(history)) <= 0.0:
        text = f"a positive mean friction torque is required, received {level:.3g} N m: a wrong sign?"
        found.append(("no friction", text))
    place = next((k for k, heading in enumerate(history.headings) if heading.name == SCALE), None)
    if count and place is not None:
        scale = float(np.median([period.values[place] for period in history.periods]))
        reach = float(np.median([period.reach * period.errors[place] for period in history.periods]))
        if scale + reach < 1.0 / MOST_SCALE or scale - reach > MOST_SCALE:
            text = (
                f"inertia and gravity near those of the rig are required, received {scale:.3g} times as much:"
                " masses, lengths, gear and torque constant of another joint?"
            )
            found.append((OTHER_RIG, text))
    return [FleetProblem(history.joint, "", "", kind, history.axis.said(text)) for kind, text in found]
