"""A fitted model on any log of its rig: the drive that it predicts, and what it leaves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eccentric.identification import LOAD, Drive, Fit, Machine, Refit, fit_data_of, loaded_model
from eccentric.model import Model
from eccentric.rigs import Alignment, Rig
from eccentric.signals import Channels

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Predicted:
    """Measured and predicted drive on the rows (m,) of a log, in `unit`.

    Attributes:
        t: time [s] (m,).
        measured, predicted: of a coast-down, what its deceleration gives and what friction gives (m,).
        held_out: rows (m,) that a fit of this log would not use.
        unit: "N m" ("N" on a carriage), or that of the drive signal where the log has no scale for a torque.
    """

    t: Array
    measured: Array
    predicted: Array
    held_out: NDArray[np.bool_]
    unit: str

    @property
    def residual(self) -> Array:
        """Measured minus predicted (m,)."""
        return self.measured - self.predicted


@dataclass(frozen=True)
class FittedDrive:
    """What predicts a log: a fitted model with the drive as it was identified.

    Attributes:
        base, model: the model that was fitted, and the same extended by effects; often the same one.
        rig, alignment: as the fit has completed and found them.
        known: values of the drive, those that were identified included.
        values: every parameter of the model, and what the drive requires beside it.
        scale: of the drive [V/(N m) or A/(N m)]; None where the torque is measured.
        unit, factor: of the errors of the fit, and what it has of them for one newton metre.
        drive_unit: of torques in the fit, "N m", "V" or "A".
        powered: whether rows with the motor switched off are left out of the fit.
    """

    base: Model
    model: Model
    rig: Rig
    alignment: Alignment
    known: Mapping[str, float]
    values: Mapping[str, float]
    scale: float | None
    unit: str
    factor: float
    drive_unit: str
    powered: bool

    def along(self, channels: Channels) -> Predicted:
        """The prediction for the channels of a log.

        Raises:
            InputError: the log lacks a signal that the model takes, such as a temperature.
        """
        channels = channels.driven if self.powered else channels
        channels = channels.realigned(channels.rig, self.alignment)
        drive = Drive(Machine(self.base), channels, self.known, self.scale, self.drive_unit)
        data = fit_data_of(drive, channels.rig, self.base)
        values = dict(self.values)
        residuals = data.residuals(self.model, values, values, self.scale)
        measured = data.rows.mean(drive.driven_by(values, self.scale))
        left = residuals.rows("mechanical", values)
        return Predicted(
            data.rows.t, self.factor * measured, self.factor * (measured - left), data.rows.score, self.unit
        )


def fitted_drive(found: Fit | Refit, parameters: Mapping[str, float] | None = None) -> FittedDrive:
    """What predicts other logs by a fit; `parameters` are those that a `Fit` is emitted with."""
    if isinstance(found, Refit):
        drive, estimates = found.data.drive, found.estimates
        moved = {n: estimates[n].value for n in vars(drive.channels.alignment) if n in estimates}
        return FittedDrive(
            found.data.signals.base or found.model,
            found.model,
            drive.channels.rig,
            replace(drive.channels.alignment, **moved),
            dict(drive.known),
            dict(found.values),
            found.scale,
            drive.channels.rig.axis.unit(drive.unit),
            1.0,
            drive.unit,
            False,
        )
    problem = found.problem
    drive, rig = problem.drive, problem.rig
    every = {**found.coefficients, **found.searched}
    moved = {name: every[name].value for name in vars(drive.channels.alignment) if name in every}
    values_of = zip(problem.coefficients, found.solutions["paper"].values, strict=True)
    of = {c.role: float(value) for c, value in values_of}
    scale = of.get("scale", 1.0) if problem.scale is not None else 1.0
    searched = {name: e.value for name, e in found.searched.items() if name not in moved}
    values = {**drive.machine.absent, **drive.known, **searched, **(parameters or {})}
    if LOAD in rig.known or LOAD in rig.unknown:
        values[LOAD] = rig.known.get(LOAD, of.get("load", 0.0) / scale)
    # By its back-EMF, where that is known, a drive tells whether friction contains it.
    open_emf = drive.machine.back_emf_letters - set(drive.known) - set(searched)
    model = loaded_model(problem.model, rig)
    return FittedDrive(
        model,
        model,
        rig,
        replace(drive.channels.alignment, **moved),
        {name: value for name, value in values.items() if name not in open_emf},
        values,
        None if drive.scale is None else drive.scale * scale,
        rig.axis.unit(problem.unit),
        scale,
        "N m" if problem.has("scale") else drive.unit,
        True,
    )
