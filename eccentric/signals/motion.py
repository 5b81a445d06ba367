"""The motion of the motor: its angle without wraps, velocity and acceleration, and the step of its sensor."""

from __future__ import annotations

import dataclasses
import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.model import TURNING, AxisKind
from eccentric.signals import filters, limits
from eccentric.signals.filters import joined, rows_of_each, stretches

# Lines of a drive's spectrum: the angle of a drive without an encoder, and ripple of a high order.
#
# An unbalanced mass, or the poles of the motor, repeat with the angle, so that the phase of their line is the
# angle.  A logged speed says where to look for it, and differs from it where one of the two clocks is wrong.
#
# Cogging repeats as often per turn as slots and poles have a common multiple: 12 slots and 14 poles make
# 84. The drive as logged is summed in bins of the angle, without what follows the speed and the low orders;
# a line is the power of an order over that of those around it.


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
    padded = np.pad(power, limits.AROUND_A_LINE // 2, mode="edge")  # SciPy's filter is slow to import
    around = np.median(np.lib.stride_tricks.sliding_window_view(padded, limits.AROUND_A_LINE), axis=1)
    floor = np.maximum(around / np.log(2.0), 1.0)
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


if TYPE_CHECKING:
    from eccentric.rigs import Rig
    from eccentric.signals.table import Table


# Whether angle and speed of a log are consistent: wrapped angles are unwrapped, the rest is reported.
#
# An angle that restarts at every turn, a speed in revolutions per minute and a wrong sign are all valid
# numbers, and a fit to them is nonsense that looks like a comparison of models.


Integers = NDArray[np.int64]


_UNITS = {
    60.0 / TURN: "the speed is in rpm",
    360.0 / TURN: "the speed is in deg/s, or the {angle} is in {rad}",
    1.0 / TURN: "the speed is in rev/s, or the {angle} is in {rad}",
    TURN / 360.0: "the {angle} is in deg",
    TURN: "the {angle} is in rev",
    1e3: "the time is in ms",
    1e6: "the time is in us",
}


def unwrapped(
    t: Array, theta: Array, segment: Integers, run: Integers, mu: float | None, axis: AxisKind = TURNING
) -> tuple[Array, str]:
    """Return the motor angle [rad] (n,) without wraps, and a warning, empty where there are none.

    An angle wraps at one turn of the motor or, with the gear ratio known, of the link. Across a gap in time
    it is continued at the speed before and after; each run starts at its logged angle.
    """
    periods = {"motor": TURN} | ({} if mu in (None, 1.0) else {"link": TURN / mu})
    if _largest_step(theta, segment) <= limits.WRAP_FULL * min(periods.values()):
        return theta, ""
    found = [
        (_largest_step(smooth, segment), turns, smooth, count)
        for turns, period in periods.items()
        for smooth, count in [_unwrap(t, theta, segment, run, period)]
        if count
    ]
    if not found:
        degrees = [math.degrees(period) for period in periods.values()]
        if any(_unwrap(t, theta, segment, run, period)[1] for period in degrees):
            jumps = f"by 360 {axis.unit('rad')} (or that over {axis.named('mu')})"
            return theta, f"the {axis.term('angle')} jumps {jumps}: is it in deg?"
        return theta, ""
    largest, turns, smooth, count = min(found, key=lambda one: one[0])
    turn = axis.term(f"turn of the {turns}")
    text = f"the {axis.term('angle')} is wrapped at one {turn}, {count} times: it is unwrapped"
    if largest > limits.WRAP_HOLE * periods[turns]:
        text += f", uncertain at up to {largest / periods[turns]:.2g} turns from row to row"
    if turns == "motor" and "link" in periods:
        text += "; the log does not show in which turn a run starts (theta_zero_rad sets it)"
    return smooth, text


def _unwrap(t: Array, theta: Array, segment: Integers, run: Integers, period: float) -> tuple[Array, int]:
    """Return the angle (n,) unwrapped at the period, and the number of wraps."""
    steps = np.diff(theta) / period
    steps[np.diff(segment) != 0] = 0.0
    sizes = np.abs(steps)
    narrow = all(np.ptp(theta[rows]) <= limits.WRAP_SPAN * period for rows in rows_of_each(run))
    whole = (
        not np.any((sizes > limits.WRAP_HOLE) & (sizes < limits.WRAP_FULL))
        and np.max(sizes, initial=0.0) < 2.0 - limits.WRAP_FULL
    )
    if not np.any(sizes > limits.WRAP_FULL) or not (narrow or whole):
        return theta, 0
    turns = np.concatenate([[0.0], np.cumsum(-np.round(steps))])
    starts = np.flatnonzero(np.diff(segment, prepend=-1))
    for first, last in zip(starts[1:], starts[1:] - 1, strict=True):
        if run[first] != run[last]:
            turns[first:] -= turns[first]
            continue
        smooth = theta + period * turns
        ahead = _speed(t, smooth, np.flatnonzero(segment == segment[first])[: limits.COMPARED_ROWS])
        behind = _speed(t, smooth, np.flatnonzero(segment == segment[last])[-limits.COMPARED_ROWS :])
        expected = smooth[last] + 0.5 * (ahead + behind) * (t[first] - t[last])
        turns[first:] += np.round((expected - smooth[first]) / period)
    return theta + period * turns, int(np.count_nonzero(np.round(steps)))


def _speed(t: Array, theta: Array, rows: Integers) -> float:
    return 0.0 if len(rows) < 2 else float((theta[rows[-1]] - theta[rows[0]]) / (t[rows[-1]] - t[rows[0]]))


def _largest_step(theta: Array, segment: Integers) -> float:
    return float(np.max(np.abs(np.diff(theta)[np.diff(segment) == 0]), initial=0.0))


def speed_factor(t: Array, theta: Array, omega: Array, segment: Integers) -> tuple[float, float] | None:
    """Return a logged speed [rad/s] (n,) over the slope of the angle, and their correlation; None at rest.

    The turns of both over the same 0.2 s, or five rows, are compared.
    """
    rise: list[Array] = []
    told: list[Array] = []
    for rows in rows_of_each(segment):
        if len(rows) > limits.COMPARED_ROWS:
            span = max(limits.COMPARED_ROWS, round(limits.COMPARED_S / float(np.median(np.diff(t[rows])))))
            integral = _turned(omega[rows], t[rows])
            rise.append(theta[rows][span:] - theta[rows][:-span])
            told.append(integral[span:] - integral[:-span])
    x, y = (np.concatenate([np.zeros(0), *parts]) for parts in (rise, told))
    size = float(x @ x)
    if size == 0.0:
        return None
    return float(x @ y) / size, float(x @ y) / math.sqrt(size * float(y @ y)) if np.any(y) else 0.0


def speed_doubt(
    t: Array, theta: Array, omega: Array, segment: Integers, mu: float | None, axis: AxisKind = TURNING
) -> tuple[str, bool]:
    """Return what is wrong with a logged speed [rad/s] (n,), by the slope of the angle, and whether it asks.

    The text is empty if nothing is wrong.
    """
    found = speed_factor(t, theta, omega, segment)
    if found is None:
        return "", False
    factor, correlation = found
    angle = axis.term("angle")
    if abs(correlation) < limits.LEAST_CORRELATION:
        text = f"the logged speed does not follow the slope of the {angle} (correlation {correlation:.2f})"
        return f"{text}: do both belong to one shaft?", True
    if limits.LEAST_SPEED_FACTOR <= factor <= limits.LARGEST_SPEED_FACTOR:
        return "", False
    cause = _cause(factor, mu, axis)
    text = f"the logged speed is {factor:.4g} times the slope of the {angle}"
    return (f"{text}: {cause}?", True) if cause else (text, False)


def _cause(factor: float, mu: float | None, axis: AxisKind) -> str:
    """Return the simplest and closest explanation of the factor; empty if there is none."""
    gears = {}
    if mu is not None and mu != 1.0:
        gears = dict.fromkeys((mu, 1.0 / mu), "they are on opposite sides of the gear")
        gears |= dict.fromkeys(
            (mu**2, mu**-2), f"{axis.named('mu')} = {mu:.4g} is the reciprocal of what it should be"
        )
    found = []
    for unit, gear in itertools.product((1.0, *_UNITS), (1.0, *gears)):
        words = [_UNITS.get(unit), gears.get(gear), "their signs differ" if factor < 0.0 else None]
        terms = {"angle": axis.term("angle"), "rad": axis.unit("rad")}
        said = [word.format(**terms) for word in words if word]
        off = abs(math.log(abs(factor) / (unit * gear)))
        if off <= limits.NEAR_CAUSE:
            found.append((len(said), off, " and ".join(said)))
    return min(found, default=(0, 0.0, ""))[2]


# The motion on the motor side.


def motor_side(table: Table, rig: Rig, motor: str, link: str) -> Array | None:
    """Convert a channel to the motor side: angles and speeds are divided by mu, torques multiplied."""
    if motor in table.channels:
        return table.channels[motor]
    if link not in table.channels:
        return None
    mu = rig.value("mu")
    return table.channels[link] * (mu if link == "torque_l" else 1.0 / mu)


def of_the_motor(table: Table, rig: Rig) -> tuple[Table, list[str]]:
    """Return the table with angle and speed of the motor, and warnings.

    The angle is the logged one, unwrapped, or the integral of the logged speed.
    """
    logged = motor_side(table, rig, "theta_m", "theta_l")
    omega = motor_side(table, rig, "omega_m", "omega_l")
    if logged is not None:
        theta, warnings = _smooth(table, rig, logged), []
    elif rig.log.by_line and omega is not None:
        theta, warnings = _by_line(table, rig, omega)
    else:
        theta, warnings = _integral(table, omega, rig.axis)
    own = {"theta_m": theta} | ({} if omega is None else {"omega_m": omega})
    rest = {c: x for c, x in table.channels.items() if not c.startswith(("theta_", "omega_"))}
    return dataclasses.replace(table, channels=rest | own), warnings


def _smooth(table: Table, rig: Rig, theta: Array) -> Array:
    if not rig.axis.wraps:
        return theta
    t = table.channels["time"]
    return unwrapped(t, theta, stretches(t, table.run), table.run, rig.known.get("mu"))[0]


def _by_line(table: Table, rig: Rig, omega: Array) -> tuple[Array, list[str]]:
    """The angle by the line that the drive signal of each run has once per turn, and what its speed says."""
    sides = (("current", ""), ("torque", "torque_l"), ("voltage", ""))
    signals = [motor_side(table, rig, motor, link) for motor, link in sides]
    drive = next(x for x in signals if x is not None)
    t, theta = table.channels["time"], np.empty(len(omega))
    ratios: list[float] = []
    orders: list[int] = []
    for rows in rows_of_each(table.run):
        name = table.run_names[int(table.run[rows[0]])]
        line = turn_line(t[rows], drive[rows], omega[rows], f"{rig.path}: {name}")
        theta[rows] = line.theta
        orders.append(line.order)
        ratios.append(line.frequency * TURN / abs(float(np.median(omega[rows]))))
    ratio = float(np.median(ratios))
    text = f"angle: line {max(orders)}/turn, {ratio:.4g} times speed"
    if not abs(ratio - 1.0) > limits.SAME_CLOCK:
        return theta, [text]
    return theta, [f"{text}; sample_rate_hz = {1.0 / float(np.median(np.diff(t))) / ratio:.4g}?"]


def _turned(omega: Array, t: Array) -> Array:
    """The integral of the speed from the first row on, by trapezoids; `scipy.integrate` is slow to import."""
    return np.concatenate([[0.0], np.cumsum(np.diff(t) * (omega[1:] + omega[:-1]) / 2.0)])


def _integral(table: Table, omega: Array | None, axis: AxisKind) -> tuple[Array, list[str]]:
    if omega is None:
        raise AssertionError("read_table requires an angle or a speed")
    t = table.channels["time"]
    theta = joined(table.run, lambda rows: _turned(omega[rows], t[rows]))
    angle = axis.term("angle")
    warnings = [f"no {angle} is logged: it is the integral of the speed, from 0 at the start of each run"]
    if stretches(t, table.run)[-1] > table.run[-1]:
        warnings.append(f"the integrated {angle} is uncertain after a gap in time")
    return theta, warnings


def uneven(table: Table, axis: AxisKind) -> list[str]:
    """Return warnings about uneven time steps; one across dropped rows does not count."""
    t = table.channels["time"]
    piece = stretches(t, table.run) + np.cumsum(table.after_dropped)
    if all(filters.is_even(t[rows]) for rows in rows_of_each(piece)):
        return []
    steps = np.diff(t)[np.diff(piece) == 0]
    usual = float(np.median(steps))
    odd = int(np.count_nonzero(np.abs(steps / usual - 1.0) > limits.UNEVEN_STEP))
    if not odd:  # a clock that drifts against the grid
        return []
    on_grid = all(filters.places_of(t[rows]) is not None for rows in rows_of_each(piece))
    angle = axis.term("angle")
    how = f"{angle} of missing rows is interpolated" if on_grid else f"{angle} is interpolated linearly"
    text = (
        f"time steps are uneven ({odd} of {len(steps)} differ by more than"
        f" {100 * limits.UNEVEN_STEP:.0f} % from the usual {usual:.4g} s): for filtering, the {how}"
    )
    return [text]


def quantum_of(logged: Table, rig: Rig, theta: Array) -> float:
    """Return the step of the motor angle [rad], from the counts or the smallest one seen.

    0 if it is integrated, or a spline through the times of turns, at which it is exact.
    """
    if rig.log.events or ("theta_m" not in logged.channels and "theta_l" not in logged.channels):
        return 0.0
    if rig.log.counts_per_rev is not None:
        gear = 1.0 if "theta_m" in logged.channels else rig.value("mu")
        return 2.0 * np.pi / rig.log.counts_per_rev / gear
    segment = stretches(logged.channels["time"], logged.run)
    changes = np.abs(np.diff(theta))[np.diff(segment) == 0]
    changes = changes[changes > 1e-9 * max(1.0, float(np.max(np.abs(theta))))]
    return float(np.min(changes)) if len(changes) else 0.0


# Which rows move, and which are unaffected by filters at the ends of a stretch or at a switched motor.


Mask = NDArray[np.bool_]


def moving_rows(
    t: Array, theta: Array, segment: Integers, rig: Rig, quantum: float, fitted: Mask
) -> tuple[Mask, float]:
    """Return the moving rows (n,), and the threshold [rad/s]: from the rig or from the rows `fitted`."""
    velocity = joined(segment, lambda rows: filters.span_velocity(t[rows], theta[rows]))
    threshold = rig.sampling.moving_threshold_rad_s
    if threshold is None:
        threshold = _default_threshold(velocity[fitted], quantum)
    moves = joined(segment, lambda rows: filters.moves(t[rows], velocity[rows], threshold))
    return moves.astype(bool), threshold


def _default_threshold(velocity: Array, quantum: float) -> float:
    speeds = np.abs(velocity[np.isfinite(velocity)])
    slow = limits.SLOW * float(np.percentile(speeds, 95.0)) if len(speeds) else 0.0
    return max(limits.QUANTA * quantum / (2.0 * limits.HALF_SPAN_S), slow)


def clear_of_ends(t: Array, segment: Integers) -> Mask:
    """Rows (n,) at least half a second from the ends of every stretch, where filters have transients."""
    return joined(segment, lambda rows: filters.away_from_ends(t[rows]))


def near_switching(t: Array, segment: Integers, off: Mask) -> Mask:
    """Rows (n,) near switching the motor, where filters mix driven and free motion."""
    near = np.zeros(len(t), dtype=bool)
    for row in np.flatnonzero(np.diff(off.astype(int)) & (np.diff(segment) == 0)):
        near |= (np.abs(t - t[row]) < limits.SWITCHING_S) & (segment == segment[row])
    return near


# The white noise of a sensor, from the signal itself, without model or filter.


def white_noise(signal: Array, segment: NDArray[np.int64] | None = None) -> float:
    """Return the RMS of the white noise in a sampled signal (n,), in its unit.

    The fourth difference of a smooth signal vanishes; that of white noise has 70 times the variance. NaN
    marks samples to ignore; differences across the ends of a `segment` (n,) are omitted.
    What a speed loop makes of the steps of its encoder is fast, and cancels in means. Means of 2, 4 and 8
    samples show white noise of the same size: the least size is returned where it is clearly smaller.
    """
    parts = np.zeros(len(signal), np.int64) if segment is None else segment
    found = _of(_differences(signal, parts))
    for length in limits.MEANS:
        left = _differences(*_means(signal, parts, length))
        if len(left) < limits.LEAST_OF_MEANS:
            break
        size = _of(left) * float(np.sqrt(length))
        if size < limits.CLEARLY_LESS * found:
            found = size
    return found


def _differences(signal: Array, segment: NDArray[np.int64]) -> Array:
    """The fourth differences within a segment that have a value."""
    difference = np.diff(signal, 4)
    return difference[np.isfinite(difference) & (segment[4:] == segment[:-4])]


def _of(difference: Array) -> float:
    """The RMS of the white noise that has these fourth differences."""
    return 1.4826 * float(np.median(np.abs(difference - np.median(difference)))) / float(np.sqrt(70.0))


def _means(signal: Array, segment: NDArray[np.int64], length: int) -> tuple[Array, NDArray[np.int64]]:
    """Means of successive groups of `length` samples, NaN across the end of a segment, and their segments."""
    whole = len(signal) // length * length
    parts = segment[:whole].reshape(-1, length)
    means = signal[:whole].reshape(-1, length).mean(axis=1)
    return np.where(parts[:, 0] == parts[:, -1], means, np.nan), parts[:, 0]
