"""The JAX back end beside the NumPy module, 50 digits, and its own derivatives."""

import ast
import dataclasses
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from mpmath import mpf

from eccentric.cli import main
from eccentric.emission.program import accuracy as stated
from eccentric.model import load_model
from tests import accelerated, accuracy, extended, oracle, promised, test_rest
from tests.compiled import Real
from tests.emitted import (
    MODELS,
    PRECISIONS,
    SWINGING,
    both_precisions,
    by_turns,
    example_states,
    module,
    quick,
    with_inertia,
)
from tests.jaxed import as_arrays, executed, jaxed
from tests.oracle import Point
from tests.random_drives import directed
from tests.test_accuracy import letters

# What `make test` compiles, of all functions and of the mapped gradient.
ALL_FUNCTIONS = {("c1_asymmetric", "single"), ("c2_parallel", "double")}
MAPPED = {("c2_asymmetric", "single"), ("c1_perpendicular", "double")}
SIZE = 40  # states: of one shape, since each is compiled for
MOST_APART = 32  # eps of the greatest value: two ways of rounding a sum of terms of either sign


@pytest.fixture(autouse=True)
def _double() -> Iterator[None]:
    with jax.enable_x64(True):
        yield


def assert_close(expected: np.ndarray, actual: jax.Array, most: float) -> None:
    """Shape and precision are the same, and values to so many eps of the greatest of a component."""
    assert (expected.shape, expected.dtype) == (actual.shape, actual.dtype)
    axes = tuple(range(expected.ndim - 1)) if expected.ndim > 1 else None
    greatest = np.max(np.abs(expected), axis=axes, initial=0.0)
    off = np.abs(np.asarray(actual, float) - expected)
    assert np.all(off <= most * np.finfo(expected.dtype).eps * greatest)


@pytest.mark.parametrize(("name", "dtype"), by_turns(MODELS, few=ALL_FUNCTIONS))
def test_every_function_is_that_of_numpy(name: str, dtype: Real) -> None:
    """Names, shapes and precisions are those of the NumPy module, values to a few roundings, in one jit."""
    assert set(jaxed(name).__all__) == set(module(name).__all__)
    given = {f: example_states(name, f, SIZE, dtype) for f in oracle.functions(name)}
    own = jaxed(name).Parameters(**vars(with_inertia(name)))
    found = jax.jit(lambda given: {f: getattr(jaxed(name), f)(*x, own) for f, x in given.items()})(given)
    for function, x in given.items():
        expected = np.asarray(getattr(module(name), function)(*x, with_inertia(name)))
        # Without inputs the precision is that of the parameters.
        assert_close(expected if x else expected.astype(float), found[function], MOST_APART)


@pytest.mark.parametrize(
    ("name", "traced", "dtype"),
    quick(
        [
            (*one, dtype)
            for one in (("c1_perpendicular", False), ("c2_parallel", False), ("c2_parallel", True))
            for dtype in PRECISIONS.values()
        ],
        {("c1_perpendicular", False, np.float32), ("c2_parallel", True, np.float64)},
    ),
)
def test_bounds_of_the_header(name: str, traced: bool, dtype: Real, monkeypatch: pytest.MonkeyPatch) -> None:
    """The bounds that headers state hold at 50 digits, also where JAX computes what parameters give."""
    functions = as_arrays(name, traced=traced)
    monkeypatch.setattr(promised, "module", lambda _: functions)
    values = letters("much unbalance")
    for at in accuracy.sets(oracle.exact(values), dtype, SIZE):
        for function, worst in promised.errors(name, at, values).items():
            assert worst <= promised.bounds(name)[function].anywhere, (function, at.name)


@pytest.mark.parametrize("dtype", quick((np.float64, np.float32), {np.float32}))
def test_bounds_with_an_acceleration(dtype: Real, monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside the curve on which F_N vanishes the bounds of `rotating_link` hold."""
    name, values = accelerated.NAME, letters("mu = 3") | {"phi": 0.75}
    functions, p = as_arrays(name, traced=False), oracle.exact(values)
    monkeypatch.setattr(promised, "module", lambda _: functions)
    at, alpha_m = accelerated.near_no_load(p, dtype, SIZE)
    for function, worst in promised.link_errors(
        at, alpha_m, values, accelerated.exact(at, alpha_m, p)
    ).items():
        assert worst <= promised.bounds(name)[function].anywhere, function


@both_precisions
def test_compiled_in_a_program_with_its_parameters_it_keeps_its_digits(dtype: Real) -> None:
    """XLA reorders sums of constants; parameters that a jitted function closes over lose no digits by it."""
    p = oracle.exact(letters("mu = 1/5"))
    at = accuracy.beside_the_tops(p, dtype)
    given = promised.given("c2_parallel", letters("mu = 1/5"))
    own = jaxed("c2_parallel").Parameters(**vars(given))
    actual = jax.jit(lambda *x: jaxed("c2_parallel").normal_force(*x, own))(at.theta_m, at.omega_m)
    worst = np.max(accuracy.units(np.asarray(actual), accuracy.normal_force("c2_parallel", at, p)))

    assert worst <= stated.NORMAL_FORCE.anywhere


@pytest.mark.parametrize(("name", "dtype"), by_turns(MODELS, few=MAPPED))
def test_jit_vmap_and_grad(name: str, dtype: Real) -> None:
    """One sample, differentiated, mapped and compiled, gives the emitted gradient of the NumPy module."""
    given = example_states(name, "friction_torque", 100, dtype)
    by = tuple(range(len(given)))
    slopes = jax.jit(jax.vmap(jax.grad(jaxed(name).friction_torque, by)))(*given)
    expected = module(name).friction_torque_gradient(*given)

    assert_close(expected, jnp.stack(slopes, -1), promised.bounds(name)["friction_torque_gradient"].anywhere)


@pytest.mark.parametrize("name", quick(MODELS, {"c1_asymmetric"}))
def test_derivatives_by_parameters(name: str) -> None:
    """By friction coefficients they are the emitted Jacobian, by all others those of the closed forms."""
    values = directed({k: float(x) for k, x in vars(accuracy.decimals()).items()} | {"phi": 0.4}, 1.25)
    given = [x[1:4] for x in example_states(name, "friction_torque", 6)]
    columns = module(name).friction_torque_jacobian(*given, promised.given(name, values)).sum(0)
    jacobian = dict(zip(module(name).JACOBIAN, columns, strict=True))
    parameters = jaxed(name).Parameters(**vars(promised.given(name, values)))
    slopes = jax.grad(lambda p: jaxed(name).friction_torque(*given, p).sum())(parameters)
    inputs, p = oracle.inputs(name, "friction_torque"), oracle.exact(values)
    states = [dict(zip(inputs, map(mpf, row), strict=True)) for row in np.transpose(given).tolist()]
    at = [Point(mpf(0), mpf(0), mpf(0))._replace(**state) for state in states]
    for letter, actual in vars(slopes).items():
        if letter in jacobian:
            assert jacobian[letter] == pytest.approx(float(actual), rel=1e-13, abs=1e-15), letter
        elif actual is not None:
            found = [oracle.derivative(name, x, p, letter) for x in at]
            most = oracle.K * np.finfo(float).eps * sum(scale + abs(value) for value, scale in found)
            assert abs(float(actual) - sum(value for value, _ in found)) <= most, letter


def test_at_the_apex_the_slopes_of_the_load_are_taken_as_0() -> None:
    """Without gravity F_N is 0 at rest; there, and as near to the apex as doubles come, slopes are finite."""
    m = jaxed("c2_parallel")
    slopes = jax.grad(m.normal_force, (0, 1))
    assert (0.0, 0.0) == slopes(1.0, 0.0, m.Parameters(g=0.0))
    top = np.pi / 0.2, np.sqrt(9.81 * 0.7 / 0.125) / 0.2
    assert m.normal_force(*top) < 1e-13

    by_theta, by_omega = slopes(*top)
    # A cone: its slopes along theta_m and omega_m, mu (M + M_l) g and 2 M L mu^2 omega_m, times cosines.
    cosines = by_theta / (0.2 * 0.7 * 9.81), by_omega / (2 * 0.125 * 0.2**2 * top[1])
    assert 1.0 == pytest.approx(np.hypot(*cosines), rel=1e-12)
    second = jax.hessian(m.friction_torque, (0, 1))
    of_emitted = jax.jacrev(m.friction_torque_gradient, (0, 1))
    for state in (top, (1.0, 0.0)):
        for parameters in (m.Parameters(), m.Parameters(g=0.0), m.Parameters(M=0.0)):
            assert np.all(np.isfinite(second(*state, parameters)))
            assert np.all(np.isfinite(of_emitted(*state, parameters)))


@pytest.mark.parametrize("name", quick(SWINGING, {"c2_parallel"}))
def test_derivatives_by_parameters_without_gravity(name: str) -> None:
    """Without gravity F_N is M L mu^2 sqrt(w^4 + (a/mu)^2); by g its derivative is taken as 0."""
    m, at = jaxed(name), {"theta_m": 1.3, "omega_m": 20.0, "alpha_m": 3.0}
    given = [at[x] for x in oracle.inputs(name, "normal_force")]
    slopes = jax.grad(lambda p: m.normal_force(*given, p))(m.Parameters(g=0.0))
    a = at["alpha_m"] if len(given) == 3 else 0.0
    force = 0.125 * np.hypot(0.2**2 * 400, 0.2 * a)
    expected = {
        "M": force / 0.5,
        "L": force / 0.25,
        "M_l": 0.0,
        "g": 0.0,
        "mu": 0.125**2 * (4 * 0.2**3 * 400**2 + 2 * 0.2 * a**2) / (2 * force),
    }

    assert expected == pytest.approx({letter: float(getattr(slopes, letter)) for letter in expected})
    assert all(np.isfinite(slope) for slope in jax.tree.leaves(slopes))


def test_by_an_acceleration_of_0_the_voltage_has_its_slope() -> None:
    """The voltage is linear in alpha_m: its slope is (R/k_i) (J_m + mu^2 J_l), also at 0."""
    m = jaxed("c1_perpendicular")
    slope = jax.grad(m.voltage, 1)(10.0, 0.0, m.Parameters(J_m=2e-4, J_l=0.04))

    assert 1.0 / 0.02 * (2e-4 + 0.2**2 * 0.04) == pytest.approx(float(slope))


def test_hidden_states() -> None:
    """With effects and hidden states all is that of the NumPy module, and has finite derivatives."""
    one, given = extended.with_effect("C1", "backlash"), extended.inputs()
    m = executed(one.model)
    chosen = {q.name: 0.1 for e in one.effects for q in e.coefficients}
    chosen |= {name: x for name, x in extended.KNOWN.items() if hasattr(m.Parameters, name)}
    parameters = m.Parameters(**chosen)
    for function in ("mechanical_residual", "next_state"):
        states = [given[name] for name in extended.arguments(m, function)]
        expected = extended.call(one.module, function, given, **chosen)
        assert_close(expected, getattr(m, function)(*states, parameters), MOST_APART)
    by = tuple(range(len(states)))
    slopes = jax.vmap(jax.jacfwd(m.next_state, by), (0,) * len(by) + (None,))(*states, parameters)
    assert all(np.all(np.isfinite(slope)) for slope in slopes)
    log = [given[name] for name in extended.arguments(m, "follow_states")]
    expected = one.module.follow_states(*log, one.module.Parameters(**chosen))

    assert one.module.STATES == m.STATES
    np.testing.assert_allclose(m.follow_states(*log, parameters), expected, 1e-12, 1e-14)


def test_parameters_are_a_tree() -> None:
    """One differentiates by parameters, here M L (mu omega_m)^2, maps over them, and makes them arrays."""
    m, at = jaxed("c1_perpendicular"), 20.0
    slopes = jax.grad(lambda p: m.normal_force(at, p))(m.Parameters())
    found = [float(getattr(slopes, letter)) for letter in ("M", "L", "mu", "g")]
    assert (4.0, 8.0, 20.0, 0.0) == pytest.approx(found)
    values = np.array([0.001, 0.004, 0.016])
    one_by_one = [m.friction_torque(at, m.Parameters(B_lN=b)) for b in values.tolist()]
    mapped = jax.vmap(lambda b: m.friction_torque(at, dataclasses.replace(m.Parameters(), B_lN=b)))(values)

    np.testing.assert_allclose(one_by_one, mapped, 1e-15)
    np.testing.assert_allclose(one_by_one, m.friction_torque(at, m.Parameters(B_lN=values)), 1e-15)


def test_what_is_refused() -> None:
    """An acceleration without inertias, parameters of another module, and what is no real number."""
    m = jaxed("c2_parallel")
    with pytest.raises(ValueError, match=r"^J_m, J_l: expected numbers unless alpha_m is 0, got None$"):
        m.voltage(0.0, 1.0, 2.0)
    with pytest.raises(TypeError, match=r"^parameters: expected Parameters of this module, got dict$"):
        m.normal_force(0.0, 1.0, {"M": 1.0})
    with pytest.raises(TypeError, match=r"^inputs: expected real numbers, got complex"):
        m.normal_force(0.0, 1j)


def test_motor_constants_that_are_not_given() -> None:
    """A carriage has none by default: B v + C is known, k_f k_e/R v only with them, and slopes are finite."""
    m = executed(load_model("linear_axis"))
    rubbing = m.Parameters(B=2.0, C=3.0)
    driven = dataclasses.replace(rubbing, R=4.0, k_f=5.0, k_e=6.0)
    slopes = jax.grad(lambda p: m.mechanical_friction_force(0.5, p))(rubbing)

    assert 4.0 == m.mechanical_friction_force(0.5, rubbing)
    assert np.isnan(m.friction_force(0.5, rubbing))
    assert 4.0 + 5.0 * 6.0 / 4.0 * 0.5 == m.friction_force(0.5, driven)
    assert (0.5, 1.0) == (slopes.B, slopes.C)
    assert all(np.isfinite(slope) for slope in jax.tree.leaves(slopes))


def test_a_loss_beyond_the_inertia_is_an_error_and_nan_for_arrays() -> None:
    """An error at the call, also while tracing; of several drives, those with one solution keep it."""
    lossy = executed(test_rest.lossy())
    inertia = {"J_m": test_rest.J_M, "J_l": test_rest.J_L}
    below, above = test_rest.beside_the_bound(*test_rest.LOSSES[3])
    with pytest.raises(ValueError, match=r"^gear_eta: expected acceleration-dependent friction"):
        jax.jit(
            lambda torque: lossy.acceleration(0.3, 0.0, 0.0, torque, lossy.Parameters(**above, **inertia))
        )(0.1)

    drives = lossy.Parameters(**{name: np.array([below[name], above[name]]) for name in below}, **inertia)
    found = lossy.acceleration(np.full((3, 1), 0.3), 0.0, 0.0, 0.1, drives)
    assert np.array_equal(np.isnan(found), [[False, True]] * 3)
    step = lossy.friction_step(0.3, 0.0, 0.0, 0.1, 1e-3, drives)
    assert np.array_equal(np.isnan(step), [[False] * 2, [True] * 2])
    assert np.isfinite(lossy.mechanical_friction_torque(0.3, 1.0, 0.0, drives)).all()


def test_it_runs_where_only_jax_is_installed(tmp_path: Path) -> None:
    """One file, which imports JAX, NumPy and the standard library; there JAX computes in float32."""
    assert 0 == main(["emit", "c2_parallel", "--backend", "jax", "--out", str(tmp_path / "out")])
    (file,) = (tmp_path / "out").glob("*.py")
    assert "c2_parallel_jax.py" == file.name
    text = file.read_text(encoding="utf-8")
    assert [line for line in text.splitlines() if len(line) > 110] == []
    imported = {n.module or "" for n in ast.walk(ast.parse(text)) if isinstance(n, ast.ImportFrom)}
    imported |= {a.name for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Import) for a in n.names}
    assert {one.split(".")[0] for one in imported} - {"jax", "numpy"} <= sys.stdlib_module_names
    program = (
        "import sys; sys.modules.update(eccentric=None, sympy=None)\n"
        "import c2_parallel_jax as m\n"
        "found = [m.normal_force(x, 37.0) for x in (0.5, 15.7, 9999.0)]\n"
        "print([float(x) for x in found], found[0].dtype)"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], cwd=file.parent, capture_output=True, text=True, check=True
    )
    shown, dtype = run.stdout.strip().rsplit(" ", 1)
    expected = module("c2_parallel").normal_force(np.array([0.5, 15.7, 9999.0], np.float32), np.float32(37.0))

    assert "float32" == dtype
    np.testing.assert_array_max_ulp(np.array(ast.literal_eval(shown), np.float32), expected, 4)


def test_a_divisor_of_zero_is_one_in_a_branch_that_is_not_taken() -> None:
    """Only zeros are replaced, of JAX and of NumPy."""
    given, expected = [0.0, -0.0, 3.0, -1e-300], [1.0, 1.0, 3.0, -1e-300]
    for array in (jnp.asarray, np.array):
        assert expected == jaxed("c2_parallel")._nonzero(array(given)).tolist()
