# Generated: do not edit. Written by `make derive` from derivations/c2_parallel.py
# (eccentric 0.1.0, program 70a139fb).
# Case C2: gravity parallel to the motion plane, steady motion.
"""Case C2: gravity parallel to the motion plane, steady motion.

Inputs are on the motor side, in SI units; they broadcast, float32 stays float32, and `out` is honoured.
Without parameters the defaults of `Parameters` hold.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

__all__ = [
    "GRADIENT",
    "JACOBIAN",
    "REGRESSOR",
    "Parameters",
    "coulomb_torque",
    "current",
    "electrical_residual",
    "friction_coefficients",
    "friction_torque",
    "friction_torque_gradient",
    "friction_torque_jacobian",
    "gravity_torque",
    "mechanical_friction_torque",
    "mechanical_residual",
    "normal_force",
    "regressor",
    "voltage",
]

REGRESSOR = ("B_lN", "C_lN", "B_m", "C_m")
GRADIENT = ("theta_m", "omega_m")
JACOBIAN = ("B_lN", "C_lN", "B_m", "C_m")

_Real = type[np.float32] | type[np.float64]


@dataclass(frozen=True)
class Parameters:
    """Parameters with the paper's letters, in SI units; the defaults are Table 1 of the paper with mu = 1/5.

    Raises:
        ValueError: a value is not a finite number, or has a sign that the quantity cannot have.
    """

    M: float = 0.5
    """unbalanced mass [kg], eq. (5)"""
    M_l: float = 0.2
    """mass of the link without M [kg], eq. (15)"""
    L: float = 0.25
    """distance of M from the axis [m], eq. (5)"""
    mu: float = 0.2
    """gear ratio theta_l/theta_m [1], eq. (3)"""
    R: float = 1.0
    """armature resistance [Ohm], eq. (2)"""
    k_i: float = 0.02
    """torque constant [N m/A], eq. (2)"""
    k_e: float = 0.2
    """back-EMF constant [V s/rad], eq. (2)"""
    g: float = 9.81
    """gravitational acceleration [m/s^2], eq. (5)"""
    B_lN: float = 0.004
    """viscous friction of the link per normal force [m s/rad], eq. (9)"""
    C_lN: float = 0.08
    """Coulomb friction of the link per normal force [m], eq. (9)"""
    B_m: float = 0.0004
    """viscous friction of the motor [N m s/rad], eq. (10)"""
    C_m: float = 0.008
    """Coulomb friction of the motor [N m], eq. (10)"""
    J_m: float | None = None
    """inertia of the motor [kg m^2], eq. (1), needed with alpha_m"""
    J_l: float | None = None
    """inertia of the link about its axis, M L^2 included [kg m^2], eq. (3), needed with alpha_m"""

    def __post_init__(self) -> None:
        for name, (required, lowest, highest) in _DOMAINS.items():
            value = getattr(self, name)
            if value is None and name in _OPTIONAL:
                continue
            try:
                allowed = value is not None and lowest <= value <= highest
            except TypeError:
                allowed = False
            if not allowed:
                raise ValueError(f"{name}: required {required}, got {value!r}")


_OPTIONAL = ("J_m", "J_l")
_LARGEST = float(np.finfo(np.float64).max)
_DOMAINS = {
    "M": ("a number that is not negative [kg]", 0.0, _LARGEST),
    "M_l": ("a number that is not negative [kg]", 0.0, _LARGEST),
    "L": ("a number that is not negative [m]", 0.0, _LARGEST),
    "mu": ("a positive number [1]", math.ulp(0.0), _LARGEST),
    "R": ("a positive number [Ohm]", math.ulp(0.0), _LARGEST),
    "k_i": ("a positive number [N m/A]", math.ulp(0.0), _LARGEST),
    "k_e": ("a number that is not negative [V s/rad]", 0.0, _LARGEST),
    "g": ("a number that is not negative [m/s^2]", 0.0, _LARGEST),
    "B_lN": ("a number that is not negative [m s/rad]", 0.0, _LARGEST),
    "C_lN": ("a number that is not negative [m]", 0.0, _LARGEST),
    "B_m": ("a number that is not negative [N m s/rad]", 0.0, _LARGEST),
    "C_m": ("a number that is not negative [N m]", 0.0, _LARGEST),
    "J_m": ("a number that is not negative [kg m^2]", 0.0, _LARGEST),
    "J_l": ("a number that is not negative [kg m^2]", 0.0, _LARGEST),
}


class _Coefficients(NamedTuple):
    """What depends on parameters only, in the working precision."""

    B_lN: Any
    B_m: Any
    C_lN: Any
    C_m: Any
    k_i: Any
    mu: Any
    scale_N: Any
    unbalanced: Any
    twice_omega_star: Any
    omega_star_1: Any
    omega_star_2: Any
    half_period_1: Any
    half_period_2: Any
    half_period_3: Any
    turns_per_rad: Any
    half_mu: Any
    period: Any
    B_lN_mu2: Any
    B_m_plus_k_e_k_i_per_R: Any
    C_lN_mu: Any
    mu_omega_star_scale_N: Any
    mu2: Any
    C_lN_mu_weight_plus_C_m: Any
    twice_L_M_g_mu: Any
    J: Any
    B_lN_R_mu2_per_k_i: Any
    B_m_R_per_k_i_plus_k_e: Any
    C_lN_R_mu_per_k_i: Any
    C_m_R_per_k_i: Any
    R_per_k_i: Any
    twice_L_M_R_g_mu_per_k_i: Any
    B_lN_mu2_per_k_i: Any
    B_m_per_k_i: Any
    per_k_i: Any
    C_lN_mu_per_k_i: Any
    C_m_per_k_i: Any
    twice_L_M_g_mu_per_k_i: Any
    k_i_per_R: Any
    k_e_k_i_per_R: Any
    largest: Any


def _leading(x: float, real: _Real) -> float:
    """Take the leading digits of x, so few that an odd number of half turns times them is exact."""
    scaled = x * (4398046511105.0 if real is np.float32 else 1048577.0)
    return scaled - (scaled - x)


@lru_cache(maxsize=64)
def _prepare(p: Parameters, real: _Real) -> _Coefficients:
    J_m = math.nan if p.J_m is None else p.J_m
    J_l = math.nan if p.J_l is None else p.J_l
    weight = p.g * (p.M + p.M_l)
    critical_squared = 1.0 if p.L * p.M == 0.0 else weight / (p.L * p.M)
    omega_star = 1.0 if p.L * p.M == 0.0 else math.sqrt(critical_squared) / p.mu
    scale_N = weight / (omega_star * omega_star) if p.L * p.M == 0.0 else p.L * p.M * p.mu * p.mu
    unbalanced = 0.0 if p.L * p.M == 0.0 else 1.0
    twice_omega_star = 2.0 * omega_star
    omega_star_1 = float(real(omega_star))
    omega_star_2 = float(real(omega_star - omega_star_1))
    half_period = 3.1415926535897932 / p.mu
    half_period_1 = _leading(half_period, real)
    half_period_2 = _leading(half_period - half_period_1, real)
    half_period_3 = float(real(half_period - half_period_1 - half_period_2))
    turns_per_rad = 0.5 * p.mu / 3.1415926535897932
    half_mu = 0.5 * p.mu
    period = 2.0 * 3.1415926535897932 / p.mu
    B_lN_mu2 = p.B_lN * p.mu * p.mu
    B_m_plus_k_e_k_i_per_R = p.B_m + p.k_e * p.k_i / p.R
    C_lN_mu = p.C_lN * p.mu
    mu_omega_star_scale_N = p.mu * omega_star * scale_N
    mu2 = p.mu * p.mu
    C_lN_mu_weight_plus_C_m = p.C_lN * p.mu * weight + p.C_m
    twice_L_M_g_mu = 2.0 * p.L * p.M * p.g * p.mu
    J = J_l * p.mu * p.mu + J_m
    B_lN_R_mu2_per_k_i = p.B_lN * p.R * p.mu * p.mu / p.k_i
    B_m_R_per_k_i_plus_k_e = p.B_m * p.R / p.k_i + p.k_e
    C_lN_R_mu_per_k_i = p.C_lN * p.R * p.mu / p.k_i
    C_m_R_per_k_i = p.C_m * p.R / p.k_i
    R_per_k_i = p.R / p.k_i
    twice_L_M_R_g_mu_per_k_i = 2.0 * p.L * p.M * p.R * p.g * p.mu / p.k_i
    B_lN_mu2_per_k_i = p.B_lN * p.mu * p.mu / p.k_i
    B_m_per_k_i = p.B_m / p.k_i
    per_k_i = 1.0 / p.k_i
    C_lN_mu_per_k_i = p.C_lN * p.mu / p.k_i
    C_m_per_k_i = p.C_m / p.k_i
    twice_L_M_g_mu_per_k_i = 2.0 * p.L * p.M * p.g * p.mu / p.k_i
    k_i_per_R = p.k_i / p.R
    k_e_k_i_per_R = p.k_e * p.k_i / p.R
    with np.errstate(all="ignore"):
        return _Coefficients(
            B_lN=real(p.B_lN),
            B_m=real(p.B_m),
            C_lN=real(p.C_lN),
            C_m=real(p.C_m),
            k_i=real(p.k_i),
            mu=real(p.mu),
            scale_N=real(scale_N),
            unbalanced=real(unbalanced),
            twice_omega_star=real(twice_omega_star),
            omega_star_1=real(omega_star_1),
            omega_star_2=real(omega_star_2),
            half_period_1=real(half_period_1),
            half_period_2=real(half_period_2),
            half_period_3=real(half_period_3),
            turns_per_rad=real(turns_per_rad),
            half_mu=real(half_mu),
            period=real(period),
            B_lN_mu2=real(B_lN_mu2),
            B_m_plus_k_e_k_i_per_R=real(B_m_plus_k_e_k_i_per_R),
            C_lN_mu=real(C_lN_mu),
            mu_omega_star_scale_N=real(mu_omega_star_scale_N),
            mu2=real(mu2),
            C_lN_mu_weight_plus_C_m=real(C_lN_mu_weight_plus_C_m),
            twice_L_M_g_mu=real(twice_L_M_g_mu),
            J=real(J),
            B_lN_R_mu2_per_k_i=real(B_lN_R_mu2_per_k_i),
            B_m_R_per_k_i_plus_k_e=real(B_m_R_per_k_i_plus_k_e),
            C_lN_R_mu_per_k_i=real(C_lN_R_mu_per_k_i),
            C_m_R_per_k_i=real(C_m_R_per_k_i),
            R_per_k_i=real(R_per_k_i),
            twice_L_M_R_g_mu_per_k_i=real(twice_L_M_R_g_mu_per_k_i),
            B_lN_mu2_per_k_i=real(B_lN_mu2_per_k_i),
            B_m_per_k_i=real(B_m_per_k_i),
            per_k_i=real(per_k_i),
            C_lN_mu_per_k_i=real(C_lN_mu_per_k_i),
            C_m_per_k_i=real(C_m_per_k_i),
            twice_L_M_g_mu_per_k_i=real(twice_L_M_g_mu_per_k_i),
            k_i_per_R=real(k_i_per_R),
            k_e_k_i_per_R=real(k_e_k_i_per_R),
            largest=real(np.finfo(real).max),
        )


_BLOCK = 4096  # elements; a block's temporaries stay in the cache
_DEFAULT = Parameters()
_SINE_SERIES = {
    "f": (
        2.60481395e-6,
        -1.98088904e-4,
        8.33304849e-3,
        -1.66666579e-1,
        9.99999996e-1,
    ),
    "d": (
        2.7213978552799456e-15,
        -7.6430101545396992e-13,
        1.6058940263949843e-10,
        -2.5052106878642193e-8,
        2.7557319211102121e-6,
        -1.984126984120794e-4,
        8.3333333333331843e-3,
        -1.6666666666666665e-1,
        1.0,
    ),
}
_COSINE_SERIES = {
    "f": (
        -2.6047719e-7,
        2.47599463e-5,
        -1.38883571e-3,
        4.16666359e-2,
        -4.99999993e-1,
        1.0,
    ),
    "d": (
        4.608641632733578e-14,
        -1.1462870836348485e-11,
        2.0876560676087604e-9,
        -2.7557316368436772e-7,
        2.4801587277173477e-5,
        -1.3888888888771598e-3,
        4.1666666666663843e-2,
        -4.9999999999999974e-1,
        1.0,
    ),
}


def _sine_series(square: Any) -> Any:
    """sin(x)/x by x^2, |x| within a quarter turn; error of the fit 4.3e-9 and 2.1e-19."""
    first, *rest = _SINE_SERIES[square.dtype.char]
    value = square * first
    for coefficient in rest[:-1]:
        value = (value + coefficient) * square
    return value + rest[-1]


def _cosine_series(square: Any) -> Any:
    """cos(x) by x^2, |x| within a quarter turn; error of the fit 2.2e-10 and 4.0e-18."""
    first, *rest = _COSINE_SERIES[square.dtype.char]
    value = square * first
    for coefficient in rest[:-1]:
        value = (value + coefficient) * square
    return value + rest[-1]


def _require(names: tuple[str, ...], value: ArrayLike, parameters: Parameters | None) -> None:
    """Ask for the inertia, which has no default, where there is an acceleration."""
    missing = [name for name in names if getattr(parameters or _DEFAULT, name) is None]
    if missing and np.any(np.asarray(value) != 0):
        raise ValueError(f"{', '.join(missing)}: required in Parameters with an acceleration, got None")


def _evaluate(
    kernel: Callable[..., tuple[Any, ...]],
    inputs: tuple[Any, ...],
    parameters: Parameters | None,
    out: np.ndarray | None,
    width: int,
) -> Any:
    """Run the kernel over the broadcast inputs, block by block; width 0 is a scalar result."""
    # Numbers of Python's have no precision of their own: they leave a float32 beside them what it is.
    kept = np.ndarray | np.generic | float | int
    inputs = tuple(x if isinstance(x, kept) else np.asarray(x) for x in inputs)
    real = np.float32 if inputs and np.result_type(*inputs) == np.float32 else np.float64
    arrays = [np.asarray(x, dtype=real) for x in inputs]
    c = _prepare(parameters or _DEFAULT, real)
    shape = np.broadcast_shapes(*(x.shape for x in arrays))
    full = (*shape, width) if width else shape
    result = np.empty(full, dtype=real) if out is None else out
    if result.shape != full or result.dtype != real:
        got = f"{result.shape} of {result.dtype}"
        raise ValueError(f"out: required shape {full} of {real.__name__}, got {got}")
    parts = [result[..., k] for k in range(width)] if width else [result]
    with np.errstate(all="ignore"):
        if result.size <= _BLOCK * max(width, 1):
            for part, value in zip(parts, kernel(c, *arrays), strict=True):
                part[...] = value
        else:
            operands: Any = [*arrays, *parts]
            flags: Any = [["readonly"]] * len(arrays) + [["writeonly"]] * len(parts)
            blocks = np.nditer(
                operands,
                flags=["external_loop", "buffered", "copy_if_overlap"],
                op_flags=flags,
                buffersize=_BLOCK,
            )
            with blocks:
                for block in blocks:
                    values = kernel(c, *block[: len(arrays)])
                    for part, value in zip(block[len(arrays) :], values, strict=True):
                        part[...] = value
    return result[()] if out is None else out


def _normal_force(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    # magnitude of the motor velocity, 0 if the mass is balanced [rad/s]
    speed = c.unbalanced * np.abs(omega_m)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    # the odd number of half turns up to the top that is nearest
    halves = 2.0 * np.floor(theta_m * c.turns_per_rad) + 1.0
    # the half turns go off in three parts, the leading digits first: both products are exact
    rest = theta_m - halves * c.half_period_1
    # angle from the top
    from_top = rest - halves * c.half_period_2 - halves * c.half_period_3
    # an angle so large that nothing is left of its phase counts as the top
    bounded = np.where(np.abs(from_top) <= c.period, from_top, theta_m - theta_m)
    # half angle from the top
    half_angle = bounded * c.half_mu
    half_angle_squared = half_angle * half_angle
    # sine of the half angle from the top: the cosine of half the angle but for its sign
    half_cosine = half_angle * _sine_series(half_angle_squared)
    p = square_difference
    q = half_cosine * speed * c.twice_omega_star
    magnitude = np.sqrt(p * p + q * q)
    # normal force on the axis of rotation [N], eq (17)
    F_N = magnitude * c.scale_N
    result = F_N
    return (result,)


def normal_force(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Normal force F_N on the axis of rotation [N]; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_normal_force, (theta_m, omega_m), parameters, out, 0)


def _friction_torque(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    # magnitude of the motor velocity, 0 if the mass is balanced [rad/s]
    speed = c.unbalanced * np.abs(omega_m)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    # the odd number of half turns up to the top that is nearest
    halves = 2.0 * np.floor(theta_m * c.turns_per_rad) + 1.0
    # the half turns go off in three parts, the leading digits first: both products are exact
    rest = theta_m - halves * c.half_period_1
    # angle from the top
    from_top = rest - halves * c.half_period_2 - halves * c.half_period_3
    # an angle so large that nothing is left of its phase counts as the top
    bounded = np.where(np.abs(from_top) <= c.period, from_top, theta_m - theta_m)
    # half angle from the top
    half_angle = bounded * c.half_mu
    half_angle_squared = half_angle * half_angle
    # sine of the half angle from the top: the cosine of half the angle but for its sign
    half_cosine = half_angle * _sine_series(half_angle_squared)
    p = square_difference
    q = half_cosine * speed * c.twice_omega_star
    magnitude = np.sqrt(p * p + q * q)
    # normal force on the axis of rotation [N], eq (17)
    F_N = magnitude * c.scale_N
    direction_of_motion = np.sign(omega_m)
    part_1 = omega_m * (c.B_lN_mu2 * F_N + c.B_m_plus_k_e_k_i_per_R)
    result = direction_of_motion * (c.C_lN_mu * F_N + c.C_m) + part_1
    return (result,)


def friction_torque(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Resultant friction torque F, back-EMF damping included, eq (6).

    In N m; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque, (theta_m, omega_m), parameters, out, 0)


def _mechanical_friction_torque(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    # magnitude of the motor velocity, 0 if the mass is balanced [rad/s]
    speed = c.unbalanced * np.abs(omega_m)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    # the odd number of half turns up to the top that is nearest
    halves = 2.0 * np.floor(theta_m * c.turns_per_rad) + 1.0
    # the half turns go off in three parts, the leading digits first: both products are exact
    rest = theta_m - halves * c.half_period_1
    # angle from the top
    from_top = rest - halves * c.half_period_2 - halves * c.half_period_3
    # an angle so large that nothing is left of its phase counts as the top
    bounded = np.where(np.abs(from_top) <= c.period, from_top, theta_m - theta_m)
    # half angle from the top
    half_angle = bounded * c.half_mu
    half_angle_squared = half_angle * half_angle
    # sine of the half angle from the top: the cosine of half the angle but for its sign
    half_cosine = half_angle * _sine_series(half_angle_squared)
    p = square_difference
    q = half_cosine * speed * c.twice_omega_star
    magnitude = np.sqrt(p * p + q * q)
    # normal force on the axis of rotation [N], eq (17)
    F_N = magnitude * c.scale_N
    direction_of_motion = np.sign(omega_m)
    part_1 = direction_of_motion * (c.C_lN_mu * F_N + c.C_m)
    result = omega_m * (c.B_lN_mu2 * F_N + c.B_m) + part_1
    return (result,)


def mechanical_friction_torque(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Mechanical friction torque f = f_m + mu f_l, without back-EMF.

    In N m; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_mechanical_friction_torque, (theta_m, omega_m), parameters, out, 0)


def _friction_torque_gradient(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    # magnitude of the motor velocity, 0 if the mass is balanced [rad/s]
    speed = c.unbalanced * np.abs(omega_m)
    direction_of_motion = np.sign(omega_m)
    speed_d_omega_m = direction_of_motion * c.unbalanced
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    # the odd number of half turns up to the top that is nearest
    halves = 2.0 * np.floor(theta_m * c.turns_per_rad) + 1.0
    # the half turns go off in three parts, the leading digits first: both products are exact
    rest = theta_m - halves * c.half_period_1
    # angle from the top
    from_top = rest - halves * c.half_period_2 - halves * c.half_period_3
    # an angle so large that nothing is left of its phase counts as the top
    bounded = np.where(np.abs(from_top) <= c.period, from_top, theta_m - theta_m)
    # half angle from the top
    half_angle = bounded * c.half_mu
    half_angle_squared = half_angle * half_angle
    # sine of the half angle from the top: the cosine of half the angle but for its sign
    half_cosine = half_angle * _sine_series(half_angle_squared)
    p = square_difference
    q = half_cosine * speed * c.twice_omega_star
    magnitude = np.sqrt(p * p + q * q)
    # normal force on the axis of rotation [N], eq (17)
    F_N = magnitude * c.scale_N
    # cosine of the half angle from the top
    half_sine = _cosine_series(half_angle_squared)
    # 0/0 at the apex, where F_N is 0 and its derivatives are taken as 0
    divisor = np.where(magnitude == 0.0, 1.0, magnitude)
    # where the square overflows, the larger of the two decides
    limit = np.where(np.abs(q) > np.abs(p), np.sign(q), 0.0)
    cosine = np.where(magnitude > c.largest, limit, q / divisor)
    ungated = half_sine * c.mu_omega_star_scale_N * speed
    F_N_d_theta_m = np.where(cosine == 0.0, 0.0, ungated * cosine)
    # where the square overflows, the larger of the two decides
    limit_2 = np.where(np.abs(p) > np.abs(q), np.sign(p), 0.0)
    cosine_2 = np.where(magnitude > c.largest, limit_2, p / divisor)
    ungated_2 = 2.0 * speed
    ungated_3 = half_cosine * c.twice_omega_star
    part_2 = np.where(cosine_2 == 0.0, 0.0, ungated_2 * cosine_2)
    part_1 = part_2 + np.where(cosine == 0.0, 0.0, ungated_3 * cosine)
    F_N_d_omega_m = part_1 * c.scale_N * speed_d_omega_m
    part_3 = c.B_lN_mu2 * omega_m + c.C_lN_mu * direction_of_motion
    result_theta_m = F_N_d_theta_m * part_3
    part_4 = c.C_lN_mu * F_N_d_omega_m * direction_of_motion
    part_5 = c.B_lN_mu2 * F_N_d_omega_m * omega_m
    part_6 = c.B_lN_mu2 * F_N
    result_omega_m = c.B_m_plus_k_e_k_i_per_R + part_4 + part_5 + part_6
    return (result_theta_m, result_omega_m)


def friction_torque_gradient(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Partial derivatives of friction_torque with respect to its inputs.

    In N m per rad, rad/s; last axis (theta_m, omega_m).

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque_gradient, (theta_m, omega_m), parameters, out, 2)


def _friction_torque_jacobian(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    # magnitude of the motor velocity, 0 if the mass is balanced [rad/s]
    speed = c.unbalanced * np.abs(omega_m)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    # the odd number of half turns up to the top that is nearest
    halves = 2.0 * np.floor(theta_m * c.turns_per_rad) + 1.0
    # the half turns go off in three parts, the leading digits first: both products are exact
    rest = theta_m - halves * c.half_period_1
    # angle from the top
    from_top = rest - halves * c.half_period_2 - halves * c.half_period_3
    # an angle so large that nothing is left of its phase counts as the top
    bounded = np.where(np.abs(from_top) <= c.period, from_top, theta_m - theta_m)
    # half angle from the top
    half_angle = bounded * c.half_mu
    half_angle_squared = half_angle * half_angle
    # sine of the half angle from the top: the cosine of half the angle but for its sign
    half_cosine = half_angle * _sine_series(half_angle_squared)
    p = square_difference
    q = half_cosine * speed * c.twice_omega_star
    magnitude = np.sqrt(p * p + q * q)
    # normal force on the axis of rotation [N], eq (17)
    F_N = magnitude * c.scale_N
    result_B_lN = F_N * c.mu2 * omega_m
    direction_of_motion = np.sign(omega_m)
    result_C_lN = F_N * direction_of_motion * c.mu
    result_B_m = omega_m
    result_C_m = direction_of_motion
    return (result_B_lN, result_C_lN, result_B_m, result_C_m)


def friction_torque_jacobian(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Partial derivatives of friction_torque with respect to all friction coefficients.

    In N m per unit coefficient; last axis (B_lN, C_lN, B_m, C_m).

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_friction_torque_jacobian, (theta_m, omega_m), parameters, out, 4)


def _regressor(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
) -> tuple[Any, ...]:
    # magnitude of the motor velocity, 0 if the mass is balanced [rad/s]
    speed = c.unbalanced * np.abs(omega_m)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    # the odd number of half turns up to the top that is nearest
    halves = 2.0 * np.floor(theta_m * c.turns_per_rad) + 1.0
    # the half turns go off in three parts, the leading digits first: both products are exact
    rest = theta_m - halves * c.half_period_1
    # angle from the top
    from_top = rest - halves * c.half_period_2 - halves * c.half_period_3
    # an angle so large that nothing is left of its phase counts as the top
    bounded = np.where(np.abs(from_top) <= c.period, from_top, theta_m - theta_m)
    # half angle from the top
    half_angle = bounded * c.half_mu
    half_angle_squared = half_angle * half_angle
    # sine of the half angle from the top: the cosine of half the angle but for its sign
    half_cosine = half_angle * _sine_series(half_angle_squared)
    p = square_difference
    q = half_cosine * speed * c.twice_omega_star
    magnitude = np.sqrt(p * p + q * q)
    # normal force on the axis of rotation [N], eq (17)
    F_N = magnitude * c.scale_N
    result_B_lN = F_N * c.mu2 * omega_m
    direction_of_motion = np.sign(omega_m)
    result_C_lN = F_N * direction_of_motion * c.mu
    result_B_m = omega_m
    result_C_m = direction_of_motion
    return (result_B_lN, result_C_lN, result_B_m, result_C_m)


def regressor(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Columns: regressor times friction_coefficients is mechanical_friction_torque.

    In N m per unit coefficient; last axis (B_lN, C_lN, B_m, C_m).

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    """
    return _evaluate(_regressor, (theta_m, omega_m), parameters, out, 4)


def _friction_coefficients(
    c: _Coefficients,
) -> tuple[Any, ...]:
    result_B_lN = c.B_lN
    result_C_lN = c.C_lN
    result_B_m = c.B_m
    result_C_m = c.C_m
    return (result_B_lN, result_C_lN, result_B_m, result_C_m)


def friction_coefficients(
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """What the columns of the regressor multiply.

    In m s/rad, m, N m s/rad, N m; last axis (B_lN, C_lN, B_m, C_m).
    """
    return _evaluate(_friction_coefficients, (), parameters, out, 4)


def _coulomb_torque(
    c: _Coefficients,
) -> tuple[Any, ...]:
    result = c.C_lN_mu_weight_plus_C_m
    return (result,)


def coulomb_torque(
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Magnitude of the friction torque at standstill, where it is set-valued.

    In N m; shape of the broadcast inputs.
    """
    return _evaluate(_coulomb_torque, (), parameters, out, 0)


def _gravity_torque(
    c: _Coefficients,
    theta_m: Any,
) -> tuple[Any, ...]:
    # the odd number of half turns up to the top that is nearest
    halves = 2.0 * np.floor(theta_m * c.turns_per_rad) + 1.0
    # the half turns go off in three parts, the leading digits first: both products are exact
    rest = theta_m - halves * c.half_period_1
    # angle from the top
    from_top = rest - halves * c.half_period_2 - halves * c.half_period_3
    # an angle so large that nothing is left of its phase counts as the top
    bounded = np.where(np.abs(from_top) <= c.period, from_top, theta_m - theta_m)
    # half angle from the top
    half_angle = bounded * c.half_mu
    half_angle_squared = half_angle * half_angle
    # sine of the half angle from the top: the cosine of half the angle but for its sign
    half_cosine = half_angle * _sine_series(half_angle_squared)
    # cosine of the half angle from the top
    half_sine = _cosine_series(half_angle_squared)
    result = -half_cosine * half_sine * c.twice_L_M_g_mu
    return (result,)


def gravity_torque(
    theta_m: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Gravity torque G, eq (5) [N m]; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    """
    return _evaluate(_gravity_torque, (theta_m,), parameters, out, 0)


def _voltage(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
    alpha_m: Any,
) -> tuple[Any, ...]:
    # magnitude of the motor velocity, 0 if the mass is balanced [rad/s]
    speed = c.unbalanced * np.abs(omega_m)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    # the odd number of half turns up to the top that is nearest
    halves = 2.0 * np.floor(theta_m * c.turns_per_rad) + 1.0
    # the half turns go off in three parts, the leading digits first: both products are exact
    rest = theta_m - halves * c.half_period_1
    # angle from the top
    from_top = rest - halves * c.half_period_2 - halves * c.half_period_3
    # an angle so large that nothing is left of its phase counts as the top
    bounded = np.where(np.abs(from_top) <= c.period, from_top, theta_m - theta_m)
    # half angle from the top
    half_angle = bounded * c.half_mu
    half_angle_squared = half_angle * half_angle
    # sine of the half angle from the top: the cosine of half the angle but for its sign
    half_cosine = half_angle * _sine_series(half_angle_squared)
    p = square_difference
    q = half_cosine * speed * c.twice_omega_star
    magnitude = np.sqrt(p * p + q * q)
    # normal force on the axis of rotation [N], eq (17)
    F_N = magnitude * c.scale_N
    direction_of_motion = np.sign(omega_m)
    # cosine of the half angle from the top
    half_sine = _cosine_series(half_angle_squared)
    part_1 = direction_of_motion * (c.C_lN_R_mu_per_k_i * F_N + c.C_m_R_per_k_i)
    part_2 = omega_m * (c.B_lN_R_mu2_per_k_i * F_N + c.B_m_R_per_k_i_plus_k_e)
    part_3 = c.R_per_k_i * np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    part_4 = -half_cosine * half_sine * c.twice_L_M_R_g_mu_per_k_i
    result = part_1 + part_2 + part_3 + part_4
    return (result,)


def voltage(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    alpha_m: ArrayLike = 0.0,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Armature voltage u = (R/k_i) (J alpha_m + G + F), eq (4) [V]; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    alpha_m [rad/s^2]: motor acceleration
    """
    _require(("J_m", "J_l"), alpha_m, parameters)
    return _evaluate(_voltage, (theta_m, omega_m, alpha_m), parameters, out, 0)


def _current(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
    alpha_m: Any,
) -> tuple[Any, ...]:
    # magnitude of the motor velocity, 0 if the mass is balanced [rad/s]
    speed = c.unbalanced * np.abs(omega_m)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    # the odd number of half turns up to the top that is nearest
    halves = 2.0 * np.floor(theta_m * c.turns_per_rad) + 1.0
    # the half turns go off in three parts, the leading digits first: both products are exact
    rest = theta_m - halves * c.half_period_1
    # angle from the top
    from_top = rest - halves * c.half_period_2 - halves * c.half_period_3
    # an angle so large that nothing is left of its phase counts as the top
    bounded = np.where(np.abs(from_top) <= c.period, from_top, theta_m - theta_m)
    # half angle from the top
    half_angle = bounded * c.half_mu
    half_angle_squared = half_angle * half_angle
    # sine of the half angle from the top: the cosine of half the angle but for its sign
    half_cosine = half_angle * _sine_series(half_angle_squared)
    p = square_difference
    q = half_cosine * speed * c.twice_omega_star
    magnitude = np.sqrt(p * p + q * q)
    # normal force on the axis of rotation [N], eq (17)
    F_N = magnitude * c.scale_N
    direction_of_motion = np.sign(omega_m)
    # cosine of the half angle from the top
    half_sine = _cosine_series(half_angle_squared)
    part_1 = direction_of_motion * (c.C_lN_mu_per_k_i * F_N + c.C_m_per_k_i)
    part_2 = c.per_k_i * np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    part_3 = -half_cosine * half_sine * c.twice_L_M_g_mu_per_k_i
    part_4 = omega_m * (c.B_lN_mu2_per_k_i * F_N + c.B_m_per_k_i)
    result = part_1 + part_2 + part_3 + part_4
    return (result,)


def current(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    alpha_m: ArrayLike = 0.0,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """Armature current i = (J alpha_m + G + f)/k_i [A]; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    alpha_m [rad/s^2]: motor acceleration
    """
    _require(("J_m", "J_l"), alpha_m, parameters)
    return _evaluate(_current, (theta_m, omega_m, alpha_m), parameters, out, 0)


def _mechanical_residual(
    c: _Coefficients,
    theta_m: Any,
    omega_m: Any,
    i: Any,
    alpha_m: Any,
) -> tuple[Any, ...]:
    # magnitude of the motor velocity, 0 if the mass is balanced [rad/s]
    speed = c.unbalanced * np.abs(omega_m)
    # speed^2 - omega_star^2; the difference is taken once, before anything is rounded
    square_difference = (speed - c.omega_star_1 - c.omega_star_2) * (speed + c.omega_star_1)
    # the odd number of half turns up to the top that is nearest
    halves = 2.0 * np.floor(theta_m * c.turns_per_rad) + 1.0
    # the half turns go off in three parts, the leading digits first: both products are exact
    rest = theta_m - halves * c.half_period_1
    # angle from the top
    from_top = rest - halves * c.half_period_2 - halves * c.half_period_3
    # an angle so large that nothing is left of its phase counts as the top
    bounded = np.where(np.abs(from_top) <= c.period, from_top, theta_m - theta_m)
    # half angle from the top
    half_angle = bounded * c.half_mu
    half_angle_squared = half_angle * half_angle
    # sine of the half angle from the top: the cosine of half the angle but for its sign
    half_cosine = half_angle * _sine_series(half_angle_squared)
    p = square_difference
    q = half_cosine * speed * c.twice_omega_star
    magnitude = np.sqrt(p * p + q * q)
    # normal force on the axis of rotation [N], eq (17)
    F_N = magnitude * c.scale_N
    direction_of_motion = np.sign(omega_m)
    # cosine of the half angle from the top
    half_sine = _cosine_series(half_angle_squared)
    part_1 = -np.where(alpha_m == 0.0, 0.0, c.J * alpha_m)
    part_2 = -direction_of_motion * (c.C_lN_mu * F_N + c.C_m)
    part_3 = half_cosine * half_sine * c.twice_L_M_g_mu
    part_4 = -omega_m * (c.B_lN_mu2 * F_N + c.B_m)
    result = i * c.k_i + part_1 + part_2 + part_3 + part_4
    return (result,)


def mechanical_residual(
    theta_m: ArrayLike,
    omega_m: ArrayLike,
    i: ArrayLike,
    alpha_m: ArrayLike = 0.0,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """What the mechanical balance leaves: k_i i - J alpha_m - G - f.

    In N m; shape of the broadcast inputs.

    theta_m [rad]: motor angle
    omega_m [rad/s]: motor velocity
    i [A]: armature current
    alpha_m [rad/s^2]: motor acceleration
    """
    _require(("J_m", "J_l"), alpha_m, parameters)
    return _evaluate(_mechanical_residual, (theta_m, omega_m, i, alpha_m), parameters, out, 0)


def _electrical_residual(
    c: _Coefficients,
    omega_m: Any,
    i: Any,
    u: Any,
) -> tuple[Any, ...]:
    result = -i * c.k_i - c.k_e_k_i_per_R * omega_m + c.k_i_per_R * u
    return (result,)


def electrical_residual(
    omega_m: ArrayLike,
    i: ArrayLike,
    u: ArrayLike,
    parameters: Parameters | None = None,
    out: np.ndarray | None = None,
) -> Any:
    """What the electrical balance leaves, as a torque: (k_i/R)(u - k_e omega_m) - k_i i.

    In N m; shape of the broadcast inputs.

    omega_m [rad/s]: motor velocity
    i [A]: armature current
    u [V]: armature voltage
    """
    return _evaluate(_electrical_residual, (omega_m, i, u), parameters, out, 0)
