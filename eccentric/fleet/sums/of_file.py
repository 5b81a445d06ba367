"""One file of a joint -> its sums: triangles of blocks of rows, and the coverage."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.fleet.limits import (
    BATCH_ROWS,
    BLOCKS,
    FAST_PART,
    LEAST_SHARE,
    LEAST_STEPS,
    QUANTA,
    SHARES,
    SLOW,
    SPEED_BIN,
    STUCK_PART,
    WINDOW_PERIODS,
)
from eccentric.fleet.sums.columns import Columns, drive_channel
from eccentric.identification import merged, triangles
from eccentric.logs import stream_log
from eccentric.rigs import Rig
from eccentric.signals import (
    Table,
    of_the_motor,
    places_of,
    read_table,
    rows_of_each,
    stream_columns,
    stretches,
    weights_by_parts,
)

Array = NDArray[np.float64]


# Evenly spaced samples -> means over smooth windows, with mean first and second derivative of the angle.
#
# Derivatives are integrated by parts (`weights_by_parts`), so that all terms of a balance J x'' + ... = tau
# get the same average, and the angle is differentiated within its low pass. Windows are spaced by a quarter
# of their length, so each sample is in 4 windows: the samples are split into quarters, multiplied by the
# kernels in one matrix product, and four shifted products add up to the windows.
def share_of(low_pass_hz: float, step_s: float) -> int:
    """Samples between windows: a quarter of the window length for a cut-off [Hz] at a step [s]."""
    return max(LEAST_SHARE, round(WINDOW_PERIODS / low_pass_hz / SHARES / step_s))


def means(x: Array, share: int) -> Array:
    """Means (m,) of samples (n,), m = n // share - 3."""
    return _windows(x, share, _kernels(share)[:, :1])[:, 0]


def rates(x: Array, share: int, step_s: float) -> tuple[Array, Array, Array]:
    """Means of samples (n,), of their first [1/s] and second [1/s^2] derivative, each (m,)."""
    # Subtract the offset of a large angle: the derivative kernels sum to zero only up to rounding.
    start = x[0]
    averages = _windows(x - start, share, _kernels(share))
    return averages[:, 0] + start, averages[:, 1] / step_s, averages[:, 2] / step_s**2


def any_in(flag: NDArray[np.bool_], share: int) -> NDArray[np.bool_]:
    """Whether a flag (n,) is set anywhere in each window (m,)."""
    count = len(flag) // share
    part = np.any(flag[: count * share].reshape(count, share), axis=1)
    return np.any([part[k : count - SHARES + 1 + k] for k in range(SHARES)], axis=0)


def _windows(x: Array, share: int, kernels: Array) -> Array:
    """Sums (m, c) of samples (n,) with kernels (SHARES * share, c)."""
    count, width = len(x) // share, kernels.shape[1]
    apart = kernels.reshape(SHARES, share, width).transpose(1, 0, 2).reshape(share, SHARES * width)
    parts = (x[: count * share].reshape(count, share) @ apart).reshape(count, SHARES, width)
    return np.sum([parts[k : count - SHARES + 1 + k, k] for k in range(SHARES)], axis=0)


@lru_cache(maxsize=64)
def _kernels(share: int) -> Array:
    """Weights (SHARES * share, 3) of the mean, first and second derivative, for samples 1 s apart."""
    half = 0.5 * SHARES * share
    place = np.arange(SHARES * share, dtype=np.float64) + (0.5 - half)
    return weights_by_parts(place[None], half, (0, 1, 2), degree=3)[:, 0].T


_EDGES = np.exp(np.arange(np.log(1e-9), np.log(1e9), np.log(SPEED_BIN)))


class Speeds:
    """Histogram of travel over speed, and the speed that the encoder resolves."""

    def __init__(self) -> None:
        self._way = np.zeros(len(_EDGES) + 1)
        self._resolved = 0.0

    def add(self, omega: Array, quantum: float, share_s: float) -> None:
        """Add windows of speeds [rad/s] (m,), spaced by `share_s` [s], with an encoder step [rad]."""
        speed = np.abs(omega)
        at = np.searchsorted(_EDGES, speed)
        self._way += np.bincount(at, speed * share_s, minlength=len(self._way))
        self._resolved = max(self._resolved, QUANTA * quantum / (SHARES * share_s))

    def threshold(self) -> float:
        """The speed [rad/s] above which a window counts as moving; 0 for a file without motion."""
        way = np.cumsum(self._way)
        if not way[-1]:
            return self._resolved
        fast = _EDGES[min(int(np.searchsorted(way, FAST_PART * way[-1])), len(_EDGES) - 1)]
        return max(self._resolved, SLOW * float(fast))


# A file, batch by batch, as stretches of evenly spaced samples. Samples that later windows need are carried
# over to the next batch.
#
# Windows are then the same whatever the size of the batches. Unevenly sampled logs are interpolated linearly
# on an even grid, which begins anew with each batch. Rows that are missing from an even grid are filled in
# linearly, too, and no window with one of them is used.
@dataclass(frozen=True)
class Piece:
    """Samples (n,) of one stretch."""

    theta: Array
    drive: Array  # the channel `measured_by`, a link torque converted to the motor
    measured_by: str
    temperature: Array | None
    wanted: NDArray[np.bool_]  # masks rows that the rig uses with the motor on
    step: float  # between samples [s]
    share: int  # samples between windows
    quantum: float  # encoder step by the rig, else 0 [rad]
    place: int  # the first row in the file
    total: int  # of its rows


def pieces(path: Path, rig: Rig, rows: int) -> Iterator[Piece]:
    """Yield the pieces of a file, with at most `rows` rows and those carried over in memory."""
    carried: _Left | None = None
    place = 0
    stream = stream_log(path)
    total = stream.rows
    spans = [(first, min(first + rows, total)) for first in range(0, total, rows)]
    for log in stream.batches(stream_columns(stream, rig), spans):
        logged = read_table([log], rig)
        extended = logged if carried is None else carried.before(logged)
        table, _ = of_the_motor(extended, rig)
        theta = table.channels["theta_m"]
        if carried is not None:
            theta = theta + (carried.theta - theta[0])
        begins = place - (len(theta) - len(logged.run))
        place = begins + len(theta)
        each = rows_of_each(stretches(table.channels["time"], table.run))
        carried = None
        for stretch in each:
            piece = _piece(table, theta, stretch, rig, _quantum(logged, rig), begins, total)
            if piece is not None:
                yield piece
            if stretch is each[-1]:
                first = stretch[0]
                if piece is not None:
                    done = max(len(piece.theta) // piece.share - SHARES + 1, 0)
                    t = table.channels["time"][stretch]
                    first += np.searchsorted(t, t[0] + (done * piece.share - 0.5) * piece.step)
                carried = _Left.of(extended, float(theta[first]), int(first))


@dataclass(frozen=True)
class _Left:
    """Rows carried over to the next batch, and the motor angle at the first of them."""

    table: Table
    theta: float

    @classmethod
    def of(cls, table: Table, theta: float, first: int) -> _Left:
        return cls(_rows(table, slice(first, None)), theta)

    def before(self, table: Table) -> Table:
        """Concatenate these rows and a table, with its runs renumbered."""
        carried = self.table
        if set(carried.channels) != set(table.channels):
            raise InputError("expected the same channels in all parts of a log")
        last = carried.run[-1]
        continues = carried.run_names[last] == table.run_names[0]
        run = table.run + last + (0 if continues else 1)
        names = (*carried.run_names[: last + 1], *table.run_names[1 if continues else 0 :])
        both = {name: np.concatenate([x, table.channels[name]]) for name, x in carried.channels.items()}
        masks = {
            name: np.concatenate([getattr(carried, name), getattr(table, name)])
            for name in _of_rows(table)
            if name != "run"
        }
        run = np.concatenate([carried.run, run])
        return replace(table, channels=both, run=run, run_names=names, **masks)


def _rows(table: Table, rows: slice) -> Table:
    masks = {name: getattr(table, name)[rows] for name in _of_rows(table)}
    return replace(table, channels={name: x[rows] for name, x in table.channels.items()}, **masks)


def _of_rows(table: Table) -> list[str]:
    """Names of a table's arrays by row besides its channels: the run number and the masks."""
    return [f.name for f in fields(table) if isinstance(getattr(table, f.name), np.ndarray)]


def _piece(
    table: Table, theta: Array, rows: NDArray[np.int64], rig: Rig, quantum: float, begins: int, total: int
) -> Piece | None:
    """The piece of these rows; None if too short for a sampling rate."""
    if len(rows) <= LEAST_STEPS:
        return None
    part = slice(int(rows[0]), int(rows[-1]) + 1)
    t = table.channels["time"][part]
    places = places_of(t)
    count = len(t) if places is None else int(places[-1]) + 1
    step = float((t[-1] - t[0]) / (count - 1))
    name, drive = _drive(table.channels, rig)
    wanted = table.use[part] & ~table.motor_off[part]
    signals = {"theta": theta[part], "drive": drive[part]}
    if "temperature" in table.channels:
        signals["temperature"] = table.channels["temperature"][part]
    if places is None or count > len(t):
        grid = t[0] + step * np.arange(count)
        signals = {key: np.interp(grid, t, x) for key, x in signals.items()}
        wanted = np.interp(grid, t, wanted.astype(float)) == 1.0
        if places is not None:
            wanted &= np.isin(np.arange(count), places)
    return Piece(
        signals["theta"],
        signals["drive"],
        name,
        signals.get("temperature"),
        wanted,
        step,
        share_of(rig.sampling.low_pass_hz, step),
        quantum,
        begins + part.start,
        total,
    )


def _quantum(logged: Table, rig: Rig) -> float:
    """The encoder step at the motor [rad], if the rig gives the counts; else 0."""
    if rig.log.counts_per_rev is None or not {"theta_m", "theta_l"} & set(logged.channels):
        return 0.0
    gear = 1.0 if "theta_m" in logged.channels else rig.value("mu")
    return 2.0 * np.pi / rig.log.counts_per_rev / gear


def _drive(channels: Mapping[str, Array], rig: Rig) -> tuple[str, Array]:
    """The channel that measures the drive, and its signal (n,)."""
    name = drive_channel(channels, rig)
    if name is None:
        drives = f"current, {rig.axis.term('torque')} or voltage"
        raise InputError(rig.path, f"a log with {drives}", "none")
    if name == "torque_l":
        return "torque", channels[name] * rig.value("mu")
    return name, channels[name]


Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Coverage:
    """Coverage of a file."""

    rows: int
    seconds: float  # in motion
    forward: float  # their forward fraction
    low: float  # speed of the slowest window [rad/s, or m/s]
    high: float  # of the fastest
    temperature: float  # mean in motion [deg C], NaN where none is logged
    coldest: float
    warmest: float


@dataclass(frozen=True)
class FileSums:
    """Sums of one file: triangles (BLOCKS, k + 1, k + 1) of [X y], windows per block (BLOCKS,), coverage."""

    triangles: Array
    windows: Integers
    coverage: Coverage


def sums_of(path: Path, columns: Columns, rows: int = BATCH_ROWS) -> FileSums:
    """The sums of a file with at most `rows` in memory; up to rounding independent of that number.

    Without a motion threshold in the rig it is determined from the file, which is read twice if it has more
    than `rows`. Raises InputError for a file that cannot be read or does not fit its rig, and for a stuck
    drive signal.
    """
    size = len(columns.headings) + 1
    stack, counts, covered = np.zeros((BLOCKS, size, size)), np.zeros(BLOCKS, dtype=np.int64), _Covered()
    slow, every = columns.rig.sampling.moving_threshold_rad_s, pieces(path, columns.rig, rows)
    if slow is None:
        slow, buffered = _threshold(every, rows)
        every = buffered or pieces(path, columns.rig, rows)
    for piece in every:
        columns.require_drive(piece.measured_by)
        covered.rows = piece.total
        if len(piece.theta) < SHARES * piece.share:
            continue
        theta, omega, alpha = rates(piece.theta, piece.share, piece.step)
        span = SHARES * piece.share * piece.step
        # Fast from end to end of the window, so that none contains a reversal.
        fast = np.abs(omega) > slow + 0.5 * span * np.abs(alpha)
        moving = np.flatnonzero(fast & ~any_in(~piece.wanted, piece.share))
        if not len(moving):
            continue
        covered.add(piece, moving, omega[moving])
        drive = means(piece.drive, piece.share)[moving]
        torque = columns.torque({piece.measured_by: drive}, omega[moving])
        design = columns.rows(theta[moving], omega[moving], alpha[moving], torque)
        block = np.minimum((piece.place + moving * piece.share) * BLOCKS // piece.total, BLOCKS - 1)
        new = triangles(design, block, BLOCKS)
        occupied = np.flatnonzero(counts)
        counts += np.bincount(block, minlength=BLOCKS)
        for shared in np.intersect1d(occupied, block):
            new[shared] = merged(np.stack([stack[shared], new[shared]]))
        updated = np.unique(block)
        stack[updated] = new[updated]
    if covered.repeats > STUCK_PART * covered.samples:
        raise InputError(
            path,
            "a drive that is measured",
            (f"one that repeats its value in {covered.repeats / covered.samples:.0%} of the moving rows"),
        )
    return FileSums(stack, counts, covered.result())


def _threshold(every: Iterable[Piece], rows: int) -> tuple[float, list[Piece]]:
    """The motion threshold [rad/s] of a file, and its pieces if it has at most `rows`."""
    speeds, buffered = Speeds(), list[Piece]()
    for piece in every:
        if piece.total <= rows:
            buffered.append(piece)
        if len(piece.theta) >= SHARES * piece.share:
            omega = rates(piece.theta, piece.share, piece.step)[1]
            speeds.add(omega[~any_in(~piece.wanted, piece.share)], piece.quantum, piece.share * piece.step)
    return speeds.threshold(), buffered


@dataclass
class _Covered:
    """Accumulated coverage of the windows so far."""

    rows: int = 0
    windows: int = 0
    forward: int = 0
    seconds: float = 0.0
    low: float = np.inf
    high: float = 0.0
    heat: float = 0.0
    coldest: float = np.inf
    warmest: float = -np.inf
    samples: int = 0
    repeats: int = 0

    def add(self, piece: Piece, moving: Integers, omega: Array) -> None:
        size = np.abs(omega)
        self.windows += len(moving)
        self.forward += int(np.count_nonzero(omega > 0.0))
        self.seconds += len(moving) * piece.share * piece.step
        self.low, self.high = min(self.low, float(size.min())), max(self.high, float(size.max()))
        first = moving * piece.share
        self.samples += len(moving)
        self.repeats += int(np.count_nonzero(piece.drive[first] == piece.drive[first + 1]))
        if piece.temperature is not None:
            heat = piece.temperature[first]
            self.heat += float(heat.sum())
            self.coldest = min(self.coldest, float(heat.min()))
            self.warmest = max(self.warmest, float(heat.max()))

    def result(self) -> Coverage:
        """The coverage, with NaN where there is no data."""
        none, nan = not self.windows, float("nan")
        warm = np.isfinite(self.coldest)
        return Coverage(
            self.rows,
            self.seconds,
            nan if none else self.forward / self.windows,
            nan if none else self.low,
            nan if none else self.high,
            self.heat / self.windows if warm else nan,
            self.coldest if warm else nan,
            self.warmest if warm else nan,
        )
