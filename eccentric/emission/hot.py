"""Load the emitted NumPy module of a model without writing it: the fit runs the code that is shipped."""

from __future__ import annotations

import json
import sys
import zlib
from types import ModuleType

from eccentric.emission.executed import executed
from eccentric.emission.render import render_code
from eccentric.model import Model, fingerprint
from eccentric.output import derived

_KEPT = 32
# By identity: a model is immutable, and rendering takes half a second. It is kept, so its id stays unique.
_by_model: dict[int, tuple[Model, ModuleType]] = {}


def load_module(model: Model) -> ModuleType:
    """The emitted NumPy module of the model, executed from memory; the last 32 are kept.

    Raises:
        InputError: the model cannot be emitted.
    """
    if id(model) not in _by_model:
        module = executed(_files(model), model.name)
        if len(_by_model) >= _KEPT:
            _, oldest = _by_model.pop(next(iter(_by_model)))
            del sys.modules[oldest.__name__]
        _by_model[id(model)] = (model, module)
    return _by_model[id(model)][1]


def _files(model: Model) -> dict[str, str]:
    """The files of the module; those of a model without effects are in the user's cache."""
    try:
        key = "" if model.extensions else f"module {fingerprint(model)}"
    except TypeError:  # it has what only its author's script can say
        key = ""
    if not key:  # an extended model has values of one log
        return render_code(model, "numpy")
    if (kept := derived.get(key)) is not None:
        return json.loads(zlib.decompress(kept))
    files = render_code(model, "numpy")
    derived.put(key, zlib.compress(json.dumps(files).encode()))
    return files
