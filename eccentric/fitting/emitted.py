"""The emitted module of a model, loaded: what is fitted and scored is what is shipped."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.emission import load_module
from eccentric.model import Model

__all__ = ["Emitted"]

Array = NDArray[np.float64]


class Emitted:
    """The functions of an emitted module, called with the inputs that they require."""

    def __init__(self, model: Model) -> None:
        self._module = load_module(model.with_other_values)
        self.letters = tuple(field.name for field in dataclasses.fields(self._module.Parameters))

    def parameters(self, values: Mapping[str, float]) -> Any:
        """Return the emitted `Parameters` with those values that the model has; others are ignored.

        Raises ValueError if the emitted class refuses a value.
        """
        return self._module.Parameters(**{k: x for k, x in values.items() if k in self.letters})

    def inputs_of(self, function: str) -> tuple[str, ...]:
        """The names of the inputs that a function takes."""
        names = inspect.signature(getattr(self._module, function)).parameters
        return tuple(name for name in names if name not in {"parameters", "out"})

    def __call__(self, function: str, inputs: Mapping[str, Array], parameters: Any) -> Array:
        """Evaluate a function on the inputs (n,) that it takes."""
        return getattr(self._module, function)(*(inputs[n] for n in self.inputs_of(function)), parameters)
