"""Units of time, angle and speed at once: names, the slope of the angle, wraps, steps, gravity, sizes.

Each reading is a hypothesis with a weight; what is close to the best one is stated as a doubt.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from eccentric.drafting import limits
from eccentric.drafting.clock import SECONDS
from eccentric.drafting.columns import LoggedColumn, nice_counts

__all__ = ["Reading", "Shown", "magnitudes", "readings"]

TURN = 2.0 * math.pi
_ANGLES = {"rad": 1.0, "deg": TURN / 360.0, "rev": TURN, "mrad": 1e-3}
_SPEEDS = {"rad/s": 1.0, "rpm": TURN / 60.0, "deg/s": TURN / 360.0, "rev/s": TURN}
_PRIOR = {
    "rad": 1.0, "deg": 0.7, "counts": 0.6, "rev": 0.1, "mrad": 0.005,
    "rad/s": 1.0, "rpm": 0.7, "deg/s": 0.5, "rev/s": 0.1, "counts/s": 0.1,
}  # fmt: skip
_SAME = {"turn": "rev", "degree": "deg", "degrees": "deg", "°": "deg", "turn/s": "rev/s"}
_USUAL = {
    "current": {"A": (3.0, 0.9, 1.0), "mA": (3.0, 0.9, 0.5)},
    "voltage": {"V": (15.0, 0.5, 1.0), "mV": (15.0, 0.5, 0.3)},
    "torque": {"N m": (1.0, 1.2, 1.0), "mNm": (0.1, 1.2, 0.5)},
}
"""Largest value in SI that a drive usually has, its spread in decades, and how usual the unit is."""
_COMMON = (4096.0, 8192.0, 16384.0, 2000.0, 4000.0, 2048.0, 1024.0, 65536.0)
"""Counts per turn of the encoders that are used most."""
_SCALE = {"A": 1.0, "mA": 1e-3, "V": 1.0, "mV": 1e-3, "N m": 1.0, "mNm": 1e-3}


@dataclass(frozen=True)
class Shown:
    """What the values show, in the units of the columns; 0 for what they do not.

    Attributes:
        time: how likely each unit of time is.
        time_unit: the one that `factor` and `fastest` were computed with.
        angle, speed: the columns, None where the log has none.
        factor: logged speed over the slope of the angle.
        wrap: period at which the angle restarts; `step` its smallest step.
        period: of gravity, `turns` how many are in the travel.
        fastest: 95th percentile of the slope of the angle, or of the speed without an angle, per second.
    """

    time: Mapping[str, float]
    time_unit: str
    angle: LoggedColumn | None
    speed: LoggedColumn | None
    factor: float = 0.0
    wrap: float = 0.0
    step: float = 0.0
    period: float = 0.0
    turns: float = 0.0
    fastest: float = 0.0


@dataclass(frozen=True)
class Reading:
    """Units that agree, their weight, what supports them, and what they mean.

    Attributes:
        counts: per turn of the shaft of the angle, where it is in counts; 0 if unknown.
        gear: turns of the shaft of the angle for one of the link, by gravity; 0 without gravity.
        ratio: of the shaft of the speed to that of the angle, 1 where they are one.
        product: whether the log shows counts per turn and gear only as their product.
    """

    time: str
    angle: str
    speed: str
    weight: float
    counts: float = 0.0
    gear: float = 0.0
    ratio: float = 1.0
    product: bool = False
    why: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def readings(given: Shown) -> list[Reading]:
    """All readings, best first; their weights add up to 1."""
    angles = [""] if given.angle is None else [*_ANGLES, "counts"]
    speeds = [""] if given.speed is None else [*_SPEEDS, "counts/s"]
    found = [
        reading
        for time, angle, speed in itertools.product(given.time, angles, speeds)
        if given.time[time] > 1e-6
        for reading in _read(given, time, angle, speed)
    ]
    total = sum(reading.weight for reading in found) or 1.0
    found = [Reading(**{**reading.__dict__, "weight": reading.weight / total}) for reading in found]
    return sorted(found, key=lambda reading: -reading.weight)


def _read(given: Shown, time: str, angle: str, speed: str) -> list[Reading]:
    weight = given.time[time]
    why: dict[str, tuple[str, ...]] = {"angle": (), "speed": ()}
    later = SECONDS[given.time_unit] / SECONDS[time]  # slopes per second under this unit of time
    counts, product = 0.0, False
    if angle == "counts":
        counts, product, said = _counts(given, speed, later)
        why["angle"] += said
    unit = TURN / counts if counts else _ANGLES.get(angle, 0.0)
    if angle and given.angle is not None:
        weight *= _named(given.angle, angle)
        if given.angle.name.unit:
            why["angle"] += (f"{given.angle.name.unit} by its name",)
        factor, said = _shape(given, angle, unit)
        weight *= factor
        why["angle"] += said
    gear = given.period * unit / TURN
    if gear:
        factor, said = _gear(gear, given.turns)
        weight *= factor
        why["angle"] += said
    per = unit if speed == "counts/s" else _SPEEDS.get(speed, 0.0)
    ratio = 1.0
    if speed and given.speed is not None:
        weight *= _named(given.speed, speed)
        if given.speed.name.unit:
            why["speed"] += (f"{given.speed.name.unit} by its name",)
        if given.factor and unit and per:
            off = abs(given.factor) * per / (unit * later)
            factor, ratio, said = _slope(off, given.factor, gear)
            weight *= factor
            why["speed"] += said
    fastest = given.fastest * later * (unit if angle else per)
    if fastest > 0.0:
        decades = math.log10(fastest / limits.USUAL_SPEED) / limits.SPEED_DECADES
        weight *= math.exp(-0.5 * min(decades**2, 16.0))
    return [Reading(time, angle, speed, weight, counts, gear, ratio, product, why)]


def _named(column: LoggedColumn, unit: str) -> float:
    said = _SAME.get(column.name.unit, column.name.unit)
    if said:
        return 1.0 if said == unit else 1e-4
    return _PRIOR[unit]


def _counts(given: Shown, speed: str, later: float) -> tuple[float, bool, tuple[str, ...]]:
    """Counts per turn of the shaft of the angle, by what shows it best, and whether a gear may be in them."""
    if given.wrap:
        return given.wrap, False, (f"it restarts every {given.wrap:.6g} counts",)
    if given.factor and speed in _SPEEDS:
        turn = TURN * later / (abs(given.factor) * _SPEEDS[speed])
        found = nice_counts(turn, limits.FACTOR) or turn
        return found, False, (f"by the logged speed a turn has {turn:.6g} counts",)
    if given.period:
        # A turn of the link is counts times gear: a usual encoder behind the smallest whole gear.
        gears = range(1, limits.MOST_TURNS)
        fits = ((g, nice_counts(given.period / g, 2e-3)) for g in gears)
        powers = [(g, n) for g, n in fits if n in _COMMON]
        found = powers[0][1] if powers else nice_counts(given.period, 0.01) or float(round(given.period))
        return found, True, (f"gravity repeats every {given.period:.6g} counts",)
    return 0.0, False, ()


def _shape(given: Shown, angle: str, unit: float) -> tuple[float, tuple[str, ...]]:
    """What wraps and steps of the angle say of its unit."""
    column, weight, said = given.angle, 1.0, ()
    if column is None:
        return weight, said
    if angle == "counts":
        weight *= 1.0 if column.is_whole else 1e-5
        return weight * (1.0 if unit else 0.2), ("whole numbers",) if column.is_whole else ()
    if given.wrap:
        turns = given.wrap * unit / TURN
        weight *= 1.0 if abs(turns - 1.0) < 0.02 else 0.02
        if abs(turns - 1.0) < 0.02:
            said += (f"it restarts at {given.wrap:.6g}, one turn in {angle}",)
    if given.step and not (column.is_whole and given.step >= 1.0):
        counts = TURN / (given.step * unit)
        power = 2.0 ** round(math.log2(counts)) if counts > 64.0 else 0.0
        if power and abs(counts / power - 1.0) < 1e-3:
            weight, said = weight * 0.5, (*said, f"its step is one turn over {power:.0f} in {angle}")
        elif counts > 90.0 and (nice := nice_counts(counts, 1e-3)):
            weight, said = weight * 0.2, (*said, f"its step is one turn over {nice:.0f} in {angle}")
        else:
            weight *= 0.03
    elif column.is_whole and given.step >= 1.0:
        weight *= 0.01
    return weight, said


def _gear(gear: float, turns: float) -> tuple[float, tuple[str, ...]]:
    """What the period of gravity says: `gear` turns of this shaft for one of the link."""
    tolerance = 0.01 if turns > 3.0 else 0.06 if turns > 0.6 else 0.25
    if abs(gear - 1.0) < tolerance:
        return 1.0, ("gravity repeats once per turn of it",)
    whole = round(gear)
    if 2 <= whole <= limits.MOST_TURNS and abs(gear / whole - 1.0) < min(tolerance, 0.1 / whole):
        return 0.3, (f"gravity repeats every {whole} turns of it: a gear of {whole}:1",)
    return (0.03 if gear > 1.0 else 0.005), (f"gravity repeats every {gear:.4g} turns of it",)


def _slope(off: float, factor: float, gear: float) -> tuple[float, float, tuple[str, ...]]:
    """What the ratio of logged speed and slope says; `off` is 1 where both have one shaft and these units."""
    scatter = math.log(off) / limits.FACTOR
    if abs(scatter) < 4.0:
        sign = "minus " if factor < 0.0 else ""
        return (
            math.exp(-0.5 * scatter**2),
            1.0,
            (f"it is {sign}the slope of the angle, within {100 * abs(off - 1):.1f} %",),
        )
    for other in (gear, 1.0 / gear if gear else 0.0):
        if other and abs(math.log(off / other)) < 2.0 * limits.FACTOR:
            return 0.05, other, (f"it is the slope of the angle times the gear, {other:.4g}",)
    return 1e-4, off, (f"it is {off:.4g} times the slope of the angle",)


def magnitudes(column: LoggedColumn, quantity: str, largest: float) -> list[tuple[str, float]]:
    """Units of a drive signal with their probabilities: by the name, else by the size that drives have."""
    if column.name.unit and column.name.unit != "%":
        return [(column.name.unit, 0.99)]
    weights: dict[str, float] = {}
    for unit, (usual, decades, weight) in _USUAL[quantity].items():
        off = math.log10(max(largest * _SCALE[unit], 1e-12) / usual) / decades
        weights[unit] = weight * math.exp(-0.5 * off**2)
    total = sum(weights.values()) or 1.0
    return sorted(((unit, weight / total) for unit, weight in weights.items()), key=lambda one: -one[1])
