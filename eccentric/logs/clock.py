"""A clock as it should have been written: stamps of packets, clocks that start again or fall.

A logger that receives packets of rows gives all rows of one the same time; a recording that is started again
appends to the file of the last one; an export can list the newest row first. Such a clock is put right where
there is one way to do it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.logs import limits

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Mended:
    """A clock put right, for rows (n,) of one run.

    `t` are its times, `kept` the rows whose time fits between those beside it, `part` the number of the
    recording of each row, from 0. `packet` is how many rows share a stamp and how long they last, (0, 0.0)
    where each has its own.
    """

    t: Array
    kept: Mask
    part: Integers
    packet: tuple[int, float] = (0, 0.0)


def falls(t: Array) -> bool:
    """Whether a clock (n,) runs backwards: nearly every step of it that is one is downwards."""
    steps = np.diff(t[np.isfinite(t)])
    steps = steps[steps != 0.0]
    return len(steps) > 2 and bool(np.count_nonzero(steps < 0.0) > limits.FALLING * len(steps))


def mended(t: Array) -> Mended:
    """Put the clock (n,) of one run right; its times are numbers.

    A few rows out of order are not kept, as is a first row that is left from another time. Where rows share
    stamps, they are spread evenly up to the next stamp. Any other fall starts another recording.
    """
    kept = np.ones(len(t), dtype=bool)
    part = np.zeros(len(t), dtype=np.int64)
    if len(t) < 2 or bool(np.all(np.diff(t) > 0.0) and not _is_stale(t)):
        return Mended(t, kept, part)
    kept[0] = not _is_stale(t)
    starts = [0]
    for k in np.flatnonzero(np.diff(t) < 0.0).tolist():
        if not kept[k] or not kept[k + 1]:
            continue
        out = _out_of_order(t, k)
        if out is None:
            starts.append(k + 1)
        else:
            kept[out] = False
    part[starts[1:]] = 1
    part = np.cumsum(part)
    rows = np.flatnonzero(kept)
    again = np.flatnonzero((np.diff(t[rows]) <= 0.0) & (np.diff(part[rows]) == 0)) + 1
    if len(again) < limits.FEWEST_IN_PACKETS * len(rows):
        # A stamp that two rows share by mistake: the second would have to be guessed.
        kept[rows[again]] = False
        return Mended(t, kept, part)
    fine, packet = t.copy(), (0, 0.0)
    for number in range(int(part[-1]) + 1):
        own = rows[part[rows] == number]
        if len(own) > 1:
            fine[own], found = _spread(t[own])
            packet = max(packet, found)
    return Mended(fine, kept, part, packet)


def _is_stale(t: Array) -> bool:
    """Whether the first time is one of another recording: many times as far away as all others last."""
    return len(t) >= limits.FEWEST_AFTER and t[1] - t[0] > limits.FAR_AWAY * float(t[-1] - t[1]) > 0.0


def _out_of_order(t: Array, k: int) -> slice | None:
    """The rows at the fall after row k that do not belong between those beside them; None if many."""
    for m in range(1, limits.MOST_OUT_OF_ORDER + 1):
        if k - m < 0 or t[k + 1] > t[k - m]:
            return slice(max(0, k - m + 1), k + 1)
        if k + 1 + m < len(t) and t[k + 1 + m] > t[k]:
            return slice(k + 1, k + 1 + m)
    return None


def _spread(t: Array) -> tuple[Array, tuple[int, float]]:
    """Rows that share a stamp, evenly up to the next, or all at one rate where no stamp contradicts that.

    Also the usual number of rows with one stamp, and how long they last.
    """
    first = np.flatnonzero(np.diff(t, prepend=-np.inf) > 0.0)
    size = np.diff(np.append(first, len(t)))
    lasts = np.diff(t[first])
    if not len(lasts):
        return t, (0, 0.0)
    row = float(np.median(lasts / size[:-1]))
    # A gap before the next stamp is none of the packet's.
    lasts = np.append(lasts, row * size[-1])
    each = np.where(lasts > limits.LONGEST_BREAK * row * size, row, lasts / size)
    place = np.arange(len(t)) - np.repeat(first, size)
    usual = int(np.median(size))
    fine = t + place * np.repeat(each, size)
    # A row that slipped into the next packet was taken in time all the same, if all were at one rate.
    even = t[0] + np.polyval(np.polyfit(first, t[first] - t[0], 1), np.arange(len(t)))
    if np.all(np.abs(even - fine) <= usual * row):
        fine = even + float(np.median(fine - even))
    return fine, (usual, usual * row)
