"""Recordings of measuring systems: MDF, TDMS of LabVIEW, ULog of PX4, WPILib and CODESYS.

Each channel has a clock of its own; all of them are put on that of the fastest.
"""

from __future__ import annotations

import io
import re
import struct
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.core import InputError, few
from eccentric.logs import limits
from eccentric.logs.assemble import Column, Read, assemble, column_of
from eccentric.logs.clocks import Recorded, on_one_clock
from eccentric.logs.foreign import (
    DamagedError,
    library,
    reading,
    require_room_for_numbers,
    require_room_for_text,
    text_of,
)

_FORMULA = {3: (10,), 4: (3,)}
"""Types of conversion that are a formula as text, by the version of the format."""


def read_mdf(path: Path) -> Read:
    """Read all channels of numbers, put on the clock of the fastest group."""
    asammdf = library("asammdf", "mdf", path)
    # From memory: after an error the library would leave the file open and complain while it is cleared away.
    with reading(path, "MDF file"), asammdf.MDF(io.BytesIO(path.read_bytes())) as file:
        version = int(str(file.version)[0])
        cycles = [int(group.channel_group.cycles_nr) for group in file.groups]
        require_room_for_numbers(
            path,
            max(cycles, default=0),
            sum(n * len(group.channels) for n, group in zip(cycles, file.groups, strict=True)),
        )
        channels: list[Recorded] = []
        formulas: list[str] = []
        others: list[str] = []
        for number, group in enumerate(file.groups):
            master = file.masters_db.get(number)
            for index, channel in enumerate(group.channels):
                if index == master:
                    continue
                if _is_formula(channel, version):
                    formulas.append(channel.name)
                    continue
                one = _read(file, number, index)
                if one is None:
                    others.append(channel.name)
                else:
                    channels.append(one)
        notes = []
        if formulas:
            notes.append(
                f"left out, since a formula in the file, not evaluated, converts them: {few(formulas, 5)}"
            )
        if others:
            notes.append(f"left out, since they are neither numbers nor text: {few(others, 5)}")
        if getattr(file, "attachments", None):
            notes.append("attachments are ignored")
        return on_one_clock(channels, path, notes)


def _is_formula(channel: Any, version: int) -> bool:
    conversion = getattr(channel, "conversion", None)
    return conversion is not None and int(conversion.conversion_type) in _FORMULA.get(version, ())


def _read(file: Any, group: int, index: int) -> Recorded | None:
    signal = file.get(group=group, index=index, ignore_invalidation_bits=False)
    values = np.asarray(signal.samples)
    if values.ndim != 1 or values.dtype.kind not in "biufSU":
        return None
    if values.dtype.kind == "S":
        values = np.char.decode(values, "utf-8", "replace")
    values = values if values.dtype.kind == "U" else values.astype(float)
    return Recorded(signal.name, np.asarray(signal.timestamps, dtype=float), values, str(signal.unit or ""))


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


def read_ulog(path: Path) -> Read:
    """Read the fields of all topics as `topic.field`, put on the clock of the fastest topic."""
    pyulog = library("pyulog", "ulog", path)
    # Opened here: the library would leave the file open after an error.
    with reading(path, "ULog file"), path.open("rb") as stream:
        require_room_for_numbers(path, path.stat().st_size // 8, path.stat().st_size // 8)
        file = pyulog.ULog(stream)
        channels: list[Recorded] = []
        for topic in file.data_list:
            name = f"{topic.name}#{topic.multi_id + 1}" if topic.multi_id else str(topic.name)
            if "timestamp" not in topic.data:
                continue
            time = 1e-6 * np.asarray(topic.data["timestamp"], dtype=float)
            channels += [
                Recorded(f"{name}.{field}", time, np.asarray(values, dtype=float))
                for field, values in topic.data.items()
                if field != "timestamp" and np.asarray(values).dtype.kind in "biuf"
            ]
        notes = ["the file is damaged in places, which are left out"] if file.file_corruption else []
        return on_one_clock(channels, path, notes)


_NUMBERS = {"boolean": "?", "int64": "<i8", "float": "<f4", "double": "<f8"}
_STARTS = b"\0"
"""A record about the log itself that begins an entry."""


@dataclass
class _Entry:
    """A signal of the log: its name and type, times [us] and payloads."""

    name: str
    kind: str
    times: list[int] = field(default_factory=list)
    values: list[bytes] = field(default_factory=list)


def read_wpilog(path: Path) -> Read:
    """Read the entries of numbers and text, put on the clock of the fastest; lists by their places from 1."""
    with reading(path, "WPILib data log"):
        data = path.read_bytes()
        require_room_for_numbers(path, len(data) // 12, len(data) // 12)
        entries, notes = _entries(memoryview(data))
        channels: list[Recorded] = []
        left_out: list[str] = []
        for entry in entries:
            found = list(_channels(entry))
            channels += found
            if not found and entry.times:
                left_out.append(f"{entry.name} ({entry.kind})")
        if left_out:
            notes.append(f"left out, of types that are neither numbers nor text: {few(left_out, 5)}")
        return on_one_clock(channels, path, notes)


def _entries(data: memoryview) -> tuple[list[_Entry], list[str]]:
    """The entries with their records, and what is damaged."""
    if bytes(data[:6]) != b"WPILOG" or len(data) < 12:
        raise DamagedError("it does not begin with WPILOG")
    at = 12 + int.from_bytes(data[8:12], "little")
    known: dict[int, _Entry] = {}
    found: list[_Entry] = []
    while at < len(data):
        lengths = data[at]
        sizes = 1 + (lengths & 3), 1 + (lengths >> 2 & 3), 1 + (lengths >> 4 & 7)
        ends = at + 1 + sizes[0], at + 1 + sizes[0] + sizes[1], at + 1 + sum(sizes)
        number, size, time = (
            int.from_bytes(data[end - n : end], "little") for end, n in zip(ends, sizes, strict=True)
        )
        if ends[2] + size > len(data):
            return found, ["the file breaks off in its last record, which is left out"]
        payload = data[ends[2] : ends[2] + size]
        at = ends[2] + size
        if number:
            if number in known:
                known[number].times.append(time)
                known[number].values.append(bytes(payload))
        elif size and bytes(payload[:1]) == _STARTS:
            (own,) = struct.unpack_from("<I", payload, 1)
            name, rest = _text(payload[5:])
            kind, _ = _text(rest)
            known[own] = _Entry(name, kind)
            found.append(known[own])
    return found, []


def _text(data: memoryview) -> tuple[str, memoryview]:
    (size,) = struct.unpack_from("<I", data, 0)
    return bytes(data[4 : 4 + size]).decode(errors="replace"), data[4 + size :]


def _channels(entry: _Entry) -> Iterator[Recorded]:
    """The signals of an entry: one, one for each place of its lists, or none."""
    if not entry.times:
        return
    name = entry.name.removeprefix("NT:").strip("/")
    kind = _NUMBERS.get(entry.kind.removesuffix("[]"))
    if kind is None:
        if entry.kind == "string":
            texts: Any = column_of([value.decode(errors="replace") for value in entry.values])
            yield Recorded(name, 1e-6 * np.array(entry.times, dtype=float), texts)
        return
    size = np.dtype(kind).itemsize
    # A list of another length than most has other places: its record is left out.
    lengths: dict[int, int] = defaultdict(int)
    for value in entry.values:
        lengths[len(value)] += 1
    usual = max(lengths, key=lambda n: lengths[n])
    rows = [k for k, value in enumerate(entry.values) if len(value) == usual]
    if not usual or usual % size or usual // size > limits.MOST_PARTS:
        return
    time = 1e-6 * np.array([entry.times[k] for k in rows], dtype=float)
    table = np.frombuffer(b"".join(entry.values[k] for k in rows), kind).reshape(len(rows), -1)
    for k, column in enumerate(table.T.astype(float), start=1):
        yield Recorded(f"{name}({k})" if entry.kind.endswith("[]") else name, time, column)


_KEY = re.compile(r"(\d+)\.(Variable|Data)\s*;\s*(.*)")
_TIME = "time"


def read_codesys(path: Path) -> Read:
    """Read the variables of a trace, put on the clock of the one with the most rows."""
    text = text_of(path)
    require_room_for_text(path, text, text.count("\n"), 2 * text.count("\n"))
    names: dict[str, str] = {}
    rows: dict[str, list[list[str]]] = {}
    block = ""
    for line in text.splitlines():
        if found := _KEY.match(line):
            number, key, value = found.groups()
            block = number if key == "Data" else ""
            if key == "Variable":
                names[number] = value.strip()
        elif line.startswith(";") and block:
            rows.setdefault(block, []).append([cell.strip() for cell in line.split(";")[1:]])
        elif line.strip():
            block = ""
    channels = [
        Recorded(names.get(number, f"variable {number}"), *_columns(pairs, path))
        for number, pairs in rows.items()
    ]
    read = on_one_clock(
        channels, path, ("a trace of CODESYS: a block of time and value for each variable",), _TIME
    )
    # A trace does not say of which unit its time is.
    return Read(read.columns, notes=read.notes, units={n: u for n, u in read.units.items() if n != _TIME})


def _columns(pairs: list[list[str]], path: Path) -> tuple[np.ndarray, np.ndarray]:
    whole = [pair[:2] for pair in pairs if len(pair) >= 2]
    times = column_of([time for time, _ in whole])
    if times.dtype.kind != "f":
        raise InputError(path, "a number for the time of every row of a trace", "text")
    return times, column_of([{"TRUE": "1", "FALSE": "0"}.get(value, value) for _, value in whole])
