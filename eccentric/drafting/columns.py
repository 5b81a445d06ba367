"""The columns of a log with what their values show by themselves: constant, whole numbers, steps, wraps."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from eccentric.core import InputError
from eccentric.drafting.limits import COMPARED, DERIVATIVE, ROUGHLY, SMOOTH_ROWS, SMOOTH_S, WRAP
from eccentric.drafting.words import Name, are_numbered, made_by, read_name
from eccentric.logs import Log
from eccentric.signals import far_from_others

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LoggedColumn:
    """A column of numbers (n,), missing ones and damaged ones of a motion interpolated, and its name."""

    name: Name
    values: Array
    astray: int = 0

    @property
    def text(self) -> str:
        """The name as the log has it."""
        return self.name.text

    @cached_property
    def range(self) -> float:
        """Largest less smallest value."""
        return float(np.ptp(self.values))

    @cached_property
    def levels(self) -> Array:
        """Its different values, in order."""
        return np.unique(self.values)

    @property
    def is_constant(self) -> bool:
        """Whether all values are one."""
        return self.range == 0.0

    @cached_property
    def varies(self) -> float:
        """Range over the largest value, both without the rarest values."""
        low, high = np.quantile(self.values, [0.005, 0.995])
        largest = max(abs(float(low)), abs(float(high)))
        return float(high - low) / largest if largest > 0.0 else 0.0

    @property
    def is_flag(self) -> bool:
        """Whether it has two values, both 0 or 1."""
        return len(self.levels) <= 2 and set(self.levels.tolist()) <= {0.0, 1.0}

    @cached_property
    def is_whole(self) -> bool:
        """Whether all values are whole numbers, other than a flag."""
        return not self.is_flag and bool(np.all(self.values == np.round(self.values)))


def columns_of(log: Log, rows: slice) -> tuple[dict[str, LoggedColumn], dict[str, NDArray[np.str_]]]:
    """The columns of numbers and those of text, by name; one without any number is left out."""
    made, numbered = made_by(log.columns), are_numbered(log.columns)
    numbers: dict[str, LoggedColumn] = {}
    texts: dict[str, NDArray[np.str_]] = {}
    for name in log.columns:
        values = log.text(name)[rows]
        if values.dtype.kind != "f":
            try:
                values = log.numbers(name)[rows]
            except InputError:
                texts[name] = values
                continue
        there = np.isfinite(values)
        if np.count_nonzero(there) < 2:
            continue
        said = Name(name) if numbered else read_name(name, log.units.get(name, ""))
        if name in made and not said.unit:
            said = replace(said, unit=made[name][0], maker=made[name][1])
        good, at = there.copy(), np.arange(len(values))
        if said.quantity in ("angle", "speed"):
            good[there] = ~far_from_others(values[there])
        numbers[name] = LoggedColumn(
            said,
            values if np.all(good) else np.interp(at, at[good], values[good]),
            int(np.count_nonzero(there & ~good)),
        )
    return numbers, texts


def step_of(column: LoggedColumn) -> float:
    """The step that all values are multiples of, but for their rounding in the file; 0 where there is none.

    A power of ten below 1 is what a file was written with and no encoder's.
    """
    levels = column.levels
    gaps = np.diff(levels)
    gaps = gaps[gaps > 1e-9 * max(abs(float(levels[0])), abs(float(levels[-1])), 1e-30)]
    if len(gaps) < 8:
        return 0.0
    smallest = np.sort(gaps)[: max(3, len(gaps) // 100)]
    least = float(np.median(smallest[smallest < 1.3 * smallest[0]]))
    # Where an angle travels far, no two of its values are one step apart: two gaps then differ by it.
    found = next((step for k in range(1, 9) if (step := _lattice(levels, least / k))), 0.0)
    if 0.0 < found < 1.0 and abs(math.log10(found) - round(math.log10(found))) < 1e-6:
        return 0.0
    return found


def _lattice(levels: Array, step: float) -> float:
    """A step that all levels are multiples of, near a first guess; 0 if there is none."""
    for reach in (2, 4, 8, 16, 32, 128, 512, 2048, 8192):
        # Levels further and further apart fix the step to more and more digits.
        apart = max(1, int(reach * step / max(float(np.median(np.diff(levels))), 1e-300)) // 2)
        if apart >= len(levels) // 2:
            break
        spread = levels[apart:] - levels[:-apart]
        count = np.round(spread / step)
        near = (count <= reach) & (count > 0)
        if np.count_nonzero(near) < 5:
            continue
        off = spread[near] / step - count[near]
        if float(np.sqrt(np.mean(off**2))) > 0.15:
            return 0.0
        step = float((spread[near] @ count[near]) / (count[near] @ count[near]))
    return step


def wrap_of(column: LoggedColumn, breaks: NDArray[np.bool_]) -> float:
    """The period at which an angle restarts, 0 if it does not; `breaks` (n-1,) are ends of runs and gaps."""
    steps = np.diff(column.values)[~breaks]
    large = np.abs(steps) > WRAP * column.range
    count = int(np.count_nonzero(large))
    if not count or count > 0.2 * len(steps) or len(column.levels) < 50:
        return 0.0
    small = np.abs(steps[~large])
    inner = (column.values - column.values.min()) / column.range
    filled = np.histogram(inner, 10, (0.0, 1.0))[0] > 0.01 * len(inner)
    if np.max(small, initial=0.0) > 0.4 * column.range or not np.all(filled):
        return 0.0
    around = float(np.median(np.abs(steps[large]))) + float(np.median(small[small > 0.0], axis=0))
    for period in (2.0 * math.pi, 360.0, 1.0, 2e3 * math.pi):
        if abs(column.range / period - 1.0) < 0.02:
            return period
    if column.is_whole and (nice := nice_counts(column.range + 1.0, 0.01)):
        return nice
    return max(column.range, around)


def nice_counts(value: float, tolerance: float) -> float:
    """The number of counts per turn of a usual encoder within a relative tolerance, 0 if none is."""
    powers = [2.0**k for k in range(7, 25)]
    rounds = [
        d * 10.0**k
        for k in range(1, 6)
        for d in (1, 1.2, 1.25, 1.44, 1.6, 1.8, 2, 2.4, 2.5, 3, 3.6, 4, 5, 6, 7.2, 8)
    ]
    near = [n for n in (*powers, *rounds) if n >= 100 and abs(value / n - 1.0) <= tolerance]
    return min(near, key=lambda n: abs(value / n - 1.0), default=0.0)


# Speed and acceleration of columns on an even grid, stretch by stretch, in the units of the columns.


@dataclass(frozen=True)
class Pair:
    """A column that is the slope of another: `speed` = `factor` times the slope [per s], correlated `r`."""

    angle: str
    speed: str
    factor: float
    r: float


@dataclass
class Grid:
    """Stretches of even steps: for each its rows, its time [s] and the time of the grid."""

    parts: list[tuple[Array, Array, slice]]
    breaks: NDArray[np.bool_]
    _kept: dict[tuple[str, int, bool], Array] = field(default_factory=dict)

    def smooth(self, column: LoggedColumn, derivative: int = 0, *, angle: bool = False) -> Array:
        """The column (m,) after a local cubic, or its derivative per s^k; an `angle` is unwrapped first."""
        key = (column.text, derivative, angle)
        if key not in self._kept:
            values = self.unwrapped(column) if angle else column.values
            self._kept[key] = np.concatenate(
                [_local(t, values[rows], grid, derivative) for t, grid, rows in self.parts]
            )
        return self._kept[key]

    def unwrapped(self, column: LoggedColumn) -> Array:
        """The column (n,) without restarts at every turn."""
        period = wrap_of(column, self.breaks)
        if not period:
            return column.values
        steps = np.diff(column.values)
        steps[self.breaks] = 0.0
        return column.values - period * np.concatenate([[0.0], np.cumsum(np.round(steps / period))])

    @property
    def step(self) -> float:
        """The usual step of the grid [s]."""
        return float(np.median([grid[1] - grid[0] for _, grid, _ in self.parts]))

    def inner(self) -> NDArray[np.bool_]:
        """Points (m,) away from the ends of a stretch, where a local fit has no two sides."""
        masks = []
        for _, grid, _ in self.parts:
            mask, half = np.ones(len(grid), dtype=bool), _window(grid) // 2
            mask[:half] = mask[len(mask) - half :] = False
            masks.append(mask)
        return np.concatenate(masks)


def grid_of(seconds: Array, breaks: NDArray[np.bool_]) -> Grid:
    """The even grid of all stretches that are long enough; `seconds` (n,), `breaks` (n-1,)."""
    edges = [0, *(np.flatnonzero(breaks) + 1).tolist(), len(seconds)]
    parts: list[tuple[Array, Array, slice]] = []
    for first, last in itertools.pairwise(edges):
        t = seconds[first:last]
        if len(t) > 2 * SMOOTH_ROWS:
            grid = np.linspace(t[0], t[-1], len(t))
            if len(grid) > 2 * _window(grid):
                parts.append((t, grid, slice(first, last)))
    return Grid(parts, breaks)


def pairs_of(grid: Grid, columns: list[LoggedColumn]) -> list[Pair]:
    """Every column that is the slope of another, best first."""
    inner, found = grid.inner(), []
    if len(columns) < 2:
        return []
    could = _could_be(grid, columns)
    for k, a in enumerate(columns):
        slope = grid.smooth(a, 1, angle=True)[inner]
        if not np.any(slope):
            continue
        for b in (columns[j] for j in np.flatnonzero(could[k]) if j != k):
            level = grid.smooth(b)[inner]
            both = float(np.std(slope) * np.std(level))
            r = float(np.mean((slope - slope.mean()) * (level - level.mean())) / both) if both > 0.0 else 0.0
            # Noise of either lowers one of the two regressions: their geometric mean has no such bias.
            if abs(r) >= DERIVATIVE:
                factor = float(np.copysign(np.std(level) / np.std(slope), r))
                found.append(Pair(a.text, b.text, factor, abs(r)))
    return sorted(found, key=lambda pair: -pair.r)


def _could_be(grid: Grid, columns: list[LoggedColumn]) -> NDArray[np.bool_]:
    """Where column k can have column j as its slope (n, n), by few points: each pair by itself takes long."""
    points = np.flatnonzero(grid.inner())
    points = points[:: max(1, len(points) // COMPARED)]
    slopes = _normal(np.array([grid.smooth(c, 1, angle=True)[points] for c in columns]))
    levels = _normal(np.array([grid.smooth(c)[points] for c in columns]))
    return np.abs(slopes @ levels.T) >= DERIVATIVE - ROUGHLY


def _normal(rows: Array) -> Array:
    """Rows (n, m) without their means, of norm 1."""
    free = rows - rows.mean(axis=1, keepdims=True)
    return free / np.maximum(np.linalg.norm(free, axis=1, keepdims=True), 1e-300)


def _window(grid: Array) -> int:
    rows = round(SMOOTH_S / float(grid[1] - grid[0]))
    return max(SMOOTH_ROWS, rows) | 1


def _local(t: Array, values: Array, grid: Array, derivative: int) -> Array:
    step = float(grid[1] - grid[0])
    return savgol_filter(np.interp(grid, t, values), _window(grid), 3, deriv=derivative, delta=step)
