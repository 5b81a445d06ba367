"""The emitted C99, compiled in both precisions and called through cffi, against the paper and NumPy."""

import dataclasses
import math
import re
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

from tests import oracle, random_drives
from tests.compiled import GENERATED, Library, Real
from tests.emitted import (
    CALLED_ON_STATES,
    INERTIA,
    every_call_in_both,
    every_call_on_states_by_turns,
    every_model,
    every_model_in_both,
    example_states,
    module,
    with_inertia,
)
from tests.promised import given

Libraries = Callable[[str, Real], Library]


@pytest.fixture(scope="module")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> Libraries:
    """Return what compiles a model in a precision, once: none of the flags has a word about it."""
    folder = tmp_path_factory.mktemp("c99")
    return cache(lambda name, dtype: Library(name, dtype, folder))


@every_call_in_both
def test_agrees_with_numpy(libraries: Libraries, name: str, function: str, dtype: Real) -> None:
    """C and NumPy give the same bits, of any drive: both take the same correctly rounded steps in one order.

    So the closed forms and Table 1, which NumPy's results are compared with, hold for C as well. -std=c99
    keeps gcc from contracting a product and a sum into one.
    """
    library, states = libraries(name, dtype), example_states(name, function, 1000, dtype)
    random = np.random.default_rng(4)
    drives = [given(name, random_drives.drawn(random) | INERTIA) for _ in range(4)]
    for values in (with_inertia(name), *drives):
        expected = np.asarray(getattr(module(name), function)(*states, values), dtype)
        actual = library.call(function, states, library.coefficients(values))

        assert np.array_equal(expected, actual, equal_nan=True)


@every_call_on_states_by_turns
def test_arrays_are_single_calls(libraries: Libraries, name: str, function: str, dtype: Real) -> None:
    """The function of n samples gives the bits of n calls, and writes nothing for n = 0."""
    library = libraries(name, dtype)
    coefficients = library.coefficients(with_inertia(name))
    states = example_states(name, function, 300, dtype)

    many = library.many(function, states, coefficients)

    one_by_one = [library.one(function, [x[k] for x in states], coefficients) for k in range(300)]
    assert np.array_equal(np.array(one_by_one), many)
    assert 0 == library.many(function, [x[:0] for x in states], coefficients).size


@every_model_in_both
def test_default_coefficients_are_the_prepared_ones(libraries: Libraries, name: str, dtype: Real) -> None:
    """`default` is what `prepare` makes of `default_parameters`, to a rounding, and both are Table 1."""
    library = libraries(name, dtype)
    prepared = library.coefficients(module(name).Parameters())
    constant = library.coefficients()
    without_inertia = {"alpha_m", "torque", "dt"}
    default_parameters = library["default_parameters"]

    for field in dir(default_parameters):
        value = getattr(module(name).Parameters(), field)
        if value is not None:
            assert value == getattr(default_parameters, field), field
    for function in oracle.functions(name):
        taken = zip(oracle.inputs(name, function), example_states(name, function, 50, dtype), strict=True)
        states = [np.zeros_like(x) if one in without_inertia else x for one, x in taken]
        if function == "acceleration":  # at rest, without a torque: NaN all the same
            continue
        expected, actual = (library.call(function, states, c) for c in (prepared, constant))
        largest = np.max(np.abs(expected))
        assert np.all(np.abs(actual - expected) <= 4 * np.finfo(dtype).eps * largest), function


@every_model_in_both
def test_no_acceleration_asks_for_no_inertia(libraries: Libraries, name: str, dtype: Real) -> None:
    """J_m and J_l are NaN by default: no matter without an acceleration, NaN with one."""
    library = libraries(name, dtype)
    for function in ("voltage", "current"):
        states = [dtype(2.0) for _ in oracle.inputs(name, function)[:-1]]

        assert np.isfinite(library.one(function, [*states, 0.0], library.coefficients()))
        assert np.isnan(library.one(function, [*states, 1.0], library.coefficients()))


@every_model_in_both
def test_the_header_says_where_an_inertia_is_wanted(libraries: Libraries, name: str, dtype: Real) -> None:
    """Its comments say so at the functions that give NaN with the default parameters."""
    library = libraries(name, dtype)
    text = (GENERATED / f"{name}.h").read_text(encoding="utf-8")
    blocks = re.findall(rf"/\*\*((?:(?!\*/).)*)\*/\n\w+ {name}_(\w+)\(", text, re.DOTALL)
    wanted = r"NaN unless (alpha_m|torque|dt) is 0 or the parameters give J_m and J_l"
    told = {f for doc, f in blocks if re.search(wanted, doc)}
    states = {f: [1.0] * len(oracle.inputs(name, f)) for f in oracle.functions(name)}

    assert told == {f for f, s in states.items() if np.isnan(library.one(f, s, library.coefficients())).any()}


@every_model
def test_the_header_says_where_to_begin(name: str) -> None:
    """Behind its banner it names the friction torque to compensate and the normal force, and it has both."""
    text = (GENERATED / f"{name}.h").read_text(encoding="utf-8")
    (begin,) = re.findall(r"^/\* Start with (.*?)\*/", text, re.DOTALL | re.MULTILINE)
    named = [f"{name}_mechanical_friction_torque", f"{name}_normal_force"]

    assert named == re.findall(rf"{name}_\w+(?=, the friction|;)", begin)
    assert all(f"\nECCENTRIC_REAL {function}(" in text for function in named)


@every_model_in_both
def test_same_functions_as_numpy(libraries: Libraries, name: str, dtype: Real) -> None:
    """C and NumPy have the same functions, C those over arrays as well."""
    public = {one for one in module(name).__all__ if one.islower()}
    with_arrays = {f"{function}_n" for model, function in CALLED_ON_STATES if model == name}

    assert set(oracle.functions(name)) == public
    assert public | with_arrays | {"prepare"} == libraries(name, dtype).names()


@every_model
def test_no_body_is_emitted_twice(name: str) -> None:
    """Routines that compute the same, as regressor and Jacobian of case C2, share their code."""
    text = (GENERATED / f"{name}.c").read_text(encoding="utf-8")
    bodies = re.findall(
        rf"^REAL_INLINE \w+ {name}_\w+_at\([^)]*\)\n(\{{\n.*?^\}})", text, re.DOTALL | re.MULTILINE
    )

    assert bodies
    assert sorted(set(bodies)) == sorted(bodies)


@every_model_in_both
def test_prepare_numbers_the_first_invalid_parameter(libraries: Libraries, name: str, dtype: Real) -> None:
    """In the order of the structure, from 1; what NumPy's Parameters accept is 0, what they refuse is not.

    The coefficients are then all 0.
    """
    library = libraries(name, dtype)
    valid = with_inertia(name)
    fields = dataclasses.asdict(valid)
    fields |= {"F_T": valid.M_l * valid.g} if "F_T" in fields else {}
    given_values: Any = library.ffi.new(f"{name}_parameters *", fields)
    prepared = library.ffi.new(f"{name}_coefficients *")
    letters = [letter for letter, _ in library.ffi.typeof(given_values).item.fields]

    assert 0 == library["prepare"](given_values, prepared)
    for number, letter in reversed(list(enumerate(letters, start=1))):
        good = getattr(given_values, letter)
        for value in (-1.0, 0.0, 2.0, math.inf, -math.inf):
            setattr(given_values, letter, value)
            try:
                dataclasses.replace(valid, **{letter: value})
            except ValueError:
                expected = number
            else:
                expected = 0

            assert expected == library["prepare"](given_values, prepared)
            if expected:
                assert not any(bytes(library.ffi.buffer(prepared)))
        setattr(given_values, letter, good)
    given_values.mu = math.nan
    assert letters.index("mu") + 1 == library["prepare"](given_values, prepared)
