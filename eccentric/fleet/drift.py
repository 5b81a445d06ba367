"""What drifts: a test for each coefficient of each joint over its periods, and which of them count.

    value of a period = a + temperature part + change + scatter

The change is a straight line over all periods, or a step or a ramp from one of them on; the best is taken,
and its p-value multiplied by how many there were (Bonferroni). How far healthy periods scatter is known
better from the fleet than from six periods of one joint: the variance of each test is shrunk towards that of
the fleet (Smyth, Statistical Applications in Genetics and Molecular Biology 3(1), 2004). Of all p-values
those count that the procedure of Benjamini and Hochberg (J. Royal Statistical Society B 57, 1995) leaves at
the rate asked for, and whose change is large enough to matter.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import digamma, polygamma
from scipy.stats import t as student

from eccentric.fleet.limits import (
    LEAST_CHANGE,
    LEAST_PERIODS,
    LEAST_RANGE_K,
    LEAST_RESIDUAL,
    LEAST_SIDE,
    MOST_PRIOR,
    PERIODS_FOR_CURVATURE,
)
from eccentric.fleet.periods import History

__all__ = [
    "FRICTION",
    "RESIDUAL",
    "FleetChange",
    "Series",
    "changes",
    "course_of",
    "discovered",
    "level_of",
    "series_of",
    "shrunk",
]

Array = NDArray[np.float64]

FRICTION, RESIDUAL = "friction", "residual"
"""Tested beside the coefficients: the mean size of the friction torque, and what the model leaves of the
drive torque, by its logarithm."""


@dataclass(frozen=True)
class Series:
    """A quantity of a joint over its periods (p,): values, their standard errors, temperatures [deg C].

    A change of 1 is `torque` of the mean friction torque; it counts from `least` of it.
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
    """The best change of a series: its shape, the period that it begins with, its size and part of friction.

    `before` and `after` are the values that the changed part starts from and has at the end, at one
    temperature; `p` is the probability of a change at least as large where nothing changed, `counts` whether
    it is a discovery that matters.
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
        """The value at the end."""
        return self.before + self.size

    @property
    def part(self) -> float:
        """The change as a part of the mean friction torque; of the residual, of its logarithm."""
        return self.size * self.series.torque


def level_of(history: History) -> float:
    """The mean friction torque of a joint, the usual one of its periods [N m, or N]; NaN without any."""
    return float(np.median([p.friction[0] for p in history.periods])) if history.periods else math.nan


def series_of(history: History, temperatures: Mapping[str, float]) -> Iterator[Series]:
    """The series of a joint that are tested; `temperatures` [deg C] by period, NaN where none is known.

    None where there are too few periods, or `level_of` is not positive.
    """
    periods, level = history.periods, level_of(history)
    if len(periods) < LEAST_PERIODS or not level > 0.0:
        return
    names = tuple(p.period for p in periods)
    heat = np.array([temperatures.get(name, math.nan) for name in names])
    friction = np.array([p.friction for p in periods])

    def one(name: str, unit: str, values: Array, errors: Array, torque: float, least: float) -> Series:
        return Series(history.joint, name, unit, names, values, errors, heat, torque, least)

    for k, heading in enumerate(history.headings):
        size = float(np.median([p.sizes[k] for p in periods]))
        values, errors = (np.array([getattr(p, what)[k] for p in periods]) for what in ("values", "errors"))
        yield one(heading.name, heading.unit, values, errors, size / level, LEAST_CHANGE)
    if np.all(np.isfinite(friction)):
        yield one(
            FRICTION, history.axis.said("N m"), friction[:, 0], friction[:, 1], 1.0 / level, LEAST_CHANGE
        )
    left = np.array([p.residual for p in periods])
    yield one(RESIDUAL, "1", np.log(left[:, 0]), left[:, 1] / left[:, 0], 1.0, LEAST_RESIDUAL)


def changes(series: Sequence[Series], rate: float) -> list[FleetChange]:
    """The best change of each series, and which count at a false discovery rate."""
    fitted = [_fitted(one) for one in series]
    prior = {
        name: shrunk([f.null for f, s in zip(fitted, series, strict=True) if s.name == name])
        for name in {s.name for s in series}
    }
    found = [_best(one, fit, *prior[one.name]) for one, fit in zip(series, fitted, strict=True)]
    called = discovered(np.array([change.p for change in found]), rate)
    return [
        replace(change, counts=bool(yes) and abs(change.part) >= change.series.least)
        for change, yes in zip(found, called, strict=True)
    ]


def discovered(p: Array, rate: float) -> NDArray[np.bool_]:
    """Which of the p-values (n,) are discoveries at a false discovery rate: Benjamini and Hochberg."""
    if not len(p):
        return np.zeros(0, bool)
    order = np.argsort(p)
    below = np.flatnonzero(p[order] <= rate * np.arange(1, len(p) + 1) / len(p))
    called = np.zeros(len(p), bool)
    called[order[: below[-1] + 1 if len(below) else 0]] = True
    return called


def shrunk(scatter: Sequence[tuple[float, int]]) -> tuple[float, float]:
    """Prior variance and its degrees of freedom from variances with theirs, most of them without change.

    Moments of their logarithms, by medians, so that the few that do change say little.
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
    """Mean logarithm of a variance with degrees of freedom, over the true one's."""
    return -float(digamma(freedom / 2.0)) + math.log(freedom / 2.0)


@dataclass(frozen=True)
class _Fitted:
    """A series against its alternatives: weights, what is in every fit, and the scatter without change."""

    root: Array
    basis: Array
    null: tuple[float, int]


def _fitted(series: Series) -> _Fitted:
    """Each period weighs by its own error and the usual one: none is known better than periods scatter."""
    errors = series.errors
    weights = 1.0 / (errors**2 + np.median(errors) ** 2)
    root = np.sqrt(weights)
    basis = np.linalg.qr(_always(series) * root[:, None])[0]
    left = series.values * root
    left = left - basis @ (basis.T @ left)
    freedom = len(left) - basis.shape[1]
    return _Fitted(root, basis, (float(left @ left) / max(freedom, 1), freedom))


def _always(series: Series) -> Array:
    """What is in every fit (p, c): a constant, and temperature where it is known and varies."""
    heat = series.temperatures
    columns = [np.ones(len(heat))]
    if np.all(np.isfinite(heat)) and np.ptp(heat) >= LEAST_RANGE_K:
        off = (heat - heat.mean()) / np.ptp(heat)
        columns.append(off)
        if len(heat) >= PERIODS_FOR_CURVATURE:
            columns.append(off**2)
    return np.stack(columns, axis=1)


def course_of(change: FleetChange) -> Array:
    """A change over the periods of its series (p,): 0 before, 1 at the end."""
    first = change.series.periods.index(change.since)
    every = _shapes(len(change.series.periods))
    return next(values for shape, at, values in every if (shape, at) == (change.shape, first))


def _shapes(count: int) -> Iterator[tuple[str, int, Array]]:
    """Changes over the periods, 0 before and 1 at the end: shape, number of the first period, values (p,)."""
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
            continue  # temperature says the same
        tried += 1
        slope = float(x @ y) / size
        left = y - x * slope
        scatter = (prior * variance + float(left @ left)) / (prior + freedom)
        if scatter <= 0.0:
            continue
        p = 2.0 * float(student.sf(abs(slope) * math.sqrt(size / scatter), prior + freedom))
        if p < p_best:
            best, p_best = (shape, first, values, slope), p
    shape, first, values, slope = best
    rest = (series.values - slope * values) * fit.root
    at_rest = _always(series)
    base = np.linalg.lstsq(at_rest * fit.root[:, None], rest, rcond=None)[0]
    before = float(np.mean(at_rest @ base))
    return FleetChange(series, shape, series.periods[first], slope, before, min(1.0, p_best * max(tried, 1)))
