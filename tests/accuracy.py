"""How far emitted code is from the paper's closed forms at 50 digits, in units of the last place.

Inputs count as the exact binary numbers they are, parameters as exact, too. `benchmarks/accuracy.py` measures
full sets, `tests/test_accuracy.py` small ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from types import SimpleNamespace

import mpmath
import numpy as np
from mpmath import mpf

from tests import oracle, paper
from tests.oracle import Point
from tests.paper import Parameters

Real = type[np.floating]
_UNSHIFTED = mpf(0)
FAR = (1e3, 1e4)  # rad, the largest angles of the motor


@dataclass(frozen=True, eq=False)
class Set:
    """One set of states: its name, and motor angles [rad] and velocities [rad/s] in the precision.

    The link hangs lowest where theta_m + shift is 0.
    """

    name: str
    theta_m: np.ndarray
    omega_m: np.ndarray
    shift: mpf = _UNSHIFTED

    @cached_property
    def points(self) -> list[Point]:
        """The states as the exact numbers that they are."""
        states = zip(self.theta_m.tolist(), self.omega_m.tolist(), strict=True)
        return [Point(mpf(t) + self.shift, mpf(w), mpf(0)) for t, w in states]


def decimals(**changes: str) -> Parameters:
    """Return Table 1 with decimals or fractions changed, at 50 digits; F_T = M_l g follows."""
    table = paper.table_1()
    values = vars(table) | {name: Fraction(text) for name, text in changes.items()}
    values["F_T"] = values["M_l"] * values["g"]
    return SimpleNamespace(**{name: oracle.number(value) for name, value in values.items()})


def sets(p: Parameters, dtype: Real, size: int, shift: mpf = _UNSHIFTED) -> tuple[Set, ...]:
    """Return the states to measure at: the whole plane, far from and near the zero of F_N, large angles.

    F_N is zero where the link is upright at the critical velocity; distances from it are in rad of the
    link and relative to that velocity.
    """
    return _sets(_letters(p), dtype, size, shift)


def _letters(p: Parameters) -> tuple[tuple[str, mpf], ...]:
    return tuple(vars(p).items())


@lru_cache(maxsize=4)
def _sets(letters: tuple[tuple[str, mpf], ...], dtype: Real, size: int, shift: mpf) -> tuple[Set, ...]:
    p = SimpleNamespace(**dict(letters))
    random = np.random.default_rng(1)
    star = paper.critical_velocity(p) / p.mu
    turn = 2 * mpmath.pi / p.mu

    def near(offsets: Callable[[], np.ndarray], turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        sides = random.choice((-1, 1), size)
        theta = [
            (int(k) + mpf(0.5)) * turn + mpf(x) / p.mu - shift for k, x in zip(turns, offsets(), strict=True)
        ]
        omega = [int(s) * star * (1 + mpf(x)) for s, x in zip(sides, offsets(), strict=True)]
        return np.array([float(x) for x in theta]), np.array([float(x) for x in omega])

    def even() -> np.ndarray:
        return random.uniform(-1e-3, 1e-3, size)

    def logarithmic() -> np.ndarray:
        return random.choice((-1, 1), size) * 10 ** random.uniform(-7, -3, size)

    def velocities() -> np.ndarray:
        return random.uniform(-3, 3, size) * float(star)

    few = random.integers(-2, 2, size)
    last = int(FAR[-1] / float(turn)) - 1
    many = random.integers(-last, last + 1, size)
    chosen = {
        "plane": (random.uniform(-3, 3, size) * float(turn), velocities()),
        "within 1e-3 of the zero of F_N": near(even, few),
        "1e-7 to 1e-3 from it": near(logarithmic, few),
        "the same, up to 1e4 rad": near(logarithmic, many),
    }
    for far in FAR:
        angles = random.choice((-1, 1), size) * random.uniform(0.9, 1.0, size) * far
        chosen[f"theta_m up to {far:.0e} rad"] = (angles, velocities())
    return tuple(
        Set(name, theta.astype(dtype), omega.astype(dtype), shift) for name, (theta, omega) in chosen.items()
    )


def beside_the_tops(p: Parameters, dtype: Real) -> Set:
    """Return the angles nearest to every top of the link up to 1e4 rad, at the nearest to critical velocity.

    Nowhere else does F_N depend on more digits of the period.
    """
    tops = [(k + mpf(0.5)) * 2 * mpmath.pi / p.mu for k in range(int(FAR[-1] * p.mu / (2 * mpmath.pi)))]
    at = np.array([float(x) for x in tops]).astype(dtype)
    theta_m = np.concatenate([np.nextafter(at, dtype(0)), at, -np.nextafter(at, dtype(FAR[-1]))])
    star = dtype(float(paper.critical_velocity(p) / p.mu))
    return Set("beside the tops", theta_m, np.full_like(theta_m, star))


def units(actual: np.ndarray, exact: list[mpf]) -> np.ndarray:
    """Return the errors in units of the last place of the exact value; NaN where `actual` is NaN."""
    spacing = np.spacing(np.array([float(abs(x)) for x in exact], actual.dtype)).astype(float)
    errors = [
        float(mpf(float(a)) - x) if np.isfinite(a) else np.nan for a, x in zip(actual, exact, strict=True)
    ]
    return np.abs(errors) / spacing


# Friction and its derivatives, of one model or of several, need the same forces.
@lru_cache(maxsize=64)
def _values(
    law: Callable[[Point, Parameters], mpf], at: Set, letters: tuple[tuple[str, mpf], ...]
) -> list[mpf]:
    p = SimpleNamespace(**dict(letters))
    return [law(x, p) for x in at.points]


def normal_force(name: str, at: Set, p: Parameters) -> list[mpf]:
    """Return the exact normal forces of a steady model [N]."""
    return _values(oracle.CASES[name].normal_force, at, _letters(p))


def friction_torque(name: str, at: Set, p: Parameters) -> list[mpf]:
    """Return the exact resultant friction torques of a steady model [N m]."""
    return _values(oracle.CASES[name].friction_torque, at, _letters(p))


def mechanical_friction_torque(name: str, at: Set, p: Parameters) -> list[mpf]:
    """Return the exact friction torques without the back-EMF damping [N m]."""
    damping = paper.back_emf_damping(p)
    return [F - damping * x.omega_m for F, x in zip(friction_torque(name, at, p), at.points, strict=True)]


def jacobian(name: str, at: Set, p: Parameters, labels: Iterable[str]) -> list[list[mpf]]:
    """Return the exact derivatives of the friction torque by its coefficients, a list for each label."""
    rows = [
        columns(name, F_N, x, p, labels) for x, F_N in zip(at.points, normal_force(name, at, p), strict=True)
    ]
    return [list(column) for column in zip(*rows, strict=True)]


def columns(name: str, F_N: mpf, x: Point, p: Parameters, labels: Iterable[str]) -> list[mpf]:
    """Return the derivatives of the friction torque by its coefficients under a given normal force."""
    found, F_T = oracle.columns(F_N, x.omega_m, p), oracle.CASES[name].transversal(p) * p.F_T
    return [found[label] * (F_T if "lT" in label else 1) for label in labels]


def gradient(name: str, at: Set, p: Parameters) -> dict[str, list[tuple[mpf, mpf]]]:
    """Return, for a steady model, (slope, size) by theta_m and by omega_m.

    With a = M L (mu omega_m)^2 and the weight b, F_N' is a'(a + b cos theta_l)/F_N and -a b theta_l' sin
    theta_l/F_N. The size is what F_N' is at most, at any angle, in its place, a' or the lesser of a and b
    times theta_l', and all terms of one sign. In case C1 b is 0, and the size is the slope itself.
    """
    return dict(_gradient(name, at, _letters(p)))


@lru_cache(maxsize=64)
def _gradient(name: str, at: Set, letters: tuple[tuple[str, mpf], ...]) -> dict[str, list[tuple[mpf, mpf]]]:
    p = SimpleNamespace(**dict(letters))
    found: dict[str, list[tuple[mpf, mpf]]] = {"theta_m": [], "omega_m": []}
    case = oracle.CASES[name]
    for x, F_N in zip(at.points, normal_force(name, at, p), strict=True):
        sign = mpmath.sign(x.omega_m)
        a_w = 2 * p.M * p.L * p.mu**2 * abs(x.omega_m)
        a, b, theta = a_w * abs(x.omega_m) / 2, (p.M + p.M_l) * case.in_plane_gravity(p), p.mu * x.theta_m
        per_load, own = under_load(name, F_N, x, p)
        by_theta = -per_load * a * b * p.mu * mpmath.sin(theta) / F_N
        by_omega = own + per_load * sign * a_w * (a + b * mpmath.cos(theta)) / F_N
        found["theta_m"].append((by_theta, abs(per_load) * min(a, b) * p.mu))
        found["omega_m"].append((by_omega, own + abs(per_load) * a_w))
    return found


def under_load(name: str, F_N: mpf, x: Point, p: Parameters) -> tuple[mpf, mpf]:
    """Return by how much friction grows with F_N, and with omega_m while F_N stays what it is."""
    q, F_T = oracle.coefficients(name, x.omega_m, p), oracle.CASES[name].transversal(p) * p.F_T
    own = q.B_lN * p.mu**2 * F_N + q.B_m + paper.back_emf_damping(p)
    per_load = q.B_lN * p.mu**2 * x.omega_m + q.C_lN * p.mu * mpmath.sign(x.omega_m)
    return per_load, own + (q.B_lT * p.mu**2 * F_T if F_T else 0)


def accelerated(at: Set, alpha_m: np.ndarray, p: Parameters) -> list[tuple[Point, mpf]]:
    """Return, for rotating_link, the states and their M L (w^2 + |alpha|) + b, link side [N]."""
    weight = (p.M + p.M_l) * oracle.CASES["rotating_link"].in_plane_gravity(p)
    found = []
    for steady, number in zip(at.points, alpha_m, strict=True):
        x = steady._replace(alpha_m=mpf(float(number)))
        found.append((x, p.M * p.L * ((p.mu * x.omega_m) ** 2 + abs(p.mu * x.alpha_m)) + weight))
    return found


def relative(actual: np.ndarray, exact: Sequence[tuple[mpf, mpf]]) -> np.ndarray:
    """Return the errors over the sizes that come with the exact values, in eps of the precision."""
    eps = float(np.finfo(actual.dtype).eps)
    errors = [abs(mpf(float(a)) - x) for a, (x, _) in zip(actual, exact, strict=True)]
    sizes = [abs(size) for _, size in exact]
    return np.array([float(e and e / size) for e, size in zip(errors, sizes, strict=True)]) / eps
