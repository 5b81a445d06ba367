"""A file, batch by batch, as stretches of even samples: those that a window still needs come with the next.

Windows are then those of the whole file, whatever the size of the batches. Of unevenly sampled logs the angle
and all else is interpolated linearly on an even grid, which begins anew with each batch.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eccentric.errors import InputError
from eccentric.fleet.limits import LEAST_STEPS
from eccentric.fleet.sums.columns import drive_channel
from eccentric.fleet.sums.windows import SHARES, share_of
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
)

__all__ = ["Piece", "pieces"]

Array = NDArray[np.float64]


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
            raise InputError("the same channels are required in all parts of a log")
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
        drives = rig.axis.said("current, torque or voltage")
        raise InputError(f"{rig.path}: a log with {drives} is required, received none")
    if name == "torque_l":
        return "torque", channels[name] * rig.value("mu")
    return name, channels[name]
