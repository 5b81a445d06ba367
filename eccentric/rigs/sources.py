"""What a rig says of its log: the source of each channel, rows, held-out part, alignment."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields

from eccentric.core import InputError, meant, read_table, refuse_unknown
from eccentric.logs import Unit, parse_value, require_unit
from eccentric.model import LINEAR, TURNING, AxisKind
from eccentric.rigs.entries import read_names

CHANNELS = {
    "time": ("time_s", "s"),
    "theta_m": ("theta_m_rad", "rad"),
    "theta_l": ("theta_l_rad", "rad"),
    "omega_m": ("omega_m_rad_s", "rad/s"),
    "omega_l": ("omega_l_rad_s", "rad/s"),
    "voltage": ("voltage_V", "V"),
    "current": ("current_A", "A"),
    "torque": ("torque_Nm", "N m"),
    "torque_l": ("torque_l_Nm", "N m"),
    "temperature": ("temperature_C", "degC"),
    "run": ("run", ""),
    "use": ("use", ""),
    "motor_off": ("motor_off", ""),
}
"""Channel: (its standard column, its unit). _m is on the motor side, _l on the link side."""

_ANYWHERE = ("time", "voltage", "current", "temperature", "run", "use", "motor_off")
_BY_AXIS = {
    TURNING: CHANNELS,
    LINEAR: {
        "theta_m": ("position_m", "m"),
        "omega_m": ("velocity_m_s", "m/s"),
        "torque": ("force_N", "N"),
        **{channel: CHANNELS[channel] for channel in _ANYWHERE},
    },
}
_GAINS = {"N": ("N/V", "N/A")}
"""Units of a gain, by the unit of what it gives: a force from the reference of an amplifier."""


def gain_of(required: str, unit: str) -> str:
    """The unit of the gain that makes this unit, of volts or amperes, the required one; "" for none."""
    per = _GAINS.get(required, ())
    return next((of for of in per if re.fullmatch(f"[a-zµ]?{of[-1]}", unit)), "")


def channels_of(axis: AxisKind) -> dict[str, tuple[str, str]]:
    """The channels of an axis, as CHANNELS; a rig file calls them by the words of the axis."""
    return _BY_AXIS[axis]


@dataclass(frozen=True)
class ForceGain:
    """A gain [`unit`], and the unit of the column that it converts, None where the rig gives none."""

    value: float
    unit: str
    column: str | None


@dataclass(frozen=True)
class ColumnSource:
    """The source of a channel: a column name or arithmetic on columns, its unit (None: SI), its gain."""

    text: str
    unit: Unit | None = None
    gain: ForceGain | None = None


def _ignored(name: str, listed: Sequence[str], standard: Iterable[str]) -> str:
    """The warning of a listed column that is no channel, with the channel that may be meant."""
    hint = meant(name, standard)
    # What is listed as well is not meant.
    taken = any(repr(other) in hint for other in listed)
    return f"column {name!r} is not a channel, ignored{'' if taken else hint}"


def read_columns(
    value: object, where: str, counts: float | None, axis: AxisKind = TURNING
) -> tuple[dict[str, ColumnSource] | None, list[str]]:
    """Return sources by channel, and warnings; a list names standard columns, as in the sidecars."""
    channels = channels_of(axis)
    if value is None:
        return None, []
    if isinstance(value, list):
        standard = {column: channel for channel, (column, _) in channels.items()}
        names = read_names(value, where)
        ignored = [_ignored(name, names, standard) for name in names if name not in standard]
        return {standard[name]: ColumnSource(name) for name in names if name in standard}, ignored
    columns: dict[str, ColumnSource] = {}
    table = read_table(value, where)
    by_name = {axis.named(channel): channel for channel in channels}
    refuse_unknown(table, by_name, where)
    for name, source in table.items():
        channel, at = by_name[name], f"{where} {name}"
        required = channels[channel][1]
        entry = {"column": source} if isinstance(source, str) else read_table(source, at)
        refuse_unknown(entry, ("column", "unit", *(["gain"] if required in _GAINS else [])), at)
        text, unit = entry.get("column"), entry.get("unit")
        if not isinstance(text, str) or not text.strip():
            raise InputError(at, "a column name or arithmetic", f"{text!r}")
        if unit is not None and (not isinstance(unit, str) or not required):
            raise InputError(at, "no unit, or a unit as text", f"{unit!r}")
        gain = None
        if "gain" in entry:
            parsed, gain = _gain(entry["gain"], unit, required, at)
        else:
            parsed = None if unit is None else _own_unit(unit, required, at, counts)
        columns[channel] = ColumnSource(text.strip(), parsed, gain)
    for left, right in (("theta_m", "theta_l"), ("omega_m", "omega_l"), ("torque", "torque_l")):
        if left in columns and right in columns:
            raise InputError(where, f"only one of {left} and {right}", "both", keys=(left, right))
    measured: dict[str, str] = {}
    for channel, source in columns.items():
        if channels[channel][1] and (other := measured.setdefault(source.text, channel)) != channel:
            raise InputError(
                where,
                "a column of its own",
                f"{source.text!r} for both",
                why=f"for {axis.named(other)} and {axis.named(channel)}",
                keys=(other, channel),
            )
    return columns, []


def _own_unit(unit: str, required: str, where: str, counts: float | None) -> Unit:
    """The unit of a column without a gain; InputError says where a gain would do."""
    try:
        return require_unit(unit, required, where, counts)
    except InputError as error:
        per = gain_of(required, unit)
        hint = f'of an amplifier\'s reference give the gain, as in gain = "35 {per}"' if per else ""
        raise error.hinted(hint) from None


def _gain(gain: object, unit: str | None, required: str, where: str) -> tuple[Unit, ForceGain]:
    """The unit of a column that a gain converts: the unit of the column, V or A, times the gain; and that."""
    units = _GAINS[required]
    if not isinstance(gain, str):
        raise InputError(where, "a gain with its unit", f"{gain!r}", why=f', as in "35 {units[0]}"')
    per = units[1] if unit is not None and unit.endswith("A") else units[0]
    factor = parse_value(gain, per, f"{where} gain")
    if factor == 0.0:
        raise InputError(where, "a gain other than 0", f"{gain!r}")
    column = require_unit(unit or per.removeprefix(f"{required}/"), per.removeprefix(f"{required}/"), where)
    dimension = require_unit(required, required, where).dimension
    converted = Unit(f"{column.text} times {gain}", column.factor * factor, dimension)
    return converted, ForceGain(factor, per, unit)


KINDS = ("sample", "mean", "held")
"""What a row's value can be: a sample at its time, the mean until the next row's time, held until then."""
_OF_KINDS = ("voltage", "current", "torque", "torque_l")


def read_kinds(value: object, where: str, axis: AxisKind = TURNING) -> dict[str, str]:
    """The kinds of the channels of a drive; InputError for another channel or kind."""
    table = read_table(value, where)
    by_name = {axis.named(channel): channel for channel in _OF_KINDS if channel in channels_of(axis)}
    refuse_unknown(table, by_name, where)
    for name, kind in table.items():
        if kind not in KINDS:
            raise InputError(f"{where} {name}", f"one of {', '.join(KINDS)}", f"{kind!r}")
    return {by_name[name]: str(kind) for name, kind in table.items()}


# The parts of a rig: what the log holds, how it becomes rows, what is held out, how it is aligned.


@dataclass(frozen=True)
class LogMap:
    """What the log holds.

    Attributes:
        columns: the source of each channel; None where the standard column names hold.
        drive: what measures the drive torque, "current", "voltage" or "torque"; None: what the log has.
        counts_per_rev: of the encoder of the angle; None where it is not declared.
        sample_rate_hz: as declared; None where it is not.
        runs: names or patterns of the runs that count, empty for all.
        kinds: what the value of a row stands for, of `KINDS`, by channel; one that is not in it is a sample.
        events: whether a row is the time of one turn of the shaft, and no sample.
        by_line: whether an angle that is not logged is the phase of the drive's line once per turn.
    """

    columns: Mapping[str, ColumnSource] | None
    drive: str | None
    counts_per_rev: float | None
    sample_rate_hz: float | None
    runs: tuple[str, ...]
    kinds: Mapping[str, str] = field(default_factory=dict)
    events: bool = False
    by_line: bool = False


@dataclass(frozen=True)
class Sampling:
    """How samples become rows of a fit.

    Attributes:
        low_pass_hz: cut-off of the low pass of the angle.
        low_pass_given: whether the rig names it.
        moving_threshold_rad_s: speed of the motor from which a row moves; None: as the log suggests.
        average_over: time [s] that both sides of the balance are averaged over before they are compared, 0
            for the rows of the log, infinite for whole runs.
    """

    low_pass_hz: float
    low_pass_given: bool
    moving_threshold_rad_s: float | None
    average_over: float

    @property
    def drive_low_pass_hz(self) -> float | None:
        """Cut-off for the measured drive if rows are averages over a time: both pass the same filter."""
        return self.low_pass_hz if self.average_over and math.isfinite(self.average_over) else None


@dataclass(frozen=True)
class NamedHoldout:
    """The held-out part that the rig names: intervals [s] and names or patterns of runs, empty for none."""

    intervals_s: tuple[tuple[float, float], ...]
    runs: tuple[str, ...]


@dataclass(frozen=True)
class Alignment:
    """What is taken out of voltage and angle.

    Attributes:
        input_delay_s: from the logged voltage to the one that acts.
        theta_zero_rad: the logged link angle at which the mass hangs straight down.
        voltage_offset_V: the logged voltage where none acts.
    """

    input_delay_s: float = 0.0
    theta_zero_rad: float = 0.0
    voltage_offset_V: float = 0.0


ALIGNMENT = tuple(field.name for field in fields(Alignment))
"""The keys of an alignment in a rig file."""
