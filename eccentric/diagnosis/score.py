"""Held-out errors of the three models, before and after, and the confidence in the difference."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter

from eccentric.diagnosis import limits
from eccentric.diagnosis.search import unexplained
from eccentric.effects import Effect
from eccentric.identification import FitData, Refit, improvement, improvement_over_runs, refit, rms
from eccentric.model import Model
from eccentric.signals import rows_of_each

Array = np.ndarray


@dataclass(frozen=True)
class OverRuns:
    """Every run left out of the fit once and predicted; effects and their shapes stay fixed.

    rmse: model -> RMSE over all runs, as in `Score.rmse`; gains: "paper" over linear, "extended" over paper
    -> percent, 95 % interval by drawing whole runs, and how many of the `runs` improve; below: percent and
    interval of "extended" below the low pass, None as in `Score.below`.
    """

    rmse: Mapping[str, float]
    gains: Mapping[str, tuple[float, tuple[float, float], int]]
    runs: int
    below: tuple[float, tuple[float, float]] | None = None


@dataclass(frozen=True)
class BelowLowPass:
    """The held-out error below the low pass of the angle: RMSE of the paper's and the extended model.

    `percent` and `interval` are the gain. Row by row, a model of a ripple above the cut-off only adds error:
    the acceleration that it causes is not in the motion any more.
    """

    cut_hz: float
    before: float
    after: float
    percent: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class Score:
    """What the held-out part says."""

    # balance -> model -> held-out RMSE [N m, or the unit of the drive]
    rmse: Mapping[str, Mapping[str, float]]
    # of the mechanical balance in the unit of the drive while the motor is on, if the torque is not
    # measured
    per_drive: Mapping[str, float]
    free: Mapping[str, float]  # held-out RMSE [N m] while the motor is off
    balance: str  # that `percent` and `interval` are of
    percent: float
    interval: tuple[float, float]
    over_runs: OverRuns | None
    below: BelowLowPass | None = None  # None where rows are averages or nothing was adopted

    @property
    def confirms(self) -> bool:
        """Whether the extended model predicts better held out, and run by run.

        It may do so clearly below the low pass instead, since row by row a model of faster ripple adds error,
        and must not be clearly worse there.
        """
        over = self.over_runs
        if over is not None:
            best = max(over.gains["extended"][1][0], -math.inf if over.below is None else over.below[1][0])
            if best <= 0.0:
                return False
        if self.below is not None and self.below.interval[1] < 0.0:
            return False
        return self.percent > 0.0 or self.only_below

    @property
    def only_below(self) -> bool:
        """Whether the gain is clear below the low pass, and not row by row."""
        return only_below(self.interval, self.below)


def only_below(interval: tuple[float, float], below: BelowLowPass | None) -> bool:
    """Whether a gain is clear below the low pass, and row by row, with this `interval`, it is not."""
    return below is not None and interval[0] <= 0.0 < below.interval[0]


def score(linear: Refit, paper: Refit, extended: Refit, balance: str, over_runs: OverRuns | None) -> Score:
    """Open the held-out part.

    Models that identify different scales are compared at the scale of the extended one: their errors are
    first in volts (or amperes).
    """
    models = {"linear": linear, "paper": paper, "extended": extended}
    rows, off = paper.data.rows, paper.data.off
    rmse: dict[str, dict[str, float]] = {
        "mechanical": {n: rms(m.residual_like(extended)[rows.score]) for n, m in models.items()}
    }
    if "electrical" in paper.residuals:
        rmse["electrical"] = {n: m.held_out("electrical") for n, m in models.items() if n != "linear"}
    free: dict[str, float] = {}
    if np.any(off & rows.score):
        free = {n: rms(m.residuals["mechanical"][off & rows.score]) for n, m in models.items()}
    before, after = (m.residual_like(extended, balance)[rows.score] for m in (paper, extended))
    percent, interval = improvement(before, after) if extended is not paper else (0.0, (0.0, 0.0))
    scaled = paper.scale is not None
    # A motor that is off has no voltage or current to be predicted: these rows are in `free`.
    on = rows.score & ~off
    per_drive = {n: rms(m.residuals["mechanical"][on]) * (m.scale or 1.0) for n, m in models.items()}
    per_drive = per_drive if scaled and np.any(on) else {}
    return Score(
        rmse, per_drive, free, balance, percent, interval, over_runs, below_low_pass(paper, extended, balance)
    )


def below_low_pass(paper: Refit, extended: Refit, balance: str) -> BelowLowPass | None:
    """The gain below the low pass; None where rows are averages or nothing was adopted."""
    rows, rig = paper.data.rows, paper.data.drive.channels.rig
    if rows.operator is not None or extended is paper:
        return None
    before, after = (m.residual_like(extended, balance, smooth=True)[rows.score] for m in (paper, extended))
    return BelowLowPass(rig.sampling.low_pass_hz, rms(before), rms(after), *improvement(before, after))


def leave_runs_out(base: Model, extended: Refit, data: FitData, bounds: bool = True) -> OverRuns | None:
    """Predict each run from all others; None with fewer than five runs, or if two balances are fitted.

    `bounds` are those of the models without effects.
    """
    rows = data.rows
    used = rows.train | rows.score
    runs = np.unique(rows.run[used])
    if len(runs) < limits.FEWEST_RUNS or data.drive.measured_twice:
        return None
    shapes = tuple(
        (e, {s.quantity.name: own[s.quantity.name] for s in e.shapes}) for e, own in extended.effects
    )
    models: dict[str, tuple[tuple[tuple[Effect, dict[str, float]], ...], dict[str, bool]]]
    models = {"linear": ((), {"bounds": bounds, "linear": True}), "paper": ((), {"bounds": bounds})}
    if shapes:
        models["extended"] = (shapes, {})
    squares, smooth = ({name: np.zeros(len(runs)) for name in models} for _ in range(2))
    for k, run in enumerate(runs):
        own = used & (rows.run == run)
        for name, (effects, options) in models.items():
            found = refit(base, effects, data, without=int(run), **options)
            squares[name][k] = float(np.sum(found.residual_like(extended)[own] ** 2))
            smooth[name][k] = float(np.sum(found.residual_like(extended, smooth=True)[own] ** 2))
    gains = {
        after: (
            *improvement_over_runs(squares[before], squares[after]),
            int(np.count_nonzero(squares[after] < squares[before])),
        )
        for before, after in (("linear", "paper"), ("paper", "extended"))
        if after in squares
    }
    count = int(np.count_nonzero(used))
    rmse = {n: float(np.sqrt(s.sum() / count)) for n, s in squares.items()}
    below = None
    if shapes and rows.operator is None:
        below = improvement_over_runs(smooth["paper"], smooth["extended"])
    return OverRuns(rmse, gains, len(runs), below)


# Periods of the torque while the motor turns one way: its spectrum over the angle, run by run.
#
# A harmonic of the motor or the link has one order per turn at every speed; something periodic in time has
# one frequency, and its order changes from speed to speed.  Each stretch of several turns has its own
# spectrum (Lomb-Scargle, over the angle instead of time), so that no common zero of the angle is needed, as
# it is for an effect: an angle integrated from the speed of each run is enough.
TURN = 2.0 * np.pi
_GRID = np.arange(limits.LOWEST_ORDER, limits.HIGHEST_ORDER, limits.ORDER_STEP)
"""Orders of the spectra."""


@dataclass(frozen=True)
class Order:
    """A periodic part of the torque."""

    per_turn: float  # cycles per turn of the motor
    amplitude: float  # RMS over the stretches of its amplitude [N m]
    share: float  # of the variance within the stretches, on average
    seen: int  # stretches where it is a peak, `ABOVE` times the median of their own spectrum
    stretches: int


def orders_of(data: FitData, target: Array) -> tuple[Order, ...]:
    """The orders of the mechanical target (samples,) [N m], the largest share first.

    Empty with fewer than `LEAST_STRETCHES` stretches of usable rows in one direction of `LEAST_TURNS` turns.
    """
    channels = data.drive.channels
    # What turns with a carriage is its screw, if the rig knows the pitch.
    axis, known = channels.rig.axis, channels.rig.known
    if not axis.wraps and "pitch" not in known:
        return ()
    turning = channels.motion.theta_m * (1.0 if axis.wraps else known["mu"])
    spectra, variances = [], []
    # A stretch has one direction, and no row in between that is not used.
    forward = channels.motion.omega_m > 0.0
    key = np.where(channels.selection.usable, 2 * channels.time.segment + forward, -1)
    for rows in rows_of_each(key):
        if key[rows[0]] < 0:
            continue
        angle, y = turning[rows], target[rows]
        turns = abs(angle[-1] - angle[0]) / TURN
        if turns < limits.LEAST_TURNS or len(rows) < limits.ROWS_PER_CYCLE * limits.HIGHEST_ORDER * turns:
            continue
        # What is smooth over the stretch or follows the speed is not a ripple.
        t = np.linspace(-1.0, 1.0, len(rows))
        slow = np.column_stack([np.ones_like(t), t, t**2, channels.motion.omega_m[rows]])
        rest = unexplained(slow, y)
        if np.std(rest) <= 1e-12 * max(np.std(y), 1e-300):
            continue
        spectra.append(_spectrum(angle, rest))
        variances.append(float(np.var(rest)))
    if len(spectra) < limits.LEAST_STRETCHES:
        return ()
    every = np.array(spectra)
    mean = every.mean(axis=0)
    around = median_filter(mean, limits.AROUND, mode="nearest")
    local = median_filter(every, (1, limits.AROUND), mode="nearest")
    found = []
    least = np.maximum(limits.LEAST_SHARE, limits.ABOVE * around)
    for k in peaks(mean, least, limits.ALONE):
        near = every[:, max(k - limits.NEIGHBOURS, 0) : k + limits.NEIGHBOURS + 1].max(axis=1)
        share = float(near.mean())
        # Leakage from one frequency in time is not a peak in the neighbouring orders.
        peak = near >= every[:, max(k - limits.ALONE, 0) : k + limits.ALONE + 1].max(axis=1)
        seen = int(np.count_nonzero(peak & (near > limits.ABOVE * local[:, k])))
        amplitude = float(np.sqrt(np.mean(2.0 * near * np.array(variances))))
        # The peak lies between the orders: on a parabola through its neighbours.
        left, top, right = mean[k - 1 : k + 2]
        centre = _GRID[k] + 0.5 * (left - right) / (left - 2.0 * top + right) * (_GRID[1] - _GRID[0])
        found.append(Order(float(centre), amplitude, share, seen, len(every)))
    return tuple(sorted((o for o in found if 2 * o.seen > o.stretches), key=lambda o: -o.share))


def peaks(mean: Array, least: Array, apart: int) -> list[int]:
    """Places of peaks of at least that height, of two nearer than `apart` the higher, in rising order.

    They are those of SciPy's `find_peaks`; importing `scipy.signal` takes longer than all else here.
    """
    inner = mean[1:-1]
    tops = 1 + np.flatnonzero((inner > mean[:-2]) & (inner > mean[2:]) & (inner >= least[1:-1]))
    kept: list[int] = []
    for k in tops[np.argsort(-mean[tops], kind="stable")].tolist():
        if all(abs(k - other) >= apart for other in kept):
            kept.append(k)
    return sorted(kept)


def _spectrum(angle: Array, y: Array) -> Array:
    """The share of y (n,) that cosine and sine of each order of `_GRID` over the angle [rad] (n,) explain.

    That is the normalised Lomb-Scargle periodogram. On an even grid e^(i nu theta) is a product of two
    factors, one for every 20th order and one for those between, so that sums over rows are matrix products.
    """
    fine = 20
    coarse = _GRID[::fine]
    one = np.exp(1j * np.outer(angle, coarse))
    other = np.exp(1j * np.outer(angle, limits.ORDER_STEP * np.arange(fine)))
    along = ((one.T * y) @ other).ravel()[: len(_GRID)]
    twice = ((one.T**2) @ other**2).ravel()[: len(_GRID)]
    # Sums of y cos, y sin, cos^2, sin^2 and sin cos: the normal equations of each order.
    yc, ys = np.real(along), np.imag(along)
    cc, ss, cs = (0.5 * x for x in (len(y) + np.real(twice), len(y) - np.real(twice), np.imag(twice)))
    determinant, power = cc * ss - cs**2, yc**2 * ss - 2.0 * yc * ys * cs + ys**2 * cc
    # On an even grid of angles sine and cosine of an order may be one column, or nothing.
    alike = determinant < limits.ALIKE * len(y) ** 2
    power = np.where(alike, (yc**2 + ys**2) / len(y), power / np.where(alike, 1.0, determinant))
    return power / (y @ y)
