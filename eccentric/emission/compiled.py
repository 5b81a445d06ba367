"""The emitted C of a model, built by the local compiler and called from Python as the NumPy module is."""

# ruff: noqa: SLF001 - the module is emission's own

from __future__ import annotations

import ctypes
import inspect
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from eccentric.emission.hot import load_module
from eccentric.emission.local_compiler import SHIM, built, python_headers
from eccentric.emission.program import Program, Routine, build_program
from eccentric.emission.render import python_source, render
from eccentric.model import Model, load_model

_REALS: dict[Any, tuple[str, Any]] = {
    np.float32: ("float", ctypes.c_float),
    np.float64: ("double", ctypes.c_double),
}


def compile(model: Model | str | Path) -> ModuleType:  # noqa: A001 - it is called as eccentric.compile
    """A module like the emitted NumPy module of the model, its functions being those of the emitted C.

    The model may be given as `load_model` takes it: its name ("c2_parallel"), or the path of a derivation.

    Arguments, broadcasting, precision, `out` and bits are those of the NumPy module; where an exponential
    stands, the bits of the two libraries may differ. Floats give a float. The library is kept in the user's
    cache under what it was built from: $XDG_CACHE_HOME or ~/.cache, folder eccentric.

    Raises:
        TypeError: this is neither a model nor a name or path.
        InputError: there is no such model, there is no C compiler, or not the one that CC names; it does not
            compile, its cache cannot be written, or the model cannot be emitted.
    """
    if isinstance(model, str | Path):
        model = load_model(model)
    if not isinstance(model, Model):
        raise TypeError(f"compile: required a Model, its name or path, got {type(model).__name__}")
    program, source, files = build_program(model), load_module(model), render(model)
    module = ModuleType(f"eccentric_compiled_{model.name}", source.__doc__)
    for name in (name for name in dir(source) if not name.startswith("_")):
        setattr(module, name, getattr(source, name))
    libraries = {real: ctypes.CDLL(str(built(program.name, files, of))) for real, (of, _) in _REALS.items()}
    compiled = _Compiled(program, source, libraries)
    for routine in program.routines:
        if hasattr(source, routine.name):
            setattr(module, routine.name, compiled.function(routine))
    plain = [r for r in program.routines if hasattr(source, r.name) and _is_plain(r)]
    if plain and python_headers():
        shim = built(program.name, files | {SHIM: python_source(program.name, plain)}, "double")
        for name, function in _direct(shim, plain, compiled, module):
            setattr(module, name, function)
    return module


def _is_plain(r: Routine) -> bool:
    """Whether it takes numbers and gives one, with nothing to check before."""
    return bool(r.inputs) and not r.labels and not r.requires and all(x.length is None for x in r.inputs)


def _direct(
    shim: Path, plain: list[Routine], compiled: _Compiled, module: ModuleType
) -> list[tuple[str, Callable[..., Any]]]:
    """Functions that take floats without a detour through ctypes, which costs more than the model."""
    library = ctypes.PyDLL(str(shim))
    library.python_set.argtypes = [ctypes.c_void_p]
    library.python_set(compiled.prepared(None, np.float64).ctypes.data)
    library.python_function.argtypes = [ctypes.c_int, ctypes.py_object]
    library.python_function.restype = ctypes.py_object
    return [(r.name, library.python_function(k, getattr(module, r.name))) for k, r in enumerate(plain)]


class _Compiled:
    """The libraries of one program, by precision, and its parameters as they take them."""

    def __init__(self, program: Program, source: ModuleType, libraries: dict[Any, ctypes.CDLL]) -> None:
        self.program, self.source, self.libraries = program, source, libraries
        self.prepared = lru_cache(maxsize=64)(self._prepared)

    def _prepared(self, parameters: Any, real: Any) -> np.ndarray:
        numbers = self.source._prepare(parameters, real).numbers
        held = self.program.held(single=real is np.float32)
        return np.array([getattr(numbers, s.name) for s in held] or [0.0], real)

    def function(self, routine: Routine) -> Callable[..., Any]:
        """The function of one routine, on arrays."""
        like = getattr(self.source, routine.name)
        signature = inspect.signature(like)
        entries = {real: self._entry(routine, real) for real in _REALS}
        names = [x.quantity.name for x in routine.inputs]
        lengths, width = [x.length for x in routine.inputs], len(routine.labels)

        def function(*given: Any, **named: Any) -> Any:
            bound = signature.bind(*given, **named)
            bound.apply_defaults()
            *inputs, parameters, out = bound.arguments.values()
            if parameters is not None:
                self.source._check_kind(type(parameters))
            if routine.requires:
                self.source._require(routine.requires, inputs[-1], parameters)
            arrays, real = self.source._arrays(inputs, names) if lengths else ([], np.float64)
            arrays, shape = _broadcast(arrays, lengths)
            full = (*shape, width) if width else shape
            if out is not None:
                self.source._check_out(out, full, real)
            apart = out is not None and not any(np.may_share_memory(x, out) for x in arrays)
            result = out if out is not None and apart and out.flags.carray else np.empty(full, real)
            c = self.prepared(parameters, real).ctypes.data
            if lengths:
                entries[real](int(np.prod(shape)), *(x.ctypes.data for x in arrays), result.ctypes.data, c)
            elif width:
                entries[real](result.ctypes.data, c)
            else:
                result[...] = entries[real](c)
            if out is not None and result is not out:
                out[...] = result
            return result[()] if out is None else out

        function.__name__ = function.__qualname__ = routine.name
        function.__doc__ = like.__doc__
        function.__signature__ = signature  # type: ignore[attr-defined]
        return function

    def _entry(self, routine: Routine, real: Any) -> Any:
        """The array version, or where nothing is sampled the function itself."""
        ending = "_n" if routine.inputs else ""
        name = f"{self.program.name}_{routine.name}{ending}_{_REALS[real][0]}"
        entry = getattr(self.libraries[real], name)
        pointers = [ctypes.c_void_p] * (len(routine.inputs) + 1)
        if routine.inputs:
            entry.argtypes = [ctypes.c_size_t, *pointers, ctypes.c_void_p]
        else:
            entry.argtypes = [ctypes.c_void_p] * (2 if routine.labels else 1)
        entry.restype = None if routine.inputs or routine.labels else _REALS[real][1]
        return entry


def _broadcast(
    arrays: list[np.ndarray], lengths: list[int | None]
) -> tuple[list[np.ndarray], tuple[int, ...]]:
    """The inputs as C takes them, all of one shape, and that shape; a vector input keeps its last axis."""
    shapes = [x.shape if n is None else x.shape[:-1] for x, n in zip(arrays, lengths, strict=True)]
    shape = np.broadcast_shapes(*shapes)
    full = [shape if n is None else (*shape, n) for n in lengths]
    whole = [
        np.require(np.broadcast_to(x, s), requirements=["C", "A"]) for x, s in zip(arrays, full, strict=True)
    ]
    return whole, shape
