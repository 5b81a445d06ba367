"""How far emitted code is from the paper's closed forms at 50 digits, in units of the last place.

Inputs count as the exact binary numbers they are, parameters as exact, too. `benchmarks/accuracy.py` measures
full sets, `tests/test_accuracy.py` small ones.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from types import SimpleNamespace
from typing import NamedTuple

import mpmath
import numpy as np
from mpmath import mpf

from tests import oracle, paper
from tests.oracle import Point
from tests.paper import Parameters

Real = type[np.floating]
FAR = (1e3, 1e4)  # rad, the largest motor angles


class Set(NamedTuple):
    """One set of states: its name, and motor angles [rad] and velocities [rad/s] in the precision."""

    name: str
    theta_m: np.ndarray
    omega_m: np.ndarray


def decimals(**changes: str) -> Parameters:
    """Return Table 1 with decimals or fractions changed, at 50 digits; F_T = M_l g follows."""
    table = paper.table_1()
    values = vars(table) | {name: Fraction(text) for name, text in changes.items()}
    values["F_T"] = values["M_l"] * values["g"]
    return SimpleNamespace(**{name: oracle.number(value) for name, value in values.items()})


def sets(p: Parameters, dtype: Real, size: int, seed: int = 1) -> tuple[Set, ...]:
    """Return the states to measure at: the whole plane, the hollow from afar and near, large angles.

    The hollow is where the link stands upright at the critical velocity; distances from it are in rad of the
    link and relative to that velocity.
    """
    random = np.random.default_rng(seed)
    star = paper.critical_velocity(p) / p.mu
    turn = 2 * mpmath.pi / p.mu

    def near(offsets: Callable[[], np.ndarray], turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        sides = random.choice((-1, 1), size)
        theta = [(int(k) + mpf(0.5)) * turn + mpf(x) / p.mu for k, x in zip(turns, offsets(), strict=True)]
        omega = [int(s) * star * (1 + mpf(x)) for s, x in zip(sides, offsets(), strict=True)]
        return np.array([float(x) for x in theta]), np.array([float(x) for x in omega])

    def even() -> np.ndarray:
        return random.uniform(-1e-3, 1e-3, size)

    def logarithmic() -> np.ndarray:
        return random.choice((-1, 1), size) * 10 ** random.uniform(-7, -3, size)

    def velocities() -> np.ndarray:
        return random.uniform(-3, 3, size) * float(star)

    few = random.integers(-2, 2, size)
    last = int(FAR[1] / float(turn)) - 1
    many = random.integers(-last, last + 1, size)
    chosen = {
        "plane": (random.uniform(-3, 3, size) * float(turn), velocities()),
        "within 1e-3 of the hollow": near(even, few),
        "1e-7 to 1e-3 from it": near(logarithmic, few),
        "the same, up to 1e4 rad": near(logarithmic, many),
    }
    for far in FAR:
        angles = random.choice((-1, 1), size) * random.uniform(0.9, 1.0, size) * far
        chosen[f"theta_m up to {far:.0e} rad"] = (angles, velocities())
    return tuple(
        Set(name, theta.astype(dtype), omega.astype(dtype)) for name, (theta, omega) in chosen.items()
    )


def units(actual: np.ndarray, exact: list[mpf]) -> np.ndarray:
    """Return the errors in units of the last place of the exact value; NaN where `actual` is NaN."""
    spacing = np.spacing(np.array([float(abs(x)) for x in exact], actual.dtype)).astype(float)
    errors = [
        float(mpf(float(a)) - x) if np.isfinite(a) else np.nan for a, x in zip(actual, exact, strict=True)
    ]
    return np.abs(errors) / spacing


def normal_force(name: str, at: Set, p: Parameters) -> list[mpf]:
    """Return the exact normal forces of a steady model [N]."""
    law = oracle.CASES[name].normal_force
    return [law(point, p) for point in _points(at)]


def friction_torque(name: str, at: Set, p: Parameters) -> list[mpf]:
    """Return the exact resultant friction torques of a steady model [N m]."""
    law = oracle.CASES[name].friction_torque
    return [law(point, p) for point in _points(at)]


def gradient(at: Set, p: Parameters) -> list[tuple[tuple[mpf, mpf], tuple[mpf, mpf]]]:
    """Return, for c2_parallel, (slope, size) by theta_m and by omega_m.

    With a = M L (mu omega_m)^2 and the weight b, F_N' is a'(a + b cos theta_l)/F_N and -a b theta_l' sin
    theta_l/F_N. The size is what F_N' is at most, a' or a theta_l', in its place, and all terms of one sign.
    """
    found = []
    for x in _points(at):
        a_w = 2 * p.M * p.L * p.mu**2 * abs(x.omega_m)
        a, b, theta = a_w * abs(x.omega_m) / 2, (p.M + p.M_l) * p.g, p.mu * x.theta_m
        F_N, sign = paper.normal_force_c2(x.theta_m, x.omega_m, p), mpmath.sign(x.omega_m)
        per_load = p.B_lN * p.mu**2 * x.omega_m + p.C_lN * p.mu * sign
        own = p.B_lN * p.mu**2 * F_N + p.B_m + paper.back_emf_damping(p)
        by_theta = -per_load * a * b * p.mu * mpmath.sin(theta) / F_N
        by_omega = own + per_load * sign * a_w * (a + b * mpmath.cos(theta)) / F_N
        sizes = abs(per_load) * a * p.mu, own + abs(per_load) * a_w
        found.append(((by_theta, sizes[0]), (by_omega, sizes[1])))
    return found


def accelerated(at: Set, alpha_m: np.ndarray, p: Parameters) -> list[tuple[mpf, mpf]]:
    """Return, for rotating_link, the normal force and M L (w^2 + |alpha|) + b, link side [N]."""
    found = []
    for x, number in zip(_points(at), alpha_m, strict=True):
        alpha = mpf(float(number))
        weight = (p.M + p.M_l) * p.g * mpmath.cos(p.phi)
        size = p.M * p.L * ((p.mu * x.omega_m) ** 2 + abs(p.mu * alpha)) + weight
        found.append((paper.normal_force_rotating_link(x.theta_m, x.omega_m, alpha, p), size))
    return found


def relative(actual: np.ndarray, exact: list[tuple[mpf, mpf]]) -> np.ndarray:
    """Return the errors over the sizes that come with the exact values, in eps of the precision."""
    eps = float(np.finfo(actual.dtype).eps)
    errors = [float(abs(mpf(float(a)) - x) / size) for a, (x, size) in zip(actual, exact, strict=True)]
    return np.array(errors) / eps


def _points(at: Set) -> list[Point]:
    return [Point(mpf(float(t)), mpf(float(w)), mpf(0)) for t, w in zip(at.theta_m, at.omega_m, strict=True)]
