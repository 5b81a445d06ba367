"""Entries of a rig file by kind: ranges, intervals, names; numbers, tables and keys are those of any file.

`where` opens the message of every InputError: file and key.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from eccentric.core import InputError, meant, read_number
from eccentric.model import DRIVE_PARTS, NO_PART


def read_pair(value: object, where: str) -> tuple[Any, Any]:
    """Return the two ends of a range, unchanged; InputError for anything but a list of two."""
    if not isinstance(value, list) or len(value) != 2:
        known = "a value that is known goes under [known]" if isinstance(value, str | int | float) else ""
        raise InputError(where, "a range of two values, [lower, upper]", f"{value!r}", hint=known)
    return value[0], value[1]


def read_intervals(value: object, where: str) -> tuple[tuple[float, float], ...]:
    """Return a list of intervals (start, end), each start before its end; InputError for anything else."""
    if not isinstance(value, list):
        raise InputError(where, "a list of [start, end]", f"{value!r}")
    intervals: list[tuple[float, float]] = []
    for pair in value:
        start, end = (read_number(end, where) for end in read_pair(pair, where))
        if start >= end:
            raise InputError(where, "intervals with start before end", f"{pair!r}")
        intervals.append((start, end))
    return tuple(intervals)


def read_names(value: object, where: str) -> tuple[str, ...]:
    """Return a list of names; InputError for anything else."""
    if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
        raise InputError(where, "a list of names", f"{value!r}")
    return tuple(value)


def read_parts(content: Mapping[str, Any], where: str) -> dict[str, tuple[str, ...]]:
    """Return what the drive is made of, by kind of part: words of `DRIVE_PARTS`, several joined by "+".

    Raises InputError for any other word, and for "none" beside one.
    """
    found: dict[str, tuple[str, ...]] = {}
    for kind in (kind for kind in DRIVE_PARTS if kind in content):
        value, at, known = content[kind], f"{where}: {kind}", ", ".join(DRIVE_PARTS[kind])
        words = tuple(word.strip() for word in value.split("+")) if isinstance(value, str) else (value,)
        if wrong := [word for word in words if word not in DRIVE_PARTS[kind]]:
            raise InputError(at, f"one of {known}", f"{wrong[0]!r}{meant(wrong[0], DRIVE_PARTS[kind])}")
        if NO_PART in words and len(words) > 1:
            raise InputError(at, f"one of {known}, or several joined by +", f"{value!r}")
        found[kind] = words
    return found


def plain_entries(value: object, where: str) -> Mapping[str, Any]:
    """Return a rig in memory as a file would have it: lists for tuples, Python numbers for NumPy ones.

    Raises InputError for anything that a file cannot contain.
    """
    if not isinstance(value, Mapping):
        raise InputError(where, "a path, a mapping or a Rig", type(value).__name__)
    try:
        return json.loads(json.dumps(dict(value), default=_plain))
    except (TypeError, ValueError, RecursionError) as error:
        raise InputError(where, problem=f"expected the content of a JSON file ({error})") from None


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return dict(value)
    if hasattr(value, "tolist"):  # arrays and numbers of NumPy
        return value.tolist()
    raise TypeError(f"got {type(value).__name__}")
