"""The quality of a log under its rig, reported before anything is fitted.

    table, channels, rig -> each signal alone (here)
                         -> angle against speed (`motion`)
                         -> drive against motion, motion against rig (`against_rig`)

A finding is a likely explanation of numbers that cannot all be right; it changes nothing in the log.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eccentric.model import AxisKind
from eccentric.signals.clock import Finding
from eccentric.signals.filters import stretches
from eccentric.signals.limits import LEAST_CORRELATION, MUCH_LOST
from eccentric.signals.motion import speed_doubt, speed_factor, unwrapped
from eccentric.signals.quality import limits
from eccentric.signals.quality.against_rig import rig_findings
from eccentric.signals.table import Table

if TYPE_CHECKING:
    from collections.abc import Iterator

    from eccentric.rigs import Rig
    from eccentric.signals.measured import Channels


# Findings on single signals: gaps, missing rows, clipped and frozen channels, speeds.


Array = NDArray[np.float64]
Integers = NDArray[np.int64]

UNITS = {
    "omega_m": "rad/s", "omega_l": "rad/s", "voltage": "V", "current": "A", "torque": "N m",
    "torque_l": "N m", "theta_m": "rad", "theta_l": "rad",
}  # fmt: skip


@dataclass(frozen=True)
class Record:
    """The rows of the log (n,), as logged; the channels of a coarse log have additional points.

    `speed` [rad/s] is the slope of the angle at the motor, `theta` [rad] the angle there, unwrapped.
    """

    t: Array
    run: Integers
    segment: Integers
    moving: NDArray[np.bool_]
    speed: Array
    theta: Array
    omega_logged: Array | None


def record_of(table: Table, c: Channels) -> Record:
    """Return the channels at the rows of the table; the motor moves unless it is switched off."""
    t, at = table.channels["time"], np.arange(len(table.run))
    if len(t) != len(c.time.t):
        for run in np.unique(table.run):
            points, rows = np.flatnonzero(c.time.run == run), table.run == run
            middles = 0.5 * (c.time.t[points][1:] + c.time.t[points][:-1])
            at[rows] = points[np.searchsorted(middles, t[rows])]
    omega = None if c.motion.omega_logged is None else c.motion.omega_logged[at]
    moving = (c.selection.moving & ~c.motor.off)[at]
    return Record(
        t, table.run, stretches(t, table.run), moving, c.motion.omega_m[at], c.motion.theta_logged[at], omega
    )


def record_findings(table: Table, channels: Channels) -> Iterator[Finding]:
    """Yield findings on dropped rows, gaps, clipped and frozen channels, and on the range of speeds."""
    record = record_of(table, channels)
    yield from table.findings
    yield from _gaps(record, table.after_skipped)
    axis = channels.rig.axis
    signals = {
        name: x for name, x in table.channels.items() if name in UNITS and not name.startswith("theta")
    }
    if channels.motor.coasting:
        signals.pop("torque", None)
    for name, x in signals.items():
        yield from _clipped(name, x, record, axis)
        yield from _frozen(name, x, record, axis)
    yield from _frozen_angle(table, record, axis)
    yield from _speeds(channels)


def _gaps(c: Record, after_skipped: NDArray[np.bool_]) -> Iterator[Finding]:
    """Yield gaps, as the filters define them: steps of more than five times the usual one within a run.

    Those between the windows of a long log are none.
    """
    ends = np.flatnonzero((np.diff(c.segment) != 0) & (np.diff(c.run) == 0) & ~after_skipped[1:])
    if not len(ends):
        return
    steps = c.t[ends + 1] - c.t[ends]
    longest = int(np.argmax(steps))
    whole = sum(float(np.ptp(c.t[c.run == run])) for run in np.unique(c.run))
    part = float(np.sum(steps)) / whole
    text = (
        f"{len(ends)} gap{'s' if len(ends) > 1 else ''} in time, {part:.2g} of the log, the longest"
        f" {steps[longest]:.3g} s after {c.t[ends[longest]]:.6g} s: sections are filtered separately"
    )
    yield Finding("gap", "time", text, len(ends), "warning" if part > MUCH_LOST else "note")


def _runs(x: Array, segment: Integers) -> tuple[Integers, Integers]:
    """Return the first rows and the lengths of runs of equal values, none across a gap."""
    begins = np.flatnonzero(np.concatenate([[True], (np.diff(x) != 0.0) | (np.diff(segment) != 0)]))
    return begins, np.diff(np.append(begins, len(x)))


def _clipped(name: str, x: Array, c: Record, axis: AxisKind) -> Iterator[Finding]:
    """Yield a limit that the channel keeps reaching: equal values in a row there, and only there.

    A coarse or stepped channel has equally long runs of equal values elsewhere, a switched-off one at zero.
    """
    begins, lengths = _runs(x, c.segment)
    values = x[begins]
    inside = (values != np.min(x)) & (values != np.max(x)) & (values != 0.0)
    usual = int(np.max(lengths[inside], initial=1))
    for limit, word in ((np.max(x), "largest"), (np.min(x), "smallest")):
        at = (values == limit) & (lengths >= max(limits.SHORT_RUN, limits.CLIPPED_RUN * usual))
        rows = int(np.sum(lengths[at]))
        if limit != 0.0 and np.count_nonzero(at) > 1 and rows > limits.CLIPPED * len(x):
            text = (
                f"{axis.named(name)} stays at its {word} value, {limit:.6g}"
                f" {axis.unit(UNITS[name])}, in {rows} of {len(x)} rows "
                f"({np.count_nonzero(at)} times): it is clipped there; measure with a wider range or less "
                "drive, or exclude these rows with `use`"
            )
            yield Finding("saturated", name, text, rows, "warning")


def _frozen(name: str, x: Array, c: Record, axis: AxisKind) -> Iterator[Finding]:
    """Yield a channel that keeps one value while the drive moves, which its own noise excludes."""
    moving = c.moving
    if np.any(moving) and np.ptp(x[moving]) == 0.0:
        text = (
            f"{axis.named(name)} is {x[moving][0]:.6g} {axis.unit(UNITS[name])} in all moving"
            f" rows: it is not recorded, or a wrong "
            "column is mapped"
        )
        yield Finding("frozen", name, text, int(np.count_nonzero(moving)), "warning")
        return
    begins, lengths = _runs(x, c.segment)
    ends = begins + lengths - 1
    inside = (x[begins] != np.max(x)) & (x[begins] != np.min(x)) & (x[begins] != 0.0)
    long = inside & (lengths >= limits.FROZEN_ROWS) & (c.t[ends] - c.t[begins] >= limits.FROZEN_S)
    if not np.any(long):
        return
    again = np.concatenate([[False], np.diff(x) == 0.0])
    others = np.repeat(np.arange(len(begins)) != np.argmax(np.where(long, lengths, 0)), lengths)
    everywhere = max(_part(again, others), _part(again, others & _steady(c)))

    def is_frozen(k: int) -> bool:
        stretch = slice(begins[k], ends[k] + 1)
        # Each run may be sampled, or averaged by the drive, differently.
        rest = (c.run == c.run[begins[k]]) & others
        rest[stretch] = False
        equal = max(everywhere, _part(again, rest))
        if equal > limits.MOST_EQUAL:
            return False
        # Equal pairs occur by chance, a fraction `equal`: that many of them in a row, anywhere in the log.
        needed = 1.0 + np.log(limits.CHANCE / len(x)) / np.log(max(equal, limits.LEAST_EQUAL))
        return lengths[k] >= needed and float(np.mean(moving[stretch])) > limits.MOSTLY_MOVING

    found = np.array([k for k in np.flatnonzero(long) if is_frozen(int(k))], dtype=np.int64)
    if len(found):
        yield _stretch(name, x, c, begins[found], lengths[found], "while the drive moves", axis)


def _part(what: NDArray[np.bool_], rows: NDArray[np.bool_]) -> float:
    return float(np.mean(what[rows])) if np.any(rows) else 0.0


def _steady(c: Record) -> NDArray[np.bool_]:
    """Rows at a steady speed: a filtered speed and a command without noise repeat themselves there."""
    ahead = np.minimum(np.arange(len(c.t)) + limits.FROZEN_ROWS, len(c.t) - 1)
    change = np.abs(c.speed[ahead] - c.speed)
    return c.moving & (change < limits.STEADY * np.nanquantile(np.abs(c.speed), limits.TOP_SPEED))


def _stretch(
    name: str, x: Array, c: Record, begins: Integers, lengths: Integers, why: str, axis: AxisKind
) -> Finding:
    k = int(np.argmax(lengths))
    first, last = begins[k], begins[k] + lengths[k] - 1
    times = f"{len(begins)} times, the longest" if len(begins) > 1 else "once,"
    text = (
        f"{axis.named(name)} keeps one value {why}, {times} {c.t[last] - c.t[first]:.3g} s at {x[first]:.6g} "
        f"{axis.unit(UNITS[name])} from {c.t[first]:.6g} s: the sensor or its connection failed; "
        "exclude these rows with `use`"
    )
    return Finding("frozen", name, text, int(np.sum(lengths)), "warning")


def _frozen_angle(table: Table, c: Record, axis: AxisKind) -> Iterator[Finding]:
    """Yield an angle that freezes and then catches up in one step, or freezes while a logged speed continues.

    A sticking link is at rest as well, but starts again without a jump.
    """
    name = next((name for name in ("theta_m", "theta_l") if name in table.channels), None)
    if name is None:
        return
    x = c.theta
    begins, lengths = _runs(x, c.segment)
    ends = begins + lengths - 1
    steps = np.abs(np.diff(x, append=x[-1]))
    steps[np.flatnonzero(np.diff(c.segment))] = 0.0
    usual = float(np.quantile(steps, limits.LARGEST_STEP)) if len(steps) else 0.0
    long = (lengths >= limits.FROZEN_ROWS) & (c.t[ends] - c.t[begins] >= limits.FROZEN_S)
    jumps = steps[ends] > limits.JUMP * usual
    goes_on = np.zeros(len(begins), dtype=bool)
    if c.omega_logged is not None:
        moved = np.concatenate([[0.0], np.cumsum(c.omega_logged[1:] * np.diff(c.t))])
        goes_on = np.abs(moved[ends] - moved[begins]) > limits.BEHIND * usual
    found = long & (jumps | goes_on) & (usual > 0.0)
    if np.any(found):
        yield _stretch(name, x, c, begins[found], lengths[found], "and then jumps or falls behind", axis)


def _speeds(c: Channels) -> Iterator[Finding]:
    rows = c.selection.fit_rows & ~c.motor.off
    speed = np.abs(c.motion.omega_m[rows])
    if not len(speed):
        return
    low, high = np.quantile(speed, limits.NEARLY_ALL)
    if high < limits.ONE_SPEED * low:
        text = (
            f"nearly all moving rows are at one speed, {low:.4g} to {high:.4g}"
            f" {c.rig.axis.unit('rad/s')} at the motor: Coulomb "
            "and viscous friction cannot be distinguished; measure at several speeds, a factor of five apart"
        )
        yield Finding("one_speed", "omega_m", text, len(speed), "warning")


def assess(table: Table, channels: Channels, rig: Rig) -> tuple[Finding, ...]:
    """Return the findings about the logs, warnings first.

    Args:
        table: the kept rows in SI as they were logged.
        channels: the same rows as signals on the motor side; comparisons with the rig use only the rows that
            a fit may use, never the held-out ones.
        rig: what is known.
    """
    found = list(record_findings(table, channels))
    # Consequences of a failed channel are not reported again.
    if not any(finding.kind == "frozen" for finding in found):
        found += [*_speed(table, channels, rig), *rig_findings(channels, rig)]
    return tuple(sorted(found, key=lambda finding: finding.severity == "note"))


def _speed(table: Table, channels: Channels, rig: Rig) -> Iterator[Finding]:
    """Angle and speed of one shaft describe the same motion."""
    c, mu = record_of(table, channels), rig.known.get("mu")
    name = next((name for name in ("theta_m", "theta_l") if name in table.channels), None)
    if name is None:
        return
    gear = rig.value("mu") if name == "theta_l" else 1.0
    logged = table.channels[name] / gear
    theta, said = unwrapped(c.t, logged, c.segment, c.run, mu, rig.axis)
    if said:
        kind, severity = ("wrong_unit", "warning") if theta is logged else ("wrapped", "note")
        yield Finding(kind, name, said, len(c.t), severity)
    if c.omega_logged is None:
        return
    doubt, asks = speed_doubt(c.t, c.theta, c.omega_logged, c.segment, mu, rig.axis)
    told = speed_factor(c.t, c.theta, c.omega_logged, c.segment)
    if doubt and told:
        factor, correlation = told
        follows = abs(correlation) >= LEAST_CORRELATION
        kind = ("wrong_sign" if factor < 0.0 else "wrong_unit") if follows else "mismatch"
        name = "omega_m" if "omega_m" in table.channels else "omega_l"
        yield Finding(kind, name, _advised(doubt, asks, rig.axis), len(c.t), "warning")


def _advised(doubt: str, asks: bool, axis: AxisKind) -> str:
    """What is wrong with the logged speed, possibly as a question, and what to do."""
    return f"{doubt}{' C' if asks else '; c'}orrect [columns] or {axis.named('mu')} in the rig file"
