"""Speed and acceleration of columns on an even grid, stretch by stretch, in the units of the columns."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from eccentric.drafting.columns import LoggedColumn, wrap_of
from eccentric.drafting.limits import DERIVATIVE, SMOOTH_ROWS, SMOOTH_S

__all__ = ["Grid", "Pair", "grid_of", "pairs_of"]

Array = NDArray[np.float64]


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
    for a in columns:
        slope = grid.smooth(a, 1, angle=True)[inner]
        if not np.any(slope):
            continue
        for b in columns:
            if a is b:
                continue
            level = grid.smooth(b)[inner]
            both = float(np.std(slope) * np.std(level))
            r = float(np.mean((slope - slope.mean()) * (level - level.mean())) / both) if both > 0.0 else 0.0
            # Noise of either lowers one of the two regressions: their geometric mean has no such bias.
            if abs(r) >= DERIVATIVE:
                factor = float(np.copysign(np.std(level) / np.std(slope), r))
                found.append(Pair(a.text, b.text, factor, abs(r)))
    return sorted(found, key=lambda pair: -pair.r)


def _window(grid: Array) -> int:
    rows = round(SMOOTH_S / float(grid[1] - grid[0]))
    return max(SMOOTH_ROWS, rows) | 1


def _local(t: Array, values: Array, grid: Array, derivative: int) -> Array:
    step = float(grid[1] - grid[0])
    return savgol_filter(np.interp(grid, t, values), _window(grid), 3, deriv=derivative, delta=step)
