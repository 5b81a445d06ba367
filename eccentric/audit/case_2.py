"""Findings on case C2: the normal force over a turn, and what follows from it."""

from __future__ import annotations

import math

import numpy as np
import sympy as sp

from eccentric.audit.printed import listed, values
from eccentric.emission import load_module
from eccentric.model import load_model
from eccentric.model import vocabulary as v

__all__ = ["balanced_mass", "constant_speed", "global_minimum", "motor_friction_alone", "progressive"]


def global_minimum() -> str:
    """Figure 4: where the friction torque is least."""
    model = load_model("c2_parallel")
    module = load_module(model)
    mu, k_e_listed = float(listed(v.mu)), float(listed(v.k_e))
    table = {q.symbol: q.default for q in model.parameters if q.default is not None}
    omega_l = float(model.equation("critical_velocity").right.subs(table))
    link_angle, link_velocity = np.meshgrid(
        np.linspace(0, 2 * np.pi, 721), np.linspace(0, 8 * np.pi, 1601)[1:]
    )
    lines = ["Figure 4's global minimum at (7.41 rad/s, pi) exists only with k_e converted from V s/rev."]
    unit = f"{k_e_listed:.2f} V s"
    for text, k_e in (
        (f"Table 1's {unit}/rad", k_e_listed),
        (f"{unit}/rev, converted", k_e_listed / (2 * math.pi)),
    ):
        parameters = module.Parameters(mu=mu, k_e=k_e)
        at_zero = module.friction_torque(math.pi / mu, omega_l / mu, parameters)
        torque = module.friction_torque(link_angle / mu, link_velocity / mu, parameters)
        lowest = np.unravel_index(np.argmin(torque), torque.shape)
        where = f"{link_velocity[lowest]:.2f} rad/s, {link_angle[lowest]:.2f} rad"
        lines.append(
            f"   {text}: {at_zero:.4f} N m at ({omega_l:.6f} rad/s, pi),"
            f" {module.coulomb_torque(parameters):.4f} N m as the velocity tends to 0;"
            f" minimum on a grid over the figure: {torque[lowest]:.4f} N m at ({where})."
        )
    return "\n".join([*lines, "   Reading: figure 4 is drawn with k_e converted, as its caption requires."])


def balanced_mass() -> str:
    """Section 2: a mass without unbalance still has a weight."""
    squared = load_model("c2_parallel").equation("normal_force").right
    balanced = sp.sqrt(sp.factor(squared.subs(v.M.symbol, 0)))
    table = values("c2_parallel")
    force, dry = float(balanced.subs(table)), float((v.mu.symbol * v.C_lN.symbol * balanced).subs(table))
    return (
        "Section 2 says that the normal forces of an evenly distributed mass have the sum zero;"
        f" in case C2, (16) with M = 0 gives F_N = {balanced}.\n"
        f"   Table 1, mu = 1/5: F_N = {force:.3f} N, or {dry:.4f} N m of Coulomb friction at the motor.\n"
        "   Reading: F_N of a balanced link is its weight: its friction does not depend on the angle, and is"
        " not zero."
    )


def motor_friction_alone() -> str:
    """Section 4: what is left of F where F_N vanishes."""
    model, table = load_model("c2_parallel"), values("c2_parallel")
    omega_m = model.equation("critical_velocity").right / v.mu.symbol
    at_top = {v.F_N.symbol: 0, v.omega_m.symbol: omega_m}
    motor = float(model.equation("motor_friction").right.subs(at_top).subs(table))
    lines = []
    for text, k_e in (
        (f"k_e = {float(listed(v.k_e)):.2f} V s/rad", listed(v.k_e)),
        ("k_e converted from V s/rev", listed(v.k_e) / (2 * sp.pi)),
    ):
        F = float(model.equation("resultant").right.subs(at_top).subs(values("c2_parallel", k_e=k_e)))
        lines.append(f"   {text}: F = {F:.4f} N m, of which {F - motor:.4f} N m is back-EMF damping.")
    return "\n".join(
        [
            (
                "Section 4 says that where F_N vanishes (18) is the motor's friction alone;"
                " (19) keeps the back-EMF damping k_i k_e/R there."
            ),
            f"   Motor friction (10) at the critical velocity, mu = 1/5: {motor:.4f} N m.",
            *lines,
            "   Reading: F is the resultant torque of (6); the mechanical friction is emitted as well.",
        ]
    )


def constant_speed() -> str:
    """Section 4: the voltage of a constant speed."""
    model = load_model("c2_parallel")
    mu = float(listed(v.mu))
    omega_m = float(model.equation("critical_velocity").right.subs(values("c2_parallel"))) / mu
    theta_l = np.linspace(0.0, 2.0 * np.pi, 3601)
    module = load_module(model)
    u = module.voltage(theta_l / mu, omega_m, 0.0, module.Parameters(mu=mu, J_m=0.0, J_l=0.0))
    low, high = int(np.argmin(u)), int(np.argmax(u))
    return (
        "Section 4 takes the velocity as constant over the turn; by (4), G and F_N vary the voltage then.\n"
        f"   Table 1, mu = 1/5, critical velocity: u from {u[low]:.2f} V at theta_l = {theta_l[low]:.2f} rad"
        f" to {u[high]:.2f} V at {theta_l[high]:.2f} rad.\n"
        "   Reading: a controller holds the speed; at constant voltage alpha_m is not zero in case C2."
    )


def progressive() -> str:
    """Figure 5: whether the friction torque is a progressive function of the velocity."""
    model, omega_m, s = load_model("c2_parallel"), v.omega_m.symbol, sp.Symbol("s")
    forward = {sp.sign(omega_m): 1}

    def curvature(name: str) -> sp.Expr:
        column = [c.subs(forward) for c in model.equation(name).right]
        F = sum(c * omega_m**k for c, k in zip(column, (3, 2, 1, 0), strict=True))
        return sp.factor(sp.diff(F, omega_m, 2))

    bottom = curvature("bottom")
    same = sp.expand(curvature("top") + s * bottom) == 0
    return (
        "Figure 5 and section 5 call the friction of case C2 progressive.\n"
        f"   d^2F/d(omega_m)^2 for omega_m > 0 is {str(bottom).replace('**', '^')} at the bottom, always"
        f" positive; at the top it {'is -s times that' if same else 'DIFFERS'}.\n"
        "   Reading: at the top F is degressive below the critical velocity (s = 1) and progressive above it."
    )
