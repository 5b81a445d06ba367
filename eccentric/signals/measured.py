"""The measured signals that models are fitted on, and the purpose of each row."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.rigs import AddedMass, Alignment, Rig
from eccentric.signals import limits
from eccentric.signals.clock import Finding
from eccentric.signals.filters import LowPass, joined, low_pass_of, motion_of
from eccentric.signals.table import Holdout, carriers

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class TimeBase:
    """When the rows were taken: `t` [s] (n,), and the run and the stretch without gap of each, numbered (n,).

    A log too coarse for the low pass has `points_per_row` points for each of its rows, which are
    `logged_step_s` apart; one finer than it needs has a point for `rows_per_point` of them. With `one_clock`,
    time goes on from run to run. `skipped` (n,) are the rows that a window of a long log begins with, where
    the rows before were left out.
    """

    t: Array
    run: Integers
    run_names: tuple[str, ...]
    segment: Integers
    logged_step_s: float
    points_per_row: int
    skipped: Mask
    one_clock: bool = False
    rows_per_point: int = 1

    @property
    def elapsed(self) -> Array:
        """Time since the start of each row's run [s] (n,); by one clock, since the start of the log."""
        if self.one_clock:
            return self.t - self.t[0]
        start = np.array([self.t[self.run == run][0] for run in range(int(self.run.max()) + 1)])
        return self.t - start[self.run]


@dataclass(frozen=True)
class MeasuredMotion:
    """The motion at the motor, each (n,).

    `theta_m` [rad], `omega_m` [rad/s], `alpha_m` [rad/s^2] come from the low-passed angle, without phase
    lag, the zero angle taken out; `theta_logged` [rad], `omega_logged` [rad/s] are the sensors' own.
    `quantum_rad` is the step of the motor angle, 0 where there is none to see.
    """

    theta_m: Array
    omega_m: Array
    alpha_m: Array
    theta_logged: Array
    omega_logged: Array | None
    quantum_rad: float


@dataclass(frozen=True)
class Motor:
    """What drives the motor, each (n,), None where the log has none.

    `voltage` [V] has delay and offset taken out, `voltage_logged` has not; `current` [A]; `torque` [N m], on
    the motor side. `off` is where the motor is switched off: no drive torque, no back-EMF. `measured_by` says
    which of "current", "torque" and "voltage" measures the drive torque. `coasting`
    is a log that nothing drives: its torque is 0 throughout. `current_later` is the current if it was
    sampled one standard error later in its row, None where that is not in question.
    """

    voltage: Array | None
    voltage_logged: Array | None
    current: Array | None
    torque: Array | None
    off: Mask
    measured_by: str
    coasting: bool = False
    current_later: Array | None = None

    @property
    def measured(self) -> Array:
        """The signal (n,) that measures the drive torque, in its own unit. InputError if there is none."""
        found = {"current": self.current, "torque": self.torque, "voltage": self.voltage}[self.measured_by]
        if found is None:
            raise InputError("", problem=f"expected a {self.measured_by} channel, the log has none")
        return found


@dataclass(frozen=True)
class Selection:
    """Which rows serve for what, each (n,).

    `moving` is `motion.moving_rows`, faster than the threshold; `usable` is moving, away from the ends, and
    `wanted` by the rig's `use` (None for all).
    """

    moving: Mask
    usable: Mask
    holdout: Holdout
    moving_threshold_rad_s: float
    wanted: Mask | None = None

    @property
    def held_out(self) -> Mask:
        """Rows (n,) of the held-out part, usable or not."""
        return self.holdout.rows

    @property
    def fit_rows(self) -> Mask:
        """Rows (n,) that a fit may use: usable and not held out."""
        return self.usable & ~self.held_out

    @property
    def score_rows(self) -> Mask:
        """Rows (n,) of the reported held-out error: usable and held out."""
        return self.usable & self.held_out


@dataclass(frozen=True)
class Intake:
    """Rows read of the logs (their paths), rows rejected as no numbers, and what is odd about them."""

    read: int
    rejected: int
    warnings: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()
    logs: tuple[str, ...] = ()


@dataclass(frozen=True)
class Controlled:
    """What the controller of the rig is given: its columns by name, each (n,), as the log has them.

    `per_motor` is the angle that its set point has for a radian of the motor: mu where the log has that of
    the link.
    """

    columns: Mapping[str, Array]
    per_motor: float = 1.0


@dataclass(frozen=True)
class Channels:
    """Signals of all kept rows, each (n,); n counts rows, moving or not.

    `temperature` is in degC, None where the log has none. `alignment` is what has been taken out of voltage
    and angle. `rig` is the one that was asked for, with what suits the log where it says nothing.
    `lines` are the orders of the motor beyond the usual ones that stand out of the drive, strongest first.
    `controlled` is None where the rig has no controller.
    """

    time: TimeBase
    motion: MeasuredMotion
    motor: Motor
    temperature: Array | None
    selection: Selection
    alignment: Alignment
    intake: Intake
    rig: Rig
    lines: tuple[int, ...] = ()
    controlled: Controlled | None = None

    @cached_property
    def turning(self) -> Array:
        """The speed of the motor [rad/s] (n,) where it is on, else 0; the same array each time."""
        speed = self.motion.omega_m
        return np.where(self.motor.off, 0.0, speed) if np.any(self.motor.off) else speed

    def smooth(self, x: Array) -> Array:
        """A signal (n,) after the low pass that the angle has passed."""
        return self.low_pass(self.rig)(x)

    def smooth_residual(self, residual: Array, filtered: Array) -> Array:
        """A residual (n,) after that low pass, with `filtered` (n,), which has passed it already, as it is.

        The residual is a torque less this: what accelerates the drive, from the angle, or what the back-EMF
        takes of the voltage. Friction, which follows the speed, passes twice; above the cut-off, the
        acceleration is the larger part.
        """
        return self.smooth(residual + filtered) - filtered

    def low_pass(self, rig: Rig) -> LowPass:
        """The low pass of a rig for all signals of the log."""
        time = self.time
        return low_pass_of(time.t, time.segment, rig.sampling.low_pass_hz, alike=bool(np.any(time.skipped)))

    @property
    def carried(self) -> tuple[tuple[Mask, AddedMass], ...]:
        """The masses that some runs carry beside that of the rig, each with its rows (n,)."""
        run, names = self.time.run, self.time.run_names
        return tuple((carriers(run, names, [runs]), added) for runs, added in self.rig.added.items())

    @property
    def phased(self) -> bool:
        """Whether the angles of all rows are comparable: an integrated one starts at zero in every run."""
        return len(self.time.run_names) == 1 or self.motion.quantum_rad > 0.0

    @property
    def excerpt(self) -> str:
        """Which windows of a long log these are, and why; "" for a log that is read whole."""
        return "; ".join(found.text for found in self.intake.findings if found.kind == "excerpt")

    @property
    def driven(self) -> Channels:
        """The same channels with the rows with the motor switched off marked unusable."""
        if not np.any(self.motor.off):
            return self
        usable = self.selection.usable & ~self.motor.off
        return dataclasses.replace(self, selection=dataclasses.replace(self.selection, usable=usable))

    @property
    def counts(self) -> dict[str, int]:
        """Rows read, used (fitted or scored), held out (scored), rejected (not numbers)."""
        points, chosen = self.time.points_per_row / self.time.rows_per_point, self.selection
        return {
            "read": self.intake.read,
            "used": round(np.count_nonzero(chosen.usable) / points),
            "held_out": round(np.count_nonzero(chosen.score_rows) / points),
            "rejected": self.intake.rejected,
        }

    def realigned(self, rig: Rig, alignment: Alignment) -> Channels:
        """Return the same channels with another delay, zero angle and offset.

        A fit that estimates them uses this. The voltage that acts at t is the logged one at t - delay,
        interpolated within a stretch (its first value before that); for a command that is held over a step,
        the delay therefore contains half a step. The zero angle is on the link side: without mu in the rig,
        InputError.
        """
        moved = alignment.theta_zero_rad - self.alignment.theta_zero_rad
        voltage = self.motor.voltage_logged
        if voltage is not None:
            voltage = _delayed(self.time.t, voltage, self.time.segment, alignment.input_delay_s)
            voltage = voltage - alignment.voltage_offset_V
        theta_m = self.motion.theta_m - (moved / rig.value("mu") if moved else 0.0)
        return dataclasses.replace(
            self,
            motion=dataclasses.replace(self.motion, theta_m=theta_m),
            motor=dataclasses.replace(self.motor, voltage=voltage),
            alignment=alignment,
        )

    @property
    def later(self) -> Channels | None:
        """The same channels with the current sampled one standard error later; None if that is known."""
        later = self.motor.current_later
        if later is None:
            return None
        return dataclasses.replace(self, motor=dataclasses.replace(self.motor, current=later))

    def narrowed(self, rig: Rig) -> Channels:
        """The same channels with the angle after a lower low pass than that of the rig.

        What a fit to them finds otherwise comes from the filter, not from the drive.
        """
        cut = limits.NARROWER * rig.sampling.low_pass_hz
        rig = dataclasses.replace(rig, sampling=dataclasses.replace(rig.sampling, low_pass_hz=cut))
        time, motion = self.time, self.motion
        (theta_m, omega_m, alpha_m), _ = motion_of(time.t, motion.theta_logged, time.segment, cut)
        found = dataclasses.replace(motion, theta_m=theta_m, omega_m=omega_m, alpha_m=alpha_m)
        plain = dataclasses.replace(self, motion=found, alignment=Alignment(), rig=rig)
        return plain.realigned(rig, self.alignment)


def _delayed(t: Array, x: Array, segment: Integers, delay: float) -> Array:
    if delay == 0.0:
        return x
    return joined(segment, lambda rows: np.interp(t[rows] - delay, t[rows], x[rows]))
