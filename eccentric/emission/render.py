"""Render the emitted files of a model: back ends by name, banner and digest in one place; write the text."""

from __future__ import annotations

import difflib
import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import sympy as sp

from eccentric.core import InputError, whole_files
from eccentric.emission.backends import BACKENDS, DEFAULT, Backend, UnprintableError, with_plain_text
from eccentric.emission.program import WHOLE, Choice, Program, build_program
from eccentric.emission.templates import plain, template
from eccentric.model import Model
from eccentric.version import __version__

_DIGEST = "{digest}"  # a placeholder in the files until the digest is known


def render(
    model: Model,
    command: str = "make derive",
    origin: str | None = None,
    backends: Iterable[str] = DEFAULT,
    *,
    single_file: bool = False,
    choice: Choice = WHOLE,
) -> dict[str, str]:
    """The emitted files of a model: file name -> text.

    Args:
        model: what to emit.
        command: the command that writes the files, for their banner.
        origin: source of the physics, for the banner; by default the derivation of the model's name.
        backends: names of `BACKENDS`.
        single_file: whether each file contains all that it needs, including the parts common to all models.
        choice: what of the model is emitted; by default all of it.

    Raises:
        InputError: there is no function of a chosen name; the model lacks a balance, a term or a definition
            that is emitted, or has one with an operation that no back end computes; the message names model
            and term; or C is wanted of functions that depend on no parameter and no angle.
    """
    backends = tuple(backends)
    with _printable(model):
        origin = origin or f"derivations/{model.name}.py"
        program = build_program(model, choice)
        if "c99" in backends and not program.coefficients:
            raise InputError(program.name, "a function of an angle or a parameter", "none", why="for C")
        return render_program(program, origin, command, backends, single_file=single_file)


def render_code(model: Model, backend: str, choice: Choice = WHOLE) -> dict[str, str]:
    """The files of one back end without banner or digest, to be executed at once: file name -> text.

    Raises:
        InputError: the model cannot be emitted, as in `render`.
    """
    with _printable(model):
        return _code(with_plain_text(build_program(model, choice)), BACKENDS[backend])


@contextmanager
def _printable(model: Model) -> Iterator[None]:
    """An operation that no back end computes becomes an InputError that names model and term."""
    try:
        yield
    except UnprintableError as error:
        raise InputError(f"model {model.name}: {_place(model, error.operation)}{error}") from None


def _place(model: Model, operation: sp.Basic) -> str:
    """The term or definition that contains an operation, for a message; "" if unknown."""
    terms = [(f"term {term.name}", term.value) for balance in model.balances for term in balance.terms]
    definitions = [(d.quantity.name, d.value) for d in model.definitions]
    updates = [(state.quantity.name, state.update) for state in model.states]
    places = [name for name, value in (*terms, *definitions, *updates) if value.has(operation.func)]
    return f"{places[0]}: " if places else ""


def render_program(
    program: Program,
    origin: str,
    command: str,
    backends: Iterable[str] = DEFAULT,
    *,
    single_file: bool = False,
) -> dict[str, str]:
    """The emitted files of a program; `origin` is the source of its physics.

    Their digest is that of everything below the banners of the default back ends, whichever are requested:
    any change of the code changes it, and files of one program have the same number.
    """
    program, backends = with_plain_text(program), tuple(backends)
    code = {name: _code(program, BACKENDS[name]) for name in {*DEFAULT, *backends}}
    texts = [text for name in DEFAULT for text in code[name].values()]
    digest = hashlib.sha256("".join(texts).encode()).hexdigest()[:8]
    if single_file:
        code = {name: _code(program, BACKENDS[name], single_file=True) for name in backends}
    written = f"Generated: do not edit. Written by `{plain(command)}`"
    own = (
        f"{written} from {plain(origin)}",
        f"(eccentric {__version__}, program {_DIGEST}).",
        f"{program.title}.",
        *(f"Caution: {plain(text)}." for text in program.cautions),
    )
    common = (f"{written} (eccentric {__version__}).",)
    files = {}
    for name in backends:
        backend = BACKENDS[name]
        for file, text in code[name].items():
            banner = backend.banner(common if file in backend.files.values() else own)
            files[file] = (banner + text).replace(_DIGEST, digest)
    return files


def digest_of(model: Model, files: Mapping[str, str]) -> str:
    """The digest of a model's emitted files, as its header spells it: 0x1234abcdUL."""
    return re.findall(r"_PROGRAM (0x\w+)", files[f"{model.name}.h"])[0]


def render_beside(
    model: Model, part: str, ending: str, view: Mapping[str, Any], meaning: str, command: str
) -> dict[str, str]:
    """Files that belong to a model's own: header, source, Python and a driver of the proof, name -> text.

    Args:
        model: whose files they lie beside.
        part: the folder of their templates.
        ending: of their names, behind the model's.
        view: what the templates are filled with, its digest among it.
        meaning, command: what they are and what writes them, for the banner.
    """
    banner = (
        f"Generated: do not edit. Written by `{plain(command)}`, beside {model.name}.c",
        f"(eccentric {__version__}, program {view['digest'][2:].removesuffix('UL')}).",
        meaning,
    )
    name = f"{model.name}_{ending}"
    listed = (
        ("header.h", f"{name}.h", "c99"),
        ("source.c", f"{name}.c", "c99"),
        ("module.py", f"{name}.py", "numpy"),
        ("proof.c", f"check/{name}_proof.c", ""),
    )
    return {
        file: (BACKENDS[backend].banner(banner) if backend else "") + template(f"{part}/{kind}").render(view)
        for kind, file, backend in listed
    }


def _code(program: Program, backend: Backend, *, single_file: bool = False) -> dict[str, str]:
    """The files of a back end without their banners."""
    view = backend.view(program, _DIGEST)
    files = backend.written(program.name, single_file=single_file)
    texts = {file: template(name).render(view) for name, file in files.items()}
    return {file: text for file, text in texts.items() if text}  # a template may have nothing to say


def write(files: Mapping[str, str], out: Path) -> list[Path]:
    """Write rendered files, name -> text, as one set; those that are already fresh are not touched.

    Returns:
        The paths, written or fresh.

    Raises:
        InputError: the folder cannot be written.
    """
    if any(_found(out / name) != text for name, text in files.items()):
        with whole_files(out) as new:
            for name, text in files.items():
                (new / name).parent.mkdir(parents=True, exist_ok=True)
                (new / name).write_text(text, encoding="utf-8", newline="\n")
    return [out / name for name in files]


def differences(files: Mapping[str, str], out: Path) -> str:
    """The unified diff from the files in the folder to the rendered ones; "" if they are the same."""
    diffs = []
    for name, text in files.items():
        diffs += difflib.unified_diff(
            _found(out / name).splitlines(keepends=True),
            text.splitlines(keepends=True),
            f"generated/{name}",
            f"derived/{name}",
        )
    return "".join(diffs)


def _found(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.is_file() else ""
