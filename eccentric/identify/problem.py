"""A rig and a model as a linear problem: target = columns @ coefficients, given a few values that enter otherwise.

    torque:  tau                = J alpha + G + f                       [N m]
    current: k_i i              = J alpha + G + f                       [N m]
    voltage: (k_i/R) u          = J alpha + G + f + (k_i k_e/R) w       [N m]   R and k_i known
    voltage: u                  = (R/k_i) (J alpha + G + f) + k_e w     [V]     else
    current: i                  = (1/k_i) (J alpha + G + f)             [A]     k_i known by a range only

f is the emitted regressor times its coefficients.  What is known moves to the left; with an unknown scale s (R/k_i
or 1/k_i) what is known of J alpha + G becomes the column of s, and without any of it only products with s come out.
"""

from __future__ import annotations

import dataclasses
import inspect
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.emit.hot import load_module
from eccentric.errors import InputError
from eccentric.identify.known import KNOWNS
from eccentric.identify.windowed import Sampling, sample
from eccentric.model import Model, regressor

if TYPE_CHECKING:
    from eccentric.identify.channels import Channels
    from eccentric.identify.rig import Rig

Array = NDArray[np.float64]

R, k_i, k_e, J, u_0 = sp.symbols("R k_i k_e J u_0")
_UNITS = {known.name: known.unit for known in KNOWNS}
LINEAR_UNITS = ("N m", "N m s/rad")
"""Coulomb and viscous friction: the coefficients whose columns are sgn(w) and w."""


@dataclass(frozen=True)
class Coefficient:
    """A column: its coefficient as an expression, what that means in the paper's letters, unit, bounds.

    role: friction, inertia, scale or offset. `linear`: it belongs to the linear model as well. `letter` is the
    coefficient without the scale, `mechanical_unit` its unit.
    """

    expression: sp.Expr
    meaning: sp.Expr
    unit: str
    lower: float
    upper: float
    role: str
    linear: bool
    letter: str
    mechanical_unit: str

    @property
    def name(self) -> str:
        """The expression as text."""
        return self.letter if self.role == "offset" else as_text(self.expression)


def as_text(expression: sp.Expr) -> str:
    """Return an expression as a reader writes it."""
    return str(expression).replace("**", "^")


@dataclass(frozen=True)
class Searched:
    """A value that does not enter linearly: its unit, its range, where to start looking."""

    name: str
    unit: str
    lower: float
    upper: float
    starts: tuple[float, ...]
    step: float


@dataclass(frozen=True)
class Problem:
    """What is minimised. `unit` is that of target and residual; `scale` is s, None where it is one."""

    channels: Channels
    rig: Rig
    model: Model
    module: ModuleType
    sampling: Sampling
    unit: str
    scale: sp.Expr | None
    coefficients: tuple[Coefficient, ...]
    searched: tuple[Searched, ...]
    warnings: tuple[str, ...]

    @property
    def starts(self) -> dict[str, float]:
        """The first value of everything searched."""
        return {s.name: s.starts[0] for s in self.searched}

    @property
    def scale_known(self) -> bool:
        """Tell whether newton metres come out: the scale is one, or has a column of its own."""
        return self.scale is None or any(c.role == "scale" for c in self.coefficients)

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

    def rows(self, values: Mapping[str, float]) -> tuple[Array, Array]:
        """Return target (m,) and columns (m, k) under the searched values."""
        channels = self.channels
        aligned = {k: v for k, v in values.items() if k in ("input_delay_s", "theta_zero_rad")}
        if aligned:
            channels = channels.realigned(self.rig, **aligned)
        parameters = self.parameters({k: v for k, v in values.items() if k not in aligned})
        signals = {"theta_m": channels.theta_m, "omega_m": channels.omega_m, "alpha_m": channels.alpha_m}
        friction = self.sampling.mean(self.module.regressor(*(signals[n] for n in self._inputs), parameters))
        known, inertia = self._known(channels, parameters)
        by_role = {"inertia": inertia, "scale": known, "offset": self._offset()}
        columns = [by_role[c.role] for c in self.coefficients if c.role != "friction"]
        target = self.sampling.mean(self._drive(channels)) - (known if self.scale is None else 0.0)
        return target, np.column_stack([friction, *columns])

    def drive_signal(self, values: Mapping[str, float]) -> Array:
        """Return what is explained as a whole, in `unit`, at the rows (m,)."""
        aligned = {k: v for k, v in values.items() if k in ("input_delay_s", "theta_zero_rad")}
        return self.sampling.mean(self._drive(self.channels.realigned(self.rig, **aligned)))

    def _drive(self, channels: Channels) -> Array:
        known = self.rig.known
        signal = getattr(channels, channels.drive)
        if channels.drive == "current" and self.scale is None:
            return known["k_i"] * signal
        if channels.drive == "voltage":
            emf = known.get("k_e", 0.0) * channels.omega_m
            return (signal - emf) * (known["k_i"] / known["R"] if self.scale is None else 1.0)
        return signal

    def _offset(self) -> Array:
        factor = self.rig.known["k_i"] / self.rig.known["R"] if self.scale is None else 1.0
        return np.full(len(self.sampling.t), factor)

    def _known(self, channels: Channels, parameters: object) -> tuple[Array, Array]:
        """Return what is known of J alpha + G (m,), and alpha (m,)."""
        acceleration = self.sampling.acceleration(channels)
        gravity = np.zeros_like(acceleration)
        if inspect.signature(self.module.gravity_torque).parameters.get("theta_m"):
            gravity = self.sampling.mean(self.module.gravity_torque(channels.theta_m, parameters))
        inertia = known_inertia(self.rig)
        return gravity + (0.0 if inertia is None else inertia * acceleration), acceleration


def known_inertia(rig: Rig) -> float | None:
    """Return J_m + mu^2 J_l [kg m^2] where the rig has all three, else None."""
    letters = ("J_m", "J_l", "mu")
    if not all(letter in rig.known for letter in letters):
        return None
    rotor, link, mu = (rig.known[letter] for letter in letters)
    return rotor + mu**2 * link


def pose(channels: Channels, rig: Rig, model: Model) -> Problem:
    """Return the problem of a log under a rig and a model.

    Raises InputError for a model of another case than the rig's, a letter that the model needs and the rig
    gives neither as a value nor as a range, and a current without k_i.
    """
    _require_case(rig, model)
    needed = _letters(model)
    for letter in sorted(needed):
        if letter not in rig.known and letter not in rig.unknown:
            raise InputError(
                f"{rig.path}: [known] {letter} is required by {model.name}, or its range in [unknown]; "
                "received neither"
            )
    scale = _scale(channels.drive, rig)
    sampling = sample(channels, rig)
    warnings = list(channels.warnings)
    if sampling.windows is not None:
        warnings.append(f"the log is fitted, and its error taken, on {sampling.description}")
    coefficients = tuple(_coefficients(channels, rig, model, scale))
    searched = tuple(_searched(channels, rig, model, needed))
    idle = set(rig.unknown) - {s.name for s in searched} - {"J_m", "J_l", "k_i", "k_e", "R"}
    idle |= rig.estimate - {s.name for s in searched} - {c.letter for c in coefficients}
    warnings += [f"{name} has no effect on {model.name} driven by {channels.drive}" for name in sorted(idle)]
    unit = "N m" if scale is None else {"current": "A", "voltage": "V"}[channels.drive]
    module = load_module(model)
    return Problem(
        channels, rig, model, module, sampling, unit, scale, coefficients, searched, tuple(warnings)
    )


def _require_case(rig: Rig, model: Model) -> None:
    if any(quantity.name == "phi" for quantity in model.parameters):
        return
    case = "C1" if model.balance("mechanical").sum_of("gravity") == 0 else "C2"
    if rig.case != case:
        received = f"case {rig.case}" if rig.case else "a tilted plane (no case)"
        raise InputError(
            f"{rig.path}: model {model.name} requires case {case}, received {received}; "
            f"{rig.model} fits it"
        )


def _letters(model: Model) -> set[str]:
    """Parameters that the regressor and the gravity torque depend on."""
    expressions = [column.basis for column in regressor(model)]
    expressions.append(model.balance("mechanical").sum_of("gravity", "conservative"))
    found = {symbol.name for e in expressions for symbol in model.expand(e).free_symbols}
    return found & {quantity.name for quantity in model.parameters}


def _scale(drive: str, rig: Rig) -> sp.Expr | None:
    if drive == "voltage":
        return None if "R" in rig.known and "k_i" in rig.known else R / k_i
    if drive == "current" and "k_i" not in rig.known:
        if "k_i" in rig.unknown:
            return 1 / k_i
        raise InputError(
            f"{rig.path}: [known] k_i_Nm_per_A is required to make a torque of the current "
            "(or its range in [unknown], to identify it along); received neither"
        )
    return None


def _coefficients(channels: Channels, rig: Rig, model: Model, scale: sp.Expr | None) -> list[Coefficient]:
    """Columns in the order of `Problem.rows`: friction first, then inertia, scale, offset."""
    unit = {None: "N m", R / k_i: "V", 1 / k_i: "A"}[scale]
    s = sp.Integer(1) if scale is None else scale
    found: list[Coefficient] = []
    for column in regressor(model):
        linear = column.unit in LINEAR_UNITS
        expression, meaning = s * column.coefficient, s * model.expand(column.coefficient)
        if column.unit == "N m s/rad" and channels.drive == "voltage" and "k_e" not in rig.known:
            # The back-EMF has the same column, w; only the sum can be seen.
            emf = k_e if scale is not None else k_i * k_e / R
            expression, meaning = expression + emf, meaning + emf
        low, high = (0.0 if b is None and not k else math.inf if b is None else float(b)
                     for k, b in enumerate(column.bounds))  # fmt: skip
        found.append(
            Coefficient(
                _plain(expression), _plain(meaning), _scaled(column.unit, unit), low, high, "friction", linear, column.name,
                column.unit,
            )
        )  # fmt: skip
    inertia = known_inertia(rig)
    s_low, s_high = _scale_range(rig, scale)
    if inertia is None:
        low, high = _inertia_range(rig)
        found.append(
            Coefficient(s * J, s * J, _scaled("kg m^2", unit), s_low * low, s_high * high, "inertia", True, "J", "kg m^2")
        )
    gravity = model.balance("mechanical").sum_of("gravity", "conservative")
    if scale is not None and (gravity != 0 or inertia is not None):
        found.append(Coefficient(scale, scale, f"{unit}/(N m)", s_low, s_high, "scale", True, str(scale), "1"))
    if "voltage_offset_V" in rig.estimate and channels.drive == "voltage":
        found.append(
            Coefficient(u_0, u_0, "V", -math.inf, math.inf, "offset", True, "voltage_offset_V", "V")
        )
    return found


def _plain(expression: sp.Expr) -> sp.Expr:
    """Symbols by name alone: the model's carry assumptions, and those that print alike would not be equal."""
    named = {symbol: sp.Symbol(symbol.name) for symbol in expression.free_symbols}
    return sp.expand(expression.xreplace(named))


def _scaled(unit: str, drive: str) -> str:
    """The unit of a mechanical coefficient times the scale, for a drive in volts or amperes."""
    if drive == "N m":
        return unit
    return {
        "N m": drive,
        "N m s/rad": f"{drive} s/rad",
        "m": f"{drive}/N",
        "m s/rad": f"{drive} s/(N rad)",
        "kg m^2": f"{drive} s^2/rad",
    }.get(unit, f"{unit} {drive}/(N m)")


def _range(rig: Rig, letter: str) -> tuple[float, float]:
    return (rig.known[letter],) * 2 if letter in rig.known else rig.unknown.get(letter, (0.0, math.inf))


def _scale_range(rig: Rig, scale: sp.Expr | None) -> tuple[float, float]:
    if scale is None:
        return 1.0, 1.0
    low, high = _range(rig, "k_i")
    r_low, r_high = _range(rig, "R") if scale.has(R) else (1.0, 1.0)
    return (r_low / high if math.isfinite(high) else 0.0), (r_high / low if low else math.inf)


def _inertia_range(rig: Rig) -> tuple[float, float]:
    (m_low, m_high), (l_low, l_high), (low, high) = (_range(rig, k) for k in ("J_m", "J_l", "mu"))
    return m_low + low**2 * l_low, m_high + high**2 * l_high


def _searched(channels: Channels, rig: Rig, model: Model, needed: set[str]) -> list[Searched]:
    together = np.diff(channels.segment) == 0
    step = float(np.median(np.diff(channels.t)[together]))
    turning = any(
        "theta_m" in {x.name for x in model.expand(e).free_symbols}
        for e in (*(c.basis for c in regressor(model)), model.balance("mechanical").sum_of("gravity"))
    )
    found: list[Searched] = []
    if "input_delay_s" in rig.estimate and channels.drive == "voltage":
        starts = tuple(k * step for k in (1.0, 0.0, 2.0, 4.0))
        found.append(Searched("input_delay_s", "s", 0.0, max(0.1, 6.0 * step), starts, step))
    if "theta_zero_rad" in rig.estimate and turning:
        found.append(Searched("theta_zero_rad", "rad", -math.pi, math.pi, (0.0,), 0.1))
    for letter, (low, high) in rig.unknown.items():
        if letter in needed:
            starts = tuple(low + part * (high - low) for part in (0.5, 0.1, 0.9))
            found.append(Searched(letter, _UNITS[letter], low, high, starts, (high - low) / 4.0))
    return found
