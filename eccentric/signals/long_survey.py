"""One pass over a long log, in constant memory: the states and the sums of each of its windows.

The log is cut into windows of ten seconds within its runs. On cells of 20 ms, the base of every friction
model (direction, speed, acceleration, gravity, and the same drifting with time and temperature) and the drive
become sums per window (X'X, X'y, y'y), and the states that the drive is in are counted. Nothing of this is
an estimate: it serves to choose the windows. Every row is checked as if the log were read whole.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.logs import Log, LogStream
from eccentric.rigs import Rig
from eccentric.signals import limits
from eccentric.signals.clock import clock_of, require_increasing
from eccentric.signals.converted import Converted, converted, stream_columns

# Signals of a log on cells of 20 ms: the base of every friction model, and the states of the drive.


Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

_STATES = ("speed", "angle", "drive", "acceleration", "temperature", "motor off", "speed and drive")


def state_name(state: int) -> str:
    """What a state is a state of, in words."""
    return _STATES[state >> 24]


def threshold(omega: Array, rig: Rig) -> float:
    """Speed from which a cell counts as moving [rad/s]: that of the rig, or as most of the batch suggests."""
    given = rig.sampling.moving_threshold_rad_s
    return limits.SLOW * usual(omega) if given is None else given


def usual(x: Array) -> float:
    """The size that a signal usually stays below."""
    return float(np.quantile(np.abs(x), 0.95))


@dataclass(frozen=True)
class Cells:
    """Signals on cells, without the first and the last one; `clear` where the angle does not wrap."""

    span: Array
    omega: Array
    alpha: Array
    drive: Array
    angle: Array | None
    temperature: Array | None
    clear: Mask


def cells_of(values: Mapping[str, Array], rig: Rig, first: Integers, per: int, count: int) -> Cells:
    """Differences over neighbouring cells; the drive is averaged over each."""
    t = values["time"][first]
    span = t[2:] - t[:-2]
    name = next((c for c in ("theta_m", "theta_l") if c in values), None)
    mu = rig.known.get("mu")
    if name is None:
        speed = next(values[c] for c in ("omega_m", "omega_l") if c in values)[first]
        omega, alpha = speed[1:-1], (speed[2:] - speed[:-2]) / span
        angle, clear = None, np.ones(len(span), dtype=bool)
    else:
        theta = values[name][first]
        steps = np.diff(theta)
        clear = np.abs(steps) <= limits.JUMP * max(float(np.quantile(np.abs(steps), 0.9)), 1e-12)
        clear = clear[1:] & clear[:-1]
        omega, alpha = (theta[2:] - theta[:-2]) / span, 4.0 * (steps[1:] - steps[:-1]) / span**2
        angle = theta[1:-1] if name == "theta_l" else None if mu is None else mu * theta[1:-1]
        if name == "theta_l" and mu is not None:
            omega, alpha = omega / mu, alpha / mu
    drive = next(values[c] for c in ("current", "torque", "torque_l", "voltage") if c in values)
    drive = drive[: count * per].reshape(count, per).mean(axis=1)[1:-1]
    warm = values.get("temperature")
    warm = None if warm is None else warm[first[1:-1]]
    return Cells(span, omega, alpha, drive, angle, warm, clear)


def base_of(cells: Cells, t: Array) -> Array:
    """The base of a friction model and the drive on the cells (cells, COLUMNS + 1)."""
    direction = np.sign(cells.omega)
    zero = np.zeros_like(t)
    angle, warm = cells.angle, cells.temperature
    x = np.empty((len(t), limits.COLUMNS + 1))
    x[:, 0], x[:, 1], x[:, 2], x[:, 3] = direction, cells.omega, cells.alpha, 1.0
    x[:, 4] = zero if angle is None else np.sin(angle)
    x[:, 5] = zero if angle is None else np.cos(angle)
    x[:, 6] = direction * np.abs(cells.omega) ** 2
    x[:, 7] = direction * t
    x[:, 8] = zero if warm is None else direction * warm
    x[:, 9] = cells.drive
    return x


def states_of(cells: Cells, moving: Mask, free: Mask, scales: tuple[float, ...]) -> list[Integers]:
    """The state of each cell in every respect, -1 for none: a kind, and a bin of its size and direction."""
    way = (cells.omega > 0.0).astype(np.int64)
    signals = cells.omega, cells.alpha, cells.drive
    speed, acceleration, drive = (
        2 * _bin(x, scale, limits.OCTAVES) + (x > 0.0) for x, scale in zip(signals, scales, strict=True)
    )
    coarse = 2 * _bin(cells.drive, scales[2], 1.0) + (cells.drive > 0.0)
    found = [
        (0, speed),
        (2, 2 * drive + way),
        (3, 2 * acceleration + way),
        (6, 1024 * (2 * _bin(cells.omega, scales[0], 1.0) + way) + coarse),
    ]
    if cells.angle is not None:
        place = np.floor(cells.angle / (2.0 * math.pi) * limits.ANGLES).astype(np.int64) % limits.ANGLES
        found.append((1, 2 * place + way))
    if cells.temperature is not None:
        warm = np.clip(np.floor(cells.temperature / limits.DEGREES_A_BIN), -500, 500).astype(np.int64) + 500
        found.append((4, 2 * warm + way))
    states = [np.where(moving, (kind << 24) + state, -1) for kind, state in found]
    if np.any(free):
        states.append(np.where(free, (5 << 24) + way, -1))
    return states


def _bin(x: Array, scale: float, octaves: float) -> Integers:
    """Number of the bin of a size, from 0 on: its logarithm, small ones together."""
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.floor(octaves * np.log2(np.abs(x) / scale)) if scale > 0.0 else np.zeros_like(x)
    # Half as many bins span the same range at one an octave.
    least = round(limits.LEAST_BIN * octaves / limits.OCTAVES)
    return np.clip(np.nan_to_num(found), least, limits.LARGEST_BIN).astype(np.int64) - least


@dataclass
class Window:
    """Rows [first, end) of a run, from `begin` to `finish` [s]; `number` counts ten seconds from its start.

    `sums` (COLUMNS + 1, COLUMNS + 1) are those of the columns and the drive over `cells` moving cells;
    `seen` counts the cells in each state. `wanted` says whether the rig uses rows of it, `assessed` whether
    there are cells on such rows, moving or not.
    """

    run: str
    number: int
    first: int
    end: int
    begin: float
    finish: float
    cells: int = 0
    sums: Array = field(default_factory=lambda: np.zeros((limits.COLUMNS + 1, limits.COLUMNS + 1)))
    seen: Counter[int] = field(default_factory=Counter)
    wanted: bool = False
    assessed: bool = False

    def joined(self, other: Window) -> None:
        """Add the window that follows."""
        self.wanted, self.assessed = self.wanted or other.wanted, self.assessed or other.assessed
        self.end, self.finish, self.cells = other.end, other.finish, self.cells + other.cells
        self.sums += other.sums
        self.seen.update(other.seen)


@dataclass
class LogSurvey:
    """What one pass over a log found: its windows in order, its rows, and how many are not numbers.

    `step_s` is the usual time between rows, `origin_s` the first, `scales` the usual sizes of speed,
    acceleration and drive, by which their states are counted.
    """

    stream: LogStream
    columns: list[str]
    windows: list[Window] = field(default_factory=list)
    rows: int = 0
    rejected: int = 0
    step_s: float = 0.0
    origin_s: float = 0.0
    scales: tuple[float, ...] = ()


def survey(stream: LogStream, rig: Rig, name: str, alone: bool, tell: Callable[[int], None]) -> LogSurvey:
    """Go over a log once.

    Args:
        stream: the log.
        rig: what is known about it.
        name: of its run, or before those of its runs.
        alone: whether its runs are named by their column alone.
        tell: called with the number of rows after every batch.

    Raises:
        InputError: whatever `read_table` refuses.
    """
    columns = stream_columns(stream, rig)
    found = LogSurvey(stream, columns)
    reader = _Reader(found, rig, name, alone)
    for batch in stream.batches(columns):
        reader.take(batch)
        tell(batch.rows)
    if found.rows == 0:
        raise InputError(stream.path, "a log with rows", "none")
    reader.finish()
    return found


class _Reader:
    """The state of a pass: the run and the window that the last batch ended in."""

    def __init__(self, found: LogSurvey, rig: Rig, name: str, alone: bool) -> None:
        self._found, self._rig, self._name, self._alone = found, rig, name, alone
        self._runs: set[str] = set()
        self._run = ""
        self._start = self._last = -math.inf
        self._first_bad = ""
        self._with_numbers: set[str] = set()

    def take(self, batch: Log) -> None:
        """Add a batch."""
        found, offset = converted(batch, self._rig), self._found.rows
        self._found.rows += batch.rows
        numbers, names = found.runs(self._name, self._alone)
        kept, fine = self._kept(batch, found, numbers)
        if not len(kept):
            return
        own = slice(None) if len(kept) == batch.rows else kept
        values, run = {c: x[own] for c, x in ({**found.values, "time": fine}).items()}, numbers[own]
        t = values["time"]
        begins = np.flatnonzero(np.diff(run, prepend=-1))
        labels = [names[run[k]] for k in begins]
        goes_on = labels[0] == self._run
        self._check(batch, t, kept, begins[goes_on:], labels, goes_on)
        if not self._found.windows:
            self._found.origin_s = float(t[0])
        firsts: list[int] = []
        windows: list[Window] = []
        for a, b, label in zip(begins.tolist(), [*begins[1:].tolist(), len(t)], labels, strict=True):
            if not (goes_on and a == 0):
                self._start = float(t[a])
            for first, end, number in _cut(t[a:b], self._start):
                rows = int(kept[a + first]), int(kept[a + end - 1]) + 1
                window = self._window(label, number, rows, float(t[a + first]), float(t[a + end - 1]), offset)
                firsts.append(a + first)
                windows.append(window)
        self._run, self._last = labels[-1], float(t[-1])
        wanted, off = found.use[own] != 0.0, found.motor_off[own] != 0.0
        for a, b, step in _stretches(t, firsts):
            first, end = firsts[a], firsts[b] if b < len(firsts) else len(t)
            rows = slice(first, end)
            own = {c: x[rows] for c, x in values.items()}
            places = np.array(firsts[a:b]) - first
            _count(own, wanted[rows], off[rows], places, windows[a:b], step, self._rig, self._found)

    def _kept(self, batch: Log, found: Converted, run: Integers) -> tuple[Integers, Array]:
        """Rows that are numbers and do not repeat the row before, the others are counted; the clock (n,)."""
        kept = found.numbers
        if not np.all(kept):
            self._first_bad = self._first_bad or batch.place(int(np.argmin(kept)))
            self._with_numbers |= {c for c, x in found.values.items() if np.any(np.isfinite(x))}
        else:
            self._with_numbers |= set(found.values)
        # Rows that are repeated have the same time.
        if np.any(np.diff(found.values["time"][kept]) == 0.0):
            kept &= ~found.repeated(kept, run)
        clock = clock_of(batch, run, found.values["time"], kept)
        self._found.rejected += int(np.count_nonzero(~clock.kept))
        if again := [finding.text for finding in clock.findings if finding.kind == "restart"]:
            raise InputError(f"{again[0]}: a long log needs one, as run = ... in [columns]")
        return np.flatnonzero(clock.kept), clock.t

    def _check(
        self, batch: Log, t: Array, rows: Integers, begins: Integers, labels: list[str], goes_on: bool
    ) -> None:
        """Raise InputError for a run in two pieces, or time stamps that do not increase."""
        for k, label in zip(begins.tolist(), labels[goes_on:], strict=True):
            if label in self._runs:
                place = batch.place(int(rows[k]))
                raise InputError(f"{batch.path}: {place}", "contiguous runs", f"{label!r} again")
            self._runs.add(label)
        require_increasing(batch, rows, t, begins, self._last)

    def _window(
        self, run: str, number: int, rows: tuple[int, int], begin: float, finish: float, offset: int
    ) -> Window:
        """The window of these rows of a batch, from `offset` on: the last one goes on, or another begins."""
        every, (first, end) = self._found.windows, rows
        if every and (every[-1].run, every[-1].number) == (run, number):
            every[-1].end, every[-1].finish = offset + end, finish
        else:
            every.append(Window(run, number, offset + first, offset + end, begin, finish))
        return every[-1]

    def finish(self) -> None:
        """Join short ends of runs to the window before; InputError for too many rows that are not numbers."""
        found, path = self._found, self._found.stream.path
        if found.rejected > limits.MOST_REJECTED * found.rows:
            what = f"no number in {found.rejected} of {found.rows} rows (first: {self._first_bad})"
            raise InputError(
                path, problem=f"{what}; at most {100 * limits.MOST_REJECTED:.0f} % may be missing"
            )
        whole: list[Window] = []
        for window in found.windows:
            short = window.finish - window.begin < limits.WINDOW_S / 2.0
            if short and whole and whole[-1].run == window.run and whole[-1].end == window.first:
                whole[-1].joined(window)
            else:
                whole.append(window)
        found.windows[:] = whole
        steps = [(w.finish - w.begin) / (w.end - w.first - 1) for w in whole if w.end - w.first > 1]
        found.step_s = float(np.median(steps)) if steps else 0.0


def _cut(t: Array, start: float) -> Iterator[tuple[int, int, int]]:
    """Rows [first, end) of each window with some, and its number, of a run that has begun at `start` [s]."""
    numbers = range(int((t[0] - start) / limits.WINDOW_S), int((t[-1] - start) / limits.WINDOW_S) + 1)
    edges = np.searchsorted(t, start + limits.WINDOW_S * np.array(numbers[1:], float)).tolist()
    for number, first, end in zip(numbers, [0, *edges], [*edges, len(t)], strict=True):
        if first < end:
            yield first, end, number


def _stretches(t: Array, firsts: Sequence[int]) -> Iterator[tuple[int, int, float]]:
    """Windows [a, b) of a batch whose rows are about as far apart, and the usual step between those [s].

    A run may be sampled at another rate than the one before. Windows of one row go with those before.
    """
    begin, step = 0, 0.0
    for k, (first, end) in enumerate(pairwise([*firsts, len(t)])):
        own = float(np.median(np.diff(t[first:end]))) if end - first > 1 else step
        if step and not 1.0 / limits.SAME_STEP <= own / step <= limits.SAME_STEP:
            yield begin, k, step
            begin, step = k, own
        step = step or own
    yield begin, len(firsts), step


def _count(
    values: Mapping[str, Array],
    wanted: Mask,
    off: Mask,
    firsts: Integers,
    windows: Sequence[Window],
    step: float,
    rig: Rig,
    found: LogSurvey,
) -> None:
    """Add sums and states of rows `step` [s] apart to their windows, on cells but the end ones."""
    for window, a, b in zip(windows, firsts, [*firsts[1:], len(wanted)], strict=True):
        window.wanted = window.wanted or bool(np.any(wanted[a:b]))
    per = max(1, round(limits.CELL_S / step)) if step else 1
    count = len(wanted) // per
    if count < limits.LEAST_CELLS_OF_A_BATCH:
        return
    first = np.arange(count) * per
    inside = first[1:-1]
    cells = cells_of(values, rig, first, per, count)
    of = np.searchsorted(firsts, first, side="right")
    alike = (of[2:] == of[:-2]) & (cells.span < 3.0 * per * step) & cells.clear & wanted[inside]
    free = alike & off[inside]
    moving = alike & ~off[inside] & (np.abs(cells.omega) > threshold(cells.omega, rig))
    columns = base_of(cells, values["time"][inside] - found.origin_s)
    if not found.scales:
        found.scales = tuple(map(usual, (cells.omega, cells.alpha, cells.drive)))
    states = states_of(cells, moving, free, found.scales)
    places = np.searchsorted(of[1:-1], np.arange(1, len(windows) + 2))
    for window, a, b in zip(windows, places[:-1], places[1:], strict=True):
        x = columns[a:b][moving[a:b]]
        window.sums += x.T @ x
        window.cells += len(x)
        window.assessed = window.assessed or bool(np.any(alike[a:b]))
        for state in states:
            numbers, often = np.unique(state[a:b], return_counts=True)
            window.seen.update(dict(zip(numbers.tolist(), often.tolist(), strict=True)))
        window.seen.pop(-1, None)
