"""Fit a model, extended or not, on its own emitted module: what is scored is what is shipped."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eccentric.effects import Effect
from eccentric.estimation import Estimate, rms
from eccentric.fitting.estimates import estimates, shares
from eccentric.fitting.expressions import alike, base_coefficients
from eccentric.fitting.extended import Adopted, Extended
from eccentric.fitting.fit_data import FitData, Values, drive_noise
from eccentric.fitting.limits import CONVERGED
from eccentric.fitting.machine import Machine
from eccentric.model import Model
from eccentric.signals import Band, band_of

__all__ = ["Refit", "refit", "residual_samples"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Refit:
    """A model fitted on the training part.

    Attributes:
        model: the model, extended by `effects`.
        effects: each with the values of all its parameters.
        values: every parameter of the model by name, as the emitted Parameters take it.
        scale: of the drive, V/(N m) or A/(N m); None where the torque is measured.
        estimates: fitted parameters with uncertainty, by name.
        covariance: of their errors (n, n), in the same order; zero where a bound holds one, NaN between two
            that are estimated from different balances.
        residuals: balance -> (rows,) [N m at this fit's own scale].
        shares: effect id -> RMS of its torque as a fraction of that of the friction, on training rows.
        target: (rows,) required mechanical friction, effects included [N m].
        data: what it was fitted on.
        change: relative, of the scale or of the predicted current, by the last step of the fit.
    """

    model: Model
    effects: tuple[tuple[Effect, Values], ...]
    values: Values
    scale: float | None
    estimates: dict[str, Estimate]
    covariance: Array
    residuals: dict[str, Array]
    shares: dict[str, float]
    target: Array
    data: FitData
    change: float

    @property
    def settled(self) -> bool:
        """Whether another step would not change the digits that are shown."""
        return self.change < CONVERGED

    def held_out(self, balance: str) -> float:
        """Held-out RMSE of a balance [N m]."""
        return rms(self.residuals[balance][self.data.rows.score])

    def smooth_residual(self, balance: str = "mechanical") -> Array:
        """The residual (rows,) [N m at this fit's scale] below the low pass; rows that are averages stay."""
        residual = self.residuals[balance]
        if self.data.rows.operator is not None:
            return residual
        filtered = self._moving if balance == "mechanical" else self._back_emf
        return self.data.drive.channels.smooth_residual(residual, filtered)

    @property
    def band(self) -> Band | None:
        """The band of the held-out error; None where rows are averages."""
        rows, channels = self.data.rows, self.data.drive.channels
        if rows.operator is not None:
            return None
        return band_of(self.residuals["mechanical"], self._moving, rows, channels, drive_noise(self.data))

    @property
    def _moving(self) -> Array:
        """What accelerates the drive (n,) [N m]: its inertia, and the other bodies of a chain."""
        drive = self.data.drive
        inertia = Machine(self.model).inertia_along(self.values, drive.channels.carried)
        moving = inertia * drive.channels.motion.alpha_m
        return moving if drive.along is None else moving + drive.along.torque

    @property
    def unresolved_rows(self) -> NDArray[np.bool_]:
        """Rows (rows,) where a torque of the effects repeats faster than half of the log's rate."""
        drive, rows = self.data.drive, self.data.rows
        fast = drive.unresolved(self.model, self.values)
        if not fast:
            return np.zeros(len(rows), dtype=bool)
        return rows.plain_mean(fast[0][1].astype(float)) > 0.0

    @property
    def _back_emf(self) -> Array:
        """The torque of the current that the back-EMF takes (n,) [N m]."""
        drive = self.data.drive
        return drive.machine.damping(self.values) * drive.channels.motion.omega_m

    def residual_like(self, other: Refit, balance: str = "mechanical", *, smooth: bool = False) -> Array:
        """The residual (rows,) at the scale of another fit; with `smooth`, below the low pass.

        Models that identify different scales are compared in the unit of the drive.
        """
        residual = self.smooth_residual(balance) if smooth else self.residuals[balance]
        return residual * ((self.scale or 1.0) / (other.scale or 1.0))


def refit(
    base: Model,
    effects: tuple[tuple[Effect, Values], ...],
    data: FitData,
    bounds: bool = True,
    linear: bool = False,
    without: int | None = None,
) -> Refit:
    """Fit friction, effect coefficients and what the rig leaves open by least squares on the training rows.

    Args:
        base: the paper's model.
        effects: adopted effects, each with the values of its shapes.
        data: the log.
        bounds: whether friction coefficients are constrained to be nonnegative. Otherwise the paper's model
            may use them to imitate what it lacks: its best case.
        linear: Coulomb and viscous friction only.
        without: number of a run to leave out; then all other runs are fitted on, held out or not.
    """
    fitted = _extended(base, effects, data, bounds, linear, without)
    step, change = fitted.fitted(base)
    found, covariance = ({}, np.empty((0, 0))) if without is not None else estimates(fitted, step)
    values = step.point.values
    return Refit(
        fitted.model,
        tuple((e, {q.name: values[q.name] for q in e.parameters}) for e, _ in effects),
        values,
        step.point.scale,
        found,
        covariance,
        dict(step.residuals),
        shares(fitted, step, base) if effects and without is None else {},
        step.target,
        data,
        change,
    )


def _extended(
    base: Model, effects: Adopted, data: FitData, bounds: bool, linear: bool, without: int | None
) -> Extended:
    """Extend a model by effects; arguments as in `refit`."""
    model = base
    for effect, own in effects:
        model = effect.extend(model, own)
    columns, rows = data.signals.columns(base), data.rows
    if without is not None:
        rows = rows.trained_on((rows.train | rows.score) & (rows.run != without))
    friction = tuple(c for c in base_coefficients(base, data.signals) if c.role == "friction")
    groups = alike(columns) if linear else [(k,) for k in range(len(columns))]
    return Extended(
        model,
        tuple(effects),
        replace(data, rows=rows),
        tuple(friction[first] for first, *_ in groups),
        friction,
        bounds,
        rows.train,
        {friction[first].name: tuple(friction[k].name for k in others) for first, *others in groups},
    )


def residual_samples(fitted: Refit) -> Array:
    """The mechanical residual on the samples (n,) [N m], up to a constant; for fits with bounds."""
    shapes = {s.quantity.name: fitted.values[s.quantity.name] for e, _ in fitted.effects for s in e.shapes}
    residuals = fitted.data.residuals(fitted.model, shapes, fitted.values, fitted.scale)
    return residuals.samples("mechanical", fitted.values)
