"""Where the estimator starts: the model's coefficients, and how far friction may move from them.

A fit tells how well its log determines the coefficients; in the field friction itself changes. The covariance
is the sum of both: that of the fit, where there is one, and a change of each coefficient by a share of its
size. Without a fit the second alone remains, and the noise is a share of the friction.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, nnls
from scipy.special import chdtri, ndtr, ndtri

from eccentric.core import InputError
from eccentric.emission.hot import evaluated, load_module, turn_of_link
from eccentric.model import LINEAR, TURNING, AxisKind, Column, Model, regressor, spoken
from eccentric.model import vocabulary as v

CHANGE = 0.3
"""Standard deviation of a coefficient's change in the field, as a share of its size."""
_LEAST_SHARE = 0.1
"""The least size of a coefficient: with it this share of the mean friction follows from its column."""
_NOISE = 0.05
"""Without a fit: noise as a share of the mean friction."""
_MOVING, _SPEED = {TURNING: 1.0, LINEAR: 0.005}, {TURNING: 20.0, LINEAR: 0.1}
"""Without a fit: the least speed, and a medium speed [rad/s, m/s]; with a screw of 30 mm both are alike."""
_LEAST_SPEED = {TURNING: 1e-3, LINEAR: 1e-6}
"""Least speed at which a row is used whatever the fit says [rad/s, m/s]: no encoder resolves less."""
_NONE = 1e-12
"""The size of a column that is 0."""
_ANGLES = 48
"""States over a turn of the link."""
_FARTHEST = 20.0
"""A coefficient stays within so many standard deviations of its start."""
_SPEEDS = 24
"""Identified speeds of each direction."""
_RANGE = {TURNING: (1.0, 40.0), LINEAR: (0.005, 0.2)}
"""Speeds where a fit states none [rad/s, m/s]."""
_LITTLE = 0.02
"""A friction below this share of its mean is left out: a ratio of two noughts says nothing."""
_DIRECTIONS = 200
_INSIDE = 1e-2
"""A row this close to a sum of others, relative to the largest of each column, counts as that sum."""


@dataclass(frozen=True)
class Prior:
    """Where the estimator starts; arrays have an entry for each of the n columns of the regressor."""

    columns: tuple[Column, ...]  # of the regressor, in the words of the axis
    values: np.ndarray  # of the coefficients, in SI units
    deviations: np.ndarray  # their standard deviations
    correlation: np.ndarray  # of their errors (n, n)
    lowest: np.ndarray  # their lower bounds
    highest: np.ndarray  # their upper bounds
    noise: float  # standard deviation of the measured friction torque [N m, or N]
    moving: float  # least speed at which a row is used [rad/s, or m/s]
    friction: float  # mean size of the friction at a medium speed [N m, or N]
    # of the regressor over the friction, at the identified states that bound all others (m, n)
    rows: np.ndarray
    origin: str  # where all this comes from, in words

    def factors(self) -> tuple[np.ndarray, np.ndarray]:
        """U (n, n), unit upper triangular, and d (n,): U diag(d) U' is the correlation."""
        n = len(self.values)
        flipped = np.linalg.cholesky(self.correlation[::-1, ::-1])[::-1, ::-1]
        roots = np.diag(flipped)
        return np.triu(flipped / roots, 1) + np.eye(n), roots**2


def prior_of(model: Model, fit: Mapping[str, Any] | None = None) -> Prior:
    """The prior of a model with its defaults; `fit` is the content of the fit.json that they come from.

    Raises:
        InputError: the model has no mechanical residual in newton metres and amperes, no inertia, no
            friction, or a coefficient whose size nothing tells.
    """
    _require(model)
    fit = fit or {}
    axis = model.axis
    columns = regressor(spoken(model))
    moving = max(_number(fit, axis.named("moving_threshold_rad_s")) or _MOVING[axis], _LEAST_SPEED[axis])
    values, bases, friction = _seen(model, _speed(fit, axis), moving)
    if not friction > 0.0:
        raise InputError(
            f"model {model.name}",
            "a friction coefficient above 0",
            "none: check the sign of the current and the rig",
            why="for an estimator to start from",
        )
    size = np.maximum(np.abs(values), _LEAST_SHARE * friction / bases)
    for j in _not_yet(model, bases):
        if values[j] == 0.0:
            raise InputError(
                f"model {model.name}: an estimator of its friction: expected {columns[j].name} other than 0,"
                " since nothing else tells its size: fit the model first"
            )
        size[j] = abs(values[j])
    covariance = np.diag((CHANGE * size) ** 2) + covariance_of_fit(columns, fit)
    deviations = np.sqrt(np.diag(covariance))
    lows = [-math.inf if c.bounds[0] is None else c.bounds[0] for c in columns]
    highs = [math.inf if c.bounds[1] is None else c.bounds[1] for c in columns]
    noise = _number(fit, axis.named("rmse_holdout_Nm"), "paper")
    from_fit = "the fit and " if fit.get("coefficients") else ""
    return Prior(
        columns=columns,
        values=values,
        deviations=deviations,
        correlation=covariance / np.outer(deviations, deviations),
        lowest=np.maximum(lows, values - _FARTHEST * deviations),
        highest=np.minimum(highs, values + _FARTHEST * deviations),
        noise=noise or _NOISE * friction,
        moving=moving,
        friction=friction,
        rows=extreme(*identified_states(model, fit)),
        origin=(
            f"standard deviations from {from_fit}a {CHANGE:.0%} change of each coefficient; "
            f"noise: {'held-out error of the fit' if noise else f'{_NOISE:.0%} of the mean friction'}"
        ),
    )


def _require(model: Model) -> None:
    where = f"model {model.name}: an estimator of its friction"
    if not model.current_known or model.back_emf_in_friction or model.torque_unit != "N m":
        said = model.axis.text("expected a fit with the current in amperes and torques in N m")
        raise InputError(f"{where}: {said}")
    missing = [q.name for q in spoken(model).parameters if q.default is None]
    if missing:
        since = model.axis.text("since it learns from what inertia leaves of the torque")
        raise InputError(
            f"{where}: expected a value of {' and of '.join(missing)}, {since}: give them with --parameters"
        )


def _number(fit: Mapping[str, Any], *keys: str) -> float:
    """A positive number of a fit.json, 0 if it is not there."""
    found: Any = fit
    for key in keys:
        found = found.get(key) if isinstance(found, Mapping) else None
    usable = isinstance(found, int | float) and not isinstance(found, bool) and 0 < found < math.inf
    return float(found) if usable else 0.0


def _speed(fit: Mapping[str, Any], axis: AxisKind) -> float:
    """A medium speed: half the fastest of the fit [rad/s, or m/s]."""
    ranges = fit.get("ranges")
    found = ranges.get(axis.named("speed_m_rad_s")) if isinstance(ranges, Mapping) else None
    fastest = found[1] if isinstance(found, list | tuple) and len(found) == 2 else None
    return fastest / 2 if isinstance(fastest, int | float) and 0 < fastest < math.inf else _SPEED[axis]


def _not_yet(model: Model, bases: np.ndarray) -> list[int]:
    """Columns that are 0 at the start, by the time or a hidden state: no motion tells their size."""
    later = {v.t.symbol, *(state.quantity.symbol for state in model.states)}
    columns = enumerate(regressor(model))
    return [j for j, one in columns if bases[j] <= _NONE and one.basis.free_symbols & later]


def _seen(model: Model, speed: float, slow: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Coefficients, size of their columns (n,), mean size of the friction, in both directions over a turn.

    Friction is that at a medium speed. The size of a column is its mean there or at a slow speed, the larger:
    what Stribeck friction hangs on is nothing at a medium one.
    """
    values = np.asarray(load_module(model).friction_coefficients(), float)
    medium, _ = regressor_rows(model, [-speed / 2, speed / 2, -speed, speed])
    slowest, _ = regressor_rows(model, [-slow, slow])
    sizes = (np.mean(np.abs(x), 0) for x in (medium, slowest))
    return values, np.maximum(np.maximum(*sizes), _NONE), float(np.mean(np.abs(medium @ values)))


def regressor_rows(model: Model, speeds: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Regressor (m, n) over a turn of the link at each speed and 25 degC, with their speeds (m,)."""
    theta_m, omega_m = (x.ravel() for x in np.meshgrid(turn_of_link(model, _ANGLES), speeds))
    states = {v.theta_m: theta_m, v.omega_m: omega_m, v.temperature: np.full_like(theta_m, 25.0)}
    return evaluated(load_module(model).regressor, model.axis, states), omega_m


def identified_states(model: Model, fit: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the regressor (m, n) with a friction above 0, and the coefficients (n,).

    They are those of both directions, with the sign of the motion, over a turn and the speeds of the fit.
    None where there is no friction.
    """
    axis, ranges = model.axis, fit.get("ranges")
    given = ranges.get(axis.named("speed_m_rad_s")) if isinstance(ranges, Mapping) else None
    slowest, fastest = given if isinstance(given, list | tuple) and len(given) == 2 else _RANGE[axis]
    speed = np.geomspace(max(slowest, 0.01 * fastest), fastest, _SPEEDS)
    rows, omega_m = regressor_rows(model, np.concatenate((-speed, speed)))
    rows, values = rows * np.sign(omega_m)[:, None], np.asarray(load_module(model).friction_coefficients())
    friction = rows @ values
    return rows[friction > _LITTLE * np.mean(np.abs(friction))], values


def extreme(rows: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Rows over their friction, without those that are sums of others with weights of 0 or above."""
    rows = rows / (rows @ values)[:, None]
    size = np.abs(rows).max(0)
    scaled = rows / (size + (size == 0.0))

    def between(k: int, others: list[int]) -> bool:
        return bool(others) and nnls(scaled[others].T, scaled[k])[1] <= _INSIDE

    # First the farthest in many directions: of the others most are between these.
    directions = np.random.default_rng(0).standard_normal((rows.shape[1], _DIRECTIONS))
    farthest = np.argmax(scaled @ directions, axis=0)
    each = np.unique(np.round(scaled, 9), axis=0, return_index=True)[1]
    found: list[int] = []
    for k in dict.fromkeys([*farthest.tolist(), *each.tolist()]):
        if not between(k, found):
            found.append(k)
    for k in list(found):
        if between(k, others := [x for x in found if x != k]):
            found = others
    return rows[found]


def covariance_of_fit(columns: tuple[Column, ...], fit: Mapping[str, Any]) -> np.ndarray:
    """The covariance of a fit (n, n), 0 where it has none: for a coefficient at a bound."""
    found = fit.get("coefficients")
    found = found if isinstance(found, Mapping) else {}
    free = {name for name, e in found.items() if isinstance(e, Mapping) and not e.get("bound_active")}
    errors = np.array([_number(found, c.name, "std_error") if c.name in free else 0.0 for c in columns])
    correlation = np.eye(len(columns))
    given = fit.get("correlation")
    names, matrix = (given["names"], given["matrix"]) if isinstance(given, Mapping) else ([], [])
    for row, one in enumerate(columns):
        for column, other in enumerate(columns):
            if one.name in names and other.name in names and row != column:
                value = matrix[names.index(one.name)][names.index(other.name)]
                correlation[row, column] = 0.0 if value is None else value
    return correlation * np.outer(errors, errors)


CONFIDENCE = 0.975
"""How sure a gain is that the friction is there."""


def joint_deviations(rows: int, coefficients: int) -> float:
    """Standard deviations within which the friction is at all rows together, with `CONFIDENCE`.

    The least of two bounds that hold for any covariance: the sum of the probabilities row by row, and the
    ellipsoid of the coefficients (H. Scheffe, The Analysis of Variance, 1959).
    """
    beyond = 1.0 - CONFIDENCE
    return float(min(-ndtri(beyond / rows), math.sqrt(chdtri(coefficients, beyond))))


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
        least, most = LEAST_FALSE_ALARMS, MOST_FALSE_ALARMS
        ranges = (
            ("forgetting", LEAST_FORGETTING, 1 - 1e-6, f"a number from {LEAST_FORGETTING} to 0.999999"),
            ("false_alarms", least, most, f"a number of samples from {least:.0f} to {most:.0e}"),
            ("settle", 0, MOST_SETTLE, f"a number of samples from 0 to {MOST_SETTLE}"),
        )
        for name, low, high, expected in ranges:
            value, kind = getattr(self, name), int if name == "settle" else int | float
            if isinstance(value, bool) or not isinstance(value, kind) or not low <= value <= high:
                raise InputError(name, expected, f"{value!r}")


# The alarm: two cumulative sums of the standardised innovation, one for each sign of a change.
#
# A sum S = max(0, S + z - k) gives an alarm above h (Page, Biometrika 41, 1954). From S = u it takes on
# average L(u) samples, which solve the integral equation
#
# L(u) = 1 + L(0) P(z <= k - u) + integral over 0 < x < h of L(x) p(x + k - u)
#
# (Brook and Evans, Biometrika 59, 1972, as a Markov chain; here by Nystroem's method on Gauss-Legendre
# nodes). h follows from the mean number of samples between false alarms; it is not a typed-in constant.
#
# A delay is Lorden's (Annals of Mathematical Statistics 42, 1971): the mean, at the worst moment that the
# samples before the change can prepare. For a sum that is when it is 0, so that the delay is L(0) after the
# change. Of all tests with the same mean time between false alarms, one sum with k at half the shift has the
# least (Moustakides, Annals of Statistics 14, 1986): no test is below. That least delay grows as Lorden's
# 2 ln(between)/shift^2 for ever rarer false alarms; at finite ones this leaves out a constant: no bound.
_NODES = 200


@dataclass(frozen=True)
class Alarm:
    """The threshold of the alarm, and what is known of it."""

    shift: float  # the change of the innovation that it is made for, in its standard deviations
    reference: float  # k, half the shift: the optimum for it
    threshold: float  # h
    between: float  # mean number of samples between false alarms, of both sums together
    delay: float  # mean number of samples until that change is announced, at the worst moment: from sums of 0
    bound: float  # the least such delay of any test with these false alarms: of one sum, which knows the sign
    lorden: float  # what the bound grows as for ever rarer false alarms, 2 ln(between)/shift^2


def run_length(reference: float, threshold: float, mean: float = 0.0) -> float:
    """Mean number of samples until one sum exceeds the threshold, from 0.

    Args:
        reference: k; threshold: h; mean: that of the innovation, which is normal with standard deviation 1.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    x, w = (nodes + 1) * threshold / 2, weights * threshold / 2
    start = np.concatenate(([0.0], x))
    offset = reference - mean
    kernel = np.exp(-((x[None, :] + offset - start[:, None]) ** 2) / 2) / math.sqrt(2 * math.pi) * w
    system = np.eye(_NODES + 1)
    system[:, 1:] -= kernel
    system[:, 0] -= ndtr(offset - start)
    return float(np.linalg.solve(system, np.ones(_NODES + 1))[0])


def alarm_of(shift: float, false_alarms: float) -> Alarm:
    """The alarm for a change of `shift` standard deviations, with that many samples between false alarms.

    The two sums are never above 0 together for long, and their rates add up (van Dobben de Bruyn 1968).
    """
    reference = shift / 2
    threshold = threshold_of(reference, 2 * false_alarms)
    return Alarm(
        shift=shift,
        reference=reference,
        threshold=threshold,
        between=run_length(reference, threshold) / 2,
        delay=run_length(reference, threshold, shift),
        bound=run_length(reference, threshold_of(reference, false_alarms), shift),
        lorden=2 * math.log(false_alarms) / shift**2,
    )


def threshold_of(reference: float, between: float) -> float:
    """The threshold of one sum with that many samples between false alarms on average."""

    def excess(threshold: float) -> float:
        return math.log(run_length(reference, threshold) / between)

    # A run length grows as exp(2 k h): this is beyond the root, and far from where a solution loses digits.
    highest = (math.log(2 * between) + 4) / (2 * reference)
    return float(brentq(excess, 1e-3, highest, xtol=1e-9))
