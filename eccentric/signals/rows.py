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
from eccentric.signals.filters import places_of, rows_of_each, stretches
from eccentric.signals.measured import Channels

if TYPE_CHECKING:
    from eccentric.signals.table import Table

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]
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


# A current behind a voltage that is held.
#
# The winding makes u = R i + k_e w.  A voltage that is held from row to row makes a current that jumps with
# it and falls with the speed in between: i - slope w, with slope = -k_e/R, is what is held.  Samples alone,
# and a hold of the current, both shift what lies between the jumps by half a row, which the inertia takes up:
# J +- k_i k_e h/(2 R) for rows of h, with an interval a hundred times narrower.


@dataclass(frozen=True)
class BehindHold:
    """A drive signal of which x(t) - slope w(t) is held from row to row.

    Attributes:
        by: its channel.
        slope: -k_e/R, in the unit of the channel per rad/s.
        late: when in its row a value was sampled: 0 at its time, 1 at that of the next row.
        levels: the number of the level without a jump of each row (n,).
    """

    by: str
    slope: float
    late: float
    levels: Integers

    def read(
        self, how: Callable[[Table, Mapping[str, str]], Table], table: Table, kinds: Mapping[str, str]
    ) -> Table:
        """The table as `at_times` or `refined` reads it, with this signal as it is between the jumps."""
        x = table.channels[self.by] - self.slope * _speeds(table, self.levels, self.late)
        held = dataclasses.replace(table, channels={**table.channels, self.by: x})
        out = how(held, {**kinds, self.by: "held"})
        x = out.channels[self.by] + self.slope * _speeds(out, stretches(out.channels["time"], out.run))
        return dataclasses.replace(out, channels={**out.channels, self.by: x})


def behind_hold(table: Table, by: str) -> BehindHold | None:
    """How a current behind a held voltage falls with the speed, and when in its row it was sampled.

    None if the circuit does not show it. Without a voltage nothing does: a current that falls with the speed
    between its jumps may be that of a speed controller, which is held from row to row.

    Args:
        table: with the angle unwrapped on the motor side.
        by: the channel.
    """
    x, segment = table.channels[by], stretches(table.channels["time"], table.run)
    same = np.diff(segment) == 0
    held = table.channels["voltage"]
    sizes = np.abs(np.diff(held))
    jumps = ~same | (sizes > limits.JUMP * np.median(sizes[same]))
    levels = np.cumsum(np.r_[False, jumps])
    w = _speeds(table, levels)
    rows = np.flatnonzero(~jumps[1:-1] & ~jumps[:-2] & ~jumps[2:]) + 1
    if len(rows) < limits.LEAST_WINDOWS:
        return None
    faster = w[rows + 1] - w[rows]
    # u = R i + k_e (w + more dw), dw the change over the row, and w by the last guess of late, which more
    # makes better. Noise of one row's angle is in w and dw, that of the voltage in u: voltage and current of
    # the rows beside it, the instruments, have neither.
    one, late, slope, error = np.ones(len(rows)), 0.5, 0.0, math.inf
    beside = [signal[rows + k] for signal in (held, x) for k in (-1, 1)]
    basis = np.linalg.qr(np.column_stack([one, x[rows], *beside]))[0]
    for _ in range(limits.GUESSES):
        design = np.column_stack([x[rows], _speeds(table, levels, late)[rows], faster, one])
        projected = basis @ (basis.T @ design)
        r, k_e, more, _ = c = np.linalg.lstsq(projected, held[rows], rcond=None)[0]
        left = float(np.var(held[rows] - design @ c))
        explained = 1.0 - left / max(float(np.var(held[rows])), 1e-300)
        if r <= 0.0 or k_e <= 0.0 or explained < limits.CIRCUIT_EXPLAINED:
            return None
        late, slope = min(max(late + float(more / k_e), 0.0), 1.0), float(-k_e / r)
        error = math.sqrt(left * float(np.linalg.pinv(projected.T @ projected)[2, 2])) / float(k_e)
    # At the start, the middle or the end of its row; the middle is that of a hold of the current itself.
    late = round(2.0 * late) / 2.0
    unknown = late == 0.5 or error > limits.SAMPLED_WHEN
    return None if unknown else BehindHold(by, slope, late, levels)


def _speeds(table: Table, levels: Integers, late: float = 0.0) -> Array:
    """Speed of the motor [rad/s] (n,), so many parts of a row after each time.

    By splines through the angle of each level (n,) and the row after it: at a jump the acceleration is new.
    """
    t, theta = table.channels["time"], table.channels["theta_m"]
    segment = stretches(t, table.run)
    w = np.zeros_like(t)
    for rows in rows_of_each(levels):
        more = rows[-1] + 1
        through = [*rows, more] if more < len(t) and segment[more] == segment[rows[-1]] else rows
        if len(through) > 2:
            spline = make_interp_spline(t[through], theta[through], k=min(5, (len(through) - 1) // 2 * 2 - 1))
            w[rows] = spline.derivative()(t[rows] + late * np.diff(t[rows], append=t[through[-1]]))
    return w
