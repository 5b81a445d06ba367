"""From logs and a rig to the signals that a model is fitted on: SI units, motor side, masks, held-out part.

    logs, rig -> table (columns in SI) -> stretches without gap -> theta, w, dw/dt -> masks -> Channels

The reference residual takes w and dw/dt from the low-passed angle, current and voltage as they were logged.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from eccentric.errors import InputError, few
from eccentric.identify import filters
from eccentric.identify.bandwidth import suited
from eccentric.identify.holdout import Holdout, hold_out
from eccentric.identify.plausible import unwrapped
from eccentric.identify.quality import Finding, assess
from eccentric.identify.refine import FACTOR, is_coarse, logged_step, refined
from eccentric.identify.table import Table, read_table

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from eccentric.identify.rig import Rig

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

QUANTA = 10.0
"""Default moving threshold: this many encoder steps within the 40 ms of the central difference ..."""
SLOW = 0.03
"""... and at least this fraction of the 95th percentile of the speed, outside the held-out part."""
SWITCHING_S = 0.1
"""Rows this near to a switching of the motor are not used, s."""
UNEVEN = 0.2
"""A time step this far from the median, as a fraction of it, is counted as uneven."""


@dataclass(frozen=True)
class Channels:
    """Signals of all kept rows, each (n,), None where the logs have none; n counts rows, moving or not.

    `theta_m` [rad], `omega_m` [rad/s], `alpha_m` [rad/s^2] come from the low-passed angle, without phase
    lag, the zero angle taken out; `theta_logged` [rad], `omega_logged` [rad/s] are the sensors' own. All
    are on the motor side, `torque` [N m] too. `voltage` [V] has delay and offset taken out. `temperature`
    is in degC. `rig` is the one that was asked for, with what suits the log where it says nothing. A log too
    coarse for the low pass has `points_per_row` points for each of its rows, which are `logged_step_s` apart.
    `segment` numbers the stretches without gap. `moving` is `filters.moves`; `usable` is moving, away from
    the ends, and wanted by the rig's `use`; `off` is where the motor is switched off: no
    drive torque, no back-EMF. `drive` is the channel that measures the
    drive torque. `quantum_rad` is the step of the motor angle, 0 where there is none to see.
    """

    t: Array
    theta_m: Array
    omega_m: Array
    alpha_m: Array
    theta_logged: Array
    omega_logged: Array | None
    voltage: Array | None
    voltage_logged: Array | None
    current: Array | None
    torque: Array | None
    temperature: Array | None
    run: NDArray[np.int64]
    run_names: tuple[str, ...]
    segment: NDArray[np.int64]
    moving: Mask
    usable: Mask
    off: Mask
    holdout: Holdout
    drive: str
    moving_threshold_rad_s: float
    quantum_rad: float
    input_delay_s: float
    theta_zero_rad: float
    voltage_offset_V: float
    logged_step_s: float
    points_per_row: int
    rows_read: int
    rows_rejected: int
    warnings: tuple[str, ...]
    findings: tuple[Finding, ...]
    rig: Rig

    @property
    def held_out(self) -> Mask:
        """Rows (n,) of the held-out part, usable or not."""
        return self.holdout.rows

    @property
    def fit_rows(self) -> Mask:
        """Rows (n,) that a fit may look at: usable and not held out."""
        return self.usable & ~self.held_out

    @property
    def score_rows(self) -> Mask:
        """Rows (n,) of the reported held-out error: usable and held out."""
        return self.usable & self.held_out

    @property
    def driven(self) -> Channels:
        """The same channels, the rows with the motor switched off not usable."""
        return dataclasses.replace(self, usable=self.usable & ~self.off) if np.any(self.off) else self

    @property
    def counts(self) -> dict[str, int]:
        """Rows read, used (fitted or scored), held out (scored), rejected (not numbers)."""
        return {
            "read": self.rows_read,
            "used": round(np.count_nonzero(self.usable) / self.points_per_row),
            "held_out": round(np.count_nonzero(self.score_rows) / self.points_per_row),
            "rejected": self.rows_rejected,
        }

    def realigned(
        self,
        rig: Rig,
        *,
        input_delay_s: float | None = None,
        theta_zero_rad: float | None = None,
        voltage_offset_V: float | None = None,
    ) -> Channels:
        """Return the same channels with another delay, zero angle or offset (None: as it is).

        This is the seam for a fit that estimates them. The voltage that acts at t is the logged one at t -
        delay, interpolated within a stretch (its first value before that); for a command that is held over
        a step, the delay so contains half a step. The zero angle is on the link side: without mu in the
        rig, InputError.
        """
        delay = self.input_delay_s if input_delay_s is None else input_delay_s
        offset = self.voltage_offset_V if voltage_offset_V is None else voltage_offset_V
        zero = self.theta_zero_rad if theta_zero_rad is None else theta_zero_rad
        moved = zero - self.theta_zero_rad
        voltage = self.voltage_logged
        if voltage is not None:
            voltage = _delayed(self.t, voltage, self.segment, delay) - offset
        return dataclasses.replace(
            self,
            theta_m=self.theta_m - (moved / rig.value("mu") if moved else 0.0),
            voltage=voltage,
            input_delay_s=delay,
            theta_zero_rad=zero,
            voltage_offset_V=offset,
        )


def read_channels(paths: Sequence[str | Path], rig: Rig) -> Channels:
    """Return the channels of logs under a rig, with its delay, zero angle and offset (0 where "estimate").

    Raises InputError for whatever `read_log` and `table.read_table` refuse, a drive that no channel
    measures, and a log in which no row is left to fit on or to hold out.
    """
    logged = read_table(paths, rig)
    step = logged_step(logged)
    table, warnings = logged, list(rig.warnings)
    t = table.channels["time"]
    segment = filters.stretches(t, table.run)
    theta, omega_logged = _angle(table, rig, segment, warnings)
    quantum = _quantum(table, rig, theta, segment)
    holdout = hold_out(t, table.run, table.run_names, rig)
    moving, threshold = _moving(t, theta, segment, rig, quantum, ~holdout.rows)
    rig, said = suited(rig, t, theta, segment, moving & ~holdout.rows)
    warnings += [said] if said else []
    if math.isinf(rig.average_over) and not {"J_m", "J_l"} <= set(rig.known):
        # What little acceleration a constant speed has would take up anything that the friction lacks.
        rig = dataclasses.replace(rig, known={"J_m": 0.0, "J_l": 0.0, **rig.known})
        warnings.append("means of runs do not tell an inertia: J_m and J_l count as 0 where the rig has none")
    if coarse := is_coarse(logged, rig):
        # Between the rows lies the unwrapped angle, not the one that jumps.
        own = {"theta_m": theta} | ({} if omega_logged is None else {"omega_m": omega_logged})
        rest = {c: x for c, x in table.channels.items() if not c.startswith(("theta_", "omega_"))}
        table = refined(dataclasses.replace(table, channels=rest | own))
        t, theta = table.channels["time"], table.channels["theta_m"]
        omega_logged = table.channels.get("omega_m")
        segment = filters.stretches(t, table.run)
        holdout = hold_out(t, table.run, table.run_names, rig)
        moving, threshold = _moving(t, theta, segment, rig, quantum, ~holdout.rows)
    cut = math.inf if coarse else rig.low_pass_hz
    motion = _motion(t, theta, segment, cut, warnings)
    settled = _by_segment(segment, lambda rows: filters.away_from_ends(t[rows])).astype(bool)
    _check_rate(step, rig, warnings)
    channels = Channels(
        t=t,
        theta_m=motion[0],
        omega_m=motion[1],
        alpha_m=motion[2],
        theta_logged=theta,
        omega_logged=omega_logged,
        voltage=table.channels.get("voltage"),
        voltage_logged=table.channels.get("voltage"),
        current=table.channels.get("current"),
        torque=_motor_side(table, rig, "torque", "torque_l"),
        temperature=table.channels.get("temperature"),
        run=table.run,
        run_names=table.run_names,
        segment=segment,
        moving=moving,
        usable=moving & settled & table.use & ~_switching(t, segment, table.motor_off),
        off=table.motor_off,
        holdout=holdout,
        drive=_drive(table.channels, rig),
        moving_threshold_rad_s=threshold,
        quantum_rad=quantum,
        input_delay_s=0.0,
        theta_zero_rad=0.0,
        voltage_offset_V=0.0,
        logged_step_s=step,
        points_per_row=FACTOR if coarse else 1,
        rows_read=table.rows_read,
        rows_rejected=table.rows_rejected,
        warnings=tuple(warnings),
        findings=(),
        rig=rig,
    )
    _check_left(channels, paths, rig)
    channels = channels.realigned(
        rig,
        input_delay_s=rig.input_delay_s,
        theta_zero_rad=rig.theta_zero_rad,
        voltage_offset_V=rig.voltage_offset_V,
    )
    findings = assess(logged, channels, rig)
    said = (finding.text for finding in findings)
    return dataclasses.replace(channels, warnings=(*warnings, *said), findings=findings)


def _by_segment(
    segment: NDArray[np.int64], function: Callable[[NDArray[np.int64]], NDArray[Any]]
) -> NDArray[Any]:
    """Join what a function gives for the rows of each stretch."""
    starts = np.flatnonzero(np.diff(segment)) + 1
    return np.concatenate([function(rows) for rows in np.split(np.arange(len(segment)), starts)])


def _motor_side(table: Table, rig: Rig, motor: str, link: str) -> Array | None:
    """Bring a channel to the motor side: angles and speeds divide by mu, torques multiply."""
    if motor in table.channels:
        return table.channels[motor]
    if link not in table.channels:
        return None
    mu = rig.value("mu")
    return table.channels[link] * (mu if link == "torque_l" else 1.0 / mu)


def _angle(
    table: Table, rig: Rig, segment: NDArray[np.int64], warnings: list[str]
) -> tuple[Array, Array | None]:
    """Return the logged angle, unwrapped, or the integral of the logged speed, and the logged speed.

    Both are on the motor side.
    """
    theta = _motor_side(table, rig, "theta_m", "theta_l")
    omega = _motor_side(table, rig, "omega_m", "omega_l")
    t = table.channels["time"]
    if theta is not None:
        mu = rig.known.get("mu")
        return unwrapped(t, theta, segment, table.run, mu)[0], omega
    if omega is None:
        raise AssertionError("read_table asks for an angle or a speed")
    integral = _by_segment(table.run, lambda rows: cumulative_trapezoid(omega[rows], t[rows], initial=0.0))
    warnings.append("no angle is logged: it is the integral of the speed, from 0 at the start of each run")
    if segment[-1] > table.run[-1]:
        warnings.append("the integrated angle is uncertain after a gap in time")
    return integral, omega


def _motion(t: Array, theta: Array, segment: NDArray[np.int64], cut_hz: float, warnings: list[str]) -> Array:
    """Return angle, velocity, acceleration as rows of (3, n), filtered stretch by stretch."""
    plain: list[int] = []
    uneven = False

    def one(rows: NDArray[np.int64]) -> Array:
        nonlocal uneven
        *signals, smoothed = filters.motion(t[rows], theta[rows], cut_hz)
        if not smoothed:
            plain.append(len(rows))
        uneven |= not filters.is_even(t[rows])
        return np.stack(signals, axis=1)

    signals = _by_segment(segment, one)
    if plain and math.isinf(cut_hz):
        warnings.append(
            "the log is sampled too slowly for the low pass: velocity and acceleration are those of a spline "
            "through the angle, averaged over windows of twelve steps"
        )
    elif plain:
        warnings.append(
            f"{sum(plain)} of {len(t)} rows are sampled too slowly, or in stretches too short, for the "
            f"{cut_hz:g} Hz low pass: their velocity and acceleration are those of a spline"
        )
    if uneven:
        steps = np.diff(t)[np.diff(segment) == 0]
        usual = float(np.median(steps))
        odd = int(np.count_nonzero(np.abs(steps / usual - 1.0) > UNEVEN))
        warnings.append(
            f"time steps are uneven ({odd} of {len(steps)} differ by more than {UNEVEN:.0%} from the usual "
            f"{usual:.4g} s): for filtering, the angle is interpolated linearly"
        )
    return signals.T


def _switching(t: Array, segment: NDArray[np.int64], off: Mask) -> Mask:
    """Rows near a switching of the motor: what is filtered there mixes driven and free motion."""
    near = np.zeros(len(t), dtype=bool)
    for row in np.flatnonzero(np.diff(off.astype(int)) & (np.diff(segment) == 0)):
        near |= (np.abs(t - t[row]) < SWITCHING_S) & (segment == segment[row])
    return near


def _quantum(table: Table, rig: Rig, theta: Array, segment: NDArray[np.int64]) -> float:
    """Return the step of the motor angle [rad], by the counts or the smallest seen; 0 if integrated."""
    if "theta_m" not in table.channels and "theta_l" not in table.channels:
        return 0.0
    if rig.counts_per_rev is not None:
        gear = 1.0 if "theta_m" in table.channels else rig.value("mu")
        return 2.0 * np.pi / rig.counts_per_rev / gear
    changes = np.abs(np.diff(theta))[np.diff(segment) == 0]
    changes = changes[changes > 1e-9 * max(1.0, float(np.max(np.abs(theta))))]
    return float(np.min(changes)) if len(changes) else 0.0


def _moving(
    t: Array, theta: Array, segment: NDArray[np.int64], rig: Rig, quantum: float, fitted: Mask
) -> tuple[Mask, float]:
    """Return the rows that move (n,), and the threshold [rad/s] that tells: by the rig or by `fitted`."""
    velocity = _by_segment(segment, lambda rows: filters.span_velocity(t[rows], theta[rows]))
    threshold = rig.moving_threshold_rad_s
    if threshold is None:
        threshold = _default_threshold(velocity[fitted], quantum)
    moves = _by_segment(segment, lambda rows: filters.moves(t[rows], velocity[rows], threshold))
    return moves.astype(bool), threshold


def _default_threshold(velocity: Array, quantum: float) -> float:
    speeds = np.abs(velocity[np.isfinite(velocity)])
    slow = SLOW * float(np.percentile(speeds, 95.0)) if len(speeds) else 0.0
    return max(QUANTA * quantum / (2.0 * filters.HALF_SPAN_S), slow)


def _drive(channels: Mapping[str, Array], rig: Rig) -> str:
    """Return what measures the drive torque: as the rig says, else the first of those below that is there."""
    logged = {
        "current": "current" in channels,
        "torque": "torque" in channels or "torque_l" in channels,
        "voltage": "voltage" in channels,
    }
    there = [drive for drive, is_there in logged.items() if is_there]
    if rig.drive is None:
        return there[0]
    if rig.drive not in there:
        what = f"one of {', '.join(there)} is required" if len(there) > 1 else f"{there[0]} is required"
        raise InputError(
            f"{rig.path}: drive: {what}, since the log has no {rig.drive}; received {rig.drive!r}"
        )
    return rig.drive


def _check_rate(step: float, rig: Rig, warnings: list[str]) -> None:
    if rig.sample_rate_hz is None or not step:
        return
    rate = 1.0 / step
    if not 0.9 < rate / rig.sample_rate_hz < 1.1:
        warnings.append(
            f"the rig says {rig.sample_rate_hz:g} rows per second, the log has {rate:.4g}: is time in s?"
        )


def _check_left(channels: Channels, paths: Sequence[str | Path], rig: Rig) -> None:
    where = few(paths)
    fitted, scored = np.count_nonzero(channels.fit_rows), np.count_nonzero(channels.score_rows)
    if not fitted or not scored:
        raise InputError(
            f"{where}: moving rows (above {channels.moving_threshold_rad_s:.4g} rad/s at the motor, "
            f"{filters.END_S:g} s from the ends) are required to fit and to hold out "
            f"({channels.holdout.brief}); received {fitted} and {scored} under {rig.path}: are the units of "
            "time and angle right?"
        )


def _delayed(t: Array, x: Array, segment: NDArray[np.int64], delay: float) -> Array:
    if delay == 0.0:
        return x
    return _by_segment(segment, lambda rows: np.interp(t[rows] - delay, t[rows], x[rows]))
