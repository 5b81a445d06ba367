"""A rig and a model as a linear problem: target = columns @ coefficients, a few values given.

    torque:  tau                = J alpha + G + f                       [N m]
    current: k_i i              = J alpha + G + f                       [N m]
    voltage: (k_i/R) u          = J alpha + G + f + (k_i k_e/R) w       [N m]   R and k_i known
    voltage: u                  = (R/k_i) (J alpha + G + f) + k_e w     [V]     else
    current: i                  = (1/k_i) (J alpha + G + f)             [A]     k_i known by a range only

f is the emitted regressor times its coefficients.  What is known moves to the left; with an unknown scale s
(R/k_i or 1/k_i) what is known of J alpha + G becomes the column of s, and without any of it only products
with s come out.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.emission import load_module
from eccentric.errors import InputError
from eccentric.fitting.columns import (
    Coefficient,
    Searched,
    coefficients_of,
    known_inertia,
    scale_of,
    searched_of,
)
from eccentric.model import Model, regressor
from eccentric.model.steps import meaning
from eccentric.rigs import KNOWNS
from eccentric.signals import Rows, fit_rows

if TYPE_CHECKING:
    from eccentric.rigs import Rig
    from eccentric.signals import Channels

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Problem:
    """What is minimised. `unit` is that of target and residual; `scale` is s, None where it is one."""

    channels: Channels
    rig: Rig
    model: Model
    module: ModuleType
    rows: Rows
    unit: str
    scale: sp.Expr | None
    coefficients: tuple[Coefficient, ...]
    searched: tuple[Searched, ...]
    kept: tuple[int, ...]
    warnings: tuple[str, ...]

    @property
    def starts(self) -> dict[str, float]:
        """The first value of everything searched."""
        return {s.name: s.starts[0] for s in self.searched}

    @cached_property
    def _inputs(self) -> tuple[str, ...]:
        names = inspect.signature(self.module.regressor).parameters
        return tuple(name for name in names if name.endswith("_m"))

    def parameters(self, values: Mapping[str, float]) -> object:
        """Return the emitted `Parameters` of what is known, the letters among `values` put in."""
        letters = {**self.rig.known, **values}
        fields = {field.name for field in dataclasses.fields(self.module.Parameters)}
        try:
            return self.module.Parameters(**{k: v for k, v in letters.items() if k in fields})
        except ValueError as error:
            raise InputError(f"{self.rig.path}: {error}") from None

    def design(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Return target (m,) and columns (m, k) under the searched values."""
        channels = self.channels
        aligned = {k: v for k, v in values.items() if k in ("input_delay_s", "theta_zero_rad")}
        if aligned:
            channels = channels.realigned(self.rig, **aligned)
        parameters = self.parameters({k: v for k, v in values.items() if k not in aligned})
        signals = {"theta_m": channels.theta_m, "omega_m": channels.omega_m, "alpha_m": channels.alpha_m}
        friction = self.rows.mean(self.module.regressor(*(signals[n] for n in self._inputs), parameters))
        friction = friction[:, self.kept]
        known, inertia = self._known(channels, parameters)
        load = np.full(len(inertia), self.rig.known.get("mu", 1.0))
        by_role = {"inertia": inertia, "scale": known, "offset": self._offset, "load": load}
        columns = [by_role[c.role] for c in self.coefficients if c.role != "friction"]
        target = self.rows.mean(self._drive(channels)) - (known if self.scale is None else 0.0)
        return target, np.column_stack([friction, *columns])

    def drive_signal(self, values: Mapping[str, float]) -> Array:
        """Return what is explained as a whole, in `unit`, at the rows (m,)."""
        aligned = {k: v for k, v in values.items() if k in ("input_delay_s", "theta_zero_rad")}
        return self.rows.mean(self._drive(self.channels.realigned(self.rig, **aligned)))

    def _drive(self, channels: Channels) -> Array:
        known = self.rig.known
        signal = getattr(channels, channels.drive)
        if channels.drive == "current" and self.scale is None:
            return known["k_i"] * signal
        if channels.drive == "voltage":
            emf = known.get("k_e", 0.0) * channels.omega_m
            return (signal - emf) * (known["k_i"] / known["R"] if self.scale is None else 1.0)
        return signal

    @property
    def _offset(self) -> Array:
        driven = self.channels.drive == "voltage" and self.scale is None
        return np.full(len(self.rows), self.rig.known["k_i"] / self.rig.known["R"] if driven else 1.0)

    def _known(self, channels: Channels, parameters: object) -> tuple[Array, Array]:
        """Return what is known of J alpha + G (m,), and alpha (m,)."""
        acceleration = self.rows.acceleration(channels)
        gravity = np.zeros_like(acceleration)
        if inspect.signature(self.module.gravity_torque).parameters.get("theta_m"):
            gravity = self.rows.mean(self.module.gravity_torque(channels.theta_m, parameters))
        gravity = gravity + self.rig.known.get("T_load", 0.0) * self.rig.known.get("mu", 1.0)
        inertia = known_inertia(self.rig)
        return gravity + (0.0 if inertia is None else inertia * acceleration), acceleration


def pose(channels: Channels, rig: Rig, model: Model) -> Problem:
    """Return the problem of a log under a rig and a model.

    Raises InputError for a model of another case than the rig's, a letter that the model needs and the rig
    gives neither as a value nor as a range, and a current without k_i.
    """
    require_case(rig, model)
    channels = channels.driven
    needed = _letters(model)
    for letter in sorted(needed - own_letters(model)):
        if letter not in rig.known and letter not in rig.unknown:
            raise InputError(
                f"{rig.path}: [known] {letter} is required by {model.name}, or its range in [unknown]; "
                "received neither"
            )
    scale = scale_of(channels.drive, rig)
    rows = fit_rows(channels, rig)
    warnings = list(channels.warnings)
    if rows.operator is not None:
        warnings.append(f"the log is fitted, and its error taken, on {rows.description}")
    coefficients = coefficients_of(channels, rig, model, scale)
    kept = seen_columns(model, rig.known)
    gone = [c.letter for k, c in enumerate(coefficients) if c.role == "friction" and k not in kept]
    if gone:
        warnings.append(f"no unbalanced mass: {', '.join(gone)} have no effect and are left out")
    coefficients = [c for c in coefficients if c.letter not in gone]
    searched = tuple(searched_of(channels, rig, model, needed))
    idle = set(rig.unknown) - {s.name for s in searched} - {"J_m", "J_l", "k_i", "k_e", "R", "T_load"}
    idle |= rig.estimate - {s.name for s in searched} - {c.letter for c in coefficients}
    warnings += [f"{name} has no effect on {model.name} driven by {channels.drive}" for name in sorted(idle)]
    unit = "N m" if scale is None else {"current": "A", "voltage": "V"}[channels.drive]
    return Problem(
        channels,
        rig,
        model,
        load_module(model),
        rows,
        unit,
        scale,
        tuple(coefficients),
        searched,
        kept,
        tuple(warnings),
    )


def own_letters(model: Model) -> set[str]:
    """Parameters of a user's own derivation that no rig knows; their defaults hold."""
    of_rigs = {known.name for known in KNOWNS}
    return {q.name for q in model.parameters if q.name not in of_rigs and _is_number(q.default)}


def _is_number(default: sp.Expr | None) -> bool:
    return default is not None and default.is_number


def seen_columns(model: Model, known: Mapping[str, float]) -> tuple[int, ...]:
    """Columns of the regressor that are not zero throughout: without a mass, in case C1, those of F_N are."""
    absent = {q.symbol: 0 for q in model.parameters if known.get(q.name) == 0.0 and q.name in ("M", "L")}
    return tuple(
        k
        for k, column in enumerate(regressor(model))
        if not absent or meaning(model.expand(column.basis)).subs(absent) != 0
    )


def require_case(rig: Rig, model: Model) -> None:
    """Raise InputError for a model of another case than the rig's; one with a tilt is of every case."""
    if any(quantity.name == "phi" for quantity in model.parameters):
        return
    case = "C1" if model.balance("mechanical").sum_of("gravity") == 0 else "C2"
    if rig.case != case:
        received = f"case {rig.case}" if rig.case else "a tilted plane (no case)"
        raise InputError(
            f"{rig.path}: model {model.name} requires case {case}, received {received}; {rig.model} fits it"
        )


def _letters(model: Model) -> set[str]:
    """Parameters that the regressor and the gravity torque depend on."""
    expressions = [column.basis for column in regressor(model)]
    expressions.append(model.balance("mechanical").sum_of("gravity", "conservative"))
    found = {symbol.name for e in expressions for symbol in model.expand(e).free_symbols}
    return found & {quantity.name for quantity in model.parameters}
