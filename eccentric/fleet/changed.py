"""What changed at a joint, by its sums alone: the coefficients that explain the recent periods.

The past fixes coefficients and what temperature does to them. The recent periods are then predicted, and one
coefficient after another is allowed to change: the one that leaves the smallest error is named, with the
error before and after. What no coefficient explains is left to a diagnosis.

A trend has no past to speak of: where it is short, all periods fix coefficients and temperature, beside the
course of the change in every coefficient.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.fleet.drift import FleetChange, course_of
from eccentric.fleet.limits import (
    EXPLAINED,
    LEAST_CHANGE,
    LEAST_PAST,
    LEAST_RANGE_K,
    LEAST_SIDE,
    SECOND,
)
from eccentric.fleet.periods import History, Period

__all__ = ["Changed", "against_the_past", "recent_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Changed:
    """What the sums of a joint say about a change.

    `names` are the coefficients that changed, strongest first, empty if none explains it; `kinds` what each
    is. `before` and `after` are RMS errors [N m, or N] of the recent periods: with the coefficients of the
    past, and with those named changed. `usual` is the error of the past's own coefficients on the past,
    `free` that of all coefficients fitted to the recent periods, `explained` the part of the new error
    (squared) that the names explain; `level` is the mean friction torque of the past [N m, or N].
    """

    names: tuple[str, ...]
    kinds: tuple[str, ...]
    before: float
    after: float
    usual: float
    free: float
    explained: float
    level: float

    @property
    def matters(self) -> bool:
        """Whether the past predicts the recent periods worse than itself, by enough of the friction torque.

        Coefficients that are alike may trade with each other and predict the same.
        """
        return self.before**2 - self.usual**2 > (LEAST_CHANGE * self.level) ** 2


def recent_of(history: History, change: FleetChange) -> tuple[list[Period], list[Period]]:
    """Periods of the past, before a change, and the last ones: what is wrong now, all of it and no less."""
    first = [p.period for p in history.periods].index(change.since)
    last = max(first, len(history.periods) - LEAST_SIDE)
    return list(history.periods[:first]), list(history.periods[last:])


def against_the_past(history: History, change: FleetChange, heat: Mapping[str, float]) -> Changed:
    """What changed at a joint since a change; `heat` [deg C] is the temperature by period, where known."""
    past, recent = recent_of(history, change)
    headings = history.headings
    k = len(headings)
    friction = np.array([h.is_friction for h in headings])
    short = len(past) < LEAST_PAST
    known = history.periods if short else past
    warmth = _warmth(known, [] if short else recent, heat)
    course = dict(zip(change.series.periods, course_of(change), strict=True))

    def rows(p: Period) -> tuple[Array, Array]:
        x, y = p.triangle[:, :k], p.triangle[:, k]
        return np.column_stack([x, x[:, friction] * warmth[p.period]]), y

    def with_change(p: Period) -> tuple[Array, Array]:
        x, y = rows(p)
        return np.column_stack([x, x[:, :k] * course[p.period]]), y

    base, usual = _least([(with_change if short else rows)(p) for p in known], known)
    base = base[: k + np.count_nonzero(friction)]
    left = [(rows(p)[0][:, :k], rows(p)[1] - rows(p)[0] @ base) for p in recent]
    windows = sum(p.windows for p in recent)

    def error(columns: Sequence[int]) -> float:
        x = np.concatenate([x[:, list(columns)] for x, _ in left])
        y = np.concatenate([y for _, y in left])
        if columns:
            y = y - x @ np.linalg.lstsq(x, y, rcond=None)[0]
        return math.sqrt(float(y @ y) / windows)

    before, free = error([]), error(range(k))
    new = max(before**2 - min(usual, free) ** 2, np.finfo(float).tiny)

    def explained(columns: Sequence[int]) -> float:
        return (before**2 - error(columns) ** 2) / new

    first = max(range(k), key=lambda j: explained([j]))
    chosen = [first]
    second = max((j for j in range(k) if j != first), key=lambda j: explained([first, j]))
    if explained([first, second]) - explained([first]) > SECOND:
        chosen.append(second)
    part = explained(chosen)
    named = chosen if part >= EXPLAINED else []
    return Changed(
        tuple(headings[j].name for j in named),
        tuple(headings[j].kind for j in named),
        before,
        error(named) if named else error(range(k)),
        usual,
        free,
        part,
        float(np.nanmean([p.friction[0] for p in past])),
    )


def _warmth(past: Sequence[Period], recent: Sequence[Period], heat: Mapping[str, float]) -> dict[str, float]:
    """Temperatures over their range in the past, from its mean; all 0 where the past has too little range."""
    known = [heat.get(p.period, math.nan) for p in (*past, *recent)]
    range_of_past = np.ptp(known[: len(past)]) if past else 0.0
    if not np.all(np.isfinite(known)) or range_of_past < LEAST_RANGE_K or len(past) < LEAST_PAST:
        return {p.period: 0.0 for p in (*past, *recent)}
    middle = float(np.mean(known[: len(past)]))
    return {
        p.period: (t - middle) / float(range_of_past) for p, t in zip((*past, *recent), known, strict=True)
    }


def _least(rows: Sequence[tuple[Array, Array]], periods: Sequence[Period]) -> tuple[Array, float]:
    """Least squares over the rows of several periods: values, and the RMS error per window."""
    x, y = np.concatenate([x for x, _ in rows]), np.concatenate([y for _, y in rows])
    values = np.asarray(np.linalg.lstsq(x, y, rcond=None)[0], float)
    left = y - x @ values
    return values, math.sqrt(float(left @ left) / sum(p.windows for p in periods))
