"""The rows of a design: samples of a log, converted for fitting and comparing models.

Target and columns of a design use the same rows.  A row is a sample of the log, or a weighted mean of
samples; then both sides of the balance are averaged with the same weights, and the average removes only noise
and quantisation above its band.  `sampling` makes the rows.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline
from scipy.sparse import csr_array, vstack

from eccentric.core import InputError
from eccentric.signals import limits
from eccentric.signals.filters import motion_of, places_of, rows_of_each, stretches
from eccentric.signals.measured import Channels

if TYPE_CHECKING:
    from eccentric.signals.table import Table

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]
LATER = "current_later"
"""Channel of a table: the current, if it was sampled one standard error later in its row."""
_OF_EACH = ("t", "run", "block", "train", "score", "weights")
"""Fields of `Rows` with an entry for each row."""


class Filtered(NamedTuple):
    """A part of a balance that comes from the angle below the low pass: a factor on a signal (n,).

    factor: a number, or one for each run (n,); angle: as logged (n,), of which the signal is the second rate.
    """

    factor: Array | float
    signal: Array
    angle: Array | None = None

    @property
    def value(self) -> Array:
        """The part itself (n,)."""
        return self.factor * self.signal


@dataclass(frozen=True)
class Rows:
    """m rows made of n samples.

    Attributes:
        t: time [s] of the middle of each row (m,).
        run: number of the run (m,).
        block: (m,); rows of one number are not independent of each other.
        train, score: masks (m,), rows to fit on and rows held out; a row can be neither.
        weights: (m,), weight of a row in a sum of squares.
        description: what a row is, in words.
        operator: sparse weights (m, n) of the means; None where the rows are the samples.
        rate_operator: sparse weights (m, n) that give the mean second rate of a signal from the signal alone;
            None where the acceleration is averaged like any other signal.
        smooth: a filter over the samples, (n,) or (n, k), applied before the mean.
        as_logged: samples (n,) that it leaves as they are, such as those of a held-out error; None for none.
        independent: rows share neither samples nor disturbances, like means of whole runs.
        remedy: what in the rig file gives more rows, in words; "" for nothing.
    """

    t: Array
    run: Integers
    block: Integers
    train: Mask
    score: Mask
    weights: Array
    description: str
    operator: csr_array | None = None
    rate_operator: csr_array | None = None
    smooth: Callable[[Array], Array] | None = None
    as_logged: Mask | None = None
    independent: bool = False
    remedy: str = ""
    _passed: dict[int, tuple[Array, Array | float]] = field(default_factory=dict, init=False, repr=False)

    def __len__(self) -> int:
        """The number of rows m."""
        return len(self.t)

    @property
    def per_coefficient(self) -> int:
        """Least number of rows per coefficient of a fit."""
        return limits.PER_COEFFICIENT_OF_RUNS if self.independent else limits.PER_COEFFICIENT

    def mean(self, x: Array) -> Array:
        """Samples (n,) or (n, k) converted to rows (m,) or (m, k), in the unit of x."""
        return self.plain_mean(self._smoothed(x))

    def _smoothed(self, x: Array) -> Array:
        if self.smooth is None:
            return x
        passed = self.smooth(x)
        if self.as_logged is not None:
            passed[self.as_logged] = np.asarray(x, float)[self.as_logged]
        return passed

    def plain_mean(self, x: Array) -> Array:
        """The same without `smooth`, for signals that have passed that low pass, such as the acceleration."""
        return np.asarray(x, float) if self.operator is None else self.operator @ x

    def once(self, x: Array, filtered: Sequence[Filtered]) -> Array:
        """The mean of x (n,), from which parts are taken away that have passed `smooth`: they pass it once.

        A balance is filtered as a whole, and what of it comes from the filtered angle would pass twice.
        """
        found = self.mean(x)
        for part in filtered:
            factor = part.factor if np.ndim(part.factor) == 0 else self.plain_mean(np.asarray(part.factor))
            found = found - factor * self._second_pass(part)
        return found

    def _second_pass(self, part: Filtered) -> Array | float:
        """What a second pass takes from a part (m,); kept, since fits repeat."""
        key = id(part.signal)
        if key not in self._passed:
            lost: Array | float = 0.0
            if self.rate_operator is not None and part.angle is not None:
                lost = self.rate_operator @ part.angle - self.mean(part.signal)
            elif self.smooth is not None:
                lost = self.plain_mean(part.signal) - self.mean(part.signal)
            self._passed[key] = part.signal, lost
        return self._passed[key][1]

    def second_rate(self, x: Array) -> Array:
        """The mean second rate of a signal (n,), from the signal alone (m,): of windows by parts."""
        if self.rate_operator is None:
            raise AssertionError("expected rows that are integrated by parts")
        return self.rate_operator @ x

    def inside(self, samples: Mask) -> Mask:
        """Rows (m,) all of whose samples are in the mask (n,)."""
        if self.operator is None:
            return samples
        outside = np.concatenate([[0], np.cumsum(~samples[self.operator.indices])])
        ends = outside[self.operator.indptr]
        return ends[1:] == ends[:-1]

    def noise_gain(self) -> Array:
        """RMS (m,) in each row of white noise with RMS one in the samples, as in a held-out error.

        `smooth` reduces it by the factor of a held-out row, if there is one: it is the same for all of them.
        """
        among = np.flatnonzero(self.score) if np.any(self.score) else np.arange(len(self))
        middle = int(among[len(among) // 2])
        if self.operator is None:
            gain, one = np.ones(len(self)), np.eye(1, len(self), middle)[0]
        else:
            gain = np.sqrt(np.asarray(self.operator.multiply(self.operator).sum(axis=1)).ravel())
            one = self.operator[[middle]].toarray()[0]
        if self.smooth is None or (self.as_logged is not None and self.as_logged[middle]):
            return gain
        # The low pass has no phase: what it makes of a row's weights are the weights of the filtered row.
        return gain * float(np.linalg.norm(self.smooth(one)) / np.linalg.norm(one))

    def used_samples(self) -> Mask:
        """Samples (n,) with a positive weight in any row."""
        if self.operator is None:
            return np.ones(len(self), dtype=bool)
        return np.asarray(self.operator.sum(axis=0)).ravel() > 0.0

    def chosen(self, kept: Integers | Mask) -> Rows:
        """A subset of the rows, in the order of their numbers (or of the mask)."""
        own = {name: getattr(self, name)[kept] for name in _OF_EACH}
        operator, rates = (None if x is None else x[kept] for x in (self.operator, self.rate_operator))
        return dataclasses.replace(self, **own, operator=operator, rate_operator=rates)

    def trained_on(self, rows: Mask) -> Rows:
        """The same rows with others to fit on (m,); all that are not stay as logged, if they are samples."""
        logged = self.as_logged if self.operator is not None or self.smooth is None else ~rows
        return dataclasses.replace(self, train=rows, as_logged=logged)

    def for_part(self, part: str) -> Rows:
        """The same rows, all for training ("train") or all held out ("score")."""
        every, none = np.ones(len(self), dtype=bool), np.zeros(len(self), dtype=bool)
        masks = {"train": (every, none), "score": (none, every)}[part]
        return dataclasses.replace(self, train=masks[0], score=masks[1])


def in_order(parts: Sequence[Rows]) -> Rows:
    """All rows of several sets of means over the same samples, in the order of their first samples."""
    operator = csr_array(vstack([part.operator for part in parts]))
    first_block = np.cumsum([0, *(int(part.block.max(initial=-1)) + 1 for part in parts)])
    joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _OF_EACH}
    joined["block"] = np.concatenate([part.block + k for part, k in zip(parts, first_block, strict=False)])
    every = dataclasses.replace(parts[0], **joined, operator=operator)
    return every.chosen(np.argsort(operator.indices[operator.indptr[:-1]], kind="stable"))


def blocks_of(t: Array, label: Integers, samples: Array) -> Integers:
    """Numbers (m,) of stretches of `BLOCK_S` within each label, for rows at t [s] (m,) in order.

    `samples` (n,) are the times of the log [s]: blocks are counted from the first.
    """
    begin, end = float(np.min(samples)), float(np.max(samples))
    key = label * (int((end - begin) / limits.BLOCK_S) + 2) + ((t - begin) / limits.BLOCK_S).astype(int)
    return np.cumsum(np.diff(key, prepend=key[:1]) != 0)


def require_rows(rows: Rows, part: Literal["train", "score"], least: int, where: str) -> None:
    """Raise InputError if fewer than `least` rows are fitted ("train") or held out; `where` names the log."""
    count = int(np.count_nonzero(rows.train if part == "train" else rows.score))
    if count < least:
        purpose = "to fit" if part == "train" else "to hold out"
        remedy = f": {rows.remedy}" if rows.remedy else ""
        raise InputError(where, f"at least {least} moving {rows.description} {purpose}", f"{count}{remedy}")


# Over which band a held-out error is taken: below the low pass of the angle, or above it.
#
# A model knows the motion below the cut-off only; the drive is compared as it was logged. What is left
# above is sensor noise, or a motion that the low pass has taken from one side of the balance.


@dataclass(frozen=True)
class Band:
    """A held-out RMSE below and above the cut-off [Hz], and the sensors' noise above it, in one unit."""

    cut_hz: float
    below: float
    above: float
    noise: float

    @property
    def filtered(self) -> bool:
        """Whether most of the error lies above the low pass, and is not noise."""
        return self.above > max(self.below, limits.FILTERED * self.noise)

    @property
    def warning(self) -> str:
        """What to do about it; "" where nothing is wrong."""
        if not self.filtered:
            return ""
        return (
            f"most of the held-out error lies above {self.cut_hz:g} Hz, which the model cannot see: motion"
            " that the low-pass filter has removed (a higher low_pass_hz shows it), or ripple of the drive"
            " (average_over averages it out)"
        )


def band_of(residual: Array, moving: Array, rows: Rows, channels: Channels, noise: float) -> Band | None:
    """The parts of a held-out residual; None where rows are averages.

    residual (n,) on all rows, moving (n,), what accelerates the drive; noise: RMS of the white noise of the
    drive in a row; all in the unit of the residual.
    """
    if rows.operator is not None or not np.any(rows.score):
        return None
    held_out = np.flatnonzero(rows.score)
    below = float(np.sqrt(np.mean(channels.smooth_residual(residual, moving)[held_out] ** 2)))
    whole = float(np.sqrt(np.mean(residual[held_out] ** 2)))
    impulse = np.zeros(len(residual))
    impulse[held_out[len(held_out) // 2]] = 1.0
    passed = min(float(np.linalg.norm(channels.smooth(impulse))), 1.0)
    cut = channels.rig.sampling.low_pass_hz
    return Band(
        cut, below, float(np.sqrt(max(whole**2 - below**2, 0.0))), noise * float(np.sqrt(1.0 - passed**2))
    )


# What a row's value stands for: a sample, the mean over the row, or a value that is held until the next.
#
# A row lasts from its time to that of the next one.  The balance is compared at the times of the rows, so
# that a value that stands for the whole row is read half a row too early if it is taken for a sample: at 50
# rows per second and a time constant of 0.3 s, the inertia comes out 3 % wrong.
#
# held   x(t) = c_k for t_k <= t < t_{k+1}             a command, kept until the next one
# mean   c_k  = mean of x over t_k <= t < t_{k+1}      what a drive has averaged over its cycle
#
# At t_k both are the mean of the rows before and after it, less a part of their second difference:
#
# x_k = (c_{k-1} + c_k)/2 - beta (c_{k-2} - c_{k-1} - c_k + c_{k+1})
#
# Of a signal of wave number w per row this leaves cos(w/2) - 2 beta (cos(3w/2) - cos(w/2)), which is 1 -
# w^2 (1/8 - 2 beta) + O(w^4).  A held signal has sin(w/2)/(w/2) = 1 - w^2/24 of its commands: beta = 1/24.
# From means it has the reciprocal, 1 + w^2/24: beta = 1/12.


_CURVATURE = {"held": 1.0 / 24.0, "mean": 1.0 / 12.0}


def at_the_times(x: Array, kind: str, t: Array, segment: Integers) -> Array:
    """Return a signal at the times t [s] (n,) of its rows, from what these stand for (n,).

    Args:
        x: the values of the rows, in any unit.
        kind: "sample", "mean" or "held".
        t: the times of the rows [s] (n,).
        segment: the number of the stretch without gap of each row (n,); none is joined to another.
    """
    if kind == "sample":
        return x
    out = np.array(x, float)
    for rows in rows_of_each(segment):
        if len(rows) > 1:
            before, c, after = np.r_[x[rows[0]], x[rows[:-1]]], x[rows], np.r_[x[rows[1:]], x[rows[-1]]]
            places = places_of(t[rows])
            steps = np.diff(t[rows] if places is None else places.astype(float))
            own, last = np.r_[steps, steps[-1]], np.r_[steps[0], steps]
            if kind == "mean":
                # A mean lies half of its own row away from the time: the shorter row says more of it.
                own, last = last, own
            earlier = np.r_[before[0], before[:-1]]
            out[rows] = (last * before + own * c) / (last + own)
            out[rows] -= _CURVATURE[kind] * (earlier - before - c + after)
    return out


def at_times(table: Table, kinds: Mapping[str, str]) -> Table:
    """The table with each channel at the times of the rows, by what their values stand for."""
    t = table.channels["time"]
    segment = stretches(t, table.run)
    read = {
        name: at_the_times(table.channels[name], kind, t, segment)
        for name, kind in kinds.items()
        if name in table.channels
    }
    return dataclasses.replace(table, channels={**table.channels, **read})


# A coarse log between its rows: the integrands of a window of twelve steps, on a finer grid.
#
# At 40 rows per second a reversal falls between two rows, and the sign of the velocity, summed over rows, is
# off by a fraction of a step; so is a load that follows the angle.  The angle between the rows is that of a
# quintic spline, as in `filters.motion`; a signal that is held from row to row is held there too; other
# signals are interpolated linearly.  Nothing is added to the log: windows cover the same time as before, and
# rows are counted as logged.


def refined(table: Table, kinds: Mapping[str, str]) -> Table:
    """The table, angle unwrapped on the motor side, with more points a row; a stretch ends as it did.

    `kinds` is what a row's value stands for, by channel; one that is not in it is a sample.
    """
    t, held = table.channels["time"], {name for name, kind in kinds.items() if kind == "held"}
    table = at_times(table, {name: kind for name, kind in kinds.items() if name not in held})
    parts: list[dict[str, Array]] = []
    source: list[NDArray[np.int64]] = []
    for rows in rows_of_each(stretches(t, table.run)):
        where = np.arange((len(rows) - 1) * limits.POINTS_PER_ROW + 1) / limits.POINTS_PER_ROW
        fine = np.interp(where, np.arange(len(rows)), t[rows])
        before = rows[np.minimum(where.astype(int), len(rows) - 1)]
        source.append(before)
        part = {"time": fine}
        for name, x in table.channels.items():
            if name == "theta_m" and len(rows) > 5:
                part[name] = np.asarray(make_interp_spline(t[rows], x[rows], k=5)(fine))
            elif name in held:
                one = np.zeros(len(fine), np.int64)
                part[name] = at_the_times(x[before], "held", fine, one)
            elif name != "time":
                part[name] = np.interp(fine, t[rows], x[rows])
        parts.append(part)
    joined = {name: np.concatenate([part[name] for part in parts]) for name in table.channels}
    return table.at(np.concatenate(source), joined)


# Whether a log shows that its drive is held.


def evidence(rows: Rows, target: Array, one: Array, other: Array) -> float:
    """Return by how many standard errors the columns `one` explain a target better than the `other` ones.

    Vuong's statistic for models that do not contain each other (Econometrica 57, 1989), least squares with
    Gaussian residuals, summed over the blocks of the rows, which are not independent within one.

    Args:
        rows: m rows.
        target: what is explained (m,); its noise does not favour either, that of the columns might.
        one: columns (m, k).
        other: others (m, k).
    """
    likelihoods = []
    for columns in (one, other):
        size = np.linalg.norm(columns, axis=0)
        scaled = columns / np.where(size > 0.0, size, 1.0)
        left = target - scaled @ np.linalg.lstsq(scaled, target, rcond=None)[0]
        variance = float(np.mean(left**2))
        if variance == 0.0:
            return math.inf if columns is one else -math.inf
        likelihoods.append(-0.5 * (math.log(variance) + left**2 / variance))
    _, block = np.unique(rows.block, return_inverse=True)
    more = np.bincount(block, likelihoods[0] - likelihoods[1])
    spread = float(np.sqrt(np.sum((more - more.mean()) ** 2)))
    return float(more.sum()) / spread if spread else 0.0


# When in its row a current was sampled, by the circuit of a logged voltage.
#
# The winding makes u = R i + k_e w at every instant, so that i - slope w, with slope = -k_e/R, is the voltage
# over R: between the rows it is held or goes on, as the voltage does.  A current that was sampled later than
# the time of its row is that of the voltage and the speed there.  Taken for a sample at the row's time, it
# makes the inertia wrong by up to k_i k_e h/(2 R), for rows of h.
#
# What tells R from the instant is the part of the current that no acceleration goes with: friction that
# changes its sign with the speed, and standstill.  A log with little of both has a large standard error.


@dataclass(frozen=True)
class SampledCurrent:
    """A current that was sampled `late_s` after the time of its row, with its standard error [s].

    Attributes:
        r: R [V/A].
        slope: -k_e/R [A s/rad].
        held: whether the voltage is held from row to row; else it is a sample at the time of the row.
        levels: the number of the level without a jump of the voltage of each row (n,).
        cut_hz: of the low pass of the angle, infinite where there is none.
    """

    r: float
    slope: float
    late_s: float
    error_s: float
    held: bool
    levels: Integers
    cut_hz: float

    def read(
        self, how: Callable[[Table, Mapping[str, str]], Table], table: Table, kinds: Mapping[str, str]
    ) -> Table:
        """The table as `at_times` or `refined` reads it, with the current at the times of the rows.

        Its channel `LATER` is the current if it was sampled one standard error later.
        """
        kinds = {**kinds, **dict.fromkeys(("current", LATER), "held" if self.held else "sample")}
        moved = {
            "current": self._over_r(table, self.late_s),
            LATER: self._over_r(table, self.late_s + self.error_s),
        }
        out = how(dataclasses.replace(table, channels={**table.channels, **moved}), kinds)
        falls = self.slope * _motion(out, stretches(out.channels["time"], out.run), 0.0, self.cut_hz)[0]
        own = {name: out.channels[name] + falls for name in moved}
        return dataclasses.replace(out, channels={**out.channels, **own})

    def _over_r(self, table: Table, late_s: float) -> Array:
        """The voltage over R (n,): in each row if it is held, else at its time."""
        x = table.channels["current"] - self.slope * _motion(table, self.levels, late_s, self.cut_hz)[0]
        return x - late_s * _rate(table, self.held) / self.r


def sampled_current(
    table: Table, points: Table, held: bool, slow: float, cut_hz: float, row_s: float
) -> SampledCurrent | None:
    """When in its row the current was sampled; None if the circuit does not explain the voltage.

    Args:
        table: with the angle unwrapped on the motor side.
        points: the same, or means of rows that are too short for a speed by the angle.
        held: whether the voltage is held from row to row.
        slow: speed [rad/s] below which its sign says nothing.
        cut_hz: of the low pass of the angle, infinite where there is none.
        row_s: how long a row of the log lasts [s].
    """
    t, u, x = (points.channels[name] for name in ("time", "voltage", "current"))
    levels, usable = _levels(points, held), points.use & ~points.motor_off
    rows = np.arange(1, len(t) - 2)
    rows = rows[(levels[rows - 1] == levels[rows + 2]) & usable[rows]]
    if len(rows) < limits.LEAST_WINDOWS:
        return None
    rate, one = _rate(points, held), np.ones(len(t))
    turns = _motion(points, levels, 0.0, math.inf)[0]
    way = np.where(np.abs(turns) > slow, np.sign(turns), 0.0)
    beside = [u[rows - 1], u[rows + 2], x[rows - 1], x[rows + 1]]
    # Instruments (Wooldridge, Econometric Analysis, 5): the noise of a row is in none of its neighbours.
    basis = np.linalg.qr(np.column_stack([one[rows], way[rows], *beside]))[0]

    def solved(late_s: float, k_e: float, unknowns: int) -> tuple[Array, Array, Array]:
        """R, k_e, an offset, and k_e times what the guess of the instant lacks; residual and weights."""
        w, a = _motion(points, levels, late_s, math.inf)
        design = np.column_stack([x, w, one, a - rate / k_e])[rows, :unknowns]
        target = (u + rate * late_s)[rows]
        weights = np.asarray(np.linalg.pinv(basis @ (basis.T @ design)), float)
        return weights @ target, target - design @ (weights @ target), weights

    late_s = 0.5 * row_s
    k_e = float(solved(late_s, math.inf, 3)[0][1])  # of the middle of the row
    if k_e <= 0.0:
        return None
    found, left, weights = solved(late_s, k_e, 4)
    for _ in range(limits.GUESSES):
        explained = np.var(left) <= (1.0 - limits.CIRCUIT_EXPLAINED) * np.var(u[rows])
        if not (explained and found[0] > 0.0 and found[1] > 0.0):
            return None
        late_s += float(found[3] / found[1])
        found, left, weights = solved(late_s, float(found[1]), 4)
    block = np.unique(blocks_of(t[rows], stretches(t, points.run)[rows], t), return_inverse=True)[1]
    error_s = float(np.linalg.norm(np.bincount(block, weights[3] * left)) / found[1])
    if error_s > limits.ANYWHERE * row_s:
        # It may be anywhere in the row: R and k_e are those with the middle.
        late_s, error_s = 0.5 * row_s, limits.ANYWHERE * row_s
        found, _, _ = solved(late_s, float(found[1]), 3)
    r, k_e = (float(x) for x in found[:2])
    return SampledCurrent(r, -k_e / r, late_s, error_s, held, _levels(table, held), cut_hz)


def _rate(table: Table, held: bool) -> Array:
    """The rate of the voltage within each row [V/s] (n,): none if it is held."""
    t = table.channels["time"]
    if held:
        return np.zeros_like(t)
    u = table.channels["voltage"]
    same = np.diff(stretches(t, table.run)) == 0
    return np.append(np.where(same, np.diff(u) / np.diff(t), 0.0), 0.0)


def _levels(table: Table, held: bool) -> Integers:
    """The number of the stretch of each row (n,), or of the level of a held voltage without a jump."""
    segment = stretches(table.channels["time"], table.run)
    same, sizes = np.diff(segment) == 0, np.abs(np.diff(table.channels["voltage"]))
    jumps = ~same | (held & (sizes > limits.JUMP * np.median(sizes[same])))
    return np.cumsum(np.r_[False, jumps])


def _motion(table: Table, levels: Integers, late_s: float, cut_hz: float) -> Array:
    """Speed [rad/s] and acceleration [rad/s^2] of the motor (2, n), so long after each time.

    Without a low pass, by splines through the angle of each level (n,) and the row after it: at a jump the
    acceleration is new.
    """
    t, theta = table.channels["time"], table.channels["theta_m"]
    segment = stretches(t, table.run)
    _, w, a = np.nan_to_num(motion_of(t, theta, segment, cut_hz)[0])
    found = np.array([w + late_s * a, a])
    for rows in rows_of_each(levels) if math.isinf(cut_hz) else ():
        more = rows[-1] + 1
        through = [*rows, more] if more < len(t) and segment[more] == segment[rows[-1]] else rows
        if len(through) > 2:
            spline = make_interp_spline(t[through], theta[through], k=min(5, (len(through) - 1) // 2 * 2 - 1))
            found[:, rows] = [spline(t[rows] + late_s, nu=order) for order in (1, 2)]
    return found
