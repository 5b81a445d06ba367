"""The clock of a log and its runs: which column is the time, in which unit, and where a run ends."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.drafting import limits
from eccentric.drafting.columns import LoggedColumn
from eccentric.drafting.proposal import Proposal
from eccentric.drafting.words import read_name
from eccentric.errors import InputError

__all__ = ["Clock", "find_clock", "find_runs"]

Array = NDArray[np.float64]
SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0}


@dataclass(frozen=True)
class Clock:
    """Time (n,) as the column has it, its ends of stretches (n-1,), and how likely each unit is."""

    proposal: Proposal
    raw: Array
    breaks: NDArray[np.bool_]
    step: float
    likely: Mapping[str, float]

    @property
    def unit(self) -> str:
        """The likeliest unit."""
        return max(self.likely, key=lambda unit: self.likely[unit])


def find_runs(
    columns: Mapping[str, LoggedColumn], texts: Mapping[str, NDArray[np.str_]], rows: int
) -> tuple[Proposal | None, NDArray[np.bool_]]:
    """The column that names runs, and its changes (n-1,): text or whole numbers in few contiguous blocks."""
    found: list[tuple[float, str, NDArray[np.bool_], int]] = []
    for name, values in texts.items():
        found += _blocks(name, values, rows, 0.5 + _named(name))
    for name, column in columns.items():
        if (column.is_whole or column.is_flag) and column.name.quantity in ("run", ""):
            if column.is_constant and column.name.quantity != "run":
                continue
            found += _blocks(name, column.values, rows, -0.5 + 2.0 * (column.name.quantity == "run"))
    if not found:
        return None, np.zeros(rows - 1, dtype=bool)
    score, name, changes, count = max(found, key=lambda one: one[0])
    if score < 0.0:
        return None, np.zeros(rows - 1, dtype=bool)
    evidence = f"{count} value{'s' if count > 1 else ''}, each in one block of rows"
    return Proposal("run", name, "", (evidence,), 0.95 if score > 0.4 else 0.7), changes


def _named(name: str) -> float:
    return 1.0 if read_name(name).quantity == "run" else 0.0


def _blocks(
    name: str, values: NDArray, rows: int, score: float
) -> list[tuple[float, str, NDArray[np.bool_], int]]:
    changes = values[1:] != values[:-1]
    count = int(np.count_nonzero(changes)) + 1
    if count > limits.FEW_VALUES or rows < 10 * count or len(np.unique(values)) != count:
        return []
    return [(score, name, changes, count)]


def find_clock(columns: Mapping[str, LoggedColumn], ends: NDArray[np.bool_], where: str) -> Clock:
    """The clock among the columns; `ends` (n-1,) are those of named runs.

    Raises:
        InputError: no column rises from row to row.
    """
    found = sorted(((_score(column, ends), column) for column in columns.values()), key=lambda one: -one[0])
    if not found or found[0][0] <= 0.0:
        raise InputError(
            f"{where}: a column that rises from row to row, the time, is required, the log has none"
        )
    score, column = found[0]
    steps = np.diff(column.values)
    inside = steps[(steps > 0.0) & ~ends]
    usual = float(np.median(inside))
    breaks = ends | (steps <= 0.0) | (steps > limits.GAP * max(usual, float(np.quantile(inside, 0.9))))
    likely = _units(column, usual, float(np.sum(inside)))
    unit = max(likely, key=lambda one: likely[one])
    others = [c.text for s, c in found[1:] if s > 0.8 * score]
    evidence = [
        "rises from row to row",
        f"step {usual * SECONDS[unit]:.4g} s, {1 / usual / SECONDS[unit]:.4g} rows a second",
    ]
    if column.name.unit:
        evidence.append(f"{column.name.unit} by its name")
    doubts = [f"{column.text} or {', '.join(others)}: several columns rise alike"] if others else []
    if column.name.quantity not in ("time", ""):
        doubts.append(f"its name says {column.name.quantity}")
    if likely[unit] < limits.SURE:
        second = sorted(likely, key=lambda one: -likely[one])[1]
        doubts.append(
            "unit by the rate of rows alone:"
            f" {second} would be {1 / usual / SECONDS[second]:.3g} rows a second"
        )
    proposal = Proposal("time", column.text, unit, tuple(evidence), likely[unit], "; ".join(doubts))
    return Clock(proposal, column.values, breaks, usual, likely)


def _score(column: LoggedColumn, ends: NDArray[np.bool_]) -> float:
    steps = np.diff(column.values)[~ends]
    if not len(steps) or column.is_constant:
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
    named = {"time": 3.0, "": 1.0}.get(column.name.quantity, 0.1)
    return named / (1.0 + 4.0 * uneven)


def _units(column: LoggedColumn, step: float, length: float) -> dict[str, float]:
    """How likely each unit of time is: by the name, else by the rate and length that logs of drives have."""
    if column.name.unit in SECONDS:
        return {unit: 0.995 if unit == column.name.unit else 0.00125 for unit in SECONDS}
    weights: dict[str, float] = {}
    for unit, seconds in SECONDS.items():
        rate, duration = 1.0 / (step * seconds), length * seconds
        decades = math.log10(rate / limits.USUAL_HZ) / limits.USUAL_DECADES
        weight = math.exp(-0.5 * decades**2) * {"s": 1.0, "min": 0.01}.get(unit, 0.5)
        possible = (
            limits.SLOWEST_HZ <= rate <= limits.FASTEST_HZ
            and limits.SHORTEST_S <= duration <= limits.LONGEST_S
        )
        weights[unit] = weight if possible else 1e-4 * weight
    total = sum(weights.values()) or 1.0
    return {unit: weight / total for unit, weight in weights.items()}
