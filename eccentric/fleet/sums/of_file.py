"""One file of a joint -> its sums: triangles of blocks of rows, and what the file covers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eccentric.errors import InputError
from eccentric.fleet.limits import BATCH_ROWS, BLOCKS, STUCK_PART
from eccentric.fleet.sums.columns import Columns
from eccentric.fleet.sums.pieces import Piece, pieces
from eccentric.fleet.sums.speeds import Speeds
from eccentric.fleet.sums.triangle import merged, triangles
from eccentric.fleet.sums.windows import SHARES, any_in, means, rates

__all__ = ["Coverage", "FileSums", "sums_of"]

Array = NDArray[np.float64]
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
            f"{path}: a drive that is measured is required, received one that repeats its value in"
            f" {covered.repeats / covered.samples:.0%} of the moving rows"
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
