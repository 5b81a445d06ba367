"""Traces of CODESYS as text: lines of key and value, then for each variable a block of time and value."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from eccentric.core import InputError
from eccentric.logs.assemble import Read, Recorded, column_of, on_one_clock
from eccentric.logs.csv_file import text_of
from eccentric.logs.foreign import require_room_for_text

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
