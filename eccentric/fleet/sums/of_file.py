"""One file of a joint -> its sums: triangles of blocks of rows, and what the file covers."""

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
    is_even,
    of_the_motor,
    read_table,
    rows_of_each,
    stream_columns,
    stretches,
    weights_by_parts,
)

# Even samples -> means over smooth windows, with the mean first and second rate of the angle.
#
# Rates are integrated by parts (`weights_by_parts`), so that a balance J x'' + ... = tau is averaged as a
# whole, and the angle is differentiated inside its own low pass. Windows are spaced by a quarter of their
# length, so that each sample is multiplied 4 times by a kernel: the samples are cut into quarters, one matrix
# product takes them all, and four shifted sums make the windows.


Array = NDArray[np.float64]


def share_of(low_pass_hz: float, step_s: float) -> int:
    """Samples between two windows: a quarter of the length that suits a cut-off [Hz] at a step [s]."""
    return max(LEAST_SHARE, round(WINDOW_PERIODS / low_pass_hz / SHARES / step_s))


def means(x: Array, share: int) -> Array:
    """Means (m,) of samples (n,), m = n // share - 3."""
    return _windows(x, share, _kernels(share)[:, :1])[:, 0]


def rates(x: Array, share: int, step_s: float) -> tuple[Array, Array, Array]:
    """Means of samples (n,), of their first rate [1/s] and of their second rate [1/s^2], each (m,)."""
    # Of a large angle only the differences count: the kernels of rates sum to zero up to rounding.
    start = x[0]
    found = _windows(x - start, share, _kernels(share))
    return found[:, 0] + start, found[:, 1] / step_s, found[:, 2] / step_s**2


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
    """Weights (SHARES * share, 3) of the mean, the first and the second rate, for samples 1 s apart."""
    half = 0.5 * SHARES * share
    place = np.arange(SHARES * share, dtype=np.float64) + (0.5 - half)
    return weights_by_parts(place[None], half, (0, 1, 2), degree=3)[:, 0].T


# The threshold of motion of a file, from the speeds of all of its windows, in memory that does not grow.


_EDGES = np.exp(np.arange(np.log(1e-9), np.log(1e9), np.log(SPEED_BIN)))


class Speeds:
    """The way covered at each speed, in bins, and the speed that the encoder resolves."""

    def __init__(self) -> None:
        self._way = np.zeros(len(_EDGES) + 1)
        self._resolved = 0.0

    def add(self, omega: Array, quantum: float, share_s: float) -> None:
        """Add windows with speeds [rad/s] (m,), spaced by `share_s` [s], of an encoder of steps [rad]."""
        speed = np.abs(omega)
        at = np.searchsorted(_EDGES, speed)
        self._way += np.bincount(at, speed * share_s, minlength=len(self._way))
        self._resolved = max(self._resolved, QUANTA * quantum / (SHARES * share_s))

    def threshold(self) -> float:
        """The speed [rad/s] above which a window moves; 0 for a file that never moves."""
        way = np.cumsum(self._way)
        if not way[-1]:
            return self._resolved
        fast = _EDGES[min(int(np.searchsorted(way, FAST_PART * way[-1])), len(_EDGES) - 1)]
        return max(self._resolved, SLOW * float(fast))


# A file, batch by batch, as stretches of even samples: those that a window still needs come with the next.
#
# Windows are then those of the whole file, whatever the size of the batches. Of unevenly sampled logs the
# angle and all else is interpolated linearly on an even grid, which begins anew with each batch.


@dataclass(frozen=True)
class Piece:
    """Even samples (n,) of one stretch, `step` [s] apart, `share` of them from window to window.

    `drive` is what measures the torque, by its channel, with a torque of the link converted; `wanted` are the
    rows that the rig uses with the motor on. `quantum` [rad] is the encoder's step by the rig, else 0.
    `place` is where it begins in the file, in rows, of `total`.
    """

    theta: Array
    drive: Array
    measured_by: str
    temperature: Array | None
    wanted: NDArray[np.bool_]
    step: float
    share: int
    quantum: float
    place: int
    total: int


def pieces(path: Path, rig: Rig, rows: int) -> Iterator[Piece]:
    """Yield the pieces of a file, at most `rows` of it, and what a window needs, in memory."""
    left: _Left | None = None
    place = 0
    stream = stream_log(path)
    total = stream.rows
    spans = [(first, min(first + rows, total)) for first in range(0, total, rows)]
    for log in stream.batches(stream_columns(stream, rig), spans):
        logged = read_table([log], rig)
        whole = logged if left is None else left.before(logged)
        table, _ = of_the_motor(whole, rig)
        theta = table.channels["theta_m"]
        if left is not None:
            theta = theta + (left.theta - theta[0])
        begins = place - (len(theta) - len(logged.run))
        place = begins + len(theta)
        each = rows_of_each(stretches(table.channels["time"], table.run))
        left = None
        for rows_of_it in each:
            piece = _piece(table, theta, rows_of_it, rig, _quantum(logged, rig), begins, total)
            if piece is not None:
                yield piece
            if rows_of_it is each[-1]:
                done = 0 if piece is None else max(len(piece.theta) // piece.share - SHARES + 1, 0)
                first = rows_of_it[0] + (0 if piece is None else done * piece.share)
                left = _Left.of(whole, float(theta[first]), int(first))


@dataclass(frozen=True)
class _Left:
    """The rows that the next batch begins with, and the angle of the motor at the first of them."""

    table: Table
    theta: float

    @classmethod
    def of(cls, table: Table, theta: float, first: int) -> _Left:
        return cls(_rows(table, slice(first, None)), theta)

    def before(self, table: Table) -> Table:
        """These rows and those of a table, its runs numbered on, as one."""
        own = self.table
        if set(own.channels) != set(table.channels):
            raise InputError("expected the same channels in all parts of a log")
        goes_on = own.run_names[own.run[-1]] == table.run_names[0]
        run = table.run + own.run[-1] + (0 if goes_on else 1)
        names = (*own.run_names[: own.run[-1] + 1], *table.run_names[1 if goes_on else 0 :])
        both = {name: np.concatenate([x, table.channels[name]]) for name, x in own.channels.items()}
        masks = {
            name: np.concatenate([getattr(own, name), getattr(table, name)])
            for name in _of_rows(table)
            if name != "run"
        }
        return replace(table, channels=both, run=np.concatenate([own.run, run]), run_names=names, **masks)


def _rows(table: Table, rows: slice) -> Table:
    masks = {name: getattr(table, name)[rows] for name in _of_rows(table)}
    return replace(table, channels={name: x[rows] for name, x in table.channels.items()}, **masks)


def _of_rows(table: Table) -> list[str]:
    """The names of what a table has for each row, beside its channels: the number of the run, and masks."""
    return [f.name for f in fields(table) if isinstance(getattr(table, f.name), np.ndarray)]


def _piece(
    table: Table, theta: Array, rows: NDArray[np.int64], rig: Rig, quantum: float, begins: int, total: int
) -> Piece | None:
    """The stretch of these rows; None for one too short to have a rate."""
    if len(rows) <= LEAST_STEPS:
        return None
    part = slice(int(rows[0]), int(rows[-1]) + 1)
    t = table.channels["time"][part]
    step = float((t[-1] - t[0]) / (len(t) - 1))
    name, drive = _drive(table.channels, rig)
    wanted = table.use[part] & ~table.motor_off[part]
    signals = {"theta": theta[part], "drive": drive[part]}
    if "temperature" in table.channels:
        signals["temperature"] = table.channels["temperature"][part]
    if not is_even(t):
        grid = t[0] + step * np.arange(len(t))
        signals = {key: np.interp(grid, t, x) for key, x in signals.items()}
        wanted = np.interp(grid, t, wanted.astype(float)) == 1.0
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
    """The step of the angle at the motor [rad], by the counts that the rig gives; else 0."""
    if rig.log.counts_per_rev is None or not {"theta_m", "theta_l"} & set(logged.channels):
        return 0.0
    gear = 1.0 if "theta_m" in logged.channels else rig.value("mu")
    return 2.0 * np.pi / rig.log.counts_per_rev / gear


def _drive(channels: Mapping[str, Array], rig: Rig) -> tuple[str, Array]:
    """What measures the drive torque, by the rig, else the first that is logged, and its signal (n,)."""
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
    """What a file covers: rows, seconds in motion, the part of them forward, speeds, temperatures.

    `low` and `high` are the slowest and the fastest window [rad/s, or m/s]; temperatures [deg C], the mean
    and the range in motion, are NaN where none is logged.
    """

    rows: int
    seconds: float
    forward: float
    low: float
    high: float
    temperature: float
    coldest: float
    warmest: float


@dataclass(frozen=True)
class FileSums:
    """Sums of one file: triangles (BLOCKS, k + 1, k + 1) of [X y], windows in each (BLOCKS,), coverage."""

    triangles: Array
    windows: Integers
    coverage: Coverage


def sums_of(path: Path, columns: Columns, rows: int = BATCH_ROWS) -> FileSums:
    """The sums of a file with at most `rows` of it in memory, the same whatever that number up to rounding.

    Where the rig has no threshold of motion, it is that of all of the file, and a file of more rows than that
    is read twice. Raises InputError for a file that cannot be read or does not fit its rig, and for a drive
    that is stuck.
    """
    size = len(columns.headings) + 1
    stack, counts, covered = np.zeros((BLOCKS, size, size)), np.zeros(BLOCKS, dtype=np.int64), _Covered()
    slow, every = columns.rig.sampling.moving_threshold_rad_s, pieces(path, columns.rig, rows)
    if slow is None:
        slow, held = _threshold(every, rows)
        every = held or pieces(path, columns.rig, rows)
    for piece in every:
        columns.require_drive(piece.measured_by)
        covered.rows = piece.total
        if len(piece.theta) < SHARES * piece.share:
            continue
        theta, omega, alpha = rates(piece.theta, piece.share, piece.step)
        span = SHARES * piece.share * piece.step
        # From end to end of the window, so that none contains a reversal.
        fast = np.abs(omega) > slow + 0.5 * span * np.abs(alpha)
        kept = np.flatnonzero(fast & ~any_in(~piece.wanted, piece.share))
        if not len(kept):
            continue
        covered.add(piece, kept, omega[kept])
        drive = means(piece.drive, piece.share)[kept]
        torque = columns.torque({piece.measured_by: drive}, omega[kept])
        design = columns.rows(theta[kept], omega[kept], alpha[kept], torque)
        block = np.minimum((piece.place + kept * piece.share) * BLOCKS // piece.total, BLOCKS - 1)
        found = triangles(design, block, BLOCKS)
        held = np.flatnonzero(counts)
        counts += np.bincount(block, minlength=BLOCKS)
        for again in np.intersect1d(held, block):
            found[again] = merged(np.stack([stack[again], found[again]]))
        fresh = np.unique(block)
        stack[fresh] = found[fresh]
    if covered.repeats > STUCK_PART * covered.samples:
        raise InputError(
            path,
            "a drive that is measured",
            (f"one that repeats its value in {covered.repeats / covered.samples:.0%} of the moving rows"),
        )
    return FileSums(stack, counts, covered.result())


def _threshold(every: Iterable[Piece], rows: int) -> tuple[float, list[Piece]]:
    """The threshold of motion [rad/s] of a file, and its pieces if it has at most `rows`."""
    speeds, held = Speeds(), list[Piece]()
    for piece in every:
        if piece.total <= rows:
            held.append(piece)
        if len(piece.theta) >= SHARES * piece.share:
            omega = rates(piece.theta, piece.share, piece.step)[1]
            speeds.add(omega[~any_in(~piece.wanted, piece.share)], piece.quantum, piece.share * piece.step)
    return speeds.threshold(), held


@dataclass
class _Covered:
    """What the windows seen so far cover."""

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

    def add(self, piece: Piece, kept: Integers, omega: Array) -> None:
        """Add the kept windows of a piece with their speeds."""
        size = np.abs(omega)
        self.windows += len(kept)
        self.forward += int(np.count_nonzero(omega > 0.0))
        self.seconds += len(kept) * piece.share * piece.step
        self.low, self.high = min(self.low, float(size.min())), max(self.high, float(size.max()))
        first = kept * piece.share
        self.samples += len(kept)
        self.repeats += int(np.count_nonzero(piece.drive[first] == piece.drive[first + 1]))
        if piece.temperature is not None:
            heat = piece.temperature[first]
            self.heat += float(heat.sum())
            self.coldest = min(self.coldest, float(heat.min()))
            self.warmest = max(self.warmest, float(heat.max()))

    def result(self) -> Coverage:
        """The coverage; NaN for what nothing says."""
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
