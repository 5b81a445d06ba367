"""The balances of the report: residuals of the models on the rows, and the channels on the axes."""

from __future__ import annotations

import numpy as np

from eccentric.diagnosis import Diagnosis
from eccentric.fitting import DRIVE_UNITS, Refit
from eccentric.report.arrays import BalanceResiduals, Channel, DriveSignal, ResidualRows
from eccentric.signals import Rows

__all__ = ["balance_of"]

Array = np.ndarray
TURN = 2.0 * np.pi
_QUARTER = TURN / 4
_QUANTITIES = {"mechanical": "friction", "electrical": "torque of the voltage"}


def balance_of(found: Diagnosis, name: str) -> BalanceResiduals:
    """Residuals at one scale of the drive, that of the extended model, as in the score."""
    mechanical = name == "mechanical"
    models = found.models
    fits = {"linear": models.linear, "paper": models.paper, "extended": models.extended}
    residuals = {
        m: _scaled(found, fit, fit.residuals[name]) for m, fit in fits.items() if name in fit.residuals
    }
    adopted = found.models.adopted and (
        mechanical or any(effect.balance == name for effect, _ in found.models.extended.effects)
    )
    return BalanceResiduals(
        name=name,
        quantity=_QUANTITIES[name],
        unit=found.unit,
        rows=_rows(found),
        paper=residuals["paper"],
        extended=residuals["extended"] if adopted else None,
        linear=residuals["linear"] if mechanical else None,
        measured=_scaled(found, found.models.paper, found.models.paper.target) if mechanical else None,
        rmse=found.score.rmse[name],
        noise_floor=found.noise_floor if mechanical else None,
        drive=_drive(found) if mechanical else None,
    )


def _drive(found: Diagnosis) -> DriveSignal:
    """The measured drive on the rows, and how much of it a newton metre is."""
    drive, scale = found.data.drive, found.models.extended.scale
    name = found.channels.motor.measured_by
    gain = 1.0
    if scale is not None:
        gain = scale
    elif name == "current":
        gain = float(drive.machine.current_of_torque(drive.known, 1.0))
    return DriveSignal(
        name, DRIVE_UNITS[name], np.where(found.data.off, np.nan, found.rows.mean(drive.signal())), gain
    )


def _scaled(found: Diagnosis, fit: Refit, x: Array) -> Array:
    return x * ((fit.scale or 1.0) / (found.models.extended.scale or 1.0))


def _rows(found: Diagnosis) -> ResidualRows:
    channels, mu, rows = found.channels, found.setting.mu, found.rows
    axis = found.rig.axis
    # The screw of a carriage turns by an angle, whose unit is not one of length.
    turn, radian = (TURN, "rad") if axis.wraps else (None, "radian")
    turns = axis.wraps or "pitch" in found.rig.known
    gravity = found.data.gravity if np.any(found.data.gravity) else None
    theta = channels.motion.theta_m if channels.phased else None
    given = [
        ("velocity", "motor velocity", "rad/s", channels.motion.omega_m, None),
        ("link_angle", "link angle", radian, None if theta is None or not turns else mu * theta, TURN),
        # Without a gear the motor turns with the link.
        ("motor_angle", "motor angle", "rad", theta if abs(mu) != 1.0 else None, turn),
        ("acceleration", "motor acceleration", "rad/s²", channels.motion.alpha_m, None),
        ("gravity_load", "gravity torque on the motor", found.unit, gravity, None),
        ("current", "current", "A", channels.motor.current, None),
        ("voltage", "voltage", "V", channels.motor.voltage, None),
        ("temperature", "temperature", "°C", channels.temperature, None),
        ("time", "time in the run", "s", channels.time.elapsed, None),
    ]  # fmt: skip
    made = [
        Channel(k, label, u, _mean(rows, x, period), period)
        for k, label, u, x, period in given
        if x is not None
    ]
    return ResidualRows(
        t=rows.t,
        run=rows.run,
        run_names=channels.time.run_names,
        train=rows.train,
        held_out=rows.score,
        channels=tuple(made),
        description=rows.description,
    )


def _mean(rows: Rows, x: Array, period: float | None) -> Array:
    """A channel on the rows; NaN where an average covers more than a quarter of a turn."""
    if rows.operator is None:
        return x
    mean = rows.mean(x)
    if period is None:
        return mean
    spread = rows.mean((x - x[0]) ** 2) - (mean - x[0]) ** 2
    return np.where(spread < _QUARTER**2, mean, np.nan)
