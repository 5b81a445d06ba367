"""Times of turns, one row each, as an angle on an even grid.

A Hall sensor and a magnet give one event a turn: the angle is exact at the events, and nothing is known
between them but that a heavy shaft turns smoothly.  So the angle is a quintic spline through the events, on
a grid of the usual turn.  A mean speed over a turn, which such loggers write beside it, belongs to the middle
of the turn and not to the row: it is not used.

Loggers of several shafts write a row for the turn of any, with the counts of all; a row counts for a shaft if
its count changes there.  Some write the count before the event, so that it changes in the next row; the even
one of the two readings is taken.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from eccentric.core import InputError, counted
from eccentric.signals.finding import Finding
from eccentric.signals.limits import (
    CHANGED_TURN,
    FEWEST_TURNS,
    SAME_TURN,
    TURNS_SMOOTHER,
)

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

TURN = 2.0 * np.pi


@dataclasses.dataclass(frozen=True)
class Turns:
    """The events of one shaft: rows (n,) and turns counted up to each (n,), mended; what was mended.

    `late` says that the count of a row is that before its own event; `missed` and `double` are how many turns
    had no event, and two.
    """

    rows: Integers
    count: Array
    late: bool = False
    missed: int = 0
    double: int = 0


def turns_of(t: Array, count: Array | None) -> Turns:
    """The turns of a shaft by the times of rows t [s] (n,) and their count (n,); None: a row is a turn."""
    if count is None:
        return _mended(t, np.arange(len(t)), np.arange(len(t), dtype=float), late=False)
    changes = np.flatnonzero(np.diff(count) != 0.0)
    steps = np.abs(np.diff(count)[changes])
    if len(changes) == len(t) - 1:
        return _mended(t, np.arange(len(t)), np.concatenate([[0.0], np.cumsum(steps)]), late=False)
    total = np.cumsum(steps)
    late = _roughness(t[changes]) < TURNS_SMOOTHER * _roughness(t[changes + 1])
    return _mended(t, changes if late else changes + 1, total, late=late)


def _roughness(t: Array) -> float:
    """The usual change from one turn to the next, relative to it; by the median, as some are missed."""
    lasts = np.diff(t)
    return float(np.median(np.abs(np.diff(lasts)) / lasts[1:])) if len(lasts) > 1 else 0.0


def _mended(t: Array, rows: Integers, count: Array, late: bool) -> Turns:
    """Without the second event of a turn that had two, and with the turns that had none."""
    lasts = np.diff(t[rows]) / np.maximum(np.diff(count), 1.0)
    both = lasts[1:-2] + lasts[2:-1]
    double = np.flatnonzero(_same(both, lasts[:-3]) & _same(both, lasts[3:])) + 2
    kept = np.delete(np.arange(len(rows)), double)
    steps = np.diff(count)
    steps[double - 1] = 0.0
    count = np.concatenate([[0.0], np.cumsum(steps)])[kept]
    rows, steps = rows[kept], np.diff(count)
    lasts = np.diff(t[rows]) / np.maximum(steps, 1.0)
    beside = 0.5 * (lasts[:-2] + lasts[2:])
    turns = np.round(lasts[1:-1] / beside)
    without = (turns > 1.0) & _same(lasts[:-2], lasts[2:]) & _same(lasts[1:-1], turns * beside)
    missed = np.where(without, turns - 1.0, 0.0)
    steps[1:-1] += missed
    return Turns(rows, np.concatenate([[0.0], np.cumsum(steps)]), late, int(missed.sum()), len(double))


def _same(one: Array, other: Array) -> NDArray[np.bool_]:
    return np.abs(one - other) < SAME_TURN * other


@dataclasses.dataclass(frozen=True)
class EvenTurns:
    """The angle of a shaft on an even grid: times [s], angle [rad], and the row before each (m,)."""

    t: Array
    theta: Array
    row: Integers
    turns: tuple[Turns, ...]

    def finding(self, path: str) -> Finding:
        """What was mended."""
        late = any(found.late for found in self.turns)
        missed, double = (sum(getattr(found, name) for found in self.turns) for name in ("missed", "double"))
        said = [
            f"{missed} missed" if missed else "",
            f"{double} doubled" if double else "",
            "counts late" if late else "",
        ]
        used = sum(len(found.rows) for found in self.turns)
        text = f"{path}: {', '.join(filter(None, [counted(used, 'turn'), *said]))}"
        return Finding("turns", "theta", text, missed + double, "warning" if any(said) else "note")


def even_turns(t: Array, count: Array | None, run: Integers, names: Sequence[str], path: str) -> EvenTurns:
    """The angle by the times of turns, between events that take less than twice as long as those beside.

    Args:
        t: times of the rows [s] (n,).
        count: turns up to each row (n,); None where each row is a turn.
        run: number of the run (n,), from 0; `names` are theirs; `path` is the log's, for messages.

    Raises InputError for a run with too few turns.
    """
    parts: list[tuple[Array, Array, Integers]] = []
    every: list[Turns] = []
    for own in np.split(np.arange(len(t)), np.flatnonzero(np.diff(run)) + 1):
        found = turns_of(t[own], None if count is None else count[own])
        at, rows = t[own][found.rows], own[found.rows]
        pieces = _steady(at)
        longest = max(map(len, pieces))
        if longest < FEWEST_TURNS:
            raise InputError(
                f"{path}: run {names[int(run[own[0]])]!r}",
                f"at least {FEWEST_TURNS} turns without a jump of the speed",
                f"{longest}",
                why=f"with {'events'} = {'revolution'!r}",
            )
        every.append(found)
        step = float(np.median(np.diff(at) / np.diff(found.count)))
        for piece in [piece for piece in pieces if len(piece) >= FEWEST_TURNS]:
            start, before = float(at[piece[0]]), at[piece]
            grid = np.arange(start, before[-1], step)
            spline = make_interp_spline(before - start, TURN * found.count[piece], k=5)
            place = rows[piece][np.searchsorted(before, grid, side="right") - 1]
            parts.append((grid, np.asarray(spline(grid - start)), place))
    grid, theta, place = (np.concatenate(some) for some in zip(*parts, strict=True))
    return EvenTurns(grid, theta, place, tuple(every))


def _steady(t: Array) -> list[Integers]:
    """The events (n,) in pieces between which a turn takes more than twice as long as the one beside it."""
    lasts = np.diff(t)
    jumps = np.flatnonzero(np.abs(np.log(lasts[1:] / lasts[:-1])) > np.log(CHANGED_TURN)) + 1
    return np.split(np.arange(len(t)), jumps)
