"""Load a derivation by name or path: a script with a module-level `model`."""

from __future__ import annotations

import os
from pathlib import Path

from eccentric.errors import InputError, meant
from eccentric.model.axis import LINEAR
from eccentric.model.exact import from_bytes, to_bytes
from eccentric.model.model import Model
from eccentric.output import derived
from eccentric.places import derivation, folder
from eccentric.scripts import asks, loads_behind, remember_loads, run_script

_BESIDE = frozenset({"serial_chain", "linear_axis", "screw_axis"})
"""Derivations that are not of the paper's drive: several joints, and a carriage."""

_loaded: dict[Path, Model] = {}
_loading: list[Path] = []


def model_names() -> tuple[str, ...]:
    """Names of the bundled derivations of the paper's drive, in alphabetical order."""
    names = (path.stem for path in folder("derivations").glob("*.py") if not path.stem.startswith("_"))
    return tuple(sorted(set(names) - _BESIDE))


def load_model(name_or_path: str | os.PathLike[str]) -> Model:
    """The model of a derivation: a name such as "c2_parallel", or the path of a script.

    A script is executed once; further calls return the same object. The models of the bundled derivations are
    kept in the user's cache until a source of the toolkit changes.

    Raises:
        InputError: there is no such derivation, scripts load each other in a circle, the script raises an
            error or has no Model named `model`.
    """
    path = _find(name_or_path)
    asks(str(name_or_path), path)
    if path in _loaded:
        return _loaded[path]
    if path in _loading:
        circle = " -> ".join(p.stem for p in [*_loading[_loading.index(path) :], path])
        raise InputError(f"{path.name}: derivations load each other in a circle: {circle}")
    bundled = path.parent == folder("derivations").resolve()
    if bundled and (kept := derived.get(f"model {path.stem}")) is not None:
        _loaded[path], loads = from_bytes(kept)
        remember_loads(loads)
        return _loaded[path]
    _loading.append(path)
    try:
        module = run_script(path, f"eccentric_derivation_{path.stem}")
    except InputError:
        raise
    except Exception as error:
        raise InputError(f"{path}: the derivation stopped with {type(error).__name__}: {error}") from error
    finally:
        _loading.pop()
    model = getattr(module, "model", None)
    if not isinstance(model, Model):
        raise InputError(
            f"{path}: a module-level `model` of type Model is required, received {type(model).__name__}"
        )
    _loaded[path] = model
    if bundled:
        derived.put(f"model {path.stem}", to_bytes((model, loads_behind(path))))
    return model


def _find(name_or_path: str | os.PathLike[str]) -> Path:
    path = derivation(name_or_path)
    if not path.is_file():
        if Path(name_or_path).suffix == ".py":
            raise InputError(f"{name_or_path}: no such derivation script")
        known = (*model_names(), LINEAR.model, LINEAR.screw)
        raise InputError(
            f"model {str(name_or_path)!r} is unknown; known are {', '.join(known)}, or a path.py"
            + meant(name_or_path, known)
        )
    return path
