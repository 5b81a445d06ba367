"""The measured signals that models are fitted on, and which of their rows serve for what."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eccentric.signals.filters import smoothed
from eccentric.signals.stretches import joined

if TYPE_CHECKING:
    from eccentric.rigs import Rig
    from eccentric.signals.finding import Finding
    from eccentric.signals.holdout import Holdout

__all__ = ["Channels"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Channels:
    """Signals of all kept rows, each (n,), None where the logs have none; n counts rows, moving or not.

    `theta_m` [rad], `omega_m` [rad/s], `alpha_m` [rad/s^2] come from the low-passed angle, without phase
    lag, the zero angle taken out; `theta_logged` [rad], `omega_logged` [rad/s] are the sensors' own. All
    are on the motor side, `torque` [N m] too. `voltage` [V] has delay and offset taken out. `temperature`
    is in degC. `rig` is the one that was asked for, with what suits the log where it says nothing. A log too
    coarse for the low pass has `points_per_row` points for each of its rows, which are `logged_step_s` apart.
    `segment` numbers the stretches without gap. `moving` is `filters.moves`; `usable` is moving, away from
    the ends, and wanted by the rig's `use`; `off` is where the motor is switched off: no drive torque, no
    back-EMF. `drive` is the channel that measures the drive torque. `quantum_rad` is the step of the motor
    angle, 0 where there is none to see.
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
    run: Integers
    run_names: tuple[str, ...]
    segment: Integers
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
    def elapsed(self) -> Array:
        """Time since the start of each row's run [s] (n,)."""
        start = np.array([self.t[self.run == run][0] for run in range(int(self.run.max()) + 1)])
        return self.t - start[self.run]

    def smooth(self, x: Array) -> Array:
        """A signal (n,) after the low pass that the angle has passed."""
        return smoothed(self.t, self.segment, x, self.rig.low_pass_hz)

    @property
    def phased(self) -> bool:
        """Whether the angles of all rows compare: an integrated one begins at zero in every run."""
        return len(self.run_names) == 1 or self.quantum_rad > 0.0

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


def _delayed(t: Array, x: Array, segment: Integers, delay: float) -> Array:
    if delay == 0.0:
        return x
    return joined(segment, lambda rows: np.interp(t[rows] - delay, t[rows], x[rows]))
