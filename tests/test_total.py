"""NaN in gives NaN out, whatever else comes in; that any bits do no harm is in the sanitized self-test."""

import itertools

import numpy as np
import pytest

from tests import oracle
from tests.emitted import CALLED_ON_STATES, both_precisions, module, width, with_inertia

SCALARS = [(name, function) for name, function in CALLED_ON_STATES if not width(name, function)]


@both_precisions
@pytest.mark.parametrize(("name", "function"), SCALARS, ids=map(".".join, SCALARS))
def test_nan_in_gives_nan_out(name: str, function: str, dtype: type[np.floating]) -> None:
    """A NaN in any input is in the result, whatever bits the other inputs have."""
    generator = np.random.default_rng(11)
    word = np.uint32 if dtype is np.float32 else np.uint64
    inputs = oracle.inputs(name, function)
    for k in range(len(inputs)):
        states = [generator.integers(0, np.iinfo(word).max, 5000, word).view(dtype) for _ in inputs]
        states[k] = np.full(5000, np.nan, dtype)

        result = getattr(module(name), function)(*states, with_inertia(name))

        assert np.all(np.isnan(result)), inputs[k]


VECTORS = [pair for pair in CALLED_ON_STATES if pair not in SCALARS]
PLAIN = (0.0, -0.0, 1.0, -2.5, 1e3)


@both_precisions
@pytest.mark.parametrize(("name", "function"), VECTORS, ids=map(".".join, VECTORS))
def test_nan_is_told_at_standstill_too(name: str, function: str, dtype: type[np.floating]) -> None:
    """A NaN in any input is in some element of the result, whatever the direction of motion.

    But not in a step without time, which takes no torque.
    """
    inputs = oracle.inputs(name, function)
    for k in range(len(inputs)):
        states = np.array(list(itertools.product(PLAIN, repeat=len(inputs))), dtype).T
        states[k] = np.nan
        states = states[:, ~(states[inputs.index("dt")] <= 0.0)] if "dt" in inputs else states

        result = getattr(module(name), function)(*states, with_inertia(name))

        assert np.all(np.any(np.isnan(result), axis=-1)), inputs[k]
