"""Load the emitted NumPy module of a model without writing it: the fit runs the code that is shipped."""

from __future__ import annotations

import inspect
import math
import sys
from collections.abc import Mapping
from functools import cache
from itertools import count
from types import ModuleType
from typing import Any

import numpy as np

from eccentric.emission.render import render_code
from eccentric.model import AxisKind, Model, Quantity, cached, spoken_quantity

_PACKAGE, _RUNTIME = "eccentric_emitted", "eccentric_runtime"
_numbers = count()


def executed(files: Mapping[str, str], name: str) -> ModuleType:
    """A new module from the emitted file of that name, with the runtime emitted beside it."""
    _package(files[f"{_RUNTIME}.py"])
    return _run(f"{_PACKAGE}.{name}_{next(_numbers)}", files[f"{name}.py"])


def executed_beside(module: ModuleType, name: str, source: str) -> ModuleType:
    """A new module from emitted source that imports `name`, such an executed module, from beside it."""
    package = sys.modules[_PACKAGE]
    setattr(package, name, module)
    try:
        return _run(f"{_PACKAGE}.{name}_beside_{next(_numbers)}", source)
    finally:
        delattr(package, name)


@cache
def _package(runtime: str) -> None:
    """Make the package of the modules, with the one runtime that this toolkit emits."""
    package = ModuleType(_PACKAGE)
    package.__path__ = []
    sys.modules[_PACKAGE] = package
    vars(package)[_RUNTIME] = _run(f"{_PACKAGE}.{_RUNTIME}", runtime)


def _run(name: str, source: str) -> ModuleType:
    module = ModuleType(name)
    module.__package__ = _PACKAGE
    # A dataclass with postponed annotations looks its module up during its definition.
    sys.modules[name] = module
    exec(compile(source, f"<{name}.py as emitted>", "exec"), module.__dict__)  # noqa: S102
    return module


_KEPT = 32
# By identity: a model is immutable, and rendering takes half a second. It is kept, so its id stays unique.
_by_model: dict[int, tuple[Model, ModuleType]] = {}


def load_module(model: Model) -> ModuleType:
    """The emitted NumPy module of the model, executed from memory; the last 32 are kept.

    Raises:
        InputError: the model cannot be emitted.
    """
    if id(model) not in _by_model:
        files = cached("module", model, lambda: render_code(model, "numpy"))
        module = executed(files, model.name)
        if len(_by_model) >= _KEPT:
            _, oldest = _by_model.pop(next(iter(_by_model)))
            del sys.modules[oldest.__name__]
        _by_model[id(model)] = (model, module)
    return _by_model[id(model)][1]


def inputs_of(function: Any) -> tuple[str, ...]:
    """The names of the inputs of an emitted function."""
    return tuple(x for x in inspect.signature(function).parameters if x not in {"parameters", "out"})


def evaluated(function: Any, axis: AxisKind, states: Mapping[Quantity, np.ndarray]) -> np.ndarray:
    """An emitted function at states of one shape, of the letters of a turning axis; other inputs are 0."""
    known = {spoken_quantity(axis, q).name: x for q, x in states.items()}
    zero = np.zeros_like(next(iter(states.values())))
    return np.asarray(function(*(known.get(name, zero) for name in inputs_of(function))))


def turn_of_link(model: Model, count: int) -> np.ndarray:
    """That many motor angles over a turn of the link [rad] (count,)."""
    return np.linspace(0.0, 2.0 * math.pi / link_over_motor(model), count, endpoint=False)


def link_over_motor(model: Model) -> float:
    """The value of the gear ratio mu; 1 for a model without one."""
    return next((float(q.default) for q in model.parameters if q.name == "mu" and q.default is not None), 1.0)
