"""What a motion may not exceed, on the motor side: a table of a TOML or JSON file, or a mapping like it."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from eccentric.entries import read_document, read_number, refuse_unknown
from eccentric.errors import InputError
from eccentric.logs import parse_value
from eccentric.model import TURNING, AxisKind
from eccentric.places import given_path
from eccentric.planning.limits import LEAST_TIME_S, MOST_TIME_S
from eccentric.rigs import plain_entries, read_pair

__all__ = ["FORCE", "Bounds", "read_bounds"]

FORCE = "force_N"
"""Of a carriage whose log has a force: its limit takes the place of the current's."""
UNITS = {
    "speed_rad_s": "rad/s",
    "acceleration_rad_s2": "rad/s^2",
    "current_A": "A",
    "time_s": "s",
    "angle_rad": "rad",
}
LOOP = "speed_loop_Hz"
"""Numbers only: hertz has no place among the units, see `eccentric.logs`."""


@dataclass(frozen=True)
class Bounds:
    """Limits of a planned motion, motor side.

    Attributes:
        speed, acceleration, current: largest magnitudes [rad/s], [rad/s^2], [A].
        time: length of the motion [s].
        angle: lower and upper end [rad], None for a drive that turns without end.
        by_force: whether the limit of the current is one of the force [N], at a force constant of 1 N/A.
        loop_hz: bandwidth of the drive's speed loop [Hz], None if it is not known.

    Of a carriage, radians are metres.
    """

    speed: float
    acceleration: float
    current: float
    time: float
    angle: tuple[float, float] | None = None
    by_force: bool = False
    loop_hz: float | None = None


def read_bounds(
    source: str | os.PathLike[str] | Mapping[str, Any] | Bounds, axis: AxisKind = TURNING
) -> Bounds:
    """Read limits: a file `.toml` or `.json`, or a mapping with its keys, by the names of the axis.

    Numbers in SI by the names of the keys, or texts with a unit ("3000 rpm", "[-90 deg, 90 deg]" as two).

    Raises InputError, one line with file, key, what is required and what was received, for all keys at once.
    """
    if isinstance(source, Bounds):
        return source
    if isinstance(source, str | os.PathLike):
        path = given_path(source, "limits")
        content, where = read_document(path, "a limits file"), str(path)
    else:
        content, where = plain_entries(source, "limits"), "limits"
    units = {axis.said(key): axis.said(unit) for key, unit in UNITS.items()}
    angle, speed, acceleration = (
        axis.said(key) for key in ("angle_rad", "speed_rad_s", "acceleration_rad_s2")
    )
    by_force = not axis.wraps and FORCE in content
    if not axis.wraps:
        units |= {FORCE: "N"}
    strength = FORCE if by_force else "current_A"
    required = (speed, acceleration, strength, "time_s")
    complaints: list[str] = []
    values: dict[str, Any] = {}

    def attempt(read: Callable[[], Any], key: str = "") -> None:
        try:
            values[key] = read()
        except InputError as error:
            complaints.append(str(error).removeprefix(f"{where}: "))

    for key in content:
        attempt(partial(refuse_unknown, (key,), (*units, LOOP), where))
    beside = {} if axis.wraps else {"current_A": f" or {FORCE}"}
    complaints += [
        f"{key}{beside.get(key, '')} is required, received none" for key in required if key not in content
    ]
    if by_force and "current_A" in content:
        complaints.append(f"only one of current_A and {FORCE} is required, received both")
    for key in required:
        if key in content:
            attempt(partial(_number, content[key], key, where, units), key)
    if LOOP in content:
        attempt(partial(read_number, content[LOOP], f"{where}: {LOOP}", 0.0, True), LOOP)
    if angle in content:
        attempt(partial(_ends, content[angle], angle, where, units), angle)
    if values.get("time_s", LEAST_TIME_S) < LEAST_TIME_S:
        complaints.append(f"time_s: at least {LEAST_TIME_S:g} s are required, received {values['time_s']:g}")
    if values.get("time_s", LEAST_TIME_S) > MOST_TIME_S:
        complaints.append(f"time_s: at most {MOST_TIME_S:g} s are required, received {values['time_s']:g}")
    if complaints:
        raise InputError(f"{where}: {'; '.join(complaints)}")
    return Bounds(
        values[speed],
        values[acceleration],
        values[strength],
        values["time_s"],
        values.get(angle),
        by_force,
        values.get(LOOP),
    )


def _ends(value: object, key: str, where: str, units: Mapping[str, str]) -> tuple[float, float]:
    low, high = (_value(end, key, where, units) for end in read_pair(value, f"{where}: {key}"))
    if not low < high:
        raise InputError(f"{where}: {key}: lower before upper is required, received [{low:g}, {high:g}]")
    return low, high


def _number(value: object, key: str, where: str, units: Mapping[str, str]) -> float:
    return read_number(_value(value, key, where, units), f"{where}: {key}", 0.0, True)


def _value(value: object, key: str, where: str, units: Mapping[str, str]) -> float:
    """A number in SI, or a text with its unit."""
    if isinstance(value, str):
        return parse_value(value, units[key], f"{where}: {key}")
    return read_number(value, f"{where}: {key}")
