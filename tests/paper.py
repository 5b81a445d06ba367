"""The closed forms of Dutkiewicz, Herman and Michałek, transcribed from the paper and shared with nothing.

Every function takes the paper's variables, then `p`, anything with the paper's letters as attributes, and
where it needs functions `m`, the namespace to take `sqrt`, `sin`, `cos` and `sign` from: `mpmath`, `sympy` or
`numpy`. Letters: `w` is a velocity [rad/s], `theta` an angle [rad], `alpha` an angular acceleration
[rad/s^2]; the suffix `_m` is the motor's side, `_l` the link's. Forces in N, torques in N m, motor side.
"""

from collections.abc import Callable
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import mpmath

Number = Any  # of mpmath, SymPy, NumPy or Python
Functions = Any  # a namespace with sqrt, sin, cos and sign
Parameters = Any  # anything with the paper's letters as attributes

# Table 1 as printed. B_lN = B_lT, C_lN = C_lT. Its k_e is listed in V s/rev and used, in F_1, in V s/rad.
TABLE_1 = {
    "M": "0.50", "M_l": "0.20", "L": "0.25", "R": "1.00", "k_i": "0.02", "k_e": "0.20", "g": "9.81",
    "C_m": "0.0080", "B_m": "0.0004", "C_lN": "0.0800", "C_lT": "0.0800", "B_lN": "0.0040", "B_lT": "0.0040",
}  # fmt: skip

# The lower half of Table 1 as printed, for w > 0: F_3, F_2, F_1, F_0 of (12)-(13).
TABLE_1_POLYNOMIAL = {
    "1/5": ("8.0000e-7", "8.0000e-5", "4.7139e-3", "3.9392e-2"),
    "1/30": ("6.1728e-10", "3.7037e-7", "4.4087e-3", "1.3232e-2"),
}


def table_1(
    number: Callable[[Fraction], Number] = Fraction, mu: str | float = "1/5", **changes: Number
) -> Parameters:
    """Return Table 1's parameters, exact unless `number` rounds them; F_T = M_l g is the reading of (13)."""
    p = {name: Fraction(text) for name, text in TABLE_1.items()} | {"mu": Fraction(mu)}
    p["F_T"] = p["M_l"] * p["g"]
    return SimpleNamespace(**{name: number(value) for name, value in p.items()} | changes)


def gravity_torque(theta_m: Functions, p: Parameters, m: Functions = mpmath) -> Number:
    """Eq. (5): the gravitational torque, g being the gravity in the plane of motion."""
    return p.mu * p.M * p.g * p.L * m.sin(p.mu * theta_m)


def back_emf_damping(p: Parameters) -> Number:
    """Eq. (6), its last term: the damping k_i k_e / R [N m s/rad] that the armature adds."""
    return p.k_i * p.k_e / p.R


def resultant_friction(f_m: Functions, f_l: Number, w_m: Functions, p: Parameters) -> Number:
    """Eq. (6): the resultant friction torque F, back-EMF damping included."""
    return f_m + p.mu * f_l + back_emf_damping(p) * w_m


def normal_force_c1(w_m: Functions, p: Parameters) -> Number:
    """Eq. (8): the centrifugal force of the unbalanced mass."""
    return p.M * p.L * p.mu**2 * w_m**2


def link_friction_c1(w_m: Functions, p: Parameters, m: Functions = mpmath) -> Number:
    """Eq. (9): friction in the link joint, case C1, with beta_T = B_lT F_T and gamma_T = C_lT F_T."""
    beta_T, gamma_T = p.B_lT * p.F_T, p.C_lT * p.F_T
    return (
        p.B_lN * p.M * p.L * p.mu**3 * w_m**3
        + p.C_lN * p.M * p.L * p.mu**2 * w_m**2 * m.sign(w_m)
        + beta_T * p.mu * w_m
        + gamma_T * m.sign(w_m)
    )


def motor_friction(w_m: Functions, p: Parameters, m: Functions = mpmath) -> Number:
    """Eq. (10): friction in the motor bearing."""
    return p.B_m * w_m + p.C_m * m.sign(w_m)


def polynomial_c1(sign: Number, p: Parameters) -> tuple[Number, Number, Number, Number]:
    """Eqs (12)-(13): F_3, F_2, F_1, F_0, where `sign` is sgn of the motor velocity."""
    F_3 = p.mu**4 * p.B_lN * p.M * p.L
    F_2 = p.mu**3 * p.C_lN * p.M * p.L * sign
    F_1 = p.mu**2 * p.B_lT * p.F_T + p.B_m + p.k_i * p.k_e / p.R
    F_0 = (p.mu * p.C_lT * p.F_T + p.C_m) * sign
    return F_3, F_2, F_1, F_0


def friction_torque_c1(w_m: Functions, p: Parameters, m: Functions = mpmath) -> Number:
    """Eq. (11): the resultant friction torque of case C1."""
    F_3, F_2, F_1, F_0 = polynomial_c1(m.sign(w_m), p)
    return F_3 * w_m**3 + F_2 * w_m**2 + F_1 * w_m + F_0


def one_direction(p: Parameters, direction: str) -> Parameters:
    """Return the coefficients of one direction, `pos` or `neg`, under their names of the symmetric case."""
    ending = "_" + direction
    chosen = {name.removesuffix(ending): value for name, value in vars(p).items() if name.endswith(ending)}
    return SimpleNamespace(**vars(p) | chosen)


def polynomial_c1_asymmetric(direction: str, p: Parameters) -> tuple[Number, Number, Number, Number]:
    """Eq. (14): F_3, F_2, F_1, F_0 for one direction of motion, `pos` or `neg`.

    The paper prints F_0^- = -mu gamma^- + C_m^-; (13), (21) and the symmetric limit require the bracket here.
    """
    q = one_direction(p, direction)
    sign = 1 if direction == "pos" else -1
    F_3 = q.mu**4 * q.B_lN * q.M * q.L
    F_2 = sign * q.mu**3 * q.C_lN * q.M * q.L
    F_1 = q.mu**2 * q.B_lT * q.F_T + q.B_m + q.k_i * q.k_e / q.R
    F_0 = sign * (q.mu * q.C_lT * q.F_T + q.C_m)
    return F_3, F_2, F_1, F_0


def friction_torque_c1_asymmetric(w_m: Functions, p: Parameters) -> Number:
    """Eq. (14): the resultant friction torque of case C1 with unsymmetrical friction; zero at standstill."""
    if w_m == 0:
        return 0 * w_m
    F_3, F_2, F_1, F_0 = polynomial_c1_asymmetric("pos" if w_m > 0 else "neg", p)
    return F_3 * w_m**3 + F_2 * w_m**2 + F_1 * w_m + F_0


def normal_force_c2_link(theta_l: Number, w_l: Number, p: Parameters, m: Functions = mpmath) -> Number:
    """Eq. (16): the normal force of case C2 in the link's variables."""
    ML, weight = p.M * p.L, (p.M + p.M_l) * p.g
    return m.sqrt(ML**2 * w_l**4 + 2 * weight * ML * w_l**2 * m.cos(theta_l) + weight**2)


def normal_force_c2(theta_m: Functions, w_m: Functions, p: Parameters, m: Functions = mpmath) -> Number:
    """Eq. (17): the normal force of case C2 in the motor's variables."""
    return m.sqrt(
        (p.M * p.L) ** 2 * p.mu**4 * w_m**4
        + 2 * p.g * (p.M + p.M_l) * p.M * p.L * p.mu**2 * w_m**2 * m.cos(p.mu * theta_m)
        + (p.M + p.M_l) ** 2 * p.g**2
    )


def friction_torque_c2(theta_m: Functions, w_m: Functions, p: Parameters, m: Functions = mpmath) -> Number:
    """Eqs (18)-(20): the resultant friction torque of case C2."""
    F_N = normal_force_c2(theta_m, w_m, p, m)
    F_1 = p.mu**2 * p.B_lN * F_N + p.B_m + p.k_i * p.k_e / p.R
    F_0 = (p.mu * p.C_lN * F_N + p.C_m) * m.sign(w_m)
    return F_1 * w_m + F_0


def friction_torque_c2_asymmetric(
    theta_m: Functions, w_m: Functions, p: Parameters, m: Functions = mpmath
) -> Number:
    """Eq. (21): the resultant friction torque of case C2 with unsymmetrical friction; zero at standstill."""
    F_N = normal_force_c2(theta_m, w_m, p, m)
    damping = p.k_i * p.k_e / p.R
    if w_m > 0:
        return (p.mu**2 * p.B_lN_pos * F_N + p.B_m_pos + damping) * w_m + (
            p.mu * p.C_lN_pos * F_N + p.C_m_pos
        )
    if w_m < 0:
        return (p.mu**2 * p.B_lN_neg * F_N + p.B_m_neg + damping) * w_m - p.mu * p.C_lN_neg * F_N - p.C_m_neg
    return 0 * w_m


def normal_force_minimum(w_l: Number, p: Parameters) -> Number:
    """Eq. (22): the smallest normal force at one speed, taken at theta_l = pi."""
    return abs((p.M + p.M_l) * p.g - p.M * p.L * w_l**2)


def normal_force_maximum(w_l: Number, p: Parameters) -> Number:
    """Eq. (23): the largest normal force at one speed, taken at theta_l = 0."""
    return abs((p.M + p.M_l) * p.g + p.M * p.L * w_l**2)


def critical_velocity(p: Parameters, m: Functions = mpmath) -> Number:
    """Unnumbered, below (23): the link velocity [rad/s] at which F_N vanishes at the top."""
    return m.sqrt(p.g * (p.M_l + p.M) / (p.M * p.L))


def polynomial_c2(s: Number, sign: Number, p: Parameters) -> tuple[Number, Number, Number, Number]:
    """Eqs (24) and (25): F_3, F_2, F_1, F_0 at the bottom and the top; `sign` is sgn of the motor velocity.

    At the top `s` is that of (25). The bottom, (24), has the signs +, +, +, +, which `s = None` selects.
    """
    ML, weight = p.M * p.L, (p.M + p.M_l) * p.g
    inertial, gravity = (1, 1) if s is None else (-s, s)
    F_3 = inertial * p.mu**4 * p.B_lN * ML
    F_2 = inertial * p.mu**3 * p.C_lN * ML * sign
    F_1 = gravity * p.mu**2 * p.B_lN * weight + p.B_m + p.k_i * p.k_e / p.R
    F_0 = (gravity * p.mu * p.C_lN * weight + p.C_m) * sign
    return F_3, F_2, F_1, F_0


def top_switch(w_m: Functions, p: Parameters) -> int:
    """Eq. (25), s: +1 below the critical velocity and -1 above it."""
    return 1 if p.M * p.L * (p.mu * w_m) ** 2 < (p.M + p.M_l) * p.g else -1


def voltage(alpha_m: Functions, gravity: Number, F: Number, p: Parameters) -> Number:
    """Eq. (4) solved for u [V], given the gravity torque and the resultant friction torque."""
    return (p.R / p.k_i) * ((p.J_m + p.mu**2 * p.J_l) * alpha_m + gravity + F)


def current(alpha_m: Functions, gravity: Number, f: Number, p: Parameters) -> Number:
    """Eqs (1)-(3) solved for i [A], given the gravity torque and the mechanical friction f = f_m + mu f_l."""
    return ((p.J_m + p.mu**2 * p.J_l) * alpha_m + gravity + f) / p.k_i


def steady_state_voltage_c1(w_m: Functions, p: Parameters, m: Functions = mpmath) -> Number:
    """Eqs (4) and (11) at constant velocity: the curve of figure 2, u [V] over the motor velocity."""
    return (p.R / p.k_i) * friction_torque_c1(w_m, p, m)


# Not in the paper, which keeps to constant velocity and to two planes: both as the design states them.


def normal_force_rotating_link(
    theta_m: Functions, w_m: Functions, alpha_m: Functions, p: Parameters, m: Functions = mpmath
) -> Number:
    """Not in the paper: the normal force in a plane tilted by phi, with angular acceleration."""
    ML, weight = p.M * p.L, (p.M + p.M_l) * p.g * m.cos(p.phi)
    theta, w, alpha = p.mu * theta_m, p.mu * w_m, p.mu * alpha_m
    pull = w**2 * m.cos(theta) + alpha * m.sin(theta)
    return m.sqrt(ML**2 * (w**4 + alpha**2) + 2 * weight * ML * pull + weight**2)


def friction_torque_rotating_link(
    theta_m: Functions, w_m: Functions, alpha_m: Functions, p: Parameters, m: Functions = mpmath
) -> Number:
    """Not in the paper: the resultant friction torque there; the transversal force is F_T sin(phi)."""
    F_N, F_T = normal_force_rotating_link(theta_m, w_m, alpha_m, p, m), p.F_T * m.sin(p.phi)
    f_l = (p.B_lN * F_N + p.B_lT * F_T) * p.mu * w_m + (p.C_lN * F_N + p.C_lT * F_T) * m.sign(w_m)
    return resultant_friction(motor_friction(w_m, p, m), f_l, w_m, p)
