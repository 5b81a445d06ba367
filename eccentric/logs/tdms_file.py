"""TDMS files of LabVIEW by nptdms: channels with a waveform have a clock, others share a column of time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from eccentric.logs.assemble import Column, Read, Recorded, assemble, column_of, on_one_clock
from eccentric.logs.foreign import library, reading, require_room_for_numbers

_UNIT = ("unit_string", "NI_UnitDescription", "unit")


def read_tdms(path: Path) -> Read:
    """Read all channels; with the waveform's time where they have one, put on the clock of the fastest."""
    nptdms = library("nptdms", "tdms", path)
    # Opened here: the library would leave the file open after an error.
    with reading(path, "TDMS file"), path.open("rb") as stream, nptdms.TdmsFile.open(stream) as file:
        found = [channel for group in file.groups() for channel in group.channels()]
        lengths = [len(channel) for channel in found]
        require_room_for_numbers(path, max(lengths, default=0), sum(lengths))
        names = [channel.name for channel in found]
        named = [
            (c.name if names.count(c.name) == 1 else f"{c.group_name}.{c.name}", c) for c in found if len(c)
        ]
        clocked = [
            (name, c) for name, c in named if float(c.properties.get("wf_increment", 0.0) or 0.0) > 0.0
        ]
        if clocked:
            starts = [c.properties.get("wf_start_time") for _, c in clocked]
            first = min((s for s in starts if s is not None), default=None)
            channels = [
                Recorded(name, _time(c, first), values, _unit(c))
                for name, c in clocked
                if (values := _values(c)) is not None
            ]
            rest = [name for name, c in named if (name, c) not in clocked]
            notes = [f"left out, since they have no clock: {', '.join(rest)}"] if rest else []
            return on_one_clock(channels, path, notes)
        read = assemble({name: values for name, c in named if (values := _values(c)) is not None})
        units = {name: unit for name, c in named if name in read.columns and (unit := _unit(c))}
        return Read(read.columns, notes=read.notes, units=units)


def _time(channel: Any, first: Any) -> np.ndarray:
    """Time [s] from the earliest start of a waveform in the file."""
    offset = float(channel.properties.get("wf_start_offset", 0.0) or 0.0)
    start = channel.properties.get("wf_start_time")
    if start is not None and first is not None:
        offset += float((start - first) / np.timedelta64(1, "ns")) * 1e-9
    return offset + float(channel.properties["wf_increment"]) * np.arange(len(channel), dtype=float)


def _values(channel: Any) -> Column | None:
    values = np.asarray(channel[:])
    if values.dtype.kind in "biuf" and values.ndim == 1:
        return values.astype(float)
    if values.dtype.kind == "M":
        return (values - values[0]) / np.timedelta64(1, "s")
    if values.dtype.kind in "OU" and values.ndim == 1:
        return column_of([str(value) for value in values])
    return None


def _unit(channel: Any) -> str:
    return next((str(channel.properties[key]) for key in _UNIT if channel.properties.get(key)), "")
