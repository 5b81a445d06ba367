"""What the user knows of the test bench: a TOML or JSON file, checked and in SI.

The sidecars `rotlink-log/1` are rigs as they stand. A file by hand looks like `examples/rigs/*.toml`.
"""

from __future__ import annotations

import json
import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import sympy as sp

from eccentric.errors import InputError
from eccentric.identify.known import (
    find_known,
    read_number,
    read_pair,
    read_table,
    read_value,
    refuse_unknown,
)
from eccentric.identify.units import Unit, parse_value, require_unit
from eccentric.model import vocabulary

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

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
"""Channel: (its column where the rig maps none, its unit). _m is on the motor side, _l on the link side."""

DRIVES = ("current", "voltage", "torque")


@dataclass(frozen=True)
class ColumnSource:
    """Where a channel comes from: a column name or arithmetic on columns, and its unit (None: SI)."""

    text: str
    unit: Unit | None = None


@dataclass(frozen=True)
class Rig:
    """The test bench as the user describes it; numbers in SI, by the paper's letters.

    `known` holds values, `unknown` ranges [lower, upper]; what is in neither is identified along where it
    can be.
    `case` is "C1", "C2" or None for a tilted plane; then `phi` [rad] is in `known` or `unknown`.
    `columns` is None where the standard column names hold. `drive` says what measures the drive torque
    ("current", "voltage", "torque"; None: what the log has). `estimate` names those of input_delay_s,
    theta_zero_rad, voltage_offset_V that the fit has to find. `theta_zero_rad` is the logged link angle at
    which the mass hangs straight down. `runs` and `holdout_runs` are names or patterns of runs, `runs` empty
    for all. `average_over` is a time [s] that both sides of the balance are averaged over before they are
    compared, 0 for the rows of the log, infinite for whole runs.
    """

    path: str
    name: str
    known: Mapping[str, float]
    unknown: Mapping[str, tuple[float, float]]
    case: str | None
    columns: Mapping[str, ColumnSource] | None
    drive: str | None
    counts_per_rev: float | None
    sample_rate_hz: float | None
    low_pass_hz: float
    low_pass_given: bool
    moving_threshold_rad_s: float | None
    holdout_intervals_s: tuple[tuple[float, float], ...]
    holdout_runs: tuple[str, ...]
    runs: tuple[str, ...]
    average_over: float
    input_delay_s: float
    theta_zero_rad: float
    voltage_offset_V: float
    estimate: frozenset[str]
    warnings: tuple[str, ...]

    def value(self, name: str) -> float:
        """Return a known quantity by the paper's letter; InputError, naming the rig, where it is unknown."""
        if name not in self.known:
            raise InputError(f"{self.path}: [known] {name} is required here and is not given")
        return self.known[name]

    @property
    def drive_low_pass_hz(self) -> float | None:
        """Cut-off for the measured drive where rows are averages over a time: both sides pass one filter."""
        return self.low_pass_hz if self.average_over and math.isfinite(self.average_over) else None

    @property
    def model(self) -> str:
        """The name of the model that the case or the tilt asks for."""
        return {"C1": "c1_perpendicular", "C2": "c2_parallel"}.get(self.case or "", "rotating_link")


def read_rig(path: str | Path) -> Rig:
    """Read a rig file, `.toml` or `.json`.

    Raises InputError, one line with file, key, what is required and what came: a missing or damaged file, an
    unknown key or unit, a value that is physically impossible, a contradiction.
    """
    path = Path(path)
    content = _load(path)
    where = str(path)
    refuse_unknown(content, _KEYS, where)
    known, unknown, case = _knowns(content, where)
    counts = _optional(content, "encoder_counts_per_rev", where, 0.0, open_below=True)
    columns, warnings = _columns(content.get("columns"), f"{where}: [columns]", counts)
    drive = content.get("drive")
    if drive is not None and drive not in DRIVES:
        raise InputError(f"{where}: drive: one of {', '.join(DRIVES)} is required, received {drive!r}")
    if known.get("mu", 0.0) > 1.0:
        warnings.append(
            f"mu = {known['mu']:g} is above 1: the link turns faster than the motor (step-up drive)"
        )
    if {"J_l", "M", "L"} <= set(known) and known["J_l"] < (mass := known["M"] * known["L"] ** 2) * (1 - 1e-9):
        warnings.append(
            f"J_l = {known['J_l']:.6g} kg m^2 is less than M L^2 = {mass:.6g} kg m^2, which it includes:"
            " it is the inertia of the whole link about its axis"
        )
    aligned, estimate = _alignment(content, where)
    return Rig(
        path=where,
        name=str(content.get("name", path.stem)),
        known=known,
        unknown=unknown,
        case=case,
        columns=columns,
        drive=drive,
        counts_per_rev=counts,
        sample_rate_hz=_optional(content, "sample_rate_hz", where, 0.0, open_below=True),
        low_pass_hz=_optional(content, "low_pass_hz", where, 0.0, open_below=True) or 25.0,
        low_pass_given="low_pass_hz" in content,
        moving_threshold_rad_s=_optional(content, "moving_threshold_rad_s", where, 0.0),
        holdout_intervals_s=_intervals(
            content.get("holdout_intervals_s", []), f"{where}: holdout_intervals_s"
        ),
        holdout_runs=_names(content.get("holdout_runs", []), f"{where}: holdout_runs"),
        runs=_names(content.get("runs", []), f"{where}: runs"),
        average_over=_average(content.get("average_over"), f"{where}: average_over"),
        estimate=estimate,
        warnings=tuple(warnings),
        **aligned,
    )


_ALIGNMENT = ("input_delay_s", "theta_zero_rad", "voltage_offset_V")
_KEYS = (
    *("format", "name", "log_type", "known", "unknown", "columns", "drive", "encoder_counts_per_rev"),
    *("sample_rate_hz", "low_pass_hz", "moving_threshold_rad_s", "holdout_intervals_s", "holdout_runs"),
    *("runs", "average_over"),
    *_ALIGNMENT,
)


def _load(path: Path) -> Mapping[str, Any]:
    parsers: dict[str, Callable[[str], Any]] = {
        ".toml": tomllib.loads,
        ".json": lambda text: json.loads(text, object_pairs_hook=lambda pairs: _no_repeats(pairs, path)),
    }
    if path.suffix.lower() not in parsers:
        raise InputError(
            f"{path}: a rig file .toml or .json is required, received {path.suffix or 'no suffix'!r}"
        )
    try:
        content = parsers[path.suffix.lower()](path.read_text(encoding="utf-8-sig"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: UTF-8 text is required, byte {error.start} is not") from None
    except InputError:
        raise
    except (ValueError, RecursionError) as error:  # ValueError: also a number of thousands of digits
        raise InputError(f"{path}: no {path.suffix[1:].upper()} file ({error})") from None
    return read_table(content, str(path))


def _no_repeats(pairs: list[tuple[str, Any]], path: Path) -> dict[str, Any]:
    keys = [key for key, _ in pairs]
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice is not None:
        raise InputError(f"{path}: key {twice!r} comes twice")
    return dict(pairs)


def _knowns(
    content: Mapping[str, Any], where: str
) -> tuple[dict[str, float], dict[str, tuple[float, float]], str | None]:
    table = dict(read_table(content.get("known", {}), f"{where}: [known]"))
    case = table.pop("case", None)
    if case not in (None, "C1", "C2"):
        raise InputError(f"{where}: [known] case: C1 or C2 is required, received {case!r}")
    known: dict[str, float] = {}
    for key, value in table.items():
        quantity = find_known(key, value, f"{where}: [known]", ["case"])
        _refuse_twice(quantity.name, known, where)
        known[quantity.name] = read_value(value, quantity, key, f"{where}: [known] {key}")
    unknown: dict[str, tuple[float, float]] = {}
    for key, value in read_table(content.get("unknown", {}), f"{where}: [unknown]").items():
        quantity = find_known(key, value, f"{where}: [unknown]")
        _refuse_twice(quantity.name, known | unknown, where)
        at = f"{where}: [unknown] {key}"
        lower, upper = (read_value(end, quantity, key, at) for end in read_pair(value, at))
        if lower >= upper:
            raise InputError(f"{at}: a range with lower below upper is required, received {value!r}")
        unknown[quantity.name] = lower, upper
    case = _case(case, known, unknown, where)
    if "g" not in unknown:
        known.setdefault("g", float(sp.Rational(vocabulary.g.default)))  # Table 1's
    return known, unknown, case


def _refuse_twice(name: str, given: Mapping[str, Any], where: str) -> None:
    if name in given:
        raise InputError(f"{where}: {name} is given twice")


def _case(case: str | None, known: dict[str, float], unknown: Mapping[str, Any], where: str) -> str | None:
    """Return the case that case and tilt agree on; write the tilt of a case into `known`."""
    tilt = {"C1": math.pi / 2.0, "C2": 0.0}
    if case is None:
        if "phi" not in known and "phi" not in unknown:
            raise InputError(
                f"{where}: [known] case (C1 or C2) or the tilt phi is required, neither is given"
            )
        return next((name for name, phi in tilt.items() if math.isclose(known.get("phi", -1.0), phi)), None)
    if "phi" in unknown or not math.isclose(known.get("phi", tilt[case]), tilt[case], abs_tol=1e-6):
        raise InputError(
            f"{where}: [known] case {case} means phi = {math.degrees(tilt[case]):g} deg; leave one out"
        )
    known["phi"] = tilt[case]
    return case


def _columns(
    value: object, where: str, counts: float | None
) -> tuple[dict[str, ColumnSource] | None, list[str]]:
    """Return sources by channel, and warnings; a list names standard columns, as in the sidecars."""
    if value is None:
        return None, []
    if isinstance(value, list):
        standard = {column: channel for channel, (column, _) in CHANNELS.items()}
        names = _names(value, where)
        ignored = [f"column {name!r} is no channel and is ignored" for name in names if name not in standard]
        return {standard[name]: ColumnSource(name) for name in names if name in standard}, ignored
    columns: dict[str, ColumnSource] = {}
    table = read_table(value, where)
    refuse_unknown(table, CHANNELS, where)
    for channel, source in table.items():
        entry = {"column": source} if isinstance(source, str) else read_table(source, f"{where} {channel}")
        refuse_unknown(entry, ("column", "unit"), f"{where} {channel}")
        text, unit = entry.get("column"), entry.get("unit")
        if not isinstance(text, str) or not text.strip():
            raise InputError(f"{where} {channel}: a column name or arithmetic is required, received {text!r}")
        if unit is not None and (not isinstance(unit, str) or not CHANNELS[channel][1]):
            raise InputError(f"{where} {channel}: no unit or a unit as text is required, received {unit!r}")
        parsed = (
            None if unit is None else require_unit(unit, CHANNELS[channel][1], f"{where} {channel}", counts)
        )
        columns[channel] = ColumnSource(text.strip(), parsed)
    for left, right in (("theta_m", "theta_l"), ("omega_m", "omega_l"), ("torque", "torque_l")):
        if left in columns and right in columns:
            raise InputError(f"{where}: one of {left} and {right} is required, both are given")
    return columns, []


def _optional(
    content: Mapping[str, Any], key: str, where: str, lower: float, open_below: bool = False
) -> float | None:
    return None if key not in content else read_number(content[key], f"{where}: {key}", lower, open_below)


def _alignment(content: Mapping[str, Any], where: str) -> tuple[dict[str, float], frozenset[str]]:
    """Return delay, zero angle and offset by key, 0 where the fit estimates them, and which those are."""
    given = {key: content.get(key, 0.0) for key in _ALIGNMENT}
    estimate = frozenset(key for key, value in given.items() if value == "estimate")
    lower = {"input_delay_s": 0.0}
    values: dict[str, float] = {}
    for key, value in given.items():
        if isinstance(value, str) and value != "estimate":
            raise InputError(f'{where}: {key}: a number or "estimate" is required, received {value!r}')
        values[key] = (
            0.0 if key in estimate else read_number(value, f"{where}: {key}", lower.get(key, -math.inf))
        )
    return values, estimate


def _intervals(value: object, where: str) -> tuple[tuple[float, float], ...]:
    if not isinstance(value, list):
        raise InputError(f"{where}: a list of [start, end] is required, received {value!r}")
    intervals: list[tuple[float, float]] = []
    for pair in value:
        start, end = (read_number(end, where) for end in read_pair(pair, where))
        if start >= end:
            raise InputError(f"{where}: intervals with start before end are required, received {pair!r}")
        intervals.append((start, end))
    return tuple(intervals)


def _average(value: object, where: str) -> float:
    """Return a time [s], 0 if none is given, infinity for "run"."""
    if value is None or value == "run":
        return 0.0 if value is None else math.inf
    seconds = parse_value(value, "s", where) if isinstance(value, str) else value
    return read_number(seconds, where, 0.0, open_below=True)


def _names(value: object, where: str) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
        raise InputError(f"{where}: a list of names is required, received {value!r}")
    return tuple(value)
