"""What an emitted function must return, from `tests/paper.py` at 50 digits, and how far rounding may take it.

Both back ends are held against this: values by the paper's closed forms, derivatives by mpmath's differences
of them. `expected` gives for each component (value, scale); the code may be off by K eps scale.

The scale is what first-order rounding analysis gives, with no reference to the code. Friction sums terms of
one sign, so its relative error is a few eps, but for F_N, the length of a sum of two vectors in the plane:
centrifugal force a = M L |(w^2, alpha)| at angle theta_l and weight b. Each is right to a few eps, theta_l to
eps |theta_l|, so F_N is right to a few eps times a + b + min(a, b) |theta_l|, however small it is itself.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from types import SimpleNamespace
from typing import NamedTuple

import mpmath
import numpy as np
from mpmath import mpf
from numpy.typing import ArrayLike

from tests import paper
from tests.paper import Number, Parameters

mpmath.mp.dps = 50

# No result is more than some 30 roundings of eps/2 away from inputs and parameters (those are rounded, too).
K = 16


class Point(NamedTuple):
    """One state of the drive: motor angle, velocity and acceleration, armature current and voltage.

    With it, the torque of all but friction and a time step.
    """

    theta_m: Number
    omega_m: Number
    alpha_m: Number
    i: Number = mpf(0)
    u: Number = mpf(0)
    torque: Number = mpf(0)
    dt: Number = mpf(0)


class Case(NamedTuple):
    """One model in the paper's terms: its closed forms and which forces act."""

    normal_force: Callable[[Point, Parameters], Number]
    friction_torque: Callable[[Point, Parameters], Number]
    in_plane_gravity: Callable[[Parameters], Number]
    transversal: Callable[[Parameters], Number]
    accelerated: bool = False
    asymmetric: bool = False


def _c1(x: Point, p: Parameters) -> Number:
    return paper.normal_force_c1(x.omega_m, p)


def _c2(x: Point, p: Parameters) -> Number:
    return paper.normal_force_c2(x.theta_m, x.omega_m, p)


def _none(_: Parameters) -> Number:
    return mpf(0)


# Asked for at every state, and always of the same few tilts.
_cos, _sin = lru_cache(maxsize=8)(mpmath.cos), lru_cache(maxsize=8)(mpmath.sin)


def _whole(_: Parameters) -> Number:
    return mpf(1)


CASES = {
    "c1_perpendicular": Case(_c1, lambda x, p: paper.friction_torque_c1(x.omega_m, p), _none, _whole),
    "c1_asymmetric": Case(
        _c1, lambda x, p: paper.friction_torque_c1_asymmetric(x.omega_m, p), _none, _whole, asymmetric=True
    ),
    "c2_parallel": Case(
        _c2, lambda x, p: paper.friction_torque_c2(x.theta_m, x.omega_m, p), lambda p: p.g, _none
    ),
    "c2_asymmetric": Case(
        _c2,
        lambda x, p: paper.friction_torque_c2_asymmetric(x.theta_m, x.omega_m, p),
        lambda p: p.g,
        _none,
        asymmetric=True,
    ),
    "rotating_link": Case(
        lambda x, p: paper.normal_force_rotating_link(x.theta_m, x.omega_m, x.alpha_m, p),
        lambda x, p: paper.friction_torque_rotating_link(x.theta_m, x.omega_m, x.alpha_m, p),
        lambda p: p.g * _cos(p.phi),
        lambda p: _sin(p.phi),
        accelerated=True,
    ),
}

FUNCTIONS = (
    "normal_force", "friction_torque", "mechanical_friction_torque", "friction_torque_gradient",
    "friction_torque_with_gradient",
    "friction_torque_jacobian", "regressor", "friction_coefficients", "breakaway_torque", "friction_budget",
    "friction_step", "acceleration", "gravity_torque", "voltage", "current", "mechanical_residual",
    "electrical_residual",
)  # fmt: skip

DERIVATIVES = ("friction_torque_gradient", "friction_torque_with_gradient", "friction_torque_jacobian")


def functions(name: str) -> tuple[str, ...]:
    """Return the names of the functions that the model is emitted with."""
    polynomials = ("polynomial", "polynomial_neg") if CASES[name].asymmetric else ("polynomial",)
    return FUNCTIONS + (polynomials if name.startswith("c1_") else ())


def inputs(name: str, function: str) -> tuple[str, ...]:
    """Return the inputs that a function depends on, in the order in which it takes them."""
    if function in ("friction_coefficients", "polynomial", "polynomial_neg"):
        return ()
    if function == "breakaway_torque":  # at rest F_N is the weight
        return ("theta_m",) if CASES[name].accelerated else ()
    position = () if name.startswith("c1_") else ("theta_m",)
    if function == "gravity_torque":
        return position
    if function == "electrical_residual":
        return ("omega_m", "i", "u")
    if function == "mechanical_residual":
        return (*position, "omega_m", "i", "alpha_m")
    accelerated = CASES[name].accelerated or function in ("voltage", "current")
    beside = {"friction_step": ("torque", "dt"), "acceleration": ("torque",)}.get(function, ())
    return (*position, "omega_m", *(("alpha_m",) if accelerated else ()), *beside)


def number(value: Fraction) -> Number:
    """Return a fraction at 50 digits."""
    return mpf(value.numerator) / value.denominator


def exact(values: dict[str, float]) -> Parameters:
    """Return parameters as mpmath numbers of exactly the binary values given."""
    return SimpleNamespace(**{name: mpf(value) for name, value in values.items()})


def coefficients(name: str, omega_m: Number, p: Parameters) -> Parameters:
    """Return the friction coefficients of this direction of motion, under their symmetric names."""
    return paper.one_direction(p, "pos" if omega_m > 0 else "neg") if CASES[name].asymmetric else p


def reaction(name: str, x: Point, p: Parameters) -> tuple[Number, Number, Number]:
    """Return the in-plane reaction, across and along, and the size of its rounding error over eps.

    Steady motion is seen from the ground, where the centrifugal force turns and the weight rests;
    accelerated motion from the link, in whose frame w^2 and alpha are components and the weight turns.
    """
    case, theta, w = CASES[name], p.mu * x.theta_m, p.mu * x.omega_m
    ML, b = p.M * p.L, (p.M + p.M_l) * case.in_plane_gravity(p)
    cos, sin = mpmath.cos(theta), mpmath.sin(theta)
    alpha = p.mu * x.alpha_m if case.accelerated else mpf(0)
    a = ML * (w**2 + abs(alpha))
    error = a + b + min(a, b) * abs(theta)
    if case.accelerated:
        return ML * alpha + b * sin, ML * w**2 + b * cos, error
    return ML * w**2 * sin, ML * w**2 * cos + b, error


def friction_under_load(
    name: str, N: Number, omega_m: Number, p: Parameters, back_emf: bool = True
) -> Number:
    """Return (6) with (7) and (10) for a given normal force: how a load enters the friction torque."""
    q, F_T = coefficients(name, omega_m, p), CASES[name].transversal(p) * p.F_T
    b_T, c_T = (q.B_lT * F_T, q.C_lT * F_T) if F_T else (0, 0)
    f_l = (q.B_lN * N + b_T) * p.mu * omega_m + (q.C_lN * N + c_T) * mpmath.sign(omega_m)
    f = paper.motor_friction(omega_m, q) + p.mu * f_l
    return f + paper.back_emf_damping(p) * omega_m if back_emf else f


def derivative(name: str, x: Point, p: Parameters, variable: str) -> tuple[Number, Number]:
    """Return dF/dvariable, an input or a parameter, with its scale.

    F_N's part of it is a direction cosine of the reaction times how fast the reaction moves: the direction is
    known to (error of the reaction)/F_N, close to the apex not at all.
    """

    def along(f: Callable[[Point, Parameters], Number]) -> Number:
        if variable in Point._fields:
            return mpmath.diff(lambda v: f(x._replace(**{variable: v}), p), getattr(x, variable))
        return mpmath.diff(lambda v: f(x, SimpleNamespace(**vars(p) | {variable: v})), getattr(p, variable))

    value = along(CASES[name].friction_torque)
    across, upright, error = reaction(name, x, p)
    direct = abs(along(lambda x, p: friction_under_load(name, error, x.omega_m, p)))
    per_load = abs(friction_under_load(name, 1, x.omega_m, p) - friction_under_load(name, 0, x.omega_m, p))
    moves = mpmath.hypot(
        along(lambda x, p: reaction(name, x, p)[0]), along(lambda x, p: reaction(name, x, p)[1])
    )
    F_N = mpmath.hypot(across, upright)
    turned = error / F_N + abs(p.mu * x.theta_m) + 1 if F_N else mpmath.inf
    return value, direct + per_load * moves * turned


def columns(N: Number, omega_m: Number, p: Parameters) -> dict[str, Number]:
    """Return the regressor's columns by name: what each coefficient multiplies in f_m + mu f_l."""
    sign = mpmath.sign(omega_m)
    one = {"B_lN": p.mu**2 * N * omega_m, "C_lN": p.mu * N * sign}
    one |= dict.fromkeys(("B", "B_m"), omega_m) | dict.fromkeys(("C", "C_m"), sign)
    one |= {"B_lT": p.mu**2 * omega_m, "C_lT": p.mu * sign}
    positive = {key + "_pos": value * (omega_m > 0) for key, value in one.items()}
    return one | positive | {key + "_neg": value * (omega_m < 0) for key, value in one.items()}


def coefficient(name: str, label: str, p: Parameters) -> Number:
    """Return the coefficient of a column of the regressor; B and C are the sums that C1 cannot separate."""
    ending = label[-4:] if CASES[name].asymmetric else ""
    own, F_T = vars(p), CASES[name].transversal(p) * p.F_T
    if label == "B" + ending:
        return own["B_m" + ending] + p.mu**2 * own["B_lT" + ending] * F_T
    if label == "C" + ending:
        return own["C_m" + ending] + p.mu * own["C_lT" + ending] * F_T
    return own[label]


def line(name: str, N: Number, sign: int, p: Parameters) -> tuple[Number, Number]:
    """Return friction in one direction for a given load, a straight line: where it starts, and its slope."""
    one, two = (friction_under_load(name, N, sign * w, p, back_emf=False) for w in (mpf(1), mpf(2)))
    return 2 * one - two, sign * (two - one)


def step(
    x: Point, sides: dict[int, tuple[Number, Number]], sizes: dict[int, tuple[Number, Number]], J: Number
) -> list[tuple[Number, Number]]:
    """Return velocity and friction after a time step, by trying each direction of motion, then rest."""
    if x.dt < mpf(10) ** -9:
        return [(x.omega_m, 0), (mpf(0), 0)]
    p = J * x.omega_m + x.dt * x.torque
    p_size = J * abs(x.omega_m) + x.dt * abs(x.torque)
    for sign, (level, slope) in sides.items():
        end = (p - x.dt * level) / (J + x.dt * slope)
        if sign * end > 0:
            level_size, slope_size = map(abs, sizes[sign])
            own = (p_size + x.dt * level_size + x.dt * slope_size * abs(end)) / (J + x.dt * slope)
            return [(end, own), (level + slope * end, level_size + slope_size * abs(end) + slope * own)]
    most = max(abs(level) for level, _ in sizes.values())
    return [(mpf(0), (p_size + x.dt * most) / J), (p / x.dt, p_size / x.dt + most)]


def expected(
    name: str, function: str, x: Point, p: Parameters, labels: Sequence[str] = ()
) -> list[tuple[Number, Number]]:
    """Return (value, scale) for each component of what `function` returns at `x`; `labels` name them."""
    case = CASES[name]
    N, (_, _, N_size) = case.normal_force(x, p), reaction(name, x, p)
    G_size = p.mu * p.M * p.L * case.in_plane_gravity(p) * mpf(1)
    G = paper.gravity_torque(x.theta_m, SimpleNamespace(**vars(p) | {"g": case.in_plane_gravity(p)}))
    G_size = G_size * (1 + abs(p.mu * x.theta_m))
    F, F_size = case.friction_torque(x, p), abs(friction_under_load(name, N_size, x.omega_m, p))
    f = F - paper.back_emf_damping(p) * x.omega_m
    f_size = abs(friction_under_load(name, N_size, x.omega_m, p, back_emf=False))
    inertia = (p.J_m + p.mu**2 * p.J_l) * abs(x.alpha_m)
    if function == "normal_force":
        return [(N, N_size)]
    if function == "friction_torque":
        return [(F, F_size)]
    if function == "mechanical_friction_torque":
        return [(f, f_size)]
    if function == "gravity_torque":
        return [(G, G_size)]
    if function == "voltage":
        return [(paper.voltage(x.alpha_m, G, F, p), p.R / p.k_i * (inertia + G_size + F_size))]
    if function == "current":
        return [(paper.current(x.alpha_m, G, f, p), (inertia + G_size + f_size) / p.k_i)]
    if function == "mechanical_residual":
        drive = p.k_i * x.i
        J = p.J_m + p.mu**2 * p.J_l
        return [(drive - J * x.alpha_m - G - f, abs(drive) + inertia + G_size + f_size)]
    if function == "electrical_residual":
        terms = [p.k_i / p.R * x.u, -paper.back_emf_damping(p) * x.omega_m, -p.k_i * x.i]
        return [(sum(terms), sum(map(abs, terms)))]
    if function == "regressor":
        size = columns(N_size, x.omega_m, p)
        return [(value[label], abs(size[label])) for value in [columns(N, x.omega_m, p)] for label in labels]
    if function.startswith("polynomial"):
        direction, sign = ("neg", -1) if function == "polynomial_neg" else ("pos", 1)
        rows = (
            paper.polynomial_c1_asymmetric(direction, p) if case.asymmetric else paper.polynomial_c1(sign, p)
        )
        return [(value, abs(value)) for value in rows]
    if function == "friction_coefficients":
        return [(value, value) for value in (coefficient(name, label, p) for label in labels)]
    if function == "breakaway_torque":
        still = x._replace(omega_m=mpf(0), alpha_m=mpf(0))
        N, N_size = case.normal_force(still, p), reaction(name, still, p)[2]
    sides, sizes = ({sign: line(name, load, sign, p) for sign in (-1, 1)} for load in (N, N_size))
    levels = [(sides[sign][0], abs(sizes[sign][0])) for sign in (-1, 1)]
    if function == "breakaway_torque":
        return levels
    ahead = 1 if x.omega_m > 0 else -1
    if function == "friction_budget":
        return [*levels, (sides[ahead][1], sizes[ahead][1])]
    J = p.J_m + p.mu**2 * p.J_l
    if function == "acceleration":
        size = (abs(x.torque) + max(size for _, size in levels) + sizes[ahead][1] * abs(x.omega_m)) / J
        if x.omega_m:
            return [((x.torque - f) / J, size)]
        return [((x.torque - min(max(x.torque, levels[0][0]), levels[1][0])) / J, size)]
    if function == "friction_step":
        return step(x, sides, sizes, J)
    assert function in DERIVATIVES
    value = [(F, F_size)] if function == "friction_torque_with_gradient" else []
    return value + [derivative(name, x, p, label) for label in labels[len(value) :]]


def assert_agrees(
    actual: ArrayLike,
    name: str,
    function: str,
    points: Sequence[Point],
    p: Parameters,
    labels: Sequence[str] = (),
) -> None:
    """Assert that `actual`, one row for each point, is the paper's but for rounding in its precision."""
    rows = np.asarray(actual).reshape(len(points), -1)
    eps = mpf(float(np.finfo(rows.dtype).eps))
    for x, row in zip(points, rows, strict=True):
        for k, (value, scale) in enumerate(expected(name, function, x, p, labels)):
            error, allowed = abs(mpf(float(row[k])) - value), K * eps * scale
            what = f"{name}.{function}[{labels[k] if labels else k}] at {[float(v) for v in x]}"
            message = f"{what}: {row[k]!r}, expected {mpmath.nstr(value, 20)} to {mpmath.nstr(allowed, 3)}"
            assert error <= allowed, message
