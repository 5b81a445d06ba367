"""Load the emitted NumPy module of a model without writing it: the fit runs what is shipped."""

from __future__ import annotations

import sys
from types import ModuleType

from eccentric.emit.render import render
from eccentric.model import Model

_loaded: dict[str, ModuleType] = {}
# By identity: a model is immutable, and rendering one takes half a second. The model is kept, so its id stays its own.
_by_model: dict[int, tuple[Model, ModuleType]] = {}


def load_module(model: Model) -> ModuleType:
    """The emitted NumPy module of the model, executed from memory; the same text gives the same module."""
    if id(model) in _by_model:
        return _by_model[id(model)][1]
    source = render(model)[f"{model.name}.py"]
    if source not in _loaded:
        name = f"eccentric_emitted_{model.name}_{len(_loaded)}"
        module = ModuleType(name)
        # A dataclass under postponed annotations looks its module up while it is made.
        sys.modules[name] = module
        exec(compile(source, f"<{model.name}.py as emitted>", "exec"), module.__dict__)  # noqa: S102
        _loaded[source] = module
    _by_model[id(model)] = (model, _loaded[source])
    return _loaded[source]
