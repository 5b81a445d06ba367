"""What a motion may not exceed, on the motor side: a table of a TOML or JSON file, or a mapping like it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from eccentric.entries import read_document, read_number, refuse_unknown
from eccentric.errors import InputError
from eccentric.logs import parse_value
from eccentric.places import given_path
from eccentric.planning.limits import LEAST_TIME_S
from eccentric.rigs import plain_entries, read_pair

__all__ = ["Bounds", "read_bounds"]

UNITS = {
    "speed_rad_s": "rad/s",
    "acceleration_rad_s2": "rad/s^2",
    "current_A": "A",
    "time_s": "s",
    "angle_rad": "rad",
}


@dataclass(frozen=True)
class Bounds:
    """Limits of a planned motion, motor side.

    Attributes:
        speed, acceleration, current: largest magnitudes [rad/s], [rad/s^2], [A].
        time: length of the motion [s].
        angle: lower and upper end [rad], None for a drive that turns without end.
    """

    speed: float
    acceleration: float
    current: float
    time: float
    angle: tuple[float, float] | None = None


def read_bounds(source: str | os.PathLike[str] | Mapping[str, Any] | Bounds) -> Bounds:
    """Read limits: a file `.toml` or `.json`, or a mapping with its keys.

    Numbers in SI by the names of the keys, or texts with a unit ("3000 rpm", "[-90 deg, 90 deg]" as two).

    Raises InputError, one line with file, key, what is required and what was received.
    """
    if isinstance(source, Bounds):
        return source
    if isinstance(source, str | os.PathLike):
        path = given_path(source, "limits")
        content, where = read_document(path, "a limits file"), str(path)
    else:
        content, where = plain_entries(source, "limits"), "limits"
    refuse_unknown(content, tuple(UNITS), where)
    for key in ("speed_rad_s", "acceleration_rad_s2", "current_A", "time_s"):
        if key not in content:
            raise InputError(f"{where}: {key} is required, received none")
    speed, acceleration, current = (
        _number(content[key], key, where) for key in ("speed_rad_s", "acceleration_rad_s2", "current_A")
    )
    time = _number(content["time_s"], "time_s", where)
    if time < LEAST_TIME_S:
        raise InputError(f"{where}: time_s: at least {LEAST_TIME_S:g} s are required, received {time:g}")
    angle = None
    if "angle_rad" in content:
        low, high = (
            _value(end, "angle_rad", where) for end in read_pair(content["angle_rad"], f"{where}: angle_rad")
        )
        if not low < high:
            raise InputError(
                f"{where}: angle_rad: lower before upper is required, received [{low:g}, {high:g}]"
            )
        angle = low, high
    return Bounds(speed, acceleration, current, time, angle)


def _number(value: object, key: str, where: str) -> float:
    return read_number(_value(value, key, where), f"{where}: {key}", 0.0, True)


def _value(value: object, key: str, where: str) -> float:
    """A number in SI, or a text with its unit."""
    if isinstance(value, str):
        return parse_value(value, UNITS[key], f"{where}: {key}")
    return read_number(value, f"{where}: {key}")
