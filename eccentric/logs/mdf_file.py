"""MDF files of version 3 and 4 by asammdf. Attachments stay closed, formulas are not evaluated."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.core import few
from eccentric.logs.assemble import Read, Recorded, on_one_clock
from eccentric.logs.foreign import library, reading, require_room_for_numbers

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
