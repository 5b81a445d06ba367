"""Slopes of a torque over velocity and angle, with those of the normal force, which follows both."""

from __future__ import annotations

from typing import NamedTuple

import sympy as sp

from eccentric.effects.forms import harmonic, omega_m, theta_m
from eccentric.effects.setting import Setting
from eccentric.model import Across, Along, Definition, HalfCosine, HalfSine, quantity
from eccentric.model import vocabulary as v

__all__ = ["Slopes", "over_angle", "slopes"]


class Slopes(NamedTuple):
    """Velocity times the slope over it [N m], the slope over the motor angle [N m/rad], and what both use."""

    by_speed: sp.Symbol
    by_angle: sp.Symbol
    definitions: tuple[Definition, ...]


def slopes(name: str, torque: sp.Expr, setting: Setting) -> Slopes:
    """The slopes of a torque in F_N and the motion of the motor; names begin with `name`.

    The normal force is the length of a vector: the pull of the mass and the weight along the link, and the
    weight across it. Its slopes are components along that vector, and 0 where it has no length.
    """
    pull = quantity(f"{name}_pull", "N", "centrifugal force of the mass", "", "nonnegative", letter="F_c")
    speed = quantity(f"{name}_by_speed", "N m", "velocity times a torque's slope over it", letter="D")
    angle = quantity(f"{name}_by_angle", "N m/rad", "its slope over the motor angle", letter="K")
    torque = _in_force(torque, setting)
    by_force = sp.diff(torque, v.F_N.symbol) * pull.symbol
    by_angle = over_angle(torque)
    by_speed = omega_m * sp.diff(torque, omega_m)
    pulled: tuple[Definition, ...] = ()
    if by_force != 0:
        pulled = (Definition(pull, v.M.symbol * v.L.symbol * (v.mu.symbol * omega_m) ** 2),)
        along, across = _direction(pull.symbol, setting)
        by_speed += 2 * along * by_force
        by_angle -= v.mu.symbol * across * by_force
    return Slopes(
        speed.symbol, angle.symbol, (*pulled, Definition(speed, by_speed), Definition(angle, by_angle))
    )


def over_angle(torque: sp.Expr) -> sp.Expr:
    """The slope of a torque over the motor angle; by half angles, cos^2 - sin^2 is 2 cos^2 - 1."""
    return sp.diff(torque, theta_m).replace(
        lambda e: e.is_Pow and isinstance(e.base, HalfSine) and e.exp == 2,
        lambda e: 1 - HalfCosine(*e.base.args) ** 2,
    )


def _in_force(torque: sp.Expr, setting: Setting) -> sp.Expr:
    """The torque without definitions that follow from the normal force, such as another load of a bearing."""
    for definition in reversed(setting.base.definitions):
        if definition.symbol == v.F_N.symbol:
            break
        torque = torque.xreplace({definition.symbol: definition.value})
    return torque


def _direction(pull: sp.Symbol, setting: Setting) -> tuple[sp.Expr, sp.Expr]:
    """Components of the normal force along the link and across it, over its length."""
    if setting.case == "C1":
        return sp.Integer(1), sp.Integer(0)
    cosine, sine = harmonic(v.mu.symbol)
    inside = sp.cos(v.phi.symbol) if setting.base.tilted else 1
    weight = (v.M.symbol + v.M_l.symbol) * v.g.symbol * inside
    ends = pull + weight * cosine, weight * sine
    return Along(*ends), Across(*ends)
