"""Channels that were recorded on clocks of their own, as columns on one of them.

The clock with the most rows is kept as it is, within the time that it shares with the channels of a similar
rate. Other channels are interpolated linearly between their samples, and what is whole numbers or text keeps
its last value: a mode has no value in between. A slow channel, or one that was recorded for a part of the
time, does not shorten the log: outside its own time it has no value. The notes say so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eccentric.errors import InputError, few
from eccentric.logs.assemble import Column, Read
from eccentric.logs.limits import SIMILAR_RATE, SIMILAR_TIME

__all__ = ["TIME", "Recorded", "on_one_clock"]

TIME = "time_s"
"""The column of the time that all channels were put on."""


@dataclass(frozen=True)
class Recorded:
    """A signal: time [s] (n,), not falling, and values (n,), numbers or text."""

    name: str
    time: NDArray[np.float64]
    values: Column
    unit: str = ""


def on_one_clock(
    channels: Sequence[Recorded], path: Path | str, notes: Sequence[str] = (), time: str = TIME
) -> Read:
    """Return the channels as columns on the clock of the one with the most rows, whose times are in `time`.

    Raises:
        InputError: no channel has rows, or those on other clocks share no time with it.
    """
    filled = [c for c in (_clean(c) for c in channels) if len(c.time) > 1]
    if not filled:
        empty = f"{path}: a log with numbers over time is required, received none"
        raise InputError("; ".join((empty, *notes)))
    lead = max(filled, key=lambda c: len(c.time))
    others = [c for c in filled if not np.array_equal(c.time, lead.time)]
    similar = [lead, *(c for c in others if _is_similar(c, lead))]
    first, last = max(c.time[0] for c in similar), min(c.time[-1] for c in similar)
    rows = (lead.time >= first) & (lead.time <= last)
    t = lead.time[rows]
    if len(t) < 2 or (others and not any(_seconds_shared(c, lead) > 0.0 for c in others)):
        first, last = max(c.time[0] for c in filled), min(c.time[-1] for c in filled)
        raise InputError(
            f"{path}: channels that share a time are required, received {lead.name} from"
            f" {lead.time[0]:.6g} to {lead.time[-1]:.6g} s and others from {first:.6g} or to {last:.6g} s"
        )
    columns: dict[str, Column] = {time: t - t[0]}
    units = {time: "s"}
    linear, held, partly = [], [], []
    for c in filled:
        name = _free(c.name, columns)
        if c.unit:
            units[name] = c.unit
        if np.array_equal(c.time, lead.time):
            columns[name] = c.values[rows]
            continue
        # Up to the time of its next sample, a channel is where it was.
        step = float(np.median(np.diff(c.time)))
        outside = t < c.time[0] - step
        if _is_held(c.values):
            columns[name] = c.values[np.clip(np.searchsorted(c.time, t, "right") - 1, 0, None)]
            held.append(name)
        else:
            columns[name] = np.interp(t, c.time, c.values)
            linear.append(name)
            outside |= t > c.time[-1] + step
        if np.any(outside):
            columns[name] = np.where(outside, np.nan if c.values.dtype.kind != "U" else "", columns[name])
            partly.append(name)
    said = [*notes]
    if linear or held:
        how = [
            f"{few(names, 5)} {words}"
            for names, words in ((linear, "linearly"), (held, "by the last value"))
            if names
        ]
        said.append(f"put on the clock of {lead.name}, {len(t)} rows: {'; '.join(how)}")
    if partly:
        said.append(f"without a value in rows outside their own time: {few(partly, 5)}")
    if len(t) < len(lead.time):
        said.append(
            f"{len(lead.time) - len(t)} rows of {lead.name} are left out, before or after other channels"
        )
    return Read(columns, notes=tuple(said), units=units)


def _is_similar(c: Recorded, lead: Recorded) -> bool:
    """Whether a channel was recorded at a similar rate, and for most of the time."""
    many = len(c.time) >= SIMILAR_RATE * len(lead.time)
    return many and _seconds_shared(c, lead) >= SIMILAR_TIME * (lead.time[-1] - lead.time[0])


def _seconds_shared(c: Recorded, lead: Recorded) -> float:
    return float(min(c.time[-1], lead.time[-1]) - max(c.time[0], lead.time[0]))


def _clean(c: Recorded) -> Recorded:
    """Without samples that are no numbers or have no time, in the order of time."""
    good = np.isfinite(c.time)
    if c.values.dtype.kind == "f":
        good &= np.isfinite(c.values)
    time, values = c.time[good], c.values[good]
    if len(time) and np.any(np.diff(time) < 0.0):
        order = np.argsort(time, kind="stable")
        time, values = time[order], values[order]
    return Recorded(c.name, time, values, c.unit)


def _is_held(values: Column) -> bool:
    return values.dtype.kind != "f" or bool(np.all(values == np.round(values)))


def _free(name: str, taken: dict[str, Column]) -> str:
    if name not in taken:
        return name
    return next(f"{name}#{k}" for k in range(2, len(taken) + 3) if f"{name}#{k}" not in taken)
