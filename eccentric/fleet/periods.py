"""Stored sums -> coefficients with intervals, friction and residual of each joint by period."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from eccentric.fleet.limits import LEAST_BLOCKS, LEAST_DIRECTION, LEAST_RANGE_K, LEAST_SECONDS, STUCK_PERIODS
from eccentric.fleet.sources import FleetProblem
from eccentric.fleet.sums import OFFSET, Coverage, Heading, dependent, solve
from eccentric.fleet.work import Stored
from eccentric.identification import merged
from eccentric.model import TURNING, AxisKind

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Period:
    """A joint in one period: coefficient values (k,), their covariance and its degrees of freedom.

    `triangle` (k + 1, k + 1) are the underlying sums, over `windows` rows. `friction` is the mean magnitude
    of the friction torque in motion and `residual` the RMS residual of the fit, each with its standard error
    [N m, or N]. `sizes` (k,) are the RMS of the columns: the change of a coefficient times its size is a
    torque.
    """

    period: str
    values: Array
    covariance: Array
    freedom: int
    triangle: Array
    windows: int
    friction: tuple[float, float]
    residual: tuple[float, float]
    sizes: Array
    coverage: Coverage

    @property
    def errors(self) -> Array:
        """Standard errors (k,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def reach(self) -> float:
        """Half-width of the 95 % interval in standard errors."""
        return float(stdtrit(self.freedom, 0.975))


@dataclass(frozen=True)
class History:
    """The solved periods of a joint, in order of time, their columns, and the kind of axis."""

    joint: str
    headings: tuple[Heading, ...]
    periods: tuple[Period, ...]
    axis: AxisKind = TURNING


def history_of(
    joint: str, stored: Mapping[str, Sequence[Stored]], axis: AxisKind = TURNING
) -> tuple[History, list[FleetProblem]]:
    """The history of a joint from its sums by period, in order of time, and its unsolvable periods.

    If a period has motion in one direction only, sensor offset and Coulomb friction cannot be separated
    there: the offset column is then dropped in all periods of the joint.
    """
    problems: list[FleetProblem] = []
    usable: dict[str, tuple[Array, Coverage, int]] = {}
    headings: tuple[Heading, ...] = ()
    for period, rows in stored.items():
        stack = np.concatenate([row.sums.triangles for row in rows])
        windows = int(sum(row.sums.windows.sum() for row in rows))
        coverage = _together([row.sums.coverage for row in rows])
        headings = rows[0].headings
        occupied = int(np.count_nonzero(np.any(stack, axis=(1, 2))))
        if coverage.seconds < LEAST_SECONDS or occupied < LEAST_BLOCKS * len(headings):
            text = (
                f"expected {LEAST_SECONDS:g} s of motion in {math.ceil(LEAST_BLOCKS * len(headings))} blocks,"
                f" got {coverage.seconds:.3g} s in {occupied}"
            )
            problems.append(FleetProblem(joint, period, "", "not excited", text))
            continue
        usable[period] = stack, coverage, windows
    one_way = any(not LEAST_DIRECTION <= c.forward <= 1.0 - LEAST_DIRECTION for _, c, _ in usable.values())
    selected = [k for k, h in enumerate(headings) if not (one_way and h.name == OFFSET)]
    headings = tuple(headings[k] for k in selected)
    solved: list[Period] = []
    for period, (stack, coverage, windows) in usable.items():
        chosen = stack[:, :, [*selected, stack.shape[2] - 1]]
        if weak := dependent(merged(chosen)):
            names = ", ".join(headings[k].name for k in weak)
            text = (
                f"expected motion that tells {names} apart: more speeds,"
                f" {axis.term('angles')}, both directions"
            )
            problems.append(FleetProblem(joint, period, "", "singular", text))
            continue
        solved.append(_period(period, chosen, headings, coverage, windows))
    return History(joint, headings, tuple(solved), axis), problems


def _period(name: str, stack: Array, headings: Sequence[Heading], coverage: Coverage, windows: int) -> Period:
    solved, triangle = solve(stack), merged(stack)
    k = len(headings)
    gram = triangle[:k, :k].T @ triangle[:k, :k]
    friction = (math.nan, math.nan)
    sign = next((j for j, heading in enumerate(headings) if heading.kind == "coulomb"), None)
    if sign is not None:
        # Its column is sign(speed), whose square is 1: products with it sum the magnitude of friction.
        weights = np.where([heading.is_friction for heading in headings], gram[sign] / gram[sign, sign], 0.0)
        level = float(weights @ solved.values)
        friction = level, math.sqrt(float(weights @ solved.covariance @ weights))
    error = stack[:, :, k] - stack[:, :, :k] @ solved.values
    squares = np.sum(error**2, axis=1)
    occupied = np.any(stack, axis=(1, 2))
    rms = math.sqrt(float(squares.sum()) / windows)
    part = squares[occupied] / max(float(squares[occupied].mean()), np.finfo(float).tiny)
    residual = rms, rms * 0.5 * float(np.std(part)) / math.sqrt(max(len(part), 1))
    sizes = np.sqrt(np.diag(gram) / windows)
    return Period(
        *(name, solved.values, solved.covariance, solved.freedom, triangle, windows),
        *(friction, residual, sizes, coverage),
    )


def _together(parts: Sequence[Coverage]) -> Coverage:
    seconds = sum(c.seconds for c in parts)
    moving = [c for c in parts if c.seconds > 0.0]
    warm = [c for c in moving if math.isfinite(c.temperature)]

    def mean(name: str, of: Sequence[Coverage]) -> float:
        weights = [c.seconds for c in of]
        return float(np.average([getattr(c, name) for c in of], weights=weights)) if of else math.nan

    return Coverage(
        rows=sum(c.rows for c in parts),
        seconds=seconds,
        forward=mean("forward", moving),
        low=min((c.low for c in moving), default=math.nan),
        high=max((c.high for c in moving), default=math.nan),
        temperature=mean("temperature", warm),
        coldest=min((c.coldest for c in warm), default=math.nan),
        warmest=max((c.warmest for c in warm), default=math.nan),
    )


def temperatures_of(histories: Sequence[History]) -> tuple[dict[str, dict[str, float]], list[FleetProblem]]:
    """Joint -> period -> temperature [deg C], and stuck sensors.

    A sensor is stuck if it shows one value in several consecutive periods while the fleet's temperature
    varies. It is replaced by the median of the fleet's working sensors plus the joint's usual difference.
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
    temperatures: dict[str, dict[str, float]] = {}
    problems: list[FleetProblem] = []
    for history in histories:
        joint, known_here = history.joint, logged[history.joint]
        bad = stuck[joint]
        known = [usual[period] for period in bad if period in usual]
        if known and len(known) == len(bad) and np.ptp(known) < LEAST_RANGE_K:
            known_here |= {p.period: p.coverage.temperature for p in history.periods if p.period in bad}
            bad = []
        differences = [known_here[period] - usual[period] for period in known_here]
        aside = float(np.median(differences)) if differences else 0.0
        temperatures[joint] = known_here | {
            p.period: usual[p.period] + aside
            for p in history.periods
            if p.period not in known_here and p.period in usual
        }
        if bad:
            instead = (
                "that of the other joints is taken"
                if len(known) == len(bad)
                else "no other joint has one in all of these periods, and it is not taken out"
            )
            text = f"expected a temperature that varies, got one value from {bad[0]} to {bad[-1]}: {instead}"
            problems.append(FleetProblem(joint, bad[0], "", "temperature sensor", text))
    return temperatures, problems


def _stuck(periods: Sequence[Period]) -> list[str]:
    """Periods in runs of equal temperatures that are long enough."""
    stuck: list[str] = []
    run: list[Period] = []
    for period in periods:
        c = period.coverage
        same = c.coldest == c.warmest and (not run or run[-1].coverage.warmest == c.warmest)
        run = [*run, period] if same else [period] if c.coldest == c.warmest else []
        if len(run) >= STUCK_PERIODS:
            stuck = sorted({*stuck, *(p.period for p in run)})
    return stuck
