"""Routines and helpers of the Program as functions of Python."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from typing import Any

from eccentric.emission.backends.expression import Language, printed
from eccentric.emission.backends.python.dialect import Dialect
from eccentric.emission.backends.python.inline import inlined
from eccentric.emission.backends.python.lines import WIDTH, broken
from eccentric.emission.backends.python.shared import CodeBody, Line, names_in, with_shared
from eccentric.emission.program import Assignment, Helper, Program, Routine

_MARGIN = 110
_LONGEST = 100  # docstring on one line


def functions(program: Program, dialect: Dialect) -> dict[str, list[dict[str, Any]]]:
    """What the template takes of helpers, of what routines share, and of routines."""
    coefficients = {s.name for s in program.coefficients} | {"rounder"}
    calls = {**dialect.kernel, **{helper.name: f"_{helper.name}(c, {{0}})" for helper in program.helpers}}
    spelling = dialect.language(calls, lambda name: f"c.{name}" if name in coefficients else name)
    taken = {f"_{helper.name}" for helper in program.helpers}
    shared, bodies = with_shared([_body(r, spelling) for r in program.routines], taken)
    return {
        "helpers": [_helper(h, spelling) for h in program.helpers],
        "shared": [_shared(body) for body in shared],
        "routines": [_routine(r, b) for r, b in zip(program.routines, bodies, strict=True)],
    }


def _body(r: Routine, spelling: Language) -> CodeBody:
    """The routine as lines; a result that is just a name needs none."""
    lines = _printed(r.assignments, spelling)
    results = [str(s) for s in r.results]
    named = {line.targets[0]: line.text for line in lines if line.text.removeprefix("c.").isidentifier()}
    kept = [line for line in lines if line.targets[0] not in results or line.targets[0] not in named]
    inputs = [s.name for x in r.inputs for s in x.symbols]
    return CodeBody(r.name, tuple(inputs), tuple(kept), tuple(named.get(name, name) for name in results))


def _printed(assignments: Iterable[Assignment], spelling: Language) -> list[Line]:
    return inlined(Line((a.target.name,), printed(a.value, spelling), a.note) for a in assignments)


def _lines(body: CodeBody, *, vector: bool) -> list[str]:
    """The lines of a function, which returns a tuple if it is a vector."""
    lines = []
    for k, line in enumerate(body.lines):
        lines += [f"# {part}" for part in textwrap.wrap(line.note, 100)]
        read = names_in(later.text for later in body.lines[k + 1 :]) | {*body.results}
        lines += _assigned(line, read)
    if body.lines and body.lines[-1].targets == body.results and vector == (len(body.results) > 1):
        own = len(_assigned(body.lines[-1], {*body.results}))
        return [*lines[:-own], *broken("return ", body.lines[-1].text)]
    return [*lines, *_returned(body.results, vector)]


def _assigned(line: Line, read: set[str]) -> list[str]:
    """An assignment; unused ones of several values are left out."""
    if len(line.targets) == 1:
        return broken(f"{line.targets[0]} = ", line.text)
    if not read.intersection(line.targets[1:]):
        return [f"{line.targets[0]} = {line.text}[0]"]
    targets = ", ".join(name if name in read else "_" for name in line.targets)
    if len(f"{targets} = {line.text}") <= WIDTH:
        return [f"{targets} = {line.text}"]
    function, _, inputs = line.text.partition("(")
    return [f"{targets} = {function}(", f"    {inputs[:-1]}", ")"]


def _returned(results: Sequence[str], vector: bool) -> list[str]:
    text = f"return {', '.join(results)}" if len(results) > 1 or not vector else f"return ({results[0]},)"
    if len(text) <= WIDTH:
        return [text]
    return ["return (", *(f"    {name}," for name in results), ")"]


def _helper(helper: Helper, spelling: Language) -> dict[str, Any]:
    result = helper.assignments[-1].target.name
    body = CodeBody(
        helper.name, (helper.argument.name,), tuple(_printed(helper.assignments, spelling)), (result,)
    )
    return {
        "name": f"_{helper.name}",
        "inputs": ["c", helper.argument.name],
        "doc": sentence(helper.meaning),
        "lines": _lines(body, vector=False),
    }


def _shared(body: CodeBody) -> dict[str, Any]:
    last = body.lines[-1]
    whole = f"the values of {body.name[1:]}"
    meaning = (last.note or last.targets[-1]) if body.name == f"_{last.targets[-1]}" else whole
    doc = f"{sentence(meaning)[:-1]}, with what it takes; {body.callers} functions call this."
    return {
        "name": body.name,
        "inputs": ["c", *body.inputs],
        "doc": doc if len(doc) <= _LONGEST else doc.replace("; ", ".\n\n    ") + "\n    ",
        "lines": _lines(body, vector=len(body.results) > 1),
    }


def _routine(r: Routine, body: CodeBody) -> dict[str, Any]:
    names = [x.quantity.name for x in r.inputs]
    defaults = ["=0.0" if r.requires and x is r.inputs[-1] else "" for x in r.inputs]
    vectors = {x.quantity.name: x.length for x in r.inputs if x.length is not None}
    unpacked = [
        f"({', '.join(s.name for s in x.symbols)},) = {x.quantity.name}" for x in r.inputs if x.length
    ]
    options = [f"needs={quoted(r.requires)}"] if r.requires else []
    options += [f"vectors={vectors}"] if vectors else []
    return {
        "name": r.name,
        "options": f"({', '.join(options)})" if options else "",
        "inputs": ["c", *(name + default for name, default in zip(names, defaults, strict=True))],
        "doc": _documentation(r),
        "lines": [*unpacked, *_lines(body, vector=bool(r.labels))],
    }


def _documentation(r: Routine) -> str:
    """Meaning, unit and columns; the meaning of the inputs is added when the module is loaded."""
    axis = f"; last axis ({', '.join(r.labels)})" if r.labels else ""
    doc = f"{sentence(r.meaning).removesuffix('.')} [{r.unit}]{axis}."
    if len(doc) <= _LONGEST:
        return doc
    return "\n    ".join([f"{sentence(r.meaning)}\n", *textwrap.wrap(f"In {r.unit}{axis}.", 100), ""])


def sentence(text: str) -> str:
    """The text as a sentence."""
    return f"{text[0].upper()}{text[1:]}."


def quoted(items: Sequence[str], before: str = "") -> str:
    """A tuple of strings in formatter style, after `before` on its line."""
    strings = [f'"{item}"' for item in items]
    line = f"({', '.join(strings)}{',' * (len(strings) == 1)})"
    return (
        line
        if len(before + line) <= _MARGIN
        else "".join(["(\n", *(f"    {string},\n" for string in strings), ")"])
    )
