"""The data of the figures: residuals of a balance on its rows, and the channels they are drawn over.

An array may hold NaN; if a log has no such signal, the field is None or the channel is not in the list.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

Array = np.ndarray
TURN = 2.0 * np.pi


@dataclass(frozen=True)
class Channel:
    """A signal on the horizontal axis of a residual plot.

    Attributes:
        key: as in `residual_depends_on`: velocity, link_angle, motor_angle, acceleration, gravity_load,
            current, voltage, temperature, time. "velocity" also says which way friction acts.
        label: for an axis, without unit: "motor velocity".
        unit: of the values.
        values: (n,), an angle unwrapped or not.
        period: of an angle that is wrapped (2 pi for one turn); None for anything else.
    """

    key: str
    label: str
    unit: str
    values: Array
    period: float | None = None


@dataclass(frozen=True)
class ResidualRows:
    """The n rows (or windows) that all arrays of a balance share.

    Attributes:
        t: (n,) logged time [s]; restarts with each run.
        run: (n,) number of the run, an index of `run_names`.
        run_names: names of the runs (or logs).
        train: (n,) bool, rows that were fitted.
        held_out: (n,) bool, rows of the held-out error. Rows that are in neither are not drawn.
        channels: the available signals.
        description: what a row is: "rows of the log", "averages over 0.2 s", "whole runs".
    """

    t: Array
    run: Array
    run_names: tuple[str, ...]
    train: Array
    held_out: Array
    channels: tuple[Channel, ...]
    description: str = "rows of the log"

    def channel(self, key: str) -> Channel | None:
        """The channel with this key, None if there is none."""
        return next((channel for channel in self.channels if channel.key == key), None)


@dataclass(frozen=True)
class DriveSignal:
    """What drives the motor, on the rows of a balance.

    Attributes:
        label: "current", "voltage", "torque", without unit.
        unit: of the values.
        values: (n,) as measured, below the low pass where there is one; a model gives `values` - `gain` * its
            residual there.
        gain: units of the drive for one of the balance.
    """

    label: str
    unit: str
    values: Array
    gain: float


@dataclass(frozen=True)
class SmoothResiduals:
    """Residuals (n,) of which held-out rows have passed the low pass too, as fitted ones and the angle have.

    Attributes:
        cut_hz: cut-off frequency of the low pass.
        paper, extended: of the two models; None as in BalanceResiduals.
    """

    cut_hz: float
    paper: Array
    extended: Array | None


@dataclass(frozen=True)
class BalanceResiduals:
    """A balance and how well each model satisfies it.

    Attributes:
        name: "mechanical" or "electrical".
        quantity: name of `measured` for an axis, without unit: "friction".
        unit: of all arrays and errors here: "N m" or "V".
        rows: those of the arrays.
        paper: (n,) residual of the paper's model.
        extended: (n,) residual of the extended model; None if nothing was adopted.
        linear: (n,) residual of Coulomb and viscous friction; None if there is no such comparison.
        measured: (n,) the measured friction, so that a model's prediction is `measured` - its residual; None
            if the balance contains no friction.
        rmse: model ("linear", "paper", "extended") -> held-out RMSE, as in diagnosis.json.
        noise_floor: RMS of the sensors' noise in this balance; None if unknown.
        drive: what the balance is about as the log has it; None for another balance than the mechanical.
        smooth: the residuals below the low pass of the angle; None where rows are averages.
    """

    name: str
    quantity: str
    unit: str
    rows: ResidualRows
    paper: Array
    extended: Array | None
    linear: Array | None
    measured: Array | None
    rmse: Mapping[str, float]
    noise_floor: float | None = None
    drive: DriveSignal | None = None
    smooth: SmoothResiduals | None = None

    @property
    def below(self) -> BalanceResiduals:
        """The same with all rows below the low pass, where there is one."""
        own = self.smooth
        return self if own is None else replace(self, paper=own.paper, extended=own.extended)


# Bins of a channel: the mean of the rows in each, and the quantiles between which most of them lie.


BINS = 60
"""Most bins of a panel; up to this many rows are drawn singly."""
SPREAD = (0.1, 0.9)
"""Quantiles of its rows from which to which the bar of a point extends."""


@dataclass(frozen=True)
class MeanAndSpread:
    """One line (k,): the mean of each point's rows, and the lower and upper end of their spread."""

    low: Array
    middle: Array
    high: Array

    @property
    def swing(self) -> float:
        """The range from the lowest to the highest mean."""
        return float(np.nanmax(self.middle) - np.nanmin(self.middle))


@dataclass(frozen=True)
class Bins:
    """Rows by the bins of a channel; of bins that are not `drawn`, means and quantiles are NaN.

    Attributes:
        x: the channel, on all rows.
        index: rows in the drawn bins, bin by bin; begins: where each of these bins begins in it.
        sizes: rows in each bin.
        drawn: whether a bin has enough rows.
    """

    x: Array
    index: Array
    begins: Array
    sizes: Array
    drawn: Array

    def mean(self, y: Array) -> Array:
        """(bins,) means of the rows."""
        return self._on_all(np.add.reduceat(y[self.index], self.begins) / self.sizes[self.drawn])

    def curve(self, y: Array) -> MeanAndSpread:
        """Mean and spread of the rows; each bin is sorted once for both quantiles."""
        ordered = y[self.index]
        for part in np.split(ordered, self.begins[1:]):
            part.sort()
        low, high = (self._on_all(self._quantile(ordered, level)) for level in SPREAD)
        return MeanAndSpread(low, self.mean(y), high)

    def structure(self, y: Array) -> float:
        """Mean square of the means, weighted with their rows."""
        return float(np.average(self.mean(y)[self.drawn] ** 2, weights=self.sizes[self.drawn]))

    def _quantile(self, ordered: Array, level: float) -> Array:
        """Linear between rows, as `numpy.quantile`."""
        place = level * (self.sizes[self.drawn] - 1)
        below = np.floor(place).astype(int)
        first, part = ordered[self.begins + below], place - below
        return first + part * (ordered[self.begins + np.ceil(place).astype(int)] - first)

    def _on_all(self, values: Array) -> Array:
        found = np.full(len(self.sizes), np.nan)
        found[self.drawn] = values
        return found


def shown_rows(rows: ResidualRows) -> Array:
    """(n,) rows that are drawn over channels: fitted or held out."""
    return np.asarray(rows.train, bool) | np.asarray(rows.held_out, bool)


def binned(rows: ResidualRows, channel: Channel, curves: Mapping[str, Array]) -> Bins | None:
    """The drawn rows in which the channel and all curves are known; None without enough of them."""
    x = channel.values if channel.period is None else np.mod(channel.values, channel.period)
    use = np.flatnonzero(shown_rows(rows) & np.all([np.isfinite(y) for y in (x, *curves.values())], axis=0))
    count, own = len(use), x[use]
    if count < 4:
        return None
    if count <= BINS:
        each = np.arange(count)
        return Bins(x, use[np.argsort(own, kind="stable")], each, np.ones(count, int), np.ones(count, bool))
    # Rare extremes of a channel would stretch the axis: they are put into the outermost bins.
    low, high = (0.0, channel.period) if channel.period else np.quantile(own, [0.002, 0.998])
    bins = int(np.clip(count // 10, 12, BINS)) if high > low else 1
    if channel.key == "velocity" and low < 0.0 < high:
        # An edge at zero: a bin that straddles it would average friction of both directions.
        width = (high - low) / bins
        below, above = np.ceil(-low / width), np.ceil(high / width)
        low, high, bins = -below * width, above * width, int(below + above)
    least = 5 if count >= 20 * bins else 2
    place = np.clip(((own - low) / max(high - low, 1e-300) * bins).astype(int), 0, bins - 1)
    sizes = np.bincount(place, minlength=bins)
    drawn = sizes >= least
    if not drawn.any():
        return None
    order = np.argsort(place, kind="stable")
    index = use[order[drawn[place[order]]]]
    return Bins(x, index, np.r_[0, np.cumsum(sizes[drawn])[:-1]], sizes, drawn)


# Run by run: the error before and after, and whether the friction of the runs is one.


BLOCK_S = 1.0
"""Residuals this far apart count as independent, as in the intervals of the scores."""
LEAST_BLOCKS = 5
"""Fewest of them for a standard error: of fewer, it is left to chance, and of one it is zero."""
SIGMAS, LEAST_DIFFERENCE = 5.0, 0.05
"""A run's friction is another one beyond this many standard errors and by this part: that of a greased gear
differs by some per cent from day to day."""


@dataclass(frozen=True)
class PartErrors:
    """Rows of a run: how many, and the RMS of the residual before and after; `after` is None without one."""

    rows: int
    before: float
    after: float | None


@dataclass(frozen=True)
class RunErrors:
    """A run of a balance.

    Attributes:
        name: of the run.
        fitted, held_out: its rows in motion, None without any. Fitted ones may have passed a low pass that
            held-out ones have not: their errors are not to be compared with each other.
        level: friction of the run over that of the model fitted to all, and its standard error; None where
            the balance contains no friction, or the run is too short for an error.
    """

    name: str
    fitted: PartErrors | None
    held_out: PartErrors | None
    level: tuple[float, float] | None


def runs_of(balance: BalanceResiduals) -> list[RunErrors]:
    """Every run with rows in motion, in the order of the logs."""
    rows, finite = balance.rows, np.isfinite(balance.paper)
    if balance.extended is not None:
        finite = finite & np.isfinite(balance.extended)
    found = []
    for run, name in enumerate(rows.run_names):
        own = finite & (rows.run == run)
        if (own & shown_rows(rows)).any():
            fitted, held_out = (_part(balance, own & mask) for mask in (rows.train, rows.held_out))
            found.append(RunErrors(name, fitted, held_out, _level(balance, own & shown_rows(rows))))
    return found


def _part(balance: BalanceResiduals, own: Array) -> PartErrors | None:
    if not own.any():
        return None
    after = None if balance.extended is None else _rms(balance.extended[own])
    return PartErrors(int(np.count_nonzero(own)), _rms(balance.paper[own]), after)


def runs_apart(runs: list[RunErrors]) -> tuple[RunErrors, RunErrors] | None:
    """The runs of least and most friction, if they differ clearly; None if one model suits them all."""
    levels = sorted((run for run in runs if run.level is not None), key=lambda run: run.level or (0.0, 0.0))
    if len(levels) < 2:
        return None
    least, most = levels[0], levels[-1]
    (low, low_error), (high, high_error) = least.level or (0.0, 0.0), most.level or (0.0, 0.0)
    clear = high - low > SIGMAS * float(np.hypot(low_error, high_error))
    return (least, most) if clear and high - low > LEAST_DIFFERENCE else None


def _level(balance: BalanceResiduals, own: Array) -> tuple[float, float] | None:
    """The factor on the model's friction that suits the run best; its standard error is by blocks of time."""
    if balance.measured is None:
        return None
    residual = (balance.paper if balance.extended is None else balance.extended)[own]
    model = balance.measured[own] - residual
    total = float(model @ model)
    block = np.floor(balance.rows.t[own] / BLOCK_S).astype(int)
    block = np.unique(block, return_inverse=True)[1]
    if total == 0.0 or block.max() + 1 < LEAST_BLOCKS:
        return None
    more = float(residual @ model) / total
    sums = np.bincount(block, (residual - more * model) * model)
    return 1.0 + more, float(np.sqrt(sums @ sums)) / total


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))
