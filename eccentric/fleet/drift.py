"""Drift tests for each coefficient of each joint over its periods.

    value of a period = a + temperature part + change + scatter

The change is a straight line over all periods, or a step or a ramp that begins at one of them; the best fit
is selected, and its p-value multiplied by the number of alternatives (Bonferroni). The fleet shows the
scatter of healthy periods better than six periods of one joint: the variance of each test is shrunk towards
that of the fleet (Smyth, Statistical Applications in Genetics and Molecular Biology 3(1), 2004). A change
counts if it is a discovery at the requested rate by the procedure of Benjamini and Hochberg (J. Royal
Statistical Society B 57, 1995), and large enough to matter.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import digamma, polygamma, stdtr

from eccentric.fleet.limits import (
    EXPLAINED,
    LEAST_CHANGE,
    LEAST_PAST,
    LEAST_PERIODS,
    LEAST_RANGE_K,
    LEAST_RESIDUAL,
    LEAST_SIDE,
    MOST_PRIOR,
    MOST_SCALE,
    PERIODS_FOR_CURVATURE,
    SECOND,
)
from eccentric.fleet.periods import History, Period
from eccentric.fleet.sources import NOT_TESTED, OTHER_RIG, FleetProblem
from eccentric.fleet.sums import SCALE

Array = NDArray[np.float64]

FRICTION, RESIDUAL = "friction", "residual"
"""Tested in addition to the coefficients: the mean magnitude of the friction torque, and the logarithm of the
RMS residual of the drive torque."""


@dataclass(frozen=True)
class Series:
    """A quantity of a joint over its periods (p,): values, their standard errors, temperatures [deg C].

    A change of 1 is `torque` times the mean friction torque; it matters from `least` times that torque.
    """

    joint: str
    name: str
    unit: str
    periods: tuple[str, ...]
    values: Array
    errors: Array
    temperatures: Array
    torque: float
    least: float


@dataclass(frozen=True)
class FleetChange:
    """The best-fitting change of a series: shape, first period, size.

    `before` and `after` are the values before the change and at the end, at one temperature; `p` is the
    p-value under no change, `counts` whether it is a discovery large enough to matter.
    """

    series: Series
    shape: str
    since: str
    size: float
    before: float
    p: float
    counts: bool = False

    @property
    def after(self) -> float:
        """Value at the end."""
        return self.before + self.size

    @property
    def part(self) -> float:
        """The change as a fraction of the mean friction torque; for the residual, of its logarithm."""
        return self.size * self.series.torque


def level_of(history: History) -> float:
    """The mean friction torque of a joint, median over its periods [N m, or N]; NaN without periods."""
    return float(np.median([p.friction[0] for p in history.periods])) if history.periods else math.nan


def series_of(history: History, temperatures: Mapping[str, float]) -> Iterator[Series]:
    """Yield the series of a joint to test; `temperatures` [deg C] by period, NaN where unknown.

    Yields nothing with too few periods, or if `level_of` is not positive.
    """
    periods, level = history.periods, level_of(history)
    if len(periods) < LEAST_PERIODS or not level > 0.0:
        return
    names = tuple(p.period for p in periods)
    heat = np.array([temperatures.get(name, math.nan) for name in names])
    friction = np.array([p.friction for p in periods])

    def series(name: str, unit: str, values: Array, errors: Array, torque: float, least: float) -> Series:
        return Series(history.joint, name, unit, names, values, errors, heat, torque, least)

    for k, heading in enumerate(history.headings):
        size = float(np.median([p.sizes[k] for p in periods]))
        values, errors = (np.array([getattr(p, what)[k] for p in periods]) for what in ("values", "errors"))
        yield series(heading.name, heading.unit, values, errors, size / level, LEAST_CHANGE)
    if np.all(np.isfinite(friction)):
        yield series(
            FRICTION, history.axis.unit("N m"), friction[:, 0], friction[:, 1], 1.0 / level, LEAST_CHANGE
        )
    residuals = np.array([p.residual for p in periods])
    relative = residuals[:, 1] / residuals[:, 0]
    yield series(RESIDUAL, "1", np.log(residuals[:, 0]), relative, 1.0, LEAST_RESIDUAL)


def changes(series: Sequence[Series], rate: float) -> list[FleetChange]:
    """The best change of each series, with `counts` set at a false discovery rate."""
    fitted = [_fitted(one) for one in series]
    prior = {
        name: shrunk([f.null for f, s in zip(fitted, series, strict=True) if s.name == name])
        for name in {s.name for s in series}
    }
    best = [_best(one, fit, *prior[one.name]) for one, fit in zip(series, fitted, strict=True)]
    discoveries = discovered(np.array([change.p for change in best]), rate)
    return [
        replace(change, counts=bool(yes) and abs(change.part) >= change.series.least)
        for change, yes in zip(best, discoveries, strict=True)
    ]


def discovered(p: Array, rate: float) -> NDArray[np.bool_]:
    """Which of the p-values (n,) are discoveries at a false discovery rate: Benjamini and Hochberg."""
    if not len(p):
        return np.zeros(0, bool)
    order = np.argsort(p)
    below = np.flatnonzero(p[order] <= rate * np.arange(1, len(p) + 1) / len(p))
    rejected = np.zeros(len(p), bool)
    rejected[order[: below[-1] + 1 if len(below) else 0]] = True
    return rejected


def shrunk(scatter: Sequence[tuple[float, int]]) -> tuple[float, float]:
    """Prior variance and its degrees of freedom, from sample variances with theirs, most without change.

    From moments of their logarithms, estimated by medians to be robust against the few that do change.
    """
    sound = [(v, d) for v, d in scatter if v > 0.0 and d > 0]
    if len(sound) < 3:
        return 1.0, 0.0
    variances, freedom = (np.array(column, float) for column in zip(*sound, strict=True))
    logs = np.log(variances) - digamma(freedom / 2.0) + np.log(freedom / 2.0)
    middle = float(np.median(logs))
    # 1.4826 times the median deviation is the standard deviation of a normal distribution.
    spread = (1.4826 * float(np.median(np.abs(logs - middle)))) ** 2 - float(
        np.mean(polygamma(1, freedom / 2.0))
    )
    least = float(polygamma(1, MOST_PRIOR / 2.0))
    if spread <= least:
        return math.exp(middle - _bias(MOST_PRIOR)), MOST_PRIOR
    most = float(polygamma(1, 0.1))
    half = brentq(lambda x: float(polygamma(1, x)) - min(spread, most), 0.05, MOST_PRIOR / 2.0 + 1.0)
    prior = 2.0 * float(half)  # pyright: ignore[reportArgumentType]
    return math.exp(middle - _bias(prior)), prior


def _bias(freedom: float) -> float:
    """Bias of the logarithm of a sample variance with these degrees of freedom."""
    return -float(digamma(freedom / 2.0)) + math.log(freedom / 2.0)


@dataclass(frozen=True)
class _Fitted:
    """A series fitted without change: root weights, common basis (p, c), (variance, freedom)."""

    root: Array
    basis: Array
    null: tuple[float, int]


def _fitted(series: Series) -> _Fitted:
    """Weights from the period's error plus the median error, since periods scatter beyond their errors."""
    errors = series.errors
    weights = 1.0 / (errors**2 + np.median(errors) ** 2)
    root = np.sqrt(weights)
    basis = np.linalg.qr(_always(series) * root[:, None])[0]
    residual = series.values * root
    residual = residual - basis @ (basis.T @ residual)
    freedom = len(residual) - basis.shape[1]
    return _Fitted(root, basis, (float(residual @ residual) / max(freedom, 1), freedom))


def _always(series: Series) -> Array:
    """Columns common to all fits (p, c): a constant, and temperature where it is known and varies."""
    heat = series.temperatures
    columns = [np.ones(len(heat))]
    if np.all(np.isfinite(heat)) and np.ptp(heat) >= LEAST_RANGE_K:
        off = (heat - heat.mean()) / np.ptp(heat)
        columns.append(off)
        if len(heat) >= PERIODS_FOR_CURVATURE:
            columns.append(off**2)
    return np.stack(columns, axis=1)


def course_of(change: FleetChange) -> Array:
    """Unit shape of a change over the periods of its series (p,): 0 before, 1 at the end."""
    first = change.series.periods.index(change.since)
    every = _shapes(len(change.series.periods))
    return next(values for shape, at, values in every if (shape, at) == (change.shape, first))


def _shapes(count: int) -> Iterator[tuple[str, int, Array]]:
    """Alternative changes, 0 before and 1 at the end: shape, index of the first period, values (p,)."""
    place = np.arange(count)
    yield "trend", 1, place / (count - 1.0)
    for first in range(LEAST_SIDE, count - LEAST_SIDE + 1):
        yield "step", first, (place >= first).astype(float)
        yield "ramp", first, np.clip((place - first + 1.0) / (count - first), 0.0, 1.0)


def _best(series: Series, fit: _Fitted, variance: float, prior: float) -> FleetChange:
    y = series.values * fit.root
    y = y - fit.basis @ (fit.basis.T @ y)
    freedom = len(y) - fit.basis.shape[1] - 1
    best, p_best, tried = ("trend", 1, np.zeros(len(y)), 0.0), 1.0, 0
    for shape, first, values in _shapes(len(y)):
        x = values * fit.root
        x = x - fit.basis @ (fit.basis.T @ x)
        size = float(x @ x)
        if size <= 1e-9 * float((values * fit.root) @ (values * fit.root)):
            continue  # collinear with temperature
        tried += 1
        slope = float(x @ y) / size
        residual = y - x * slope
        scatter = (prior * variance + float(residual @ residual)) / (prior + freedom)
        if scatter <= 0.0:
            continue
        p = 2.0 * float(stdtr(prior + freedom, -abs(slope) * math.sqrt(size / scatter)))
        if p < p_best:
            best, p_best = (shape, first, values, slope), p
    shape, first, values, slope = best
    unchanged = (series.values - slope * values) * fit.root
    columns = _always(series)
    base = np.linalg.lstsq(columns * fit.root[:, None], unchanged, rcond=None)[0]
    before = float(np.mean(columns @ base))
    return FleetChange(series, shape, series.periods[first], slope, before, min(1.0, p_best * max(tried, 1)))


# Which coefficients explain a change at a joint, from its sums alone.
#
# Coefficients and their temperature dependence are fitted to the past. The recent periods are then predicted,
# and each coefficient in turn is allowed to change: the one with the smallest remaining error is named, with
# the error before and after. A change that no coefficient explains needs a diagnosis.
#
# A trend has hardly any past: where it is too short, all periods are fitted together, with the shape of the
# change in every coefficient.
@dataclass(frozen=True)
class Changed:
    """Explanation of a change by the sums of a joint."""

    names: tuple[str, ...]  # the changed coefficients, strongest first, empty if none explains it
    kinds: tuple[str, ...]  # their kinds
    before: float  # RMS error of the recent periods with the coefficients of the past [N m, or N]
    after: float  # the same with the named ones refitted
    usual: float  # the error of the past's coefficients on the past
    free: float  # that of all coefficients fitted to the recent periods
    explained: float  # the fraction of the new error (squared) that the names explain
    level: float  # the mean friction torque of the past [N m, or N]

    @property
    def matters(self) -> bool:
        """Whether the recent periods are predicted worse than the past, by enough of the friction torque.

        Correlated coefficients may shift against each other and predict the same.
        """
        return self.before**2 - self.usual**2 > (LEAST_CHANGE * self.level) ** 2


def recent_of(history: History, change: FleetChange) -> tuple[list[Period], list[Period]]:
    """The periods before a change, and the last ones, where the change is complete."""
    first = [p.period for p in history.periods].index(change.since)
    last = max(first, len(history.periods) - LEAST_SIDE)
    return list(history.periods[:first]), list(history.periods[last:])


def against_the_past(history: History, change: FleetChange, heat: Mapping[str, float]) -> Changed:
    """Which coefficients explain a change; `heat` [deg C] is the temperature by period, where known."""
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
    unexplained = [(rows(p)[0][:, :k], rows(p)[1] - rows(p)[0] @ base) for p in recent]
    windows = sum(p.windows for p in recent)

    def error(columns: Sequence[int]) -> float:
        x = np.concatenate([x[:, list(columns)] for x, _ in unexplained])
        y = np.concatenate([y for _, y in unexplained])
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
    """Temperature deviations from the past's mean, over its range; all 0 if that range is too small."""
    known = [heat.get(p.period, math.nan) for p in (*past, *recent)]
    range_of_past = np.ptp(known[: len(past)]) if past else 0.0
    if not np.all(np.isfinite(known)) or range_of_past < LEAST_RANGE_K or len(past) < LEAST_PAST:
        return {p.period: 0.0 for p in (*past, *recent)}
    middle = float(np.mean(known[: len(past)]))
    return {
        p.period: (t - middle) / float(range_of_past) for p, t in zip((*past, *recent), known, strict=True)
    }


def _least(rows: Sequence[tuple[Array, Array]], periods: Sequence[Period]) -> tuple[Array, float]:
    """Least squares over several periods: values, and the RMS error per window."""
    x, y = np.concatenate([x for x, _ in rows]), np.concatenate([y for _, y in rows])
    values = np.asarray(np.linalg.lstsq(x, y, rcond=None)[0], float)
    residual = y - x @ values
    return values, math.sqrt(float(residual @ residual) / sum(p.windows for p in periods))


_NEAR = "expected inertia and gravity near those of the rig"
_CONSTANTS = "masses, lengths, gear and torque constant"


def doubts_of(history: History) -> list[FleetProblem]:
    """Doubts about the history of a joint; a joint without any period has problems of its logs already."""
    doubts: list[tuple[str, str]] = []
    count, axis = len(history.periods), history.axis
    if 0 < count < LEAST_PERIODS:
        text = f"expected {LEAST_PERIODS} periods with an answer to tell a change, got {count}"
        doubts.append((NOT_TESTED, text))
    if (level := level_of(history)) <= 0.0:
        text = (
            f"expected a positive mean friction {axis.term('torque')}, got"
            f" {level:.3g} {axis.unit('N m')}: a wrong sign?"
        )
        doubts.append(("no friction", text))
    place = next((k for k, heading in enumerate(history.headings) if heading.name == SCALE), None)
    if count and place is not None:
        scale = float(np.median([period.values[place] for period in history.periods]))
        reach = float(np.median([period.reach * period.errors[place] for period in history.periods]))
        if scale + reach < 1.0 / MOST_SCALE or scale - reach > MOST_SCALE:
            text = (
                f"{axis.term(_NEAR)}, got {scale:.3g} times as much:"
                f" {axis.term(_CONSTANTS)} of another joint?"
            )
            doubts.append((OTHER_RIG, text))
    return [FleetProblem(history.joint, "", "", kind, text) for kind, text in doubts]
