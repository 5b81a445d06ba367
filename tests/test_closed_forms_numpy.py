"""The emitted NumPy modules against the paper's closed forms, with the identities among their functions."""

import dataclasses
import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests import oracle, paper, strategies
from tests.emitted import (
    PRECISIONS,
    SOME,
    SWINGING,
    every_call_in_both,
    every_model,
    labels,
    module,
    parameters,
    quick,
)

# The paper's values.


@every_call_in_both
def test_agrees_with_the_paper(name: str, function: str, dtype: type[np.floating]) -> None:
    """Every function is the paper's closed form to rounding, for any drive, even near F_N = 0."""
    derivative = function in oracle.DERIVATIVES

    @given(st.data())
    def check(data: st.DataObject) -> None:
        values = data.draw(strategies.parameters(name))
        size = 2 if derivative else 6
        points = data.draw(strategies.states(values, dtype, moving=derivative, size=size))
        arrays = strategies.arrays(points, dtype)
        given_states = [arrays[one] for one in oracle.inputs(name, function)]

        actual = getattr(module(name), function)(*given_states, parameters(name, values))

        points = points if given_states else points[:1]
        oracle.assert_agrees(actual, name, function, points, oracle.exact(values), labels(name, function))

    check()


@pytest.mark.parametrize("mu", paper.TABLE_1_POLYNOMIAL)
def test_table_1(mu: str) -> None:
    """The polynomial of C1 with the paper's parameters is Table 1, to all printed digits."""
    c1 = module("c1_perpendicular")

    actual = c1.polynomial(c1.Parameters(mu=float(paper.table_1(float, mu).mu)))

    assert [float(text) for text in paper.TABLE_1_POLYNOMIAL[mu]] == [
        float(f"{value:.4e}") for value in actual
    ]


@every_model
def test_defaults_are_table_1(name: str) -> None:
    """Without parameters the values of Table 1 hold, at mu = 1/5; the inertias have no value."""
    expected = vars(paper.table_1(float)) | {"phi": 0.0, "J_m": None, "J_l": None}
    actual = dataclasses.asdict(module(name).Parameters())

    for letter, value in actual.items():
        symmetric = letter.removesuffix("_pos").removesuffix("_neg")
        if letter != "F_T":  # its default follows from M_l and g
            assert expected[symmetric] == value, letter


@pytest.mark.parametrize("name", ["c1_perpendicular", "c1_asymmetric", "rotating_link"])
def test_transversal_force_follows_link_weight(name: str) -> None:
    """Without a value of its own F_T is M_l g: at mu C_lT F_T + C_m the drive of a level link sticks."""
    values = {"M_l": 3.0, "g": 2.0} | ({"phi": np.pi / 2} if name == "rotating_link" else {})

    still = [0.0 for _ in oracle.inputs(name, "breakaway_torque")]

    actual = module(name).breakaway_torque(*still, module(name).Parameters(**values))

    assert actual == pytest.approx(np.array([-1.0, 1.0]) * (0.2 * 0.08 * 6.0 + 0.008), rel=1e-14)


# Derivatives where mpmath's differences do not reach: standstill and the apex.


@every_model
@given(data=st.data())
def test_standstill_takes_the_one_sided_slope(name: str, data: st.DataObject) -> None:
    """At standstill friction is 0, its gradient the slope on one side of it, its Jacobian 0."""
    values = data.draw(strategies.parameters(name))
    theta_m = data.draw(strategies.signed(1e-3, 1e2))
    p, emitted = oracle.exact(values), module(name)
    state = {"theta_m": np.array(theta_m), "omega_m": np.array(0.0), "alpha_m": np.array(0.0)}
    states = [state[one] for one in oracle.inputs(name, "friction_torque")]
    still = oracle.Point(*(oracle.mpf(float(x)) for x in state.values()))

    gradient = emitted.friction_torque_gradient(*states, parameters(name, values))

    slopes = []
    for sign in (1, -1):
        load = oracle.CASES[name].normal_force(still, p)
        one, two = (
            oracle.friction_under_load(name, load, sign * w, p) for w in (oracle.mpf(1), oracle.mpf(2))
        )
        slopes.append(float(abs(two - one)))
    by_name = dict(zip(emitted.GRADIENT, gradient, strict=True))
    slope = by_name.pop("omega_m")
    assert min(abs(slope / one_sided - 1) for one_sided in slopes) <= oracle.K * np.finfo(float).eps
    assert set(by_name.values()) <= {0.0}
    assert emitted.friction_torque(*states, parameters(name, values)) == 0.0
    assert not np.any(emitted.friction_torque_jacobian(*states, parameters(name, values)))


@pytest.mark.parametrize("name", ["c2_parallel", "c2_asymmetric", "rotating_link"])
@pytest.mark.parametrize("level", [{"g": 0.0}, {"M": 0.0, "M_l": 0.0}, {"L": 0.0}], ids="+".join)
def test_degenerate_loads_have_a_gradient(name: str, level: dict[str, float]) -> None:
    """Without weight, mass or lever F_N adds no slope at standstill, where it is zero or constant."""
    p = SimpleNamespace(**vars(paper.table_1(float)) | level)
    emitted = module(name)
    states = [0.0 for _ in oracle.inputs(name, "friction_torque")]

    gradient = dict(
        zip(
            emitted.GRADIENT,
            emitted.friction_torque_gradient(*states, emitted.Parameters(**level)),
            strict=True,
        )
    )

    slope = p.mu**2 * p.B_lN * (p.M + p.M_l) * p.g + p.B_m + paper.back_emf_damping(p)
    assert gradient.pop("omega_m") == pytest.approx(slope, rel=1e-14)
    assert set(gradient.values()) == {0.0}


@pytest.mark.parametrize(
    ("name", "dtype"),
    quick(
        itertools.product(SWINGING, PRECISIONS.values()),
        {(x, PRECISIONS[SOME[x]]) for x in SWINGING},
    ),
)
def test_zero_of_the_force(name: str, dtype: type[np.floating]) -> None:
    """At (pi, w*) F_N is of rounding size, and the gradient no steeper than the cone F_N: nowhere a NaN."""
    emitted = module(name)
    p = paper.table_1(oracle.number)
    around = np.arange(-20, 21)
    theta_m = dtype(np.pi / 0.2) * (1 + around[:, None] * np.finfo(dtype).eps)
    omega_m = dtype(7.411882352007485 / 0.2) * (1 + around * np.finfo(dtype).eps)
    theta_m, omega_m = (x.astype(dtype) for x in np.broadcast_arrays(theta_m, omega_m))
    states = [theta_m, omega_m] + ([np.zeros_like(theta_m)] if oracle.CASES[name].accelerated else [])

    F_N, gradient = emitted.normal_force(*states), emitted.friction_torque_gradient(*states)

    ML_w, weight = p.M * p.L * paper.critical_velocity(p), (p.M + p.M_l) * p.g
    rounding = oracle.K * float(np.finfo(dtype).eps) * float(weight * (2 + oracle.mpmath.pi))
    distance = 21 * float(np.finfo(dtype).eps) * float(weight * (2 + oracle.mpmath.pi))
    per_load = float(p.mu**2 * p.B_lN * paper.critical_velocity(p) / p.mu + p.mu * p.C_lN)
    steepest = {"theta_m": p.mu * weight, "omega_m": 2 * p.mu * ML_w, "alpha_m": p.mu * p.M * p.L}
    base = {"omega_m": float(p.B_m + paper.back_emf_damping(p))}
    assert np.all(F_N >= 0)
    assert np.all(F_N <= rounding + distance)
    for k, one in enumerate(emitted.GRADIENT):
        limit = per_load * float(steepest[one]) * (1 + 1e-4)
        assert np.all(np.abs(gradient[..., k] - base.get(one, 0.0)) <= limit), one


# Identities of the emitted functions among themselves.


@every_model
@given(data=st.data())
def test_regressor_spans_mechanical_friction(name: str, data: st.DataObject) -> None:
    """The regressor times the coefficients is the mechanical friction torque, which has no back-EMF in it."""
    values = data.draw(strategies.parameters(name))
    arrays = strategies.arrays(data.draw(strategies.states(values, np.float64)), np.float64)
    states = [arrays[one] for one in oracle.inputs(name, "regressor")]
    given_parameters, emitted = parameters(name, values), module(name)

    f = emitted.mechanical_friction_torque(*states, given_parameters)
    actual = emitted.regressor(*states, given_parameters) @ emitted.friction_coefficients(given_parameters)

    # Terms of one sign: a sum of four products, each to a few roundings.
    assert np.all(np.abs(actual - f) <= 8 * np.finfo(float).eps * np.abs(f))


@every_model
@given(data=st.data())
def test_two_torques_differ_by_back_emf(name: str, data: st.DataObject) -> None:
    """F = f + (k_i k_e/R) w."""
    values = data.draw(strategies.parameters(name))
    arrays = strategies.arrays(data.draw(strategies.states(values, np.float64)), np.float64)
    states = [arrays[one] for one in oracle.inputs(name, "friction_torque")]
    given_parameters, emitted = parameters(name, values), module(name)

    F = emitted.friction_torque(*states, given_parameters)
    f = emitted.mechanical_friction_torque(*states, given_parameters)

    damping = values["k_i"] * values["k_e"] / values["R"]
    assert np.all(np.abs(F - (f + damping * arrays["omega_m"])) <= 8 * np.finfo(float).eps * np.abs(F))
