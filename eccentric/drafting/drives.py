"""Which column drives the motor, and as what.

Current and torque follow friction, acceleration and gravity, a voltage follows the speed as well; where both
are logged, voltage = R current + k_e speed.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.drafting import limits
from eccentric.drafting.balance import Explained, Moved, balance_of
from eccentric.drafting.columns import Grid, LoggedColumn
from eccentric.drafting.proposal import Proposal, quoted
from eccentric.drafting.units import magnitudes

Array = NDArray[np.float64]
KINDS = ("current", "torque", "voltage")


@dataclass(frozen=True)
class Driven:
    """A column that drives the motor: what it is, and its balance."""

    column: LoggedColumn
    kind: str
    balance: Explained
    evidence: tuple[str, ...]
    doubt: str
    sure: float


def find_drives(
    grid: Grid, motion: Moved, columns: Sequence[LoggedColumn]
) -> tuple[list[Proposal], dict[str, Explained], dict[str, str]]:
    """Proposals for current, torque and voltage, the balance of each, and why other columns were left out."""
    found: list[tuple[LoggedColumn, Explained]] = []
    left_out: dict[str, str] = {}
    for column in columns:
        y = grid.smooth(column)
        balance = balance_of(motion, y)
        if balance is None:
            left_out[column.text] = "it does not vary while the drive moves"
        elif column.name.quantity in KINDS or balance.r2 >= limits.SHOWN:
            found.append((column, balance))
        else:
            left_out[column.text] = (
                f"motion explains {max(balance.r2, 0.0):.0%} of it, too little for a drive"
            )
    kept: list[Driven] = []
    for column, balance in sorted(found, key=lambda one: _rank(*one)):
        copied = next((one for one in kept if _copies(column, one)), None)
        if copied is not None:
            left_out[column.text] = f"it is {copied.column.text} again, in other units or as a set value"
            continue
        kept.append(_kind(column, balance))
    kept = _together(grid, motion, kept)
    proposals: dict[str, Proposal] = {}
    balances: dict[str, Explained] = {}
    for one in _voltage_among(kept):
        if one.kind in proposals:
            first = proposals[one.kind]
            said = "; ".join(
                filter(None, (first.doubt, f"{one.column.text} could be this {one.kind} as well"))
            )
            proposals[one.kind] = dataclasses.replace(first, doubt=said)
            left_out[one.column.text] = (
                f"another {one.kind}; {proposals[one.kind].column} follows the motion better"
            )
            continue
        proposals[one.kind] = _proposal(one)
        balances[one.kind] = one.balance
    return list(proposals.values()), balances, left_out


def _rank(column: LoggedColumn, balance: Explained) -> tuple[bool, bool, bool, float]:
    """Measured before set, named before unnamed, in a unit before in percent, then the better explained."""
    name = column.name
    return name.commanded, name.quantity not in KINDS, name.unit == "%", -balance.r2


def _kind(column: LoggedColumn, balance: Explained) -> Driven:
    shares = balance.shares
    told = [
        f"{words} {shares[term]:.2f}"
        for term, words in (
            ("friction", "the sign of the speed"),
            ("speed", "the speed"),
            ("inertia", "the acceleration"),
            ("gravity", "the angle under gravity"),
        )
        if shares[term] > limits.TOLD
    ]
    opposed = ", which oppose each other" if max(shares.values()) > 1.0 else ""
    evidence = (
        f"motion explains {balance.r2:.0%} of it",
        *((f"follows {', '.join(told)} (standard deviations over its own{opposed})",) if told else ()),
    )
    named = column.name.quantity
    if named in KINDS:
        said = (f"{named} by its name", *evidence)
        if (
            named != "voltage"
            and shares["speed"] > limits.LIKE_VOLTAGE
            and shares["speed"] > limits.OVER_THE_REST * (shares["friction"] + shares["inertia"])
        ):
            return Driven(column, named, balance, said, "it follows the speed as a voltage does", 0.8)
        return Driven(column, named, balance, said, "", 0.98)
    rest = shares["friction"] + shares["inertia"] + shares["gravity"]
    if shares["speed"] > limits.BACK_EMF * (shares["speed"] + rest):
        return Driven(
            column,
            "voltage",
            balance,
            evidence,
            "no name; viscous friction could do the same to a current",
            0.7,
        )
    return Driven(column, "current", balance, evidence, "no name; a torque would look the same", 0.6)


def _voltage_among(kept: list[Driven]) -> list[Driven]:
    """Of two currents without names, the one that follows the speed more is taken for the voltage."""
    unnamed = [one for one in kept if one.kind == "current" and not one.column.name.quantity]
    if len(unnamed) < 2 or any(one.kind == "voltage" for one in kept):
        return kept
    most = max(unnamed, key=lambda one: one.balance.shares["speed"])
    doubt = "no name: of two alike it follows the speed more"
    return [
        dataclasses.replace(one, kind="voltage", doubt=doubt, sure=0.6) if one is most else one
        for one in kept
    ]


def _together(grid: Grid, motion: Moved, kept: list[Driven]) -> list[Driven]:
    """Two drive signals tell each other apart: voltage = R current + k_e speed, with both above 0."""
    rows = motion.moving
    for first in range(len(kept)):
        for second in range(len(kept)):
            u, i = kept[first], kept[second]
            if first == second or {u.column.name.quantity, i.column.name.quantity} >= {"voltage", "current"}:
                continue
            if u.column.name.quantity not in ("", "voltage") or i.column.name.quantity not in (
                "",
                "current",
                "torque",
            ):
                continue
            y, x = grid.smooth(u.column)[rows], grid.smooth(i.column)[rows]
            design = np.column_stack([np.ones_like(x), x, motion.w[rows]])
            scaled = design / np.maximum(np.max(np.abs(design), axis=0), 1e-300)
            c = np.linalg.lstsq(scaled, y, rcond=None)[0]
            r2 = 1.0 - float(np.var(y - scaled @ c)) / float(np.var(y))
            emf = abs(c[2]) * float(np.std(scaled[:, 2])) / float(np.std(y))
            if r2 > limits.CIRCUIT and c[1] > 0.0 and c[2] > 0.0 and emf > limits.LEAST_EMF:
                said = f"it is R {i.column.text} + k_e times the speed, to {r2:.1%}, with both above 0"
                other = f"{u.column.text} is a multiple of it plus a multiple of the speed"
                kept = list(kept)
                sure = 0.97 if i.column.name.quantity else 0.9
                kept[first] = Driven(u.column, "voltage", u.balance, (*u.evidence, said), "", 0.97)
                if i.column.name.quantity != "torque":
                    kept[second] = Driven(i.column, "current", i.balance, (*i.evidence, other), "", sure)
                return kept
    return kept


def _copies(column: LoggedColumn, other: Driven) -> bool:
    """Whether a column is another one again: to the last digits, or as the value that is set for it."""
    if column.name.quantity not in ("", other.kind) and not column.name.commanded:
        return False
    # A torque that is asked for is a current in other units; a voltage that is asked for drives the motor.
    if "voltage" in {column.name.quantity, other.kind} and column.name.quantity not in ("", other.kind):
        return False
    alike = column.name.commanded or (column.name.quantity == other.column.name.quantity != "")
    r = abs(float(np.corrcoef(column.values, other.column.values)[0, 1]))
    return r > (limits.COPY if alike else limits.SAME)


def _proposal(one: Driven) -> Proposal:
    largest = float(np.quantile(np.abs(one.column.values), 0.999))
    units = magnitudes(one.column, one.kind, largest)
    unit, sure = units[0]
    evidence, doubts = list(one.evidence), [one.doubt] if one.doubt else []
    if one.column.name.unit == "%":
        unit, sure = {"torque": "N m", "current": "A", "voltage": "V"}[one.kind], 0.3
        doubts.append("in percent of a rated value that the log does not hold")
    elif one.column.name.unit:
        evidence.append(f"{unit} by its name")
    else:
        second = units[1][0] if len(units) > 1 else ""
        doubts.append(f"{unit} by its size alone, up to {largest:.3g}" + (f"; or {second}" if second else ""))
    turned = one.balance.losses < 0.0 or (one.balance.losses == 0.0 and one.balance.inertia < 0.0)
    if turned:
        evidence.append("its sign is turned: it falls where friction and inertia need it to rise")
    said = tuple(evidence), min(one.sure, sure), "; ".join(doubts)
    return Proposal(one.kind, one.column.text, unit, *said, turned=turned)


# The other columns: temperature and supply, which are slow, duty cycles, and flags.


def find_slow(columns: Sequence[LoggedColumn]) -> tuple[Proposal | None, LoggedColumn | None]:
    """The temperature, and the supply voltage, if the log has them."""
    slow = [c for c in columns if not c.is_flag and not c.is_constant and is_slow(c)]
    named = [c for c in columns if c.name.quantity == "temperature" and not c.is_flag]
    supply = next((c for c in columns if c.name.quantity == "supply" and not c.is_flag), None)
    temperature = next(iter(named), None) or next(
        (c for c in slow if c.name.quantity == "" and _warm(c)), None
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
    if not temperature.name.unit and not (low > 200.0 or high < 150.0):
        doubts.append("unit by its size alone")
    elif not temperature.name.unit:
        evidence.append(f"{unit} by its size")
    return Proposal("temperature", temperature.text, unit, tuple(evidence), sure, "; ".join(doubts)), supply


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
    duty = next((c for c in columns if c.name.quantity == "duty" and not c.is_flag), None)
    if duty is None:
        return None
    largest = float(np.max(np.abs(duty.values)))
    full = 100.0 if duty.name.unit == "%" else max(1.0, largest)
    sure = duty.name.unit == "%" or largest <= 1.0
    doubt = (
        "" if sure else f"full scale is taken as the largest duty seen, {largest:g}: put the converter's own"
    )
    over = "" if full == 1.0 else f" / {full:g}"
    if supply is None:
        doubt = "; ".join(filter(None, (doubt, "times the supply voltage, which the log does not hold")))
        return Proposal(
            "voltage",
            f"{quoted(duty.text)}{over}",
            "V",
            ("a duty cycle by its name",),
            0.4,
            doubt,
            reads=(duty.text,),
        )
    text = f"{quoted(duty.text)}{over} * {quoted(supply.text)}"
    if supply.name.unit == "mV":
        text += " / 1000"
    return Proposal(
        "voltage",
        text,
        "V",
        ("duty cycle times supply, by their names",),
        0.9 if sure else 0.7,
        doubt,
        reads=(duty.text, supply.text),
    )


def find_flags(
    columns: Sequence[LoggedColumn], grid: Grid, motion: Moved, drive: LoggedColumn | None
) -> tuple[list[Proposal], Mapping[str, str]]:
    """Where the motor is off, and which rows are to be used."""
    proposals: dict[str, Proposal] = {}
    left_out: dict[str, str] = {}
    for column in columns:
        quantity = column.name.quantity
        if column.is_constant:
            left_out[column.text] = "it is constant"
            continue
        value = {"on": 0, "off": 1, "good": 1, "bad": 0}.get(quantity)
        share = float(np.mean(column.values == value)) if value is not None else 0.0
        channel = "motor_off" if quantity in ("on", "off") else "use"
        if value is None or channel in proposals:
            left_out[column.text] = "a flag whose meaning its name does not say"
            continue
        text = f"{quoted(column.text)} == {value}"
        evidence = (
            f"by its name; so in {share:.1%} of the rows",
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
        f"explained by motion: {max(within.r2_plain, 0):.0%} there, {max(without.r2_plain, 0):.0%} elsewhere",
    )
