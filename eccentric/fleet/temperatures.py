"""The temperature of each joint in each period; where its sensor is stuck or has none, that of the fleet."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from eccentric.fleet.limits import LEAST_RANGE_K, STUCK_PERIODS
from eccentric.fleet.periods import History, Period
from eccentric.fleet.problems import FleetProblem

__all__ = ["temperatures_of"]


def temperatures_of(histories: Sequence[History]) -> tuple[dict[str, dict[str, float]], list[FleetProblem]]:
    """Joint -> period -> temperature [deg C], and sensors that are stuck.

    A sensor is stuck if it shows one value in several periods on end while the fleet's temperature varies.
    There the median of the fleet's sound sensors is taken, with the usual difference of this joint to it.
    """
    stuck = {history.joint: _stuck(history.periods) for history in histories}
    logged = {
        history.joint: {
            p.period: p.coverage.temperature
            for p in history.periods
            if math.isfinite(p.coverage.temperature) and p.period not in stuck[history.joint]
        }
        for history in histories
    }
    names = {period for sound in logged.values() for period in sound}
    usual = {
        period: float(np.median([sound[period] for sound in logged.values() if period in sound]))
        for period in names
    }
    found: dict[str, dict[str, float]] = {}
    problems: list[FleetProblem] = []
    for history in histories:
        joint, own = history.joint, logged[history.joint]
        bad = stuck[joint]
        known = [usual[period] for period in bad if period in usual]
        if known and len(known) == len(bad) and np.ptp(known) < LEAST_RANGE_K:
            own |= {p.period: p.coverage.temperature for p in history.periods if p.period in bad}
            bad = []
        differences = [own[period] - usual[period] for period in own]
        aside = float(np.median(differences)) if differences else 0.0
        found[joint] = own | {
            p.period: usual[p.period] + aside
            for p in history.periods
            if p.period not in own and p.period in usual
        }
        if bad:
            instead = (
                "that of the other joints is taken"
                if len(known) == len(bad)
                else "no other joint has one in all of these periods, and it is not taken out"
            )
            text = (
                f"a temperature that varies is required, received one value from {bad[0]} to {bad[-1]}:"
                f" {instead}"
            )
            problems.append(FleetProblem(joint, bad[0], "", "temperature sensor", text))
    return found, problems


def _stuck(periods: Sequence[Period]) -> list[str]:
    """Periods of a run of equal temperatures that is long enough."""
    found: list[str] = []
    run: list[Period] = []
    for period in periods:
        c = period.coverage
        same = c.coldest == c.warmest and (not run or run[-1].coverage.warmest == c.warmest)
        run = [*run, period] if same else [period] if c.coldest == c.warmest else []
        if len(run) >= STUCK_PERIODS:
            found = sorted({*found, *(p.period for p in run)})
    return found
