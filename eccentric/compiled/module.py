"""A derivation or Model as a Python module whose functions are those of the emitted C."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from eccentric.compiled.calls import functions
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
    from eccentric.emission import Program
    from eccentric.model import Model


_UNIT = "python-calls.c"
"""The file that is compiled and includes the rest; no model can have this name, since it is no C
identifier."""
_numbers = count()


def compile(model: Model | str | Path) -> ModuleType:  # noqa: A001 - called as eccentric.compile
    """A module like the emitted NumPy module of the model, with the functions of the emitted C.

    The model may be given as for `load_model`: its name ("c2_parallel"), or the path of a derivation. It is
    then derived only if something has changed since it was last compiled: its scripts, the toolkit or the
    compiler. The file of an arm, `.toml`, `.json` or `.urdf`, is derived every time.

    Arguments, broadcasting, precision, `out` and bits are those of the NumPy module; only exponentials may
    differ in their last bits between the two libraries. Floats give a float64. The library is stored in the
    user's cache, named after its sources: $XDG_CACHE_HOME or ~/.cache, folder eccentric.

    Raises:
        TypeError: this is neither a model nor a name or path.
        InputError: there is no such model, there is no C compiler, or not the one that CC names; it does not
            compile, its cache cannot be written, or the model cannot be emitted.
    """
    if isinstance(model, str | Path) and is_arm_file(model):
        return _of_arm(model, local_compiler())
    if isinstance(model, str | Path):
        compiler = local_compiler()
        served = _served(look_up(model, compiler))
        return served or _derived(model, compiler)
    from eccentric.model import Model

    if not isinstance(model, Model):
        raise TypeError(
            f"compile: a Model, its name or its path is required, received {type(model).__name__}"
        )
    return _built(model, local_compiler())[0]


def _of_arm(asked: str | Path, compiler: Compiler) -> ModuleType:
    from eccentric.emission import build_arm_program, render_program
    from eccentric.model import arm, recursion
    from eccentric.rigs import read_arm

    chain = read_arm(asked)
    found = recursion(chain)
    program = build_arm_program(found, arm(chain, f"Arm {chain.name}", found=found))
    return _compiled(
        program, render_program(program, Path(asked).name, "eccentric.compile", single_file=True), compiler
    )[0]


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
    from eccentric.compiled.view import length_of, view
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
                r.name, tuple(x.quantity.name for x in r.inputs), len(r.labels), r.requires, length_of(r)
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


def _served(entry: CacheEntry | None) -> ModuleType | None:
    """The module of an entry; None if there is no entry, or its library cannot be loaded."""
    if entry is None:
        return None
    source = run_text(
        entry.module, f"eccentric_compiled_{entry.name}_{next(_numbers)}", f"<{entry.name}.py as emitted>"
    )
    module = ModuleType(f"eccentric_compiled_{entry.name}", source.__doc__)
    for name in (*source.__all__, "STATES", "follow_states"):
        if hasattr(source, name):
            setattr(module, name, getattr(source, name))
    try:
        made = functions(entry, cache_folder() / entry.library, source)
    except OSError:
        return None
    for name, function in made.items():
        setattr(module, name, function)
    return module
