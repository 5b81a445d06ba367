"""Pieces of motion that a drive can follow, each from rest to rest, and their sequence.

Constant speeds in both directions excite speed-dependent effects; strokes that grow from near zero excite
effects of the distance since the last reversal; sums of sines (J. Swevers et al., IEEE Trans. Robotics and
Automation 13(5), 1997) mix speeds, angles and accelerations. Ramps are smoothsteps, so that the acceleration
is continuous.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, given_path, read_document, read_number, refuse_unknown, together
from eccentric.logs import parse_value
from eccentric.model import TURNING, AxisKind
from eccentric.planning.limits import (
    ACCELERATION_PART,
    FIRMWARE_HZ,
    LEAST_TIME_S,
    MARGIN,
    MOST_TIME_S,
    RATE_HZ,
    WHOLE_TURNS,
)
from eccentric.rigs import plain_entries, read_pair

FORCE = "force_N"
"""Key for a carriage whose log has a force: replaces the current limit."""
UNITS = {
    "speed_rad_s": "rad/s",
    "acceleration_rad_s2": "rad/s^2",
    "current_A": "A",
    "time_s": "s",
    "angle_rad": "rad",
}
_EXAMPLES, _EXAMPLES_OF_A_CARRIAGE = (50, 500, 2, 60), (0.2, 2, 50, 60)
"""Speed, acceleration, current or force, and time, for a message."""
LOOP = "speed_loop_Hz"
"""Numbers only: hertz is not among the units, see `eccentric.logs`."""


@dataclass(frozen=True)
class Bounds:
    """Limits of a planned motion, motor side.

    Attributes:
        speed, acceleration, current: largest magnitudes [rad/s], [rad/s^2], [A].
        time: length of the motion [s].
        angle: lower and upper end [rad], None for unlimited rotation.
        by_force: whether `current` is a force limit [N], at a force constant of 1 N/A.
        loop_hz: bandwidth of the drive's speed loop [Hz], None if unknown.

    For a carriage, radians are metres.
    """

    speed: float
    acceleration: float
    current: float
    time: float
    angle: tuple[float, float] | None = None
    by_force: bool = False
    loop_hz: float | None = None


def read_bounds(
    source: str | os.PathLike[str] | Mapping[str, Any] | Bounds, axis: AxisKind = TURNING
) -> Bounds:
    """Read limits from a `.toml` or `.json` file, or a mapping with its keys, in the names of the axis.

    Values are numbers in the unit of the key, or text with a unit ("3000 rpm"; a pair has two).

    Raises one InputError for all keys.
    """
    if isinstance(source, Bounds):
        return source
    if isinstance(source, str | os.PathLike):
        path = given_path(source, "limits")
        content, where = read_document(path, "a limits file"), str(path)
    else:
        content, where = plain_entries(source, "limits"), "limits"
    units = {axis.named(key): axis.unit(unit) for key, unit in UNITS.items()}
    angle, speed, acceleration = (
        axis.named(key) for key in ("angle_rad", "speed_rad_s", "acceleration_rad_s2")
    )
    by_force = not axis.wraps and FORCE in content
    if not axis.wraps:
        units |= {FORCE: "N"}
    strength = FORCE if by_force else "current_A"
    required = (speed, acceleration, strength, "time_s")
    complaints: list[InputError] = []
    values: dict[str, Any] = {}

    def attempt(read: Callable[[], Any], key: str = "") -> None:
        try:
            values[key] = read()
        except InputError as error:
            complaints.append(error)

    for key in content:
        attempt(partial(refuse_unknown, (key,), (*units, LOOP), ""))
    beside = {} if axis.wraps else {"current_A": f" or {FORCE}"}
    complaints += [
        InputError("", f"{key}{beside.get(key, '')}", "none", why=f", as in {key} = {example}")
        for key, example in zip(required, _EXAMPLES if axis.wraps else _EXAMPLES_OF_A_CARRIAGE, strict=True)
        if key not in content
    ]
    if by_force and "current_A" in content:
        complaints.append(InputError("", f"only one of current_A and {FORCE}", "both"))
    for key in required:
        if key in content:
            attempt(partial(_number, content[key], key, units), key)
    if LOOP in content:
        attempt(partial(read_number, content[LOOP], LOOP, 0.0, True), LOOP)
    if angle in content:
        attempt(partial(_ends, content[angle], angle, units), angle)
    if values.get("time_s", LEAST_TIME_S) < LEAST_TIME_S:
        complaints.append(InputError("time_s", f"at least {LEAST_TIME_S:g} s", f"{values['time_s']:g}"))
    if values.get("time_s", LEAST_TIME_S) > MOST_TIME_S:
        complaints.append(InputError("time_s", f"at most {MOST_TIME_S:g} s", f"{values['time_s']:g}"))
    if complaints:
        raise together(where, complaints)
    return Bounds(
        values[speed],
        values[acceleration],
        values[strength],
        values["time_s"],
        values.get(angle),
        by_force,
        values.get(LOOP),
    )


def _ends(value: object, key: str, units: Mapping[str, str]) -> tuple[float, float]:
    low, high = (_value(end, key, units) for end in read_pair(value, key))
    if not low < high:
        raise InputError(key, "lower before upper", f"[{low:g}, {high:g}]")
    return low, high


def _number(value: object, key: str, units: Mapping[str, str]) -> float:
    return read_number(_value(value, key, units), key, 0.0, True)


def _value(value: object, key: str, units: Mapping[str, str]) -> float:
    return parse_value(value, units[key], key) if isinstance(value, str) else read_number(value, key)


Array = NDArray[np.floating]


@dataclass(frozen=True)
class Reference:
    """A reference on the motor side at `RATE_HZ`.

    Attributes:
        t, theta, omega, alpha: time [s], angle [rad], velocity [rad/s] and acceleration [rad/s^2], (n,).
    """

    t: Array
    theta: Array
    omega: Array
    alpha: Array

    @property
    def seconds(self) -> float:
        """Duration [s]."""
        return float(self.t[-1])


@dataclass(frozen=True)
class Segment:
    """A part of a motion, from rest to rest."""

    pattern: str  # description, a format string for `sizes`, which scale with the velocity
    omega: Array  # velocity [rad/s], (n,)
    sizes: tuple[float, ...] = ()

    def words(self, axis: AxisKind) -> str:
        """Description of the motion."""
        return self.pattern.format(*(f"{size:.3g}" for size in self.sizes), rad=axis.unit("rad"))

    def scaled(self, factor: float) -> Segment:
        """The motion with its velocity scaled, in the same time."""
        return Segment(self.pattern, factor * self.omega, tuple(factor * size for size in self.sizes))


def joined(parts: Sequence[Segment], bounds: Bounds) -> Reference:
    """The pieces in sequence, from the middle of the allowed angles, at rest at the end.

    The number of steps is a multiple of that of the coarser firmware table.
    """
    omega = np.concatenate([part.omega for part in parts])
    dt, step = 1.0 / RATE_HZ, round(RATE_HZ / FIRMWARE_HZ)
    omega = np.concatenate([omega, np.zeros(step + -len(omega) % step + 1)])
    middle = 0.0 if bounds.angle is None else 0.5 * sum(bounds.angle)
    theta = middle + np.concatenate([[0.0], np.cumsum(0.5 * (omega[1:] + omega[:-1]) * dt)])
    return Reference(np.arange(len(omega)) * dt, theta, omega, np.gradient(omega, dt))


def pieces(bounds: Bounds, seconds: float, rng: np.random.Generator) -> Iterator[Segment]:
    """The pieces on offer, each at most this long [s] and within a margin of the bounds."""
    top, steep = (1.0 - MARGIN) * bounds.speed, ACCELERATION_PART * bounds.acceleration
    for low, high in ((0.005, 0.1), (0.02, 0.3), (0.05, 1.0), (0.3, 1.0)):
        for order in ("rising", "falling"):
            yield from _speeds(low * top, high * top, order == "falling", steep, seconds, bounds)
    for part in (0.005, 0.015, 0.05, 0.15, 0.3, 0.6, 1.0):
        for hold in (0.0, 1.0, 3.0):
            yield from _strokes(part * top, hold, steep, seconds, bounds)
    for reach in (0.01, 0.1, 1.0):
        yield from _reversals(reach, top, steep, seconds, bounds)
    for fastest in (0.5, 1.5, 4.0):
        for _ in range(4):
            yield from _sines(top, fastest, steep, seconds, bounds, rng)


def _speeds(
    low: float, high: float, falling: bool, steep: float, seconds: float, bounds: Bounds
) -> Iterator[Segment]:
    """Constant speeds in geometric steps and alternating directions; only for unlimited rotation."""
    if bounds.angle is not None:
        return
    count = max(2, int(seconds / 2.0))
    sizes = np.geomspace(low, high, count)
    sizes = sizes[::-1] if falling else sizes
    speeds = sizes * (-1.0) ** np.arange(count)
    last = _ramp(speeds[-1], steep)
    omega = _timed(speeds, np.full(count, (seconds - last) / count), steep)
    if omega is not None:
        order = "falling" if falling else "rising"
        yield Segment(
            f"constant speeds in alternating directions, {order}, {{}} to {{}} {{rad}}/s", omega, (low, high)
        )


def _strokes(speed: float, hold: float, steep: float, seconds: float, bounds: Bounds) -> Iterator[Segment]:
    """Strokes at one speed, held for `hold` [s] or up to the angle limits; with 0, all is acceleration."""
    ramp = _ramp(2.0 * speed, steep)
    if bounds.angle is not None:
        room = (1.0 - MARGIN) * (bounds.angle[1] - bounds.angle[0])
        # The first ramp, from rest, is shorter than the others, so the first end is the farthest, at
        # speed * (hold / 2 + 9/16 ramp) by the integral of the smoothstep.
        longest = room / speed - 1.125 * ramp
        if longest < 0.0:
            return
        hold = min(hold, longest)
    # Half a stroke first: the strokes are then centred.
    strokes = 2 * int((seconds - ramp) / (2.0 * (hold + ramp)))
    if strokes < 2:
        return
    lengths = np.r_[0.5, np.ones(strokes - 1), 0.5] * (hold + ramp)
    signs = (-1.0) ** np.arange(strokes + 1)
    omega = _timed(signs * speed, lengths, steep)
    if omega is not None and len(omega) <= seconds * RATE_HZ + 1:
        word = f"held for {hold:.2g} s" if hold else "turned at once"
        yield Segment(f"strokes in both directions at {{}} {{rad}}/s, {word}", omega, (speed,))


def _reversals(reach: float, top: float, steep: float, seconds: float, bounds: Bounds) -> Iterator[Segment]:
    """Slow strokes, back and forth, that grow from 3 % of the reach, each twice as far as the last."""
    full = WHOLE_TURNS if bounds.angle is None else 0.5 * (1.0 - MARGIN) * np.ptp(bounds.angle)
    end, cycles = reach * full, 6
    amplitudes = end * np.geomspace(0.03, 1.0, cycles)
    t = np.arange(int(seconds * RATE_HZ)) / RATE_HZ
    period = seconds / cycles
    phase, which = (t % period) / period, np.minimum((t / period).astype(int), cycles - 1)
    # (1 - cos)/2 has no velocity at its ends.
    rate = 2.0 * np.pi / period
    omega = amplitudes[which] * 0.5 * rate * np.sin(2.0 * np.pi * phase)
    alpha = amplitudes[which] * 0.5 * rate**2
    if np.max(np.abs(omega)) < top and np.max(alpha) < steep:
        yield Segment("reversals that grow to {} {rad}", np.append(omega, 0.0), (end,))


def _sines(
    top: float, fastest: float, steep: float, seconds: float, bounds: Bounds, rng: np.random.Generator
) -> Iterator[Segment]:
    """A sum of five sines up to `fastest` [Hz], faded in and out, as large as the bounds allow."""
    t = np.arange(int(seconds * RATE_HZ) + 1) / RATE_HZ
    slow = min(max(2.0 / seconds, 0.05), 0.5 * fastest)
    frequency = slow * np.exp(rng.uniform(0.0, np.log(fastest / slow), 5))
    size, shift = rng.uniform(0.3, 1.0, 5), rng.uniform(-np.pi, np.pi, 5)
    fade = _step(t / 0.8) * _step((t[-1] - t) / 0.8)
    omega = fade * np.sum(
        size[:, None] * np.sin(2.0 * np.pi * frequency[:, None] * t + shift[:, None]), axis=0
    )
    omega -= fade * np.sum(omega) / np.sum(fade)  # it ends where it began
    scales = [top / np.max(np.abs(omega)), steep / np.max(np.abs(np.gradient(omega, 1.0 / RATE_HZ)))]
    if bounds.angle is not None:
        way = np.cumsum(omega) / RATE_HZ
        scales.append(0.5 * (1.0 - MARGIN) * np.ptp(bounds.angle) / np.max(np.abs(way)))
    yield Segment(f"a sum of sines, 5 frequencies to {np.max(frequency):.2g} Hz", min(scales) * omega)


def _ramp(change: Any, steep: float) -> Any:
    """Duration [s] of a smoothstep by this change of speed: its peak rate is 1.5 times the mean."""
    return 1.5 * np.abs(change) / steep


def _timed(speeds: Array, lengths: Array, steep: float) -> Array | None:
    """Constant speeds of these durations [s], each beginning with a ramp, and a last ramp to rest.

    None if a ramp is longer than its duration.
    """
    starts, changes = np.r_[0.0, np.cumsum(lengths)], np.diff(speeds, prepend=0.0, append=0.0)
    ramps = _ramp(changes, steep)
    if np.any(ramps > np.r_[lengths, np.inf]):
        return None
    t = np.arange(int(np.ceil((starts[-1] + ramps[-1]) * RATE_HZ)) + 1) / RATE_HZ
    part = np.searchsorted(starts, t, side="right") - 1
    change, ramp = changes[part], ramps[part]
    done = np.divide(t - starts[part], ramp, out=np.ones_like(t), where=ramp > 0.0)
    omega = np.r_[0.0, np.cumsum(changes)][part] + change * _step(done)
    omega[-1] = 0.0
    return omega


def _step(x: Array) -> Array:
    """Smoothstep: 0 below 0, 1 above 1, with a continuous derivative."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)
