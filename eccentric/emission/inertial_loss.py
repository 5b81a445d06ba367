"""Whether friction that follows the acceleration stays below the inertia, for a step to have one solution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from eccentric.core import InputError
from eccentric.emission.hot import evaluated, load_module, turn_of_link
from eccentric.model import Model, spoken
from eccentric.model import vocabulary as v

_ACCELERATIONS = np.concatenate([-np.geomspace(1e5, 1e-2, 36), np.geomspace(1e-2, 1e5, 36)])
"""Of the motor [rad/s^2]: friction is steepest where a load begins to grow, or far beyond it."""
_ANGLES = 24
_SLOW = 1.0
"""Speed of the motor [rad/s], where no fit says at which it turns."""


@dataclass(frozen=True)
class InertialLoss:
    """How much friction changes with the acceleration, at most [kg m^2], and the inertia of the drive."""

    loss: float
    inertia: float

    @property
    def solvable(self) -> bool:
        """Whether a step has one solution, and an acceleration passed on from step to step settles."""
        return self.loss < self.inertia


def inertial_loss(model: Model, speed: float = _SLOW) -> InertialLoss | None:
    """The loss by the acceleration at motor speeds up to this [rad/s], over a turn of the link.

    None where friction does not follow the acceleration, or a parameter has no value.
    """
    friction = model.expand(model.balance("mechanical").sum_of("friction"))
    missing = any(q.default is None for q in spoken(model).parameters)
    if v.alpha_m.symbol not in friction.free_symbols or missing:
        return None
    module = load_module(model)
    speeds = np.array([-speed, -1e-3 * speed, 1e-3 * speed, speed])
    grid = np.meshgrid(turn_of_link(model, _ANGLES), speeds, _ACCELERATIONS, indexing="ij")
    states = dict(zip((v.theta_m, v.omega_m, v.alpha_m), grid, strict=True))

    def along(function: Any) -> np.ndarray:
        return np.diff(evaluated(function, model.axis, states), axis=-1) / np.diff(_ACCELERATIONS)

    slopes = along(module.mechanical_friction_torque)
    inertia = -(along(module.mechanical_residual) + slopes)
    return InertialLoss(float(np.abs(slopes).max()), float(np.median(inertia)))


def require_solvable(model: Model, speed: float = _SLOW) -> None:
    """Raise InputError for a model whose friction takes more of an acceleration than its inertia does."""
    found = inertial_loss(model, speed)
    if found is not None and not found.solvable:
        unit = model.axis.unit("kg m^2")
        raise InputError(
            f"model {model.name}",
            f"acceleration-dependent friction below the inertia, {found.inertia:.3g} {unit}",
            f"up to {found.loss:.3g} {unit}",
            why="for a time step to have one solution",
            hint="check the inertias and the loss, or the gear",
        )
