"""Lines of a drive's spectrum: the angle of a drive without an encoder, and ripple of a high order.

An unbalanced mass, or the poles of the motor, repeat with the angle, so that the phase of their line is the
angle.  A logged speed says where to look for it, and differs from it where one of the two clocks is wrong.

Cogging repeats as often per turn as slots and poles have a common multiple: 12 slots and 14 poles make 84.
The drive as logged is summed in bins of the angle, without what follows the speed and the low orders; a line
is the power of an order over that of those around it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from eccentric.core import InputError
from eccentric.signals import limits

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
    if turns * seconds < limits.LINE_TURNS:
        raise InputError(where, f"at least {limits.LINE_TURNS} turns for a line", f"{turns * seconds:.3g}")
    rest = signal - np.mean(signal)
    window = np.hanning(len(t))
    found = np.abs(np.fft.rfft(rest * window, 4 * len(t)))
    hertz = np.fft.rfftfreq(4 * len(t), seconds / (len(t) - 1))
    for order in range(1, limits.LINE_ORDERS + 1):
        near = np.abs(hertz / (order * turns) - 1.0)
        band, around = near < limits.LINE_REACH, near < 3.0 * limits.LINE_REACH
        peak = int(np.argmax(np.where(band, found, 0.0)))
        if found[peak] ** 2 > limits.LINE_POWER * float(np.median(found[around] ** 2)):
            return _tracked(t, rest, order, float(hertz[peak]), math.copysign(1.0, float(np.median(speed))))
    raise InputError(
        where, f"a line at 1 to {limits.LINE_ORDERS} times the speed in the drive signal", "none"
    )


def _tracked(t: Array, rest: Array, order: int, hertz: float, way: float) -> TurnLine:
    """The line near a frequency: its phase over time, and the straight line through that."""
    turned = rest * np.exp(-1j * TURN * hertz * (t - t[0]))
    length = max(3, round(limits.LINE_TRACK / hertz * (len(t) - 1) / float(t[-1] - t[0])))
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


def standing_lines(
    theta: Array, omega: Array, drive: Array, step_s: float, mu: float | None
) -> tuple[int, ...]:
    """The orders above `LOW_ORDERS` that stand out, the strongest first; none in less than a turn.

    Args:
        theta, omega: angle of the motor [rad] from one zero and its velocity [rad/s] on moving rows (n,).
        drive: what measures the torque, as logged (n,), in any unit.
        step_s: time between rows [s]; orders up to 0.4 of the rows of a turn at the median speed are seen.
        mu: speed of the link over that of the motor, None where it is unknown.
    """
    if not len(theta) or np.ptp(theta) < limits.LEAST_TURNS * TURN:
        return ()
    highest = min(
        limits.HIGHEST_LINE, int(limits.PER_TURN * TURN / (float(np.median(np.abs(omega))) * step_s))
    )
    if highest <= limits.LOW_ORDERS:
        return ()
    link = [n * mu for n in range(1, limits.LOW_ORDERS_OF_THE_LINK + 1)] if mu not in (None, 1.0) else []
    orders = [*range(1, limits.LOW_ORDERS + 1), *link]
    phases = np.outer(theta, orders)
    way = np.sign(omega)
    rise = np.gradient(omega)
    known = np.column_stack([np.ones_like(way), way, omega, rise, np.cos(phases), np.sin(phases)])
    rest = drive - known @ np.linalg.lstsq(known, drive, rcond=None)[0]
    count = limits.BINS_PER_CYCLE * limits.HIGHEST_LINE
    bins = np.bincount((theta / TURN % 1.0 * count).astype(int) % count, rest, count)
    # Of white noise, the power has the mean 1.
    power = np.abs(np.fft.rfft(bins)[: highest + 1]) ** 2 / max(float(rest @ rest), 1e-300)
    floor = np.maximum(median_filter(power, limits.AROUND_A_LINE, mode="nearest") / np.log(2.0), 1.0)
    share = 2.0 * power / len(rest)
    found = np.flatnonzero((power > limits.STANDS_OUT * floor) & (share > limits.LEAST_LINE_SHARE))
    found = found[found > limits.LOW_ORDERS]
    strongest = found[np.argsort(-power[found], kind="stable")][: limits.MOST_LINES]
    return tuple(int(n) for n in strongest if _keeps_phase(theta, rest, int(n)))


def _keeps_phase(theta: Array, rest: Array, order: int) -> bool:
    """Whether the parts of a log agree on the phase of a line, as what is fixed to the motor does.

    What the motion itself leaves in the drive has another phase in each part. Of eight parts without a line,
    the square of their sum is an eighth of eight times the sum of their squares.
    """
    waves = rest * np.exp(-1j * order * theta)
    parts = np.array([np.sum(part) for part in np.array_split(waves, limits.PARTS_OF_A_LOG)])
    together = float(abs(np.sum(parts)) ** 2)
    return together > limits.IN_PHASE * limits.PARTS_OF_A_LOG * float(np.sum(np.abs(parts) ** 2))
