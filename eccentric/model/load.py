"""Load a derivation by name or path: a script whose module-level `model` is what the toolkit takes."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

from eccentric.errors import InputError
from eccentric.model.model import Model
from eccentric.places import folder

_loaded: dict[Path, Model] = {}
_loading: list[Path] = []


def model_names() -> tuple[str, ...]:
    """Names of the derivations that ship, in alphabetical order."""
    return tuple(
        sorted(path.stem for path in folder("derivations").glob("*.py") if not path.stem.startswith("_"))
    )


def load_model(name_or_path: str | Path) -> Model:
    """The model of a derivation: a name such as "c2_parallel", or the path of a script.

    A script is executed once; asking again gives the same object.

    Raises:
        InputError: no such derivation, a circle of scripts that load each other, an error in the script, or a
            script without a Model named `model`.
    """
    path = _find(name_or_path)
    if path in _loaded:
        return _loaded[path]
    if path in _loading:
        circle = " -> ".join(p.stem for p in [*_loading[_loading.index(path) :], path])
        raise InputError(f"{path.name}: derivations load each other in a circle: {circle}")
    module_name = f"eccentric_derivation_{path.stem}"
    spec = importlib.util.spec_from_file_location(module_name, path)
    if spec is None or spec.loader is None:
        raise InputError(f"{path}: required a Python script (.py)")
    module = importlib.util.module_from_spec(spec)
    # A dataclass under postponed annotations looks its module up while the script still runs.
    sys.modules[module_name] = module
    _loading.append(path)
    try:
        spec.loader.exec_module(module)
    except InputError:
        del sys.modules[module_name]
        raise
    except Exception as error:
        del sys.modules[module_name]
        raise InputError(f"{path}: the derivation stopped with {type(error).__name__}: {error}") from error
    finally:
        _loading.pop()
    model = getattr(module, "model", None)
    if not isinstance(model, Model):
        raise InputError(f"{path}: required a module-level `model` of type Model, got {type(model).__name__}")
    _loaded[path] = model
    return model


def _find(name_or_path: str | Path) -> Path:
    path = Path(name_or_path)
    if path.suffix == ".py":
        if not path.is_file():
            raise InputError(f"{path}: no such derivation script")
        return path.resolve()
    shipped = folder("derivations") / f"{name_or_path}.py"
    if not shipped.is_file():
        raise InputError(
            f"model {str(name_or_path)!r} is unknown; known are {', '.join(model_names())}, or a path.py"
        )
    return shipped.resolve()
