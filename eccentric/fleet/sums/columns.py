"""The regression of a rig's model: target = X b + residual on window means, in newton metres at the motor.

For a linear axis in newtons, with its symbols and units.

friction   one column for each coefficient of the emitted model's regressor
inertia    where the rig does not give it
scale      J alpha + G by the rig's values, nominally 1: changes with the sensor gain, the torque constant or
           the payload
offset     a constant torque: sensor offset or constant load
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, few
from eccentric.fleet.limits import MEMBER_PART, NO_COLUMN
from eccentric.identification import (
    LOAD,
    Emitted,
    Machine,
    inseparable,
    load_gain,
    load_letters,
    merged,
    require_case,
    with_own,
)
from eccentric.model import Load, Model, Role, load_model, regressor, spoken
from eccentric.rigs import Rig

Array = NDArray[np.float64]
Kind = Literal["viscous", "coulomb", "load", "friction", "inertia", "scale", "offset"]

SCALE, OFFSET = "scale", "offset"
_DRIVES = ("current", "torque", "torque_l", "voltage")


@dataclass(frozen=True)
class Heading:
    """A column: the name, unit and kind of its coefficient."""

    name: str
    unit: str
    # of friction: "load" if it depends on a load, else "viscous" or "coulomb", "friction" for other
    # roles
    kind: Kind

    @property
    def is_friction(self) -> bool:
        """Whether it is a coefficient of friction."""
        return self.kind not in {"inertia", "scale", "offset"}


class Columns:
    """The columns of one joint; InputError for a rig with open values that sums cannot represent."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self._model = model = require_rig(rig)
        self._machine = Machine(model)
        self._known = dict(with_own(rig, model).known)
        self._open_inertia = not self._machine.inertia_letters <= set(self._known)
        self._emitted = Emitted(model)
        unfitted = dict.fromkeys((q.name for q in model.friction_parameters), 0.0)
        values = {**self._machine.absent, "M_l": 0.0, **self._known, **unfitted}
        self._values = {name: value for name, value in values.items() if name != LOAD}
        self._parameters = self._emitted.parameters(self._values)

    @cached_property
    def headings(self) -> tuple[Heading, ...]:
        """The columns in their order."""
        gravity = self._model.balance("mechanical").sum_of("gravity") != 0
        axis = self._model.axis
        friction = [Heading(c.name, c.unit, _kind(c.role, c.load)) for c in regressor(spoken(self._model))]
        rotor = Heading(axis.named(self._machine.rotor), axis.unit("kg m^2"), "inertia")
        inertia = [rotor] if self._open_inertia else []
        scale = [] if self._open_inertia and not gravity else [Heading(SCALE, "1", "scale")]
        return (*friction, *inertia, *scale, Heading(OFFSET, axis.unit("N m"), "offset"))

    def torque(self, drive: Mapping[str, Array], omega: Array) -> Array:
        """The drive torque (m,) [N m] from a measured "torque", "current" or "voltage" (m,)."""
        if "torque" in drive:
            return drive["torque"]
        if "current" in drive:
            return self._machine.torque(self._known, drive["current"])
        voltage = drive["voltage"] - self.rig.alignment.voltage_offset_V
        current = self._machine.current(self._known, voltage, omega)
        return self._machine.torque(self._known, current)

    def require_drive(self, measured_by: str) -> None:
        """Raise InputError if the rig lacks a constant to convert the measured drive to torque."""
        _require_motor(self.rig, self._machine, set(self._known), measured_by)

    def rows(self, theta: Array, omega: Array, alpha: Array, torque: Array) -> Array:
        """[X y] (m, k + 1) from the motor's motion and the drive torque, each (m,)."""
        if zero := self.rig.alignment.theta_zero_rad:
            theta = theta - zero / self.rig.value("mu")
        inputs = {"theta_m": theta, "omega_m": omega, "alpha_m": alpha}
        friction = self._emitted("regressor", inputs, self._parameters)
        gravity = self._emitted("gravity_torque", inputs, self._parameters) + np.zeros_like(omega)
        design = np.empty((len(omega), len(self.headings) + 1))
        design[:, : friction.shape[1]] = friction
        place = friction.shape[1]
        if self._open_inertia:
            design[:, place] = alpha
            place += 1
        else:
            gravity = gravity + self._machine.inertia(self._values) * alpha
        if place < len(self.headings) - 1:
            design[:, place] = gravity
        design[:, -2] = 1.0
        design[:, -1] = torque - self._known.get(LOAD, 0.0) * load_gain(self.rig)
        return design


def drive_channel(channels: Collection[str], rig: Rig) -> str | None:
    """The channel that measures the drive: by the rig, else the first present; None without any."""
    wanted = {None: _DRIVES, "torque": ("torque", "torque_l")}.get(rig.log.drive, (rig.log.drive,))
    return next((name for name in wanted if name in channels), None)


def _require_motor(rig: Rig, machine: Machine, known: Collection[str], measured_by: str) -> None:
    letters = set[str]() if measured_by in ("torque", "torque_l") else set(machine.torque_letters)
    if measured_by == "voltage":
        letters |= machine.resistance_letters | machine.back_emf_letters
    if missing := sorted(letters - set(known)):
        named = rig.axis.named
        raise InputError(
            rig.path,
            problem=f"expected [known] {' and '.join(map(named, missing))} for a fleet driven by"
            f" {named(measured_by)}, got none",
        )


def require_rig(rig: Rig) -> Model:
    """The model of a rig; InputError for a rig with open values that sums cannot represent."""
    model = load_model(rig.model)
    require_case(rig, model)
    if rig.unknown or rig.estimate:
        open_ = rig.axis.named(few(sorted({*rig.unknown, *rig.estimate})))
        raise InputError(
            rig.path,
            problem=f"expected values for a fleet, but {open_} is left to be estimated: fit one log of"
            " the joint and enter what it finds",
        )
    if rig.alignment.input_delay_s:
        raise InputError(
            f"{rig.path}: input_delay_s", "0", f"{rig.alignment.input_delay_s:g}", why="for a fleet"
        )
    if rig.log.kinds:
        raise InputError(f"{rig.path}: [kinds]", "none", few(rig.log.kinds), why="for a fleet")
    if missing := sorted(load_letters(model) - set(rig.known) - {"M_l"}):
        letters = rig.axis.named(few(missing))
        raise InputError(rig.path, f"[known] {letters}", "none", why=f"for {model.name}")
    # Without [columns] the header of each log decides what measures the drive.
    if drive := drive_channel(rig.log.columns or (), rig):
        _require_motor(rig, Machine(model), with_own(rig, model).known, drive)
    return model


def _kind(role: Role, load: Load) -> Kind:
    if load is not Load.NONE:
        return "load"
    return {Role.VISCOUS: "viscous", Role.COULOMB: "coulomb"}.get(role, "friction")  # pyright: ignore[reportReturnType]


def dependent(triangle: Array) -> list[int]:
    """Columns of X that are zero or linearly dependent; empty if all are identifiable."""
    zero, together = inseparable(triangle[:, :-1], MEMBER_PART, NO_COLUMN)
    return zero or together


@dataclass(frozen=True)
class Solved:
    """Coefficient values (k,), their covariance (k, k) and its degrees of freedom."""

    values: Array
    covariance: Array
    freedom: int


def solve(stack: Array) -> Solved:
    """Least squares over triangles (b, k + 1, k + 1), with a cluster-robust covariance over blocks.

    Rows within a block may be correlated in any way (sandwich estimator; Liang and Zeger, 1986).
    """
    triangle = merged(stack)
    k = triangle.shape[0] - 1
    values = np.linalg.solve(triangle[:k, :k], triangle[:k, k])
    x, y = stack[:, :, :-1], stack[:, :, -1]
    score = np.einsum("bij,bi->bj", x, y - x @ values)
    occupied = int(np.count_nonzero(np.any(x != 0.0, axis=(1, 2))))
    freedom = max(occupied - k, 1)
    # R^-1 R^-T is the inverse of X'X.
    half = np.linalg.solve(triangle[:k, :k].T, score.T)
    spread = np.linalg.solve(triangle[:k, :k], half)
    return Solved(np.asarray(values, float), spread @ spread.T * (occupied / freedom), freedom)
