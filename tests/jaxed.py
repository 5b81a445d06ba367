"""Emitted JAX modules as the tests call them, executed from memory."""

import sys
from collections.abc import Callable
from functools import cache
from types import ModuleType, SimpleNamespace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from eccentric.emission import render
from eccentric.model import Model, load_model
from tests.random_drives import FUNCTIONS


def executed(model: Model) -> ModuleType:
    """Return the emitted JAX module of a model."""
    module = ModuleType(f"{model.name}_jax")
    text = render(model, backends=("jax",))[f"{module.__name__}.py"]
    sys.modules[module.__name__] = module  # a dataclass looks its module up
    exec(compile(text, f"<{module.__name__}.py as emitted>", "exec"), module.__dict__)  # noqa: S102
    return module


@cache
def jaxed(name: str) -> ModuleType:
    """Return the emitted JAX module of a model of the paper."""
    return executed(load_model(name))


def as_arrays(name: str, *, traced: bool) -> SimpleNamespace:
    """Return the module with results as NumPy's arrays; if traced, parameters are arrays of JAX."""
    module = jaxed(name)

    def called(function: Callable[..., Any]) -> Callable[..., np.ndarray]:
        def call(*given: Any) -> np.ndarray:
            *inputs, parameters = given
            return np.asarray(
                function(*inputs, jax.tree.map(jnp.asarray, parameters) if traced else parameters)
            )

        return call

    functions = {function: called(getattr(module, function)) for function in FUNCTIONS}
    constants = {name: getattr(module, name) for name in ("Parameters", "GRADIENT", "JACOBIAN", "REGRESSOR")}
    return SimpleNamespace(**functions, **constants)
