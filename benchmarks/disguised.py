"""A log with its columns renamed, rescaled and shuffled at random, and what a draft should make of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.drafting import Draft
from eccentric.logs import Log, parse_unit

__all__ = ["UNITS", "Column", "Disguised", "Judged", "disguised", "in_unit", "judged"]

UNITS = {
    "time": ("s", "ms", "us"),
    "angle": ("rad", "deg", "rev", "counts"),
    "speed": ("rad/s", "rpm", "deg/s", "rev/s"),
    "current": ("A", "mA"),
    "voltage": ("V", "mV"),
    "torque": ("N m", "mNm"),
    "temperature": ("degC", "K"),
}
WORDS = {
    "time": ("time", "t", "Timestamp", "Zeit"),
    "angle": ("angle", "position", "theta", "Winkel", "q"),
    "speed": ("speed", "velocity", "omega", "Drehzahl", "w"),
    "current": ("current", "Iq", "motor current", "Strom"),
    "voltage": ("voltage", "u", "motor voltage", "Spannung"),
    "torque": ("torque", "tau", "Drehmoment"),
    "temperature": ("temperature", "temp", "motor temp"),
    "run": ("run", "trial", "Versuch"),
    "duty": ("pwm", "duty"),
    "supply": ("supply", "vbus"),
    "on": ("enable", "motor enabled"),
    "bad": ("suspect", "invalid"),
    "set angle": ("goal position", "target angle"),
}
SUFFIX = {"rad/s": "rad_s", "deg/s": "deg_s", "rev/s": "rev_s", "N m": "Nm", "degC": "C"}
STYLES = ("with unit", "words", "no name")
WEIGHTS = (0.4, 0.4, 0.2)
"""Logs whose names state units, whose names are words alone, and whose columns are numbered."""


@dataclass(frozen=True)
class Column:
    """A column of a log as it is known: quantity, and the unit it is in.

    `same` is another column that holds the same quantity; either is right.
    """

    quantity: str
    unit: str = ""
    counts: float = 0.0
    same: str = ""


@dataclass(frozen=True)
class Disguised:
    """A disguised log: new name -> what it is, and SI per unit of the column as it stands now."""

    log: Log
    truth: Mapping[str, Column]
    factor: Mapping[str, float]
    offset: Mapping[str, float]
    style: str


@dataclass(frozen=True)
class Judged:
    """Of one column: what it is, whether channel and unit are right, and whether a doubt is stated."""

    name: str
    quantity: str
    right: bool
    doubted: bool
    said: str


def disguised(log: Log, known: Mapping[str, Column], rng: np.random.Generator) -> Disguised:
    """A random disguise of the columns in `known`; others are dropped."""
    style = str(rng.choice(STYLES, p=WEIGHTS))
    order = rng.permutation(list(known))
    columns: dict[str, NDArray] = {}
    truth: dict[str, Column] = {}
    factors: dict[str, float] = {}
    offsets: dict[str, float] = {}
    names: dict[str, str] = {}
    for k, old in enumerate(order):
        column, values = known[old], log.columns[old]
        unit, values, factor, offset = _rescaled(column, values, rng)
        name = _name(column.quantity, unit, style, k, rng, columns)
        names[old] = name
        columns[name], truth[name], factors[name], offsets[name] = values, column, factor, offset
    truth = {n: Column(c.quantity, c.unit, c.counts, names.get(c.same, "")) for n, c in truth.items()}
    return Disguised(Log(f"{style}.csv", columns, log.rows), truth, factors, offsets, style)


def _rescaled(column: Column, values: NDArray, rng: np.random.Generator) -> tuple[str, NDArray, float, float]:
    """The column in a unit drawn at random: unit, values, SI per unit and offset."""
    if column.quantity not in UNITS:
        return column.unit, values, 1.0, 0.0
    choices = [u for u in UNITS[column.quantity] if u != "counts" or column.counts]
    unit = str(rng.choice(choices))
    if column.quantity == "time" and math.isclose(float(np.median(np.diff(values))), 1.0):
        unit = column.unit
    return unit, *in_unit(column, values, unit)


def in_unit(column: Column, values: NDArray, unit: str) -> tuple[NDArray, float, float]:
    """The column in another unit, with the digits that files keep: values, SI per unit and offset."""
    there = parse_unit(column.unit, "", column.counts or None)
    new = parse_unit(unit, "", column.counts or None)
    changed = (there.to_si(values) - new.offset) / new.factor
    if unit == "counts":
        changed = np.round(changed)
    elif unit != column.unit:
        # Files keep some six digits of what varies.
        digits = 6 - math.floor(math.log10(max(float(np.ptp(changed)), 1e-12)))
        changed = np.round(changed, max(0, digits + (3 if column.quantity in ("time", "angle") else 0)))
    return changed, new.factor, new.offset


def _name(
    quantity: str, unit: str, style: str, k: int, rng: np.random.Generator, taken: Mapping[str, object]
) -> str:
    if style == "no name":
        return f"ch{k + 1}"
    word = str(rng.choice(WORDS[quantity]))
    text = word
    if style == "with unit" and unit:
        form = rng.integers(3)
        text = (f"{word} [{unit}]", f"{word} ({unit})", f"{word.replace(' ', '_')}_{SUFFIX.get(unit, unit)}")[
            form
        ]
    return text if text not in taken else f"{text} {k}"


def judged(draft: Draft, given: Disguised) -> list[Judged]:
    """Each column: the channel by its quantity, the unit by its size in SI, to one in a thousand."""
    counts = next(
        (float(e.value) for e in draft.entries if e.key == "encoder_counts_per_rev" and not e.asked), None
    )
    found: list[Judged] = []
    for name, column in given.truth.items():
        about = [p for p in draft.proposals if name in _columns_in(p.column, given.truth)]
        said = "; ".join(f"{p.channel} = {p.column} [{p.unit}]" for p in about) or "left out"
        doubted = any(p.doubt for p in about)
        right = any(_right(p.channel, p.unit, counts, column, given, name) for p in about)
        if not about:
            # Left out is right where it is no channel, or another column with the same quantity was taken.
            # So is it where all of its values are one, as a flag that is never raised.
            constant = float(np.ptp(given.log.numbers(name))) == 0.0 if column.quantity != "run" else False
            right = (
                constant
                or column.quantity in ("set angle", "decoy")
                or any(column.same in _columns_in(p.column, given.truth) for p in draft.proposals)
            )
            # In a log without names a flag has no meaning that could be seen.
            doubted = "meaning" in draft.left_out.get(name, "") or "too little" in draft.left_out.get(
                name, ""
            )
        found.append(Judged(name, column.quantity, right, doubted, said))
    return found


def _columns_in(text: str, names: Mapping[str, object]) -> set[str]:
    import re

    parts = set(re.findall(r"`([^`]+)`|([A-Za-z_]\w*)", text))
    words = {a or b for a, b in parts} | {text}
    return words & set(names)


def _right(
    channel: str, unit: str, counts: float | None, column: Column, given: Disguised, name: str
) -> bool:
    of = {
        "theta_m": "angle",
        "theta_l": "angle",
        "omega_m": "speed",
        "omega_l": "speed",
        "torque_l": "torque",
        "motor_off": "on",
        "use": "bad",
    }
    quantity = of.get(channel, channel)
    if column.quantity in ("duty", "supply"):
        return channel == "voltage"
    if quantity != column.quantity:
        return False
    if quantity in ("run", "on", "bad"):
        return True
    if unit in ("counts", "counts/s") and counts is None:
        return False
    found = parse_unit(unit, "", counts)
    return math.isclose(found.factor, given.factor[name], rel_tol=1e-3) and found.offset == given.offset[name]
