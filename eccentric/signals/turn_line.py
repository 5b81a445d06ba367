"""The angle of a drive without an encoder, from the line that its drive signal has once per turn.

An unbalanced mass, or the poles of the motor, repeat with the angle, so that the phase of their line is the
angle.  A logged speed says where to look for it, and differs from it where one of the two clocks is wrong.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.signals.limits import (
    LINE_ORDERS,
    LINE_POWER,
    LINE_REACH,
    LINE_TRACK,
    LINE_TURNS,
)

Array = NDArray[np.float64]

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class TurnLine:
    """A line that repeats `order` times per turn of a nearly constant speed.

    Attributes:
        order: cycles per turn.
        frequency: turns per second by the line [1/s]; error: its standard error for white noise.
        amplitude: of the line, in the unit of the signal.
        theta: angle by the phase of the line [rad] (n,), from a zero of its own.
    """

    order: int
    frequency: float
    error: float
    amplitude: float
    theta: Array


def turn_line(t: Array, signal: Array, speed: Array, where: str = "log") -> TurnLine:
    """The line of the lowest order that stands out of a signal, near the order times the logged speed.

    Args:
        t: times of the rows [s] (n,), at an even rate.
        signal: of the drive (n,), in any unit.
        speed: as logged [rad/s] (n,), nearly constant; where: names the log in messages.

    Raises InputError if the log is too short, or no line stands out.
    """
    turns = abs(float(np.median(speed))) / TURN
    seconds = float(t[-1] - t[0])
    if turns * seconds < LINE_TURNS:
        raise InputError(where, f"at least {LINE_TURNS} turns for a line", f"{turns * seconds:.3g}")
    rest = signal - np.mean(signal)
    window = np.hanning(len(t))
    found = np.abs(np.fft.rfft(rest * window, 4 * len(t)))
    hertz = np.fft.rfftfreq(4 * len(t), seconds / (len(t) - 1))
    for order in range(1, LINE_ORDERS + 1):
        near = np.abs(hertz / (order * turns) - 1.0)
        band, around = near < LINE_REACH, near < 3.0 * LINE_REACH
        peak = int(np.argmax(np.where(band, found, 0.0)))
        if found[peak] ** 2 > LINE_POWER * float(np.median(found[around] ** 2)):
            return _tracked(t, rest, order, float(hertz[peak]), math.copysign(1.0, float(np.median(speed))))
    raise InputError(where, f"a line at 1 to {LINE_ORDERS} times the speed in the drive signal", "none")


def _tracked(t: Array, rest: Array, order: int, hertz: float, way: float) -> TurnLine:
    """The line near a frequency: its phase over time, and the straight line through that."""
    turned = rest * np.exp(-1j * TURN * hertz * (t - t[0]))
    length = max(3, round(LINE_TRACK / hertz * (len(t) - 1) / float(t[-1] - t[0])))
    smooth = np.convolve(turned, np.hanning(length + 2)[1:-1], "same")
    phase = np.unwrap(np.angle(smooth))
    slope = float(np.polyfit(t - t[0], phase, 1, w=np.hanning(len(t) + 2)[1:-1])[0])
    frequency = hertz + slope / TURN
    design = np.column_stack([f(phase + TURN * hertz * (t - t[0])) for f in (np.cos, np.sin)])
    parts = np.linalg.lstsq(design, rest, rcond=None)[0]
    amplitude = float(np.hypot(*parts))
    noise = float(np.std(rest - design @ parts))
    seconds = float(t[-1] - t[0])
    error = math.sqrt(24.0 / len(t)) * noise / (amplitude * seconds) / TURN
    theta = way * (phase + TURN * hertz * (t - t[0])) / order
    return TurnLine(order, frequency / order, error / order, amplitude, theta - theta[0])
