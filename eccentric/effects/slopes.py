"""Slopes of a torque over velocity and angle, with those of the normal force, which follows both."""

from __future__ import annotations

from typing import NamedTuple

import sympy as sp

from eccentric.effects.forms import harmonic, omega_m, theta_m
from eccentric.effects.setting import Setting
from eccentric.model import Across, Along, Definition, HalfCosine, HalfSine, quantity
from eccentric.model import vocabulary as v

__all__ = ["Slopes", "slopes"]


class Slopes(NamedTuple):
    """Velocity times the slope over it [N m], the slope over the motor angle [N m/rad], and what both use."""

    damping: sp.Symbol
    stiffness: sp.Symbol
    definitions: tuple[Definition, ...]


def slopes(name: str, torque: sp.Expr, setting: Setting) -> Slopes:
    """The slopes of a torque in F_N and the motion of the motor; names begin with `name`.

    The normal force is the length of a vector: the pull of the mass and the weight along the link, and the
    weight across it. Its slopes are components along that vector, and 0 where it has no length.
    """
    pull = quantity(f"{name}_pull", "N", "centrifugal force of the mass", "", "nonnegative", letter="F_c")
    damping = quantity(
        f"{name}_damping", "N m", "motor velocity times the slope of a torque over it", letter="D"
    )
    stiffness = quantity(
        f"{name}_stiffness", "N m/rad", "slope of that torque over the motor angle", letter="K"
    )
    pulled = Definition(pull, v.M.symbol * v.L.symbol * (v.mu.symbol * omega_m) ** 2)
    along, across = sp.Integer(1), sp.Integer(0)
    if setting.case == "C2":
        cosine, sine = harmonic(v.mu.symbol)
        inside = sp.cos(v.phi.symbol) if setting.base.tilted else 1
        weight = (v.M.symbol + v.M_l.symbol) * v.g.symbol * inside
        ends = pull.symbol + weight * cosine, weight * sine
        along, across = Along(*ends), Across(*ends)
    # Of the force in the torque; friction without it is not reached.
    by_force = sp.diff(torque, v.F_N.symbol) * pull.symbol
    # By half angles, cos^2 - sin^2 is 2 cos^2 - 1: one of them is enough.
    held = sp.diff(torque, theta_m).replace(
        lambda e: e.is_Pow and isinstance(e.base, HalfSine) and e.exp == 2,
        lambda e: 1 - HalfCosine(*e.base.args) ** 2,
    )
    by_speed = omega_m * sp.diff(torque, omega_m) + 2 * along * by_force
    return Slopes(
        damping.symbol,
        stiffness.symbol,
        (
            pulled,
            Definition(damping, by_speed),
            Definition(stiffness, held - v.mu.symbol * across * by_force),
        ),
    )
