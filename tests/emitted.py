"""The emitted NumPy modules as the tests call them, with the cases that tests are parametrised by."""

import dataclasses
import importlib
import itertools
from collections.abc import Collection, Iterable, Sequence
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from tests import oracle
from tests.paper import Parameters

MODELS = tuple(oracle.CASES)
SWINGING = [name for name in MODELS if not name.startswith("c1_")]
INERTIA = {"J_m": 2e-4, "J_l": 0.04}
"""Inertias have no default."""
CALLS = [(name, function) for name in MODELS for function in oracle.functions(name)]
CALLED_ON_STATES = [(name, function) for name, function in CALLS if oracle.inputs(name, function)]
every_model = pytest.mark.parametrize("name", MODELS)
every_call = pytest.mark.parametrize(("name", "function"), CALLS, ids=map(".".join, CALLS))
every_call_on_states = pytest.mark.parametrize(
    ("name", "function"), CALLED_ON_STATES, ids=map(".".join, CALLED_ON_STATES)
)
PRECISIONS = {"double": np.float64, "single": np.float32}
both_precisions = pytest.mark.parametrize("dtype", list(PRECISIONS.values()), ids=list(PRECISIONS))
SOME = {name: list(PRECISIONS)[k % 2] for k, name in enumerate(MODELS)}
"""The precision in which `make test` has a model, by turns; the other one is for the slow tests."""
slow = pytest.mark.slow


def some_calls(
    calls: Iterable[tuple[str, str]], models: Sequence[str] = MODELS, turn: int = 0
) -> set[tuple[str, str]]:
    """Return each function of one model, the models by turns: what `make test` samples of the calls."""
    having: dict[str, list[str]] = {}
    for name, function in calls:
        if name in models:
            having.setdefault(function, []).append(name)
    return {(names[(k + turn) % len(names)], function) for k, (function, names) in enumerate(having.items())}


def in_both(
    calls: Sequence[tuple[str, str]], models: Sequence[str] = MODELS, *, by_turns: bool = False
) -> pytest.MarkDecorator:
    """Return the parameters of a test of every call in both precisions; few are quick, of these models.

    By turns, a call has one precision, and the next one of its model the other.
    """
    few, orders = some_calls(calls, models), dict.fromkeys(calls, 0)
    for name in MODELS:
        orders |= {call: k for k, call in enumerate(c for c in calls if c[0] == name)}
    return pytest.mark.parametrize(
        ("name", "function", "dtype"),
        [
            pytest.param(
                name,
                function,
                dtype,
                id=f"{name}.{function}-{precision}",
                marks=() if (name, function) in few and (by_turns or precision == SOME[name]) else slow,
            )
            for name, function in calls
            for k, (precision, dtype) in enumerate(PRECISIONS.items())
            if not by_turns or (MODELS.index(name) + orders[name, function] + k) % 2 == 0
        ],
    )


def in_one(calls: Sequence[tuple[str, str]], models: Sequence[str] = MODELS) -> pytest.MarkDecorator:
    """Return the parameters of a test of every call; each function is quick for one of these models."""
    few = some_calls(calls, models)
    return pytest.mark.parametrize(("name", "function"), quick(calls, few))


every_call_in_both = in_both(CALLS)
every_call_by_turns = in_both(CALLS, by_turns=True)
every_call_on_states_by_turns = in_both(CALLED_ON_STATES, by_turns=True)
every_model_in_both = pytest.mark.parametrize(
    ("name", "dtype"),
    [
        pytest.param(name, dtype, id=f"{name}-{precision}", marks=() if precision == SOME[name] else slow)
        for name in MODELS
        for precision, dtype in PRECISIONS.items()
    ],
)


def quick(cases: Iterable[Any], few: Collection[Any]) -> list[Any]:
    """Return the cases as parameters of a test; those that are not among the few are slow."""
    return [
        pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=() if case in few else slow)
        for case in cases
    ]


def by_turns(*axes: Iterable[Any], few: Collection[Any] = (), both: Collection[Any] = ()) -> list[Any]:
    """Return each combination in one precision, the precisions by turns, and the few, which alone are quick.

    The few end with the name of a precision; what ends with one of `both` is there in both precisions.
    """
    found = []
    for places in itertools.product(*map(enumerate, axes), enumerate(PRECISIONS)):
        turn, case = sum(k for k, _ in places), tuple(x for _, x in places)
        if case in few or case[-2] in both or turn % 2 == 0:
            marks = () if case in few else slow
            found.append(
                pytest.param(*case[:-1], PRECISIONS[case[-1]], id="-".join(map(str, case)), marks=marks)
            )
    return found


def module(name: str) -> ModuleType:
    """Return the emitted module."""
    return importlib.import_module(f"generated.{name}")


def parameters(name: str, values: dict[str, float]) -> Parameters:
    """Return the emitted Parameters with the values of those letters that the model has."""
    cls = module(name).Parameters
    return cls(**{field.name: values[field.name] for field in dataclasses.fields(cls)})


def labels(name: str, function: str) -> tuple[str, ...]:
    """Return the names of the components of a vector result, those of derivatives and columns."""
    constant = {
        "friction_torque_gradient": "GRADIENT",
        "friction_torque_jacobian": "JACOBIAN",
        "regressor": "REGRESSOR",
        "friction_coefficients": "REGRESSOR",
    }
    if function == "friction_torque_with_gradient":
        return ("friction_torque", *module(name).GRADIENT)
    return tuple(getattr(module(name), constant[function])) if function in constant else ()


def width(name: str, function: str) -> tuple[int, ...]:
    """Return the shape of one result."""
    if function.startswith("polynomial"):
        return (4,)
    if function in ("breakaway_torque", "friction_step"):
        return (2,)
    if function == "friction_budget":
        return (3,)
    return (len(labels(name, function)),) if labels(name, function) else ()


def example_states(
    name: str, function: str, shape: int | tuple[int, ...], dtype: type[np.floating] = np.float64
) -> list[np.ndarray]:
    """Return reproducible inputs of one shape for a function, every fourth velocity at standstill."""
    generator = np.random.default_rng(3)
    columns = {
        "theta_m": generator.uniform(-40.0, 40.0, shape),
        "omega_m": generator.uniform(-90.0, 90.0, shape) * (generator.integers(0, 4, shape) > 0),
        "alpha_m": generator.uniform(-200.0, 200.0, shape),
        "i": generator.uniform(-30.0, 30.0, shape),
        "u": generator.uniform(-50.0, 50.0, shape),
        "torque": generator.uniform(-1.0, 1.0, shape),
        "dt": generator.uniform(0.0, 0.01, shape),
    }
    return [np.asarray(columns[one], dtype) for one in oracle.inputs(name, function)]


def grid(name: str, function: str, count: int = 500) -> dict[str, np.ndarray]:
    """Return reproducible states by the names of the inputs."""
    return dict(zip(oracle.inputs(name, function), example_states(name, function, count), strict=True))


def with_inertia(name: str) -> Parameters:
    """Return the default parameters with inertias."""
    return module(name).Parameters(**INERTIA)
