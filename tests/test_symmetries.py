"""What must hold of the emitted models for any numbers: symmetries, limits, special angles, units."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from tests import oracle, paper, strategies
from tests.emitted import MODELS, every_call, every_model, example_states, module, parameters
from tests.paper import Parameters

EPS = float(np.finfo(float).eps)
TORQUES = ("friction_torque", "mechanical_friction_torque")
ODD = (*TORQUES, "regressor", "friction_torque_jacobian", "voltage", "current")
SYMMETRIC = [name for name in MODELS if not oracle.CASES[name].asymmetric]
SWINGING = [name for name in MODELS if not name.startswith("c1_")]
LETTERS = "M M_l L g mu R k_i k_e F_T B_lN C_lN B_lT C_lT B_m C_m"
# Of kilogram, metre, second and ampere; angles have none.
FORCE, TORQUE = (1, 1, -2, 0), (1, 2, -2, 0)
DIMENSION = {
    "theta_m": (0, 0, 0, 0), "omega_m": (0, 0, -1, 0), "alpha_m": (0, 0, -2, 0),
    "i": (0, 0, 0, 1), "u": (1, 2, -3, -1),
    "mu": (0, 0, 0, 0), "phi": (0, 0, 0, 0),
    "M": (1, 0, 0, 0), "M_l": (1, 0, 0, 0), "L": (0, 1, 0, 0), "g": (0, 1, -2, 0), "F_T": FORCE,
    "R": (1, 2, -3, -2), "k_i": (1, 2, -2, -1), "k_e": (1, 2, -2, -1),
    "J_m": (1, 2, 0, 0), "J_l": (1, 2, 0, 0),
    "B_lN": (0, 1, 1, 0), "B_lT": (0, 1, 1, 0), "C_lN": (0, 1, 0, 0), "C_lT": (0, 1, 0, 0),
    "B_m": (1, 2, -1, 0), "C_m": TORQUE, "B": (1, 2, -1, 0), "C": TORQUE,
}  # fmt: skip
RESIDUALS = ("mechanical_residual", "electrical_residual")
RESULT = dict.fromkeys((*TORQUES, *RESIDUALS, "gravity_torque", "coulomb_torque"), TORQUE) | {
    "normal_force": FORCE, "voltage": (1, 2, -3, -1), "current": (0, 0, 0, 1),
}  # fmt: skip


def states(name: str, function: str, **columns: object) -> list[np.ndarray]:
    """Return the columns that a function takes, in its order."""
    return [np.asarray(columns[one], float) for one in oracle.inputs(name, function)]


def grid(name: str, function: str) -> dict[str, np.ndarray]:
    """Return 500 reproducible states by the names of the inputs."""
    return dict(zip(oracle.inputs(name, function), example_states(name, function, 500), strict=True))


def reversed_motion(columns: dict[str, np.ndarray]) -> list[np.ndarray]:
    """Return the states run backwards in mirror image: angle, velocity and acceleration change sign."""
    return [-x for x in columns.values()]


def inertia() -> dict[str, float]:
    """Return inertias, which have no default."""
    return {"J_m": 2e-4, "J_l": 0.04}


# The paper's closed forms among themselves: what the oracle is made of.


@pytest.mark.parametrize("sign", [1, -1])
def test_closed_forms_follow_from_the_postulate(sign: int) -> None:
    """(11)-(13), (18)-(20) are (6) with (9), (10) and the postulate (7), and the limits of (14) and (21)."""
    p = SimpleNamespace(**{letter: sympy.Symbol(letter, positive=True) for letter in LETTERS.split()})
    w, theta = sign * sympy.Symbol("w", positive=True), sympy.Symbol("theta", real=True)
    f_m = paper.motor_friction(w, p, sympy)
    directions = vars(p) | {
        name + end: vars(p)[name] for name in strategies.FRICTION for end in ("_pos", "_neg")
    }
    both = SimpleNamespace(**directions)
    c1 = paper.resultant_friction(f_m, paper.link_friction_c1(w, p, sympy), w, p)
    F_N = paper.normal_force_c2(theta, w, p, sympy)
    c2 = paper.resultant_friction(f_m, p.B_lN * F_N * p.mu * w + p.C_lN * F_N * sympy.sign(w), w, p)

    assert sympy.expand(c1 - paper.friction_torque_c1(w, p, sympy)) == 0
    assert sympy.expand(c1 - paper.friction_torque_c1_asymmetric(w, both)) == 0
    assert sympy.expand(c2 - paper.friction_torque_c2(theta, w, p, sympy)) == 0
    assert sympy.expand(c2 - paper.friction_torque_c2_asymmetric(theta, w, both, sympy)) == 0


def test_general_force_has_the_papers_as_limits() -> None:
    """The reaction in a tilted plane is (8) at phi = pi/2 and (17) at phi = 0, without acceleration."""
    p = {letter: sympy.Symbol(letter, positive=True) for letter in LETTERS.split()}
    level, upright = (SimpleNamespace(**p, phi=phi) for phi in (sympy.pi / 2, sympy.Integer(0)))
    w, theta = sympy.Symbol("w", real=True), sympy.Symbol("theta", real=True)

    c1 = paper.normal_force_rotating_link(theta, w, 0, level, sympy) - paper.normal_force_c1(w, level)
    c2 = paper.normal_force_rotating_link(theta, w, 0, upright, sympy) - paper.normal_force_c2(
        theta, w, upright, sympy
    )
    assert (sympy.simplify(c1), sympy.simplify(c2)) == (0, 0)


# Symmetries, exact in floating point as well: rounding to nearest has them.


@pytest.mark.parametrize("function", ODD)
@pytest.mark.parametrize("name", SYMMETRIC)
def test_odd_under_reversal(name: str, function: str) -> None:
    """Friction, voltage and current change sign, and nothing else, when the motion is mirrored."""
    f, p, columns = (
        getattr(module(name), function),
        module(name).Parameters(**inertia()),
        grid(name, function),
    )

    assert np.array_equal(-f(*columns.values(), p), f(*reversed_motion(columns), p))


@pytest.mark.parametrize("function", TORQUES)
@pytest.mark.parametrize("name", ["c1_perpendicular", "c2_parallel"])
def test_odd_in_velocity(name: str, function: str) -> None:
    """In steady motion friction is odd in the velocity alone, at any angle."""
    f, columns = getattr(module(name), function), grid(name, function)

    assert np.array_equal(-f(*columns.values()), f(*(columns | {"omega_m": -columns["omega_m"]}).values()))


@every_model
def test_normal_force_is_even(name: str) -> None:
    """F_N is even in the mirrored motion, even in the velocity, and in steady motion even in the angle."""
    f, columns = module(name).normal_force, grid(name, "normal_force")
    expected = f(*columns.values())

    assert np.array_equal(expected, f(*reversed_motion(columns)))
    assert np.array_equal(expected, f(*(columns | {"omega_m": -columns["omega_m"]}).values()))
    if name.startswith("c2_"):
        assert np.array_equal(expected, f(*(columns | {"theta_m": -columns["theta_m"]}).values()))


@pytest.mark.parametrize("name", [name for name in MODELS if oracle.CASES[name].asymmetric])
def test_asymmetric_reversal_swaps_the_directions(name: str) -> None:
    """Mirrored motion with the coefficients of the two directions exchanged changes the sign only."""
    values = vars(paper.table_1(float)) | inertia()
    ahead = {f"{one}_pos": (k + 1) * values[one] for k, one in enumerate(strategies.FRICTION)}
    back = {f"{one}_neg": values[one] / (k + 2) for k, one in enumerate(strategies.FRICTION)}
    swapped = {key.replace("_pos", "_neg"): value for key, value in ahead.items()}
    swapped |= {key.replace("_neg", "_pos"): value for key, value in back.items()}
    columns = grid(name, "friction_torque")
    f = module(name).friction_torque

    expected = -f(*columns.values(), parameters(name, values | ahead | back))
    assert np.array_equal(expected, f(*reversed_motion(columns), parameters(name, values | swapped)))


@pytest.mark.parametrize("name", SWINGING)
@given(data=st.data())
def test_periodic_in_the_link_angle(name: str, data: st.DataObject) -> None:
    """A whole turn of the link, which the angle holds to rounding, changes nothing but by rounding."""
    values = data.draw(strategies.parameters(name))
    points = data.draw(strategies.states(values, np.float64))
    turns = data.draw(st.integers(-50, 50))
    columns = strategies.arrays(points, np.float64)
    turned = columns | {"theta_m": columns["theta_m"] + turns * 2 * np.pi / values["mu"]}
    p, exact = parameters(name, values), oracle.exact(values)

    for function in ("normal_force", "friction_torque", "gravity_torque"):
        f, taken = getattr(module(name), function), oracle.inputs(name, function)
        here, there = (np.atleast_1d(f(*(x[one] for one in taken), p)) for x in (columns, turned))
        for k, x in enumerate(points):
            # Both have the error of their own angle, the second that of the turn as well.
            far = oracle.Point(
                max(abs(x.theta_m), abs(oracle.mpf(float(turned["theta_m"][k])))), x.omega_m, x.alpha_m
            )
            scale = float(oracle.expected(name, function, far, exact)[0][1])
            turn = abs(turns) * 2 * np.pi
            assert abs(here[k] - there[k]) <= oracle.K * EPS * scale * (3 + turn)


# Limits.


@every_model
def test_balanced_mass_is_linear(name: str) -> None:
    """With M = 0 friction is the classical model, Coulomb and viscous; F_3 and F_2 vanish."""
    emitted = module(name)
    p, columns = emitted.Parameters(M=0.0), grid(name, "friction_torque")
    table = paper.table_1(float, M=0.0)
    weight = 0.0 if name.startswith("c1_") else table.M_l * table.g
    transversal = table.F_T if name.startswith("c1_") else 0.0
    viscous = (
        table.B_m
        + paper.back_emf_damping(table)
        + table.mu**2 * (table.B_lN * weight + table.B_lT * transversal)
    )
    coulomb = table.C_m + table.mu * (table.C_lN * weight + table.C_lT * transversal)
    w = columns["omega_m"]

    actual = emitted.friction_torque(*columns.values(), p)

    expected = viscous * w + coulomb * np.sign(w)
    assert np.all(np.abs(actual - expected) <= 16 * EPS * np.abs(expected))
    assert np.all(emitted.normal_force(*columns.values(), p) == pytest.approx(weight, rel=4 * EPS))
    if name.startswith("c1_"):
        assert [0.0, 0.0] == list(emitted.polynomial(p)[:2])


@pytest.mark.parametrize("name", ["c1_perpendicular", "c2_parallel", "rotating_link"])
def test_high_reduction_is_linear(name: str) -> None:
    """For mu << 1 what the link adds vanishes in proportion to mu: mu (C_lN F_N + C_lT F_T) at mu to 0."""
    emitted, columns = module(name), grid(name, "friction_torque")
    columns = columns | ({"alpha_m": 0 * columns["alpha_m"]} if "alpha_m" in columns else {})
    w = columns["omega_m"]
    for exponent in (10, 15, 20):
        mu = 2.0**-exponent
        p = paper.table_1(float, mu)
        load = p.F_T if name.startswith("c1_") else (p.M + p.M_l) * p.g

        linear = p.B_m * w + p.C_m * np.sign(w)
        added = emitted.mechanical_friction_torque(*columns.values(), emitted.Parameters(mu=mu)) - linear

        centrifugal = (
            p.M * p.L * (mu * w) ** 2
        )  # what is left beside it: viscous, and the other part of the load
        left = mu**2 * p.B_lN * (load + centrifugal) * np.abs(w) + mu * p.C_lN * centrifugal
        rounding = 16 * EPS * np.abs(linear)
        assert np.all(np.abs(added - mu * p.C_lN * load * np.sign(w)) <= left + rounding)


@pytest.mark.parametrize("name", ["c2_parallel", "c2_asymmetric"])
def test_without_gravity_the_force_is_centrifugal(name: str) -> None:
    """With g = 0 the normal force of C2 is that of C1, M L w^2, eq. (8)."""
    p, columns = paper.table_1(float, "1/5", g=0.0), grid(name, "normal_force")

    actual = module(name).normal_force(*columns.values(), module(name).Parameters(g=0.0))

    assert actual == pytest.approx(paper.normal_force_c1(columns["omega_m"], p), rel=8 * EPS)


def test_tilted_plane_has_both_cases_as_limits() -> None:
    """rotating_link is C2 at phi = 0 and, but for the rounding of cos(pi/2), C1 at phi = pi/2."""
    link, columns = module("rotating_link"), grid("c2_parallel", "friction_torque")
    theta_m, omega_m = columns.values()
    for function in ("normal_force", "friction_torque", "mechanical_friction_torque"):
        upright = getattr(link, function)(theta_m, omega_m, 0.0)
        level = getattr(link, function)(theta_m, omega_m, 0.0, link.Parameters(phi=np.pi / 2))
        c2 = getattr(module("c2_parallel"), function)(theta_m, omega_m)
        c1 = getattr(module("c1_perpendicular"), function)(omega_m)

        tolerance = oracle.K * EPS * (1 + np.abs(theta_m)) * (7.0 + np.abs(c2))
        assert np.all(np.abs(upright - c2) <= tolerance)
        assert np.all(np.abs(level - c1) <= oracle.K * EPS * (7.0 + np.abs(c1)))


# Special angles: (22)-(25).


@pytest.mark.parametrize("name", ["c2_parallel", "rotating_link"])
@pytest.mark.parametrize("omega_l", [0.0, 0.5, 7.0, 7.4, 7.5, 25.0, -3.0, -12.0])
def test_bottom_and_top(name: str, omega_l: float) -> None:
    """At link angle 0 and pi F_N is (23) and (22), and friction is the polynomial (24) and (25)."""
    p, emitted = paper.table_1(float), module(name)
    omega_m, sign = omega_l / p.mu, np.sign(omega_l)
    bottom = paper.polynomial_c2(None, sign, p)
    top = paper.polynomial_c2(paper.top_switch(omega_m, p), sign, p)
    force_scale = float(paper.normal_force_maximum(omega_l, p))
    torque_scale = float(np.polyval(np.abs(bottom), abs(omega_m)))

    for theta_m, force, polynomial in (
        (0.0, paper.normal_force_maximum(omega_l, p), bottom),
        (np.pi / p.mu, paper.normal_force_minimum(omega_l, p), top),
        (-np.pi / p.mu, paper.normal_force_minimum(omega_l, p), top),
    ):
        at = states(name, "normal_force", theta_m=theta_m, omega_m=omega_m, alpha_m=0.0)
        limit = oracle.K * EPS * (1 + np.pi)
        assert abs(emitted.normal_force(*at) - force) <= limit * force_scale
        assert abs(emitted.friction_torque(*at) - np.polyval(polynomial, omega_m)) <= limit * torque_scale


@pytest.mark.parametrize("mu", [1.0, 0.2, 1 / 30, 0.005])
@pytest.mark.parametrize("dtype", [np.float64, np.float32], ids=("double", "single"))
@pytest.mark.parametrize("name", SWINGING)
def test_bottom_and_top_after_many_turns(name: str, dtype: type[np.floating], mu: float) -> None:
    """After any number of half turns F_N is (23) at the bottom and (22) at the top."""
    emitted, omega_l = module(name), 5.0
    p, halves = paper.table_1(float, mu), np.arange(-2000, 2001)
    theta_m, eps = (halves * np.pi / mu).astype(dtype), float(np.finfo(dtype).eps)
    given_states = {"theta_m": theta_m, "omega_m": dtype(omega_l / mu), "alpha_m": dtype(0.0)}

    actual = emitted.normal_force(
        *(given_states[one] for one in oracle.inputs(name, "normal_force")), emitted.Parameters(mu=mu)
    )

    low, high = float(paper.normal_force_minimum(omega_l, p)), float(paper.normal_force_maximum(omega_l, p))
    expected = np.where(halves % 2, low, high)
    assert np.all(np.abs(actual - expected) <= oracle.K * eps * high * (1 + np.abs(halves) * np.pi))


# Dimensions.


@every_call
def test_scales_with_its_dimension(name: str, function: str) -> None:
    """In other units of mass, length, time and current everything is the same number in these units.

    The factors are powers of two, so that no rounding differs and the results are the same to the bit.
    """
    emitted = module(name)
    units = np.array([2.0**3, 2.0**-4, 2.0**5, 2.0**-2])

    def factor(quantity: str) -> float:
        symmetric = quantity.removesuffix("_pos").removesuffix("_neg")
        return float(np.prod(units ** np.array(DIMENSION[symmetric])))

    def scaled(values: dict[str, float]) -> Parameters:
        return parameters(name, {letter: value * factor(letter) for letter, value in values.items()})

    values = vars(paper.table_1(float)) | {"phi": 0.75 if name == "rotating_link" else 0.0} | inertia()
    values |= {one + end: values[one] for one in strategies.FRICTION for end in ("_pos", "_neg")}
    columns = dict(zip(oracle.inputs(name, function), example_states(name, function, 300), strict=True))
    f = getattr(emitted, function)

    result = f(*columns.values(), parameters(name, values))
    rescaled = f(*(x * factor(one) for one, x in columns.items()), scaled(values))

    F = float(np.prod(units ** np.array(TORQUE)))
    by_component = {
        "friction_torque_gradient": lambda: [F / factor(one) for one in emitted.GRADIENT],
        "friction_torque_with_gradient": lambda: [F, *(F / factor(one) for one in emitted.GRADIENT)],
        "friction_torque_jacobian": lambda: [F / factor(one) for one in emitted.JACOBIAN],
        "regressor": lambda: [F / factor(one) for one in emitted.REGRESSOR],
        "friction_coefficients": lambda: [factor(one) for one in emitted.REGRESSOR],
        "polynomial_neg": lambda: [F / factor("omega_m") ** k for k in (3, 2, 1, 0)],
        "polynomial": lambda: [F / factor("omega_m") ** k for k in (3, 2, 1, 0)],
    }
    expected = (
        by_component[function]() if function in by_component else np.prod(units ** np.array(RESULT[function]))
    )
    assert np.array_equal(result * np.asarray(expected), rescaled)
