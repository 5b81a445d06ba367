# Generated: do not edit. Written by `make derive` from derivations/c1_asymmetric.py
# (eccentric 0.2.0b1, program 2d39efa4).
# Case C1 with friction that differs between the directions of motion.
"""Case C1 with friction that differs between the directions of motion.

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
    "polynomial_neg",
    "regressor",
    "voltage",
]

REGRESSOR = ("B_lN_pos", "B_lN_neg", "C_lN_pos", "C_lN_neg", "B_pos", "B_neg", "C_pos", "C_neg")
GRADIENT = ("omega_m",)
JACOBIAN = (
    "B_lN_pos",
    "B_lN_neg",
    "C_lN_pos",
    "C_lN_neg",
    "B_lT_pos",
    "B_lT_neg",
    "C_lT_pos",
    "C_lT_neg",
    "B_m_pos",
    "B_m_neg",
    "C_m_pos",
    "C_m_neg",
)


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
    B_lN_pos: float = runtime.nonnegative(0.004, "m s/rad")
    """viscous friction of the link per normal force, omega_m > 0 [m s/rad], eq. (9)"""
    B_lN_neg: float = runtime.nonnegative(0.004, "m s/rad")
    """viscous friction of the link per normal force, omega_m < 0 [m s/rad], eq. (9)"""
    C_lN_pos: float = runtime.nonnegative(0.08, "m")
    """Coulomb friction of the link per normal force, omega_m > 0 [m], eq. (9)"""
    C_lN_neg: float = runtime.nonnegative(0.08, "m")
    """Coulomb friction of the link per normal force, omega_m < 0 [m], eq. (9)"""
    B_lT_pos: float = runtime.nonnegative(0.004, "m s/rad")
    """viscous friction of the link per transversal force, omega_m > 0 [m s/rad], eq. (9)"""
    B_lT_neg: float = runtime.nonnegative(0.004, "m s/rad")
    """viscous friction of the link per transversal force, omega_m < 0 [m s/rad], eq. (9)"""
    C_lT_pos: float = runtime.nonnegative(0.08, "m")
    """Coulomb friction of the link per transversal force, omega_m > 0 [m], eq. (9)"""
    C_lT_neg: float = runtime.nonnegative(0.08, "m")
    """Coulomb friction of the link per transversal force, omega_m < 0 [m], eq. (9)"""
    B_m_pos: float = runtime.nonnegative(0.0004, "N m s/rad")
    """viscous friction of the motor, omega_m > 0 [N m s/rad], eq. (10)"""
    B_m_neg: float = runtime.nonnegative(0.0004, "N m s/rad")
    """viscous friction of the motor, omega_m < 0 [N m s/rad], eq. (10)"""
    C_m_pos: float = runtime.nonnegative(0.008, "N m")
    """Coulomb friction of the motor, omega_m > 0 [N m], eq. (10)"""
    C_m_neg: float = runtime.nonnegative(0.008, "N m")
    """Coulomb friction of the motor, omega_m < 0 [N m], eq. (10)"""
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
    c.k_e = p.k_e
    c.B_lN_pos = p.B_lN_pos
    c.B_lN_neg = p.B_lN_neg
    c.C_lN_pos = p.C_lN_pos
    c.C_lN_neg = p.C_lN_neg
    c.L_M_mu2 = p.L * p.M * p.mu * p.mu
    c.B_lN_pos_mu2 = p.B_lN_pos * p.mu * p.mu
    c.B_lN_neg_mu2 = p.B_lN_neg * p.mu * p.mu
    c.B_pos = p.B_lT_pos * F_T * p.mu * p.mu + p.B_m_pos
    c.B_neg = p.B_lT_neg * F_T * p.mu * p.mu + p.B_m_neg
    c.k_e_k_i_per_R = p.k_e * p.k_i / p.R
    c.C_lN_pos_mu = p.C_lN_pos * p.mu
    c.C_lN_neg_mu = p.C_lN_neg * p.mu
    c.C_pos = p.C_lT_pos * F_T * p.mu + p.C_m_pos
    c.C_neg = p.C_lT_neg * F_T * p.mu + p.C_m_neg
    c.twice_L_M_mu2 = 2.0 * p.L * p.M * p.mu * p.mu
    c.mu2 = p.mu * p.mu
    c.F_T_mu2 = F_T * p.mu * p.mu
    c.F_T_mu = F_T * p.mu
    c.J = J_l * p.mu * p.mu + J_m
    c.B_lN_pos_R_mu2_per_k_i = p.B_lN_pos * p.R * p.mu * p.mu / p.k_i
    c.B_lN_neg_R_mu2_per_k_i = p.B_lN_neg * p.R * p.mu * p.mu / p.k_i
    c.B_pos_R_per_k_i = c.B_pos * p.R / p.k_i
    c.B_neg_R_per_k_i = c.B_neg * p.R / p.k_i
    c.C_lN_pos_R_mu_per_k_i = p.C_lN_pos * p.R * p.mu / p.k_i
    c.C_lN_neg_R_mu_per_k_i = p.C_lN_neg * p.R * p.mu / p.k_i
    c.C_pos_R_per_k_i = c.C_pos * p.R / p.k_i
    c.C_neg_R_per_k_i = c.C_neg * p.R / p.k_i
    c.R_per_k_i = p.R / p.k_i
    c.B_lN_pos_mu2_per_k_i = p.B_lN_pos * p.mu * p.mu / p.k_i
    c.B_lN_neg_mu2_per_k_i = p.B_lN_neg * p.mu * p.mu / p.k_i
    c.B_pos_per_k_i = c.B_pos / p.k_i
    c.B_neg_per_k_i = c.B_neg / p.k_i
    c.per_k_i = 1.0 / p.k_i
    c.C_lN_pos_mu_per_k_i = p.C_lN_pos * p.mu / p.k_i
    c.C_lN_neg_mu_per_k_i = p.C_lN_neg * p.mu / p.k_i
    c.C_pos_per_k_i = c.C_pos / p.k_i
    c.C_neg_per_k_i = c.C_neg / p.k_i
    c.k_i_per_R = p.k_i / p.R
    c.B_lN_pos_L_M_mu4 = p.B_lN_pos * p.L * p.M * p.mu * p.mu * p.mu * p.mu
    c.C_lN_pos_L_M_mu3 = p.C_lN_pos * p.L * p.M * p.mu * p.mu * p.mu
    c.B_pos_plus_k_e_k_i_per_R = c.B_pos + p.k_e * p.k_i / p.R
    c.B_lN_neg_L_M_mu4 = p.B_lN_neg * p.L * p.M * p.mu * p.mu * p.mu * p.mu
    c.C_lN_neg_L_M_mu3 = p.C_lN_neg * p.L * p.M * p.mu * p.mu * p.mu
    c.B_neg_plus_k_e_k_i_per_R = c.B_neg + p.k_e * p.k_i / p.R


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
    part_3 = F_N * np.where(omega_m > 0.0, c.B_lN_pos_mu2, c.B_lN_neg_mu2)
    part_6 = F_N * np.where(omega_m > 0.0, c.C_lN_pos_mu, c.C_lN_neg_mu)
    part_4 = direction_of_motion * (part_6 + np.where(omega_m > 0.0, c.C_pos, c.C_neg))
    return omega_m * (c.k_e_k_i_per_R + part_3 + np.where(omega_m > 0.0, c.B_pos, c.B_neg)) + part_4


@_model.function
def mechanical_friction_torque(c, omega_m):
    """Mechanical friction torque f = f_m + mu f_l, without back-EMF [N m]."""
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = np.sign(omega_m)
    part_3 = F_N * np.where(omega_m > 0.0, c.C_lN_pos_mu, c.C_lN_neg_mu)
    part_6 = F_N * np.where(omega_m > 0.0, c.B_lN_pos_mu2, c.B_lN_neg_mu2)
    part_4 = omega_m * (part_6 + np.where(omega_m > 0.0, c.B_pos, c.B_neg))
    return direction_of_motion * (part_3 + np.where(omega_m > 0.0, c.C_pos, c.C_neg)) + part_4


@_model.function
def friction_torque_gradient(c, omega_m):
    """Partial derivatives of friction_torque with respect to its inputs.

    In N m per rad/s; last axis (omega_m).
    """
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    F_N_d_omega_m = omega_m * c.twice_L_M_mu2
    direction_of_motion = np.sign(omega_m)
    part_5 = omega_m * np.where(omega_m > 0.0, c.B_lN_pos_mu2, c.B_lN_neg_mu2)
    part_2 = direction_of_motion * np.where(omega_m > 0.0, c.C_lN_pos_mu, c.C_lN_neg_mu) + part_5
    part_6 = F_N * np.where(omega_m > 0.0, c.B_lN_pos_mu2, c.B_lN_neg_mu2)
    part_7 = np.where(omega_m > 0.0, c.B_pos, c.B_neg)
    result_omega_m = c.k_e_k_i_per_R + F_N_d_omega_m * part_2 + part_6 + part_7
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
    part_3 = F_N * np.where(omega_m > 0.0, c.B_lN_pos_mu2, c.B_lN_neg_mu2)
    part_1 = omega_m * (c.k_e_k_i_per_R + part_3 + np.where(omega_m > 0.0, c.B_pos, c.B_neg))
    part_6 = F_N * np.where(omega_m > 0.0, c.C_lN_pos_mu, c.C_lN_neg_mu)
    part_4 = direction_of_motion * (part_6 + np.where(omega_m > 0.0, c.C_pos, c.C_neg))
    result_friction_torque = part_1 + part_4
    part_11 = omega_m * np.where(omega_m > 0.0, c.B_lN_pos_mu2, c.B_lN_neg_mu2)
    part_8 = part_11 + direction_of_motion * np.where(omega_m > 0.0, c.C_lN_pos_mu, c.C_lN_neg_mu)
    part_13 = np.where(omega_m > 0.0, c.B_pos, c.B_neg)
    result_omega_m = c.k_e_k_i_per_R + part_13 + part_3 + F_N_d_omega_m * part_8
    return result_friction_torque, result_omega_m


@_model.function
def friction_torque_jacobian(c, omega_m):
    """Partial derivatives of friction_torque with respect to all friction coefficients.

    In N m per unit coefficient; last axis (B_lN_pos, B_lN_neg, C_lN_pos, C_lN_neg, B_lT_pos, B_lT_neg,
    C_lT_pos, C_lT_neg, B_m_pos, B_m_neg, C_m_pos, C_m_neg).
    """
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    is_forward = np.heaviside(omega_m, 0.0)
    ungated = F_N * c.mu2 * omega_m
    result_B_lN_pos = np.where(is_forward == 0.0, np.sign(ungated), ungated) * is_forward
    is_backward = np.heaviside(-(omega_m), 0.0)
    result_B_lN_neg = np.where(is_backward == 0.0, np.sign(ungated), ungated) * is_backward
    direction_of_motion = np.sign(omega_m)
    ungated_2 = F_N * direction_of_motion * c.mu
    result_C_lN_pos = np.where(is_forward == 0.0, np.sign(ungated_2), ungated_2) * is_forward
    result_C_lN_neg = np.where(is_backward == 0.0, np.sign(ungated_2), ungated_2) * is_backward
    ungated_3 = c.F_T_mu2 * omega_m
    result_B_lT_pos = np.where(is_forward == 0.0, np.sign(ungated_3), ungated_3) * is_forward
    result_B_lT_neg = np.where(is_backward == 0.0, np.sign(ungated_3), ungated_3) * is_backward
    ungated_4 = c.F_T_mu * direction_of_motion
    result_C_lT_pos = np.where(is_forward == 0.0, np.sign(ungated_4), ungated_4) * is_forward
    result_C_lT_neg = np.where(is_backward == 0.0, np.sign(ungated_4), ungated_4) * is_backward
    result_B_m_pos = np.where(is_forward == 0.0, np.sign(omega_m), omega_m) * is_forward
    result_B_m_neg = np.where(is_backward == 0.0, np.sign(omega_m), omega_m) * is_backward
    result_C_m_pos = direction_of_motion * is_forward
    result_C_m_neg = direction_of_motion * is_backward
    return (
        result_B_lN_pos,
        result_B_lN_neg,
        result_C_lN_pos,
        result_C_lN_neg,
        result_B_lT_pos,
        result_B_lT_neg,
        result_C_lT_pos,
        result_C_lT_neg,
        result_B_m_pos,
        result_B_m_neg,
        result_C_m_pos,
        result_C_m_neg,
    )


@_model.function
def regressor(c, omega_m):
    """Columns: regressor times friction_coefficients is mechanical_friction_torque.

    In N m per unit coefficient; last axis (B_lN_pos, B_lN_neg, C_lN_pos, C_lN_neg, B_pos, B_neg, C_pos,
    C_neg).
    """
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    is_forward = np.heaviside(omega_m, 0.0)
    ungated = F_N * c.mu2 * omega_m
    result_B_lN_pos = np.where(is_forward == 0.0, np.sign(ungated), ungated) * is_forward
    is_backward = np.heaviside(-(omega_m), 0.0)
    result_B_lN_neg = np.where(is_backward == 0.0, np.sign(ungated), ungated) * is_backward
    direction_of_motion = np.sign(omega_m)
    ungated_2 = F_N * direction_of_motion * c.mu
    result_C_lN_pos = np.where(is_forward == 0.0, np.sign(ungated_2), ungated_2) * is_forward
    result_C_lN_neg = np.where(is_backward == 0.0, np.sign(ungated_2), ungated_2) * is_backward
    result_B_pos = np.where(is_forward == 0.0, np.sign(omega_m), omega_m) * is_forward
    result_B_neg = np.where(is_backward == 0.0, np.sign(omega_m), omega_m) * is_backward
    result_C_pos = direction_of_motion * is_forward
    result_C_neg = direction_of_motion * is_backward
    return (
        result_B_lN_pos,
        result_B_lN_neg,
        result_C_lN_pos,
        result_C_lN_neg,
        result_B_pos,
        result_B_neg,
        result_C_pos,
        result_C_neg,
    )


@_model.function
def friction_coefficients(c):
    """Coefficients of the columns of the regressor.

    In m s/rad, m s/rad, m, m, N m s/rad, N m s/rad, N m, N m; last axis (B_lN_pos, B_lN_neg, C_lN_pos,
    C_lN_neg, B_pos, B_neg, C_pos, C_neg).
    """
    return c.B_lN_pos, c.B_lN_neg, c.C_lN_pos, c.C_lN_neg, c.B_pos, c.B_neg, c.C_pos, c.C_neg


@_model.function
def breakaway_torque(c):
    """Levels of dry friction at rest: any torque between them holds the drive.

    In N m; last axis (lower, upper).
    """
    result_lower = -c.C_neg
    return result_lower, c.C_pos


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
    result_lower = -c.C_lN_neg_mu * F_N - c.C_neg
    result_upper = c.C_lN_pos_mu * F_N + c.C_pos
    part_2 = c.B_lN_neg_mu2 * F_N + c.B_neg
    result_viscous = np.where(omega_m > 0.0, c.B_lN_pos_mu2 * F_N + c.B_pos, part_2)
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
    part_3 = F_N * np.where(omega_m > 0.0, c.C_lN_pos_R_mu_per_k_i, c.C_lN_neg_R_mu_per_k_i)
    part_2 = part_3 + np.where(omega_m > 0.0, c.C_pos_R_per_k_i, c.C_neg_R_per_k_i)
    part_7 = F_N * np.where(omega_m > 0.0, c.B_lN_pos_R_mu2_per_k_i, c.B_lN_neg_R_mu2_per_k_i)
    part_5 = omega_m * (c.k_e + part_7 + np.where(omega_m > 0.0, c.B_pos_R_per_k_i, c.B_neg_R_per_k_i))
    part_10 = c.R_per_k_i * np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    return direction_of_motion * part_2 + part_10 + part_5


@_model.function(needs=("J_m", "J_l"))
def current(c, omega_m, alpha_m=0.0):
    """Armature current i = (J alpha_m + G + f)/k_i [A]."""
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = np.sign(omega_m)
    part_3 = F_N * np.where(omega_m > 0.0, c.C_lN_pos_mu_per_k_i, c.C_lN_neg_mu_per_k_i)
    part_1 = direction_of_motion * (part_3 + np.where(omega_m > 0.0, c.C_pos_per_k_i, c.C_neg_per_k_i))
    part_7 = F_N * np.where(omega_m > 0.0, c.B_lN_pos_mu2_per_k_i, c.B_lN_neg_mu2_per_k_i)
    part_5 = omega_m * (part_7 + np.where(omega_m > 0.0, c.B_pos_per_k_i, c.B_neg_per_k_i))
    return part_1 + part_5 + c.per_k_i * np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)


@_model.function(needs=("J_m", "J_l"))
def mechanical_residual(c, omega_m, i, alpha_m=0.0):
    """Residual of the mechanical balance: k_i i - J alpha_m - G - f [N m]."""
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    direction_of_motion = np.sign(omega_m)
    part_3 = -F_N * np.where(omega_m > 0.0, c.C_lN_pos_mu, c.C_lN_neg_mu)
    part_1 = direction_of_motion * (part_3 - np.where(omega_m > 0.0, c.C_pos, c.C_neg))
    part_6 = -F_N * np.where(omega_m > 0.0, c.B_lN_pos_mu2, c.B_lN_neg_mu2)
    part_7 = -np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    return i * c.k_i + part_1 + omega_m * (part_6 - np.where(omega_m > 0.0, c.B_pos, c.B_neg)) + part_7


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
    upper = c.C_lN_pos_mu * F_N + c.C_pos
    slope_forward = c.B_lN_pos_mu2 * F_N + c.B_pos
    lower = -c.C_lN_neg_mu * F_N - c.C_neg
    slope_backward = c.B_lN_neg_mu2 * F_N + c.B_neg
    # momentum at the end of the step, if there were no friction [N m s]
    momentum = c.J * omega_m + elapsed * torque
    highest = elapsed * upper
    lowest = elapsed * lower
    held_back = np.where(momentum > highest, highest, np.where(momentum < lowest, lowest, momentum))
    # its part that friction at rest does not take up [N m s]
    excess = momentum - held_back + 0.0 * (highest - lowest)
    damped = np.where(excess > 0.0, slope_forward, slope_backward)
    base = c.J + damped * elapsed
    velocity_after = excess / base
    unlimited = momentum / elapsed
    dry = np.where(unlimited > upper, upper, np.where(unlimited < lower, lower, unlimited))
    result_omega_m = np.where(dt < 1.0e-9, omega_m, velocity_after)
    result_friction = np.where(dt < 1.0e-9, 0.0, damped * velocity_after + dry)
    return result_omega_m, result_friction


@_model.function(needs=("J_m", "J_l"))
def acceleration(c, omega_m, torque):
    """Acceleration by a torque, 0 at rest within the levels of dry friction [rad/s^2]."""
    # normal force on the axis of rotation [N], eq (8)
    F_N = c.L_M_mu2 * omega_m * omega_m
    # levels of dry friction [N m]
    upper = c.C_lN_pos_mu * F_N + c.C_pos
    slope_forward = c.B_lN_pos_mu2 * F_N + c.B_pos
    lower = -c.C_lN_neg_mu * F_N - c.C_neg
    slope_backward = c.B_lN_neg_mu2 * F_N + c.B_neg
    held_back = np.where(torque > upper, upper, np.where(torque < lower, lower, torque))
    starting = torque - held_back + 0.0 * (upper - lower)
    part_2 = np.where(omega_m > 0.0, torque - upper, np.where(omega_m < 0.0, -lower + torque, starting))
    return (part_2 + (-omega_m * np.where(omega_m > 0.0, slope_forward, slope_backward))) / c.J


@_model.function
def polynomial(c):
    """Coefficients F_3, F_2, F_1, F_0 of F for omega_m > 0, eqs (11)-(14).

    In N m s^3/rad^3, N m s^2/rad^2, N m s/rad, N m; last axis (F_3, F_2, F_1, F_0).
    """
    return c.B_lN_pos_L_M_mu4, c.C_lN_pos_L_M_mu3, c.B_pos_plus_k_e_k_i_per_R, c.C_pos


@_model.function
def polynomial_neg(c):
    """Coefficients F_3, F_2, F_1, F_0 of F for omega_m < 0, eqs (11)-(14).

    In N m s^3/rad^3, N m s^2/rad^2, N m s/rad, N m; last axis (F_3, F_2, F_1, F_0).
    """
    result_F_2 = -c.C_lN_neg_L_M_mu3
    result_F_0 = -c.C_neg
    return c.B_lN_neg_L_M_mu4, result_F_2, c.B_neg_plus_k_e_k_i_per_R, result_F_0
