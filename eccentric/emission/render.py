"""Render a model's trio: banner and digest in one place, templates strict, output as text."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import cache
from typing import Any

import jinja2
import sympy as sp

from eccentric import __version__
from eccentric.emission.backends.c99 import view as c99
from eccentric.emission.backends.expression import UnprintableError
from eccentric.emission.backends.numpy import view as numpy_module
from eccentric.emission.backends.text import plain, with_plain_text
from eccentric.emission.program import Program, Routine, build_program
from eccentric.errors import InputError
from eccentric.model import Model
from eccentric.places import folder

_DIGEST = "{digest}"  # stands in the files for what is known only when they are rendered


def render(model: Model, command: str = "make derive", origin: str | None = None) -> dict[str, str]:
    """The emitted files of a model: file name -> text.

    Args:
        model: what to emit.
        command: by which command the files were written; it stands in their banner.
        origin: where the physics stands, for the banner; by default the derivation of the model's name.

    Raises:
        InputError: the model lacks a balance, a term or a definition that is emitted, or has one with an
            operation that no back end computes; the message names model and term.
    """
    try:
        return render_program(build_program(model), origin or f"derivations/{model.name}.py", command)
    except UnprintableError as error:
        raise InputError(f"model {model.name}: {_place(model, error.operation)}{error}") from None


def _place(model: Model, operation: sp.Basic) -> str:
    """The term or definition that brings an operation along, for a message; "" if it cannot be told."""
    terms = [(f"term {term.name}", term.value) for balance in model.balances for term in balance.terms]
    definitions = [(d.quantity.name, d.value) for d in model.definitions]
    updates = [(state.quantity.name, state.update) for state in model.states]
    places = [name for name, value in (*terms, *definitions, *updates) if value.has(operation.func)]
    return f"{places[0]}: " if places else ""


def render_program(program: Program, origin: str, command: str) -> dict[str, str]:
    """The emitted files of a program; `origin` names where its physics stands.

    The digest that they carry is of all that stands below their banners: what changes the code changes it.
    """
    program = with_plain_text(program)
    banner = (
        f"Generated: do not edit. Written by `{plain(command)}` from {plain(origin)}\n"
        f"(eccentric {__version__}, program {_DIGEST}).\n"
        f"{program.title}."
    )
    summary = (
        "Inputs are on the motor side, in SI units; they broadcast, float32 stays float32, and `out` is"
        " honoured.\n"
        "Without parameters the defaults of `Parameters` hold.\n"
        "A TypeError names what is no real number; a ValueError, what is too large for the float32 beside it."
    )
    c_view = c99.view(program, banner, _DIGEST)
    views = {
        ("numpy/module.py.jinja", ".py"): numpy_module.view(program, banner, summary),
        ("c99/header.h.jinja", ".h"): c_view,
        ("c99/source.c.jinja", ".c"): c_view,
    }
    code = hashlib.sha256()
    files = {}
    for (name, ending), view in views.items():
        text = template(name).render(view)
        code.update(text.removeprefix(view["banner"]).encode())
        files[f"{program.name}{ending}"] = text
    return {name: text.replace(_DIGEST, code.hexdigest()[:8]) for name, text in files.items()}


def python_source(name: str, routines: Iterable[Routine]) -> str:
    """C that makes the functions of one sample callable from Python; each takes numbers and gives one."""
    return template("compiled/python.c.jinja").render(python_view(name, routines))


def python_view(name: str, routines: Iterable[Routine]) -> dict[str, Any]:
    """All that this template is filled with."""
    functions = [
        {"name": r.name, "inputs": [x.quantity.name for x in r.inputs], "doc": plain(r.meaning)}
        for r in routines
    ]
    return {"name": name, "functions": functions}


@cache
def _environment() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder("templates")),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # noqa: S701 - the output is C and Python, not HTML
    )


def template(name: str) -> jinja2.Template:
    """The template of that name below `templates/`, such as `numpy/module.py.jinja`."""
    return _environment().get_template(name)
