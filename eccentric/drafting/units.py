"""Units of time, angle and speed at once: names, the slope of the angle, wraps, steps, gravity, sizes.

Each reading is a hypothesis with a weight; what is close to the best one is stated as a doubt.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, few, so_more
from eccentric.drafting import limits
from eccentric.drafting.columns import LoggedColumn, columns_of, nice_counts
from eccentric.drafting.proposal import Proposal, quoted
from eccentric.drafting.words import Name, is_like, is_mass, read_name
from eccentric.logs import Log, falls, mended, parse_unit
from eccentric.signals import UNEVEN_STEP

# The clock of a log and its runs: which column is the time, in which unit, and where a run ends.


Array = NDArray[np.float64]
_NANO = re.compile(r"^(.*?)(nano_?secs?|nsecs?|nanoseconds?)(.*)$")
SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}


@dataclass(frozen=True)
class Clock:
    """Time (n,) as the column has it, its ends of stretches (n-1,), and how likely each unit is.

    `step` is the usual one; `uneven` says how many others there are, "" for few.
    """

    proposal: Proposal
    raw: Array
    breaks: NDArray[np.bool_]
    step: float
    likely: Mapping[str, float]
    uneven: str = ""

    @property
    def unit(self) -> str:
        """The likeliest unit."""
        return max(self.likely, key=lambda unit: self.likely[unit])

    @property
    def rate_hz(self) -> float:
        """The usual number of rows per second."""
        return 1.0 / (self.step * SECONDS[self.unit])


def find_runs(
    columns: Mapping[str, LoggedColumn], texts: Mapping[str, NDArray[np.str_]], rows: int
) -> tuple[Proposal | None, NDArray[np.bool_]]:
    """The column that names runs, and its changes (n-1,): text or whole numbers in few contiguous blocks."""
    found: list[tuple[float, str, NDArray[np.bool_], int]] = []
    for name, values in texts.items():
        quantity = read_name(name).quantity
        # A date is no run: midnight ends none. A text that never changes names one where it is called so.
        if quantity != "time" and (quantity == "run" or np.any(values[1:] != values[:-1])):
            found += _blocks(name, values, rows, 0.5 + (quantity == "run"))
    for name, column in columns.items():
        mass = is_mass(column.name.unit)  # each mass is a run where no column names them
        if mass or ((column.is_whole or column.is_flag) and column.name.quantity in ("run", "")):
            if column.is_constant and column.name.quantity != "run":
                continue
            score = -0.5 + mass + 2.0 * (column.name.quantity == "run")
            found += _blocks(name, column.values, rows, score)
    if not found:
        return None, np.zeros(rows - 1, dtype=bool)
    score, name, changes, count = max(found, key=lambda one: one[0])
    if score < 0.0:
        return None, np.zeros(rows - 1, dtype=bool)
    evidence = f"{count} value{'s' if count > 1 else ''}, each in one block of rows"
    return Proposal("run", name, "", (evidence,), 0.95 if score > 0.4 else 0.7), changes


def _blocks(
    name: str, values: NDArray, rows: int, score: float
) -> list[tuple[float, str, NDArray[np.bool_], int]]:
    changes = values[1:] != values[:-1]
    count = int(np.count_nonzero(changes)) + 1
    if count > limits.FEW_VALUES or rows < 10 * count or len(np.unique(values)) != count:
        return []
    return [(score, name, changes, count)]


def upright(log: Log) -> Log:
    """Return a log in the order of its time: with its last row first, where a column of time falls."""
    clocks = [
        n for n, x in log.columns.items() if x.dtype.kind == "f" and read_name(n, "").quantity == "time"
    ]
    turned = any(falls(log.numbers(name)) for name in clocks)
    return log.rows_of(slice(None, None, -1)) if turned else log


def clock_in(log: Log) -> Clock:
    """Return the clock of a log that nobody has described, by all of its rows.

    Raises:
        InputError: no column rises from row to row.
    """
    return opened(upright(log), log.rows).clock


@dataclass(frozen=True)
class Opened:
    """The columns of a log: numbers and text by name, its runs and the ends of these (n-1,), its clock."""

    columns: Mapping[str, LoggedColumn]
    texts: Mapping[str, NDArray[np.str_]]
    run: Proposal | None
    ends: NDArray[np.bool_]
    clock: Clock


def opened(log: Log, rows: int) -> Opened:
    """Return the columns of the first rows of a log.

    Raises:
        InputError: no column rises from row to row.
    """
    columns, texts = columns_of(log, slice(0, rows))
    columns = _with_nanoseconds(columns)
    run, ends = find_runs(columns, texts, rows)
    could = {n: c for n, c in columns.items() if not c.is_flag and (run is None or n != run.column)}
    return Opened(columns, texts, run, ends, find_clock(could, ends, log.path, texts))


def _with_nanoseconds(columns: Mapping[str, LoggedColumn]) -> dict[str, LoggedColumn]:
    """The columns, with a time in place of one in whole seconds and one in the nanoseconds beyond them.

    Names show such a pair, or the values of two columns side by side without names, as ROS 2 prints them.
    """
    found, timed = dict(columns), any(column.name.quantity == "time" for column in columns.values())
    for before, (name, beyond) in zip((None, *columns.values()), columns.items(), strict=False):
        whole = _NANO.sub(lambda one: one[1] + "sec" + one[3], name)
        named = next((found[n] for n in (whole, f"{whole}s") if n in found and whole != name), None)
        seconds, parts = (named, 1e9) if named else (before, 0.0 if timed else _parts_of(before, beyond))
        if seconds is None or not parts or not (seconds.is_whole and np.all(np.abs(beyond.values) < parts)):
            continue
        text = f"{quoted(seconds.text)} + {quoted(name)} / {parts:.0f}"
        # From the first second: floating point has no nanoseconds of seconds since 1970.
        values = seconds.values - seconds.values[0] + beyond.values / parts
        del found[name], found[seconds.text]
        found[text] = LoggedColumn(Name(text, "time", "s", word="sec"), values)
    return found


_UNNAMED = re.compile(r"column_\d+")


def _parts_of(seconds: LoggedColumn | None, beyond: LoggedColumn) -> float:
    """Into how many parts a column divides the whole seconds of the one before it; 0 where it does not.

    It fills each second, starts again with the next, and together they rise as evenly there as anywhere.
    """
    if seconds is None or not (seconds.is_whole and beyond.is_whole) or len(seconds.values) < 3:
        return 0.0
    if not (_UNNAMED.fullmatch(seconds.text) and _UNNAMED.fullmatch(beyond.text)):
        return 0.0
    steps, highest = np.diff(seconds.values), float(np.max(beyond.values))
    parts = next((parts for parts in (1e3, 1e6, 1e9) if highest < parts), 0.0)
    fills = parts and highest > 0.5 * parts and np.min(beyond.values) >= 0.0
    if not fills or np.any(steps < 0.0) or not np.any(steps) or np.all(steps):
        return 0.0
    rise = steps + np.diff(beyond.values) / parts
    even = abs(np.median(rise[steps > 0.0]) - np.median(rise)) <= 0.5 * np.median(rise)
    return parts if even and np.all(rise > 0.0) else 0.0


def opened_to_draft(log: Log) -> Opened:
    """Return as many rows of a log as a draft looks at. InputError for too few, and as for `opened`."""
    if log.rows < limits.FEWEST_ROWS:
        raise InputError(log.path, f"at least {limits.FEWEST_ROWS} rows", log.rows, why="to draft a rig")
    return opened(log, min(log.rows, limits.MOST_ROWS))


def by_rate(log: Log, rate_hz: float) -> Log:
    """Return a log with a column of time, `time_s`, of so many rows per second.

    Raises:
        InputError: no number above 0, or a log that has this column.
    """
    if not (math.isfinite(rate_hz) and rate_hz > 0.0):
        raise InputError("rate", "a number of rows per second above 0", f"{rate_hz:g}")
    for name, x in log.columns.items():
        said = read_name(name, log.units.get(name, ""))
        timed = x.dtype.kind == "f" and said.quantity == "time" and not _is_counter(said)
        if name == "time_s" or (timed and np.all(np.diff(x) > 0.0)):
            raise InputError(
                log.path,
                "a log without a column of time",
                repr(name),
                why="with a rate",
                hint="leave the rate out",
            )
    return dataclasses.replace(log, columns={"time_s": np.arange(log.rows) / rate_hz, **log.columns})


def _is_counter(name: Name) -> bool:
    """Whether a name is that of a counter, whose unit it does not say."""
    return not name.unit and name.word in ("tick", "ticks", "clock")


def find_clock(
    columns: Mapping[str, LoggedColumn], ends: NDArray[np.bool_], where: str, texts: Iterable[str] = ()
) -> Clock:
    """The clock among the columns; `ends` (n-1,) are those of named runs, `texts` columns of text.

    Raises:
        InputError: no column rises from row to row.
    """
    found = sorted(((_score(column, ends), column) for column in columns.values()), key=lambda one: -one[0])
    said = ""
    if not found or found[0][0] <= 0.0:
        found, ends, said = _put_right(columns, ends)
    if not found:
        spelled = [name for name in texts if read_name(name, "").quantity == "time"]
        if spelled:
            raise InputError(
                where,
                "numbers or times of day (14:05:00.5) for the time",
                f"text in {few(map(repr, spelled))}",
            )
        raise InputError(
            where,
            problem="expected a column that rises from row to row, the time, but the log has none"
            f"{f' ({few(columns, 5)})' if columns else ''}: if its rows are evenly spaced, give the rate in"
            " rows per second, as in --rate 500 (sample_rate_hz = 500 in a rig file)",
        )
    score, column = found[0]
    steps = np.diff(column.values)
    inside = steps[(steps > 0.0) & ~ends]
    usual = float(np.median(inside))
    breaks = ends | (steps <= 0.0) | (steps > limits.GAP * max(usual, float(np.quantile(inside, 0.9))))
    likely = _units(column, usual, float(np.sum(inside)))
    unit = max(likely, key=lambda one: likely[one])
    others = [c.text for s, c in found[1:] if s > 0.8 * score]
    odd = int(np.count_nonzero(np.abs(inside / usual - 1.0) > UNEVEN_STEP)) if usual else 0
    step_said = f"step {usual * SECONDS[unit]:.4g} s, {1 / usual / SECONDS[unit]:.4g} rows/s"
    uneven = (
        f"{odd} of {len(inside)} steps differ from that by more than {100 * UNEVEN_STEP:.0f} %"
        if odd > limits.FEW_STEPS * len(inside)
        else ""
    )
    evidence = ["rises from row to row", step_said, *([uneven] if uneven else [])]
    if column.name.unit:
        evidence.append(f"{column.name.unit} by its name")
    if not said and np.any((steps < 0.0) & ~ends):
        right = mended(column.values)
        starts = np.flatnonzero((np.diff(right.part) > 0) & ~ends) + 2
        if len(starts):
            said = f"time starts again in row {starts[0]}{so_more(len(starts) - 1)}: each recording is a run"
        elif not np.all(right.kept):
            said = f"the time of row {int(np.argmin(right.kept)) + 1} is out of order"
    doubts = [said] if said else []
    doubts += [f"{column.text} or {', '.join(others)}: several columns could be the time"] if others else []
    if column.name.quantity not in ("time", ""):
        doubts.append(f"its name says {column.name.quantity}")
    if _is_counter(column.name):
        doubts.append(f"a counter? taken in {unit}; if it counts rows, give the rate")
    elif likely[unit] < limits.SURE:
        second = sorted(likely, key=lambda one: -likely[one])[1]
        doubts.append(
            f"unit by the rate of rows alone: {second} would be {1 / usual / SECONDS[second]:.3g} rows/s"
        )
    proposal = Proposal("time", column.text, unit, tuple(evidence), likely[unit], "; ".join(doubts))
    return Clock(proposal, column.values, breaks, usual, likely, uneven)


def _put_right(
    columns: Mapping[str, LoggedColumn], ends: NDArray[np.bool_]
) -> tuple[list[tuple[float, LoggedColumn]], NDArray[np.bool_], str]:
    """The columns that are a clock once shared stamps are spread and rows out of order left out, best first.

    Also the ends of runs, with those of recordings of the best, and what was done; none if there is no clock.
    """
    found: list[tuple[float, LoggedColumn, NDArray[np.bool_], str]] = []
    for column in columns.values():
        if column.name.quantity != "time":
            continue  # an angle that wraps rises and starts again as well
        clock = mended(column.values)
        rows, at = np.flatnonzero(clock.kept), np.arange(len(clock.t))
        fine = LoggedColumn(column.name, np.interp(at, rows, clock.t[rows]))
        apart = ends | (np.diff(clock.part) > 0)
        lost = len(at) - len(rows)
        said = [f"groups of {clock.packet[0]} rows share one stamp and are spread evenly"] * bool(
            clock.packet[0]
        )
        said += [f"{lost} rows have a time out of order"] * bool(lost)
        said += [f"time starts again {int(clock.part[-1])} times: each recording is a run"] * bool(
            clock.part[-1]
        )
        score = _score(fine, apart) if lost <= limits.FEW_VALUES else 0.0
        if score > 0.0:
            found.append((score, fine, apart, "; ".join(said)))
    found.sort(key=lambda one: -one[0])
    best = found[0] if found else (0.0, None, ends, "")
    return [(score, column) for score, column, *_ in found], best[2], best[3]


def _score(column: LoggedColumn, ends: NDArray[np.bool_]) -> float:
    steps = np.diff(column.values)[~ends]
    if len(steps) < 2 or column.is_constant:
        return 0.0
    falls = int(np.count_nonzero(steps < 0.0))
    rising = np.count_nonzero(steps > 0.0) / len(steps)
    if falls > limits.FEW_VALUES or rising < (
        0.9 if column.name.quantity == "time" else limits.RISING - 0.01
    ):
        return 0.0
    usual = float(np.median(steps))
    if usual <= 0.0:
        return 0.0
    uneven = float(np.median(np.abs(np.diff(steps)))) / usual
    also = "time" in column.text.lower() or column.name.unit in SECONDS
    other = 0.1 if column.name.weak or column.name.quantity == "other" or also else 0.0
    named = {"time": 3.0, "": 1.0}.get(column.name.quantity, other)
    return named / (1.0 + 4.0 * uneven)


def _units(column: LoggedColumn, step: float, length: float) -> dict[str, float]:
    """How likely each unit of time is: by the name, else by the rate and length that logs of drives have."""
    if column.name.unit in SECONDS:
        return {unit: 0.995 if unit == column.name.unit else 0.00125 for unit in SECONDS}
    weights: dict[str, float] = {}
    for unit, seconds in SECONDS.items():
        rate, duration = 1.0 / (step * seconds), length * seconds
        decades = math.log10(rate / limits.USUAL_HZ) / limits.USUAL_DECADES
        weight = math.exp(-0.5 * decades**2) * {"s": 1.0, "min": 1e-4, "h": 1e-6}.get(unit, 0.5)
        possible = (
            limits.SLOWEST_HZ <= rate <= limits.FASTEST_HZ
            and limits.SHORTEST_S <= duration <= limits.LONGEST_S
        )
        weights[unit] = weight if possible else 1e-4 * weight
    total = sum(weights.values()) or 1.0
    return {unit: weight / total for unit, weight in weights.items()}


TURN = 2.0 * math.pi
_ANGLES = {"rad": 1.0, "deg": TURN / 360.0, "rev": TURN, "mrad": 1e-3}
_SPEEDS = {"rad/s": 1.0, "rpm": TURN / 60.0, "deg/s": TURN / 360.0, "rev/s": TURN}
REGISTER = "0.229 rpm"
"""What one of `present_velocity` is in servos of the series Dynamixel X."""
_OF_REGISTER = re.compile(r"present[ _]?velocity[\W\d_]*$", re.IGNORECASE)
_PRIOR = {
    "rad": 1.0, "deg": 0.7, "counts": 0.6, "rev": 0.1, "mrad": 0.005,
    "rad/s": 1.0, "rpm": 0.7, "deg/s": 0.5, "rev/s": 0.1, "counts/s": 0.1, "0.229 rpm": 1.0,
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
        by_gravity: what of `why` follows from gravity.
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
    by_gravity: tuple[str, ...] = ()


def readings(given: Shown) -> list[Reading]:
    """All readings, best first; their weights add up to 1."""
    angles = [""] if given.angle is None else _units_of(given.angle, [*_ANGLES, "counts"], "rad")
    in_counts = given.speed.name.unit if given.speed and _counts_in(given.speed.name.unit) else "counts/s"
    speeds = [""] if given.speed is None else _units_of(given.speed, [*_SPEEDS, in_counts], "rad/s")
    if given.speed is not None and given.speed.is_whole and _OF_REGISTER.search(given.speed.text):
        speeds = [*speeds, REGISTER]
    found = [
        reading
        for time, angle, speed in itertools.product(given.time, angles, speeds)
        if given.time[time] > 1e-6
        for reading in _read(given, time, angle, speed)
    ]
    total = sum(reading.weight for reading in found) or 1.0
    found = [Reading(**{**reading.__dict__, "weight": reading.weight / total}) for reading in found]
    return sorted(found, key=lambda reading: -reading.weight)


def _units_of(column: LoggedColumn, usual: list[str], like: str) -> list[str]:
    """The units that a motion may be in, with one of its name that is none of the usual, as krpm."""
    said = _SAME.get(column.name.unit, column.name.unit)
    return [*usual, said] if said not in usual and "count" not in said and is_like(said, like) else usual


def _factor(unit: str, usual: Mapping[str, float]) -> float:
    """The SI value of one of a unit of motion; 0 for none and for counts."""
    if unit in ("", "counts") or _counts_in(unit):
        return 0.0
    if unit == REGISTER:
        return 0.229 * usual["rpm"]
    return usual.get(unit) or parse_unit(unit, "").factor


def _counts_in(speed: str) -> float:
    """How many counts per second one of a unit of speed is; 0 for a unit without counts."""
    return parse_unit(speed, "", 1.0).factor / TURN if speed.endswith("counts/s") else 0.0


def _read(given: Shown, time: str, angle: str, speed: str) -> list[Reading]:
    weight = given.time[time]
    why: dict[str, tuple[str, ...]] = {"angle": (), "speed": ()}
    later = SECONDS[given.time_unit] / SECONDS[time]  # slopes per second under this unit of time
    counts, product = 0.0, False
    by_gravity: tuple[str, ...] = ()
    if angle == "counts":
        counts, product, said = _counts(given, speed, later)
        by_gravity += said if product else ()
        why["angle"] += said
    unit = TURN / counts if angle == "counts" and counts else _factor(angle, _ANGLES)
    if angle and given.angle is not None:
        weight *= _named(given.angle, angle)
        if given.angle.name.unit:
            why["angle"] += (f"{given.angle.name.unit} by {_source(given.angle.name)}",)
        factor, said = _shape(given, angle, unit)
        weight *= factor
        why["angle"] += said
    gear = given.period * unit / TURN
    if gear:
        factor, said = _gear(gear, given.turns)
        weight *= factor
        by_gravity += said
        why["angle"] += said
    told, each = given.speed is not None and given.speed.name.unit == speed, _counts_in(speed)
    if told and each and angle != "counts" and given.factor and unit:
        turn = TURN * each * abs(given.factor) / (unit * later)
        counts = nice_counts(turn, limits.SAME_COUNTS) or turn
        why["speed"] += (f"{turn:.6g} counts per turn by the slope of the angle",)
    of_count = TURN / counts if counts else unit
    per = each * of_count if each else _factor(speed, _SPEEDS)
    ratio = 1.0
    if speed and given.speed is not None:
        weight *= 1.0 if _follows(given, angle, speed) else _named(given.speed, speed)
        if given.speed.name.unit:
            why["speed"] += (f"{given.speed.name.unit} by {_source(given.speed.name)}",)
        # Counts of one encoder are compared without their size.
        alike = bool(each) and angle == "counts"
        weight *= 1e-4 if each and angle not in ("", "counts") and not told else 1.0
        if given.factor and (alike or (unit and per)):
            off = abs(given.factor) / later * (each if alike else per / unit)
            factor, ratio, said = _slope(off, given.factor, gear)
            weight *= factor
            why["speed"] += said
    fastest = given.fastest * later * (unit if angle else per) * max(ratio, 1.0)
    if fastest > 0.0:
        decades = math.log10(fastest / limits.USUAL_SPEED) / limits.SPEED_DECADES
        weight *= math.exp(-0.5 * min(decades**2, 16.0))
    return [Reading(time, angle, speed, weight, counts, gear, ratio, product, why, by_gravity)]


def _named(column: LoggedColumn, unit: str) -> float:
    said = _SAME.get(column.name.unit, column.name.unit)
    if said:
        return 1.0 if said == unit else 1e-4
    return _PRIOR[unit] * (
        limits.TURNS_BY_SYMBOL if unit.startswith("rev") and _SYMBOL(column.name.text) else 1.0
    )


_SYMBOL = re.compile(
    r"(?<![a-z])(d{0,2}q|qd{0,2}|qpos|qvel|theta|omega|w|phi|joint_?states?)(?![a-z])", re.IGNORECASE
).search


def _source(name: Name) -> str:
    return f"{name.maker}'s names" if name.maker else "its name"


def _follows(given: Shown, angle: str, speed: str) -> bool:
    """Whether neither name has a unit and the speed is in that of the angle: one choice, not two."""
    named = (given.angle is None or given.angle.name.unit) or (given.speed is None or given.speed.name.unit)
    return not named and speed == f"{angle}/s"


def _counts(given: Shown, speed: str, later: float) -> tuple[float, bool, tuple[str, ...]]:
    """Counts per turn of the shaft of the angle, by what shows it best, and whether a gear may be in them."""
    if given.wrap:
        return given.wrap, False, (f"it restarts every {given.wrap:.6g} counts",)
    if given.factor and (per := _factor(speed, _SPEEDS)):
        turn = TURN * later / (abs(given.factor) * per)
        found = nice_counts(turn, limits.FACTOR) or turn
        return found, False, (f"{turn:.6g} counts per turn by the logged speed",)
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
        if unit and not nice_counts(TURN / unit, limits.FACTOR):
            weight *= limits.ODD_COUNTS
        return weight * (1.0 if unit else 0.2), ("whole numbers",) if column.is_whole else ()
    if given.wrap:
        turns = given.wrap * unit / TURN
        weight *= 1.0 if abs(turns - 1.0) < 0.02 else 0.02
        if abs(turns - 1.0) < 0.02:
            said += (f"it restarts at {given.wrap:.6g}, one turn in {angle}",)
    if given.step and not (column.is_whole and given.step >= 1.0):
        counts = TURN / (given.step * unit)
        power = 2.0 ** round(math.log2(counts)) if counts > 64.0 else 0.0
        usual = bool(power) and abs(counts / power - 1.0) < 1e-3
        nice = power if usual else nice_counts(counts, 1e-3) if counts > 90.0 else 0.0
        weight *= 0.5 if usual else 0.2 if nice else 0.03
        if nice:
            said += (f"its step is one turn over {nice:.0f} in {angle}",)
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
            (f"it is {sign}the slope of the angle, within {max(100 * abs(off - 1), 0.1):.1f} %",),
        )
    for other in (gear, 1.0 / gear if gear else 0.0):
        if other and abs(math.log(off / other)) < 2.0 * limits.FACTOR:
            return 0.05, other, (f"it is the slope of the angle times the gear, {other:.4g}",)
    return 1e-4, off, (f"it is {off:.4g} times the slope of the angle",)


def magnitudes(column: LoggedColumn, quantity: str, largest: float) -> list[tuple[str, float]]:
    """Units of a drive signal with their probabilities: by the name, else by the size that drives have."""
    if column.name.unit and not column.name.is_rated:
        return [(column.name.unit, 0.99)]
    weights: dict[str, float] = {}
    for unit, (usual, decades, weight) in _USUAL[quantity].items():
        off = math.log10(max(largest * _SCALE[unit], 1e-12) / usual) / decades
        weights[unit] = weight * math.exp(-0.5 * off**2)
    total = sum(weights.values()) or 1.0
    return sorted(((unit, weight / total) for unit, weight in weights.items()), key=lambda one: -one[1])
