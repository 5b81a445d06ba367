"""Limits and special angles of the emitted models; the paper's closed forms as limits of each other."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy

from tests import oracle, paper, strategies
from tests.emitted import SWINGING, every_model, grid, module

EPS = float(np.finfo(float).eps)
LETTERS = "M M_l L g mu R k_i k_e F_T B_lN C_lN B_lT C_lT B_m C_m"


def states(name: str, function: str, **columns: object) -> list[np.ndarray]:
    """Return the columns that a function takes, in its order."""
    return [np.asarray(columns[one], float) for one in oracle.inputs(name, function)]


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
