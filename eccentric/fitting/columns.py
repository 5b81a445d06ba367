"""The columns of a fit: which coefficients a rig leaves open, what they mean, their units and bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from eccentric.errors import InputError
from eccentric.model import Model, Role, regressor
from eccentric.rigs import KNOWNS

if TYPE_CHECKING:
    from eccentric.rigs import Rig
    from eccentric.signals import Channels

R, k_i, k_e, J, u_0, T_load = sp.symbols("R k_i k_e J u_0 T_load")
_UNITS = {known.name: known.unit for known in KNOWNS}


@dataclass(frozen=True)
class Coefficient:
    """A column: its coefficient as an expression, what that means in the paper's letters, unit, bounds.

    role: friction, inertia, scale, load or offset. `linear`: it belongs to the linear model as well. `letter`
    is the coefficient without the scale, `mechanical_unit` its unit.
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


def known_inertia(rig: Rig) -> float | None:
    """Return J_m + mu^2 J_l [kg m^2] where the rig has all three, else None."""
    letters = ("J_m", "J_l", "mu")
    if not all(letter in rig.known for letter in letters):
        return None
    rotor, link, mu = (rig.known[letter] for letter in letters)
    return rotor + mu**2 * link


def scale_of(drive: str, rig: Rig) -> sp.Expr | None:
    """Return what the mechanical balance is multiplied by, None for one.

    Raises InputError for a current whose k_i is neither known nor known by a range.
    """
    if drive == "voltage":
        return None if "R" in rig.known and "k_i" in rig.known else R / k_i
    if drive == "current" and "k_i" not in rig.known:
        if "k_i" in rig.unknown:
            return 1 / k_i
        raise InputError(
            f"{rig.path}: [known] k_i is required to make a torque of the current "
            "(or its range in [unknown], to identify it along); received neither"
        )
    return None


def coefficients_of(channels: Channels, rig: Rig, model: Model, scale: sp.Expr | None) -> list[Coefficient]:
    """Return the columns in the order of `Problem.rows`: friction first, then inertia, scale, offset."""
    unit = {None: "N m", R / k_i: "V", 1 / k_i: "A"}[scale]
    s = sp.Integer(1) if scale is None else scale
    found: list[Coefficient] = []
    for column in regressor(model):
        expression, meaning = s * column.coefficient, s * model.expand(column.coefficient)
        if (
            column.linear
            and column.role is Role.VISCOUS
            and channels.drive == "voltage"
            and "k_e" not in rig.known
        ):
            # The back-EMF has the same column, w; only the sum can be seen.
            emf = k_e if scale is not None else k_i * k_e / R
            expression, meaning = expression + emf, meaning + emf
        low = -math.inf if column.bounds[0] is None else float(column.bounds[0])
        high = math.inf if column.bounds[1] is None else float(column.bounds[1])
        own, shown = _scaled(column.unit, unit), _plain(expression)
        found.append(
            Coefficient(
                shown, _plain(meaning), own, low, high, "friction", column.linear, column.name, column.unit
            )
        )
    inertia = known_inertia(rig)
    s_low, s_high = _scale_range(rig, scale)
    if inertia is None:
        low, high = _inertia_range(rig)
        own, bounds = _scaled("kg m^2", unit), (s_low * low, s_high * high)
        found.append(Coefficient(s * J, s * J, own, *bounds, "inertia", True, "J", "kg m^2"))
    gravity = model.balance("mechanical").sum_of("gravity", "conservative")
    if scale is not None and (gravity != 0 or inertia is not None):
        found.append(
            Coefficient(scale, scale, f"{unit}/(N m)", s_low, s_high, "scale", True, str(scale), "1")
        )
    if "T_load" in rig.unknown:
        found.append(
            Coefficient(s * T_load, s * T_load, unit, -math.inf, math.inf, "load", True, "T_load", "N m")
        )
    if "voltage_offset_V" in rig.estimate and channels.drive == "voltage":
        found.append(Coefficient(u_0, u_0, "V", -math.inf, math.inf, "offset", True, "voltage_offset_V", "V"))
    return found


def _plain(expression: sp.Expr) -> sp.Expr:
    """Symbols by name alone: the model's carry assumptions, so that those that print alike differ."""
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
    if letter in rig.known:
        return rig.known[letter], rig.known[letter]
    return rig.unknown.get(letter, (0.0, math.inf))


def _scale_range(rig: Rig, scale: sp.Expr | None) -> tuple[float, float]:
    if scale is None:
        return 1.0, 1.0
    low, high = _range(rig, "k_i")
    r_low, r_high = _range(rig, "R") if scale.has(R) else (1.0, 1.0)
    return (r_low / high if math.isfinite(high) else 0.0), (r_high / low if low else math.inf)


def _inertia_range(rig: Rig) -> tuple[float, float]:
    (m_low, m_high), (l_low, l_high), (low, high) = (_range(rig, k) for k in ("J_m", "J_l", "mu"))
    return m_low + low**2 * l_low, m_high + high**2 * l_high


def searched_of(channels: Channels, rig: Rig, model: Model, needed: set[str]) -> list[Searched]:
    """Return what does not enter linearly: delay and zero angle to estimate, `needed` letters with ranges."""
    step = channels.logged_step_s
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
