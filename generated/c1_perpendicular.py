# Generated: do not edit. Written by `make derive` from derivations/c1_perpendicular.py
# (eccentric 0.2.0b1, program b6caacd1).
# Case C1: gravity perpendicular to the motion plane, steady motion.
"""Case C1: gravity perpendicular to the motion plane, steady motion.

Inputs are on the motor side, in SI units. They broadcast, float32 stays float32, and `out` is supported.
Every function takes inputs, parameters=None, out=None; the default parameters are those of `Parameters`.
A TypeError names an argument that is not a real number; a ValueError, one too large for float32 inputs.

Below, each function is a formula; `c` has the values that depend on parameters only, computed by `_prepare`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

if __package__:
    from . import eccentric_runtime as runtime
else:  # it lies beside this file
    import eccentric_runtime as runtime

__all__ = [
    "GRADIENT",
    "JACOBIAN",
    "REGRESSOR",
    "Parameters",
    "acceleration",
    "breakaway_torque",
    "current",
    "electrical_residual",
    "friction_budget",
    "friction_coefficients",
    "friction_step",
    "friction_torque",
    "friction_torque_gradient",
    "friction_torque_jacobian",
    "friction_torque_with_gradient",
    "gravity_torque",
    "mechanical_friction_torque",
    "mechanical_residual",
    "normal_force",
    "polynomial",
    "regressor",
    "voltage",
]

REGRESSOR = ("B_lN", "C_lN", "B", "C")
GRADIENT = ("omega_m",)
JACOBIAN = ("B_lN", "C_lN", "B_lT", "C_lT", "B_m", "C_m")


@dataclass(frozen=True)
class Parameters(runtime.Checked):
    """Parameters with the paper's letters, in SI units; the defaults are Table 1 of the paper with mu = 1/5.

    Real numbers of any type are accepted and stored as floats.

    Raises:
        TypeError: a value is not a real number.
        ValueError: a value is not finite, or has an impossible sign.
    """

    M: float = runtime.nonnegative(0.5, "kg")
    """unbalanced mass [kg], eq. (5)"""
    M_l: float = runtime.nonnegative(0.2, "kg")
    """mass of the link without M [kg], eq. (15)"""
    L: float = runtime.nonnegative(0.25, "m")
    """distance of M from the axis [m], eq. (5)"""
    mu: float = runtime.positive(0.2, "1")
    """gear ratio theta_l/theta_m [1], eq. (3)"""
    R: float = runtime.positive(1.0, "Ohm")
    """armature resistance [Ohm], eq. (2)"""
    k_i: float = runtime.positive(0.02, "N m/A")
    """torque constant [N m/A], eq. (2)"""
    k_e: float = runtime.nonnegative(0.2, "V s/rad")
    """back-EMF constant [V s/rad], eq. (2)"""
    g: float = runtime.nonnegative(9.81, "m/s^2")
    """gravitational acceleration [m/s^2], eq. (5)"""
    B_lN: float = runtime.nonnegative(0.004, "m s/rad")
    """viscous friction of the link per normal force [m s/rad], eq. (9)"""
    C_lN: float = runtime.nonnegative(0.08, "m")
    """Coulomb friction of the link per normal force [m], eq. (9)"""
    B_lT: float = runtime.nonnegative(0.004, "m s/rad")
    """viscous friction of the link per transversal force [m s/rad], eq. (9)"""
    C_lT: float = runtime.nonnegative(0.08, "m")
    """Coulomb friction of the link per transversal force [m], eq. (9)"""
    B_m: float = runtime.nonnegative(0.0004, "N m s/rad")
    """viscous friction of the motor [N m s/rad], eq. (10)"""
    C_m: float = runtime.nonnegative(0.008, "N m")
    """Coulomb friction of the motor [N m], eq. (10)"""
    F_T: float | None = runtime.nonnegative(None, "N")
    """transversal force of a level plane [N], eq. (9), M_l*g if None"""
    J_m: float | None = runtime.nonnegative(None, "kg m^2")
    """inertia of the motor [kg m^2], eq. (1), needed with alpha_m"""
    J_l: float | None = runtime.nonnegative(None, "kg m^2")
    """inertia of the link about its axis, M L^2 included [kg m^2], eq. (3), needed with alpha_m"""


def _prepare(p, c):
    """Compute values that depend on parameters only; values beyond double precision are Pairs."""
    F_T = p.M_l * p.g if p.F_T is None else p.F_T
    J_m = math.nan if p.J_m is None else p.J_m
    J_l = math.nan if p.J_l is None else p.J_l
    c.mu = p.mu
    c.k_i = p.k_i
    c.B_lN = p.B_lN
    c.C_lN = p.C_lN
    c.L_M_mu2 = p.L * p.M * p.mu * p.mu
    c.B_lN_mu2 = p.B_lN * p.mu * p.mu
    c.B = p.B_lT * F_T * p.mu * p.mu + p.B_m
    c.B_plus_k_e_k_i_per_R = c.B + p.k_e * p.k_i / p.R
    c.C_lN_mu = p.C_lN * p.mu
    c.C = p.C_lT * F_T * p.mu + p.C_m
    c.twice_L_M_mu2 = 2.0 * p.L * p.M * p.mu * p.mu
    c.mu2 = p.mu * p.mu
    c.F_T_mu2 = F_T * p.mu * p.mu
    c.F_T_mu = F_T * p.mu
    c.J = J_l * p.mu * p.mu + J_m
    c.B_lN_R_mu2_per_k_i = p.B_lN * p.R * p.mu * p.mu / p.k_i
    c.B_R_per_k_i_plus_k_e = c.B * p.R / p.k_i + p.k_e
    c.C_lN_R_mu_per_k_i = p.C_lN * p.R * p.mu / p.k_i
    c.C_R_per_k_i = c.C * p.R / p.k_i
    c.R_per_k_i = p.R / p.k_i
    c.B_lN_mu2_per_k_i = p.B_lN * p.mu * p.mu / p.k_i
    c.B_per_k_i = c.B / p.k_i
    c.per_k_i = 1.0 / p.k_i
    c.C_lN_mu_per_k_i = p.C_lN * p.mu / p.k_i
    c.C_per_k_i = c.C / p.k_i
    c.k_i_per_R = p.k_i / p.R
    c.k_e_k_i_per_R = p.k_e * p.k_i / p.R
    c.B_lN_L_M_mu4 = p.B_lN * p.L * p.M * p.mu * p.mu * p.mu * p.mu
    c.C_lN_L_M_mu3 = p.C_lN * p.L * p.M * p.mu * p.mu * p.mu


_INPUTS = {
    "omega_m": "motor velocity [rad/s]",
    "alpha_m": "motor acceleration [rad/s^2]",
    "i": "armature current [A]",
    "u": "armature voltage [V]",
    "torque": "torque on the motor side of everything but friction [N m]",
    "dt": "time step, positive [s]",
}
_model = runtime.Model(Parameters, _prepare, _INPUTS)


@_model.function
def normal_force(c, omega_m):
    """Normal force F_N on the axis of rotation [N]."""
    # normal force on the axis of rotation [N], eq (8)
    return c.L_M_mu2 * omega_m * omega_m


@_model.function
def friction_torque(c, omega_m):
    """Resultant friction torque F, back-EMF damping included, eq (6) [N m]."""
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = np.sign(omega_m)
    part_1 = omega_m * (c.B_lN_mu2 * F_N + c.B_plus_k_e_k_i_per_R)
    return direction_of_motion * (c.C + c.C_lN_mu * F_N) + part_1


@_model.function
def mechanical_friction_torque(c, omega_m):
    """Mechanical friction torque f = f_m + mu f_l, without back-EMF [N m]."""
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = np.sign(omega_m)
    return omega_m * (c.B + c.B_lN_mu2 * F_N) + direction_of_motion * (c.C + c.C_lN_mu * F_N)


@_model.function
def friction_torque_gradient(c, omega_m):
    """Partial derivatives of friction_torque with respect to its inputs.

    In N m per rad/s; last axis (omega_m).
    """
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    F_N_d_omega_m = omega_m * c.twice_L_M_mu2
    direction_of_motion = np.sign(omega_m)
    part_1 = F_N_d_omega_m * (c.B_lN_mu2 * omega_m + c.C_lN_mu * direction_of_motion)
    result_omega_m = c.B_lN_mu2 * F_N + c.B_plus_k_e_k_i_per_R + part_1
    return (result_omega_m,)


@_model.function
def friction_torque_with_gradient(c, omega_m):
    """Friction torque and its partial derivatives, for linearisation.

    In N m, N m per rad/s; last axis (friction_torque, omega_m).
    """
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    F_N_d_omega_m = omega_m * c.twice_L_M_mu2
    direction_of_motion = np.sign(omega_m)
    part_1 = omega_m * (c.B_lN_mu2 * F_N + c.B_plus_k_e_k_i_per_R)
    result_friction_torque = direction_of_motion * (c.C + c.C_lN_mu * F_N) + part_1
    part_2 = F_N_d_omega_m * (c.B_lN_mu2 * omega_m + c.C_lN_mu * direction_of_motion)
    result_omega_m = c.B_lN_mu2 * F_N + c.B_plus_k_e_k_i_per_R + part_2
    return result_friction_torque, result_omega_m


@_model.function
def friction_torque_jacobian(c, omega_m):
    """Partial derivatives of friction_torque with respect to all friction coefficients.

    In N m per unit coefficient; last axis (B_lN, C_lN, B_lT, C_lT, B_m, C_m).
    """
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    result_B_lN = F_N * c.mu2 * omega_m
    direction_of_motion = np.sign(omega_m)
    result_C_lN = F_N * direction_of_motion * c.mu
    result_B_lT = c.F_T_mu2 * omega_m
    result_C_lT = c.F_T_mu * direction_of_motion
    return result_B_lN, result_C_lN, result_B_lT, result_C_lT, omega_m, direction_of_motion


@_model.function
def regressor(c, omega_m):
    """Columns: regressor times friction_coefficients is mechanical_friction_torque.

    In N m per unit coefficient; last axis (B_lN, C_lN, B, C).
    """
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    result_B_lN = F_N * c.mu2 * omega_m
    direction_of_motion = np.sign(omega_m)
    result_C_lN = F_N * direction_of_motion * c.mu
    return result_B_lN, result_C_lN, omega_m, direction_of_motion


@_model.function
def friction_coefficients(c):
    """Coefficients of the columns of the regressor.

    In m s/rad, m, N m s/rad, N m; last axis (B_lN, C_lN, B, C).
    """
    return c.B_lN, c.C_lN, c.B, c.C


@_model.function
def breakaway_torque(c):
    """Levels of dry friction at rest: any torque between them holds the drive.

    In N m; last axis (lower, upper).
    """
    result_lower = -c.C
    return result_lower, c.C


def coulomb_torque(*_, **__):
    """Renamed to `breakaway_torque`."""
    raise AttributeError("coulomb_torque: now breakaway_torque, which returns the lower and the upper level")


@_model.function
def friction_budget(c, omega_m):
    """Levels of dry friction at this state, and the viscous coefficient.

    In N m, N m, N m s/rad; last axis (lower, upper, viscous).
    """
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    result_lower = -c.C - c.C_lN_mu * F_N
    result_upper = c.C + c.C_lN_mu * F_N
    result_viscous = c.B + c.B_lN_mu2 * F_N
    return result_lower, result_upper, result_viscous


@_model.function
def gravity_torque(c):
    """Gravity torque G, eq (5) [N m]."""
    return 0.0


@_model.function(needs=("J_m", "J_l"))
def voltage(c, omega_m, alpha_m=0.0):
    """Armature voltage u = (R/k_i) (J alpha_m + G + F), eq (4) [V]."""
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = np.sign(omega_m)
    part_2 = omega_m * (c.B_R_per_k_i_plus_k_e + c.B_lN_R_mu2_per_k_i * F_N)
    part_3 = c.R_per_k_i * np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    return direction_of_motion * (c.C_R_per_k_i + c.C_lN_R_mu_per_k_i * F_N) + part_2 + part_3


@_model.function(needs=("J_m", "J_l"))
def current(c, omega_m, alpha_m=0.0):
    """Armature current i = (J alpha_m + G + f)/k_i [A]."""
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = np.sign(omega_m)
    part_2 = c.per_k_i * np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    part_3 = omega_m * (c.B_lN_mu2_per_k_i * F_N + c.B_per_k_i)
    return direction_of_motion * (c.C_lN_mu_per_k_i * F_N + c.C_per_k_i) + part_2 + part_3


@_model.function(needs=("J_m", "J_l"))
def mechanical_residual(c, omega_m, i, alpha_m=0.0):
    """Residual of the mechanical balance: k_i i - J alpha_m - G - f [N m]."""
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = np.sign(omega_m)
    part_1 = -np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    part_2 = -direction_of_motion * (c.C + c.C_lN_mu * F_N)
    return i * c.k_i - omega_m * (c.B + c.B_lN_mu2 * F_N) + part_1 + part_2


@_model.function
def electrical_residual(c, omega_m, i, u):
    """Residual of the electrical balance, as a torque: (k_i/R)(u - k_e omega_m) - k_i i [N m]."""
    return -i * c.k_i - c.k_e_k_i_per_R * omega_m + c.k_i_per_R * u


@_model.function(needs=("J_m", "J_l"))
def friction_step(c, omega_m, torque, dt):
    """Velocity after a time step and the friction torque in it, unchanged if dt is less than 1e-9 s.

    In rad/s, N m; last axis (omega_m, friction).
    """
    # time step, at least the shortest [s]
    elapsed = np.where(1.0e-9 > dt, 1.0e-9, dt)
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    # levels of dry friction [N m]
    upper = c.C + c.C_lN_mu * F_N
    slope = c.B + c.B_lN_mu2 * F_N
    # momentum at the end of the step, if there were no friction [N m s]
    momentum = c.J * omega_m + elapsed * torque
    highest = elapsed * upper
    held_back = np.clip(momentum, -highest, highest)
    # its part that friction at rest does not take up [N m s]
    excess = momentum - held_back + 0.0 * highest
    base = c.J + elapsed * slope
    velocity_after = excess / base
    unlimited = momentum / elapsed
    dry = np.clip(unlimited, -upper, upper)
    result_omega_m = np.where(dt < 1.0e-9, omega_m, velocity_after)
    result_friction = np.where(dt < 1.0e-9, 0.0, dry + slope * velocity_after)
    return result_omega_m, result_friction


@_model.function(needs=("J_m", "J_l"))
def acceleration(c, omega_m, torque):
    """Acceleration by a torque, 0 at rest within the levels of dry friction [rad/s^2]."""
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    # levels of dry friction [N m]
    upper = c.C + c.C_lN_mu * F_N
    slope = c.B + c.B_lN_mu2 * F_N
    held_back = np.clip(torque, -upper, upper)
    starting = torque - held_back + 0.0 * upper
    part_2 = np.where(omega_m > 0.0, torque - upper, np.where(omega_m < 0.0, torque + upper, starting))
    return (-omega_m * slope + part_2) / c.J


@_model.function
def polynomial(c):
    """Coefficients F_3, F_2, F_1, F_0 of F for omega_m > 0, eqs (11)-(14).

    In N m s^3/rad^3, N m s^2/rad^2, N m s/rad, N m; last axis (F_3, F_2, F_1, F_0).
    """
    return c.B_lN_L_M_mu4, c.C_lN_L_M_mu3, c.B_plus_k_e_k_i_per_R, c.C
