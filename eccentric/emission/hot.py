"""Load the emitted NumPy module of a model without writing it: the fit runs what is shipped."""

from __future__ import annotations

import sys
from itertools import count
from types import ModuleType

from eccentric.emission.render import render
from eccentric.model import Model

_KEPT = 32
_numbers = count()
# By identity: a model is immutable, and rendering takes half a second. It is kept, so its id stays its own.
_by_model: dict[int, tuple[Model, ModuleType]] = {}


def load_module(model: Model) -> ModuleType:
    """The emitted NumPy module of the model, executed from memory; the last 32 are kept.

    Raises:
        InputError: the model cannot be emitted.
    """
    if id(model) not in _by_model:
        module = _executed(model)
        if len(_by_model) >= _KEPT:
            _, oldest = _by_model.pop(next(iter(_by_model)))
            del sys.modules[oldest.__name__]
        _by_model[id(model)] = (model, module)
    return _by_model[id(model)][1]


def _executed(model: Model) -> ModuleType:
    module = ModuleType(f"eccentric_emitted_{model.name}_{next(_numbers)}")
    # A dataclass under postponed annotations looks its module up while it is made.
    sys.modules[module.__name__] = module
    source = render(model, backends=("numpy",))[f"{model.name}.py"]
    exec(compile(source, f"<{model.name}.py as emitted>", "exec"), module.__dict__)  # noqa: S102
    return module
