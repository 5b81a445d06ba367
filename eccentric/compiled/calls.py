"""Arguments as NumPy accepts them, converted to what the C accepts.

The library itself accepts numbers, and contiguous arrays of one shape and precision. All else is handled
here: lists, shapes to broadcast, mixed precisions, strides, and bad input.
"""

# ruff: noqa: SLF001 - the module is emission's own

from __future__ import annotations

import ctypes
import inspect
import sys
from collections.abc import Callable, Sequence
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from eccentric.compiled.entry import CacheEntry, Signature


def functions(entry: CacheEntry, library: Path, source: ModuleType) -> dict[str, Callable[..., Any]]:
    """The functions that the NumPy module `source` has, from a library, by name, with the same arguments.

    Raises:
        OSError: this is not a library, or not one for this process.
    """
    loaded = ctypes.PyDLL(str(library))
    loaded.python_set.argtypes = [*[ctypes.py_object] * 5, ctypes.c_ssize_t, ctypes.c_int]
    # Without the global lock, Python threads run in parallel and must not share the last arguments.
    alone = getattr(sys, "_is_gil_enabled", lambda: True)()
    prepare = _prepare(entry, source)
    number_at = float.__basicsize__ - ctypes.sizeof(ctypes.c_double)  # behind the object's header
    loaded.python_set(np.ndarray, np.empty, np.float32, np.float64, prepare, number_at, alone)
    loaded.python_function.argtypes = [ctypes.c_int, ctypes.c_char_p, ctypes.py_object]
    loaded.python_function.restype = ctypes.py_object
    made = {}
    for number, called in enumerate(entry.functions):
        if like := getattr(source, called.name, None):
            plain = loaded.python_function(number, None, ctypes.py_object())
            signature = inspect.signature(like)
            doc = f"{called.name}{_text(signature)}\n--\n\n{inspect.getdoc(like)}"
            general = _general(called, source, signature, plain)
            made[called.name] = loaded.python_function(number, doc.encode(), general)
    return made


def _text(signature: inspect.Signature) -> str:
    """A signature as `inspect` reads it from C functions: without types."""
    plain = (p.replace(annotation=p.empty) for p in signature.parameters.values())
    return str(signature.replace(parameters=list(plain), return_annotation=signature.empty))


def _prepare(entry: CacheEntry, source: ModuleType) -> Callable[[Any, Any], tuple[np.ndarray, bool]]:
    held = {np.float32: entry.single, np.float64: entry.double}
    inertias = {name for called in entry.functions for name in called.requires}

    @lru_cache(maxsize=64)
    def prepared(parameters: Any, real: Any) -> tuple[np.ndarray, bool]:
        """The coefficients as stored in C, and whether there are inertias for an acceleration."""
        numbers = source._model.prepared(parameters, real).numbers
        given = source._model.default if parameters is None else parameters
        complete = all(getattr(given, name) is not None for name in inertias)
        return np.array([getattr(numbers, name) for name in held[real]] or [0.0], real), complete

    def prepare(parameters: Any, real: Any) -> tuple[np.ndarray, bool]:
        source._model.check(parameters)
        return prepared(parameters, real)

    return prepare


def _general(
    called: Signature, source: ModuleType, signature: inspect.Signature, plain: Callable[..., Any]
) -> Callable[..., Any]:
    """A function that passes on to `plain` whatever that accepts."""

    def general(*given: Any, **named: Any) -> Any:
        bound = signature.bind(*given, **named)
        bound.apply_defaults()
        *inputs, parameters, out = bound.arguments.values()
        source._model.check(parameters)
        if called.requires:
            source._model.require(called.requires, inputs[-1], parameters)
        arrays, real = source.runtime.arrays(inputs, called.inputs) if inputs else ([], np.float64)
        shape, ends = _samples(called, arrays)
        if out is not None:
            source.runtime.check_out(out, (*shape, called.width) if called.width else shape, real)
        whole = [_whole(x, (*shape, *ends)) for x in arrays]
        if out is None:
            result = plain(*whole, parameters)
            return result if shape or called.width else result[()]
        if out.flags.carray and not any(np.may_share_memory(x, out) for x in whole):
            return plain(*whole, parameters, out)
        out[...] = plain(*whole, parameters)
        return out

    return general


def _samples(called: Signature, arrays: Sequence[np.ndarray]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The shape of the samples, and the last axis that vectors have in addition."""
    if not called.length:
        return np.broadcast_shapes(*(x.shape for x in arrays)), ()
    for name, x in zip(called.inputs, arrays, strict=True):
        if x.shape[-1:] != (called.length,):
            required = f"{called.length} values on the last axis are required"
            raise ValueError(f"{name}: {required}, received shape {x.shape}")
    return np.broadcast_shapes(*(x.shape[:-1] for x in arrays)), (called.length,)


def _whole(x: np.ndarray, shape: Sequence[int]) -> np.ndarray:
    """The array, contiguous and aligned, with that shape."""
    return np.require(np.broadcast_to(x, shape), requirements=["C", "A"])
