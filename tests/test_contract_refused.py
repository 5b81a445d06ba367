"""What the emitted NumPy modules take for a number, for parameters and for `out`, and what they refuse."""

import dataclasses
import re
import warnings
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from tests import oracle
from tests.emitted import every_call_on_states, every_model, module, with_inertia
from tests.refused import NO_NUMBERS, NO_PARAMETERS

REAL = {
    "float32": np.float32(0.3),
    "float16": np.float16(0.3),
    "long double": np.longdouble("0.3"),
    "fraction": Fraction(3, 10),
    "byte": np.int8(1),
    "whole": 1,
    "truth": True,
}
NOT_REAL = {
    "complex": (0.2 + 0j, "complex"),
    "complex64": (np.complex64(0.2), "complex64"),
    "text": ("0.2", "str"),
    "bytes": (b"0.2", "bytes"),
    "decimal": (Decimal("0.2"), "Decimal"),
    "none": (None, "NoneType"),
    "list": ([0.2], "list"),
    "array": (np.array([0.2, 0.3]), "ndarray"),
    "date": (np.datetime64(1, "s"), "datetime64"),
}


def inputs(name: str, function: str) -> list[str]:
    """Return the names of the inputs of a function."""
    return list(oracle.inputs(name, function))


@every_model
@pytest.mark.parametrize("kind", REAL)
def test_parameters_are_plain_floats(name: str, kind: str) -> None:
    """A real number of any type is kept as the float of its value: equal parameters, the same results."""
    emitted, value = module(name), REAL[kind]
    states = [np.linspace(-3.0, 3.0, 5) for _ in inputs(name, "friction_torque")]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        given = emitted.Parameters(mu=value)
        first = emitted.friction_torque(*states, given)
    plain = emitted.Parameters(mu=float(value))

    assert (float, float(value)) == (type(given.mu), given.mu)
    assert {float} == {type(v) for v in dataclasses.asdict(given).values() if v is not None}
    assert np.array_equal(emitted.friction_torque(*states, plain), first)
    assert np.float64 == first.dtype
    assert np.float64 is type(emitted.friction_torque(*(1.0 for _ in states), given))


@every_model
def test_minus_zero_is_zero(name: str) -> None:
    """Parameters that are equal are the same, bit by bit, since results are kept by them."""
    kept = module(name).Parameters(M=-0.0).M

    assert np.copysign(1.0, kept) == 1.0


@every_model
@pytest.mark.parametrize("kind", NOT_REAL)
def test_a_parameter_that_is_no_real_number_is_named(name: str, kind: str) -> None:
    """One line names the field, what it requires with its unit, and the type that came."""
    value, said = NOT_REAL[kind]

    with pytest.raises(TypeError, match=rf"^mu: expected a positive number \[1\], got {said}$"):
        module(name).Parameters(mu=value)
    if value is not None:
        with pytest.raises(TypeError, match=rf"^J_m: expected .* \[kg m\^2\], got {said}$"):
            module(name).Parameters(J_m=value)


@every_call_on_states
def test_an_input_that_is_no_real_number_is_named(name: str, function: str) -> None:
    """Complex numbers, texts, dates, None and other objects are refused by the name of the input."""
    f, p, names = getattr(module(name), function), with_inertia(name), inputs(name, function)
    for wrong, came in NO_NUMBERS:
        for k, asked in enumerate(names):
            for others in (1.0, np.ones(1), np.ones(1, np.float32)):
                given: list[Any] = [wrong if j == k else others for j in range(len(names))]
                with pytest.raises(TypeError, match=rf"^{asked}: expected real numbers, got {came}$"):
                    f(*given, p)


@every_call_on_states
def test_a_number_beyond_single_precision_is_refused_beside_it(name: str, function: str) -> None:
    """Rounded to infinity it would make a NaN of finite inputs; what fits, and infinity, is taken."""
    f, p, names = getattr(module(name), function), with_inertia(name), inputs(name, function)
    if len(names) < 2:
        return
    largest = float(np.finfo(np.float32).max)
    for k, asked in enumerate(names):
        for value in (1e300, -1e300, 10**50, np.nextafter(largest, np.inf).item()):
            given: list[Any] = [value if j == k else np.ones(3, np.float32) for j in range(len(names))]
            said = re.escape(f"{asked}: expected a number that float32 can hold, got {value}")
            with pytest.raises(ValueError, match=f"^{said}$"):
                f(*given, p)
        for value in (largest, -largest, float("inf"), float("nan"), 1e-300):
            given = [value if j == k else np.ones(3, np.float32) for j in range(len(names))]
            rounded = [np.float32(x) for x in given]
            with np.errstate(all="raise"):  # as who debugs sets it
                actual = f(*given, p)
            assert np.float32 == actual.dtype
            assert np.array_equal(f(*(np.broadcast_to(x, 3) for x in rounded), p), actual, equal_nan=True)


@every_call_on_states
def test_parameters_of_another_kind_are_refused(name: str, function: str) -> None:
    """A mapping, an array in the place of `parameters`, or another model's: one line says what came."""
    f, names = getattr(module(name), function), inputs(name, function)
    another = module("c1_perpendicular" if name != "c1_perpendicular" else "c2_parallel").Parameters
    for wrong in (*NO_PARAMETERS, another(), module(name).Parameters):
        kind = type(wrong)
        said = re.escape(
            f"parameters: expected Parameters of this model, got {kind.__module__}.{kind.__name__}"
        )
        for state in (1.0, np.ones(3)):
            with pytest.raises(TypeError, match=f"^{said}$"):
                f(*(state for _ in names), wrong)


@every_call_on_states
def test_out_that_is_no_array_is_refused(name: str, function: str) -> None:
    """A list or a number cannot take the result; nor can an array that cannot be written."""
    f, p, names = getattr(module(name), function), with_inertia(name), inputs(name, function)
    for wrong in ([0.0], 0.0, memoryview(bytearray(24))):
        with pytest.raises(TypeError, match=rf"^out: expected an array, got {type(wrong).__name__}$"):
            f(*(np.ones(3) for _ in names), p, out=wrong)
    for count in (1, 3, 5000):
        states = [np.ones(count) for _ in names]
        kept = np.array(f(*states, p))
        kept[...] = 7.0
        kept.flags.writeable = False
        with pytest.raises(ValueError, match="read-only"):
            f(*states, p, out=kept)
        assert np.all(kept == 7.0)
