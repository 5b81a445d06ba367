# Generated: do not edit. Written by `make derive` from derivations/rotating_link.py
# (eccentric 0.2.0b1, program 09c928c4).
# Rotating link with an unbalanced mass, in a plane tilted by phi, with angular acceleration.
"""Rotating link with an unbalanced mass, in a plane tilted by phi, with angular acceleration.

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
    "regressor",
    "voltage",
]

REGRESSOR = ("B_lN", "C_lN", "B", "C")
GRADIENT = ("theta_m", "omega_m", "alpha_m")
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
    phi: float = runtime.tilt(0.0, "rad")
    """tilt of the motion plane: 0 holds gravity (C2), pi/2 is level (C1) [rad]"""
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
    c.k_i = p.k_i
    c.B_lN = p.B_lN
    c.C_lN = p.C_lN
    g_p = runtime.Pair(p.g) * (abs(math.cos(p.phi)))
    weight = g_p * (runtime.Pair(p.M) + p.M_l)
    critical_squared = runtime.Pair(1.0) if p.L * p.M == 0.0 else weight / (runtime.Pair(p.L) * p.M)
    omega_star = runtime.Pair(1.0) if p.L * p.M == 0.0 else critical_squared.sqrt() / p.mu
    c.scale_N = (
        weight.high / (omega_star.high * omega_star.high) if p.L * p.M == 0.0 else p.L * p.M * p.mu * p.mu
    )
    c.fastest = 0.0 if p.L * p.M == 0.0 else 1073741824.0
    c.half_mu2_omega_star2 = 0.5 * p.mu * p.mu * omega_star.high * omega_star.high
    c.mu_omega_star2 = p.mu * omega_star.high * omega_star.high
    c.per_mu = 1.0 / p.mu
    c.fastest2 = c.fastest * c.fastest
    c.turns_per_rad = 0.5 * p.mu / 3.1415926535897932
    c.period_1 = c.leading(2.0 * 3.1415926535897932 / p.mu)
    period_left = runtime.turn_less(c.period_1, p.mu) / p.mu
    c.period_2 = c.leading(period_left.high)
    period_rest = period_left.high - c.period_2 + period_left.low
    c.period_3 = c.leading(period_rest) if c.single else c.rounded(period_rest)
    c.half_mu = 0.5 * p.mu
    c.omega_star_1 = c.rounded(omega_star.high)
    c.omega_star_2 = c.rounded(omega_star.high - c.omega_star_1 + omega_star.low)
    c.B_lN_mu2_scale_N = p.B_lN * p.mu * p.mu * c.scale_N
    c.B = p.B_lT * F_T * p.mu * p.mu * math.sin(p.phi) + p.B_m
    c.B_plus_k_e_k_i_per_R = c.B + p.k_e * p.k_i / p.R
    c.C_lN_mu_scale_N = p.C_lN * p.mu * c.scale_N
    c.C = p.C_lT * F_T * p.mu * math.sin(p.phi) + p.C_m
    c.quarter_mu3_omega_star2 = 0.25 * p.mu * p.mu * p.mu * omega_star.high * omega_star.high
    c.mu2_omega_star2 = p.mu * p.mu * omega_star.high * omega_star.high
    c.mu2_scale_N = p.mu * p.mu * c.scale_N
    c.mu_scale_N = p.mu * c.scale_N
    c.F_T_mu2_sin_phi = F_T * p.mu * p.mu * math.sin(p.phi)
    c.F_T_mu_sin_phi = F_T * p.mu * math.sin(p.phi)
    c.omega_star2 = omega_star.high * omega_star.high
    c.L_M_g_p_mu2 = p.L * p.M * g_p.high * p.mu * p.mu
    c.J = J_l * p.mu * p.mu + J_m
    c.B_lN_R_mu2_scale_N_per_k_i = p.B_lN * p.R * p.mu * p.mu * c.scale_N / p.k_i
    c.B_R_per_k_i_plus_k_e = c.B * p.R / p.k_i + p.k_e
    c.C_lN_R_mu_scale_N_per_k_i = p.C_lN * p.R * p.mu * c.scale_N / p.k_i
    c.C_R_per_k_i = c.C * p.R / p.k_i
    c.R_per_k_i = p.R / p.k_i
    c.L_M_R_g_p_mu2_per_k_i = p.L * p.M * p.R * g_p.high * p.mu * p.mu / p.k_i
    c.B_lN_mu2_scale_N_per_k_i = p.B_lN * p.mu * p.mu * c.scale_N / p.k_i
    c.B_per_k_i = c.B / p.k_i
    c.per_k_i = 1.0 / p.k_i
    c.C_lN_mu_scale_N_per_k_i = p.C_lN * p.mu * c.scale_N / p.k_i
    c.C_per_k_i = c.C / p.k_i
    c.L_M_g_p_mu2_per_k_i = p.L * p.M * g_p.high * p.mu * p.mu / p.k_i
    c.k_i_per_R = p.k_i / p.R
    c.k_e_k_i_per_R = p.k_e * p.k_i / p.R
    if c.single:
        c.period_4 = c.leading(period_rest - c.period_3)
        period_last = period_rest - c.period_3 - c.period_4
        c.period_5 = c.rounded(period_last)


_INPUTS = {
    "theta_m": "motor angle [rad]",
    "omega_m": "motor velocity [rad/s]",
    "alpha_m": "motor acceleration [rad/s^2]",
    "i": "armature current [A]",
    "u": "armature voltage [V]",
    "torque": "torque on the motor side of everything but friction [N m]",
    "dt": "time step, positive [s]",
}
_model = runtime.Model(Parameters, _prepare, _INPUTS)


def _from_top(c, theta_m):
    """Motor angle from the nearest top of the link [rad]."""
    # whole turns of the link plus a half, up to the nearest top
    turns = theta_m * c.turns_per_rad - 0.5 + c.rounder - c.rounder + 0.5
    # the turns are subtracted in parts of few digits: all products but the last are exact
    rest = theta_m - turns * c.period_1
    left = rest - turns * c.period_2 - turns * c.period_3
    reduced = left - turns * c.period_4 - turns * c.period_5 if c.single else left
    # bounded for angles too large to have any phase; infinity gives NaN
    return np.clip(reduced, -c.period_1, c.period_1)


def _chord(c, from_top):
    """2 sin(half the link angle from the top)/mu."""
    half_angle = from_top * c.half_mu
    return from_top + from_top * runtime.sine_ratio(half_angle, c)


def _half_sine(c, from_top):
    """Cosine of half the link angle from the top."""
    half_angle = from_top * c.half_mu
    return runtime.cosine(half_angle, c)


def _load(c, theta_m, omega_m, alpha_m):
    """Normal force over scale_N [rad^2/s^2], with what it takes; 13 functions call this."""
    size = abs(omega_m)
    # magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s]
    speed = np.minimum(size, c.fastest)
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    half_sine = _half_sine(c, from_top)
    size_2 = alpha_m * c.per_mu
    p = chord * chord * c.half_mu2_omega_star2 + square_difference
    part_1 = np.where(size_2 > c.fastest2, c.fastest2, np.where(size_2 < -c.fastest2, -c.fastest2, size_2))
    q = part_1 + (-c.mu_omega_star2) * chord * half_sine
    # normal force over scale_N [rad^2/s^2]
    load = np.sqrt(p * p + q * q)
    return load, chord, half_sine, speed, p, q


@_model.function
def normal_force(c, theta_m, omega_m, alpha_m):
    """Normal force F_N on the axis of rotation [N]."""
    load = _load(c, theta_m, omega_m, alpha_m)[0]
    return load * c.scale_N


@_model.function
def friction_torque(c, theta_m, omega_m, alpha_m):
    """Resultant friction torque F, back-EMF damping included, eq (6) [N m]."""
    load = _load(c, theta_m, omega_m, alpha_m)[0]
    direction_of_motion = np.sign(omega_m)
    part_2 = omega_m * (c.B_lN_mu2_scale_N * load + c.B_plus_k_e_k_i_per_R)
    return direction_of_motion * (c.C + c.C_lN_mu_scale_N * load) + part_2


@_model.function
def mechanical_friction_torque(c, theta_m, omega_m, alpha_m):
    """Mechanical friction torque f = f_m + mu f_l, without back-EMF [N m]."""
    load = _load(c, theta_m, omega_m, alpha_m)[0]
    direction_of_motion = np.sign(omega_m)
    part_2 = direction_of_motion * (c.C + c.C_lN_mu_scale_N * load)
    return omega_m * (c.B + c.B_lN_mu2_scale_N * load) + part_2


@_model.function
def friction_torque_gradient(c, theta_m, omega_m, alpha_m):
    """Partial derivatives of friction_torque with respect to its inputs.

    In N m per rad, rad/s, rad/s^2; last axis (theta_m, omega_m, alpha_m).
    """
    load, chord, half_sine, speed, p, q = _load(c, theta_m, omega_m, alpha_m)
    direction_of_motion = np.sign(omega_m)
    # 1 at the apex, where F_N is 0 and its derivatives are taken as 0
    inverse = np.where(load == 0.0, 1.0, 1.0 / load)
    part_3 = chord * chord * c.quarter_mu3_omega_star2 * (q * inverse)
    part_4 = -half_sine * half_sine * c.mu_omega_star2 * (q * inverse)
    load_d_theta_m = c.mu2_omega_star2 * (p * inverse) * chord * half_sine + part_3 + part_4
    load_d_omega_m = 2.0 * direction_of_motion * speed * (p * inverse)
    load_d_alpha_m = c.per_mu * (q * inverse)
    part_5 = c.B_lN_mu2_scale_N * omega_m + c.C_lN_mu_scale_N * direction_of_motion
    result_theta_m = load_d_theta_m * part_5
    result_omega_m = c.B_lN_mu2_scale_N * load + c.B_plus_k_e_k_i_per_R + load_d_omega_m * part_5
    result_alpha_m = load_d_alpha_m * part_5
    return result_theta_m, result_omega_m, result_alpha_m


@_model.function
def friction_torque_with_gradient(c, theta_m, omega_m, alpha_m):
    """Friction torque and its partial derivatives, for linearisation.

    In N m, N m per rad, rad/s, rad/s^2; last axis (friction_torque, theta_m, omega_m, alpha_m).
    """
    load, chord, half_sine, speed, p, q = _load(c, theta_m, omega_m, alpha_m)
    direction_of_motion = np.sign(omega_m)
    # 1 at the apex, where F_N is 0 and its derivatives are taken as 0
    inverse = np.where(load == 0.0, 1.0, 1.0 / load)
    part_3 = chord * chord * c.quarter_mu3_omega_star2 * (q * inverse)
    part_4 = -half_sine * half_sine * c.mu_omega_star2 * (q * inverse)
    load_d_theta_m = c.mu2_omega_star2 * (p * inverse) * chord * half_sine + part_3 + part_4
    load_d_omega_m = 2.0 * direction_of_motion * speed * (p * inverse)
    load_d_alpha_m = c.per_mu * (q * inverse)
    part_6 = direction_of_motion * (c.C + c.C_lN_mu_scale_N * load)
    result_friction_torque = omega_m * (c.B_lN_mu2_scale_N * load + c.B_plus_k_e_k_i_per_R) + part_6
    part_7 = c.B_lN_mu2_scale_N * omega_m + c.C_lN_mu_scale_N * direction_of_motion
    result_theta_m = load_d_theta_m * part_7
    result_omega_m = c.B_lN_mu2_scale_N * load + c.B_plus_k_e_k_i_per_R + load_d_omega_m * part_7
    result_alpha_m = load_d_alpha_m * part_7
    return result_friction_torque, result_theta_m, result_omega_m, result_alpha_m


@_model.function
def friction_torque_jacobian(c, theta_m, omega_m, alpha_m):
    """Partial derivatives of friction_torque with respect to all friction coefficients.

    In N m per unit coefficient; last axis (B_lN, C_lN, B_lT, C_lT, B_m, C_m).
    """
    load = _load(c, theta_m, omega_m, alpha_m)[0]
    result_B_lN = load * c.mu2_scale_N * omega_m
    direction_of_motion = np.sign(omega_m)
    result_C_lN = direction_of_motion * load * c.mu_scale_N
    result_B_lT = c.F_T_mu2_sin_phi * omega_m
    result_C_lT = c.F_T_mu_sin_phi * direction_of_motion
    return result_B_lN, result_C_lN, result_B_lT, result_C_lT, omega_m, direction_of_motion


@_model.function
def regressor(c, theta_m, omega_m, alpha_m):
    """Columns: regressor times friction_coefficients is mechanical_friction_torque.

    In N m per unit coefficient; last axis (B_lN, C_lN, B, C).
    """
    load = _load(c, theta_m, omega_m, alpha_m)[0]
    result_B_lN = load * c.mu2_scale_N * omega_m
    direction_of_motion = np.sign(omega_m)
    result_C_lN = direction_of_motion * load * c.mu_scale_N
    return result_B_lN, result_C_lN, omega_m, direction_of_motion


@_model.function
def friction_coefficients(c):
    """Coefficients of the columns of the regressor.

    In m s/rad, m, N m s/rad, N m; last axis (B_lN, C_lN, B, C).
    """
    return c.B_lN, c.C_lN, c.B, c.C


@_model.function
def breakaway_torque(c, theta_m):
    """Levels of dry friction at rest: any torque between them holds the drive.

    In N m; last axis (lower, upper).
    """
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    half_sine = _half_sine(c, from_top)
    p = chord * chord * c.half_mu2_omega_star2 - c.omega_star2
    q = (-c.mu_omega_star2) * chord * half_sine
    magnitude = np.sqrt(p * p + q * q)
    result_lower = -c.C - c.C_lN_mu_scale_N * magnitude
    result_upper = c.C + c.C_lN_mu_scale_N * magnitude
    return result_lower, result_upper


def coulomb_torque(*_, **__):
    """Renamed to `breakaway_torque`."""
    raise AttributeError("coulomb_torque: now breakaway_torque, which returns the lower and the upper level")


@_model.function
def friction_budget(c, theta_m, omega_m, alpha_m):
    """Levels of dry friction at this state, and the viscous coefficient.

    In N m, N m, N m s/rad; last axis (lower, upper, viscous).
    """
    load = _load(c, theta_m, omega_m, alpha_m)[0]
    result_lower = -c.C - c.C_lN_mu_scale_N * load
    result_upper = c.C + c.C_lN_mu_scale_N * load
    result_viscous = c.B + c.B_lN_mu2_scale_N * load
    return result_lower, result_upper, result_viscous


@_model.function
def gravity_torque(c, theta_m):
    """Gravity torque G, eq (5) [N m]."""
    from_top = _from_top(c, theta_m)
    chord = _chord(c, from_top)
    half_sine = _half_sine(c, from_top)
    return (-c.L_M_g_p_mu2) * chord * half_sine


@_model.function(needs=("J_m", "J_l"))
def voltage(c, theta_m, omega_m, alpha_m=0.0):
    """Armature voltage u = (R/k_i) (J alpha_m + G + F), eq (4) [V]."""
    load, chord, half_sine, _, _, _ = _load(c, theta_m, omega_m, alpha_m)
    direction_of_motion = np.sign(omega_m)
    part_2 = direction_of_motion * (c.C_R_per_k_i + c.C_lN_R_mu_scale_N_per_k_i * load)
    part_4 = omega_m * (c.B_R_per_k_i_plus_k_e + c.B_lN_R_mu2_scale_N_per_k_i * load)
    part_6 = c.R_per_k_i * np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    return part_2 + part_4 + (-c.L_M_R_g_p_mu2_per_k_i) * chord * half_sine + part_6


@_model.function(needs=("J_m", "J_l"))
def current(c, theta_m, omega_m, alpha_m=0.0):
    """Armature current i = (J alpha_m + G + f)/k_i [A]."""
    load, chord, half_sine, _, _, _ = _load(c, theta_m, omega_m, alpha_m)
    direction_of_motion = np.sign(omega_m)
    part_2 = direction_of_motion * (c.C_lN_mu_scale_N_per_k_i * load + c.C_per_k_i)
    part_4 = omega_m * (c.B_lN_mu2_scale_N_per_k_i * load + c.B_per_k_i)
    part_5 = c.per_k_i * np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    return part_2 + (-c.L_M_g_p_mu2_per_k_i) * chord * half_sine + part_4 + part_5


@_model.function(needs=("J_m", "J_l"))
def mechanical_residual(c, theta_m, omega_m, i, alpha_m=0.0):
    """Residual of the mechanical balance: k_i i - J alpha_m - G - f [N m]."""
    load, chord, half_sine, _, _, _ = _load(c, theta_m, omega_m, alpha_m)
    direction_of_motion = np.sign(omega_m)
    part_2 = -direction_of_motion * (c.C + c.C_lN_mu_scale_N * load)
    part_4 = -np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    part_5 = -omega_m * (c.B + c.B_lN_mu2_scale_N * load)
    return i * c.k_i + part_2 + c.L_M_g_p_mu2 * chord * half_sine + part_4 + part_5


@_model.function
def electrical_residual(c, omega_m, i, u):
    """Residual of the electrical balance, as a torque: (k_i/R)(u - k_e omega_m) - k_i i [N m]."""
    return -i * c.k_i - c.k_e_k_i_per_R * omega_m + c.k_i_per_R * u


@_model.function(needs=("J_m", "J_l"))
def friction_step(c, theta_m, omega_m, alpha_m, torque, dt):
    """Velocity after a time step and the friction torque in it, unchanged if dt is less than 1e-9 s.

    In rad/s, N m; last axis (omega_m, friction).
    """
    # time step, at least the shortest [s]
    elapsed = np.where(1.0e-9 > dt, 1.0e-9, dt)
    load = _load(c, theta_m, omega_m, alpha_m)[0]
    # levels of dry friction [N m]
    upper = c.C + c.C_lN_mu_scale_N * load
    slope = c.B + c.B_lN_mu2_scale_N * load
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
def acceleration(c, theta_m, omega_m, alpha_m, torque):
    """Acceleration by a torque, 0 at rest within the levels of dry friction [rad/s^2]."""
    load = _load(c, theta_m, omega_m, alpha_m)[0]
    # levels of dry friction [N m]
    upper = c.C + c.C_lN_mu_scale_N * load
    slope = c.B + c.B_lN_mu2_scale_N * load
    held_back = np.clip(torque, -upper, upper)
    starting = torque - held_back + 0.0 * upper
    part_3 = np.where(omega_m > 0.0, torque - upper, np.where(omega_m < 0.0, torque + upper, starting))
    return (-omega_m * slope + part_3) / c.J
