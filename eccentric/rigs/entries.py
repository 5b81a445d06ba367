"""Entries of a rig file by kind: numbers, ranges, intervals, names, tables, and the allowed keys.

`where` opens the message of every InputError: file and key.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from eccentric.errors import InputError, meant

if TYPE_CHECKING:
    from collections.abc import Iterable


def read_number(value: object, where: str, lower: float = -math.inf, open_below: bool = False) -> float:
    """Return a finite number, at least (or above) `lower`; InputError for anything else, including true."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{where}: a number is required, received {value!r}")
    number = float(value) if abs(value) < 1e300 else math.inf
    if not math.isfinite(number) or number < lower or (open_below and number == lower):
        bound = "" if math.isinf(lower) else f" {'above' if open_below else 'of at least'} {lower:g}"
        raise InputError(f"{where}: a finite number{bound} is required, received {value!r}")
    return number


def read_pair(value: object, where: str) -> tuple[Any, Any]:
    """Return the two ends of a range, unchanged; InputError for anything but a list of two."""
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(f"{where}: a range of two values, [lower, upper], is required, received {value!r}")
    return value[0], value[1]


def read_intervals(value: object, where: str) -> tuple[tuple[float, float], ...]:
    """Return a list of intervals (start, end), each start before its end; InputError for anything else."""
    if not isinstance(value, list):
        raise InputError(f"{where}: a list of [start, end] is required, received {value!r}")
    intervals: list[tuple[float, float]] = []
    for pair in value:
        start, end = (read_number(end, where) for end in read_pair(pair, where))
        if start >= end:
            raise InputError(f"{where}: intervals with start before end are required, received {pair!r}")
        intervals.append((start, end))
    return tuple(intervals)


def read_names(value: object, where: str) -> tuple[str, ...]:
    """Return a list of names; InputError for anything else."""
    if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
        raise InputError(f"{where}: a list of names is required, received {value!r}")
    return tuple(value)


def plain_entries(value: object, where: str) -> Mapping[str, Any]:
    """Return a rig in memory as a file would have it: lists for tuples, Python numbers for NumPy ones.

    Raises InputError for anything that a file cannot contain.
    """
    if not isinstance(value, Mapping):
        raise InputError(f"{where}: a path, a mapping or a Rig is required, received {type(value).__name__}")
    try:
        return json.loads(json.dumps(dict(value), default=_plain))
    except (TypeError, ValueError, RecursionError) as error:
        raise InputError(f"{where}: the content of a JSON file is required ({error})") from None


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return dict(value)
    if hasattr(value, "tolist"):  # arrays and numbers of NumPy
        return value.tolist()
    raise TypeError(f"received {type(value).__name__}")


def read_table(value: object, where: str) -> Mapping[str, Any]:
    """Return a table of the rig file; InputError for anything else."""
    if not isinstance(value, dict):
        raise InputError(f"{where}: a table is required, received {value!r}")
    return value


def refuse_unknown(keys: Iterable[str], allowed: Iterable[str], where: str) -> None:
    """Raise InputError for the first key that is not allowed, with the closest one that is."""
    allowed = list(allowed)
    for key in keys:
        if key not in allowed:
            hint = meant(key, allowed) or f"; known are {', '.join(allowed)}"
            raise InputError(f"{where}: unknown key {key!r}{hint}")
