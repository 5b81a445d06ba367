"""The source of each channel of a log: its columns, by standard names or as mapped in [columns]."""

from __future__ import annotations

from dataclasses import dataclass

from eccentric.errors import InputError
from eccentric.logs import Unit, require_unit
from eccentric.rigs.entries import read_names, read_table, refuse_unknown

__all__ = ["CHANNELS", "ColumnSource", "read_columns"]

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


@dataclass(frozen=True)
class ColumnSource:
    """The source of a channel: a column name or arithmetic on columns, and its unit (None: SI)."""

    text: str
    unit: Unit | None = None


def read_columns(
    value: object, where: str, counts: float | None
) -> tuple[dict[str, ColumnSource] | None, list[str]]:
    """Return sources by channel, and warnings; a list names standard columns, as in the sidecars."""
    if value is None:
        return None, []
    if isinstance(value, list):
        standard = {column: channel for channel, (column, _) in CHANNELS.items()}
        names = read_names(value, where)
        ignored = [f"column {name!r} is not a channel, ignored" for name in names if name not in standard]
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
            raise InputError(f"{where} {channel}: no unit, or a unit as text, is required, received {unit!r}")
        parsed = (
            None if unit is None else require_unit(unit, CHANNELS[channel][1], f"{where} {channel}", counts)
        )
        columns[channel] = ColumnSource(text.strip(), parsed)
    for left, right in (("theta_m", "theta_l"), ("omega_m", "omega_l"), ("torque", "torque_l")):
        if left in columns and right in columns:
            raise InputError(f"{where}: only one of {left} and {right} is required, received both")
    return columns, []
