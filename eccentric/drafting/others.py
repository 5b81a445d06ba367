"""The other columns: temperature and supply, which are slow, duty cycles, and flags."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from eccentric.drafting import limits
from eccentric.drafting.balance import Moved, balance_of
from eccentric.drafting.columns import Grid, LoggedColumn
from eccentric.drafting.drives import CONSTANT, no_drive
from eccentric.drafting.proposal import BY_SIZE, Proposal, quoted
from eccentric.drafting.words import is_of_supply

_FAHRENHEIT = re.compile(r"(?<![A-Za-z])(°|[Dd]eg ?)?F\W*$|(?i:fahrenheit|(?<![a-z])deg ?f\W*$)")
"""A small f alone is of "filtered" or "front"."""


def find_slow(columns: Sequence[LoggedColumn]) -> tuple[Proposal | None, LoggedColumn | None]:
    """The temperature, and the supply voltage, if the log has them."""
    slow = [c for c in columns if not c.is_flag and not c.is_constant and is_slow(c)]
    named = [c for c in columns if c.name.quantity == "temperature" and not c.is_flag]
    of_supply = (c for c in columns if c.name.quantity == "supply" and not c.is_flag)
    supply = next((c for c in of_supply if not is_of_supply(c.name)), None)
    # The motor's own heats its winding and its magnets; a converter has one of its own.
    temperature = min(named, key=_far_from_motor, default=None) or next(
        (c for c in slow if c.name.quantity == "" and c.name.signal and _warm(c)), None
    )
    if temperature is None:
        return None, supply
    low, high = float(temperature.values.min()), float(temperature.values.max())
    evidence = [f"drifts from {low:.3g} to {high:.3g}, far slower than the motion"]
    doubts = []
    unit, sure = temperature.name.unit or ("K" if low > 200.0 else "degC"), 0.98
    if temperature.name.quantity == "temperature":
        evidence.insert(0, "temperature by its name")
    else:
        doubts.append("no name; any slow signal would look the same")
        sure = 0.6
    if not temperature.name.unit and high >= 150.0:
        doubts.append(BY_SIZE)
    elif not temperature.name.unit:
        evidence.append(f"{unit} by its size")
    text, reads = temperature.text, ()
    if _FAHRENHEIT.search(text):
        reads, text, unit = (text,), f"({quoted(text)} - 32) / 1.8", "degC"
        evidence.append("in degrees Fahrenheit")
    said = tuple(evidence), sure, "; ".join(doubts)
    return Proposal("temperature", text, unit, *said, reads=reads), supply


def _far_from_motor(column: LoggedColumn) -> int:
    words = set(column.name.whose.split())
    near = ({"winding", "stator", "coil"}, {"motor", "mot", "rotor", "magnet", "joint"})
    return next((k for k, some in enumerate(near) if words & some), 3 if words - {"actual", "present"} else 2)


def is_slow(column: LoggedColumn) -> bool:
    """Whether a column drifts: its steps from row to row are small against its range."""
    return (
        bool(column.range > 0.0)
        and float(np.mean(np.abs(np.diff(column.values)))) < limits.SLOW * 0.1 * column.range
    )


def _warm(column: LoggedColumn) -> bool:
    low, high = float(column.values.min()), float(column.values.max())
    return (5.0 < low and high < 150.0) or (270.0 < low and high < 430.0)


def find_voltage(columns: Sequence[LoggedColumn], supply: LoggedColumn | None) -> Proposal | None:
    """The voltage as duty cycle times supply."""
    duties = [c for c in columns if c.name.quantity == "duty" and not c.is_flag and no_drive(c.name) == ""]
    duty = next((c for c in duties if c.name.signal), next(iter(duties), None))
    if duty is None:
        return None
    largest = float(np.max(np.abs(duty.values)))
    full = 100.0 if duty.name.unit == "%" else max(1.0, largest)
    sure = duty.name.unit == "%" or largest <= 1.0
    doubt = f"full scale is taken as the largest duty seen, {largest:g}: enter that of your converter"
    text = quoted(duty.text) + ("" if full == 1.0 else f" / {full:g}")
    if supply is None:
        said, sure_of, reads = "a duty cycle by its name", 0.4, (duty.text,)
    else:
        text += f" * {quoted(supply.text)}" + (" / 1000" if supply.name.unit == "mV" else "")
        said, reads = "duty cycle times supply, by their names", (duty.text, supply.text)
        sure_of = 0.9 if sure else 0.7
    found = Proposal("voltage", text, "V", (said,), sure_of, "" if sure else doubt, reads=reads)
    if (
        supply is not None
        and not supply.name.unit
        and (level := float(np.median(supply.values))) > limits.HIGHEST_SUPPLY
    ):
        found = found.doubted(
            f"{supply.text} is taken in V, {level:.4g}: a register may have tenths of a volt"
        )
    return found if supply else found.doubted("times the supply voltage, which the log does not contain")


def find_flags(
    columns: Sequence[LoggedColumn], grid: Grid, motion: Moved, drive: LoggedColumn | None
) -> tuple[list[Proposal], Mapping[str, str]]:
    """Where the motor is off, and which rows are to be used."""
    proposals: dict[str, Proposal] = {}
    left_out: dict[str, str] = {}
    for column in columns:
        quantity = column.name.quantity
        if column.is_constant:
            left_out[column.text] = CONSTANT
            continue
        value = {"on": 0, "off": 1, "good": 1, "bad": 0}.get(quantity)
        share = float(np.mean(column.values == value)) if value is not None else 0.0
        channel = "motor_off" if quantity in ("on", "off") else "use"
        if value is None or channel in proposals:
            left_out[column.text] = "a flag whose meaning its name does not say"
            continue
        text = f"{quoted(column.text)} == {value}"
        evidence = (
            f"by its name; so in {100 * share:.1f} % of the rows",
            *_coasting(grid, motion, drive, column, value, channel),
        )
        doubt = "" if channel == "motor_off" else "only its name says that the other rows are not to be used"
        proposals[channel] = Proposal(
            channel, text, "", evidence, 0.9 if channel == "motor_off" else 0.8, doubt, reads=(column.text,)
        )
    return list(proposals.values()), left_out


def _coasting(
    grid: Grid, motion: Moved, drive: LoggedColumn | None, flag: LoggedColumn, value: int, channel: str
) -> tuple[str, ...]:
    """Whether the drive still follows the motion where a flag says that it is off."""
    if drive is None or channel != "motor_off":
        return ()
    off = np.abs(grid.smooth(flag) - value) < 0.5
    y = grid.smooth(drive)
    within, without = (
        balance_of(Moved(motion.x, motion.w, motion.a, motion.moving & rows), y, periodic=False)
        for rows in (off, ~off)
    )
    if within is None:
        return (f"{drive.text} is constant there",)
    if without is None:
        return ()
    return (
        (
            f"explained by motion: {100 * max(within.r2_plain, 0):.0f} % there,"
            f" {100 * max(without.r2_plain, 0):.0f} % elsewhere"
        ),
    )
