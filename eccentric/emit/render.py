"""Render a model's trio: banner and digest in one place, templates strict, output as text."""

from __future__ import annotations

import hashlib
from functools import cache

import jinja2

from eccentric import __version__
from eccentric.emit import c99, numpy_module
from eccentric.emit.build import build_program
from eccentric.emit.program import Program
from eccentric.model import Model
from eccentric.places import folder


def render(model: Model, command: str = "make derive", origin: str | None = None) -> dict[str, str]:
    """The emitted files of a model: file name -> text.

    Args:
        model: what to emit.
        command: by which command the files were written; it stands in their banner.
        origin: where the physics stands, for the banner; by default the derivation of the model's name.
    """
    program = build_program(model)
    return render_program(program, origin or f"derivations/{model.name}.py", command)


def render_program(program: Program, origin: str, command: str) -> dict[str, str]:
    """The emitted files of a program; `origin` names where its physics stands."""
    digest = program_digest(program)
    banner = (
        f"Generated: do not edit. Written by `{command}` from {origin}\n"
        f"(eccentric {__version__}, program {digest}).\n"
        f"{program.title}."
    )
    summary = (
        "Inputs are on the motor side, in SI units; they broadcast, float32 stays float32, and `out` is"
        " honoured.\n"
        "Without parameters the defaults of `Parameters` hold."
    )
    c_view = c99.view(program, banner, digest)
    return {
        f"{program.name}.py": _template("module.py.jinja").render(
            numpy_module.view(program, banner, summary)
        ),
        f"{program.name}.h": _template("header.h.jinja").render(c_view),
        f"{program.name}.c": _template("source.c.jinja").render(c_view),
    }


def program_digest(program: Program) -> str:
    """Eight hexadecimal digits that change when anything that is computed changes."""
    lines = [program.name, *(f"{q.name} {q.unit} {q.default}" for q in program.parameters)]
    lines += [f"{a.target} = {a.value}" for a in program.prepare]
    for r in program.routines:
        lines += [r.name, *r.labels, *(x.quantity.name for x in r.inputs)]
        lines += [f"{a.target} = {a.value}" for a in r.assignments]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()[:8]


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


def _template(name: str) -> jinja2.Template:
    return _environment().get_template(name)
