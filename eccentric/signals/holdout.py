"""The held-out part of a log: named by the rig, or by a rule that is recorded."""

from __future__ import annotations

import fnmatch
from dataclasses import dataclass
from textwrap import shorten
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, few
from eccentric.signals.limits import FEWEST_RUNS_HELD_OUT, HELD_OUT_BLOCKS, HELD_OUT_PART

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from eccentric.rigs import Rig


Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
_ORDINALS = ("first", "second", "third", "fourth", "fifth")


@dataclass(frozen=True)
class Holdout:
    """Held-out rows (n,), the rule in a sentence, and the intervals [s] that they cover, in row order."""

    rows: NDArray[np.bool_]
    rule: str
    intervals_s: tuple[tuple[float, float], ...]

    @property
    def brief(self) -> str:
        """The rule shortened to one line: a log may have hundreds of runs."""
        return shorten(self.rule, 100, placeholder=" ...")


def hold_out(
    t: Array, run: NDArray[np.int64], run_names: tuple[str, ...], off: NDArray[np.bool_], rig: Rig
) -> Holdout:
    """Return the held-out part of rows with times t [s], run numbers and the motor switched off, each (n,).

    If the rig names intervals (in every run) or runs, those are held out. Otherwise it is every fifth run
    from the third on if there are three or more, else five contiguous blocks, the middle fifth of each fifth
    of the rows. If that would take all rows with the motor off, or all with it on, to one side, or hold out
    all that carry an added mass, or all that do not, every fifth run is counted from another one.

    Raises InputError for a run that is not in the log, and for intervals without rows.
    """
    if rig.holdout.intervals_s or rig.holdout.runs:
        rows, rule = _named(t, run, run_names, rig)
        if not rig.holdout.runs and len(run_names) == 1:
            return Holdout(rows, rule, rig.holdout.intervals_s)
    elif len(run_names) >= FEWEST_RUNS_HELD_OUT:
        first, rows = _every_fifth(run, len(run_names), off, carriers(run, run_names, rig.added))
        names = ", ".join(run_names[k] for k in np.unique(run[rows]))
        rule = f"whole runs, every fifth from the {_ORDINALS[first]} on: {names}"
    else:
        position = (np.arange(len(t)) / len(t) * HELD_OUT_BLOCKS) % 1.0
        rows = np.abs(position - 0.5) < HELD_OUT_PART / 2.0
        rule = f"{HELD_OUT_BLOCKS} contiguous blocks, {HELD_OUT_PART:.0%} of the rows, evenly spread"
    return Holdout(rows, rule, _intervals(t, run, rows))


def carriers(run: NDArray[np.int64], run_names: Sequence[str], patterns: Iterable[str]) -> Mask:
    """Rows (n,) of the runs that match any of the names or patterns."""
    named = [k for k, name in enumerate(run_names) if any(fnmatch.fnmatchcase(name, p) for p in patterns)]
    return np.isin(run, named)


def _every_fifth(run: NDArray[np.int64], count: int, off: Mask, carrying: Mask) -> tuple[int, Mask]:
    """The first of every fifth of `count` runs, and their rows: the third, unless that splits them badly.

    Only rows with the motor off separate back-EMF from viscous friction, and only driven ones are scored.
    Only rows of two masses show what their difference does.
    """

    def suits(rows: Mask) -> bool:
        swings = not np.any(off) or bool(np.any(off & ~rows) and np.any(rows & ~off) and np.any(~off & ~rows))
        loads = not np.any(carrying) or np.all(carrying)
        return swings and bool(loads or (np.any(carrying & ~rows) and np.any(~carrying & ~rows)))

    every = {
        first: np.isin(run, range(first, count, round(1.0 / HELD_OUT_PART)))
        for first in (2, 3, 4, 0, 1)
        if first < count
    }
    suited = (first for first, rows in every.items() if suits(rows))
    chosen = next(suited, 2)
    return chosen, every[chosen]


def _named(
    t: Array, run: NDArray[np.int64], run_names: tuple[str, ...], rig: Rig
) -> tuple[NDArray[np.bool_], str]:
    rows = np.zeros(len(t), dtype=bool)
    parts: list[str] = []
    for start, end in rig.holdout.intervals_s:
        rows |= (t >= start) & (t <= end)
    if rig.holdout.intervals_s and not np.any(rows):
        given = few(f"[{start:g}, {end:g}]" for start, end in rig.holdout.intervals_s)
        raise InputError(
            f"{rig.path}: holdout_intervals_s: an interval with rows of the log is required; the log goes "
            f"from {np.min(t):.6g} to {np.max(t):.6g} s, received {given}: "
            "is time in s, and the log complete?"
        )
    if rig.holdout.intervals_s:
        parts.append(f"{len(rig.holdout.intervals_s)} intervals from the rig file")
    chosen = matching(rig.holdout.runs, run_names, f"{rig.path}: holdout_runs")
    rows |= np.isin(run, [run_names.index(name) for name in chosen])
    if chosen:
        parts.append(f"runs from the rig file: {', '.join(chosen)}")
    return rows, "; ".join(parts)


def matching(patterns: Sequence[str], run_names: Sequence[str], where: str) -> list[str]:
    """Return the runs that match any of the names or patterns (`*`, `?`), in the order of the log.

    Raises InputError for a name or pattern that matches no run.
    """
    for pattern in patterns:
        if not fnmatch.filter(run_names, pattern):
            raise InputError(where, f"one of {few(run_names)}", f"{pattern!r}")
    return [name for name in run_names if any(fnmatch.fnmatchcase(name, p) for p in patterns)]


def _intervals(t: Array, run: NDArray[np.int64], rows: NDArray[np.bool_]) -> tuple[tuple[float, float], ...]:
    """First and last time of each contiguous stretch of held-out rows."""
    label = np.where(rows, run, -1)
    begins = np.flatnonzero(np.concatenate([[True], label[1:] != label[:-1]]))
    ends = np.concatenate([begins[1:], [len(t)]]) - 1
    return tuple((float(t[a]), float(t[b])) for a, b in zip(begins, ends, strict=True) if rows[a])
