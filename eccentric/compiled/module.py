"""A derivation or Model as a Python module whose functions are those of the emitted C."""

from __future__ import annotations

import ctypes
import inspect
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from eccentric.compiled.entry import (
    CacheEntry,
    Compiler,
    Signature,
    keep_library,
    local_compiler,
    look_up,
    read_entry,
    remember,
    write_entry,
)
from eccentric.core import InputError, cache_folder, digest, is_arm_file, run_text

if TYPE_CHECKING:
    from eccentric.emission import Program, Routine
    from eccentric.model import Model


# Arguments as NumPy accepts them, converted to what the C accepts.
#
# The library itself accepts numbers, and contiguous arrays of one shape and precision. All else is handled
# here: lists, shapes to broadcast, mixed precisions, strides, and bad input.


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
        """The coefficients as stored in C, and whether there are inertias, above what friction takes."""
        numbers = source._model.prepared(parameters, real).numbers  # noqa: SLF001 - emission's own
        given = source._model.default if parameters is None else parameters  # noqa: SLF001 - emission's own
        complete = all(getattr(given, name) is not None for name in inertias)
        complete = complete and not source._model.unsolvable(parameters)  # noqa: SLF001 - emission's own
        return np.array([getattr(numbers, name) for name in held[real]] or [0.0], real), complete

    def prepare(parameters: Any, real: Any) -> tuple[np.ndarray, bool]:
        source._model.check(parameters)  # noqa: SLF001 - emission's own
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
        source._model.check(parameters)  # noqa: SLF001 - emission's own
        if called.requires:
            source._model.require(called.requires, called.inputs[-1], inputs[-1], parameters)  # noqa: SLF001 - emission's own
        if called.steps:
            source._model.require_solvable(parameters)  # noqa: SLF001 - emission's own
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
            required = f"expected {called.length} values on the last axis"
            raise ValueError(f"{name}: {required}, got shape {x.shape}")
    return np.broadcast_shapes(*(x.shape[:-1] for x in arrays)), (called.length,)


def _whole(x: np.ndarray, shape: Sequence[int]) -> np.ndarray:
    """The array, contiguous and aligned, with that shape."""
    return np.require(np.broadcast_to(x, shape), requirements=["C", "A"])


_UNIT = "python-calls.c"
"""The file that is compiled and includes the rest; no model can have this name, since it is no C
identifier."""
_numbers = count()


def compile(model: Model | str | Path) -> ModuleType:  # noqa: A001 - called as eccentric.compile
    """Compile the emitted C of a model into a module like the emitted NumPy module.

    The model may be given as for `load_model`: its name ("c2_parallel"), or the path of a derivation. It is
    derived again only if its scripts, the toolkit or the compiler have changed. The file of an arm, `.toml`,
    `.json` or `.urdf`, is derived every time.

    Arguments, broadcasting, precision, `out` and bits are those of the NumPy module; only exponentials may
    differ in their last bits between the two libraries. Floats give a float64. The library is stored in the
    user's cache, named after its sources: $XDG_CACHE_HOME or ~/.cache, folder eccentric.

    Raises:
        TypeError: `model` is neither a Model nor a name or path.
        InputError: there is no such model; there is no C compiler, or not the one named by CC; the code does
            not compile; the cache cannot be written; or the model cannot be emitted.
    """
    if isinstance(model, str | Path) and is_arm_file(model):
        return _of_arm(model, local_compiler())
    if isinstance(model, str | Path):
        compiler = local_compiler()
        served = _served(look_up(model, compiler))
        return served or _derived(model, compiler)
    from eccentric.model import Model

    if not isinstance(model, Model):
        raise TypeError(f"compile: expected a Model, its name or its path, got {type(model).__name__}")
    return _built(model, local_compiler())[0]


def _of_arm(asked: str | Path, compiler: Compiler) -> ModuleType:
    from eccentric.model import arm
    from eccentric.rigs import read_arm

    chain = read_arm(asked)
    return _built(arm(chain, f"Arm {chain.name}"), compiler)[0]


def _derived(asked: str | Path, compiler: Compiler) -> ModuleType:
    from eccentric.model import load_model

    module, name, key = _built(load_model(asked), compiler)
    remember(asked, compiler, (name, key))
    return module


def _built(model: Model, compiler: Compiler) -> tuple[ModuleType, str, str]:
    """The module of a model, and the name and key of its entry in the cache."""
    from eccentric.emission import build_program, render

    return _compiled(build_program(model), render(model, single_file=True), compiler)


def _compiled(program: Program, files: Mapping[str, str], compiler: Compiler) -> tuple[ModuleType, str, str]:
    from eccentric.emission import template

    module = files[f"{program.name}.py"]
    sources = {name: text for name, text in files.items() if name.endswith((".c", ".h"))}
    sources[_UNIT] = template("compiled/python.c").render(view(program))
    key = digest([compiler.identity, module, *(part for source in sources.items() for part in source)])
    if served := _served(read_entry(program.name, key)):
        return served, program.name, key
    entry = CacheEntry(
        program.name,
        module,
        tuple(
            Signature(
                r.name,
                tuple(x.quantity.name for x in r.inputs),
                len(r.labels),
                r.requires,
                _length(r),
                r.name in program.conditioned,
            )
            for r in program.routines
        ),
        tuple(s.name for s in program.held(single=True)),
        tuple(s.name for s in program.held(single=False)),
        keep_library(program.name, lambda folder: compiler.build(sources, _UNIT, folder)),
    )
    write_entry(key, entry)
    if served := _served(entry):
        return served, program.name, key
    raise InputError("compile", "a library that this process can load", cache_folder() / entry.library)


def view(program: Program) -> dict[str, Any]:
    """The variables of `templates/compiled/`: C by which Python calls the functions of a program."""
    functions = [
        {
            "name": r.name,
            "inputs": [x.quantity.name for x in r.inputs],
            "width": len(r.labels),
            "length": _length(r),
            "inertia": 2 if r.name in program.conditioned else int(bool(r.requires)),
            "optional": int(r.last_is_optional),
            "plain": bool(r.inputs)
            and not (r.labels or r.requires or _length(r) or r.name in program.conditioned),
        }
        for r in program.routines
    ]
    most = max(len(r.inputs) for r in program.routines)
    return {"name": program.name, "functions": functions, "most_inputs": most}


def _length(r: Routine) -> int:
    """The number of entries of every input, 0 where they are numbers."""
    return next((x.length or 0 for x in r.inputs), 0)


def _served(entry: CacheEntry | None) -> ModuleType | None:
    """The module of an entry; None if there is no entry, or its library cannot be loaded."""
    if entry is None:
        return None
    source = run_text(
        entry.module, f"eccentric_compiled_{entry.name}_{next(_numbers)}", f"<{entry.name}.py as emitted>"
    )
    module = ModuleType(f"eccentric_compiled_{entry.name}", source.__doc__)
    for name in source.__all__:
        setattr(module, name, getattr(source, name))
    # A former name is not public: calling it is the same error as in the NumPy module.
    setattr(module, "__getattr__", partial(getattr, source))  # noqa: B010 - no attribute of ModuleType
    try:
        made = functions(entry, cache_folder() / entry.library, source)
    except OSError:
        return None
    for name, function in made.items():
        setattr(module, name, function)
    return module
