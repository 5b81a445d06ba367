"""Data logs of WPILib, by their published specification ("WPILib Data Log File Format", version 1.0).

The one library that reads them is compiled against the robot's software of one season; the format is six
bytes of header and records of an entry, a time in microseconds and a value.
"""

from __future__ import annotations

import struct
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.core import InputError, few
from eccentric.logs.assemble import Read, Recorded, column_of, on_one_clock
from eccentric.logs.foreign import reading, require_room_for_numbers
from eccentric.logs.limits import MOST_PARTS

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
        entries, notes = _entries(memoryview(data), path)
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


def _entries(data: memoryview, path: Path) -> tuple[list[_Entry], list[str]]:
    """The entries with their records, and what is damaged."""
    if bytes(data[:6]) != b"WPILOG" or len(data) < 12:
        raise InputError(f"{path}: not a valid WPILib data log (it does not begin with WPILOG)")
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
    if not usual or usual % size or usual // size > MOST_PARTS:
        return
    time = 1e-6 * np.array([entry.times[k] for k in rows], dtype=float)
    table = np.frombuffer(b"".join(entry.values[k] for k in rows), kind).reshape(len(rows), -1)
    for k, column in enumerate(table.T.astype(float), start=1):
        yield Recorded(f"{name}({k})" if entry.kind.endswith("[]") else name, time, column)
