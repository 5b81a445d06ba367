"""What callers of the emitted NumPy modules rely on: signatures, shapes, precision, same bits, errors."""

import ast
import dataclasses
import inspect
import itertools
import subprocess
import sys
import tracemalloc
import warnings
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from generated import eccentric_runtime
from tests import oracle, strategies
from tests.emitted import (
    every_call,
    every_call_by_turns,
    every_call_on_states,
    every_call_on_states_by_turns,
    every_model,
    example_states,
    module,
    width,
    with_inertia,
)

ROOT = Path(__file__).resolve().parent.parent


@every_call
def test_signature(name: str, function: str) -> None:
    """A function takes the inputs it depends on, then `parameters` and `out`; `alpha_m` may be left out."""
    signature = inspect.signature(getattr(module(name), function)).parameters

    assert (*oracle.inputs(name, function), "parameters", "out") == tuple(signature)
    assert signature["parameters"].default is None
    assert signature["out"].default is None
    if function in ("voltage", "current"):
        assert 0.0 == signature["alpha_m"].default


@every_model
def test_labels(name: str) -> None:
    """The constants name the columns, the coefficients and the inputs, as the paper's letters."""
    emitted, case = module(name), oracle.CASES[name]
    base = ("B_lN", "C_lN", "B_m", "C_m") if name.startswith("c2_") else ("B_lN", "C_lN", "B", "C")
    endings = ("_pos", "_neg") if case.asymmetric else ("",)

    assert {letter + ending for letter in base for ending in endings} == set(emitted.REGRESSOR)
    assert oracle.inputs(name, "friction_torque") == tuple(emitted.GRADIENT)
    assert (len(emitted.REGRESSOR),) == np.shape(emitted.friction_coefficients())
    fields = {field.name for field in dataclasses.fields(emitted.Parameters)}
    friction = {field for field in fields if field.split("_pos")[0].split("_neg")[0] in strategies.FRICTION}
    assert friction <= set(emitted.JACOBIAN) <= fields


@every_call_on_states_by_turns
def test_finite_inputs_give_numbers_and_no_warning(
    name: str, function: str, dtype: type[np.floating]
) -> None:
    """No finite input, however small or large, makes a NaN or a warning; what overflows is infinite.

    A step subtracts momenta, products of three inputs: they must not overflow.
    """

    @given(st.data())
    def check(data: st.DataObject) -> None:
        one = strategies.finite(dtype, 2.0**30 if function == "friction_step" else np.inf)
        states = [
            np.array(data.draw(st.lists(one, min_size=4, max_size=4)), dtype)
            for _ in oracle.inputs(name, function)
        ]
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            actual = getattr(module(name), function)(*states, with_inertia(name))
        assert not np.any(np.isnan(actual)), (states, actual)

    check()


@every_call_on_states_by_turns
def test_one_value_has_one_result(name: str, function: str, dtype: type[np.floating]) -> None:
    """An element has the same bits whether it comes alone, strided, transposed, broadcast or in 100,000."""
    f, p = getattr(module(name), function), with_inertia(name)
    states = example_states(name, function, 100_000, dtype)
    whole = f(*states, p)
    some = np.arange(0, 100_000, 997)

    assert dtype == whole.dtype
    for k in some:
        assert np.array_equal(whole[k], f(*(x[k] for x in states), p))
        assert np.array_equal(whole[k], f(*(x[k : k + 1] for x in states), p)[0])
    assert np.array_equal(whole[::7], f(*(x[::7] for x in states), p))
    assert np.array_equal(whole[::-3], f(*(x[::-3] for x in states), p))
    assert np.array_equal(whole[1:], f(*(x[1:] for x in states), p))
    table = f(*(x.reshape(100, 1000).T for x in states), p)
    assert np.array_equal(np.swapaxes(whole.reshape(100, 1000, *whole.shape[1:]), 0, 1), table)
    for k in (0, 5):
        wide = [states[0], *(np.broadcast_to(x[k], 100_000) for x in states[1:])]
        assert np.array_equal(f(*wide, p), f(states[0], *(x[k] for x in states[1:]), p))


@every_call_by_turns
def test_shapes_follow_broadcasting(name: str, function: str, dtype: type[np.floating]) -> None:
    """Inputs broadcast; a vector result adds its axis last; scalars give a scalar, nothing gives nothing."""
    f, p, n = getattr(module(name), function), with_inertia(name), len(oracle.inputs(name, function))
    one = width(name, function)

    assert one == np.shape(f(*(dtype(2.0) for _ in range(n)), p))
    if not n:
        return
    assert (0, *one) == f(*(np.zeros(0, dtype) for _ in range(n)), p).shape
    assert (2, 3, *one) == f(*(np.ones((2, 3), dtype) for _ in range(n)), p).shape
    mixed = [np.ones((3,) if k else (4, 1), dtype) for k in range(n)]
    result = f(*mixed, p)
    assert (np.broadcast_shapes(*(x.shape for x in mixed)) + one, dtype) == (result.shape, result.dtype)
    assert dtype == f(np.ones(3, dtype), *(1.0 for _ in range(n - 1)), p).dtype
    assert dtype == f(np.ones(3, dtype), *(1 for _ in range(n - 1)), p).dtype


@every_call_on_states
def test_whole_numbers_and_lists_are_taken_as_doubles(name: str, function: str) -> None:
    """Integers and lists are inputs like any other, in double precision."""
    f, n, p = getattr(module(name), function), len(oracle.inputs(name, function)), with_inertia(name)

    expected = f(*(np.array([1.0, 2.0]) for _ in range(n)), p)
    assert np.array_equal(expected, f(*([1, 2] for _ in range(n)), p))
    assert np.array_equal(expected[0], f(*(1 for _ in range(n)), p))
    assert np.float64 == np.asarray(f(*(1 for _ in range(n)), p)).dtype


@every_call_on_states_by_turns
def test_out_is_filled_and_returned(name: str, function: str, dtype: type[np.floating]) -> None:
    """`out` takes the result, is what is returned, may be strided, and is refused in the wrong shape."""
    f, p = getattr(module(name), function), with_inertia(name)
    states = example_states(name, function, (3, 5), dtype)
    expected = f(*states, p)
    out, strided = np.full_like(expected, np.nan), np.full((6, *expected.shape[1:]), np.nan, dtype)[::2]

    assert f(*states, p, out=out) is out
    assert np.array_equal(expected, out)
    f(*states, p, out=strided)
    assert np.array_equal(expected, strided)
    with pytest.raises(ValueError, match=r"out|shape|broadcast"):
        f(*states, p, out=np.empty((2, 2), dtype))


@every_call_on_states_by_turns
def test_out_may_be_an_input(name: str, function: str, dtype: type[np.floating]) -> None:
    """An input that lies where the result goes, or a sample beside it, is read before it is overwritten."""
    f, p, one = getattr(module(name), function), with_inertia(name), width(name, function)
    for count in (7, 1500, 2048, 50_000):
        states = example_states(name, function, count + 1, dtype)
        cases = [(0, count), (1, count)] + ([(0, 1)] if len(states) > 1 else [])
        for k, (shift, length) in itertools.product(range(len(states)), cases):
            given_states = [x[:count].copy() for x in states]
            memory = np.zeros(count * (one[0] if one else 1) + 1, dtype)
            memory[shift : shift + length] = given_states[k][:length]
            given_states[k] = memory[shift : shift + length]
            expected = f(*(x.copy() for x in given_states), p)
            out = memory[:-1].reshape(expected.shape)

            f(*given_states, p, out=out)

            assert np.array_equal(expected, out, equal_nan=True), (count, k, shift, length)


@every_call_on_states_by_turns
def test_memory_is_bounded_by_the_block(name: str, function: str, dtype: type[np.floating]) -> None:
    """With `out` a call takes as much memory for 1,000,000 elements as for 100,000."""
    f, p = getattr(module(name), function), with_inertia(name)
    taken = []
    for count in (100_000, 1_000_000):
        states = [np.resize(x, count) for x in example_states(name, function, 1000, dtype)]
        out = np.empty((count, *width(name, function)), dtype)
        f(*states, p, out=out)
        tracemalloc.start()
        f(*states, p, out=out)
        taken.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()

    assert abs(taken[1] - taken[0]) < 10_000, taken
    assert taken[1] < 64 * eccentric_runtime._BLOCK * np.dtype(dtype).itemsize, taken


@every_model
def test_parameters_are_checked(name: str) -> None:
    """What cannot be a drive is refused by name: a negative mass, a ratio of zero, a NaN, an infinity."""
    cls = module(name).Parameters
    wrong = {
        "M": (-1.0, float("nan")),
        "M_l": (-0.1,),
        "L": (-0.25,),
        "mu": (0.0, -0.2, float("inf"), 10**400, Fraction(1, 10**400)),
        "R": (0.0,),
        "k_i": (0.0,),
    }

    for letter, values in wrong.items():
        for value in values:
            with pytest.raises(ValueError, match=rf"\b{letter}\b"):
                cls(**{letter: value})
    with pytest.raises(dataclasses.FrozenInstanceError):
        cls().M = 1.0


@every_model
@pytest.mark.parametrize("function", ["voltage", "current"])
def test_acceleration_asks_for_inertia(name: str, function: str) -> None:
    """An acceleration without J_m and J_l is refused by their names; without one they are not required."""
    f, Parameters = getattr(module(name), function), module(name).Parameters
    states = [1.0 for _ in oracle.inputs(name, function)[:-1]]

    assert np.isfinite(f(*states))
    assert np.isfinite(f(*states, np.zeros(3))).all()
    for missing, kept in (("J_l", "J_m"), ("J_m", "J_l")):
        with pytest.raises(ValueError, match=missing):
            f(*states, 1.0, Parameters(**{kept: 1e-3}))
    with pytest.raises(ValueError, match=r"J_m.*J_l"):
        f(*states, np.array([0.0, 1.0]))


@every_model
def test_needs_nothing_but_numpy(name: str) -> None:
    """A module imports NumPy, its runtime and the standard library, and runs where the toolkit is absent."""
    path = ROOT / "generated" / f"{name}.py"
    tree = ast.parse(path.read_text(encoding="utf-8"))
    imported = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    imported |= {node.module or "." for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    packages = {one.split(".")[0] for one in imported}
    assert packages - set(sys.stdlib_module_names) == {"numpy", "eccentric_runtime", ""}

    program = (
        "import sys; sys.path[:] = [{folder!r}, *(p for p in sys.path if p not in ('', {root!r}))]\n"
        "for gone in ('eccentric', 'sympy', 'scipy', 'jinja2'): sys.modules[gone] = None\n"
        "import {name} as m\n"
        "print(float(m.friction_torque(*[0.5] * {n})))"
    ).format(
        root=str(ROOT), name=name, folder=str(path.parent), n=len(oracle.inputs(name, "friction_torque"))
    )
    run = subprocess.run([sys.executable, "-I", "-c", program], capture_output=True, text=True, check=False)

    states = [0.5] * len(oracle.inputs(name, "friction_torque"))
    assert ("", str(float(module(name).friction_torque(*states)))) == (run.stderr, run.stdout.strip())
